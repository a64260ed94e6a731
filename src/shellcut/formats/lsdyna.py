"""LS-DYNA keyword files (.k, .key, .dyn): nodes, shells, parts and their sets.

The reader uses *NODE, *ELEMENT_SHELL with the options that change no node, *PART, *SET_NODE,
*SET_SHELL and *SET_PART (as LIST, COLUMN, LIST_GENERATE; each with _TITLE) and *INCLUDE. Any
other *ELEMENT is counted; the caller refuses it or leaves it out. Everything else (materials,
sections, control, contact) is named in a note.

A set is named by its title, otherwise ``node_set_3`` and the like; a part by its title, otherwise
``part_3``.

The syntax follows the LS-DYNA Keyword User's Manual, Vol. I, "Introduction": ``$`` begins a
comment, a card with a comma is in free format, ``*END`` ends the input. Three layouts of fixed
columns exist: the standard one, ``i10`` and ``long``, chosen by ``*KEYWORD`` (``I10=Y``, ``LONG=Y``
or ``LONG=S``) and, for one keyword, by a mark after its name (``-`` standard, ``%`` i10, ``+``
long).
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from itertools import accumulate
from pathlib import Path
from typing import Literal

import numpy as np

from shellcut.arrays import Ints

from .deck import Block, Deck, Line, attached
from .errors import FileError, named
from .file_mesh import QUAD, CellBlock, FileMesh, Numbering, unique_names, unused_note

Layout = Literal["standard", "i10", "long"]
_MARKS: dict[str, Layout] = {"-": "standard", "%": "i10", "+": "long"}
_CHOSEN: dict[str, Layout] = {"LONG=Y": "long", "LONG=S": "standard", "I10=Y": "i10"}

# Field widths of node cards, shell cards and cards of eight fields.
_NODE: dict[Layout, list[int]] = {
    "standard": [8, 16, 16, 16, 8, 8],
    "i10": [10, 16, 16, 16, 10, 10],
    "long": [20, 20, 20, 20, 20, 20],
}
_SHELL: dict[Layout, list[int]] = {"standard": [8] * 10, "i10": [10] * 10, "long": [20] * 10}
_EIGHT: dict[Layout, list[int]] = {"standard": [10] * 8, "i10": [10] * 8, "long": [20] * 8}

# Options of *ELEMENT_SHELL that add one card to each element and do not change its nodes.
_SHELL_CARDS = {"THICKNESS": 1, "BETA": 1, "MCID": 1, "OFFSET": 1, "DOF": 1}

_MOVES_MESH = (
    *("NODE_TRANSFORM", "NODE_MERGE", "NODE_MERGE_SET", "NODE_MERGE_TOLERANCE", "PART_MOVE"),
    *("ELEMENT_GENERATE_SHELL", "ELEMENT_SHELL_SOURCE_SINK"),
)
_SILENT = ("TITLE",)
_QUADRATIC = "ELEMENT_SHELL of 5 to 8 nodes"
_SPELLED = (
    *("NODE", "ELEMENT_SHELL", "PART"),
    *(f"SET_{kind}_LIST{title}" for kind in ("NODE", "SHELL", "PART") for title in ("", "_TITLE")),
)
_CLOSE = 0.85  # similarity from which an unknown keyword is taken for a misspelt one
_OTHER_SETS = ("BEAM", "SOLID", "TSHELL", "DISCRETE", "SEGMENT", "2D", "BOX", "MODE", "PERI")
_CLOSE_SET = 0.6
_NONE: Ints = np.empty(0, dtype=np.int64)


def read_lsdyna(path: str | Path) -> FileMesh:
    """Read an LS-DYNA keyword file."""
    reader = _Reader(Path(path))
    blocks = list(_blocks(reader, reader.path, "standard"))
    if not blocks:
        raise FileError(path, "an LS-DYNA file must hold *KEYWORD lines, got none")
    for block in blocks:
        if block.name != "END":
            reader.take(block)
    mesh = reader.mesh()
    if not any(block.name == "END" and block.path == reader.path for block in blocks):
        mesh.notes.append("there is no *END: the file may be cut short")
    return mesh


class _Reader(Deck):
    def __init__(self, path: Path):
        super().__init__(path)
        self.node_ids: list[int] = []
        self.positions: list[list[float]] = []
        self.shells: list[tuple[int, int, list[int], bool]] = []  # id, part, corners, quadratic
        self.others: dict[str, list[int]] = defaultdict(list)
        self.part_titles: dict[int, str] = {}
        self.sets: dict[str, list[CardBlock]] = {"NODE": [], "SHELL": [], "PART": []}

    def take(self, block: CardBlock) -> None:
        name = block.name
        match name.split("_"):
            case _ if name in _MOVES_MESH:
                raise block.error(
                    "generates or moves nodes and elements, which is not read; write the final "
                    "mesh out (LS-PrePost: save keyword)"
                )
            case ["NODE"]:
                self._nodes(block)
            case ["ELEMENT", "SHELL", *_]:
                self._shells(block)
            case ["ELEMENT", *_]:
                # the id on each card, 0 on a continuation card
                ids = (re.match(r"\s*(\d{1,20})", c.text) for c in block.data if c.text.strip())
                self.others[name] += [int(found[1]) if found else 0 for found in ids]
            case ["PART", *_]:
                self._parts(block)
            case ["SET", kind, *_]:
                self._set(block, kind)
            case _ if name not in _SILENT:
                is_new = f"*{name}" not in self.unused
                if is_new and (near := get_close_matches(name, _SPELLED, 1, _CLOSE)):
                    raise block.error(f"keywords must be spelt out; did you mean *{near[0]}?")
                self.unused[f"*{name}"] += 1

    def _set(self, block: CardBlock, kind: str) -> None:
        if kind in self.sets:
            self.sets[kind].append(block)
            return
        near = get_close_matches(kind, self.sets, 1, _CLOSE_SET)
        if near and kind not in _OTHER_SETS:
            raise block.error(f"keywords must be spelt out; did you mean *SET_{near[0]}?")
        self.unused[f"*{block.name}"] += 1

    def _nodes(self, block: CardBlock) -> None:
        n_constrained = 0
        for card in block.data:
            entries = card.fields(_NODE[block.layout])
            if not any(entries):
                continue
            self.node_ids.append(_id(card, entries[0], "the node id"))
            self.positions.append([card.decimal(e, "a coordinate") for e in entries[1:4]])
            n_constrained += any(entry.strip("0.") for entry in entries[4:])
        self.unused["constraints TC, RC on cards of nodes"] += n_constrained

    def _shells(self, block: CardBlock) -> None:
        options = [option for option in block.name.split("_")[2:] if option]
        if unknown := [option for option in options if option not in _SHELL_CARDS]:
            raise block.error(
                f"options must be among {', '.join(_SHELL_CARDS)}, got {', '.join(unknown)}"
            )
        # thickness, angle and system share a card
        shared = {"THICKNESS", "BETA", "MCID"}
        self.unused.update(f"*ELEMENT_SHELL_{option}" for option in options)
        more = bool(shared & set(options)) + sum(option not in shared for option in options)
        cards = [card for card in block.data if card.text.strip()]
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
            if min(nodes[:3]) < 1:
                raise card.error(f"element {shell} must have 3 or 4 nodes, got {nodes[:4]}")
            self.shells.append((shell, part, [*nodes[:3], nodes[3] or nodes[2]], any(nodes[4:])))

    def _parts(self, block: CardBlock) -> None:
        plain = block.name == "PART"
        if not plain:
            self.unused[f"option of *{block.name}"] += 1
        cards = block.data
        if len(cards) < 2 or (plain and len(cards) % 2):
            raise block.error("each part must have a title and a card; is the file cut short?")
        # further options add their own cards: only the first part is then named
        for title, card in zip(cards[::2], cards[1::2], strict=False):
            part = card.integer(card.fields(_EIGHT[block.layout])[0], "the part id")
            self.part_titles[part] = title.text.strip()
            if not plain:
                break

    # --- the mesh ---------------------------------------------------------------------------------

    def mesh(self) -> FileMesh:
        positions = np.array(self.positions, dtype=np.float64).reshape(-1, 3)
        nodes = Numbering(self.path, "node", self.node_ids, positions)
        self.shells.sort(key=lambda shell: shell[3])  # those of four nodes first, in their order
        shells = Numbering(self.path, "shell", [shell for shell, *_ in self.shells])
        corners = nodes.rows(np.array([n for _, _, n, _ in self.shells]).reshape(-1, 4), "shells")
        parts = np.array([part for _, part, *_ in self.shells], dtype=np.int64)

        order = np.argsort(parts, kind="stable").astype(np.int64)
        of_parts, first = np.unique(parts[order], return_index=True)
        each = zip(of_parts.tolist(), np.split(order, first[1:]), strict=False)
        members_of: dict[int, Ints] = dict(each)

        self.notes += unused_note(+self.unused)
        if lost := sorted(set(parts.tolist()) - set(self.part_titles)) if self.part_titles else []:
            self.notes.append(f"shells are of parts {named(lost)}, which no *PART defines")

        node_sets = self._sets_of("node", nodes)
        cell_sets = [
            (self.part_titles.get(part) or f"part_{part}", part, shells)
            for part, shells in members_of.items()
        ]
        cell_sets += self._sets_of("shell", shells)
        for name, sid, members in self._sets_of("part", None):
            rows = [members_of.get(part, _NONE) for part in members.tolist()]
            self.budget.take("ids in its sets", sum(map(len, rows)))
            cell_sets.append((name, sid, np.concatenate([*rows, _NONE])))
        # a triangle is a quad with its last corner repeated, as in the file
        n = sum(not quadratic for *_, quadratic in self.shells)
        blocks = [
            CellBlock(kind, shells.labels[rows], corners[rows], QUAD)
            for kind, rows in ((QUAD, slice(n)), (_QUADRATIC, slice(n, None)))
            if len(corners[rows])
        ]
        blocks += [
            CellBlock(kind, ids, np.empty((len(ids), 0), np.int64))
            for kind, ids in self.others.items()
        ]
        return FileMesh(
            self.path,
            positions,
            nodes.labels,
            blocks,
            unique_names(node_sets),
            unique_names(cell_sets),
            self.notes,
        )

    def _sets_of(self, kind: str, numbers: Numbering | None) -> list[tuple[str, int, Ints]]:
        # (name, id, rows) of every set of a kind; part sets keep their ids
        found: list[tuple[str, int, Ints]] = []
        for block in self.sets[kind.upper()]:
            options = block.name.split("_")[2:]
            cards = [card for card in block.data if card.text.strip()]
            title = ""
            if "TITLE" in options:
                options.remove("TITLE")
                title = cards.pop(0).text.strip() if cards else ""
            if not cards:
                raise block.error("a set must have an id; is the file cut short?")
            head = cards.pop(0)
            entries = head.fields(_EIGHT[block.layout])
            sid = _id(head, entries[0], "the set id")
            name = title or f"{kind}_set_{sid}"
            how = "_".join(option for option in options if option != "COLLECT") or "LIST"
            rows = self._rows(block, how, cards, numbers)
            if rows is None:
                self.notes.append(f"{kind} set {name!r} is left out: *{block.name} is not read")
                continue
            found.append((name, sid, rows))
        return found

    def _rows(
        self, block: CardBlock, how: str, cards: list[Card], numbers: Numbering | None
    ) -> Ints | None:
        match how:
            case "LIST":
                ids = _integers(block, cards)
            case "COLUMN":
                ids = [_id(card, card.fields(_EIGHT[block.layout])[0], "an id") for card in cards]
            case "LIST_GENERATE" | "GENERATE" if numbers is not None:
                return self._ranges(block, _integers(block, cards), numbers)
            case _:
                return None
        members: Ints = np.array(ids, dtype=np.int64)
        if numbers is None:
            return members
        return numbers.rows(members, f"*{block.name}, line {block.line},")

    def _ranges(self, block: CardBlock, ends: list[int], numbers: Numbering) -> Ints:
        if len(ends) % 2:
            raise block.error(f"ranges must have a first and a last id, got {len(ends)} ids")
        ranges = [_NONE]
        for a, b in zip(ends[::2], ends[1::2], strict=True):
            ranges.append(numbers.between(a, b))
            self.budget.take("ids in its sets", len(ranges[-1]))
        return np.concatenate(ranges)


def _integers(block: CardBlock, cards: list[Card]) -> list[int]:
    # zeros and blanks are padding
    entries = [(card, entry) for card in cards for entry in card.fields(_EIGHT[block.layout])]
    return [value for card, entry in entries if (value := card.integer(entry, "an id"))]


def _id(card: Card, entry: str, what: str) -> int:
    value = card.integer(entry, what)
    if value < 1:
        raise card.error(f"{what} must be 1 or more, got {entry!r}; is the file cut short?")
    return value


# --- the syntax -----------------------------------------------------------------------------------


@dataclass
class Card(Line):
    """A line of data."""

    def fields(self, widths: list[int]) -> list[str]:
        """Return the entries without outer blanks: one per width, empty if missing."""
        if "," in self.text:
            entries = [entry.strip() for entry in self.text.split(",")]
            entries += [""] * (len(widths) - len(entries))
            if any(entries[len(widths) :]):
                raise self.error(f"a card must have {len(widths)} entries at most")
            return entries[: len(widths)]
        *starts, at = accumulate(widths, initial=0)
        if self.text[at:].strip():
            raise self.error(
                f"a card must end at column {at}, got {self.text[at:].strip()[:20]!r} beyond; is "
                "it in another layout (*KEYWORD LONG=Y, I10=Y)?"
            )
        return [self.text[k : k + n].strip() for k, n in zip(starts, widths, strict=True)]

    def integer(self, entry: str, what: str) -> int:
        """Return an entry as a whole number, 0 if it is empty."""
        return self.whole(entry, what) if entry else 0


@dataclass
class CardBlock(Block):
    """A keyword, with its options in the name, and its cards."""

    layout: Layout


def _blocks(deck: Deck, path: Path, layout: Layout) -> Iterator[CardBlock]:
    # the keywords of a file, its includes inserted
    with deck.reading(path) as lines:
        for block in attached(_parts(deck, path, lines, layout)):
            assert isinstance(block, CardBlock)
            match block.name:
                case "KEYWORD":
                    layout = block.layout
                case "INCLUDE_PATH" | "INCLUDE_PATH_RELATIVE":
                    deck.folders += [path.parent / name for name in _file_names(block)]
                case "INCLUDE":
                    for name in _file_names(block):
                        yield from _blocks(deck, deck.included(block, name), layout)
                case name if name.startswith("INCLUDE"):
                    raise block.error("is not read: only *INCLUDE and *INCLUDE_PATH are")
                case _:
                    yield block


def _parts(deck: Deck, path: Path, lines: list[str], layout: Layout) -> Iterator[CardBlock | Card]:
    # without comments and blank lines at the beginning; below a keyword a blank line is a card
    begun = False
    for number, line in enumerate(lines, start=1):
        text = line.rstrip()
        if text.startswith("$") or (not text and not begun):
            continue
        if not text.startswith("*"):
            yield Card(path, number, text.expandtabs(8))
            continue
        begun, block = True, _keyword(path, number, text, layout)
        yield block
        if block.name == "KEYWORD":
            layout = block.layout
        if block.name == "END":
            break


def _keyword(path: Path, number: int, text: str, layout: Layout) -> CardBlock:
    name = text[1:].strip().upper()
    if name.startswith("KEYWORD"):
        options = name[len("KEYWORD") :].replace(" ", "")
        chosen = next((_CHOSEN[key] for key in _CHOSEN if key in options), layout)
        return CardBlock(path, number, "KEYWORD", chosen)
    if name[-1:] in _MARKS:
        return CardBlock(path, number, name[:-1].strip(), _MARKS[name[-1]])
    return CardBlock(path, number, name, layout)


def _file_names(block: CardBlock) -> list[str]:
    # one per line; a line that ends in " +" continues in the next
    names, pending = [], ""
    for card in block.data:
        text = card.text.strip()
        if text.endswith(" +"):
            pending += text[:-2].strip()
        elif pending or text:
            names.append(pending + text)
            pending = ""
    if pending or not names:
        raise block.error("must name a file: is this one cut short?")
    return names
