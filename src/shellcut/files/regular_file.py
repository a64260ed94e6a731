"""Read a file given by a user: it must be a regular file of plausible size.

Opening a pipe blocks until somebody writes to it, and a device such as ``/dev/zero`` never ends.
Both are refused before they are opened.
"""

from __future__ import annotations

import errno
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


_LARGEST = 4_000_000_000


class NotRegularError(OSError):
    """The path is a folder, a pipe or a device."""

    def __str__(self) -> str:
        return f"{self.filename} {self.strerror}"


def read_regular(path: str | os.PathLike[str], most: int = _LARGEST) -> bytes:
    """Return the content of a regular file of at most ``most`` bytes, by default 4 GB."""
    require_regular(path)
    # The file may have been replaced by a pipe meanwhile: opening it must not block.
    with open(os.open(path, os.O_RDONLY | _FLAGS), "rb") as file:
        found = os.fstat(file.fileno())
        _check_kind(path, found.st_mode)
        size, parts = found.st_size, list[bytes]()
        if size <= most:
            # One byte too many shows the excess, even where the system reports no size (/proc).
            # Memory is taken for what is asked, so no more is asked than the file is said to hold.
            left = most + 1
            while left:
                ask = min(left, max(size + 1, _LEAST_READ))
                parts.append(file.read(ask))
                left -= len(parts[-1])
                if len(parts[-1]) < ask:
                    break
            size = max(size, most + 1 - left)
    if size > most:
        raise OSError(
            f"must hold {most / 1e6:,.0f} MB at most, got {size / 1e6:,.0f} MB or more; is it "
            "the right file?"
        )
    return parts[0] if len(parts) == 1 else b"".join(parts)


_LEAST_READ = 1 << 16  # bytes
_FLAGS = getattr(os, "O_NONBLOCK", 0) | getattr(os, "O_BINARY", 0)


def require_regular(path: str | os.PathLike[str]) -> None:
    """Check that a file which another library is to open exists and is a regular file."""
    _check_kind(path, Path(path).stat().st_mode)


def _check_kind(path: str | os.PathLike[str], mode: int) -> None:
    for is_kind, words in _OTHER_KINDS:
        if is_kind(mode):
            said = f"must be a regular file, got {words}; save it as a file first"
            raise NotRegularError(errno.EINVAL, said, os.fspath(path))
