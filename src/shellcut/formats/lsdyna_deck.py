"""The syntax of LS-DYNA keyword files: cards of fixed columns or with commas, includes, comments.

Follows the LS-DYNA Keyword User's Manual, Vol. I, "Introduction": ``$`` begins a comment, a card
with a comma is in free format, ``*END`` ends the input. Three layouts of fixed columns exist: the
standard one, ``i10`` and ``long``, chosen by ``*KEYWORD`` (``I10=Y``, ``LONG=Y`` or ``LONG=S``)
and, for one keyword, by a mark after its name (``-`` standard, ``%`` i10, ``+`` long).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from . import numerals
from .budget import Budget
from .errors import FileError, read_lines
from .losses import comment_note, is_numbers

Layout = Literal["standard", "i10", "long"]
_MARKS: dict[str, Layout] = {"-": "standard", "%": "i10", "+": "long"}
_DATA = ("*NODE", "*ELEMENT", "*SET_", "*PART")


@dataclass
class Card:
    """A line of data."""

    path: Path
    line: int
    text: str

    def error(self, problem: str) -> FileError:
        """Return the error that names this line."""
        return FileError(self.path, problem, line=self.line)

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
        try:
            return numerals.whole(entry) if entry else 0
        except ValueError:
            raise self.error(f"{what} must be a whole number, got {entry!r}") from None

    def number(self, entry: str, what: str) -> float:
        """Return an entry as a number, 0 if it is empty."""
        try:
            return numerals.number(entry.upper().replace("D", "E")) if entry else 0.0
        except ValueError:
            raise self.error(f"{what} must be a number, got {entry!r}") from None


@dataclass
class Block:
    """A keyword with its cards."""

    path: Path
    line: int
    name: str
    """In upper case, without the star, with its options."""
    layout: Layout
    cards: list[Card] = field(default_factory=list)

    def error(self, problem: str) -> FileError:
        """Return the error that names this line."""
        return FileError(self.path, f"*{self.name}: {problem}", line=self.line)


def read_deck(path: Path, notes: list[str], budget: Budget) -> tuple[list[Block], bool]:
    """Return the keyword blocks of a file, with its includes inserted.

    Parameters
    ----------
    path : Path
    notes : list of str
        Receives signs of lost data: data in comments.
    budget : Budget
        Counts files and lines.

    Returns
    -------
    blocks : list of Block
    ended : bool
        Whether the main file has an ``*END``.

    Raises
    ------
    FileError
        For a file that is no keyword file and for missing includes.
    """
    folders = [path.parent]
    blocks: list[Block] = []
    ended = False
    for block in _blocks(path, folders, "standard", [], notes, budget):
        ended |= block.name == "END" and block.path == path
        blocks.append(block)
    if not blocks:
        raise FileError(path, "an LS-DYNA file must hold *KEYWORD lines, got none")
    return [block for block in blocks if block.name != "END"], ended


def _blocks(
    path: Path,
    folders: list[Path],
    layout: Layout,
    above: list[Path],
    notes: list[str],
    budget: Budget,
) -> Iterator[Block]:
    if path.resolve() in above:
        raise FileError(path, "a file must not include itself")
    budget.descend("includes", len(above))
    here = [*above, path.resolve()]
    for block in _plain_blocks(path, layout, notes, budget):
        if block.name == "KEYWORD" or block.name.startswith("KEYWORD "):
            layout = block.layout
        elif block.name == "INCLUDE_PATH" or block.name == "INCLUDE_PATH_RELATIVE":
            folders += [path.parent / name for name in _file_names(block)]
        elif block.name == "INCLUDE":
            for name in _file_names(block):
                found = _find(block, name, folders)
                yield from _blocks(found, folders, layout, here, notes, budget)
        elif block.name.startswith("INCLUDE"):
            raise block.error("is not read: only *INCLUDE and *INCLUDE_PATH are")
        else:
            yield block


def _plain_blocks(path: Path, layout: Layout, notes: list[str], budget: Budget) -> Iterator[Block]:
    current: Block | None = None
    off: list[int] = []  # comments that look like data
    lines = read_lines(path)
    budget.take("files with those included")
    budget.take("lines with those of included files", len(lines))
    for number, line in enumerate(lines, start=1):
        text = line.rstrip()
        if text.startswith("$") or (not text and current is None):
            if is_numbers(text[1:]) or text[1:].startswith(_DATA):
                off.append(number)
            continue
        if not text.startswith("*"):
            if current is None:
                raise FileError(path, f"a keyword must come first, got {text[:30]!r}", line=number)
            current.cards.append(Card(path, number, text.expandtabs(8)))
            continue
        if current is not None:
            yield current
        current = _keyword(path, number, text, layout)
        if current.name.startswith("KEYWORD"):
            layout = current.layout
        if current.name == "END":
            break
    notes += comment_note(off)
    if current is not None:
        yield current


def _keyword(path: Path, number: int, text: str, layout: Layout) -> Block:
    name = text[1:].strip().upper()
    if name.startswith("KEYWORD"):
        options = name[len("KEYWORD") :].replace(" ", "")
        for key, chosen in (("LONG=Y", "long"), ("LONG=S", "standard"), ("I10=Y", "i10")):
            if key in options:
                return Block(path, number, "KEYWORD", _layout(chosen))
        return Block(path, number, "KEYWORD", layout)
    if name[-1:] in _MARKS:
        return Block(path, number, name[:-1].strip(), _MARKS[name[-1]])
    return Block(path, number, name, layout)


def _layout(name: str) -> Layout:
    return "long" if name == "long" else "i10" if name == "i10" else "standard"


def _file_names(block: Block) -> list[str]:
    # one per line; a line that ends in " +" continues in the next
    names, pending = [], ""
    for card in block.cards:
        text = card.text.strip()
        if text.endswith(" +"):
            pending += text[:-2].strip()
        elif pending or text:
            names.append(pending + text)
            pending = ""
    if pending or not names:
        raise block.error("must name a file: is this one cut short?")
    return names


def _find(block: Block, name: str, folders: list[Path]) -> Path:
    for folder in (block.path.parent, *folders):
        if (found := folder / name).is_file():
            return found
    raise block.error(f"the file {name!r} must lie beside {block.path}, but is not there")
