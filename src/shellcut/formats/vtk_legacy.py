"""VTK's legacy files, .vtk: unstructured grids and polygons, text and binary, versions 1 to 5.

Follows "VTK File Formats, Simple Legacy Formats" (docs.vtk.org). Binary data are big-endian.
"""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from shellcut.arrays import Ints, Numbers

from .errors import FileError, read_bytes
from .vtk_grid import VtkGrid, stacked

_TYPES = {
    **{"char": "i1", "unsigned_char": "u1", "short": "i2", "unsigned_short": "u2", "int": "i4"},
    **{"unsigned_int": "u4", "long": "i8", "unsigned_long": "u8", "float": "f4", "double": "f8"},
    **{"vtkidtype": "i4", "vtktypeint64": "i8", "vtktypeint32": "i4", "vtktypeuint64": "u8"},
}
_POLY = {"VERTICES": 2, "LINES": 4, "POLYGONS": 7, "TRIANGLE_STRIPS": 6}
# attributes of one array: number of components
_ROWS = {"VECTORS": 3, "NORMALS": 3, "TENSORS": 9, "GLOBAL_IDS": 1, "PEDIGREE_IDS": 1}
_A_NUMBER = 32  # bytes of text at first looked through for each number


def read_vtk_legacy(path: Path) -> VtkGrid:
    """Read a .vtk file.

    Raises
    ------
    FileError
        If it is none, or its declarations and its content do not match.
    """
    reader = _Reader(path, read_bytes(path))
    try:
        return reader.grid()
    except (ValueError, OverflowError, LookupError) as reason:
        if isinstance(reason, FileError):
            raise
        raise reader.error(f"{reason}; is it damaged, or cut short?") from None


class _Reader:
    def __init__(self, path: Path, content: bytes):
        self.path, self.content, self.at, self.place = path, content, 0, "the head"
        first = re.match(r"# vtk DataFile Version (\d+)\.\d+", self._line())
        self._line()  # the title
        how = self._line().strip().upper()
        if not first or how not in ("ASCII", "BINARY"):
            raise self.error("it must begin with # vtk DataFile Version, a title, ASCII or BINARY")
        self.binary = how == "BINARY"
        self.by_offsets = int(first[1]) >= 5
        self.points: Numbers | None = None
        self.types: Ints | None = None
        self.cells: dict[str, tuple[Ints, Ints]] = {}  # ends and nodes
        self.data: dict[str, dict[str, Numbers]] = {"POINT_DATA": {}, "CELL_DATA": {}}
        self.unused: dict[str, int] = {}

    def grid(self) -> VtkGrid:
        kind = ""
        where, n_row = "", 0  # whose attributes follow, and how many
        while words := self._words():
            name, *rest = words
            name = name.upper()
            self.place = name
            if name == "DATASET":
                kind = rest[0].upper()
                if kind not in ("UNSTRUCTURED_GRID", "POLYDATA"):
                    raise self.error(
                        f"the grid must be UNSTRUCTURED_GRID or POLYDATA, got {kind}; convert it "
                        "to an unstructured grid"
                    )
            elif name == "POINTS":
                self.points = self._numbers(3 * int(rest[0]), rest[1]).reshape(-1, 3)
            elif name == "CELLS" or name in _POLY:
                self.cells[name] = self._cells(int(rest[0]), int(rest[1]))
            elif name == "CELL_TYPES":
                self.types = self._numbers(int(rest[0]), "int").astype(np.int64)
            elif name in self.data:
                where, n_row = name, int(rest[0])
            elif name == "METADATA":
                while self._line().strip():
                    pass
            elif name == "FIELD" or where:
                self._attributes(name, rest, self.data.get(where), n_row)
            else:
                raise self.error("this section is not known")
        return self._assembled(kind)

    def _assembled(self, kind: str) -> VtkGrid:
        if self.points is None:
            raise self.error("there must be POINTS, but they are missing: cut short?")
        if kind == "UNSTRUCTURED_GRID":
            if self.types is None or "CELLS" not in self.cells:
                raise self.error("there must be CELLS and CELL_TYPES, but they are missing")
            types, (ends, nodes) = self.types, self.cells["CELLS"]
        else:
            types, ends, nodes = stacked(
                [(k, *self.cells[name]) for name, k in _POLY.items() if name in self.cells]
            )
        data = self.data["POINT_DATA"], self.data["CELL_DATA"]
        return VtkGrid(self.points.astype(np.float64), types, ends, nodes, *data, self.unused)

    def _cells(self, n: int, size: int) -> tuple[Ints, Ints]:
        if self.by_offsets:
            ends = self._numbers(n, self._heading("OFFSETS")).astype(np.int64)
            nodes = self._numbers(size, self._heading("CONNECTIVITY")).astype(np.int64)
            if n and ends[0]:
                raise self.error(f"the first offset must be 0, got {ends[0]}")
            return ends[1:], nodes
        table = self._numbers(size, "int").astype(np.int64)
        starts, at = [], 0  # each cell: its number of nodes, then these
        for _ in range(n):
            starts.append(at)
            if table[at] < 0:
                raise self.error(f"a cell must not have {table[at]} nodes")
            at += 1 + int(table[at])
        if at != size:
            raise self.error(f"{n} cells must take {size} numbers, got {at}")
        heads = np.array(starts, dtype=np.int64)
        return np.cumsum(table[heads]), np.delete(table, heads)

    def _heading(self, wanted: str) -> str:
        name, kind = (*self._words(), "", "")[:2]
        if name.upper() != wanted:
            raise self.error(f"{wanted} must follow, got {name!r}")
        return kind

    def _attributes(
        self, name: str, rest: list[str], data: dict[str, Numbers] | None, n: int
    ) -> None:
        if name == "FIELD":
            for _ in range(int(rest[1])):
                array, columns, rows, kind = self._words()
                values = self._numbers(int(columns) * int(rows), kind)
                if data is None:
                    self.unused[f"array {array!r}"] = 1
                else:
                    data[array] = values.reshape(int(rows), -1) if columns != "1" else values
            return
        assert data is not None
        if name == "LOOKUP_TABLE":
            self._numbers(4 * int(rest[1]), "unsigned_char" if self.binary else "double")
            return
        if name == "SCALARS":
            n_component = int(rest[2]) if len(rest) > 2 else 1
            at = self.at
            if (self._words() or [""])[0].upper() != "LOOKUP_TABLE":
                self.at = at
            kind = rest[1]
        elif name == "COLOR_SCALARS":
            n_component, kind = int(rest[1]), "unsigned_char" if self.binary else "double"
        elif name == "TEXTURE_COORDINATES":
            n_component, kind = int(rest[1]), rest[2]
        elif name in _ROWS:
            n_component, kind = _ROWS[name], rest[1]
        else:
            raise self.error("this section is not known")
        values = self._numbers(n * n_component, kind)
        data[rest[0]] = values.reshape(n, -1) if n_component > 1 else values

    # --- bytes and words --------------------------------------------------------------------------

    def _line(self) -> str:
        end = self.content.find(b"\n", self.at)
        end = len(self.content) if end < 0 else end
        line = self.content[self.at : end]
        self.at = end + 1
        return line.decode("latin-1").rstrip("\r")

    def _words(self) -> list[str]:
        # of the next line that is not empty; none at the end of the file
        while self.at < len(self.content):
            if words := self._line().split():
                return words
        return []

    def _numbers(self, n: int, kind: str) -> Numbers:
        if kind.lower() not in _TYPES:
            raise self.error(f"numbers must be of a type among {', '.join(_TYPES)}, got {kind!r}")
        dtype = np.dtype(">" + _TYPES[kind.lower()])
        least = n * (dtype.itemsize if self.binary else 2) - 1  # of text a digit and a blank
        if not n >= 0 or least > len(self.content) - self.at:
            raise self.error(
                f"{n:,} numbers are declared, and there are {len(self.content) - self.at:,} bytes"
            )
        if self.binary:
            values = np.frombuffer(self.content, dtype, n, self.at)
            self.at += n * dtype.itemsize
            return values
        size = _A_NUMBER * (n + 1)
        while True:
            found = self.content[self.at : self.at + size].split(None, n)
            # the last number may go on behind the stretch
            if len(found) > n or self.at + size >= len(self.content):
                break
            size *= 2
        if len(found) < n:
            raise self.error(f"{n:,} numbers are declared, got {len(found):,}")
        left = len(found[n]) if len(found) > n else 0
        self.at = min(self.at + size, len(self.content)) - left
        return np.array(found[:n]).astype(dtype) if n else np.empty(0, dtype)

    def error(self, problem: str) -> FileError:
        """Return the error that names the section."""
        return FileError(self.path, f"{self.place}: {problem}")
