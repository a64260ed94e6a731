"""A folder reserved for one run: locked, with a list of the files that the run writes there."""

from __future__ import annotations

import os
from collections.abc import Iterable

from .file_list import FILES, FileList, folder_named
from .folder_lock import FolderLock
from .whole_file import unfinished


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
