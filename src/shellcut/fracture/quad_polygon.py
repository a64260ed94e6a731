"""The part of a quad that a copy carries: a convex polygon in the parametric square, and its share.

A crack crosses a quad along a straight chord in xi, eta. Each chord divides the polygon of a copy
in two, so the polygons stay convex however often a quad is cut. An edge of a polygon lies either on
a side of the quad, where the film continues in the neighbour, or on a flank.

The share of a copy is its part of the quad's area. With n the unit normal at the centre, the
density J = n · (a_1 x a_2) is linear in xi and eta, so that its integral over a polygon is exact:
the sum over triangles of their area times J at their centroid. On a flat quad that is the area in
space; on a warped one it is the area seen along n. The shares of all copies sum to 1.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import copysign, hypot
from typing import NamedTuple, TypeAlias

import numpy as np

from shellcut.arrays import Floats, product
from shellcut.numerics.bilinear import slopes_by_eta, slopes_by_xi
from shellcut.numerics.jit import inline_or_plain

Point: TypeAlias = tuple[float, float]
"""xi, eta."""

FLANK = -1
"""Of a polygon's edge: it lies on a crack, not on a side of the quad."""

CORNERS: tuple[Point, ...] = ((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0))
"""Of the parametric square, in the order of a quad's nodes."""

# Of the corners: half the vectors from side to side, and the part that twists.
_MODES = 0.25 * np.array([[-1.0, 1.0, 1.0, -1.0], [-1.0, -1.0, 1.0, 1.0], [1.0, -1.0, 1.0, -1.0]])

UNUSED = 1e-9
"""Shape functions below this are round-off."""

# Two points of the parametric square closer than this are one; far above round-off, and far below
# any distance that the rules of snapping leave.
_SAME = 1e-9

AWAY = 1e-6
"""Of the parametric square, or of a side of it: far above round-off."""

# Gauss points and weights of the two directions through a triangle.
_LINE_POINTS = [np.polynomial.legendre.leggauss(n) for n in (3, 2)]

# Of the parametric square: a quarter of an edge, clear of the mid-plane of a blade in the cut.
_CLEAR = 0.5


class Polygon(NamedTuple):
    """A convex polygon of the parametric square, counter-clockwise."""

    points: tuple[Point, ...]
    sides: tuple[int, ...]
    """Of the edge from each point to the next: the side of the quad on which it lies (0 from corner
    0 to corner 1, and so on), or FLANK."""


WHOLE = Polygon(CORNERS, (0, 1, 2, 3))
"""Of a quad that nothing has cut."""


def on_side(side: int, s: float) -> Point:
    """Return the point of a side at the fraction s of its length from its first corner."""
    start, end = CORNERS[side], CORNERS[(side + 1) % 4]
    c = 2.0 * s - 1.0  # exact at the ends and symmetric about the middle
    return (
        start[0] if start[0] == end[0] else start[0] * -c,
        start[1] if start[1] == end[1] else start[1] * -c,
    )


@inline_or_plain
def along_side(side: int, point: Point) -> float:
    """Return the fraction of a side's length at which a point of it lies."""
    c = point[0] if side % 2 == 0 else point[1]
    return 0.5 * (1.0 + (c if side < 2 else -c))


def ascending(a: int, b: int, s: float) -> tuple[int, int, float]:
    """Return the ends of a side, the lower first, and the fraction s of it from that one on."""
    return (a, b, s) if a <= b else (b, a, 1.0 - s)


def edges(polygon: Polygon) -> Iterator[tuple[Point, Point, int]]:
    """Yield the edges of a polygon: two points, and the side of the quad, or FLANK."""
    points = polygon.points
    return zip(points, (*points[1:], points[0]), polygon.sides, strict=True)


def span(polygon: Polygon, side: int) -> tuple[float, float] | None:
    """Return from where to where a polygon lies on a side, as fractions of it; None if nowhere."""
    ends = ((a, b) for a, b, lies_on in edges(polygon) if lies_on == side)
    return next(((along_side(side, a), along_side(side, b)) for a, b in ends), None)


def has_corner(polygon: Polygon, corner: int) -> bool:
    """Return whether a polygon reaches a corner of the quad."""
    return any(_distance(p, CORNERS[corner]) < _SAME for p in polygon.points)


def corner_at(point: Point) -> int:
    """Return the corner of the quad at a point, -1 if there is none."""
    return next((c for c in range(4) if _distance(point, CORNERS[c]) < _SAME), -1)


def side_at(point: Point) -> int:
    """Return the side of the quad on which a point lies, -1 if none; of two the first."""
    return next(
        (k for k in range(4) if _distance(point, on_side(k, along_side(k, point))) < _SAME), -1
    )


def onto_boundary(point: Point) -> Point:
    """Return a point of the parametric square, on the boundary if it is there but for round-off."""
    xi, eta = (copysign(1.0, c) if abs(c) > 1.0 - 2.0 * AWAY else c for c in point)
    return xi, eta


def edge_at(polygon: Polygon, point: Point) -> int:
    """Return on which edge of a polygon a point lies, -1 if on none."""
    for i, (a, b, _) in enumerate(edges(polygon)):
        length = _distance(a, b)
        along = ((point[0] - a[0]) * (b[0] - a[0]) + (point[1] - a[1]) * (b[1] - a[1])) / length
        if abs(_cross(a, b, point)) < _SAME * length and -_SAME < along < length + _SAME:
            return i
    return -1


def contains(polygon: Polygon, point: Point) -> bool:
    """Return whether a point lies in a polygon or on its boundary."""
    return all(_cross(a, b, point) > -_SAME for a, b, _ in edges(polygon))


def common_side(polygon: Polygon, one: Point, other: Point) -> int | None:
    """Return on which side of the quad two points of a polygon lie, None if on no common edge."""
    on = (side for a, b, side in edges(polygon) if is_on(one, a, b) and is_on(other, a, b))
    return next(on, None)


def between(a: Point, b: Point, share: float) -> Point:
    """Return the point at a fraction of the distance from a to b."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1])


def fraction_between(a: Point, b: Point, point: Point) -> float | None:
    """Return at which fraction from a to b a point lies; None if elsewhere."""
    d, gap = (b[0] - a[0], b[1] - a[1]), (point[0] - a[0], point[1] - a[1])
    length = hypot(*d)
    along = (d[0] * gap[0] + d[1] * gap[1]) / length
    return along / length if is_on(point, a, b) and AWAY < along < length - AWAY else None


@inline_or_plain
def is_on(point: Point, a: Point, b: Point) -> bool:
    """Return whether a point lies on the line through a and b."""
    d = b[0] - a[0], b[1] - a[1]
    height = abs((point[0] - a[0]) * d[1] - (point[1] - a[1]) * d[0])
    return height < AWAY * hypot(d[0], d[1])


def beyond(a: Point, b: Point) -> list[int]:
    """Return the corners of the quad to the right of the line from a to b, outside its film."""
    return [c for c in range(4) if _cross(a, b, CORNERS[c]) < -_SAME]


def film_beside(polygon: Polygon) -> Point:
    """Return a place that shows on which side of its flanks the film of a polygon lies.

    The mean of its points, but at least ``_CLEAR`` of the parametric square from the flanks, beyond
    the polygon of a sliver.
    """
    centre = np.add.reduce(polygon.points) / len(polygon.points)
    mid, inward, n = np.zeros(2), np.zeros(2), 0
    for a, b, side in edges(polygon):
        if side == FLANK:
            length = _distance(a, b)
            inward += (a[1] - b[1]) / length, (b[0] - a[0]) / length
            mid += 0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])
            n += 1
    size = float(np.hypot(*inward))
    if size >= _SAME:
        off = float(product(centre - mid / n, inward)) / size
        centre = centre + max(0.0, _CLEAR - off) / size * inward
    x, y = centre.tolist()
    return x, y


def divide(polygon: Polygon, start: Point, end: Point) -> tuple[Polygon, Polygon]:
    """Return the parts of a polygon to the right and to the left of a chord.

    Parameters
    ----------
    polygon : Polygon
        What is cut.
    start, end : Point
        On its boundary, not both on one edge of it.

    Raises
    ------
    ValueError
        If an end does not lie on the boundary, or both lie on one edge.
    """
    with_start, i = _with_point(polygon, start)
    both, j = _with_point(with_start, end)
    if len(both.points) > len(with_start.points) and j <= i:
        i += 1  # the end was put in before the start
    n = len(both.points)
    to_right, to_left = (j - i) % n, (i - j) % n
    if to_right < 2 or to_left < 2:
        raise ValueError(
            f"a chord must divide the polygon in two, the one from {start} to {end} runs along a "
            f"side of {polygon.points}"
        )
    right = [(i + k) % n for k in range(to_right + 1)]
    left = [(j + k) % n for k in range(to_left + 1)]
    return _loop(both, right), _loop(both, left)


def density(X: Floats) -> tuple[float, float, float]:
    """Return j_0, j_1, j_2 of J = j_0 + j_1 xi + j_2 eta for corner positions X : (4, 3) [mm²]."""
    p, q, h = product(_MODES, X).tolist()
    pq, ph, hq = _cross3(p, q), _cross3(p, h), _cross3(h, q)
    size = hypot(*pq)
    return size, _dot3(pq, ph) / size, _dot3(pq, hq) / size


def share_of(polygon: Polygon, J: tuple[float, float, float]) -> float:
    """Return which part of its quad's area a polygon covers, J as of :func:`density`."""
    a = polygon.points[0]
    total = 0.0
    for b, c in zip(polygon.points[1:], polygon.points[2:], strict=False):
        at = J[0] + J[1] * (a[0] + b[0] + c[0]) / 3.0 + J[2] * (a[1] + b[1] + c[1]) / 3.0
        total += 0.5 * _cross(a, b, c) * at
    return total / (4.0 * J[0])


def shape_slopes(point: Point) -> Floats:
    """Return the derivatives of the shape functions by xi and eta, shape (2, 4)."""
    xi, eta = point
    return np.array([slopes_by_xi(eta), slopes_by_eta(xi)])


def film_moments(polygon: Polygon) -> Floats:
    """Return ∫ N_a (1, xi, eta) over a polygon for the four shape functions, shape (4, 3).

    By six points of each triangle of a fan, exact for these polynomials of degree three.
    """
    points = np.array(polygon.points)
    a, b, c = points[0], points[1:-1], points[2:]
    (u, by_u), (v, by_v) = _LINE_POINTS
    u, v = 0.5 * (u[:, None] + 1.0), 0.5 * (v + 1.0)
    # u runs from a to the opposite side, v along that from b to c; the density is 2 A u.
    towards = (b - a)[:, None, None] + v[:, None] * (c - b)[:, None, None]
    at = a + u[..., None] * towards
    twice_area = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    weights = 0.25 * twice_area[:, None, None] * (u * by_u[:, None] * by_v)
    xi, eta = at[..., 0].ravel(), at[..., 1].ravel()
    N = 0.25 * np.array([(1.0 + x * xi) * (1.0 + y * eta) for x, y in CORNERS])
    weight = weights.ravel()
    return np.asarray(product(N, np.stack([weight, weight * xi, weight * eta], axis=1)))


def spans(polygon: Polygon) -> Floats:
    """Return from where to where a polygon lies on each side, two zeros if nowhere, (4, 2)."""
    return np.array([span(polygon, side) or (0.0, 0.0) for side in range(4)])


def _with_point(polygon: Polygon, point: Point) -> tuple[Polygon, int]:
    """Return the polygon with a point of its boundary among its points, and which it is."""
    for i, p in enumerate(polygon.points):
        if _distance(p, point) < _SAME:
            return polygon, i
    i = edge_at(polygon, point)
    if i < 0:
        raise ValueError(f"the end of a cut must lie on the polygon {polygon.points}, got {point}")
    points, sides = list(polygon.points), list(polygon.sides)
    points.insert(i + 1, point)
    sides.insert(i + 1, sides[i])
    return Polygon(tuple(points), tuple(sides)), i + 1


def _loop(polygon: Polygon, which: list[int]) -> Polygon:
    """Return the polygon of some of the points, closed by a flank."""
    sides = [polygon.sides[i] for i in which[:-1]]
    return Polygon(tuple(polygon.points[i] for i in which), (*sides, FLANK))


def _cross3(a: list[float], b: list[float]) -> list[float]:
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def _dot3(a: list[float], b: list[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _distance(a: Point, b: Point) -> float:
    return hypot(b[0] - a[0], b[1] - a[1])


def _cross(a: Point, b: Point, c: Point) -> float:
    """Return twice the signed area of a triangle."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
