"""Records of the files that shellcut has written in a folder, one name per line.

``run.files`` is that of a run, ``shellcut.files`` that of the other commands. A name is listed
before its file is created, so that none is missed if the process is killed. What a record does not
list is somebody else's, and so is anything behind a link: it is never replaced and never removed. A
new run removes exactly the files of ``run.files``.
"""

from __future__ import annotations

import os
from collections.abc import Iterable
from pathlib import Path, PurePosixPath, PureWindowsPath

from .regular_file import read_regular
from .whole_file import opened, unfinished, write_all, write_text

FILES, OTHERS = "run.files", "shellcut.files"

LOCK = "run.lock"

_HEADINGS = {
    FILES: "# Written here by a run of shellcut; another run in this folder removes these files "
    "only.",
    OTHERS: "# Written here by commands of shellcut, which replace these files only.",
}
_TEXT = "utf-8", "surrogateescape"  # as Python holds names that are no text
_LARGEST = 100_000_000  # bytes
_MOST_NAMED = 5


class FileList:
    """A record in a folder, ``run.files`` or ``shellcut.files``; it need not exist.

    Of ``run.files`` only the run that holds the folder changes it.
    """

    def __init__(self, folder: Path, record: str = FILES) -> None:
        self._folder, self._record = folder, record
        found = _read(folder, record)
        self._is_there = found is not None
        self.names = found or []
        """Names relative to the folder, in the order they were added, with ``/`` between parts."""

    def refuse_foreign(self, names: Iterable[str]) -> None:
        """Raise if files that are about to be written, or the record, are somebody else's."""
        known = {*self.names, self._record} if self._is_there else set()
        foreign = [
            name
            for name in (self._record, *names)
            if (name not in known and os.path.lexists(self._folder / name))
            or _leads_away(self._folder, name)
        ]
        if foreign:
            more = f" and {n} more" if (n := len(foreign) - _MOST_NAMED) > 0 else ""
            who = "this run" if self._record == FILES else "shellcut"
            by = "no run" if self._record == FILES else "none of its commands"
            raise FileExistsError(
                f"{self._folder} has {', '.join(foreign[:_MOST_NAMED])}{more}, which {who} would "
                f"replace although {by} wrote it ({self._record} does not list it): move it away, "
                "or choose another folder"
            )

    def add(self, *names: str) -> None:
        """Add those of some names that are new, before their files are created.

        A name that belongs to somebody else's file is refused.
        """
        new = [name for name in names if name not in self.names]
        if not new:
            return
        self.refuse_foreign(new)
        if not self._is_there:
            self.write(new)
            return
        with opened(self._folder / self._record, "a+") as file:
            write_all(file, "".join(f"{name}\n" for name in new).encode(*_TEXT))
        self.names += new

    def write(self, names: Iterable[str]) -> None:
        """Replace the record. If it cannot be written, the old one stays."""
        self.names = list(dict.fromkeys(names))
        lines = (_HEADINGS[self._record], *self.names)
        write_text(self._folder / self._record, "".join(f"{line}\n" for line in lines), *_TEXT)
        self._is_there = True

    def there(self) -> list[str]:
        """Return the names of the listed files that exist."""
        return [name for name in self.names if os.path.lexists(self._folder / name)]

    def remove(self, names: Iterable[str]) -> None:
        """Remove those of some files that are listed, also partly written, and empty folders."""
        for name in names:
            if name not in self.names or _leads_away(self._folder, name):
                continue
            path = self._folder / name
            for place in (path, *unfinished(path)):
                place.unlink(missing_ok=True)
            if path.parent != self._folder:
                try:
                    path.parent.rmdir()
                except OSError:  # already gone, or not empty
                    continue


def claim(
    folder: str | os.PathLike[str],
    names: Iterable[str],
    inputs: Iterable[str | os.PathLike[str]] = (),
) -> None:
    """List files that a command is about to write in a folder under names of its own choice.

    The folder is created if missing. A name of an input, which the command reads, or of somebody
    else's file is refused; nothing has been changed then.
    """
    folder, names = folder_named(folder), list(names)
    for name in names:
        _refuse_needed(folder / name, inputs)
    folder.mkdir(parents=True, exist_ok=True)
    FileList(folder, OTHERS).add(*names)


def target(
    path: str | os.PathLike[str] | None,
    default: Path,
    inputs: Iterable[str | os.PathLike[str]] = (),
) -> Path:
    """Return the file that a command writes: the one that a user names, or one that is claimed.

    A named one is replaced if it exists, unless it is an input, which the command reads, or belongs
    to a run; the default never replaces somebody else's.
    """
    if path is None:
        claim(default.parent, [default.name], inputs)
        return default
    path = Path(path)
    if not path.parent.is_dir():
        raise NotADirectoryError(
            f"{path.parent}: there is no such folder; make it, or choose another name"
        )
    _refuse_needed(path, inputs)
    return path


def refuse_input(path: Path, inputs: Iterable[str | os.PathLike[str]]) -> None:
    """Raise if a file that is about to be replaced is an input."""
    if path.exists() and any(os.path.exists(i) and os.path.samefile(path, i) for i in inputs):
        raise FileExistsError(
            f"{path} is read here and would be replaced: choose another place for the results"
        )


def _refuse_needed(path: Path, inputs: Iterable[str | os.PathLike[str]]) -> None:
    refuse_input(path, inputs)
    if path.name in (FILES, OTHERS, LOCK, *FileList(path.parent).names):
        raise FileExistsError(f"{path} is a file of a run, which needs it: choose another name")


def folder_named(path: str | os.PathLike[str]) -> Path:
    """Return the absolute path of a folder to write to, whatever the present folder becomes.

    An empty one, which would be the present folder, is refused.
    """
    if not os.fspath(path):
        raise ValueError("the folder for the results must have a name, got an empty one; . is here")
    return Path(path).absolute()


def _read(folder: Path, record: str) -> list[str] | None:
    """Return the names in the record of a folder; None if there is none, or something else.

    An unfinished last line is ignored, as are paths outside the folder, which nothing here writes.
    """
    path = folder / record
    try:
        text = "" if path.is_symlink() else read_regular(path, _LARGEST).decode(*_TEXT)
    except OSError:
        return None
    heading, *names = text.split("\n")[:-1] or [""]
    if heading != _HEADINGS[record]:
        return None
    inside = []
    for name in dict.fromkeys(names):
        parts = PurePosixPath(name).parts
        if parts and ".." not in parts and not PureWindowsPath(name).anchor:
            inside.append(name)
    return inside


def _leads_away(folder: Path, name: str) -> bool:
    """Whether a link lies on the path from a folder to a file in it."""
    return any((folder / above).is_symlink() for above in PurePosixPath(name).parents if above.name)
