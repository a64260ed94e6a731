"""One run at a time in a folder, by an operating-system lock.

The lock is on the file ``run.lock``, whose text names the holder. The system releases the lock when
the process ends, even by ``kill -9``; the file left behind then locks nothing. The lock belongs to
an open file, not to a process: a second run in the same process, in any thread, is refused too, and
a fork of the process does not share it.

Readers ignore the lock. On a file system without locks, such as some network ones, the run logs a
warning and proceeds without.
"""

from __future__ import annotations

import json
import logging
import os
import socket
import sys
import time
import weakref
from collections.abc import Iterable
from contextlib import suppress
from pathlib import Path
from typing import Any

from . import file_lock
from .file_list import FILES, LOCK, FileList, folder_named
from .whole_file import opened, unfinished

_log = logging.getLogger(__name__)

# Attempts, if the lock file vanishes between opening and locking it; after that the file system is
# assumed unable to tell files apart.
_MOST_TRIES = 100

# How the text of a holder begins; a full disk may have cut it short.
_BEGINS = b'{"process": '


class FolderInUse(OSError):
    """Another run writes in the folder; the message names its process, host and start."""


class FolderLock:
    """The lock on an existing folder, kept until it is closed or the process ends.

    Raises FolderInUse if another run, of this or another process, has it, and FileExistsError if
    ``run.lock`` is a file of another origin.
    """

    def __init__(self, folder: Path) -> None:
        self._path = folder / LOCK
        self._file: Any = None
        self.hold()
        _all.add(self)

    def hold(self) -> None:
        """Check the lock: if somebody has removed its file, lock again."""
        if self._file is not None and self._is_in_place(self._file):
            return
        self.let_go()
        file = self._opened()
        # If the holder has just removed the file, the next attempt opens another one.
        for _ in range(_MOST_TRIES):
            if self._is_in_place(file):
                break
            file.close()
            file = self._opened()
        self._file = file
        with suppress(OSError):  # full disk: the folder is locked all the same
            file.truncate(0)
            file.write(json.dumps(_myself()).encode())

    def close(self) -> None:
        """Release the lock; a second call does nothing."""
        file, self._file = self._file, None
        if file is None:
            return
        in_place = self._is_in_place(file)
        if sys.platform == "win32":  # an open file cannot be removed there
            file.close()
        if in_place:
            with suppress(OSError):  # another process may have it open
                self._path.unlink()
        file.close()

    def let_go(self) -> None:
        """Close the file only, as in a fork whose parent keeps the lock."""
        file, self._file = self._file, None
        if file is not None:
            file.close()

    def _opened(self) -> Any:
        """Return the file, opened and locked."""
        file: Any = opened(self._path, "a+")
        try:
            self._take(file)
            file.seek(0)
            if not _BEGINS.startswith(start := file.read(len(_BEGINS))):
                raise FileExistsError(
                    f"{self._path} must be the lock of a run, but no run wrote it (it begins with "
                    f"{start!r}): move it away, or choose another folder"
                )
        except BaseException:
            file.close()
            raise
        return file

    def _take(self, file: Any) -> None:
        try:
            file_lock.take(file)
        except OSError as refusal:
            if refusal.errno in file_lock.HELD_BY_ANOTHER:
                holder, remedy = _holder(file)
                raise FolderInUse(
                    f"{self._path.parent} is being written by {holder}: {remedy}, or choose "
                    "another folder"
                ) from None
            _log.warning(
                "%s lies on a file system without locks (%s): make sure that no second run writes "
                "there; the last run to start there was %s",
                self._path.parent,
                refusal.strerror,
                _holder(file)[0],
            )

    def _is_in_place(self, file: Any) -> bool:
        """Whether the open file is still the one in the folder."""
        try:
            return os.path.samestat(os.fstat(file.fileno()), self._path.lstat())
        except FileNotFoundError:
            return False


class TakenFolder:
    """Hold a folder until its ``lock`` is closed, or the process ends; ``files`` lists its files.

    It is created if missing; FolderInUse is raised if another run writes there.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = folder_named(path)
        self.path.mkdir(parents=True, exist_ok=True)
        self.lock = FolderLock(self.path)
        self.files = FileList(self.path)

    def begin(self, names: Iterable[str], later: Iterable[str] = (), *, replace: bool) -> None:
        """Prepare the folder for a new run, which writes these names and later may list others.

        FileExistsError is raised, and nothing has been changed, if there is a run that must not be
        replaced, or one of the names belongs to a file of another origin.
        """
        earlier, names = self.files.there(), list(names)
        if earlier and not replace:
            raise FileExistsError(f"{self.path} already holds a run, with {earlier[0]}")
        self.files.refuse_foreign([*names, *later])
        self.files.remove(self.files.names)
        self.files.write(names)

    def resume(self, names: Iterable[str]) -> None:
        """Resume the run in the folder, which may write these further files."""
        self.files.refuse_foreign(names := list(names))
        for name in self.files.names:
            for of_killed in unfinished(self.path / name):
                of_killed.unlink(missing_ok=True)
        self.files.write([*self.files.names, *names])

    def clear(self) -> None:
        """Remove all files of the run, and the list."""
        self.files.remove(self.files.names)
        (self.path / FILES).unlink(missing_ok=True)


def refuse_if_in_use(folder: Path) -> None:
    """Raise if a run is writing in a folder; a run that starts later is not excluded."""
    if os.path.lexists(folder / LOCK):
        FolderLock(folder).close()


def _myself() -> dict[str, Any]:
    since = time.strftime("%Y-%m-%d %H:%M:%S %z")
    return {"process": os.getpid(), "host": socket.gethostname(), "since": since}


def _holder(file: Any) -> tuple[str, str]:
    """Return the holder named in the file, in words, and how to free the folder."""
    wait = "wait until that run ends, or stop it"
    try:
        file.seek(0)
        owner = json.loads(file.read())
        process, host, since = (owner[name] for name in ("process", "host", "since"))
    except (OSError, ValueError, KeyError, TypeError):  # being written just now, or unreadable
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
