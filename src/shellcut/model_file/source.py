"""The text of a model file: its values and their line numbers, and the error with its problems.

``tomllib`` reports no lines. So the text is read entry by entry, too: an entry ends with the first
line with which it is TOML by itself.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from dis import opmap
from pathlib import Path
from typing import TYPE_CHECKING, Any

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

if TYPE_CHECKING:
    from .model import Model


@dataclass(frozen=True)
class Problem:
    """One problem."""

    place: str
    """``file:line``, or the setting that overrides the file."""
    text: str

    def __str__(self) -> str:
        return f"{self.place}: {self.text}"


class ModelFileError(ValueError):
    """The model file is wrong; the message lists every problem, one per line.

    Attributes
    ----------
    problems : tuple of Problem
    partial : Model or None
        The valid part: a model without the sections that have problems.

    Examples
    --------
    >>> from shellcut import read_model
    >>> read_model("opening", {"tool.teehs": 6, "motion.pitch": "3 MPa"})
    Traceback (most recent call last):
    ...
    shellcut.model_file.source.ModelFileError: ...unknown key [tool].teehs; did you mean teeth?...
    """

    def __init__(self, problems: Sequence[Problem]) -> None:
        self.problems = tuple(problems)
        self.partial: Model | None = None
        super().__init__("\n".join(str(problem) for problem in problems))


def is_refusal(problem: BaseException) -> bool:
    """Whether an error is shellcut's own word on a value, raised by a ``raise`` of its sources.

    Any other is raised inside a library and says nothing of the user's file.
    """
    trace = problem.__traceback__
    while trace is not None and trace.tb_next is not None:
        trace = trace.tb_next
    if trace is None:
        return False
    package = str(trace.tb_frame.f_globals.get("__name__")).partition(".")[0]
    raised = trace.tb_frame.f_code.co_code[trace.tb_lasti] == opmap["RAISE_VARARGS"]
    return package == "shellcut" and raised


# --- the text -------------------------------------------------------------------------------------

KeyPath = tuple[str | int, ...]
"""From the top: section, place in an array of tables, from 0 on, key."""

_DEEPEST = 8  # levels of tables and arrays; holes = [[[x, y], ...]] in a section are five
_TOO_DEEP = f"must nest tables and arrays to {_DEEPEST} levels at most"
_SHOWN = 60  # letters of a heading or key in a message
_LONGEST_KEY = 100  # parts; tomllib takes time by their square
_NO_KEY = re.compile(r"[^\w.\"' \t-]")
_LARGEST_WHOLE = 2**63 - 1
_BARE = re.compile(
    r"[^=]*=\s*([+-]?\d+[.,]?\d*(?:[eE][+-]?\d+)?)\s*([A-Za-zµμ°][\w/*^²³ ]*?)?\s*(?:#.*)?"
)
_ERROR_LINE = re.compile(r"(.*) \(at (?:line (\d+), column \d+|end of document)\)")


@dataclass(frozen=True)
class Source:
    """Source of a model: a file and its overrides."""

    name: str
    """Name of the file in messages."""
    folder: Path
    """Folder to which paths in the file are relative."""
    values: dict[str, Any]
    lines: Mapping[KeyPath, int]
    settings: Mapping[KeyPath, str] = field(default_factory=dict)
    """Overridden keys, each with the text of its override."""

    @classmethod
    def empty(cls) -> Source:
        """Return the source of a model that was not read."""
        return cls("model", Path.cwd(), {}, {})

    def place(self, path: KeyPath) -> str:
        """Return the line of a key, or of the nearest level above it, with what overrides it."""
        within = [text for key, text in self.settings.items() if key[: len(path)] == path]
        if within and path:
            return ", ".join(within if path in self.settings else [self._line(path), *within])
        return self._line(path)

    def _line(self, path: KeyPath) -> str:
        for end in range(len(path), 0, -1):
            if path[:end] in self.settings:
                return self.settings[path[:end]]
            if path[:end] in self.lines:
                return f"{self.name}:{self.lines[path[:end]]}"
        return self.name

    def base(self, path: KeyPath) -> Path:
        """Return the folder to which a path at a key is relative."""
        return Path.cwd() if path in self.settings else self.folder


def titled_path(path: KeyPath) -> str:
    """Return the title of a section or table, a place in an array as in ``--set``.

    Examples
    --------
    >>> titled_path(("tool",)), titled_path(("material", "layers", 0, "hardening"))
    ('[tool]', '[material.layers.0.hardening]')
    """
    return f"[{'.'.join(map(str, path))}]"


def parse(text: str, name: str, folder: Path) -> Source:
    """Return values and lines of a TOML text; ModelFileError if it is not valid TOML."""
    try:
        values = loaded(text)
    except ValueError as error:  # from TOML, or from Python for a number of thousands of digits
        found = _ERROR_LINE.fullmatch(str(error))
        number = int(found[2] or len(text.splitlines())) if found else 0
        place = f"{name}:{number}" if found else name
        said = (found[1] if found else str(error)) + _entry_at(text, number) + _bare(text, number)
        raise ModelFileError([Problem(place, f"is not a model file (TOML): {said}")]) from None
    except RecursionError:
        raise ModelFileError([Problem(name, _TOO_DEEP)]) from None
    if beyond := beyond_all(values):
        raise ModelFileError([Problem(name, beyond)])
    return Source(name, folder, values, _lines(text))


def parse_value(text: str) -> object:
    """Return a value written in TOML; any other text is returned as a string.

    Examples
    --------
    >>> parse_value("4"), parse_value("[1, 2]"), parse_value("M1"), parse_value("12 um")
    (4, [1, 2], 'M1', '12 um')
    """
    try:
        values = loaded(f"value = {text}")
    except (ValueError, RecursionError):
        return text
    return text if len(values) != 1 or beyond_all(values) else values["value"]


def loaded(text: str) -> dict[str, Any]:
    """Return the values of a TOML text; ValueError if it is not valid, or a key is endless."""
    for number, line in enumerate(text.splitlines(), start=1):
        if line.count(".") < _LONGEST_KEY:
            continue
        n_part = max(sum(map(bool, key.split("."))) for key in _NO_KEY.split(line))
        if n_part > _LONGEST_KEY:
            raise ValueError(
                f"a key must have {_LONGEST_KEY} parts at most, got {n_part:,} "
                f"(at line {number}, column 1)"
            )
    return tomllib.loads(text)


def beyond_all(values: dict[str, Any]) -> str:
    """Return a description of the first value beyond the limits; empty if there is none.

    Python reads integers of any length and tables of any depth, but then cannot print them.
    """
    level: list[Any] = [values]
    for _ in range(_DEEPEST + 1):
        level = [
            value
            for thing in level
            if isinstance(thing, dict | list)
            for value in (thing.values() if isinstance(thing, dict) else thing)
        ]
        if any(isinstance(value, int) and abs(value) > _LARGEST_WHOLE for value in level):
            return f"must hold whole numbers up to {_LARGEST_WHOLE}, as TOML requires"
    return _TOO_DEEP if any(isinstance(thing, dict | list) for thing in level) else ""


def _entry_at(text: str, line: int) -> str:
    """Return which heading or key is at a line, or has a value that continues there."""
    lines = text.splitlines()[:line]
    starts = list(_starts("\n".join(lines)))
    start, path = starts[-1] if starts else (0, ())
    entry, equals, _ = lines[start - 1].partition("=") if start else ("", "", "")
    if not equals and not entry.strip().startswith("["):
        return ""
    first = min(number for number, known in starts if known == path)
    again = f", first in line {first}" if first < start else ""
    shown = entry.strip()
    if len(shown) > _SHOWN:
        shown = f"{shown[:_SHOWN]}..."
    return f", {shown} in line {start}{again}"


def _bare(text: str, line: int) -> str:
    """Return how to write a number of a line that has a unit without quotes, or a comma."""
    lines = text.splitlines()
    found = _BARE.fullmatch(lines[line - 1]) if 0 < line <= len(lines) else None
    if found is None:
        return ""
    number, unit = found[1].replace(",", "."), found[2]
    if unit is not None:
        return f'; write "{number} {unit}"'
    return f"; write {number}" if "," in found[1] else ""


def _lines(text: str) -> dict[KeyPath, int]:
    """Return the first line of every section, key, and table of a dotted key."""
    found: dict[KeyPath, int] = {}
    for number, path in _starts(text):
        for end in range(1, len(path) + 1):
            found.setdefault(path[:end], number)
    return found


def _starts(text: str) -> Iterator[tuple[int, KeyPath]]:
    """Yield line and path of each heading and key, and an empty path where the text is no TOML."""
    counts: dict[KeyPath, int] = {}  # of the tables so far, by the path of their array
    section: KeyPath = ()
    begun, entry, in_text = 1, "", False
    for number, line in enumerate(text.splitlines(), start=1):
        entry += f"{line}\n"
        if line.rstrip().endswith(",") and not line.lstrip().startswith("#"):
            continue  # within an array
        has_quotes = any(quotes in line for quotes in ('"""', "'''"))
        if in_text and not has_quotes and "]" not in line:
            continue  # within a text of several lines
        in_text = in_text or has_quotes
        try:
            inner: Any = loaded(entry)
        except (ValueError, RecursionError):
            continue
        names: list[str] = []
        while isinstance(inner, dict) and len(inner) == 1:
            ((name, inner),) = inner.items()
            names.append(name)
        if not entry.lstrip().startswith("["):
            if names:
                yield begun, (*section, *names)
        else:
            section = ()
            for name in names:
                if section in counts:  # within the last table of an array
                    section = (*section, counts[section] - 1)
                section = (*section, name)
            if entry.lstrip().startswith("[["):
                counts[section] = counts.get(section, 0) + 1
                section = (*section, counts[section] - 1)
            yield begun, section
        begun, entry, in_text = number + 1, "", False
    if entry.strip():
        yield begun, ()
