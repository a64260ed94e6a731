"""The point of a bilinear quad that is closest to a point in space.

With s(xi, eta) = c + xi a + eta b + xi eta d over the square [-1, 1]², the foot of p makes
½ |p - s|² stationary (Newton, from the quad's centre); where it lies beyond the square, the closest
point of a side takes its place.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

from shellcut.arrays import Vec3
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import add_scaled, combine, cross, dot, norm, scale, sub

_NEWTON_STEPS = 8

# Of the second derivatives' determinant over that of a rectangle, below which it is no guide.
_LEAST_CONVEX = 0.1

# Of the square: steps below this are no more than round-off.
_CONVERGED = 1e-12


class QuadSurface(NamedTuple):
    """Coefficients of a bilinear quad."""

    c: Annotated[Vec3, "[mm]"]
    a: Annotated[Vec3, "[mm]"]
    b: Annotated[Vec3, "[mm]"]
    d: Annotated[Vec3, "[mm]"]


@inline
def quad_surface(x0: Vec3, x1: Vec3, x2: Vec3, x3: Vec3) -> QuadSurface:
    """Return the surface through four corners, at (-1, -1), (1, -1), (1, 1) and (-1, 1)."""
    even, odd = combine(0.25, x0, 0.25, x2), combine(0.25, x1, 0.25, x3)
    along, across = combine(0.25, x2, -0.25, x0), combine(0.25, x1, -0.25, x3)
    return QuadSurface(
        combine(1.0, even, 1.0, odd),
        combine(1.0, along, 1.0, across),
        combine(1.0, along, -1.0, across),
        sub(even, odd),
    )


@inline
def point_of(quad: QuadSurface, xi: float, eta: float) -> Vec3:
    """Return s(xi, eta) [mm]."""
    s = add_scaled(add_scaled(quad.c, xi, quad.a), eta, quad.b)
    return add_scaled(s, xi * eta, quad.d)


@inline
def unit_normal(quad: QuadSurface, xi: float, eta: float) -> Vec3:
    """Return the unit normal at a place."""
    n = cross(add_scaled(quad.a, eta, quad.d), add_scaled(quad.b, xi, quad.d))
    return scale(1.0 / norm(n), n)


@inline
def corner_weights(xi: float, eta: float) -> tuple[float, float, float, float]:
    """Return the shape functions of the four corners."""
    p, m, q, n = 0.5 * (1.0 + xi), 0.5 * (1.0 - xi), 0.5 * (1.0 + eta), 0.5 * (1.0 - eta)
    return m * n, p * n, p * q, m * q


@inline
def foot_on_quad(p: Vec3, quad: QuadSurface) -> tuple[float, float]:
    """Return xi and eta of the point of a quad closest to p."""
    xi = eta = 0.0
    for _ in range(_NEWTON_STEPS):
        r = sub(p, point_of(quad, xi, eta))
        one, two = add_scaled(quad.a, eta, quad.d), add_scaled(quad.b, xi, quad.d)
        h11, h22 = dot(one, one), dot(two, two)
        level = dot(one, two)
        h12 = level - dot(r, quad.d)
        whole = h11 * h22 - h12 * h12
        if whole <= _LEAST_CONVEX * h11 * h22:  # of a skewed quad, far from the foot: Gauss-Newton
            h12, whole = level, h11 * h22 - level * level
        f1, f2 = dot(r, one), dot(r, two)
        on, up = (h22 * f1 - h12 * f2) / whole, (h11 * f2 - h12 * f1) / whole
        xi, eta = min(max(xi + on, -2.0), 2.0), min(max(eta + up, -2.0), 2.0)
        if abs(on) + abs(up) < _CONVERGED:
            break
    if abs(xi) <= 1.0 and abs(eta) <= 1.0:
        return xi, eta
    best_xi, best_eta, least = xi, eta, -1.0
    if abs(xi) > 1.0:
        best_xi = 1.0 if xi > 0.0 else -1.0
        best_eta = _along(
            p, add_scaled(quad.c, best_xi, quad.a), add_scaled(quad.b, best_xi, quad.d)
        )
        away = sub(p, point_of(quad, best_xi, best_eta))
        least = dot(away, away)
    if abs(eta) > 1.0:
        side = 1.0 if eta > 0.0 else -1.0
        at = _along(p, add_scaled(quad.c, side, quad.b), add_scaled(quad.a, side, quad.d))
        away = sub(p, point_of(quad, at, side))
        if least < 0.0 or dot(away, away) < least:
            best_xi, best_eta = at, side
    return best_xi, best_eta


@inline
def _along(p: Vec3, middle: Vec3, half: Vec3) -> float:
    """Return the place in [-1, 1] on a side, from its middle by its half, closest to p."""
    return min(max(dot(sub(p, middle), half) / dot(half, half), -1.0), 1.0)
