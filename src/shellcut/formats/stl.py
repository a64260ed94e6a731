"""STL files, binary and text, with one or several solids.

A binary file may begin with the word ``solid`` like a text file; its length identifies it: 84 bytes
and 50 per triangle, and less than a triangle more, which some programs write.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from shellcut.arrays import Floats, Ints, unit

from . import numerals
from .errors import FileError, counted, read_bytes, read_lines
from .surface_file import SurfaceFile

_HEADER = 80  # bytes of free content before the number of triangles
_RECORD = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def read_stl(path: str | Path) -> SurfaceFile:
    """Read an STL file; each triangle gets its own three vertices."""
    path = Path(path)
    content = read_bytes(path)
    start = _HEADER + 4
    declared = int.from_bytes(content[_HEADER:start], "little") if len(content) >= start else -1
    over = len(content) - start - declared * _RECORD.itemsize
    if declared > 0 and 0 <= over < _RECORD.itemsize:
        with np.errstate(invalid="ignore"):  # the caller reports NaNs
            records = np.frombuffer(content, _RECORD, declared, offset=start)
            corners = records["corners"].astype(np.float64)
        notes = [f"{counted(over, 'byte')} after its last triangle: not read"] if over else []
        return SurfaceFile(path, corners.reshape(-1, 3), _in_order(declared), notes)
    if content.lstrip()[:5].lower() != b"solid" or b"\0" in content:
        n_record = (len(content) - start) / _RECORD.itemsize
        raise FileError(
            path,
            "an STL file must begin with 'solid' or hold as many triangles as it declares, got "
            f"{max(declared, 0)} declared and data for {max(n_record, 0.0):.6g}; is it cut short?",
        )
    points = _text_corners(path)
    return SurfaceFile(path, points, _in_order(len(points) // 3))


def _in_order(n: int) -> Ints:
    return np.arange(3 * n, dtype=np.int64).reshape(n, 3)


def _text_corners(path: Path) -> Floats:
    # the first word of each line: solid, facet normal, outer loop, 3 x vertex, endloop, ...
    expected = {
        "start": ("solid",),
        "solid": ("facet", "endsolid"),
        "facet": ("outer",),
        "outer": ("vertex",),
        "vertex": ("vertex",),
        "third vertex": ("endloop",),
        "endloop": ("endfacet",),
        "endfacet": ("facet", "endsolid"),
        "endsolid": ("solid",),
    }
    points: list[list[float]] = []
    state = "start"
    for number, line in enumerate(read_lines(path), start=1):
        words = line.split()
        if not words:
            continue
        word = words[0].lower()
        if word not in expected[state]:
            raise FileError(
                path,
                f"'{state}' must be followed by '{' or '.join(expected[state])}', "
                f"got {line.strip()!r}",
                line=number,
            )
        if word == "vertex":
            try:
                x, y, z = (numerals.number(w) for w in words[1:])
            except ValueError:
                raise FileError(
                    path, f"a vertex must have three numbers, got {line.strip()!r}", line=number
                ) from None
            points.append([x, y, z])
            word = "third vertex" if len(points) % 3 == 0 else word
        state = word
    if state != "endsolid":
        raise FileError(path, "the last line must be 'endsolid': the file is cut short")
    return np.array(points, dtype=np.float64).reshape(-1, 3)


def write_stl(path: str | Path, vertices: Floats, triangles: Ints, *, header: str) -> None:
    """Write a binary STL file in single precision.

    The header is cut to 80 bytes; it must not begin with ``solid``, which programs take for text.
    """
    corners = vertices[triangles]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    records = np.zeros(len(triangles), _RECORD)
    records["normal"] = unit(normals)
    records["corners"] = corners
    title = header.encode("ascii", errors="replace")[:_HEADER].ljust(_HEADER)
    Path(path).write_bytes(title + len(triangles).to_bytes(4, "little") + records.tobytes())
