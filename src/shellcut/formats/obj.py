"""Wavefront OBJ files: vertices and faces; faces with more than three corners are triangulated."""

from __future__ import annotations

from pathlib import Path

from . import numerals
from .errors import FileError, read_lines
from .surface_file import SurfaceFile, surface_of_polygons

# Statements other than faces: texture, normals, groups, materials, points, lines.
_PASSED_OVER = (
    *("vt", "vn", "vp", "g", "o", "s", "mg", "usemtl", "mtllib", "usemap", "maplib", "p", "l"),
    *("bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"),
)


def read_obj(path: str | Path) -> SurfaceFile:
    """Read an OBJ file without free-form surfaces."""
    path = Path(path)
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    pending = ""
    n_number = 0  # numbers per vertex, as in the first one
    for number, line in enumerate(read_lines(path), start=1):
        text = pending + line.split("#", 1)[0].rstrip()
        pending = ""
        if text.endswith("\\"):
            pending = text[:-1] + " "
            continue
        words = text.split()
        if not words or words[0] in _PASSED_OVER:
            continue
        if words[0] == "v":
            n_number = n_number or len(words) - 1
            vertices.append(_position(path, words, n_number, number))
        elif words[0] == "f":
            corners = [_vertex(path, word, len(vertices), number) for word in words[1:]]
            if len(corners) < 3:
                raise FileError(path, f"f must have three corners, got {text!r}", line=number)
            faces.append(corners)
        else:
            raise FileError(path, f"{words[0]!r} is not read; save plain faces", line=number)
    if pending:
        raise FileError(path, "the last line must not continue: the file is cut short")
    return surface_of_polygons(path, vertices, faces)


def _position(path: Path, words: list[str], n_number: int, line: int) -> list[float]:
    # x y z, possibly with a weight, which must be 1, or with a colour of three or four numbers
    try:
        values = [numerals.number(word) for word in words[1:]]
    except ValueError:
        values = []
    if len(values) not in (3, 4, 6, 7) or len(values) != n_number:
        raise FileError(
            path,
            f"v must have three numbers (and a weight or a colour, the same for all v), got "
            f"{' '.join(words)!r}",
            line=line,
        )
    if len(values) == 4 and values[3] != 1.0:
        raise FileError(path, f"the weight of a vertex must be 1, got {words[4]!r}", line=line)
    return values[:3]


def _vertex(path: Path, word: str, n_vertex: int, line: int) -> int:
    # v, v/vt, v//vn or v/vt/vn; negative numbers count back from the last vertex so far
    try:
        number = numerals.whole(word.split("/", 1)[0])
    except ValueError:
        number = 0
    if number == 0 or number < -n_vertex:
        raise FileError(path, f"a corner must name a vertex, got {word!r}", line=line)
    return number - 1 if number > 0 else n_vertex + number
