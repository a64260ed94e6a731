"""The operating system's lock on an open file, which it releases when the file is closed."""

from __future__ import annotations

import errno
import sys
import time
from typing import IO, Any

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

HELD_BY_ANOTHER = {errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES, errno.EDEADLK}
"""Codes of the error where another open file has the lock."""

# On Windows a locked byte cannot be read: lock one far behind the text.
_LOCKED_BYTE = 1 << 20

_BETWEEN_TRIES = 0.05
"""How long Windows, which cannot wait, is left between tries [s]."""


def take(file: IO[Any], *, wait: bool = False) -> None:
    """Lock a file open for writing against all others, also of this process.

    Raises OSError of a code in :data:`HELD_BY_ANOTHER` if another has the lock and ``wait`` is
    false; of other codes on a file system without locks.
    """
    if sys.platform == "win32":
        file.seek(_LOCKED_BYTE)
        while True:
            try:
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
                return
            except OSError as refusal:
                if not wait or refusal.errno not in HELD_BY_ANOTHER:
                    raise
                time.sleep(_BETWEEN_TRIES)
    else:
        fcntl.flock(file, fcntl.LOCK_EX | (0 if wait else fcntl.LOCK_NB))
