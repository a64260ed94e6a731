"""VTK files: cells, and integer arrays as groups.

meshio reads them. What it cannot (other versions, LZ4, .vtp, polygons of legacy files, several
pieces, ...) VTK itself rewrites for it, if it is installed (``pip install 'shellcut[vtk]'``, BSD).

An integer or boolean array on points or cells becomes groups: one with the array's name if it
contains only 0 and 1, otherwise ``name_7`` and the like for each value.
"""

from __future__ import annotations

import re
import tempfile
import traceback
from collections import Counter
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np

from shellcut.arrays import Ints

from . import vtk_process
from .budget import Budget
from .errors import FileError, as_file, read_bytes
from .file_mesh import LINE, POINT, QUAD, TRIANGLE, CellBlock, FileMesh, unused_note
from .own_process import OwnProcess

_KINDS = {"vertex": POINT, "line": LINE, "triangle": TRIANGLE, "quad": QUAD, "pixel": QUAD}
_POLYGONS = {3: TRIANGLE, 4: QUAD}
_QUADRATIC = {"line3": LINE, "triangle6": TRIANGLE, "quad8": QUAD, "quad9": QUAD}
_MOST_VALUES = 64  # an array with more distinct values is data, not a group
_VTK = OwnProcess(
    "VTK",
    "vtkmodules",
    vtk_process.__file__,
    "is it damaged? write it anew, as a .vtu of version 1.0",
    "libgl1 libxrender1",
)


def read_vtk(path: str | Path) -> FileMesh:
    """Read a grid or polygons: .vtu, .vtp or legacy .vtk.

    Raises FileError if neither meshio nor VTK can read it, or they find other counts than declared.
    """
    path = Path(path)
    content = read_bytes(path)
    declared = _declared(path, content)
    Budget(path).take("nodes and elements with those of all instances", sum(declared.values()))
    with as_file(path, content) as file:
        return _read(path, file, declared)


def _read(path: Path, file: Path, declared: dict[str, int]) -> FileMesh:
    # `file` is what the libraries open, `path` what messages name
    unused: Counter[str] = Counter()
    try:
        return _mesh_of(path, _by_meshio(file, declared), unused)
    except _Unread as reason:
        if not _VTK.installed:
            raise FileError(
                path, f"{reason}; VTK reads more of these files: pip install 'shellcut[vtk]'"
            ) from None
        problem = str(reason)
    with tempfile.TemporaryDirectory() as folder:
        rewritten = Path(folder) / "grid.vtu"
        try:
            unused.update(_VTK.run(file, str(rewritten)).splitlines())
            return _mesh_of(path, _by_meshio(rewritten, declared), unused)
        except FileError as reason:
            raise FileError(path, f"{problem}; {reason.problem}") from None
        except _Unread as reason:
            raise FileError(path, f"{problem}; as rewritten by VTK, {reason}") from None


class _Unread(Exception):
    """meshio cannot read the file; the message says why."""


def _declared(path: Path, content: bytes) -> dict[str, int]:
    # numbers of points and cells; none of a structured grid, whose dimensions give them
    if path.suffix.lower() != ".vtk":
        points = re.findall(rb"\bNumberOfPoints\s*=\s*[\"']\s*(\d+)", content)
        parts = rb"\bNumberOf(?:Cells|Verts|Lines|Strips|Polys)\s*=\s*[\"']\s*(\d+)"
        cells = re.findall(parts, content)
        return {"points": sum(map(int, points)), "cells": sum(map(int, cells))}
    points = re.findall(rb"(?i)\n\s*POINTS\s+(\d+)", content)
    cells = re.findall(rb"(?i)\n\s*CELL_TYPES\s+(\d+)", content)
    counts = [*map(int, cells)]
    if re.search(rb"(?i)\n\s*DATASET\s+POLYDATA", content):
        parts = rb"(?i)\n\s*(?:VERTICES|LINES|POLYGONS|TRIANGLE_STRIPS)\s+(\d+)"
        # versions from 5 on declare the number of offsets
        more = re.match(rb"# vtk DataFile Version [5-9]", content) is not None
        counts = [max(int(n) - more, 0) for n in re.findall(parts, content)]
    found = {"points": [*map(int, points)], "cells": counts}
    return {what: sum(numbers) for what, numbers in found.items() if numbers}


def _by_meshio(path: Path, declared: dict[str, int]) -> Any:
    import meshio  # takes 0.3 s, so only for this format

    legacy = path.suffix.lower() == ".vtk"
    try:
        mesh = (meshio.vtk if legacy else meshio.vtu).read(str(path))
        mesh.points = np.asarray(mesh.points, dtype=np.float64)
    except (Exception, SystemExit) as reason:  # meshio raises any exception, or exits
        raise _Unread(f"meshio cannot read it: {_cause(reason)}") from None
    read = {"points": len(mesh.points), "cells": sum(len(block.data) for block in mesh.cells)}
    wrong = {what: n for what, n in declared.items() if n != read[what]}
    if problems := [f"{n} {what} are declared, got {read[what]}" for what, n in wrong.items()]:
        raise _Unread(
            f"{'; '.join(problems)}: is it damaged, or are there several pieces, or polylines, "
            "strips, sets of points, which meshio leaves out?"
        )
    if legacy and any(block.type == "polygon" for block in mesh.cells):
        raise _Unread("meshio leaves out the arrays of cells where there are polygons")
    if legacy:  # where %20 is a blank
        mesh.point_data = {unquote(name): v for name, v in mesh.point_data.items()}
        mesh.cell_data = {unquote(name): v for name, v in mesh.cell_data.items()}
    return mesh


def _mesh_of(path: Path, mesh: Any, unused: Counter[str]) -> FileMesh:
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
    unused.update(f"array {name!r} of the field data" for name in mesh.field_data)
    of_points = _groups(mesh.point_data, unused)
    cell_data = {name: np.concatenate(parts) for name, parts in mesh.cell_data.items()}
    of_cells = _groups(cell_data, unused)
    notes = unused_note(unused)
    return FileMesh(path, points, range(len(points)), blocks, of_points, of_cells, notes)


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
            for value in distinct.tolist():
                groups[f"{name}_{value}"] = np.flatnonzero(values == value).astype(np.int64)
    return groups
