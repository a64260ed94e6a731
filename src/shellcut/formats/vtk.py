"""VTK files (.vtu, .vtk) through meshio: cells, and integer arrays as groups.

An integer or boolean array on points or cells becomes groups: one with the array's name if it
contains only 0 and 1, otherwise ``name_7`` and the like for each value.
"""

from __future__ import annotations

import re
import traceback
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.arrays import Ints

from .errors import FileError, named, read_bytes
from .file_mesh import LINE, POINT, QUAD, TRIANGLE, CellBlock, FileMesh

_KINDS = {"vertex": POINT, "line": LINE, "triangle": TRIANGLE, "quad": QUAD}
_QUADRATIC = {"line3": LINE, "triangle6": TRIANGLE, "quad8": QUAD, "quad9": QUAD}
_FEW = 3  # up to this many values other than 0 and 1 look like slips
_MOST_VALUES = 64  # an array with more distinct values is data, not a group
_DECLARED = {
    ".vtu": (rb'NumberOfPoints="\s*(\d+)\s*"', rb'NumberOfCells="\s*(\d+)\s*"'),
    ".vtk": (rb"\n\s*POINTS\s+(\d+)", rb"\n\s*CELL_TYPES\s+(\d+)"),
}


def read_vtk(path: str | Path) -> FileMesh:
    """Read a .vtu or legacy .vtk file of an unstructured grid.

    Raises
    ------
    FileError
        If meshio cannot read it, or finds other counts than declared.
    """
    import meshio  # takes 0.3 s, so only for this format

    path = Path(path)
    content = read_bytes(path)
    read = meshio.vtu.read if path.suffix.lower() == ".vtu" else meshio.vtk.read
    try:
        mesh = read(str(path))
        n_cell = sum(len(block.data) for block in mesh.cells)
        points = np.asarray(mesh.points, dtype=np.float64)
    except (Exception, SystemExit) as reason:  # meshio raises any exception, or exits
        raise FileError(path, f"meshio cannot read it: {_cause(reason)}") from None
    for what, pattern, read_count in zip(
        ("points", "cells"), _DECLARED[path.suffix.lower()], (len(points), n_cell), strict=True
    ):
        declared = sum(int(n) for n in re.findall(pattern, content))
        if declared != read_count:
            raise FileError(path, f"{declared} {what} are declared, got {read_count}")
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise FileError(path, f"points must have 3 coordinates, got shape {points.shape}")
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    blocks, first = [], 0
    for block in mesh.cells:
        nodes = np.asarray(block.data)
        count = len(nodes)
        if block.type in _KINDS or block.type in _QUADRATIC:
            nodes = nodes.astype(np.int64)
            if nodes.size and (nodes.min() < 0 or nodes.max() >= len(points)):
                raise FileError(path, f"{block.type} cells must name existing points")
        else:
            nodes = np.empty((count, 0), np.int64)
        labels = range(first, first + count)
        blocks.append(
            CellBlock(
                _KINDS.get(block.type, block.type), labels, nodes, _QUADRATIC.get(block.type, "")
            )
        )
        first += count
    notes: list[str] = []
    of_cells = {name: np.concatenate(parts) for name, parts in mesh.cell_data.items()}
    return FileMesh(
        path,
        points,
        range(len(points)),
        blocks,
        _groups(mesh.point_data, notes),
        _groups(of_cells, notes),
        notes,
    )


def _cause(reason: BaseException) -> str:
    """Return in words why meshio failed; many of its errors have no text."""
    told = reason
    while told is not None and not str(told):
        told = told.__cause__ or told.__context__  # type: ignore[assignment]
    if isinstance(told, KeyError):
        return f"there must be {told.args[0]!r}, but it is missing"
    if told is not None:
        return f"{type(told).__name__}: {told}"
    place = "reading"
    for frame, _ in traceback.walk_tb(reason.__traceback__):
        if "meshio" in frame.f_code.co_filename:
            place = frame.f_code.co_name.strip("_").replace("_", " ")
    return (
        f"it stops at {place!r}: the declarations and the content there do not match; "
        "is it damaged, or cut short?"
    )


def _groups(data: dict[str, Any], notes: list[str]) -> dict[str, Ints]:
    groups: dict[str, Ints] = {}
    for name, array in data.items():
        values = np.asarray(array)
        if values.ndim != 1 or values.dtype.kind not in "iub":
            continue
        distinct, counts = np.unique(values, return_counts=True)
        marks = np.isin(distinct, (0, 1))
        if marks.all() != marks.any() and (n := int(counts[~marks].sum())) <= _FEW:
            notes.append(
                f"array {name!r} contains 0 and 1, except for {n} of its {len(values)} values "
                f"({named(distinct[~marks].tolist())}): is it damaged?"
            )
        if set(distinct.tolist()) <= {0, 1}:
            groups[name] = np.flatnonzero(values).astype(np.int64)
        elif len(distinct) <= _MOST_VALUES:
            for value in distinct.tolist():
                groups[f"{name}_{value}"] = np.flatnonzero(values == value).astype(np.int64)
    return groups
