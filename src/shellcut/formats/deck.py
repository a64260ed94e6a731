"""Decks, the text input of Abaqus and LS-DYNA: keywords, the lines below them, included files.

:mod:`shellcut.formats.abaqus_deck` and :mod:`shellcut.formats.lsdyna` say how a line is written.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from . import numerals
from .budget import Budget
from .errors import FileError, read_lines


@dataclass
class Line:
    """A line of data."""

    path: Path
    line: int
    text: str

    def error(self, problem: str) -> FileError:
        """Return the error that names this line."""
        return FileError(self.path, problem, line=self.line)

    def whole(self, text: str, what: str) -> int:
        """Return an entry as a whole number."""
        try:
            return numerals.whole(text)
        except ValueError:
            raise self.error(f"{what} must be a whole number, got {text!r}") from None

    def decimal(self, text: str, what: str) -> float:
        """Return an entry as a number, 0 if it is empty."""
        try:
            return numerals.number(text.upper().replace("D", "E")) if text else 0.0
        except ValueError:
            raise self.error(f"{what} must be a number, got {text!r}") from None


@dataclass
class Block:
    """A keyword and the lines of data below it."""

    path: Path
    line: int
    name: str
    """In upper case, with single blanks, without the star."""
    data: list[Any] = field(default_factory=list, kw_only=True)

    def error(self, problem: str) -> FileError:
        """Return the error that names this line."""
        return FileError(self.path, f"*{self.name}: {problem}", line=self.line)


class Deck:
    """What is gathered while a file and those that it includes are read."""

    def __init__(self, path: Path):
        self.path = path
        self.budget = Budget(path)
        self.folders = [path.parent]
        """Where included files are searched, beside the folder of the file that includes them."""
        self.notes: list[str] = []
        """What is left out, or not defined."""
        self.unused: Counter[str] = Counter()
        """How often there is what no film takes."""
        self._within: list[Path] = []

    @contextmanager
    def reading(self, path: Path) -> Iterator[list[str]]:
        """Give the lines of a file that may include others.

        FileError if it includes itself, or there is too much.
        """
        if path.resolve() in self._within:
            raise FileError(path, "a file must not include itself")
        self.budget.descend("includes", len(self._within))
        self._within.append(path.resolve())
        lines = read_lines(path)
        self.budget.take("files with those included")
        self.budget.take("lines with those of included files", len(lines))
        yield lines
        self._within.pop()

    def included(self, block: Block, name: str) -> Path:
        """Return the path of a file that a keyword names."""
        for folder in (block.path.parent, *self.folders):
            if (found := folder / name).is_file():
                return found
        raise block.error(f"the file {name!r} must lie beside {block.path}, but is not there")


def attached(parts: Iterator[Block | Line]) -> Iterator[Block]:
    """Return the keywords with the lines of data that follow them."""
    current: Block | None = None
    for part in parts:
        if isinstance(part, Block):
            if current is not None:
                yield current
            current = part
        elif current is None:
            raise part.error(f"a keyword must come first, got {part.text[:30]!r}")
        else:
            current.data.append(part)
    if current is not None:
        yield current
