"""Combine parts, instances and sets of an Abaqus model into one mesh.

Part sets of an instance keep their name if it is unique among instances and assembly; otherwise
they are called ``instance.set``.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from dataclasses import dataclass, field

import numpy as np

from shellcut.arrays import Floats, Ints, product

from .abaqus_deck import DataLine
from .deck import Deck
from .errors import FileError, named
from .file_mesh import LINE, QUAD, TRIANGLE, CellBlock, FileMesh

KINDS: dict[str, tuple[str, int]] = {
    **dict.fromkeys(["S4", "S4R", "S4RS", "S4RSW", "S4R5", "S4T", "S4RT"], (QUAD, 4)),
    **dict.fromkeys(["M3D4", "M3D4R", "SFM3D4", "SFM3D4R"], (QUAD, 4)),
    **dict.fromkeys(["CPS4", "CPS4R", "CPS4I", "CPE4", "CPE4R", "CPE4I"], (QUAD, 4)),
    **dict.fromkeys(["S3", "S3R", "S3RS", "S3T", "S3RT", "STRI3"], (TRIANGLE, 3)),
    **dict.fromkeys(["M3D3", "CPS3", "CPE3", "SFM3D3"], (TRIANGLE, 3)),
    **dict.fromkeys(["T3D2", "T2D2"], (LINE, 2)),
}
"""Three- and four-node shells of any formulation, and the trusses that mesh programs write for
curves, with kind and number of nodes; the film's formulation replaces theirs."""

QUADRATIC: dict[str, tuple[str, int]] = {
    **dict.fromkeys(["S8R", "S8R5", "S8RT", "M3D8", "M3D8R", "SFM3D8", "SFM3D8R"], (QUAD, 8)),
    **dict.fromkeys(["CPS8", "CPS8R", "CPE8", "CPE8R"], (QUAD, 8)),
    **dict.fromkeys(["S9R5", "M3D9", "M3D9R"], (QUAD, 9)),
    **dict.fromkeys(["STRI65", "M3D6", "SFM3D6", "CPS6", "CPE6"], (TRIANGLE, 6)),
}
"""Quadratic kinds: that of their corners, which come first, and number of nodes."""

Transform = tuple[Floats, Floats]
"""Rotation R, shape (3, 3), and translation t, shape (3,): x = R X + t."""


@dataclass
class Scope:
    """The nodes, elements and sets of a part, an instance or the assembly."""

    name: str
    nodes: dict[int, tuple[float, float, float]] = field(default_factory=dict)
    elements: dict[int, tuple[str, list[int]]] = field(default_factory=dict)
    sets: dict[tuple[str, str], list[Entry]] = field(default_factory=dict)
    """By kind ("node" or "element") and upper-case name."""
    spelling: dict[tuple[str, str], str] = field(default_factory=dict)
    """Names of the sets to pass on."""


@dataclass
class Entry:
    """One entry of a set: ids, or the name of another set, possibly of another instance."""

    line: DataLine
    ids: range | None = None
    other: str = ""
    kind: str = ""
    instance: str = ""
    text: str = ""
    """The original text, if a dot was read as separator of instance and name."""


@dataclass
class Instance:
    """A placed part, with the assembly's additions."""

    name: str
    part: str
    transform: Transform
    own: Scope


class Model:
    """All placed scopes; nodes and elements are numbered in order of appearance."""

    def __init__(self, deck: Deck):
        self.path, self.notes, self.budget = deck.path, deck.notes, deck.budget
        self._known: dict[tuple[str, str, str], Ints] = {}  # members of sets
        self.positions: list[Floats] = []
        self.node_labels: list[str] = []
        self.rows: dict[str, dict[tuple[str, int], int]] = {"node": {}, "element": {}}
        self.elements: list[tuple[str, str, list[int]]] = []  # label, type, node rows
        self.scopes: dict[str, list[Scope]] = defaultdict(list)

    def add(self, key: str, scope: Scope, transform: Transform | None) -> None:
        """Add a scope: an instance by its upper-case name, or the assembly with ""."""
        self.scopes[key].append(scope)
        prefix = f"{scope.name}." if scope.name else ""
        positions = np.array(list(scope.nodes.values()), dtype=np.float64).reshape(-1, 3)
        if transform is not None:
            positions = product(positions, transform[0].T) + transform[1]
        self.positions.append(positions)
        for label in scope.nodes:
            if (key, label) in self.rows["node"]:
                raise FileError(self.path, f"node {prefix}{label} must be defined once")
            self.rows["node"][key, label] = len(self.node_labels)
            self.node_labels.append(f"{prefix}{label}")
        for label, (kind, nodes) in scope.elements.items():
            if (key, label) in self.rows["element"]:
                raise FileError(self.path, f"element {prefix}{label} must be defined once")
            if lost := [n for n in nodes if (key, n) not in self.rows["node"]]:
                raise FileError(
                    self.path,
                    f"element {prefix}{label} must have nodes that are defined, got {named(lost)}; "
                    "is the file cut short?",
                )
            self.rows["element"][key, label] = len(self.elements)
            members = [self.rows["node"][key, n] for n in nodes]
            self.elements.append((f"{prefix}{label}", kind, members))

    def mesh(self, instance_names: dict[str, str]) -> FileMesh:
        """Return the mesh; ``instance_names``: original spelling by upper-case name."""
        by_kind: dict[str, list[int]] = defaultdict(list)
        for i, (_, kind, _) in enumerate(self.elements):
            by_kind[kind].append(i)
        blocks, new_number, n_cell = [], np.zeros(len(self.elements), np.int64), 0
        for kind, members in by_kind.items():
            new_number[members] = n_cell + np.arange(len(members))
            n_cell += len(members)
            labels = [self.elements[i][0] for i in members]
            nodes = np.array([self.elements[i][2] for i in members], dtype=np.int64)
            known, _ = KINDS.get(kind, (kind, 0))
            corners, _ = QUADRATIC.get(kind, ("", 0))
            blocks.append(CellBlock(known, labels, nodes, corners))
            if known in (TRIANGLE, QUAD) and not kind.startswith(("S3", "S4", "STRI")):
                self.notes.append(
                    f"{len(members)} elements of type {kind}, which do not bend, are read as shells"
                )
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
            list(dict.fromkeys(self.notes)),
        )

    def _group_names(self, kind: str, instance_names: dict[str, str]) -> list[tuple[str, str, str]]:
        # (name, scope, upper-case name) of every set of a kind
        found: dict[tuple[str, str], str] = {}  # (scope, upper) -> spelling
        for key, scopes in self.scopes.items():
            for scope in scopes:
                for (of, upper), spelling in scope.spelling.items():
                    if of == kind:
                        found.setdefault((key, upper), spelling)
        n_scope = Counter(upper for _, upper in found)

        def name(key: str, upper: str, spelling: str) -> str:
            shared = key and n_scope[upper] > 1
            return f"{instance_names[key]}.{spelling}" if shared else spelling

        return [(name(*at, spelling), *at) for at, spelling in found.items()]

    def _members(self, kind: str, key: str, upper: str, above: tuple[str, ...]) -> Ints:
        if upper in above:
            raise FileError(self.path, f"set {upper} must not contain itself")
        self.budget.descend("sets", len(above))
        if (kind, key, upper) in self._known:
            return self._known[kind, key, upper]
        rows: list[int] = []
        for scope in self.scopes[key]:
            for entry in scope.sets.get((kind, upper), []):
                at = entry.instance.upper() or key
                if at not in self.scopes and entry.text:  # the dot is part of the name
                    entry = Entry(entry.line, other=entry.text, kind=kind)
                    at = key
                if at not in self.scopes:
                    raise entry.line.error(f"there must be an instance {entry.instance!r}")
                if entry.ids is not None:
                    rows += self._ids(kind, at, entry)
                    continue
                rows += self._other(kind, key, at, entry, (*above, upper))
        members = np.unique(np.array(rows, dtype=np.int64))
        self._known[kind, key, upper] = members
        return members

    def _ids(self, kind: str, at: str, entry: Entry) -> list[int]:
        assert entry.ids is not None
        table = self.rows[kind]
        found = [table[at, i] for i in entry.ids if (at, i) in table]
        if len(found) < len(entry.ids) and len(entry.ids) == 1:
            raise entry.line.error(f"{kind} {entry.ids[0]} must be defined; is the file cut short?")
        if not found:
            raise entry.line.error(f"no {kind} is defined from {entry.ids[0]} to {entry.ids[-1]}")
        if len(found) < len(entry.ids):  # a generated range may include gaps in the ids
            self.notes.append(
                f"line {entry.line.line}: {len(entry.ids) - len(found)} of the {len(entry.ids)} "
                f"{kind}s from {entry.ids[0]} to {entry.ids[-1]} are not defined"
            )
        return found

    def _other(
        self, kind: str, key: str, at: str, entry: Entry, above: tuple[str, ...]
    ) -> list[int]:
        # the members of another set, of the instance or of the scope itself
        of = entry.kind or kind
        upper = entry.other.upper()
        for where in dict.fromkeys((at, key)):
            if any((of, upper) in scope.sets for scope in self.scopes[where]):
                rows = self._members(of, where, upper, above if of == kind else ())
                self.budget.take("ids in its sets", len(rows))
                if of == kind:
                    return [int(i) for i in rows]
                return sorted({n for i in rows for n in self.elements[i][2]})
        raise entry.line.error(f"there must be {of} set {entry.other!r}, but it is not defined")
