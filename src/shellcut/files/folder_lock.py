"""One run at a time in a folder, by a lock that the operating system keeps for the process.

The lock is on the file ``run.lock``, which tells for people who holds it. The system gives the lock
back when the process ends, also by ``kill -9``; what is left of the file then holds nothing. It is
the lock of a file that was opened, not of a process: a second one in the same process, of whatever
thread, is refused too, and a fork of the process has no part in it.

Readers never look at it. A file system that has no locks, as some network ones, is told of, and the
run goes on without.
"""

from __future__ import annotations

import errno
import json
import logging
import os
import socket
import sys
import time
import weakref
from contextlib import suppress
from pathlib import Path
from typing import Any

if sys.platform == "win32":
    import msvcrt
else:
    import fcntl

LOCK = "run.lock"

_log = logging.getLogger(__name__)

# Windows lets nobody read what is locked: a byte that is not there, far behind the text.
_LOCKED_BYTE = 1 << 20

# Times that a lock file may vanish between opening and locking it, before it is taken for one of a
# file system that cannot tell files apart.
_MOST_TRIES = 100

_HELD_BY_ANOTHER = {errno.EWOULDBLOCK, errno.EAGAIN, errno.EACCES}


class FolderInUse(OSError):
    """Another run writes in the folder; the message names its process, host and start."""


class FolderLock:
    """The lock on a folder, held until it is closed or the process ends.

    Parameters
    ----------
    folder : Path
        The folder, which is there.

    Raises
    ------
    FolderInUse
        If another holds it, of this or of another process.
    OSError
        If nothing can be written in the folder.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / LOCK
        self._file: Any = None
        self.hold()
        _all.add(self)

    def hold(self) -> None:
        """Make sure of the lock: if somebody has removed its file, take it again.

        Raises
        ------
        FolderInUse
            If another has taken it meanwhile.
        OSError
            If nothing can be written in the folder.
        """
        if self._file is not None and self._is_in_place(self._file):
            return
        self.let_go()
        file = self._opened()
        # If its holder has removed it just now, the next one is another file.
        for _ in range(_MOST_TRIES):
            if self._is_in_place(file):
                break
            file.close()
            file = self._opened()
        self._file = file
        with suppress(OSError):  # of a full disk: it is locked all the same
            file.truncate(0)
            file.write(json.dumps(_myself()).encode())

    def close(self) -> None:
        """Give the lock back; a second call does nothing."""
        file, self._file = self._file, None
        if file is None:
            return
        in_place = self._is_in_place(file)
        if sys.platform == "win32":  # where an open file cannot be removed
            file.close()
        if in_place:
            with suppress(OSError):  # it may be open for another who asks for it
                self._path.unlink()
        file.close()

    def let_go(self) -> None:
        """Close the file alone, as in a fork, whose parent goes on holding the lock."""
        file, self._file = self._file, None
        if file is not None:
            file.close()

    def _opened(self) -> Any:
        """Return the file, opened and locked."""
        file = self._path.open("a+b", buffering=0)
        try:
            self._take(file)
        except BaseException:
            file.close()
            raise
        return file

    def _take(self, file: Any) -> None:
        try:
            if sys.platform == "win32":
                file.seek(_LOCKED_BYTE)
                msvcrt.locking(file.fileno(), msvcrt.LK_NBLCK, 1)
            else:
                fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as refusal:
            if refusal.errno in _HELD_BY_ANOTHER:
                holder, remedy = _holder(file)
                raise FolderInUse(
                    f"{self._path.parent} is being written by {holder}: {remedy}, or choose "
                    "another folder"
                ) from None
            _log.warning(
                "%s lies on a file system that has no locks (%s): see to it that no second run "
                "writes there; the last one to begin was that of %s",
                self._path.parent,
                refusal.strerror,
                _holder(file)[0],
            )

    def _is_in_place(self, file: Any) -> bool:
        """Whether the file that was opened is the one that the folder has now."""
        try:
            return os.path.samestat(os.fstat(file.fileno()), self._path.stat())
        except FileNotFoundError:
            return False


def refuse_if_in_use(folder: Path) -> None:
    """Raise if a run writes in a folder now; whoever waits may come first all the same.

    Raises
    ------
    FolderInUse
        If so.
    """
    if (folder / LOCK).exists():
        FolderLock(folder).close()


def _myself() -> dict[str, Any]:
    since = time.strftime("%Y-%m-%d %H:%M:%S %z")
    return {"process": os.getpid(), "host": socket.gethostname(), "since": since}


def _holder(file: Any) -> tuple[str, str]:
    """Return in words whom the file names, and what frees the folder."""
    wait = "wait until that run ends, or stop it"
    try:
        file.seek(0)
        told = json.loads(file.read())
        process, host, since = (told[name] for name in ("process", "host", "since"))
    except (OSError, ValueError, KeyError, TypeError):  # just being written, or not to be read
        return "another process", wait
    me = _myself()
    if (process, host) == (me["process"], me["host"]):
        here = f"this very process, {process} on {host}, since {since}"
        return here, "wait until that run ends, or close its Recorder"
    return f"process {process} on {host} since {since}", wait


_all: weakref.WeakSet[FolderLock] = weakref.WeakSet()


def _let_go_of_all() -> None:
    for lock in tuple(_all):
        lock.let_go()


if hasattr(os, "register_at_fork"):
    os.register_at_fork(after_in_child=_let_go_of_all)
