"""Open and write files so that nothing of anybody else's is changed.

A new name is created exclusively, a file of one's own is opened again without following a link, and
a file is replaced atomically: written under a temporary name that nobody has, and moved into place
when it is complete. After a kill or on a full disk the old file is still there. Unbuffered files
may accept only part of the bytes without an error, as when a disk fills up; :func:`write_all`
repeats until all are written or an error shows.
"""

from __future__ import annotations

import os
import re
import secrets
import stat
from collections.abc import Iterator
from contextlib import contextmanager
from io import TextIOWrapper
from pathlib import Path
from typing import BinaryIO, Literal

# Windows has neither; there the check of the link before opening is all.
_FLAGS = getattr(os, "O_NOFOLLOW", 0) | getattr(os, "O_NONBLOCK", 0)

_MOST_OF_STEM = 40  # characters: a temporary name must not be too long where the name is not


def exclusive(path: str, flags: int) -> int:
    """Open a name that nobody has, for ``open(..., opener=exclusive)``.

    Not even a link that leads nowhere may have it.
    """
    return os.open(path, flags | os.O_CREAT | os.O_EXCL | _FLAGS, 0o666)


def unfollowed(path: str, flags: int) -> int:
    """Open a regular file, no link, for ``open(..., opener=unfollowed)``; ``"a"`` creates one."""
    refuse_link(Path(path))
    file = os.open(path, flags | _FLAGS, 0o666)
    if not stat.S_ISREG(os.fstat(file).st_mode):
        os.close(file)
        raise OSError(f"{path} must be a regular file: move away what has this name now")
    return file


def opened(path: Path, mode: Literal["w", "r+", "a+"]) -> BinaryIO:
    """Return a file to read and write, unbuffered, which is a regular one and no link.

    mode : ``"w"`` puts a new file in the place of the one there; ``"r+"`` opens the one there;
    ``"a+"`` opens or creates it, and writes at its end.
    """
    if mode == "w":
        path.unlink(missing_ok=True)  # a link itself, not what it leads to
        return open(path, "w+b", buffering=0, opener=exclusive)
    if mode == "r+":
        return open(path, "r+b", buffering=0, opener=unfollowed)
    return open(path, "a+b", buffering=0, opener=unfollowed)


def log_file(path: Path) -> TextIOWrapper:
    """Return a text file to append to, created if missing."""
    return open(path, "a", encoding="utf-8", errors="backslashreplace", opener=unfollowed)


def refuse_link(path: Path) -> None:
    """Raise if a path is a link: what it leads to is somebody's own."""
    if path.is_symlink():
        raise OSError(f"{path} must not be a link: move it away, or name the file itself")


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Give a temporary path to write to; after the block that file replaces ``path``.

    If the block fails, the temporary file is removed and the old one stays. A path that is not a
    regular file, such as ``/dev/stdout``, is written directly; a link is refused.
    """
    if path.exists() and not path.is_file():
        yield path
        return
    refuse_link(path)
    token = secrets.token_hex(8)
    temporary = path.with_name(f"{path.stem[:_MOST_OF_STEM]}.part-{token}{path.suffix}")
    with open(temporary, "wb", opener=exclusive):
        pass
    try:
        yield temporary
        os.replace(temporary, path)
    except BaseException:  # including a second Ctrl-C
        temporary.unlink(missing_ok=True)
        raise


def write_text(path: Path, text: str, encoding: str = "utf-8", errors: str = "strict") -> None:
    """Replace a file by a text, atomically."""
    with atomic_write(path) as temporary:
        temporary.write_bytes(text.encode(encoding, errors))


def unfinished(path: Path) -> list[Path]:
    """Return the temporary files of a path that killed processes have left beside it."""
    stem, suffix = re.escape(path.stem[:_MOST_OF_STEM]), re.escape(path.suffix)
    temporary = re.compile(rf"{stem}\.part-[\da-f]{{16}}{suffix}")
    try:
        names = os.listdir(path.parent)
    except OSError:
        return []
    return [path.with_name(name) for name in names if temporary.fullmatch(name)]


def write_all(file: BinaryIO, data: bytes | memoryview) -> None:
    """Write all bytes to an unbuffered file."""
    rest = memoryview(data)
    try:
        while len(rest):
            rest = rest[file.write(rest) :]
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, str(file.name)) from problem
