"""The error of all readers, and how messages list what they are about."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import Any

from shellcut.files.regular_file import read_regular

LARGEST_FILE = 1_000_000_000
"""Bytes of the largest mesh, surface or table that is read: some ten million quads as text."""

_NAMED = 5  # offenders named in a message


class FileError(ValueError):
    """A file that cannot be read as what it should be; the message says where and why."""

    def __init__(self, path: str | Path, problem: str, *, line: int | None = None):
        place = f"{path}, line {line}" if line is not None else f"{path}"
        super().__init__(f"{place}: {problem}")


def named(items: Iterable[Any]) -> str:
    """List the first few items, with the number of those left out."""
    listed = list(items)
    more = f" and {len(listed) - _NAMED} more" if len(listed) > _NAMED else ""
    return ", ".join(str(item) for item in listed[:_NAMED]) + more


def read_bytes(path: str | Path) -> bytes:
    """Return the content of a file.

    Raises
    ------
    FileError
        If there is no such file, it cannot be read, it is empty, no regular file (a pipe, a
        device), or larger than :data:`LARGEST_FILE`.
    """
    try:
        content = read_regular(path, LARGEST_FILE)
    except OSError as reason:
        raise FileError(path, f"cannot be read: {reason.strerror or reason}") from None
    if not content:
        raise FileError(path, "the file is empty")
    return content


def read_lines(path: str | Path) -> list[str]:
    """Return the lines of a text file, without their ends; odd bytes become a replacement mark."""
    content = read_bytes(path)
    if b"\0" in content:
        raise FileError(path, "a text file must hold no zero bytes; is this another format?")
    return content.decode("utf-8", errors="replace").splitlines()
