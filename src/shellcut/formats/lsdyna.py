"""LS-DYNA keyword files (.k, .key, .dyn): nodes, shells, parts and their sets.

Read are *NODE, *ELEMENT_SHELL with the options that change no node, *PART, *SET_NODE, *SET_SHELL
and *SET_PART (as LIST, COLUMN, LIST_GENERATE, GENERAL by ids and parts, ADD; each with _TITLE) and
*INCLUDE. Any other *ELEMENT is counted, to be refused or left out by choice. Everything else
(materials, control, contact) is passed over.

A set is called by its title, otherwise ``node_set_3`` and the like; a part by its title, otherwise
``part_3``.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from shellcut.arrays import Ints

from .errors import named
from .file_mesh import QUAD, CellBlock, FileMesh, Numbering, unique_names
from .losses import blank_note, gap_note, ragged_note, repeat_note
from .lsdyna_deck import Block, Card, Layout, read_deck

# Field widths of the cards of a node and of a shell, and of cards of eight fields.
_NODE: dict[Layout, list[int]] = {
    "standard": [8, 16, 16, 16, 8, 8],
    "i10": [10, 16, 16, 16, 10, 10],
    "long": [20, 20, 20, 20, 20, 20],
}
_SHELL: dict[Layout, list[int]] = {"standard": [8] * 10, "i10": [10] * 10, "long": [20] * 10}
_EIGHT: dict[Layout, list[int]] = {"standard": [10] * 8, "i10": [10] * 8, "long": [20] * 8}

# Options of *ELEMENT_SHELL that add one card each to an element and leave its nodes alone.
_SHELL_CARDS = {"THICKNESS": 1, "BETA": 1, "MCID": 1, "OFFSET": 1, "DOF": 1}

_MOVES_MESH = frozenset(
    [
        "NODE_TRANSFORM",
        "NODE_MERGE",
        "NODE_MERGE_SET",
        "NODE_MERGE_TOLERANCE",
        "ELEMENT_GENERATE_SHELL",
        "ELEMENT_SHELL_SOURCE_SINK",
        "PARAMETER",
        "PARAMETER_EXPRESSION",
        "PART_MOVE",
    ]
)
_SPELLED = (
    *("NODE", "ELEMENT_SHELL", "PART"),
    *(f"SET_{kind}_LIST{title}" for kind in ("NODE", "SHELL", "PART") for title in ("", "_TITLE")),
)
_CLOSE = 0.85  # likeness at which an unknown keyword is taken for a misspelt one
_OTHER_SETS = ("BEAM", "SOLID", "TSHELL", "DISCRETE", "SEGMENT", "2D", "BOX", "MODE", "PERI")
_CLOSE_SET = 0.6
_HEAD = 5  # entries of the card of a set's id: the id and four attributes


def read_lsdyna(path: str | Path) -> FileMesh:
    """Read an LS-DYNA keyword file.

    Raises
    ------
    FileError
        Naming file and line of what is wrong, missing or made by a keyword that is not read.
    """
    reader = _Reader(Path(path))
    blocks, ended = read_deck(reader.path, reader.notes)
    for block in blocks:
        reader.take(block)
    mesh = reader.mesh()
    if not ended:
        mesh.notes.append("there is no *END: the file may be cut short")
    return mesh


class _Reader:
    def __init__(self, path: Path):
        self.path = path
        self.node_ids: list[int] = []
        self.positions: list[list[float]] = []
        self.shells: list[tuple[int, int, list[int]]] = []  # id, part, nodes
        self.others: dict[str, list[int]] = defaultdict(list)
        self.part_titles: dict[int, str] = {}
        self.sets: dict[str, list[Block]] = {"NODE": [], "SHELL": [], "PART": []}
        self.notes: list[str] = []

    def take(self, block: Block) -> None:
        name = block.name
        first, _, rest = name.partition("_")
        if name in _MOVES_MESH:
            raise block.error(
                "makes or moves nodes and elements by rule, which is not read; write the mesh out "
                "as it is after that (LS-PrePost: save keyword)"
            )
        if name == "NODE":
            self._nodes(block)
        elif name == "ELEMENT_SHELL" or name.startswith("ELEMENT_SHELL_"):
            self._shells(block)
        elif first == "ELEMENT":
            self.others[name] += [_first_number(card) for card in block.cards if card.text.strip()]
        elif name == "PART" or name.startswith("PART_"):
            self._parts(block)
        elif first == "SET":
            self._set(block, rest.split("_")[0])
        elif near := get_close_matches(name, _SPELLED, 1, _CLOSE):
            raise block.error(f"keywords must be spelt out; did you mean *{near[0]}?")

    def _set(self, block: Block, kind: str) -> None:
        if kind in self.sets:
            self.sets[kind].append(block)
        elif kind not in _OTHER_SETS:
            if near := get_close_matches(kind, self.sets, 1, _CLOSE_SET):
                raise block.error(f"keywords must be spelt out; did you mean *SET_{near[0]}?")
            self.notes.append(f"line {block.line}: *{block.name} is not read")

    def _nodes(self, block: Block) -> None:
        given = []
        for card in block.cards:
            entries = card.fields(_NODE[block.layout])
            if not any(entries):
                continue
            self.node_ids.append(_id(card, entries[0], "the node id"))
            self.positions.append([card.number(e, "a coordinate") for e in entries[1:4]])
            given.append(sum(map(bool, entries[1:4])))
        self.notes += blank_note("nodes", given, self.node_ids[-len(given) :])

    def _shells(self, block: Block) -> None:
        options = [option for option in block.name.split("_")[2:] if option]
        unknown = [option for option in options if option not in _SHELL_CARDS]
        if unknown:
            raise block.error(
                f"options must be among {', '.join(_SHELL_CARDS)}, got {', '.join(unknown)}"
            )
        # thickness, angle and system share a card
        shared = {"THICKNESS", "BETA", "MCID"}
        more = bool(shared & set(options)) + sum(option not in shared for option in options)
        cards = [card for card in block.cards if card.text.strip()]
        if len(cards) % (1 + more):
            raise block.error(
                f"each element must have {1 + more} cards, got {len(cards)} cards; is the file cut "
                "short?"
            )
        for card in cards[:: 1 + more]:
            entries = card.fields(_SHELL[block.layout])
            shell = _id(card, entries[0], "the element id")
            part = card.integer(entries[1], "the part id")
            nodes = [card.integer(e, "a node id") for e in entries[2:]]
            if any(nodes[4:]):
                self.others["ELEMENT_SHELL of 5 to 8 nodes"].append(shell)
                continue
            if min(nodes[:3]) < 1:
                raise card.error(f"element {shell} must have 3 or 4 nodes, got {nodes[:4]}")
            self.shells.append((shell, part, [*nodes[:3], nodes[3] or nodes[2]]))

    def _parts(self, block: Block) -> None:
        plain = block.name == "PART"
        cards = block.cards
        if len(cards) < 2 or (plain and len(cards) % 2):
            raise block.error("each part must have a title and a card; is the file cut short?")
        # further options add cards of their own: of those only the first part is named
        for title, card in zip(cards[::2], cards[1::2], strict=False):
            part = card.integer(card.fields(_EIGHT[block.layout])[0], "the part id")
            self.part_titles[part] = title.text.strip()
            if not plain:
                break

    # --- the mesh ---------------------------------------------------------------------------------

    def mesh(self) -> FileMesh:
        nodes = Numbering(self.path, "node", self.node_ids)
        shells = Numbering(self.path, "shell", [shell for shell, _, _ in self.shells])
        corners = nodes.rows(np.array([n for _, _, n in self.shells]).reshape(-1, 4), "shells")
        parts = np.array([part for _, part, _ in self.shells], dtype=np.int64)

        def shells_of(part: int) -> Ints:
            return np.flatnonzero(parts == part).astype(np.int64)

        def nodes_of(part: int) -> Ints:
            return np.unique(corners[parts == part])

        self.notes += gap_note("node", self.node_ids)
        self.notes += gap_note("shell", shells.labels.tolist())
        if lost := sorted(set(parts.tolist()) - set(self.part_titles)) if self.part_titles else []:
            self.notes.append(f"shells are of parts {named(lost)}, which no *PART defines")

        node_sets = _Sets(self.notes, "node", nodes, nodes_of).read(self.sets["NODE"])
        cell_sets = [
            (self.part_titles.get(part) or f"part_{part}", part, shells_of(part))
            for part in np.unique(parts).tolist()
        ]
        cell_sets += _Sets(self.notes, "shell", shells, shells_of).read(self.sets["SHELL"])
        for name, sid, members in _Sets(self.notes, "part", None, shells_of).read(
            self.sets["PART"]
        ):
            rows = [shells_of(part) for part in members.tolist()]
            cell_sets.append((name, sid, np.concatenate([*rows, _NONE])))
        # a triangle is a quad whose last corner repeats, as in the file
        blocks = [CellBlock(QUAD, shells.labels, corners)] if len(corners) else []
        for kind, ids in self.others.items():
            blocks.append(CellBlock(kind, ids, np.empty((len(ids), 0), np.int64)))
        return FileMesh(
            self.path,
            np.array(self.positions, dtype=np.float64).reshape(-1, 3),
            nodes.labels,
            blocks,
            {name: np.unique(rows) for name, rows in unique_names(node_sets).items()},
            {name: np.unique(rows) for name, rows in unique_names(cell_sets).items()},
            self.notes,
        )


_NONE: Ints = np.empty(0, dtype=np.int64)


class _Sets:
    # the sets of one kind; ids become rows, part sets keep their ids
    def __init__(
        self, notes: list[str], kind: str, ids: Numbering | None, of_part: Callable[[int], Ints]
    ):
        self.notes, self.kind, self.ids, self.of_part = notes, kind, ids, of_part

    def read(self, blocks: list[Block]) -> list[tuple[str, int, Ints]]:
        """Return (name, id, rows) of every set."""
        found: list[tuple[str, int, Ints]] = []
        adding: list[tuple[str, int, Block, list[Card]]] = []
        for block in blocks:
            options = block.name.split("_")[2:]
            cards = [card for card in block.cards if card.text.strip()]
            title = ""
            if "TITLE" in options:
                options.remove("TITLE")
                title = cards.pop(0).text.strip() if cards else ""
            if not cards:
                raise block.error("a set must have an id; is the file cut short?")
            head = cards.pop(0)
            entries = head.fields(_EIGHT[block.layout])
            sid = _id(head, entries[0], "the set id")
            name = title or f"{self.kind}_set_{sid}"
            if all(entry.isdigit() for entry in entries[: _HEAD + 1]):
                self.notes.append(
                    f"{self.kind} set {name!r}: the card of its id, line {head.line}, looks like "
                    "one of members: is a line lost?"
                )
            how = "_".join(option for option in options if option != "COLLECT") or "LIST"
            if how == "ADD":
                adding.append((name, sid, block, cards))
                continue
            rows = self._rows(block, how, cards)
            if rows is None:
                self.notes.append(
                    f"{self.kind} set {name!r} is left out: *{block.name} is not read"
                )
                continue
            found.append((name, sid, rows))
        known = {sid: rows for _, sid, rows in found}
        for name, sid, block, cards in adding:
            members = self._integers(block, cards)
            lost = [m for m in members if m not in known]
            if lost:
                raise block.error(f"must add sets that are read, got {lost}")
            found.append((name, sid, np.concatenate([known[m] for m in members] or [_NONE])))
        return found

    def _rows(self, block: Block, how: str, cards: list[Card]) -> Ints | None:
        if how == "LIST":
            ids = self._integers(block, cards)
            what = f"*{block.name} in line {block.line}"
            counts = [(card.line, len(self._integers(block, [card]))) for card in cards]
            self.notes += ragged_note(what, counts) + repeat_note(what, ids)
            return self._find(block, ids)
        if how == "COLUMN":
            widths = _EIGHT[block.layout]
            return self._find(block, [_id(card, card.fields(widths)[0], "an id") for card in cards])
        if how in ("LIST_GENERATE", "GENERATE") and self.ids is not None:
            ends = self._integers(block, cards)
            if len(ends) % 2:
                raise block.error(f"ranges must have a first and a last id, got {len(ends)} ids")
            ranges = [self.ids.between(a, b) for a, b in zip(ends[::2], ends[1::2], strict=True)]
            return np.concatenate([*ranges, _NONE])
        if how == "GENERAL" and self.ids is not None:
            return self._general(block, cards)
        return None

    def _general(self, block: Block, cards: list[Card]) -> Ints | None:
        # ALL, or ids and parts to take and (with a D) to leave, card by card
        assert self.ids is not None
        members: set[int] = set()
        single = "NODE" if self.kind == "node" else "ELEM"
        for card in cards:
            option, *entries = card.fields(_EIGHT[block.layout])
            option = option.upper()
            values = [v for e in entries if (v := card.integer(e, "an id"))]
            if option == "ALL":
                members |= set(range(len(self.ids.labels)))
            elif option in (single, "D" + single):
                rows = set(self._find(block, values).tolist())
                members = members - rows if option[0] == "D" else members | rows
            elif option in ("PART", "DPART"):
                rows = {int(r) for p in values for r in self.of_part(p)}
                members = members - rows if option[0] == "D" else members | rows
            else:
                return None
        return np.array(sorted(members), dtype=np.int64)

    def _find(self, block: Block, ids: list[int]) -> Ints:
        if self.ids is None:
            return np.array(ids, dtype=np.int64)
        return self.ids.rows(np.array(ids, dtype=np.int64), f"*{block.name}, line {block.line},")

    def _integers(self, block: Block, cards: list[Card]) -> list[int]:
        # zeros and blanks fill cards up
        return [
            value
            for card in cards
            for entry in card.fields(_EIGHT[block.layout])
            if (value := card.integer(entry, "an id"))
        ]


def _first_number(card: Card) -> int:
    # the id on a card that is only counted; 0 where the card goes on from the one before
    found = re.match(r"\s*(\d{1,20})", card.text)
    return int(found[1]) if found else 0


def _id(card: Card, entry: str, what: str) -> int:
    value = card.integer(entry, what)
    if value < 1:
        raise card.error(f"{what} must be 1 or more, got {entry!r}; is the file cut short?")
    return value
