"""Complete files: replaced atomically, with all bytes written.

A file is written under a temporary name and moved into place when complete: after a kill or on a
full disk the old file is still there. Unbuffered files may accept only part of the bytes without an
error, as when a disk fills up; :func:`write_all` repeats until all are written or an error shows.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


def temporary_path(path: Path) -> Path:
    """Return the temporary path of a file while it is written.

    Examples
    --------
    >>> temporary_path(Path("out/energy.png")).name
    'energy.part.png'
    """
    return path.with_name(f"{path.stem}.part{path.suffix}")


@contextmanager
def atomic_write(path: Path) -> Iterator[Path]:
    """Give a temporary path to write to; after the block that file replaces ``path``.

    If the block fails, the temporary file is removed and the old one stays. A link is followed; a
    path that is not a regular file, such as ``/dev/stdout``, is written directly.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        yield path
        return
    temporary = temporary_path(path)
    try:
        yield temporary
        os.replace(temporary, path)
    except BaseException:  # including a second Ctrl-C
        temporary.unlink(missing_ok=True)
        raise


def write_all(file: BinaryIO, data: bytes | memoryview) -> None:
    """Write all bytes to an unbuffered file.

    Raises
    ------
    OSError
        If the system accepts no more of them, with the file's name.
    """
    rest = memoryview(data)
    try:
        while len(rest):
            rest = rest[file.write(rest) :]
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, str(file.name)) from problem
