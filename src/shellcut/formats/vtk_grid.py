"""Content of a VTK file, in one form for its formats, and as a mesh."""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats, Ints, Numbers

from .errors import FileError, named
from .file_mesh import LINE, POINT, QUAD, TRIANGLE, CellBlock, FileMesh
from .losses import unused_note

# VTK's cell types: kind, and number of nodes, 0 for any.
_TYPES = {
    **{1: (POINT, 1), 3: (LINE, 2), 5: (TRIANGLE, 3), 9: (QUAD, 4), 21: ("line3", 3)},
    **{22: ("triangle6", 6), 23: ("quad8", 8), 28: ("quad9", 9), 10: ("tetra", 4)},
    **{12: ("hexahedron", 8), 13: ("wedge", 6), 14: ("pyramid", 5), 2: ("points", 0)},
    **{4: ("polyline", 0), 6: ("triangle strip", 0), 7: ("polygon", 0), 42: ("polyhedron", 0)},
    **{24: ("tetra10", 10), 25: ("hexahedron20", 20)},
}
_PIXEL = 8  # a quad whose last two corners are swapped
_QUADRATIC = {"line3": LINE, "triangle6": TRIANGLE, "quad8": QUAD, "quad9": QUAD}
# points, lines and polygons of as many nodes are these types
_OF_N_NODE = {(2, 1): 1, (4, 2): 3, (7, 3): 5, (7, 4): 9}
_FEW = 3  # up to this many values other than 0 and 1 look like slips
_MOST_VALUES = 64  # an array with more distinct values is data, not a group


@dataclass
class VtkGrid:
    """Points and cells of a file, or of a piece of it."""

    points: Floats
    """Shape (n_point, 3)."""
    types: Ints
    """VTK's numbers of the cell types, shape (n_cell,)."""
    ends: Ints
    """Where the nodes of each cell end in ``nodes``, shape (n_cell,)."""
    nodes: Ints
    """Point numbers of all cells, one after the other."""
    point_data: dict[str, Numbers] = field(default_factory=dict)
    """Arrays by name, the first axis along the points."""
    cell_data: dict[str, Numbers] = field(default_factory=dict)
    unused: dict[str, int] = field(default_factory=dict)
    """What the reader passed over, with its number."""


def mesh_of(path: Path, grid: VtkGrid) -> FileMesh:
    """Return the mesh: cells by kind, and integer arrays as groups.

    Raises
    ------
    FileError
        If cells name missing points, or have other numbers of nodes than their type, or arrays
        have other numbers of rows.
    """
    n_point, n_cell = len(grid.points), len(grid.types)
    if len(grid.ends) != n_cell:
        raise FileError(path, f"{n_cell} types of cells are given, but {len(grid.ends)} cells")
    for data, n, what in ((grid.point_data, n_point, "point"), (grid.cell_data, n_cell, "cell")):
        if lost := [f"{name!r} has {len(v)}" for name, v in data.items() if len(v) != n]:
            raise FileError(path, f"arrays must have {n} rows, one per {what}, but {named(lost)}")
    n_node = np.diff(grid.ends, prepend=0)
    if n_cell and (n_node.min() < 0 or grid.ends[-1] != len(grid.nodes)):
        raise FileError(path, "the offsets of cells must ascend to the number of their nodes")
    types = grid.types.copy()
    for (kind, n), plain in _OF_N_NODE.items():
        types[(types == kind) & (n_node == n)] = plain
    starts = grid.ends - n_node
    order = np.argsort(types, kind="stable")
    kinds, first = np.unique(types[order], return_index=True)
    blocks = []
    for kind, rows in zip(kinds.tolist(), np.split(order, first[1:]), strict=False):
        name, n = (QUAD, 4) if kind == _PIXEL else _TYPES.get(kind, (f"VTK type {kind}", 0))
        if n and (n_node[rows] != n).any():
            raise FileError(path, f"{name} cells must have {n} nodes, got {n_node[rows].tolist()}")
        nodes = np.empty((len(rows), 0), np.int64)
        if name in (POINT, LINE, TRIANGLE, QUAD, *_QUADRATIC):
            nodes = grid.nodes[starts[rows, None] + np.arange(n)]
            if len(nodes) and not 0 <= nodes.min() <= nodes.max() < n_point:
                raise FileError(path, f"{name} cells must name existing points")
            if kind == _PIXEL:
                nodes = nodes[:, [0, 1, 3, 2]]
        blocks.append(CellBlock(name, rows, nodes, _QUADRATIC.get(name, "")))
    notes: list[str] = []
    unused = dict(grid.unused)
    of_cells = {name: values[order] for name, values in grid.cell_data.items()}
    mesh = FileMesh(
        path,
        grid.points,
        range(n_point),
        blocks,
        _groups(grid.point_data, notes, unused),
        _groups(of_cells, notes, unused),
        notes,
    )
    mesh.notes += unused_note(unused)
    return mesh


def joined(path: Path, pieces: list[VtkGrid]) -> VtkGrid:
    """Return one grid of the pieces of a file; arrays that some pieces lack are not used."""
    if not pieces:
        raise FileError(path, "there must be a grid, got none")
    if len(pieces) == 1:
        return pieces[0]
    first_point = np.cumsum([0, *(len(piece.points) for piece in pieces)])
    first_node = np.cumsum([0, *(len(piece.nodes) for piece in pieces)])

    unused = {name: n for piece in pieces for name, n in piece.unused.items()}

    def common(of_pieces: list[dict[str, Numbers]]) -> dict[str, Numbers]:
        n_piece = Counter(name for arrays in of_pieces for name in arrays)
        unused.update({f"array {name!r}": n for name, n in n_piece.items() if n < len(pieces)})
        names = [name for name, n in n_piece.items() if n == len(pieces)]
        return {n: np.concatenate([arrays[n] for arrays in of_pieces]) for n in names}

    return VtkGrid(
        np.concatenate([piece.points for piece in pieces]),
        np.concatenate([piece.types for piece in pieces]),
        np.concatenate([p.ends + k for p, k in zip(pieces, first_node, strict=False)]),
        np.concatenate([p.nodes + k for p, k in zip(pieces, first_point, strict=False)]),
        common([piece.point_data for piece in pieces]),
        common([piece.cell_data for piece in pieces]),
        unused,
    )


def stacked(parts: list[tuple[int, Ints, Ints]]) -> tuple[Ints, Ints, Ints]:
    """Return types, ends and nodes of cells given by their type, each with its ends and nodes."""
    none = np.empty(0, np.int64)
    first = np.cumsum([0, *(len(nodes) for _, _, nodes in parts)])
    return (
        np.concatenate([none, *(np.full(len(ends), kind) for kind, ends, _ in parts)]),
        np.concatenate([none, *(e + k for (_, e, _), k in zip(parts, first, strict=False))]),
        np.concatenate([none, *(nodes for _, _, nodes in parts)]),
    )


def _groups(data: dict[str, Numbers], notes: list[str], unused: dict[str, int]) -> dict[str, Ints]:
    groups: dict[str, Ints] = {}
    for name, values in data.items():
        distinct, counts = np.unique(values, return_counts=True)
        if values.ndim != 1 or values.dtype.kind not in "iub" or len(distinct) > _MOST_VALUES:
            unused[f"array {name!r}"] = unused.get(f"array {name!r}", 0) + 1
            continue
        marks = np.isin(distinct, (0, 1))
        if marks.all() != marks.any() and (n := int(counts[~marks].sum())) <= _FEW:
            notes.append(
                f"array {name!r} contains 0 and 1, except for {n} of its {len(values)} values "
                f"({named(distinct[~marks].tolist())}): is it damaged?"
            )
        if set(distinct.tolist()) <= {0, 1}:
            groups[name] = np.flatnonzero(values).astype(np.int64)
        else:
            for value in distinct.tolist():
                groups[f"{name}_{value}"] = np.flatnonzero(values == value).astype(np.int64)
    return groups
