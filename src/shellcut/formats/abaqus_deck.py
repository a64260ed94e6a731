"""The syntax of Abaqus input files: keyword lines with parameters, data lines, comments, includes.

Follows the Abaqus Analysis User's Manual, "Input syntax rules": ``**`` begins a comment; a keyword
line that ends in a comma continues in the next line; keywords, parameters and labels ignore case;
blanks count only in quoted labels; ``*INCLUDE, INPUT=`` and ``INPUT=`` of a data keyword insert
another file.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path

from . import numerals
from .budget import Budget
from .errors import FileError, read_lines
from .losses import comment_note, end_note, is_numbers

_DATA = frozenset(["NODE", "ELEMENT", "NSET", "ELSET"])  # keywords with no blank after the star
_CLOSE = 0.75  # similarity to a known keyword: that of NSET with one letter changed


@dataclass
class DataLine:
    """A line of comma-separated entries."""

    path: Path
    line: int
    entries: list[str]
    """Entries without outer blanks; a trailing comma adds no empty entry."""
    continues: bool
    """Whether the line ends in a comma."""

    def error(self, problem: str) -> FileError:
        """Return the error that names this line."""
        return FileError(self.path, problem, line=self.line)

    def integer(self, k: int) -> int:
        """Return entry ``k`` as a whole number."""
        try:
            return numerals.whole(self.entries[k])
        except (ValueError, IndexError):
            raise self.error(f"entry {k + 1} must be a whole number, got {self._got(k)}") from None

    def number(self, k: int) -> float:
        """Return entry ``k`` as a number, 0 where it is empty or missing."""
        text = self.entries[k] if k < len(self.entries) else ""
        try:
            return numerals.number(text.upper().replace("D", "E")) if text else 0.0
        except ValueError:
            raise self.error(f"entry {k + 1} must be a number, got {text!r}") from None

    def _got(self, k: int) -> str:
        return repr(self.entries[k]) if k < len(self.entries) else "none"


@dataclass
class Keyword:
    """A keyword line and the data lines below it."""

    path: Path
    line: int
    name: str
    """In upper case, with single blanks, without the star."""
    parameters: dict[str, str]
    """By upper-case name; a parameter without a value has an empty one."""
    data: list[DataLine] = field(default_factory=list)

    def error(self, problem: str) -> FileError:
        """Return the error that names this line."""
        return FileError(self.path, f"*{self.name}: {problem}", line=self.line)

    def required(self, parameter: str) -> str:
        """Return the value of a required parameter."""
        value = self.parameters.get(parameter, "")
        if not value:
            raise self.error(f"the parameter {parameter} must be given")
        return value


def read_deck(
    path: Path, known: frozenset[str], notes: list[str], budget: Budget
) -> Iterator[Keyword]:
    """Return the keywords of a file and of the files it includes, in order.

    Parameters
    ----------
    path : Path
        The main file; included files are searched beside it and beside the including file.
    known : frozenset of str
        Keywords that the caller uses. Others are passed on too, unless they look like a misspelt
        one of these.
    notes : list of str
        Receives signs of lost data: data in comments, an unfinished last line.
    budget : Budget
        Counts files and lines.

    Raises
    ------
    FileError
        For a file that is no input file, for misspelt keywords and for missing files.
    """
    if not any(line.lstrip().startswith("*") for line in read_lines(path)):
        raise FileError(path, "an Abaqus input file must hold *KEYWORD lines, got none")
    yield from _keywords(path, path.parent, known, [], notes, budget)


def _keywords(
    path: Path,
    folder: Path,
    known: frozenset[str],
    above: list[Path],
    notes: list[str],
    budget: Budget,
) -> Iterator[Keyword]:
    if path.resolve() in above:
        raise FileError(path, "a file must not include itself")
    budget.descend("includes", len(above))
    current: Keyword | None = None
    for keyword, data in _lines(path, notes, budget):
        if keyword is None:
            if data is None or current is None:
                if data is not None and any(data.entries):
                    raise data.error(f"a keyword must come first, got {','.join(data.entries)!r}")
                continue
            current.data.append(data)
            continue
        if current is not None:
            yield current
        current = None
        if keyword.name == "INCLUDE":
            included = _find(keyword, keyword.required("INPUT"), folder)
            yield from _keywords(included, folder, known, [*above, path.resolve()], notes, budget)
            continue
        near = _near(keyword.name, known)
        if "=" in keyword.name:
            raise keyword.error("a comma must stand between a keyword and its parameters")
        if keyword.name not in known and near:
            raise keyword.error(f"keywords must be spelt out; did you mean *{near[0]}?")
        current = keyword
        if keyword.name in known and "INPUT" in keyword.parameters:
            source = _find(keyword, keyword.required("INPUT"), folder)
            for inner, line in _lines(source, notes, budget):
                if inner is not None:
                    raise inner.error("a file of data must hold no keywords")
                if line is not None:
                    current.data.append(line)
    if current is not None:
        yield current


@lru_cache(maxsize=1000)
def _near(name: str, known: frozenset[str]) -> list[str]:
    return get_close_matches(name, known, n=1, cutoff=_CLOSE)


def _find(keyword: Keyword, name: str, folder: Path) -> Path:
    for place in (keyword.path.parent, folder):
        if (found := place / name).is_file():
            return found
    raise keyword.error(f"the file {name!r} must lie beside {keyword.path}, but is not there")


def _lines(
    path: Path, notes: list[str], budget: Budget
) -> Iterator[tuple[Keyword | None, DataLine | None]]:
    # yield each line as one of the two; skip blank lines and comments
    off: list[int] = []  # comments that look like data
    pending: tuple[int, str] | None = None
    lines = read_lines(path)
    budget.take("files with those included")
    budget.take("lines with those of included files", len(lines))
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if text.startswith("**") or not text:
            if is_numbers(text[2:]) or text[2:].split(",")[0].rstrip().upper() in _DATA:
                off.append(number)
            continue
        if pending is not None:
            number, text = pending[0], pending[1] + text
            pending = None
        elif not text.startswith("*"):
            yield None, _data_line(path, number, text)
            continue
        if text.endswith(","):
            pending = number, text
        else:
            yield _keyword(path, number, text), None
    if pending is not None:
        raise FileError(
            path, "a keyword line that ends in a comma must continue: cut short?", line=pending[0]
        )
    notes += comment_note(off) + end_note(path)


def _keyword(path: Path, number: int, text: str) -> Keyword:
    head, *rest = _split(text)
    name = " ".join(head[1:].upper().split())
    parameters = {}
    for item in rest:
        key, equals, value = item.partition("=")
        parameters["".join(key.upper().split())] = _unquoted(value) if equals else ""
    return Keyword(path, number, name, parameters)


def _data_line(path: Path, number: int, text: str) -> DataLine:
    entries = [_unquoted(entry) for entry in _split(text)]
    continues = entries[-1] == ""
    if continues:
        entries.pop()
    return DataLine(path, number, entries, continues)


def _split(text: str) -> list[str]:
    # split at commas outside quotes
    if '"' not in text:
        return text.split(",")
    parts, inside = [""], False
    for character in text:
        inside ^= character == '"'
        if character == "," and not inside:
            parts.append("")
        else:
            parts[-1] += character
    return parts


def _unquoted(text: str) -> str:
    stripped = text.strip()
    if len(stripped) > 1 and stripped[0] == stripped[-1] == '"':
        return stripped[1:-1]
    return stripped
