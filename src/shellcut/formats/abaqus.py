"""Abaqus input files (.inp): nodes, shell elements and sets, of parts and of their instances.

Read are *NODE, *ELEMENT, *NSET, *ELSET (with GENERATE, sets of sets, sets named on *NODE and
*ELEMENT), *PART, *INSTANCE with translation and rotation, *ASSEMBLY and *INCLUDE. Keywords that
make nodes or elements by rule are refused: without them the mesh would be smaller. Everything else
(materials, steps, output) is passed over.

Part sets of an instance keep their name if only one instance brings it and the assembly does not;
otherwise they are called ``instance.set``.
"""

from __future__ import annotations

from collections import defaultdict
from dataclasses import dataclass, field
from math import radians
from pathlib import Path

import numpy as np
import scipy

from shellcut._jit import Floats, Ints

from .abaqus_deck import DataLine, Keyword, read_deck
from .errors import FileError, named
from .file_mesh import LINE, QUAD, TRIANGLE, CellBlock, FileMesh

_READ = frozenset(
    [
        "NODE",
        "ELEMENT",
        "NSET",
        "ELSET",
        "PART",
        "END PART",
        "INSTANCE",
        "END INSTANCE",
        "ASSEMBLY",
        "END ASSEMBLY",
        "INCLUDE",
    ]
)
_MAKES_MESH = frozenset(
    [
        "NGEN",
        "NFILL",
        "NCOPY",
        "NMAP",
        "ELGEN",
        "ELCOPY",
        "SYSTEM",
        "PARAMETER",
        "SUBSTRUCTURE GENERATE",
        "IMPORT",
        "IMPORT NODESET",
        "IMPORT ELSET",
        "MODEL CHANGE",
    ]
)

# Three- and four-node sheets of any formulation, and the trusses that mesh programs write for
# curves; the film replaces the formulation.
_KINDS: dict[str, tuple[str, int]] = {
    **dict.fromkeys(
        [
            "S4",
            "S4R",
            "S4RS",
            "S4RSW",
            "S4R5",
            "S4T",
            "S4RT",
            "M3D4",
            "M3D4R",
            "CPS4",
            "CPS4R",
            "CPS4I",
            "CPE4",
            "CPE4R",
            "CPE4I",
            "SFM3D4",
            "SFM3D4R",
        ],
        (QUAD, 4),
    ),
    **dict.fromkeys(
        ["S3", "S3R", "S3RS", "S3T", "S3RT", "STRI3", "M3D3", "CPS3", "CPE3", "SFM3D3"],
        (TRIANGLE, 3),
    ),
    **dict.fromkeys(["T3D2", "T2D2"], (LINE, 2)),
}

_Transform = tuple[Floats, Floats]  # rotation (3, 3), translation (3,): x = R X + t


@dataclass
class _Scope:
    """The nodes, elements and sets of a part, of an instance's own or of the assembly."""

    name: str
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    sets: dict[tuple[str, str], list[_Entry]] = field(default_factory=dict)
    """By kind ("node" or "element") and upper-case name."""
    spelling: dict[tuple[str, str], str] = field(default_factory=dict)
    """Of the sets to be handed on."""


@dataclass
class _Entry:
    """One entry of a set: ids, or the name of another set, perhaps of one instance."""

    line: DataLine
    ids: range | None = None
    other: str = ""
    kind: str = ""
    instance: str = ""
    text: str = ""
    """As written, where a dot was taken to part instance and name."""


@dataclass
class _Instance:
    name: str
    part: str
    transform: _Transform
    own: _Scope


def read_abaqus(path: str | Path) -> FileMesh:
    """Read an Abaqus input file.

    Raises
    ------
    FileError
        Naming file and line of what is wrong, missing or made by a keyword that is not read.
    """
    reader = _Reader(Path(path))
    for keyword in read_deck(reader.path, _READ):
        reader.take(keyword)
    return reader.mesh()


class _Reader:
    def __init__(self, path: Path):
        self.path = path
        self.top = _Scope("")  # the assembly, or the whole of a file without parts
        self.parts: dict[str, _Scope] = {}
        self.instances: dict[str, _Instance] = {}
        self.part: _Scope | None = None
        self.instance: _Instance | None = None
        self.open: list[Keyword] = []  # PART, ASSEMBLY and INSTANCE not yet ended

    # --- keywords ---------------------------------------------------------------------------------

    def take(self, keyword: Keyword) -> None:
        name = keyword.name
        if name in _MAKES_MESH:
            raise keyword.error(
                "makes or moves nodes and elements by rule, which is not read; write the mesh out "
                "node by node (in Abaqus/CAE: export the model as an orphan mesh)"
            )
        if name in ("PART", "ASSEMBLY", "INSTANCE"):
            self._begin(keyword)
        elif name in ("END PART", "END ASSEMBLY", "END INSTANCE"):
            if not self.open or self.open[-1].name != name[4:]:
                raise keyword.error(f"must end a *{name[4:]}, there is none open")
            self.open.pop()
            self.part = None if name == "END PART" else self.part
            self.instance = None if name == "END INSTANCE" else self.instance
        elif name == "NODE":
            self._nodes(keyword)
        elif name == "ELEMENT":
            self._elements(keyword)
        elif name in ("NSET", "ELSET"):
            self._set(keyword)

    @property
    def scope(self) -> _Scope:
        if self.instance is not None:
            return self.instance.own
        return self.part if self.part is not None else self.top

    def _begin(self, keyword: Keyword) -> None:
        within = [k.name for k in self.open]
        if within != (["ASSEMBLY"] if keyword.name == "INSTANCE" else []):
            raise keyword.error(f"must not stand within *{' *'.join(within) or '(nothing)'}")
        self.open.append(keyword)
        if keyword.name == "ASSEMBLY":
            return
        name = keyword.required("NAME")
        known = self.parts if keyword.name == "PART" else self.instances
        if name.upper() in known:
            raise keyword.error(f"the name must be new, got {name!r} again")
        if keyword.name == "PART":
            self.part = self.parts[name.upper()] = _Scope(name)
            return
        part = keyword.parameters.get("PART", "")
        if part and part.upper() not in self.parts:
            raise keyword.error(f"the part must be one of {self._part_names()}, got {part!r}")
        self.instance = _Instance(name, part.upper(), _transform(keyword), _Scope(name))
        self.instances[name.upper()] = self.instance

    def _part_names(self) -> str:
        return named(sorted(part.name for part in self.parts.values())) or "none"

    def _nodes(self, keyword: Keyword) -> None:
        if keyword.parameters.get("SYSTEM", "R").upper() != "R":
            raise keyword.error("coordinates must be Cartesian (SYSTEM=R); write them out so")
        nodes, ids = self.scope.nodes, []
        for line in keyword.data:
            label = line.integer(0)
            if label in nodes:
                raise line.error(f"each node id must stand once, got {label} again")
            if len(line.entries) > 7:
                raise line.error("a node has an id, coordinates and at most a normal")
            nodes[label] = (line.number(1), line.number(2), line.number(3))
            ids.append((line, label))
        self._named_on(keyword, "NSET", "node", ids)

    def _elements(self, keyword: Keyword) -> None:
        kind = keyword.required("TYPE").upper()
        n_node = _KINDS[kind][1] if kind in _KINDS else 0
        elements, ids = self.scope.elements, []
        lines = iter(keyword.data)
        for line in lines:
            label = line.integer(0)
            # other types are only counted: their nodes may be of any form
            nodes = [line.integer(k) for k in range(1, len(line.entries))] if n_node else []
            last = line
            # the entries go on while any are missing; of other types, while lines end in a comma
            while len(nodes) < n_node if n_node else last.continues:
                following = next(lines, None)
                if following is None or not last.continues:
                    raise line.error(
                        f"element {label} of type {kind} must have {n_node or 'more'} nodes, got "
                        f"{len(nodes)}; is the file cut short?"
                    )
                last = following
                nodes += [last.integer(k) for k in range(len(last.entries))] if n_node else []
            if n_node and len(nodes) != n_node:
                raise line.error(
                    f"element {label} of type {kind} must have {n_node} nodes, got {len(nodes)}"
                )
            if label in elements:
                raise line.error(f"each element id must stand once, got {label} again")
            elements[label] = (kind, nodes)
            ids.append((line, label))
        self._named_on(keyword, "ELSET", "element", ids)

    def _named_on(
        self, keyword: Keyword, parameter: str, kind: str, ids: list[tuple[DataLine, int]]
    ) -> None:
        # *NODE, NSET=rim and *ELEMENT, ELSET=film name what stands below them
        if parameter in keyword.parameters:
            entries = self._set_entries(kind, keyword.required(parameter))
            entries += [_Entry(line, range(label, label + 1)) for line, label in ids]

    def _set_entries(self, kind: str, name: str, *, shown: bool = True) -> list[_Entry]:
        # sets grow where their name comes again
        scope = self.scope
        if shown:
            scope.spelling.setdefault((kind, name.upper()), name)
        return scope.sets.setdefault((kind, name.upper()), [])

    def _set(self, keyword: Keyword) -> None:
        kind = "node" if keyword.name == "NSET" else "element"
        # Abaqus/CAE marks the sets that it made for itself as internal
        shown = "INTERNAL" not in keyword.parameters
        entries = self._set_entries(kind, keyword.required(keyword.name), shown=shown)
        instance = keyword.parameters.get("INSTANCE", "")
        if "ELSET" in keyword.parameters and kind == "node":
            where = DataLine(keyword.path, keyword.line, [], False)
            entries.append(
                _Entry(where, other=keyword.required("ELSET"), kind="element", instance=instance)
            )
        for line in keyword.data:
            if "GENERATE" in keyword.parameters:
                first, last = line.integer(0), line.integer(1)
                step = line.integer(2) if len(line.entries) > 2 and line.entries[2] else 1
                if step < 1 or last < first or (last - first) % step:
                    raise line.error(
                        "GENERATE must go from a first id up to a last one by a step that divides "
                        f"the way, got {first}, {last}, {step}"
                    )
                entries.append(_Entry(line, range(first, last + 1, step), instance=instance))
                continue
            entries += [_entry(line, text, kind, instance) for text in line.entries if text]

    # --- the model --------------------------------------------------------------------------------

    def mesh(self) -> FileMesh:
        if self.open:
            raise self.open[-1].error(f"must be ended by *END {self.open[-1].name}: cut short?")
        if self.parts and not self.instances:
            # a part file alone: each part once, where it is
            for key, part in self.parts.items():
                still = np.eye(3), np.zeros(3)
                self.instances[key] = _Instance(part.name, key, still, _Scope(part.name))
        model = _Model(self.path)
        model.add("", self.top, None)
        for key, instance in self.instances.items():
            if instance.part:
                model.add(key, self.parts[instance.part], instance.transform)
            model.add(key, instance.own, instance.transform)
        return model.mesh({key: instance.name for key, instance in self.instances.items()})


class _Model:
    # all scopes put in place; nodes and elements numbered in order of their appearance
    def __init__(self, path: Path):
        self.path = path
        self.positions: list[Floats] = []
        self.node_labels: list[str] = []
        self.rows: dict[str, dict[tuple[str, int], int]] = {"node": {}, "element": {}}
        self.elements: list[tuple[str, str, list[int]]] = []  # label, type, node rows
        self.scopes: dict[str, list[_Scope]] = defaultdict(list)

    def add(self, key: str, scope: _Scope, transform: _Transform | None) -> None:
        self.scopes[key].append(scope)
        prefix = f"{scope.name}." if scope.name else ""
        positions = np.array(list(scope.nodes.values()), dtype=np.float64).reshape(-1, 3)
        if transform is not None:
            positions = positions @ transform[0].T + transform[1]
        self.positions.append(positions)
        for label in scope.nodes:
            if (key, label) in self.rows["node"]:
                raise FileError(self.path, f"node {prefix}{label} must be defined once")
            self.rows["node"][key, label] = len(self.node_labels)
            self.node_labels.append(f"{prefix}{label}")
        for label, (kind, nodes) in scope.elements.items():
            if (key, label) in self.rows["element"]:
                raise FileError(self.path, f"element {prefix}{label} must be defined once")
            lost = [n for n in nodes if (key, n) not in self.rows["node"]]
            if lost:
                raise FileError(
                    self.path,
                    f"element {prefix}{label} must have nodes that are defined, got {named(lost)}; "
                    "is the file cut short?",
                )
            self.rows["element"][key, label] = len(self.elements)
            members = [self.rows["node"][key, n] for n in nodes]
            self.elements.append((f"{prefix}{label}", kind, members))

    def mesh(self, instance_names: dict[str, str]) -> FileMesh:
        by_kind: dict[str, list[int]] = defaultdict(list)
        for i, (_, kind, _) in enumerate(self.elements):
            by_kind[kind].append(i)
        blocks, new_number, n_cell = [], np.zeros(len(self.elements), np.int64), 0
        for kind, members in by_kind.items():
            new_number[members] = n_cell + np.arange(len(members))
            n_cell += len(members)
            labels = [self.elements[i][0] for i in members]
            if kind in _KINDS:
                nodes = np.array([self.elements[i][2] for i in members], dtype=np.int64)
                blocks.append(CellBlock(_KINDS[kind][0], labels, nodes))
            else:
                blocks.append(CellBlock(kind, labels, np.empty((len(members), 0), np.int64)))
        groups = {
            kind: {
                name: self._members(kind, key, upper, ())
                for name, key, upper in self._group_names(kind, instance_names)
            }
            for kind in ("node", "element")
        }
        positions = np.concatenate([np.empty((0, 3)), *self.positions])
        return FileMesh(
            self.path,
            positions,
            self.node_labels,
            blocks,
            groups["node"],
            {name: np.sort(new_number[rows]) for name, rows in groups["element"].items()},
        )

    def _group_names(self, kind: str, instance_names: dict[str, str]) -> list[tuple[str, str, str]]:
        # (name, scope, upper-case name) of every set of a kind
        found: dict[tuple[str, str], str] = {}  # (scope, upper) -> spelling
        for key, scopes in self.scopes.items():
            for scope in scopes:
                for (of, upper), spelling in scope.spelling.items():
                    if of == kind:
                        found.setdefault((key, upper), spelling)
        uppers = [upper for _, upper in found]

        def name(key: str, upper: str, spelling: str) -> str:
            shared = key and uppers.count(upper) > 1
            return f"{instance_names[key]}.{spelling}" if shared else spelling

        return [(name(*at, spelling), *at) for at, spelling in found.items()]

    def _members(self, kind: str, key: str, upper: str, above: tuple[str, ...]) -> Ints:
        if upper in above:
            raise FileError(self.path, f"set {upper} must not contain itself")
        rows: list[int] = []
        for scope in self.scopes[key]:
            for entry in scope.sets.get((kind, upper), []):
                at = entry.instance.upper() or key
                if at not in self.scopes and entry.text:  # the dot belongs to the name
                    entry = _Entry(entry.line, other=entry.text, kind=kind)
                    at = key
                if at not in self.scopes:
                    raise entry.line.error(f"there must be an instance {entry.instance!r}")
                if entry.ids is not None:
                    rows += self._ids(kind, at, entry)
                    continue
                rows += self._other(kind, key, at, entry, (*above, upper))
        return np.unique(np.array(rows, dtype=np.int64))

    def _ids(self, kind: str, at: str, entry: _Entry) -> list[int]:
        assert entry.ids is not None
        table = self.rows[kind]
        found = [table[at, i] for i in entry.ids if (at, i) in table]
        if len(found) < len(entry.ids) and len(entry.ids) == 1:
            raise entry.line.error(f"{kind} {entry.ids[0]} must be defined; is the file cut short?")
        if not found:
            raise entry.line.error(f"no {kind} is defined from {entry.ids[0]} to {entry.ids[-1]}")
        return found  # a generated range may run over gaps in the ids

    def _other(
        self, kind: str, key: str, at: str, entry: _Entry, above: tuple[str, ...]
    ) -> list[int]:
        # the members of another set, of the instance or of the scope itself
        of = entry.kind or kind
        upper = entry.other.upper()
        for where in dict.fromkeys((at, key)):
            if any((of, upper) in scope.sets for scope in self.scopes[where]):
                rows = self._members(of, where, upper, above if of == kind else ())
                if of == kind:
                    return [int(i) for i in rows]
                return sorted({n for i in rows for n in self.elements[i][2]})
        raise entry.line.error(f"there must be {of} set {entry.other!r}, it is not defined")


def _entry(line: DataLine, text: str, kind: str, instance: str) -> _Entry:
    # 12, name, instance.12 or instance.name
    head, dot, tail = text.rpartition(".")
    whole, name = (text, tail) if dot and head else ("", text)
    instance = head if whole else instance
    if name.isdigit():
        return _Entry(line, range(int(name), int(name) + 1), instance=instance, text=whole)
    return _Entry(line, other=name, kind=kind, instance=instance, text=whole)


def _transform(keyword: Keyword) -> _Transform:
    rotation, shift = np.eye(3), np.zeros(3)
    if len(keyword.data) > 2:
        raise keyword.error("an instance has a line of translation and one of rotation at most")
    if keyword.data:
        shift = np.array([keyword.data[0].number(k) for k in range(3)])
    if len(keyword.data) == 2:
        line = keyword.data[1]
        a = np.array([line.number(k) for k in range(3)])
        b = np.array([line.number(k) for k in range(3, 6)])
        length = float(np.linalg.norm(b - a))
        if length == 0.0:
            raise line.error("the axis of rotation must have two different points")
        turn = scipy.spatial.transform.Rotation.from_rotvec(
            (b - a) / length * radians(line.number(6))
        )
        rotation = turn.as_matrix()
        # first the translation, then the rotation about the axis from a to b
        shift = rotation @ (shift - a) + a
    return rotation, shift
