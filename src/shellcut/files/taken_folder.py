"""A folder that one run has for itself: locked, and with a list of what the run writes there."""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path

from .file_list import FILES, FileList
from .folder_lock import FolderLock

_MOST_NAMED = 5


class TakenFolder:
    """Hold a folder until it is closed, or the process ends.

    Parameters
    ----------
    path : path
        The folder; made if need be.

    Raises
    ------
    FolderInUse
        If another run writes there.
    OSError
        If it cannot be made or written.
    """

    def __init__(self, path: str | os.PathLike[str]) -> None:
        self.path = Path(path)
        self.path.mkdir(parents=True, exist_ok=True)
        self._lock = FolderLock(self.path)
        self._list = FileList(self.path)

    @property
    def names(self) -> list[str]:
        """Names of the files of the run, relative to the folder."""
        return self._list.names

    def begin(self, names: Iterable[str], later: Iterable[str] = (), *, replace: bool) -> None:
        """Make room for a run that begins.

        Parameters
        ----------
        names : iterable of str
            Of the files that the run will write, listed at once.
        later : iterable of str
            Of those that it may come to write: :meth:`add` lists them.
        replace : bool
            Whether the run before may be removed.

        Raises
        ------
        FileExistsError
            If there is a run that shall not be replaced, or a file of another origin has one of the
            names; then nothing has been touched.
        OSError
            If the folder cannot be written.
        """
        earlier, names = self._list.there(), list(names)
        if earlier and not replace:
            raise FileExistsError(f"{self.path} holds a run already, with {earlier[0]}")
        known = {*self._list.names, FILES} if self._list.names else set()
        foreign = [
            name
            for name in (FILES, *names, *later)
            if name not in known and os.path.lexists(self.path / name)
        ]
        if foreign:
            more = f" and {n} more" if (n := len(foreign) - _MOST_NAMED) > 0 else ""
            raise FileExistsError(
                f"{self.path} has {', '.join(foreign[:_MOST_NAMED])}{more}, which no run is known "
                f"to have written ({FILES} does not list it) and this run would replace: move it "
                "away, or choose another folder"
            )
        self._list.remove(self._list.names)
        self._list.write(names)

    def go_on(self, names: Iterable[str]) -> None:
        """Go on with the run in the folder, which may write these files besides.

        Raises
        ------
        OSError
            If the list cannot be written.
        """
        self._list.write([*self._list.names, *names])

    def add(self, path: Path) -> None:
        """List a file in the folder that is about to be written.

        Raises
        ------
        OSError
            If the list cannot be written.
        """
        self._list.add(path.relative_to(self.path).as_posix())

    def remove(self, names: Iterable[str]) -> None:
        """Remove those of these files that are of the run."""
        known = set(self._list.names)
        self._list.remove(name for name in names if name in known)

    def clear(self) -> None:
        """Remove all files of the run, and the list."""
        self._list.remove(self._list.names)
        (self.path / FILES).unlink(missing_ok=True)

    def hold(self) -> None:
        """Make sure that the folder is still ours, see :meth:`FolderLock.hold`."""
        self._lock.hold()

    def close(self) -> None:
        """Give the folder back; a second call does nothing."""
        self._lock.close()
