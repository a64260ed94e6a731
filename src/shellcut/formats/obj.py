"""Wavefront OBJ files: vertices and faces, faces of more than three corners cut into triangles."""

from __future__ import annotations

from pathlib import Path

from .errors import FileError, read_lines
from .surface_file import SurfaceFile, surface_of_polygons

# Statements that are no faces of a surface: texture, normals, groups, materials, points, lines.
_PASSED_OVER = frozenset(
    (
        *("vt", "vn", "vp", "g", "o", "s", "mg", "usemtl", "mtllib", "usemap", "maplib", "p", "l"),
        *("bevel", "c_interp", "d_interp", "lod", "shadow_obj", "trace_obj"),
    )
)


def read_obj(path: str | Path) -> SurfaceFile:
    """Read an OBJ file.

    Raises
    ------
    FileError
        For statements that are not understood: free-form surfaces and misspelt lines.
    """
    path = Path(path)
    vertices: list[list[float]] = []
    faces: list[list[int]] = []
    pending = ""
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
            try:
                vertices.append([float(w) for w in words[1:4]])
            except ValueError:
                vertices.append([])
            if len(vertices[-1]) != 3:
                raise FileError(path, f"v must have three numbers, got {text!r}", line=number)
        elif words[0] == "f":
            corners = [_vertex(path, word, len(vertices), number) for word in words[1:]]
            if len(corners) < 3:
                raise FileError(path, f"f must have three corners, got {text!r}", line=number)
            faces.append(corners)
        else:
            raise FileError(path, f"{words[0]!r} is not read; save plain faces", line=number)
    if pending:
        raise FileError(path, "the last line must not go on: the file is cut short")
    return surface_of_polygons(path, vertices, faces)


def _vertex(path: Path, word: str, n_vertex: int, line: int) -> int:
    # v, v/vt, v//vn or v/vt/vn; negative numbers count back from the last vertex so far
    try:
        number = int(word.split("/", 1)[0])
    except ValueError:
        number = 0
    if number == 0 or number < -n_vertex:
        raise FileError(path, f"a corner must name a vertex, got {word!r}", line=line)
    return number - 1 if number > 0 else n_vertex + number
