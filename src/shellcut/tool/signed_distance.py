"""Signed distance of a point from a tool's surface.

The candidates are the triangles of the point's cell in a :class:`ClosestTriangleGrid`, sorted by
their distance d(c, T) from the cell's centre c; as d(p, T) >= d(c, T) - |p - c| a query stops
early.

Inside or outside is decided by the sign of (p - q) . n at the closest point q of the whole
surface, with n the angle-weighted pseudo-normal of the face, edge or vertex that q lies on
[Baerentzen2005]; the regions of a triangle are distinguished as in [Ericson2005], 5.1.5.

=======  =========================================
feature  of triangle (a, b, c)
=======  =========================================
0        its interior
1, 2, 3  its vertices a, b, c
4, 5, 6  its edges ab, bc, ca
=======  =========================================
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated, NamedTuple, TypeAlias

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import combine, dot, load, store, sub

# Of a height over a plane, far below any depth that counts [mm].
_ROUND_OFF = 1e-9

# Sine between planes that are taken to be no more parallel than this.
_LEAST_SINE = 1e-9

Cells3: TypeAlias = tuple[int, int, int]


class GridCells(NamedTuple):
    """Grid of cubic cells, z running fastest."""

    lower: Vec3
    """Least corner of the grid [mm]."""
    size: float
    """Side of a cell [mm]."""
    shape: Cells3
    """Number of cells along x, y, z."""


class CellLists(NamedTuple):
    """Candidate triangles of each cell."""

    start: Annotated[Ints, "(n_cell + 1,)"]
    """First entry of each cell, and the end."""
    triangle: Annotated[Ints, "(n_entry,)"]
    """Triangles of the cells, nearest to the cell's centre first."""
    distance: Annotated[Floats, "(n_entry,)"]
    """Their distances from the cell's centre [mm]."""


class TriangleSurface(NamedTuple):
    """The surface of a tool, one row per triangle."""

    corners: Annotated[Floats, "(n_triangle, 3, 3)"]
    """Corners [mm]."""
    flank: Annotated[SmallInts, "(n_triangle,)"]
    """The tool's flank labels."""
    planes: Annotated[Floats, "(n_triangle, 4, 4)"]
    """Unit normals n of four planes and their level n · x [mm]: that of the triangle and, upright
    on it, those of its edges ab, bc, ca, which face its interior."""
    pseudo_normals: Annotated[Floats, "(n_triangle, 7, 3)"]
    """Normals of each triangle's features, of any length."""


class TriangleGrid(NamedTuple):
    """Tables for a search; built by :mod:`shellcut.tool.closest_triangles`."""

    cells: GridCells
    lists: CellLists
    surface: TriangleSurface


@inline
def closest_on_triangle(p: Vec3, a: Vec3, b: Vec3, c: Vec3) -> tuple[Vec3, int]:
    """Return the point of triangle (a, b, c) closest to ``p`` [mm] and the feature it lies on."""
    ab = sub(b, a)
    ac = sub(c, a)
    ap = sub(p, a)
    d1 = dot(ab, ap)
    d2 = dot(ac, ap)
    if d1 <= 0.0 and d2 <= 0.0:
        return a, 1
    bp = sub(p, b)
    d3 = dot(ab, bp)
    d4 = dot(ac, bp)
    if d3 >= 0.0 and d4 <= d3:
        return b, 2
    vc = d1 * d4 - d3 * d2
    if vc <= 0.0 and d1 >= 0.0 and d3 <= 0.0:
        return combine(1.0, a, d1 / (d1 - d3), ab), 4
    cp = sub(p, c)
    d5 = dot(ab, cp)
    d6 = dot(ac, cp)
    if d6 >= 0.0 and d5 <= d6:
        return c, 3
    vb = d5 * d2 - d1 * d6
    if vb <= 0.0 and d2 >= 0.0 and d6 <= 0.0:
        return combine(1.0, a, d2 / (d2 - d6), ac), 6
    va = d3 * d6 - d5 * d4
    if va <= 0.0 and d4 >= d3 and d5 >= d6:
        return combine(1.0, b, (d4 - d3) / ((d4 - d3) + (d5 - d6)), sub(c, b)), 5
    whole = 1.0 / (va + vb + vc)
    return combine(1.0, combine(1.0, a, vb * whole, ab), vc * whole, ac), 0


@inline
def _over(p: Vec3, t: int, planes: Floats) -> tuple[float, float]:
    """Return the height of p over the plane of a triangle, and how far it is inside its edges [mm].

    No point of the triangle is closer than the height and, where p is outside, than that distance.
    """
    height = _above(p, t, 0, planes)
    within = min(_above(p, t, 1, planes), _above(p, t, 2, planes), _above(p, t, 3, planes))
    return height, within


@inline
def _at_least_away(p: Vec3, t: int, planes: Floats) -> float:
    """Return a distance than which no point of a triangle is closer [mm]."""
    height, within = _over(p, t, planes)
    beside = min(within, 0.0)
    return sqrt(height * height + beside * beside)


@inline
def _above(p: Vec3, t: int, k: int, planes: Floats) -> float:
    n = planes[t, k, 0], planes[t, k, 1], planes[t, k, 2]
    return dot(n, p) - float(planes[t, k, 3])


@inline
def _foot(
    p: Vec3, height: float, within: float, t: int, surface: TriangleSurface
) -> tuple[Vec3, int]:
    """Return :func:`closest_on_triangle` of a triangle for a point that is :func:`_over` it so."""
    if within > 0.0:
        planes = surface.planes
        n = planes[t, 0, 0], planes[t, 0, 1], planes[t, 0, 2]
        return combine(1.0, p, -height, n), 0
    x = surface.corners
    a, b = (x[t, 0, 0], x[t, 0, 1], x[t, 0, 2]), (x[t, 1, 0], x[t, 1, 1], x[t, 1, 2])
    return closest_on_triangle(p, a, b, (x[t, 2, 0], x[t, 2, 1], x[t, 2, 2]))


@inline
def cell_of(p: Vec3, cells: GridCells) -> tuple[bool, int]:
    """Return whether ``p`` [mm] lies in the grid, and its cell."""
    lower, shape = cells.lower, cells.shape
    u = (p[0] - lower[0]) / cells.size
    v = (p[1] - lower[1]) / cells.size
    w = (p[2] - lower[2]) / cells.size
    if not (0.0 <= u < shape[0] and 0.0 <= v < shape[1] and 0.0 <= w < shape[2]):
        return False, 0
    return True, (int(u) * shape[1] + int(v)) * shape[2] + int(w)


@inline
def at_least(p: Vec3, reach: float, cells: GridCells, empty_around: SmallInts) -> float:
    """Return a distance than which a point is no closer to the solid, where none is found [mm].

    reach : within which it would be [mm].  empty_around : cells from each to the next with a list.
    """
    lower, shape = cells.lower, cells.shape
    outside, cell = 0.0, 0
    for c in range(3):
        most = cells.size * shape[c]
        along = p[c] - lower[c]
        outside = max(outside, max(-along, along - most))
        cell = cell * shape[c] + min(max(int(along / cells.size), 0), shape[c] - 1)
    around: float = cells.size * (empty_around[cell] - 1)
    return max(outside, around) + reach


@inline
def _distance_from_centre(p: Vec3, cell: int, cells: GridCells) -> float:
    # of the cell, with a slack far above the round-off of cells and distances
    lower, cell_size, shape = cells.lower, cells.size, cells.shape
    ij = cell // shape[2]
    u = p[0] - lower[0] - cell_size * (ij // shape[1] + 0.5)
    v = p[1] - lower[1] - cell_size * (ij % shape[1] + 0.5)
    w = p[2] - lower[2] - cell_size * (cell % shape[2] + 0.5)
    return sqrt(u * u + v * v + w * w) + 1e-9 * cell_size


@inline
def closest_of_side(p: Vec3, side: int, grid: TriangleGrid) -> tuple[bool, int, int, Vec3]:
    """Return whether a triangle was found, the closest one of the side, its feature and point.

    p : in the body frame, [mm].  side : +1, -1 or 0 for triangles of flank >= 0, <= 0, all.
    If nothing is found: 0, 0 and ``p`` itself.
    """
    grid = borrowed(grid)
    cell_start, cell_triangles, cell_distance = grid.lists
    surface, flank = grid.surface, grid.surface.flank
    nearest = p
    triangle = 0
    feature = 0
    best = np.inf
    in_grid, cell = cell_of(p, grid.cells)
    if not in_grid:
        return False, triangle, feature, nearest
    off_centre = _distance_from_centre(p, cell, grid.cells)
    for k in range(cell_start[cell], cell_start[cell + 1]):
        # The list ascends by the distance from the centre: no later triangle can be closer than
        # this.
        least = cell_distance[k] - off_centre
        if least > 0.0 and least * least > best:
            break
        t = cell_triangles[k]
        if side * flank[t] < 0:
            continue
        # Most triangles are seen to be farther from their planes alone.
        height, within = _over(p, t, surface.planes)
        beside = min(within, 0.0)
        squared = height * height + beside * beside
        if squared >= best:
            continue
        q, where = _foot(p, height, within, t, surface)
        gap = sub(p, q)
        squared = dot(gap, gap)
        if squared < best:
            best = squared
            nearest = q
            triangle = t
            feature = where
    return best < np.inf, triangle, feature, nearest


@inline
def closest_of_solid(p: Vec3, grid: TriangleGrid) -> tuple[bool, bool, int, Vec3]:
    """Return whether ``p`` is near, whether inside the solid, the closest triangle, its point."""
    grid = borrowed(grid)
    found, triangle, i, nearest = closest_of_side(p, 0, grid)
    if not found:
        return False, False, 0, p
    # The pseudo-normal of the feature gives the side also at edges and vertices [Baerentzen2005].
    normal = load(grid.surface.pseudo_normals[triangle], i)
    return True, dot(sub(p, nearest), normal) < 0.0, triangle, nearest


@inline
def signed_distance(p: Vec3, side: int, grid: TriangleGrid) -> tuple[bool, bool, int, Vec3, int]:
    """Return whether ``p`` is near, whether inside the solid, and the closest triangle of the side.

    p : in the body frame, [mm].  side : +1, -1 or 0 for triangles of flank >= 0, <= 0, all.

    ``inside`` uses all triangles; the returned triangle and its closest point are of the side. A
    point on the surface is outside. If nothing is found: False, triangle 0, ``p``. The last is the
    closest triangle of all.
    """
    grid = borrowed(grid)
    found, inside, whole, nearest = closest_of_solid(p, grid)
    triangle = whole
    if found and side * grid.surface.flank[whole] < 0:
        found, triangle, _, nearest = closest_of_side(p, side, grid)
    return found, inside, triangle, nearest, whole


@inline
def ball_clearance(
    z: Vec3, radius: float, p: Vec3, one: int, two: int, side: int, grid: TriangleGrid
) -> float:
    """Return how far a ball may roll along one or two faces and touch no other [mm].

    z : its centre, in the body frame, ``radius`` deep under the triangles ``one`` and ``two``,
    which may be the same.  p : the point that it rounds, no farther from z than that, which may not
    come out through a face of the other side.  side : +1, -1 or 0 for triangles of flank >= 0,
    <= 0, all.

    A triangle in the plane of such a face, or above it, is no closer to the centre than the face.
    On one face the centre moves along its plane, so its depth under another plane changes by the
    sine of the angle between both.
    """
    grid = borrowed(grid)
    cell_start, cell_triangles, cell_distance = grid.lists
    surface, planes = grid.surface, grid.surface.planes
    in_grid, cell = cell_of(z, grid.cells)
    if not in_grid:
        return 0.0
    off_centre = _distance_from_centre(z, cell, grid.cells)
    free = min(_over(z, one, planes)[1], _over(z, two, planes)[1])
    free = min(free, _unlisted(cell, side, off_centre, grid) - radius)
    # The point stays over the face that is closest to it, and not over a concave edge of that.
    (above_one, within_one), (above_two, within_two) = _over(p, one, planes), _over(p, two, planes)
    free = min(free, within_one, max(within_two, 0.5 * (above_one - above_two)))
    for k in range(cell_start[cell], cell_start[cell + 1]):
        if cell_distance[k] - off_centre - radius > free:
            break
        t = cell_triangles[k]
        if t in (one, two):
            continue
        if side * surface.flank[t] < 0:
            free = min(free, _at_least_away(p, t, planes))
            continue
        height = _above(z, t, 0, planes)
        clear = _at_least_away(z, t, planes) - radius
        if one == two and -height > radius:
            sine = max(_sine_between(t, one, planes), _LEAST_SINE)
            clear = max(clear, (-height - radius) / sine)
        if clear < free and not (_is_above(t, one, surface) or _is_above(t, two, surface)):
            free = clear
    return free


@inline
def clear_before_plane(p: Vec3, q: Vec3, grid: TriangleGrid) -> float:
    """Return how far a point outside may move in front of a plane and touch nothing [mm].

    The plane lies at the closest point of the surface, square to the line from there to p.
    Triangles that are nowhere in front of it are not met.

    p, q : the point and the closest one, in the body frame [mm].
    """
    grid = borrowed(grid)
    cell_start, cell_triangles, cell_distance = grid.lists
    x, gap = grid.surface.corners, sub(p, q)
    away = sqrt(dot(gap, gap))
    in_grid, cell = cell_of(p, grid.cells)
    if not in_grid or away == 0.0:
        return 0.0
    off_centre = _distance_from_centre(p, cell, grid.cells)
    free, level = _unlisted(cell, 0, off_centre, grid), dot(gap, q) + _ROUND_OFF * away
    for k in range(cell_start[cell], cell_start[cell + 1]):
        if cell_distance[k] - off_centre > free:
            break
        t = cell_triangles[k]
        for a in range(3):
            if dot(gap, load(x[t], a)) > level:
                free = min(free, _at_least_away(p, t, grid.surface.planes))
                break
    return free


@inline
def _unlisted(cell: int, side: int, off_centre: float, grid: TriangleGrid) -> float:
    """Return how far triangles of the side that a cell does not list are away at least [mm].

    From a point that is ``off_centre`` from its centre. The cell lists all that is closer to that
    than the closest of the side and its diagonal.
    """
    cell_start, cell_triangles, cell_distance = grid.lists
    for k in range(cell_start[cell], cell_start[cell + 1]):
        if side * grid.surface.flank[cell_triangles[k]] >= 0:
            return float(cell_distance[k]) + sqrt(3.0) * grid.cells.size - off_centre
    return 0.0


@inline
def _sine_between(t: int, other: int, planes: Floats) -> float:
    """Return the sine of the angle between the planes of two triangles."""
    cosine = dot(load(planes[t], 0), load(planes[other], 0))
    return sqrt(max(1.0 - cosine * cosine, 0.0))


@inline
def _is_above(t: int, other: int, surface: TriangleSurface) -> bool:
    """Return whether a triangle lies in the plane of another, or above it."""
    least = np.inf
    for a in range(3):
        least = min(least, _above(load(surface.corners[t], a), other, 0, surface.planes))
    return least > -_ROUND_OFF


@kernel
def query_points(
    x: Floats,
    side: int,
    grid: TriangleGrid,
    found: Bools,
    inside: Bools,
    triangle: Ints,
    closest: Floats,
) -> None:
    """Write ``signed_distance`` of the points x : (n_point, 3), [mm], to the last four arrays."""
    grid = borrowed(grid)
    for n in range(x.shape[0]):
        p = (x[n, 0], x[n, 1], x[n, 2])
        found[n], inside[n], triangle[n], q, _ = signed_distance(p, side, grid)
        store(closest, n, q)
