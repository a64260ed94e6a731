"""Content that a file declares, bytes or text, taken one after the other: :class:`Content`."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from . import numerals
from .errors import FileError, counted, read_bytes


class Content:
    """The content of a file, read from its first byte to its last.

    What is not there, or is no number where one must be, is a FileError.
    """

    def __init__(self, path: Path):
        self.path = path
        self.content = read_bytes(path)
        self.at = 0
        """Where the next byte is taken."""
        self.order = ""
        """Byte order of numbers, ``<`` or ``>``; empty where they are text."""
        self.tokens: list[bytes] = []
        """Numbers as text."""
        self.next_token = 0
        self.notes: list[str] = []
        """What is there and not read."""

    def error(self, problem: str) -> FileError:
        """Return the error that names the file."""
        return FileError(self.path, problem)

    def line(self) -> bytes:
        """Take the rest of a line."""
        end = self.content.find(b"\n", self.at)
        line = self.content[self.at : end if end >= 0 else None]
        self.at += len(line) + (end >= 0)
        return line.strip()

    def raw(self, n: int) -> bytes:
        """Take bytes."""
        if n < 0 or self.at + n > len(self.content):
            raise self.error("the file ends before its declared content: it is cut short")
        self.at += n
        return self.content[self.at - n : self.at]

    def rest(self) -> None:
        """Pass over what follows the declared content."""
        if n := len(self.content[self.at :].strip()):
            self.notes.append(f"{counted(n, 'byte')} after its declared content: not read")
        self.at = len(self.content)

    def texts(self, n: int) -> list[bytes]:
        """Take numbers as text."""
        if n < 0 or self.next_token + n > len(self.tokens):
            raise self.error("the file ends before its declared content: it is cut short")
        self.next_token += n
        return self.tokens[self.next_token - n : self.next_token]

    def numbers(self, kind: str, n: int = 1) -> Any:
        """Take numbers, shape (n,); ``kind`` as of NumPy, without byte order: ``f4``, ``i8``."""
        if not self.order:
            return self.read(kind, self.texts(n))
        dtype = np.dtype(self.order + kind)
        found = np.frombuffer(self.raw(n * dtype.itemsize), dtype)
        return found.astype(np.float64 if kind[0] == "f" else np.int64)

    def read(self, kind: str, texts: list[bytes]) -> Any:
        """Return texts as numbers of a kind."""
        as_float = kind[0] == "f"
        read = numerals.number if as_float else numerals.whole
        values = list[float]()
        for text in texts:
            try:
                values.append(read(text))
            except ValueError:
                what = "numbers" if as_float else "whole numbers"
                shown = text[:20].decode("latin-1")
                raise self.error(f"there must be {what}, got {shown!r}") from None
        return np.array(values, np.float64 if as_float else np.int64)
