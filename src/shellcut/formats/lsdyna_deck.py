"""The syntax of LS-DYNA keyword files: cards of fixed columns or with commas, includes, comments.

Follows the LS-DYNA Keyword User's Manual, Vol. I, "Introduction": ``$`` begins a comment, a card
with a comma is in free format, ``*END`` ends the input. Three layouts of fixed columns exist: the
standard one, ``i10`` and ``long``, chosen by ``*KEYWORD`` (``I10=Y``, ``LONG=Y`` or ``LONG=S``)
and, for one keyword, by a mark after its name (``-`` standard, ``%`` i10, ``+`` long).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

from .deck import Block, Deck, Line, attached
from .errors import FileError
from .losses import comment_note, is_numbers

Layout = Literal["standard", "i10", "long"]
_MARKS: dict[str, Layout] = {"-": "standard", "%": "i10", "+": "long"}
_CHOSEN: dict[str, Layout] = {"LONG=Y": "long", "LONG=S": "standard", "I10=Y": "i10"}
_DATA = ("*NODE", "*ELEMENT", "*SET_", "*PART")


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
        entries, at = [], 0
        for width in widths:
            entries.append(self.text[at : at + width].strip())
            at += width
        if self.text[at:].strip():
            raise self.error(
                f"a card must end at column {at}, got {self.text[at:].strip()[:20]!r} beyond; is "
                "it in another layout (*KEYWORD LONG=Y, I10=Y)?"
            )
        return entries

    def integer(self, entry: str, what: str) -> int:
        """Return an entry as a whole number, 0 if it is empty."""
        return self.whole(entry, what) if entry else 0


@dataclass
class CardBlock(Block):
    """A keyword, with its options in the name, and its cards."""

    layout: Layout


def read_deck(deck: Deck) -> tuple[list[CardBlock], bool]:
    """Return the keywords of a file, its includes inserted, and whether it has an ``*END``."""
    blocks = list(_blocks(deck, deck.path, "standard"))
    if not blocks:
        raise FileError(deck.path, "an LS-DYNA file must hold *KEYWORD lines, got none")
    ended = any(block.name == "END" and block.path == deck.path for block in blocks)
    return [block for block in blocks if block.name != "END"], ended


def _blocks(deck: Deck, path: Path, layout: Layout) -> Iterator[CardBlock]:
    with deck.reading(path) as lines:
        for block in attached(_parts(deck, path, lines, layout)):
            assert isinstance(block, CardBlock)
            if block.name == "KEYWORD":
                layout = block.layout
            elif block.name in ("INCLUDE_PATH", "INCLUDE_PATH_RELATIVE"):
                deck.folders += [path.parent / name for name in _file_names(block)]
            elif block.name == "INCLUDE":
                for name in _file_names(block):
                    yield from _blocks(deck, deck.included(block, name), layout)
            elif block.name.startswith("INCLUDE"):
                raise block.error("is not read: only *INCLUDE and *INCLUDE_PATH are")
            else:
                yield block


def _parts(deck: Deck, path: Path, lines: list[str], layout: Layout) -> Iterator[CardBlock | Card]:
    # without comments and blank lines at the beginning; below a keyword a blank line is a card
    off: list[int] = []  # comments that look like data
    begun = False
    for number, line in enumerate(lines, start=1):
        text = line.rstrip()
        if text.startswith("$") or (not text and not begun):
            if is_numbers(text[1:]) or text[1:].startswith(_DATA):
                off.append(number)
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
    deck.notes += comment_note(off)


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
