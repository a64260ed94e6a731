"""A frame as one unstructured grid with named arrays, as stored in result files.

docs/howto/read-results.md lists the parts, the values of the cell array ``part``, and all arrays.
Points are the nodes in their deformed positions, so that the crack opens without a filter; then the
ends of the cables' branches, two per segment; the vertices of the tool; the ends of the segments of
the cutting edges, two per segment. A "/" in a unit becomes "per", because HDF5 reads it as a path.
Rounding to 12 bits halves the packed size of arrays.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.frame import ROWS, SIZED_BY, Frame, Rows, is_corner

MEMBRANE, CABLE, TOOL, FLANK, EDGE = range(5)
"""Values of the cell array ``part``."""

LINE, TRIANGLE, POLYGON, QUAD = 3, 5, 7, 9
"""VTK's numbers of cell types."""

KEPT_BITS = 12
"""Mantissa bits kept out of the 23 of a single, for all floating-point arrays except points."""

_KEPT_AS = {np.float64: np.float32, np.bool_: np.uint8, np.int8: np.uint8, np.int64: np.uint16}
"""Type of an array in a file by the type of its field."""


def _tables(of_points: bool) -> dict[str, tuple[Any, tuple[int, ...]]]:
    return {
        array: (_KEPT_AS[rows.dtype], rows.shape if len(rows.arrays) == 1 else ())
        for rows in ROWS.values()
        for array in rows.arrays
        if (rows.of == "node") == of_points
    }


_DISPLACEMENT = "displacement [mm]"

POINT_ARRAYS = {_DISPLACEMENT: (np.float32, (3,))} | _tables(of_points=True)
"""Type and row shape of each array on the points; these belong to the nodes."""

CELL_ARRAYS = {"part": (np.uint8, ())} | _tables(of_points=False)
"""Type and row shape of each array on the cells of every frame."""

# Start of the names of history arrays of the material, one number per cell.
_HISTORY = "history, "


def is_history(name: str) -> bool:
    """Whether an array on the cells contains a history variable of the material."""
    return name.startswith(_HISTORY)


class Counts(NamedTuple):
    """Number of each entity in a frame, which the grid's arrays alone do not tell."""

    node: int
    quad: int
    segment: int
    vertex: int
    triangle: int
    crack: int
    edge: int

    @classmethod
    def of(cls, frame: Frame) -> Counts:
        """Count the entities of a frame."""
        return cls(**{entity: len(getattr(frame, array)) for entity, array in SIZED_BY.items()})

    def rows(self, entity: str) -> slice:
        """Return the rows of an entity's arrays: on points for nodes, else on cells."""
        if entity == "node":
            return slice(0, self.node)
        part = ("quad", "segment", "triangle", "crack", "edge").index(entity)
        return slice((0, *self.cells)[part], self.cells[part])

    @property
    def points(self) -> tuple[int, ...]:
        """End indices of nodes, cable ends, vertices and edge ends among the points."""
        return _ends(self.node, 2 * self.segment, self.vertex, 2 * self.edge)

    @property
    def cells(self) -> tuple[int, ...]:
        """End indices of parts 0 to 4 among the cells."""
        return _ends(self.quad, self.segment, self.triangle, 2 * self.crack, self.edge)


Arrays: TypeAlias = dict[str, Any]
"""Arrays by the names of their columns in a file."""


def grid_of(frame: Frame) -> tuple[Counts, Floats, Arrays, Arrays, Arrays]:
    """Return a frame as one unstructured grid; the module's tables list its arrays.

    Counts; points (n_point, 3), [mm]; cells by VTK's numbers of their types, the ids of their
    points, cell after cell, and where in these each begins and the last one ends; arrays on the
    points, and on the cells.
    """
    n = Counts.of(frame)
    first_cable, first_vertex, first_end, _ = n.points
    own = is_corner(frame.quads)
    corners = own.sum(axis=1)
    connectivity = np.concatenate(
        (
            frame.quads[own],
            np.arange(first_cable, first_vertex),
            frame.tool_triangles.ravel() + first_vertex,
            frame.crack_edges.ravel(),
            np.arange(first_end, first_end + 2 * n.edge),
        )
    )
    counts = (n.quad, n.segment, n.triangle, 2 * n.crack, n.edge)
    types = np.repeat(np.array([QUAD, LINE, TRIANGLE, LINE, LINE], dtype=np.uint8), counts)
    types[: n.quad][corners != 4] = POLYGON
    sizes = np.repeat((4, 2, 3, 2, 2), counts)
    sizes[: n.quad] = corners
    points = np.concatenate(
        (
            frame.points,
            frame.cable_segments.reshape(-1, 3),
            frame.tool_points,
            frame.edge_points.reshape(-1, 3),
        )
    )
    on_points = _arrays(POINT_ARRAYS, n.points[-1], frame, n)
    on_points[_DISPLACEMENT][: n.node] = _rounded(frame.displacement)
    on_cells = _arrays(CELL_ARRAYS, n.cells[-1], frame, n)
    on_cells["part"][:] = np.repeat(np.arange(len(counts)), counts)
    for name, numbers in frame.quad_history.items():
        on_cells[_HISTORY + name] = np.zeros(n.cells[-1], np.float32)
        on_cells[_HISTORY + name][n.rows("quad")] = _rounded(numbers)
    offsets = np.append(0, np.cumsum(sizes))
    cells = {"Types": types, "Offsets": offsets, "Connectivity": connectivity}
    return n, points, cells, on_points, on_cells


def frame_of(counts: Counts, grid: Arrays, arrays: Arrays, **others: Any) -> Frame:
    """Return the frame of a grid, from its points and cells and from all its arrays.

    ``others`` are the fields of :class:`Frame` that a grid lacks: time, coordinate, scalars, pose.
    """
    n = counts
    points = np.asarray(grid["Points"], float)
    nodes, cable_ends, vertices, edge_ends = np.split(points, n.points[:-1])
    corners = np.diff(grid["Offsets"][: n.quad + 1])
    row_ends = _ends(int(corners.sum()), 2 * n.segment, 3 * n.triangle, 4 * n.crack)
    quads, _, triangles, flanks, _ = np.split(np.asarray(grid["Connectivity"], np.int64), row_ends)
    fields = {
        name: _field_of(rows, arrays, n.rows(rows.of))
        for name, rows in ROWS.items()
        if rows.arrays and all(array in arrays for array in rows.arrays)
    }
    fields["quad_history"] = {
        name.removeprefix(_HISTORY): numbers[n.rows("quad")]
        for name, numbers in arrays.items()
        if is_history(name)
    }
    return Frame(
        points=nodes,
        reference=nodes - arrays[_DISPLACEMENT][: n.node],
        quads=_padded(quads, corners),
        crack_edges=flanks.reshape(-1, 2, 2),
        cable_segments=cable_ends.reshape(-1, 2, 3),
        tool_points=vertices,
        tool_triangles=triangles.reshape(-1, 3) - n.points[1],
        edge_points=edge_ends.reshape(-1, 2, 3),
        **fields,
        **others,
    )


def _padded(ids: Ints, corners: Ints) -> Ints:
    """Return the ids of polygons in rows; those with fewer corners repeat their last one."""
    first = np.cumsum(corners) - corners
    column = np.arange(corners.max(initial=4))
    return np.asarray(ids[first[:, None] + np.minimum(column, corners[:, None] - 1)])


def _field_of(rows: Rows, arrays: Mapping[str, Any], some: slice) -> Any:
    """Return one field of a frame from its arrays in the file."""
    columns = [arrays[name][some] for name in rows.arrays]
    values = columns[0] if len(columns) == 1 else np.stack(columns, axis=1)
    return values.astype(rows.dtype)


def series_of(frame: Frame) -> dict[str, float]:
    """Return time, coordinate and scalars of a frame by the names of their arrays."""
    return {
        "time [s]": frame.time,
        array_name(frame.coordinate_name, frame.coordinate_unit): frame.coordinate,
        **{array_name(name, frame.scalar_units[name]): v for name, v in frame.scalars.items()},
    }


def array_name(name: str, unit: str) -> str:
    """Return the name of an array: ``speed [mm per s]``."""
    return f"{name} [{unit}]".replace("/", " per ")


def _ends(*counts: int) -> tuple[int, ...]:
    return tuple(np.cumsum(counts).tolist())


def _arrays(
    table: Mapping[str, tuple[Any, tuple[int, ...]]], count: int, frame: Frame, n: Counts
) -> dict[str, Any]:
    """Return the arrays of a table with the fields of a frame, zero where they do not apply."""
    arrays = {name: np.zeros((count, *shape), dtype) for name, (dtype, shape) in table.items()}
    for name, rows in ROWS.items():
        values = getattr(frame, name)
        if rows.dtype is np.float64:
            values = _rounded(values)
        for column, array in enumerate(rows.arrays):
            if array in arrays:
                one = values if len(rows.arrays) == 1 else values[:, column]
                arrays[array][n.rows(rows.of)] = one
    return arrays


def _rounded(values: Floats) -> Any:
    # Round to nearest on the bits of the single: add half of the last kept bit, cut off the rest.
    dropped = 23 - KEPT_BITS
    bits = values.astype(np.float32).view(np.int32)
    return ((bits + (1 << (dropped - 1))) & -(1 << dropped)).view(np.float32)
