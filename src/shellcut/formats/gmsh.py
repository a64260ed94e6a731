"""Gmsh's .msh, versions 2.2 and 4.1, text and binary, with all physical groups of an entity.

The layout follows the Gmsh reference manual, "MSH file format". Each section must end after its
declared counts; sections without mesh data are skipped.
"""

from __future__ import annotations

import re
from collections import Counter, defaultdict
from pathlib import Path
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.files.text_content import decoded

from .declared_content import Content
from .errors import named
from .file_mesh import (
    LINE,
    POINT,
    QUAD,
    TRIANGLE,
    CellBlock,
    FileMesh,
    Numbering,
    unused_note,
)

# Gmsh's element types: name, number of nodes. Only the four kinds of a film have constants.
_TYPES: dict[int, tuple[str, int]] = {
    1: (LINE, 2),
    2: (TRIANGLE, 3),
    3: (QUAD, 4),
    4: ("tetrahedron", 4),
    5: ("hexahedron", 8),
    6: ("prism", 6),
    7: ("pyramid", 5),
    8: ("3-node line", 3),
    9: ("6-node triangle", 6),
    10: ("9-node quad", 9),
    11: ("10-node tetrahedron", 10),
    12: ("27-node hexahedron", 27),
    13: ("18-node prism", 18),
    14: ("14-node pyramid", 14),
    15: (POINT, 1),
    16: ("8-node quad", 8),
    17: ("20-node hexahedron", 20),
    18: ("15-node prism", 15),
    19: ("13-node pyramid", 13),
    21: ("10-node triangle", 10),
    26: ("4-node line", 4),
    36: ("16-node quad", 16),
}
_QUADRATIC = dict.fromkeys(("8-node quad", "9-node quad"), QUAD)
_QUADRATIC |= {"3-node line": LINE, "6-node triangle": TRIANGLE}
_PASSED_OVER = (
    *("Comments", "Periodic", "Parametrizations"),
    *("NodeData", "ElementData", "ElementNodeData", "InterpolationScheme"),
)
_NAMED = re.compile(rb'\s*(\d+) (\d+) "([^"]*)"\s*')  # dimension, tag, name, which may have blanks
_ENTITY = ("point", "curve", "surface", "volume")


class _Cells(NamedTuple):
    # cells of one type and one set of physical groups
    kind: str
    labels: Ints
    node_labels: Ints  # (n, k)
    groups: tuple[str, ...]


def read_gmsh(path: str | Path) -> FileMesh:
    """Read a .msh file of version 2.2 or 4.1.

    Points and lines are returned as cells of those kinds. A physical group without a name is called
    ``curve_3`` and the like, by dimension and number.
    """
    return _Reader(Path(path)).mesh()


class _Reader(Content):
    def __init__(self, path: Path):
        super().__init__(path)
        self.names: dict[tuple[int, int], str] = {}
        self.unused: Counter[str] = Counter()
        self.unnamed: set[str] = set()  # groups without a name while others have one
        self.entities: dict[tuple[int, int], list[int]] = {}
        self.node_labels: list[Ints] = []
        self.positions: list[Floats] = []
        self.cells: list[_Cells] = []

    # --- sections ---------------------------------------------------------------------------------

    def mesh(self) -> FileMesh:
        version = self._format()
        readers = {"PhysicalNames": self._physical_names}
        readers |= {"Nodes": self._nodes_2, "Elements": self._elements_2}
        if version == "4.1":
            readers |= {"Nodes": self._nodes_4, "Elements": self._elements_4}
            readers["Entities"] = self._entities
        seen = set()
        while (name := self._section()) is not None:
            if name in _PASSED_OVER:
                self.unused[f"${name}"] += name != "Comments"
                self._until_end(name)
                continue
            if name not in readers:
                raise self.error(
                    f"sections must be one of {', '.join(sorted(readers))} or known data without "
                    f"mesh, got ${name}; save an unpartitioned mesh"
                )
            if name in seen:
                raise self.error(f"each section must occur once, got ${name} again")
            seen.add(name)
            if in_text := not self.order or name == "PhysicalNames":
                self.tokens, self.next_token = self._until_end(name).split(), 0
            readers[name]()
            if not in_text:
                self._end(name)
            elif self.next_token < len(self.tokens):
                raise self.error(
                    f"${name} must hold as much as it declares, got "
                    f"{len(self.tokens) - self.next_token} entries more"
                )
        if missing := {"Nodes", "Elements"} - seen:
            raise self.error(f"there must be a section ${', $'.join(sorted(missing))}: cut short?")
        return self._assemble()

    def _format(self) -> str:
        if self._section() != "MeshFormat":
            raise self.error("a .msh file must begin with $MeshFormat")
        line = self.line().decode("latin-1")
        match line.split():
            case ["2.2" | "4.1" as version, "0" | "1" as is_binary, "8"]:
                self.order = "<" * int(is_binary)
            case [version, "0" | "1", "8"]:
                raise self.error(
                    f"the version must be 2.2 or 4.1, got {version}; save it again with "
                    "Mesh.MshFileVersion = 4.1"
                )
            case _:
                raise self.error(f"$MeshFormat must read 'version 0|1 8', got {line!r}")
        if self.order and self.numbers("i4")[0] != 1:
            raise self.error("a binary .msh must be little-endian")
        self._end("MeshFormat")
        return version

    def _physical_names(self) -> None:
        declared = int(self.read("i8", self.texts(1))[0])
        text = b" ".join(self.texts(len(self.tokens) - 1))
        if _NAMED.sub(b"", text):
            raise self.error('$PhysicalNames must hold lines: dimension tag "name"')
        found = _NAMED.findall(text)
        self._check_count("groups", declared, len(found))
        self.names = {(int(dim), int(tag)): decoded(name) for dim, tag, name in found}

    def _entities(self) -> None:
        counts = self._sizes(4)
        for dim, count in enumerate(counts):
            for _ in range(count):
                tag = self.numbers("i4")[0]
                self.numbers("f8", 3 if dim == 0 else 6)
                groups = self.numbers("i4", self._sizes(1)[0])
                if dim > 0:
                    self.numbers("i4", self._sizes(1)[0])
                self.entities[dim, int(tag)] = [abs(int(g)) for g in groups]

    def _nodes_4(self) -> None:
        n_block, n_node, _, _ = self._sizes(4)
        for _ in range(n_block):
            dim, _, parametric = self.numbers("i4", 3)
            (count,) = self._sizes(1)
            self.node_labels.append(self.numbers("i8", count))
            columns = 3 + (int(dim) if parametric else 0)
            rows = self.numbers("f8", count * columns).reshape(count, columns)
            self.positions.append(rows[:, :3])
        self._check_count("nodes", n_node, sum(len(p) for p in self.positions))

    def _elements_4(self) -> None:
        n_block, n_element, _, _ = self._sizes(4)
        for _ in range(n_block):
            dim, tag, kind = (int(i) for i in self.numbers("i4", 3))
            (count,) = self._sizes(1)
            name, n = self._type(kind)
            rows = self.numbers("i8", count * (n + 1)).reshape(count, n + 1)
            if (dim, tag) not in self.entities and self.entities:
                raise self.error(f"elements must lie on a known entity, got {(dim, tag)}")
            groups = [self._name(dim, g) for g in self.entities.get((dim, tag), [])]
            self.cells.append(_Cells(name, rows[:, 0], rows[:, 1:], tuple(groups)))
        self._check_count("elements", n_element, sum(len(c.labels) for c in self.cells))

    def _nodes_2(self) -> None:
        count = self._count_2()
        if self.order:
            dtype = np.dtype([("id", "<i4"), ("x", "<f8", 3)])
            rows = np.frombuffer(self.raw(count * dtype.itemsize), dtype)
            self.node_labels.append(rows["id"].astype(np.int64))
            self.positions.append(rows["x"].astype(np.float64))
            return
        texts = self.texts(4 * count)
        self.node_labels.append(self.read("i8", texts[::4]))
        del texts[::4]
        self.positions.append(self.read("f8", texts).reshape(count, 3))

    def _elements_2(self) -> None:
        count = self._count_2()
        rows: dict[tuple[int, int], list[list[int]]] = defaultdict(list)
        read = 0
        while read < count:
            # binary: type, number of elements, number of tags; as text: id, type, number of tags
            first, second, n_tag = self.numbers("i4", 3).tolist()
            kind, n_follow, label = (first, second, []) if self.order else (second, 1, [first])
            if n_follow < 1 or n_tag < 0:
                raise self.error(
                    f"blocks must have 1 element and 0 tags or more, got {n_follow} and {n_tag}"
                )
            width = 1 - len(label) + n_tag + self._type(kind)[1]
            for row in self.numbers("i4", n_follow * width).reshape(n_follow, width).tolist():
                row = label + row
                group = abs(row[1]) if n_tag else 0
                rows[kind, group].append([row[0], *row[1 + n_tag :]])
            read += n_follow
        self._check_count("elements", count, read)
        for (kind, group), table in rows.items():
            name, _ = self._type(kind)
            dim = {POINT: 0, LINE: 1, TRIANGLE: 2, QUAD: 2}.get(name.split()[-1], 3)
            groups = (self._name(dim, group),) if group else ()
            array = np.array(table, dtype=np.int64)
            self.cells.append(_Cells(name, array[:, 0], array[:, 1:], groups))

    def _count_2(self) -> int:
        return int(self.read("i8", [self.line()] if self.order else self.texts(1))[0])

    def _type(self, kind: int) -> tuple[str, int]:
        if kind not in _TYPES:
            raise self.error(f"element types must be known ones of Gmsh, got {kind}")
        return _TYPES[kind]

    def _name(self, dim: int, tag: int) -> str:
        name = self.names.get((dim, tag))
        if name is None and any(of == dim for of, _ in self.names):
            self.unnamed.add(f"{_ENTITY[dim]}_{tag}")
        return f"{_ENTITY[dim]}_{tag}" if name is None else name

    def _check_count(self, what: str, declared: int, read: int) -> None:
        if declared != read:
            raise self.error(f"{declared} {what} are declared, got {read}; is the file cut short?")

    def _assemble(self) -> FileMesh:
        positions = np.concatenate([np.empty((0, 3)), *self.positions])
        labels = np.concatenate([np.empty(0, np.int64), *self.node_labels])
        numbering = Numbering(self.path, "node", labels, positions)
        blocks: list[CellBlock] = []
        groups: dict[str, list[Ints]] = defaultdict(list)
        first: dict[tuple[str, tuple[int, ...]], int] = {}  # version 2 repeats a cell per group
        n_cell = n_again = 0
        for cells in self.cells:
            nodes = numbering.rows(cells.node_labels, f"{cells.kind} cells")
            keep: list[int] = []
            members: list[int] = []
            for i, row in enumerate(nodes.tolist()):
                key = cells.kind, tuple(row)
                if key not in first:
                    first[key] = n_cell + len(keep)
                    keep.append(i)
                elif not cells.groups:
                    raise self.error(f"cells must differ, got {cells.labels[i]} again")
                members.append(first[key])
            n_again += len(nodes) - len(keep)
            for name in cells.groups:
                groups[name].append(np.array(members, dtype=np.int64))
            if keep:
                corners = _QUADRATIC.get(cells.kind, "")
                blocks.append(CellBlock(cells.kind, cells.labels[keep], nodes[keep], corners))
                n_cell += len(keep)
        named_cells = {name: np.unique(np.concatenate(parts)) for name, parts in groups.items()}
        mesh = FileMesh(self.path, positions, numbering.labels, blocks, cell_groups=named_cells)
        mesh.notes += [*unused_note(+self.unused), *self.notes]
        if self.unnamed:
            mesh.notes.append(
                "groups without a name, though others have one, are called "
                f"{named(sorted(self.unnamed))}"
            )
        if n_again:
            mesh.notes.append(f"{n_again} cells are listed once per group, kept once")
        return mesh

    # --- bytes and tokens -------------------------------------------------------------------------

    def _section(self) -> str | None:
        # the name of the next section, None at the end of the file
        while self.content.find(b"$", self.at) >= 0:
            if not (line := self.line()):
                continue
            if not line.startswith(b"$") or line.startswith(b"$End"):
                raise self.error(
                    f"a section must begin with $Name, got {line[:30].decode('latin-1')!r}"
                )
            return line[1:].decode("latin-1")
        self.rest()
        return None

    def _end(self, name: str) -> None:
        line = self.line() or self.line()
        if line != b"$End" + name.encode("latin-1"):
            raise self.error(f"${name} must end with $End{name} after its declared content")

    def _until_end(self, name: str) -> bytes:
        end = self.content.find(b"$End" + name.encode("latin-1"), self.at)
        if end < 0:
            raise self.error(f"${name} must end with $End{name}: the file is cut short")
        within = self.raw(end - self.at)
        self.line()
        return within

    def _sizes(self, n: int) -> list[int]:
        sizes: list[int] = self.numbers("i8", n).tolist()
        if min(sizes) < 0:
            raise self.error(f"counts must not be negative, got {min(sizes)}")
        return sizes
