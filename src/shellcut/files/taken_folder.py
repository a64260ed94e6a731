"""A folder reserved for one run: locked, with a list of the files that the run writes there."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from .file_list import FILES, FileList, folder_named
from .folder_lock import FolderLock
from .whole_file import unfinished


class TakenFolder:
    """Hold a folder until it is closed, or the process ends.

    Parameters
    ----------
    path : path
        The folder; created if missing.

    Raises
    ------
    FolderInUse
        If another run writes there.
    ValueError
        If the path is empty.
    OSError
        If it cannot be created or written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = folder_named(path)
        self.path.mkdir(parents=True, exist_ok=True)
        self._lock = FolderLock(self.path)
        self._list = FileList(self.path)

    @property
    def names(self) -> list[str]:
        """Names of the files of the run, relative to the folder."""
        return self._list.names

    def begin(self, names: Iterable[str], later: Iterable[str] = (), *, replace: bool) -> None:
        """Prepare the folder for a new run.

        Parameters
        ----------
        names : iterable of str
            Files that the run will write, listed at once.
        later : iterable of str
            Files that it may write; :meth:`add` lists them when it does.
        replace : bool
            Whether the previous run may be removed.

        Raises
        ------
        FileExistsError
            If there is a run that must not be replaced, or one of the names belongs to a file of
            another origin; nothing has been changed then.
        OSError
            If the folder cannot be written.
        """
        earlier, names = self._list.there(), list(names)
        if earlier and not replace:
            raise FileExistsError(f"{self.path} already holds a run, with {earlier[0]}")
        self._list.refuse_foreign([*names, *later])
        self._list.remove(self._list.names)
        self._list.write(names)

    def resume(self, names: Iterable[str]) -> None:
        """Resume the run in the folder, which may write these further files.

        Raises
        ------
        FileExistsError
            If one of the names belongs to a file of another origin.
        OSError
            If the list cannot be written.
        """
        self._list.refuse_foreign(names := list(names))
        for name in self._list.names:
            for of_killed in unfinished(self.path / name):
                of_killed.unlink(missing_ok=True)
        self._list.write([*self._list.names, *names])

    def add(self, path: Path) -> None:
        """List a file in the folder that is about to be written.

        Raises
        ------
        FileExistsError
            If it is there and no run wrote it.
        OSError
            If the list cannot be written.
        """
        self._list.add(path.relative_to(self.path).as_posix())

    def remove(self, names: Iterable[str]) -> None:
        """Remove those of these files that belong to the run."""
        known = set(self._list.names)
        self._list.remove(name for name in names if name in known)

    def clear(self) -> None:
        """Remove all files of the run, and the list."""
        self._list.remove(self._list.names)
        (self.path / FILES).unlink(missing_ok=True)

    def hold(self) -> None:
        """Make sure that this run still holds the folder, see :meth:`FolderLock.hold`."""
        self._lock.hold()

    def close(self) -> None:
        """Release the folder; a second call does nothing."""
        self._lock.close()
