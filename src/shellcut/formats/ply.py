"""PLY files, text and binary: vertices with x, y, z and faces as lists of vertex numbers."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from .declared_content import Content
from .surface_file import SurfaceFile, surface_of_polygons

_TYPES = {
    **dict.fromkeys(("char", "int8"), "i1"),
    **dict.fromkeys(("uchar", "uint8"), "u1"),
    **dict.fromkeys(("short", "int16"), "i2"),
    **dict.fromkeys(("ushort", "uint16"), "u2"),
    **dict.fromkeys(("int", "int32"), "i4"),
    **dict.fromkeys(("uint", "uint32"), "u4"),
    **dict.fromkeys(("float", "float32"), "f4"),
    **dict.fromkeys(("double", "float64"), "f8"),
}
_ORDERS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}
_FACE_LISTS = ("vertex_indices", "vertex_index")


@dataclass
class _Property:
    name: str
    kind: str
    count_kind: str = ""  # type of a list's length


@dataclass
class _Element:
    name: str
    count: int
    properties: list[_Property] = field(default_factory=list)


def read_ply(path: str | Path) -> SurfaceFile:
    """Read a PLY file."""
    return _Reader(Path(path)).surface()


class _Reader(Content):
    def __init__(self, path: Path):
        super().__init__(path)
        self.elements: list[_Element] = []

    def surface(self) -> SurfaceFile:
        self._header()
        if not self.order:
            self.tokens = self.content[self.at :].split()
            self.at = len(self.content)
        vertices: list[list[float]] = []
        faces: list[list[int]] = []
        row_size = 0
        for element in self.elements:
            for _ in range(element.count):
                start = self.at
                row = self._row(element)
                row_size = self.at - start
                if element.name == "vertex":
                    vertices.append([row[axis][0] for axis in "xyz"])
                elif element.name == "face":
                    corners = [int(c) for c in next(row[n] for n in _FACE_LISTS if n in row)]
                    if len(corners) < 3:
                        raise self.error(f"a face must have three vertices, got {corners}")
                    faces.append(corners)
        if len(self.content) - self.at < row_size:
            self.rest()  # less than the last row has, so no row is lost
        if self.at < len(self.content) or self.next_token < len(self.tokens):
            raise self.error("the file must end after the content declared in the header")
        surface = surface_of_polygons(self.path, vertices, faces)
        surface.notes += self.notes
        return surface

    def _header(self) -> None:
        end = self.content.find(b"end_header")
        stop = self.content.find(b"\n", end)
        if not self.content.startswith(b"ply") or end < 0 or stop < 0:
            raise self.error("a PLY file must have a header from 'ply' to 'end_header'")
        self.at = stop + 1
        for line in self.content[:end].decode("latin-1").splitlines()[1:]:
            kinds = _TYPES if self.elements else {}  # of properties, which belong to an element
            match line.split():
                case [] | ["comment" | "obj_info", *_]:
                    continue
                case ["format", order, "1.0"] if order in _ORDERS:
                    self.order = _ORDERS[order]
                case ["format", _, "1.0"]:
                    raise self.error(f"the format must be one of {', '.join(_ORDERS)}")
                case ["element", name, count] if count.isdigit():
                    self.elements.append(_Element(name, int(count)))
                case ["property", "list", of_count, kind, name] if {of_count, kind} <= {*kinds}:
                    listed = _Property(name, kinds[kind], kinds[of_count])
                    self.elements[-1].properties.append(listed)
                case ["property", kind, name] if kind in kinds:
                    self.elements[-1].properties.append(_Property(name, kinds[kind]))
                case _:
                    raise self.error(f"this line of the header is invalid: {line!r}")
        if bare := [e for e in self.elements if e.count and not e.properties]:
            raise self.error(
                f"elements must have properties, got {bare[0].count:,} of {bare[0].name} without"
            )
        names = [e.name for e in self.elements]
        if len(set(names)) < len(names):
            raise self.error(f"each element must occur once, got {names}")
        plain = {e.name: {p.name for p in e.properties if not p.count_kind} for e in self.elements}
        lists = {e.name: {p.name for p in e.properties if p.count_kind} for e in self.elements}
        if not {"x", "y", "z"} <= plain.get("vertex", set()):
            raise self.error("there must be an element vertex with x, y and z")
        if not lists.get("face", set()) & set(_FACE_LISTS):
            raise self.error(f"there must be an element face with a list {_FACE_LISTS[0]}")

    def _row(self, element: _Element) -> dict[str, list[float]]:
        row = {}
        for item in element.properties:
            count = int(self.numbers(item.count_kind)[0]) if item.count_kind else 1
            if count < 0:
                raise self.error("the length of a list must not be negative")
            row[item.name] = self.numbers(item.kind, count).tolist()
        return row
