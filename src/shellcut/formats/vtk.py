"""VTK files: cells, and integer arrays as groups.

meshio reads them. What it cannot (other versions, LZ4, .vtp, polygons of legacy files, several
pieces, ...) is refused, with a hint how to convert it.

An integer or boolean array on points or cells becomes groups: one with the array's name if it
contains only 0 and 1, otherwise ``name_7`` and the like for each value.
"""

from __future__ import annotations

import re
from collections import Counter
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from shellcut.arrays import Ints

from .budget import Budget
from .errors import FileError, as_file, read_bytes
from .file_mesh import LINE, POINT, QUAD, TRIANGLE, CellBlock, FileMesh, unused_note

_KINDS = {"vertex": POINT, "line": LINE, "triangle": TRIANGLE, "quad": QUAD, "pixel": QUAD}
_POLYGONS = {3: TRIANGLE, 4: QUAD}
_QUADRATIC = {"line3": LINE, "triangle6": TRIANGLE, "quad8": QUAD, "quad9": QUAD}
_DECLARED_IN_LEGACY = {
    "points": rb"(?i)\n\s*POINTS\s+(\d+)",
    "cells": rb"(?i)\n\s*CELL_TYPES\s+(\d+)",
}
_DECLARED_IN_XML = {
    "points": rb"\bNumberOfPoints\s*=\s*[\"']\s*(\d+)",
    "cells": rb"\bNumberOfCells\s*=\s*[\"']\s*(\d+)",
}
_MOST_VALUES = 64  # an array with more distinct values is data, not a group
_CONVERT = (
    "open it in ParaView, choose the filter Append Datasets, and save the result as .vtu with the "
    "compressor ZLib"
)


def read_vtk(path: str | Path) -> FileMesh:
    """Read a grid: .vtu or legacy .vtk.

    Raises FileError if meshio cannot read it, or finds other counts than declared; the message says
    how to convert the file.
    """
    path = Path(path)
    content = read_bytes(path)
    declared = _declared(path, content)
    Budget(path).take("nodes and elements with those of all instances", sum(declared.values()))
    with as_file(path, content) as file:
        return _mesh_of(path, _by_meshio(path, file, declared))


def _declared(path: Path, content: bytes) -> dict[str, int]:
    # numbers of points and cells; none of a structured grid, whose dimensions give them
    legacy = path.suffix.lower() == ".vtk"
    patterns = _DECLARED_IN_LEGACY if legacy else _DECLARED_IN_XML
    found = {what: re.findall(pattern, content) for what, pattern in patterns.items()}
    return {
        what: sum(map(int, numbers)) for what, numbers in found.items() if numbers or not legacy
    }


def _by_meshio(path: Path, file: Path, declared: dict[str, int]) -> Any:
    # meshio opens `file`; messages name `path`
    import meshio  # takes 0.3 s, so only for this format

    legacy = path.suffix.lower() == ".vtk"
    try:
        mesh = (meshio.vtk if legacy else meshio.vtu).read(str(file))
        mesh.points = np.asarray(mesh.points, dtype=np.float64)
    except (Exception, SystemExit) as reason:  # meshio raises any exception, or exits
        raise FileError(path, f"meshio cannot read it: {_cause(reason)}; {_CONVERT}") from None
    read = {"points": len(mesh.points), "cells": sum(len(block.data) for block in mesh.cells)}
    wrong = {what: n for what, n in declared.items() if n != read[what]}
    if problems := [f"{n} {what} are declared, got {read[what]}" for what, n in wrong.items()]:
        raise FileError(
            path,
            f"{'; '.join(problems)}: is it damaged, or are there several pieces, or polylines, "
            f"strips, sets of points, which meshio leaves out? {_CONVERT}",
        )
    if legacy and any(block.type == "polygon" for block in mesh.cells):
        raise FileError(
            path, f"meshio leaves out the arrays of cells where there are polygons; {_CONVERT}"
        )
    if legacy:  # where %20 is a blank
        mesh.point_data = {unquote(name): v for name, v in mesh.point_data.items()}
        mesh.cell_data = {unquote(name): v for name, v in mesh.cell_data.items()}
    return mesh


def _mesh_of(path: Path, mesh: Any) -> FileMesh:
    points = mesh.points
    if points.ndim != 2 or points.shape[1] not in (2, 3):
        raise FileError(path, f"points must have 3 coordinates, got shape {points.shape}")
    points = np.pad(points, ((0, 0), (0, 3 - points.shape[1])))
    blocks, first = [], 0
    for block in mesh.cells:
        count, kind = len(block.data), _KINDS.get(block.type, block.type)
        if kind == "polygon":
            kind = _POLYGONS.get(np.shape(block.data)[1], kind)
        nodes = np.empty((count, 0), np.int64)
        if kind in (*_KINDS.values(), *_QUADRATIC):
            nodes = np.asarray(block.data).astype(np.int64)
            if nodes.size and (nodes.min() < 0 or nodes.max() >= len(points)):
                raise FileError(path, f"{kind} cells must name existing points")
        if block.type == "pixel":
            nodes = nodes[:, [0, 1, 3, 2]]
        labels = range(first, first + count)
        blocks.append(CellBlock(kind, labels, nodes, _QUADRATIC.get(kind, "")))
        first += count
    unused = Counter(f"array {name!r} of the field data" for name in mesh.field_data)
    of_points = _groups(mesh.point_data, unused)
    cell_data = {name: np.concatenate(parts) for name, parts in mesh.cell_data.items()}
    of_cells = _groups(cell_data, unused)
    notes = unused_note(unused)
    return FileMesh(path, points, range(len(points)), blocks, of_points, of_cells, notes)


def _cause(reason: BaseException) -> str:
    """Return in words why meshio failed; many of its errors have no text."""
    cause = reason
    while cause is not None and not str(cause):
        cause = cause.__cause__ or cause.__context__  # type: ignore[assignment]
    if isinstance(cause, KeyError):
        return f"there must be {cause.args[0]!r}, but it is missing"
    if cause is not None:
        return f"{type(cause).__name__}: {cause}"
    return "its declarations and its content do not match; is it damaged, or cut short?"


def _groups(data: dict[str, Any], unused: Counter[str]) -> dict[str, Ints]:
    groups: dict[str, Ints] = {}
    for name, array in data.items():
        values = np.asarray(array)
        if values.ndim == 2 and values.shape[1] == 1:
            values = values[:, 0]
        distinct = np.unique(values)
        if values.ndim != 1 or values.dtype.kind not in "iub" or len(distinct) > _MOST_VALUES:
            unused[f"array {name!r}"] += 1
            continue
        if set(distinct.tolist()) <= {0, 1}:
            groups[name] = np.flatnonzero(values).astype(np.int64)
        else:
            groups |= {
                f"{name}_{value}": np.flatnonzero(values == value).astype(np.int64)
                for value in distinct.tolist()
            }
    return groups
