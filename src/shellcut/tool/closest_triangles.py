"""Closest point of a tool's surface: a uniform grid of candidate triangles in the body frame.

Each cell lists every triangle that can be the closest one to some point of the cell, within each
of three classes: all triangles, those with flank >= 0, those with flank <= 0. With centre c and
diagonal D of the cell, any point p of it has |p - c| <= D/2, so a triangle T with

    d(c, T) > min over the class of d(c, .) + D

is never the closest of its class. Halving the cells level by level keeps the guarantee, since a
child's points are its parent's, and makes the build cheap: a child only searches its parent's list.
A list is sorted by d(c, T).

The grid is built here; :mod:`shellcut.tool.signed_distance` searches points in it.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from math import ceil, log2, sqrt
from weakref import WeakKeyDictionary

import numpy as np
import numpy.typing as npt
import scipy

from shellcut.arrays import Bools, Floats, Ints, Numbers, SmallInts, Vec3, angles, unit
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import dot, sub

from .signed_distance import (
    CellLists,
    Cells3,
    GridCells,
    TriangleGrid,
    TriangleSurface,
    closest_on_triangle,
    query_points,
)
from .tool import Tool

CELLS_PER_THICKNESS = 3.0
"""Cells across the mean thickness 2 V / A of the thinnest body. A ring of 4,112 triangles: 4 or 2
instead of 3 change a query by -4 or +17 %, the build by +70 or -40 %."""

REACH, REACH_HALF_THICKNESS = 0.05, 0.20472408083310684
"""Points outside the default ring of teeth, whose V / A is the second number [mm], are found within
the first [mm]; in proportion for other tools. Less than a cell, so few more cells have lists."""

ROUND_OFF = 1e-9
"""Relative slack of the distances compared in the build, far above round-off."""

MOST_CELLS = 2_000_000
"""The cells are enlarged until there are at most this many."""

COARSEST_CELLS = 4
"""Halving starts with about this many cells along the longest side."""


@dataclass(frozen=True, eq=False, repr=False)
class ClosestTriangleGrid:
    """Candidate triangles by cell, in the tool's body frame; read-only."""

    arrays: TriangleGrid
    """The tables for kernels."""
    reach: float
    """Points up to this far outside the surface are found [mm]."""

    def __post_init__(self) -> None:
        for array in (*self.arrays.lists, *self.arrays.surface):
            array.flags.writeable = False

    @cached_property
    def empty_around(self) -> SmallInts:
        """Cells from each to the next one with a list, 127 at most, (n_cell,); for `at_least`."""
        cells, lists, _ = self.arrays
        empty = np.diff(lists.start).reshape(cells.shape) == 0
        steps = scipy.ndimage.distance_transform_cdt(empty, "chessboard")
        if not lists.triangle.size:
            steps = np.zeros(cells.shape)
        return np.asarray(np.minimum(steps, 127).astype(np.int8).ravel())

    @classmethod
    def of(cls, tool: Tool | None) -> ClosestTriangleGrid:
        """Return the grid of a tool built once per tool.

        Without a tool the grid has no cells: nothing is near it.
        """
        if tool is None:
            cells = GridCells(lower=(0.0, 0.0, 0.0), size=1.0, shape=(0, 0, 0))
            lists = CellLists(np.zeros(1, np.int64), np.zeros(0, np.int64), np.zeros(0))
            tables = (np.zeros((0, *shape)) for shape in ((3, 3), (4, 4), (7, 3)))
            corners, planes, pseudo_normals = tables
            surface = TriangleSurface(corners, np.zeros(0, np.int8), planes, pseudo_normals)
            return cls(TriangleGrid(cells, lists, surface), reach=0.0)
        grid = _BUILT.get(tool)
        if grid is None:
            grid = _BUILT[tool] = cls.build(tool)
        return grid

    @classmethod
    def build(cls, tool: Tool) -> ClosestTriangleGrid:
        """Build the grid of a tool.

        Every point inside the solid or within the reach of its surface is found; points farther
        outside may or may not be found.
        """
        half = tool.half_thickness()
        reach = REACH * (half / REACH_HALF_THICKNESS)
        cells = _cells_around(tool, reach, 2.0 * half / CELLS_PER_THICKNESS)
        surface = TriangleSurface(
            corners=tool.vertices[tool.triangles],
            flank=tool.flank,
            planes=_planes(tool),
            pseudo_normals=_pseudo_normals(tool),
        )
        return cls(TriangleGrid(cells, _fill(cells, surface, reach), surface), reach)

    def query(self, points: npt.ArrayLike, side: int = 0) -> tuple[Bools, Bools, Ints, Floats]:
        """Return :func:`signed_distance` of many points in the body frame.

        Of points, (n_point, 3), [mm], whether each is found and inside, (n_point,), and the closest
        triangle of the side and its closest point, (n_point, 3), [mm]; 0 and the point itself if
        none is found. Side +1 is of triangles with flank >= 0, -1 of those with flank <= 0, 0 of
        all.
        """
        x = np.array(points, dtype=np.float64, order="C", ndmin=2)
        if x.ndim != 2 or x.shape[1] != 3:
            raise ValueError(f"points must have shape (n_point, 3), got {x.shape}")
        if side not in (-1, 0, 1):
            raise ValueError(f"side must be -1, 0 or +1, got {side}")
        found = np.zeros(x.shape[0], dtype=np.bool_)
        inside = np.zeros(x.shape[0], dtype=np.bool_)
        triangle = np.zeros(x.shape[0], dtype=np.int64)
        closest = np.zeros_like(x)
        query_points(x, side, self.arrays, found, inside, triangle, closest)
        return found, inside, triangle, closest


_BUILT: WeakKeyDictionary[Tool, ClosestTriangleGrid] = WeakKeyDictionary()
"""Grids by tool: building a grid for many triangles costs seconds."""


@kernel
def _refine(
    cells: GridCells,
    parent_lists: CellLists,
    parents: Cells3,
    shift: int,
    reach: float,
    surface: TriangleSurface,
) -> tuple[Ints, Ints, Floats]:
    """Return the lists of a level (start, triangles, distances) from those of its parents.

    Cell (i, j, k) has the parent (i, j, k) >> shift. A cell that contains no point of the solid and
    none within ``reach`` of its surface gets an empty list; so does a child of an empty parent.
    """
    lower, cell_size, shape = cells.lower, cells.size, cells.shape
    parent_start, parent_triangles = parent_lists.start, parent_lists.triangle
    slack = 1.0 + ROUND_OFF
    diagonal = sqrt(3.0) * cell_size
    longest = 0
    for cell in range(parent_start.size - 1):
        longest = max(longest, parent_start[cell + 1] - parent_start[cell])
    separation = np.empty(longest)
    cell_start = np.zeros(shape[0] * shape[1] * shape[2] + 1, dtype=np.int64)
    entries = np.empty(4 * parent_triangles.size + 64, dtype=np.int64)
    distance = np.empty(entries.size)
    n_entry = 0
    for cell in range(cell_start.size - 1):
        ij = cell // shape[2]
        i, j, k = ij // shape[1], ij % shape[1], cell % shape[2]
        parent = ((i >> shift) * parents[1] + (j >> shift)) * parents[2] + (k >> shift)
        candidates = parent_triangles[parent_start[parent] : parent_start[parent + 1]]
        if candidates.size > 0:
            centre = (
                lower[0] + cell_size * (i + 0.5),
                lower[1] + cell_size * (j + 0.5),
                lower[2] + cell_size * (k + 0.5),
            )
            least, least_plus, least_minus, height = _separations(
                centre, candidates, surface, separation
            )
            if height < 0.0 or least <= slack * (reach + 0.5 * diagonal):
                if n_entry + candidates.size > entries.size:
                    grown = 2 * entries.size + candidates.size
                    entries = _grown(entries, n_entry, grown)
                    distance = _grown(distance, n_entry, grown)
                bound_plus = slack * (least_plus + diagonal)
                bound_minus = slack * (least_minus + diagonal)
                for m in range(candidates.size):
                    t, d = candidates[m], separation[m]
                    if (surface.flank[t] >= 0 and d <= bound_plus) or (
                        surface.flank[t] <= 0 and d <= bound_minus
                    ):
                        entries[n_entry] = t
                        distance[n_entry] = d
                        n_entry += 1
        cell_start[cell + 1] = n_entry
    return cell_start, entries[:n_entry].copy(), distance[:n_entry].copy()


@inline
def _separations(
    centre: Vec3, candidates: Ints, surface: TriangleSurface, separation: Floats
) -> tuple[float, float, float, float]:
    """Write the distances of some triangles from a point to separation : (n,).

    Returns the smallest distance of all, of those with flank >= 0 and of those with flank <= 0, and
    the signed distance of the point from the surface (negative inside) times the length of the
    pseudo-normal.
    """
    corners, flank, pseudo_normals = surface.corners, surface.flank, surface.pseudo_normals
    least = least_plus = least_minus = np.inf
    height = 0.0
    for m in range(candidates.size):
        t = candidates[m]
        q, feature = closest_on_triangle(
            centre,
            (corners[t, 0, 0], corners[t, 0, 1], corners[t, 0, 2]),
            (corners[t, 1, 0], corners[t, 1, 1], corners[t, 1, 2]),
            (corners[t, 2, 0], corners[t, 2, 1], corners[t, 2, 2]),
        )
        away = sub(centre, q)
        d = sqrt(dot(away, away))
        separation[m] = d
        if d < least:
            least = d
            normal = (
                pseudo_normals[t, feature, 0],
                pseudo_normals[t, feature, 1],
                pseudo_normals[t, feature, 2],
            )
            height = dot(away, normal)
        if flank[t] >= 0:
            least_plus = min(least_plus, d)
        if flank[t] <= 0:
            least_minus = min(least_minus, d)
    return least, least_plus, least_minus, height


@inline
def _grown(rows: Numbers, n: int, size: int) -> Numbers:
    """Return a longer copy of the first n numbers."""
    more = np.empty(size, rows.dtype)
    for m in range(n):  # a slice would have its error messages compiled, for seconds
        more[m] = rows[m]
    return more


def _cells_around(tool: Tool, reach: float, size: float) -> GridCells:
    """Return cells of this size [mm] around a tool and its reach, enlarged until few enough."""
    low, high = tool.bounding_box()
    extent = high - low + 2.0 * reach
    lower = float(low[0]) - reach, float(low[1]) - reach, float(low[2]) - reach
    while True:
        shape = ceil(extent[0] / size), ceil(extent[1] / size), ceil(extent[2] / size)
        if shape[0] * shape[1] * shape[2] <= MOST_CELLS:
            return GridCells(lower=lower, size=size, shape=shape)
        size *= 1.05


def _fill(finest: GridCells, surface: TriangleSurface, reach: float) -> CellLists:
    """Return the lists of the finest cells, found level by level from coarse ones."""
    shape, n_triangle = finest.shape, len(surface.corners)
    # one cell with all triangles is the parent of the coarsest level
    lists = CellLists(
        start=np.array([0, n_triangle], dtype=np.int64),
        triangle=np.arange(n_triangle, dtype=np.int64),
        distance=np.zeros(n_triangle),
    )
    parents = (1, 1, 1)
    shift = 62  # i >> 62 is 0: all coarsest cells share the one parent
    for level in range(max(0, ceil(log2(max(shape) / COARSEST_CELLS))), -1, -1):
        width = 2**level
        some = (-(-shape[0] // width), -(-shape[1] // width), -(-shape[2] // width))
        cells = GridCells(lower=finest.lower, size=finest.size * width, shape=some)
        lists = CellLists(*_refine(cells, lists, parents, shift, reach, surface))
        parents, shift = some, 1
    cell = np.repeat(np.arange(lists.start.size - 1), np.diff(lists.start))
    order = np.lexsort((lists.distance, cell))  # stable: equal distances stay by triangle
    return lists._replace(triangle=lists.triangle[order], distance=lists.distance[order])


def _planes(tool: Tool) -> Floats:
    # (n_triangle, 4, 4): see TriangleSurface.
    corners = tool.vertices[tool.triangles]
    along = np.roll(corners, -1, axis=1) - corners
    inward = unit(np.cross(tool.triangle_normals[:, None], along))
    planes = np.empty((tool.n_triangle, 4, 4))
    planes[:, 0, :3], planes[:, 1:, :3] = tool.triangle_normals, inward
    planes[:, 0, 3] = (tool.triangle_normals * corners[:, 0]).sum(axis=1)
    planes[:, 1:, 3] = (inward * corners).sum(axis=2)
    return planes


def _pseudo_normals(tool: Tool) -> Floats:
    # (n_triangle, 7, 3) by feature: the face's normal; at a vertex the sum of the normals of its
    # faces weighted by their angles there; at an edge the sum of its two faces' normals.
    triangles, normals = tool.triangles, tool.triangle_normals
    corners = tool.vertices[triangles]
    to_next = np.roll(corners, -1, axis=1) - corners
    to_last = np.roll(corners, 1, axis=1) - corners
    angle = angles(to_next, to_last)
    at_vertex = np.zeros_like(tool.vertices)
    np.add.at(at_vertex, triangles, angle[:, :, None] * normals[:, None, :])

    start, end = triangles, np.roll(triangles, -1, axis=1)
    key = np.minimum(start, end) * tool.n_vertex + np.maximum(start, end)
    _, row = np.unique(key.ravel(), return_inverse=True)
    at_edge = np.zeros((row.max() + 1, 3))
    np.add.at(at_edge, row, np.repeat(normals, 3, axis=0))

    table = np.empty((tool.n_triangle, 7, 3))
    table[:, 0] = normals
    table[:, 1:4] = at_vertex[triangles]
    table[:, 4:7] = at_edge[row].reshape(-1, 3, 3)
    return table
