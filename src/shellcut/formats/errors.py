"""The error of all readers; lists and places in messages."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.arrays import Floats
from shellcut.files.regular_file import read_regular
from shellcut.files.text_content import decoded, in_one_form

LARGEST_FILE = 1_000_000_000
"""Largest size of a mesh, surface or table file [bytes]: about ten million quads as text."""

_NAMED = 5  # offenders named in a message


class FileError(ValueError):
    """The file is not readable as expected; the message says where and why."""

    def __init__(self, path: str | Path, problem: str, *, line: int | None = None):
        place = f"{path}, line {line}" if line is not None else f"{path}"
        self.problem = problem
        super().__init__(f"{place}: {problem}")


@contextmanager
def naming(path: str | Path) -> Iterator[None]:
    """Name the file of which a value is refused."""
    try:
        yield
    except ValueError as problem:
        raise FileError(path, str(problem)) from None


def named(items: Iterable[Any], describe: Callable[[Any], str] = str) -> str:
    """List the first few items, and the number of the others."""
    listed = list(items)
    more = f" and {len(listed) - _NAMED} more" if len(listed) > _NAMED else ""
    return ", ".join(describe(item) for item in listed[:_NAMED]) + more


def counted(n: int, one: str, more: str = "") -> str:
    """Return a number with its noun; ``more`` is the plural, by default with an s."""
    return f"{n:,} {one if n == 1 else more or one + 's'}"


def check_finite(path: str | Path, points: Floats, name: Callable[[int], str]) -> None:
    """Refuse coordinates that are no numbers, naming their points."""
    wrong = np.flatnonzero(~np.isfinite(points).all(axis=1))
    if len(wrong):
        said = named(wrong.tolist(), lambda k: f"{name(k)} at {point_text(points[k])}")
        raise FileError(path, f"coordinates must be finite numbers, got {said}")


def point_text(point: Sequence[float] | Floats, digits: int = 6) -> str:
    """Return the coordinates of a point."""
    texts = (f"{round(float(value), 9) + 0.0:.{digits}g}" for value in point)
    return f"({', '.join(texts)})"


def read_bytes(path: str | Path, most: int | None = None) -> bytes:
    """Return the content of a regular file that is not empty, text as :func:`in_one_form`.

    It has ``most`` bytes, :data:`LARGEST_FILE` by default.
    """
    try:
        content = in_one_form(read_regular(path, LARGEST_FILE if most is None else most))
    except OSError as reason:
        raise FileError(path, f"cannot be read: {reason.strerror or reason}") from None
    if not content:
        raise FileError(path, "the file is empty, or has only zero bytes")
    return content


def read_lines(path: str | Path) -> list[str]:
    """Return the lines of a text file, without line ends."""
    content = read_bytes(path)
    if b"\0" in content:
        raise FileError(path, "a text file must hold no zero bytes; is this another format?")
    return decoded(content).splitlines()


@contextmanager
def as_file(path: str | Path, content: bytes) -> Iterator[Path]:
    """Give the path of a file with this content to a library that opens files itself.

    It is ``path`` if that file holds the content, otherwise a copy with the same ending.
    """
    path = Path(path)
    if read_regular(path) == content:
        yield path
        return
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / f"file{path.suffix}"
        copy.write_bytes(content)
        try:
            yield copy
        except FileError as reason:
            raise FileError(path, reason.problem) from None
