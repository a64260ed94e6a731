"""``run.files``: the names of the files that a run has written in its folder, one per line.

A name is listed before its file is created, so that none is missed if the run is killed. A new run
removes exactly the files of this list; other files in the folder stay, whatever their names.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePosixPath, PureWindowsPath

from .regular_file import read_regular
from .whole_file import atomic_write, temporary_path, write_all

FILES = "run.files"

_HEADING = (
    "# Written here by a run of shellcut; another run in this folder removes these files only."
)


class FileList:
    """The list in a folder; only the run that holds the folder's lock may change it.

    Parameters
    ----------
    folder : Path
        The folder; the list need not exist.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self.names = names_in(folder)
        """Names relative to the folder, in the order they were added, with ``/`` between parts."""

    def add(self, name: str) -> None:
        """Add a name, if it is new.

        Raises
        ------
        OSError
            If the list cannot be written.
        """
        if name in self.names:
            return
        with (self._folder / FILES).open("ab", buffering=0) as file:
            write_all(file, f"{name}\n".encode())
        self.names.append(name)

    def write(self, names: Iterable[str]) -> None:
        """Replace the list.

        Raises
        ------
        OSError
            If it cannot be written; the old list then stays.
        """
        self.names = list(dict.fromkeys(names))
        with atomic_write(self._folder / FILES) as temporary:
            temporary.write_text("".join(f"{line}\n" for line in (_HEADING, *self.names)), "utf-8")

    def there(self) -> list[str]:
        """Return the names of the listed files that exist."""
        return _there(self._folder, self.names)

    def remove(self, names: Iterable[str]) -> None:
        """Remove listed files, including partly written ones, and folders left empty."""
        for name in names:
            path = self._folder / name
            path.unlink(missing_ok=True)
            temporary_path(path).unlink(missing_ok=True)
            if path.parent != self._folder:
                try:
                    path.parent.rmdir()
                except OSError:  # already gone, or not empty
                    continue


def names_in(folder: Path) -> list[str]:
    """Return the names in the list of a folder; none without a list.

    An unfinished last line is ignored, as are paths outside the folder, which no run writes.
    """
    try:
        text = read_regular(folder / FILES).decode("utf-8", errors="replace")
    except (FileNotFoundError, NotADirectoryError):
        return []
    heading, *names = text.split("\n")[:-1] or [""]
    if heading != _HEADING:
        return []
    return [name for name in dict.fromkeys(names) if _is_inside(name)]


def files_there(folder: Path) -> list[str]:
    """Return the names of the files in a folder that a run has written and that still exist."""
    return _there(folder, names_in(folder))


def _there(folder: Path, names: Iterable[str]) -> list[str]:
    return [name for name in names if os.path.lexists(folder / name)]


def _is_inside(name: str) -> bool:
    parts = PurePosixPath(name).parts
    return bool(parts) and ".." not in parts and not PureWindowsPath(name).anchor
