"""Read a file that someone named: a regular one, of a size that can be meant.

A pipe is waited for without end until somebody writes, and a device such as ``/dev/zero`` has no
end at all. Both are told before they are opened.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

_OTHER_KINDS = (
    (stat.S_ISDIR, "a folder"),
    (stat.S_ISFIFO, "a pipe"),
    (stat.S_ISCHR, "a device"),
    (stat.S_ISBLK, "a device"),
    (stat.S_ISSOCK, "a socket"),
)


def read_regular(path: str | os.PathLike[str], most: int) -> bytes:
    """Return the content of a regular file.

    Parameters
    ----------
    path : path
    most : int
        Bytes that it may hold.

    Raises
    ------
    OSError
        If it is not there, cannot be read, is no regular file, or holds more.
    """
    path = Path(path)
    _check_kind(path.stat().st_mode)
    # Whatever may have taken the file's place by now: opening it must not wait for a writer.
    with open(os.open(path, os.O_RDONLY | _FLAGS), "rb") as file:
        found = os.fstat(file.fileno())
        _check_kind(found.st_mode)
        # One byte more than allowed is enough to tell, also where the system knows no size (/proc).
        content = b"" if found.st_size > most else file.read(most + 1)
        size = max(found.st_size, len(content))
    if size > most:
        raise OSError(
            f"must hold {most / 1e6:,.0f} MB at most, got {size / 1e6:,.0f} MB or more; is it "
            "the file that is meant?"
        )
    return content


_FLAGS = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


def _check_kind(mode: int) -> None:
    for is_kind, words in _OTHER_KINDS:
        if is_kind(mode):
            raise OSError(f"must be a regular file, got {words}; save it as a file first")
