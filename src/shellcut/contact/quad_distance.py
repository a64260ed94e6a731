"""The place of a quad's film that is closest to a point, for kernels.

The film of a row is a convex polygon of the parametric square (:mod:`.film_outline`). The foot of
the perpendicular from p on the bilinear surface is found by Newton's method on

    r · a_1 = 0,   r · a_2 = 0,   r = p - x(xi, eta),

with the exact second derivatives. If it lies in the polygon, it is the closest place; else that
lies on an edge of the polygon, taken as a straight line between its ends. On sides of the quad that
is exact. A flank is a straight chord of the parametric square: on a quad that is no parallelogram
the two differ by a part of its twist.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.jit import always_inline
from shellcut.numerics.vec3 import add, add_scaled, combine, cross, dot, load, scale, sub

from .film_outline import Outline

# Newton's method converges quadratically; a foot that is not found by then lies far outside.
_MOST_STEPS = 12
_FOUND = 1e-13
_FAR_OUTSIDE = 4.0

# A foot this little outside a polygon, in xi and eta, is on its edge: far above round-off.
_ON_EDGE = 1e-12


class Corners(NamedTuple):
    """Positions of the nodes of a quad [mm]."""

    x0: Vec3
    x1: Vec3
    x2: Vec3
    x3: Vec3


class Closest(NamedTuple):
    """The place of a quad's film that is closest to a point."""

    square: float
    """Squared distance [mm²]."""
    xi: float
    """Where it is, as is eta."""
    eta: float
    beside: bool
    """Whether the film ends there: the point lies beyond its edge."""


@always_inline
def corners_of(x: Floats, quads: Ints, row: int) -> Corners:
    """Return the positions of the nodes of a row."""
    return Corners(
        load(x, quads[row, 0]),
        load(x, quads[row, 1]),
        load(x, quads[row, 2]),
        load(x, quads[row, 3]),
    )


@always_inline
def weights_at(xi: float, eta: float) -> tuple[float, float, float, float]:
    """Return the four shape functions at a place."""
    return (
        0.25 * (1.0 - xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 - eta),
        0.25 * (1.0 + xi) * (1.0 + eta),
        0.25 * (1.0 - xi) * (1.0 + eta),
    )


@always_inline
def place_in(q: Corners, xi: float, eta: float) -> Vec3:
    """Return the position of a place of a quad [mm]."""
    n0, n1, n2, n3 = weights_at(xi, eta)
    return add(combine(n0, q.x0, n1, q.x1), combine(n2, q.x2, n3, q.x3))


@always_inline
def tangents_at(q: Corners, xi: float, eta: float) -> tuple[Vec3, Vec3]:
    """Return the tangents a_1 and a_2 at a place of a quad [mm]."""
    low, high = sub(q.x1, q.x0), sub(q.x2, q.x3)
    left, right = sub(q.x3, q.x0), sub(q.x2, q.x1)
    a1 = combine(0.25 * (1.0 - eta), low, 0.25 * (1.0 + eta), high)
    a2 = combine(0.25 * (1.0 - xi), left, 0.25 * (1.0 + xi), right)
    return a1, a2


@always_inline
def normal_at(q: Corners, xi: float, eta: float) -> Vec3:
    """Return the unit normal at a place of a quad."""
    a1, a2 = tangents_at(q, xi, eta)
    n = cross(a1, a2)
    return scale(1.0 / sqrt(dot(n, n)), n)


@always_inline
def foot_on(p: Vec3, q: Corners) -> tuple[float, float, bool]:
    """Return where the foot of the perpendicular from p on a quad is, and whether there is one."""
    twist = scale(0.25, sub(add(q.x0, q.x2), add(q.x1, q.x3)))
    xi = eta = 0.0
    for _ in range(_MOST_STEPS):
        a1, a2 = tangents_at(q, xi, eta)
        r = sub(p, place_in(q, xi, eta))
        g1, g2 = dot(r, a1), dot(r, a2)
        h11, h22 = dot(a1, a1), dot(a2, a2)
        h12 = dot(a1, a2) - dot(r, twist)
        det = h11 * h22 - h12 * h12
        if not det > 0.0:  # far from the quad, or it is not finite
            return xi, eta, False
        step_xi, step_eta = (h22 * g1 - h12 * g2) / det, (h11 * g2 - h12 * g1) / det
        xi += step_xi
        eta += step_eta
        if abs(xi) + abs(eta) > 2.0 * _FAR_OUTSIDE:
            return xi, eta, False
        if abs(step_xi) + abs(step_eta) < _FOUND:
            return xi, eta, True
    return xi, eta, False


@always_inline
def closest_place(p: Vec3, q: Corners, row: int, outline: Outline) -> Closest:
    """Return the place of a row's film that is closest to p."""
    n, point = outline.n_edge[row], outline.point
    xi, eta, found = foot_on(p, q)
    inside = found
    for k in range(n):
        end = (k + 1) % n
        x0, y0 = point[row, k, 0], point[row, k, 1]
        dx, dy = point[row, end, 0] - x0, point[row, end, 1] - y0
        inside = inside and dx * (eta - y0) - dy * (xi - x0) >= -_ON_EDGE
    if inside:
        r = sub(p, place_in(q, xi, eta))
        return Closest(dot(r, r), xi, eta, False)
    best = Closest(1e300, 0.0, 0.0, True)
    for k in range(n):
        s, square, xi, eta = closest_on_edge(p, q, row, k, outline)
        if square < best.square:
            beside = outline.open[row, k]
            if s <= 0.0:
                beside = outline.open_at[row, k]
            elif s >= 1.0:
                beside = outline.open_at[row, (k + 1) % n]
            best = Closest(square, xi, eta, beside)
    return best


@always_inline
def closest_on_edge(
    p: Vec3, q: Corners, row: int, k: int, outline: Outline
) -> tuple[float, float, float, float]:
    """Return the place of an edge closest to p: its part of the way, distance² [mm²], xi, eta."""
    point, end = outline.point, (k + 1) % outline.n_edge[row]
    x0, y0, x1, y1 = point[row, k, 0], point[row, k, 1], point[row, end, 0], point[row, end, 1]
    start = place_in(q, x0, y0)
    way, r = sub(place_in(q, x1, y1), start), sub(p, start)
    s = min(max(dot(r, way) / dot(way, way), 0.0), 1.0)
    off = add_scaled(r, -s, way)
    return s, dot(off, off), x0 + s * (x1 - x0), y0 + s * (y1 - y0)
