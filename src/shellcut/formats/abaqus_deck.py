"""The syntax of Abaqus input files: keyword lines with parameters, data lines, comments, includes.

Follows the Abaqus Analysis User's Manual, "Input syntax rules": ``**`` begins a comment; a keyword
line that ends in a comma continues in the next line; keywords, parameters and labels ignore case;
blanks count only in quoted labels; ``*INCLUDE, INPUT=`` and ``INPUT=`` of a data keyword insert
another file.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from difflib import get_close_matches
from functools import lru_cache
from pathlib import Path

from .deck import Block, Deck, Line, attached
from .errors import FileError, read_lines

_FIELD = re.compile(r',((?:[^",]+|"[^"]*"?)*)')  # what follows a comma that is in no quotes
_CLOSE = 0.75  # similarity to a known keyword: that of NSET with one letter changed


@dataclass
class DataLine(Line):
    """A line of comma-separated entries."""

    entries: list[str]
    """Entries without outer blanks; a trailing comma adds no empty entry."""
    continues: bool
    """Whether the line ends in a comma."""

    def integer(self, k: int) -> int:
        """Return entry ``k`` as a whole number."""
        return self.whole(self._entry(k), f"entry {k + 1}")

    def number(self, k: int) -> float:
        """Return entry ``k`` as a number, 0 where it is empty or missing."""
        return self.decimal(self._entry(k), f"entry {k + 1}")

    def _entry(self, k: int) -> str:
        return self.entries[k] if k < len(self.entries) else ""


@dataclass
class Keyword(Block):
    """A keyword line and the data lines below it."""

    parameters: dict[str, str]
    """By upper-case name; a parameter without a value has an empty one."""

    def required(self, parameter: str) -> str:
        """Return the value of a required parameter."""
        value = self.parameters.get(parameter, "")
        if not value:
            raise self.error(f"the parameter {parameter} must be given")
        return value


def read_deck(deck: Deck, known: frozenset[str]) -> Iterator[Keyword]:
    """Return the keywords of a file and of the files it includes, in order.

    Keywords that are not ``known``, those that the caller uses, are passed on too, unless they look
    like a misspelt one.
    """
    if not any(line.lstrip().startswith("*") for line in read_lines(deck.path)):
        raise FileError(deck.path, "an Abaqus input file must hold *KEYWORD lines, got none")
    yield from _keywords(deck, deck.path, known)


def _keywords(deck: Deck, path: Path, known: frozenset[str]) -> Iterator[Keyword]:
    with deck.reading(path) as lines:
        for keyword in attached(_parts(deck, path, lines)):
            assert isinstance(keyword, Keyword)
            if keyword.name == "INCLUDE":
                included = deck.included(keyword, keyword.required("INPUT"))
                yield from _keywords(deck, included, known)
                continue
            if "=" in keyword.name:
                raise keyword.error("a comma must stand between a keyword and its parameters")
            if keyword.name not in known and (near := _near(keyword.name, known)):
                raise keyword.error(f"keywords must be spelt out; did you mean *{near[0]}?")
            if keyword.name in known and "INPUT" in keyword.parameters:
                source = deck.included(keyword, keyword.required("INPUT"))
                with deck.reading(source) as inner:
                    for part in _parts(deck, source, inner):
                        if isinstance(part, Keyword):
                            raise part.error("a file of data must hold no keywords")
                        keyword.data.append(part)
            yield keyword


@lru_cache(maxsize=1000)
def _near(name: str, known: frozenset[str]) -> list[str]:
    return get_close_matches(name, known, n=1, cutoff=_CLOSE)


def _parts(deck: Deck, path: Path, lines: list[str]) -> Iterator[Keyword | DataLine]:
    # without blank lines and comments
    pending: tuple[int, str] | None = None
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if text.startswith("**") or not text:
            continue
        if pending is not None:
            number, text = pending[0], pending[1] + text
            pending = None
        elif not text.startswith("*"):
            entries = [_unquoted(entry) for entry in _FIELD.findall(f",{text}")]
            continues = entries[-1] == ""
            yield DataLine(path, number, text, entries[:-1] if continues else entries, continues)
            continue
        if text.endswith(","):
            pending = number, text
        else:
            yield _keyword(path, number, text)
    if pending is not None:
        raise FileError(
            path, "a keyword line that ends in a comma must continue: cut short?", line=pending[0]
        )


def _keyword(path: Path, number: int, text: str) -> Keyword:
    head, *rest = _FIELD.findall(f",{text}")
    name = " ".join(head[1:].upper().split())
    parameters = {}
    for item in rest:
        key, equals, value = item.partition("=")
        parameters["".join(key.upper().split())] = _unquoted(value) if equals else ""
    return Keyword(path, number, name, parameters)


def _unquoted(text: str) -> str:
    stripped = text.strip()
    if len(stripped) > 1 and stripped[0] == stripped[-1] == '"':
        return stripped[1:-1]
    return stripped
