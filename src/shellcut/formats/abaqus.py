"""Abaqus input files (.inp): nodes, shell elements and sets, of parts and of their instances.

The reader uses *NODE, *ELEMENT, *NSET, *ELSET (with GENERATE, sets of sets, sets named on *NODE and
*ELEMENT), *PART, *INSTANCE with translation and rotation, *ASSEMBLY and *INCLUDE. It refuses
keywords that generate nodes or elements, because the mesh would be incomplete without them, and
names everything else in a note (materials, sections, supports, steps).
:mod:`shellcut.formats.abaqus_model` combines instances and sets into one mesh.
"""

from __future__ import annotations

from difflib import get_close_matches
from math import radians
from pathlib import Path

import numpy as np
import scipy

from shellcut.arrays import norm, product

from .abaqus_deck import DataLine, Keyword, read_deck
from .abaqus_model import KINDS, QUADRATIC, Entry, Instance, Model, Scope, Transform
from .deck import Deck
from .errors import named
from .file_mesh import FileMesh, unused_note

_SILENT = ("HEADING", "END STEP", "PREPRINT")
_MAKES_MESH = (
    *("NGEN", "NFILL", "NCOPY", "NMAP", "ELGEN", "ELCOPY", "SYSTEM", "SUBSTRUCTURE GENERATE"),
    *("IMPORT", "IMPORT NODESET", "IMPORT ELSET", "MODEL CHANGE"),
)

# Keywords that are read, and parameters allowed on them.
_READ: dict[str, tuple[str, ...]] = {
    "NODE": ("INPUT", "NSET", "SYSTEM"),
    "ELEMENT": ("ELSET", "INPUT", "TYPE"),
    "NSET": ("NSET", "ELSET", "GENERATE", "INPUT", "INSTANCE", "INTERNAL", "UNSORTED"),
    "ELSET": ("ELSET", "GENERATE", "INPUT", "INSTANCE", "INTERNAL", "UNSORTED"),
    "PART": ("NAME",),
    "INSTANCE": ("NAME", "PART"),
    "ASSEMBLY": ("NAME",),
    "INCLUDE": ("INPUT", "PASSWORD"),
    **dict.fromkeys(("END PART", "END INSTANCE", "END ASSEMBLY"), ()),
}
_CLOSE = 0.7  # similarity from which an unknown parameter is taken for a misspelt one


def read_abaqus(path: str | Path) -> FileMesh:
    """Read an Abaqus input file."""
    reader = _Reader(Path(path))
    for keyword in read_deck(reader, frozenset(_READ)):
        reader.take(keyword)
    return reader.mesh()


class _Reader(Deck):
    def __init__(self, path: Path):
        super().__init__(path)
        self.top = Scope("")  # the assembly, or a whole file without parts
        self.scope = self.top  # what the nodes, elements and sets belong to that are read now
        self.parts: dict[str, Scope] = {}
        self.instances: dict[str, Instance] = {}
        self.open: list[Keyword] = []  # PART, ASSEMBLY and INSTANCE not yet ended

    # --- keywords ---------------------------------------------------------------------------------

    def take(self, keyword: Keyword) -> None:
        name = keyword.name
        known = _READ.get(name, ())
        for parameter in keyword.parameters if known else ():
            if parameter in known:
                continue
            if near := get_close_matches(parameter, known, 1, _CLOSE):
                raise keyword.error(
                    f"parameters must be spelt out, got {parameter!r}; did you mean {near[0]}?"
                )
            self.notes.append(
                f"line {keyword.line}: the parameter {parameter!r} of *{name} is not read"
            )
        match name:
            case "PART" | "ASSEMBLY" | "INSTANCE":
                self._begin(keyword)
            case "END PART" | "END ASSEMBLY" | "END INSTANCE":
                if not self.open or self.open[-1].name != name[4:]:
                    raise keyword.error(f"must end a *{name[4:]}, but none is open")
                self.open.pop()
                self.scope = self.top
            case "NODE":
                self._nodes(keyword)
            case "ELEMENT":
                self._elements(keyword)
            case "NSET" | "ELSET":
                self._set(keyword)
            case _ if name in _MAKES_MESH:
                raise keyword.error(
                    "generates or moves nodes and elements, which is not read; write the mesh out "
                    "node by node (in Abaqus/CAE: export the model as an orphan mesh)"
                )
            case _ if name not in _SILENT:
                self.unused[f"*{name}"] += 1

    def _begin(self, keyword: Keyword) -> None:
        within = [k.name for k in self.open]
        if within != (["ASSEMBLY"] if keyword.name == "INSTANCE" else []):
            raise keyword.error(f"must not occur within *{' *'.join(within) or '(nothing)'}")
        self.open.append(keyword)
        if keyword.name == "ASSEMBLY":
            return
        name = keyword.required("NAME")
        known = self.parts if keyword.name == "PART" else self.instances
        if name.upper() in known:
            raise keyword.error(f"the name must be new, got {name!r} again")
        if keyword.name == "PART":
            self.scope = self.parts[name.upper()] = Scope(name)
            return
        part = keyword.parameters.get("PART", "")
        if part and part.upper() not in self.parts:
            names = named(sorted(scope.name for scope in self.parts.values())) or "none"
            raise keyword.error(f"the part must be one of {names}, got {part!r}")
        self.scope = Scope(name)
        self.instances[name.upper()] = Instance(name, part.upper(), _transform(keyword), self.scope)

    def _nodes(self, keyword: Keyword) -> None:
        if keyword.parameters.get("SYSTEM", "R").upper() != "R":
            raise keyword.error("coordinates must be Cartesian (SYSTEM=R); write them out so")
        nodes, ids, n_normal = self.scope.nodes, [], 0
        for line in keyword.data:
            label = line.integer(0)
            if len(line.entries) > 7:
                raise line.error("a node must have an id, coordinates and at most a normal")
            place = line.number(1), line.number(2), line.number(3)
            if nodes.setdefault(label, place) != place:
                raise line.error(
                    f"node {label} must have one place, got {place} and {nodes[label]}"
                )
            ids.append((line, label))
            n_normal += any(line.entries[4:])
        self.unused["normals of nodes"] += n_normal
        self._named_on(keyword, "NSET", "node", ids)

    def _elements(self, keyword: Keyword) -> None:
        kind = keyword.required("TYPE").upper()
        _, n_node = (KINDS | QUADRATIC).get(kind, ("", 0))
        elements, ids = self.scope.elements, []
        lines = iter(keyword.data)
        for line in lines:
            label = line.integer(0)
            # other types are only counted: their nodes may have any form
            nodes = [line.integer(k) for k in range(1, len(line.entries))] if n_node else []
            last = line
            # read entries until all nodes are there; for other types, while lines end in a comma
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
                raise line.error(f"each element id must occur once, got {label} again")
            elements[label] = (kind, nodes)
            ids.append((line, label))
        self._named_on(keyword, "ELSET", "element", ids)

    def _named_on(
        self, keyword: Keyword, parameter: str, kind: str, ids: list[tuple[DataLine, int]]
    ) -> None:
        # *NODE, NSET=rim and *ELEMENT, ELSET=film name the data below them
        if parameter in keyword.parameters:
            entries = self._set_entries(kind, keyword.required(parameter))
            entries += [Entry(line, range(label, label + 1)) for line, label in ids]

    def _set_entries(self, kind: str, name: str, *, shown: bool = True) -> list[Entry]:
        # a repeated name extends the set
        scope = self.scope
        if shown:
            scope.spelling.setdefault((kind, name.upper()), name)
        return scope.sets.setdefault((kind, name.upper()), [])

    def _set(self, keyword: Keyword) -> None:
        kind = "node" if keyword.name == "NSET" else "element"
        # Abaqus/CAE marks its own sets as internal
        shown = "INTERNAL" not in keyword.parameters
        self.unused["internal sets"] += not shown
        entries = self._set_entries(kind, keyword.required(keyword.name), shown=shown)
        instance = keyword.parameters.get("INSTANCE", "")
        if "ELSET" in keyword.parameters and kind == "node":
            where = DataLine(keyword.path, keyword.line, "", [], False)
            entries.append(
                Entry(where, other=keyword.required("ELSET"), kind="element", instance=instance)
            )
        name = f"{kind} set {keyword.required(keyword.name)!r}"
        is_empty = not any(any(line.entries) for line in keyword.data)
        if is_empty and "ELSET" not in keyword.parameters.keys() - {keyword.name}:
            self.notes.append(f"{name} in line {keyword.line} is empty")
        for line in keyword.data:
            if "GENERATE" in keyword.parameters:
                first, last = line.integer(0), line.integer(1)
                step = line.integer(2) if len(line.entries) > 2 and line.entries[2] else 1
                if step < 1 or last < first or (last - first) % step:
                    raise line.error(
                        "GENERATE must have a first id, a last id and a step that divides their "
                        f"difference, got {first}, {last}, {step}"
                    )
                self.budget.take("ids in its sets", (last - first) // step + 1)
                entries.append(Entry(line, range(first, last + 1, step), instance=instance))
                continue
            entries += [_entry(line, text, kind, instance) for text in line.entries if text]

    # --- the model --------------------------------------------------------------------------------

    def mesh(self) -> FileMesh:
        if self.open:
            raise self.open[-1].error(f"must be ended by *END {self.open[-1].name}: cut short?")
        if self.parts and not self.instances:
            # a part file alone: each part once, untransformed
            for key, part in self.parts.items():
                still = np.eye(3), np.zeros(3)
                self.instances[key] = Instance(part.name, key, still, Scope(part.name))
        scopes = [self.parts[each.part] for each in self.instances.values() if each.part]
        self.budget.take(
            "nodes and elements with those of all instances",
            sum(len(scope.nodes) + len(scope.elements) for scope in scopes),
        )
        self.notes += unused_note(+self.unused)
        model = Model(self)
        model.add("", self.top, None)
        for key, instance in self.instances.items():
            if instance.part:
                model.add(key, self.parts[instance.part], instance.transform)
            model.add(key, instance.own, instance.transform)
        return model.mesh({key: instance.name for key, instance in self.instances.items()})


def _entry(line: DataLine, text: str, kind: str, instance: str) -> Entry:
    # 12, name, instance.12 or instance.name
    head, dot, tail = text.rpartition(".")
    whole, name = (text, tail) if dot and head else ("", text)
    instance = head if whole else instance
    if name.isdigit():
        return Entry(line, range(int(name), int(name) + 1), instance=instance, text=whole)
    return Entry(line, other=name, kind=kind, instance=instance, text=whole)


def _transform(keyword: Keyword) -> Transform:
    rotation, shift = np.eye(3), np.zeros(3)
    if len(keyword.data) > 2:
        raise keyword.error("an instance must have at most one line of translation and of rotation")
    if keyword.data:
        shift = np.array([keyword.data[0].number(k) for k in range(3)])
    if len(keyword.data) == 2:
        line = keyword.data[1]
        a = np.array([line.number(k) for k in range(3)])
        b = np.array([line.number(k) for k in range(3, 6)])
        length = float(norm(b - a))
        if length == 0.0:
            raise line.error("the axis of rotation must have two different points")
        turn = scipy.spatial.transform.Rotation.from_rotvec(
            (b - a) / length * radians(line.number(6))
        )
        rotation = turn.as_matrix()
        # first the translation, then the rotation about the axis from a to b
        shift = product(rotation, shift - a) + a
    return rotation, shift
