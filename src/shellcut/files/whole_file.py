"""Files that are whole or not there, and bytes that are written to the last.

A file is made beside its place and put into it when it is complete: a kill or a full disk leaves
what was there before. Raw files may take a part of what they are given, without an error, as when
a disk fills up; :func:`write_all` goes on until all is written or the system says why it is not.
"""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import BinaryIO


def aside_of(path: Path) -> Path:
    """Return where a file is made before it takes its place.

    Examples
    --------
    >>> aside_of(Path("out/energy.png")).name
    'energy.part.png'
    """
    return path.with_name(f"{path.stem}.part{path.suffix}")


@contextmanager
def written_whole(path: Path) -> Iterator[Path]:
    """Give a path to write to; what is there after the block takes the place of ``path``.

    If the block fails, its file is removed and the former one stays. A link is followed; what is no
    ordinary file, as ``/dev/stdout``, is written to as it is.
    """
    path = Path(os.path.realpath(path))
    if path.exists() and not path.is_file():
        yield path
        return
    aside = aside_of(path)
    try:
        yield aside
        os.replace(aside, path)
    except BaseException:  # also of a second Ctrl-C
        aside.unlink(missing_ok=True)
        raise


def write_all(file: BinaryIO, data: bytes | memoryview) -> None:
    """Write all bytes to an unbuffered file.

    Raises
    ------
    OSError
        If the system takes no more of them, with the file's name.
    """
    rest = memoryview(data)
    try:
        while len(rest):
            rest = rest[file.write(rest) :]
    except OSError as problem:
        raise OSError(problem.errno, problem.strerror, str(file.name)) from problem
