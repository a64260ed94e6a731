"""The files of a run in its folder: created or reopened to resume, and watched while it runs."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from shellcut.files.folder_lock import TakenFolder
from shellcut.files.run_folder import (
    CHECKPOINT,
    ENERGY_PICTURE,
    HISTORY,
    SPLITS,
    SUMMARY,
    resistance_picture,
    result_file,
    snapshot,
    snapshots,
)
from shellcut.results.history import HistoryWriter, Written
from shellcut.results.run_results import summary_in
from shellcut.results.vtkhdf import VtkHdfWriter

from .pictures import Pictures


class FolderLost(OSError):
    """Somebody removed, moved or emptied the folder of a running simulation."""


class RunFiles:
    """Hold the folder of a run and its growing files.

    Open the files with :meth:`begin` or :meth:`resume`; close them with :meth:`close` and free the
    folder with :meth:`release`. A folder that is missing is created; one in which another run
    writes is refused. ``columns`` are names and units of the history, the third is plotted over the
    run; ``also`` names further files that belong to the run, ``n_node`` is the size of the film.
    """

    history: HistoryWriter
    frames: VtkHdfWriter

    def __init__(
        self,
        folder: str | os.PathLike[str],
        name: str,
        *,
        columns: Sequence[tuple[str, str]],
        also: Sequence[str],
        n_node: int,
    ) -> None:
        if name != Path(name).name or not name.isprintable():
            raise ValueError(f"name must be the stem of a file, without a folder, got {name!r}")
        self.folder, self._name = Path(folder), name
        self._columns, self._also = columns, also
        self.pictures = Pictures(n_node)
        self._taken = TakenFolder(self.folder)
        self.lost = False
        """Whether the folder is no longer the one of this run."""
        self._is_new = False

    def begin(self, *, n_snapshot: int, replace: bool) -> None:
        """Remove the previous run, if allowed, and create new files; see `TakenFolder.begin`."""
        always, later = self._planned(n_snapshot)
        self._taken.begin(always, later, replace=replace)
        try:
            self._open(None, None)
        except BaseException:
            self._taken.clear()
            raise
        self._is_new = True

    def resume(self, *, history: Written, frame_time: float, n_picture: int) -> None:
        """Reopen the files of the run in the folder and drop everything after its checkpoint.

        Before it the history had this content, which must be there unchanged, the last frame was
        written at this time [s], and there were so many pictures.
        """
        growing = (self.folder / HISTORY, result_file(self.folder, self._name))
        if gone := [str(file) for file in growing if not file.exists()]:
            raise FileNotFoundError(
                f"cannot append to {' and '.join(gone)}: not there; run it from the beginning"
            )
        own = [snapshot(self.folder, k).name for k in range(n_picture)]
        self._taken.resume([*self._planned(0)[0], *own])
        later = [path.name for path in snapshots(self.folder, first=n_picture)]
        self._open(history, frame_time)  # which refuses files that have been changed
        try:
            self._taken.files.remove([*self._last_names(drawn=True), *later])
        except BaseException:
            self.close()
            raise

    def are_summed_up(self, drawn: bool) -> bool:
        """Whether all files written at the end of a run exist, drawings included if asked for.

        A damaged summary counts as none.
        """
        try:
            there = bool(summary_in(self.folder))
        except ValueError:
            there = False
        return there and all((self.folder / name).exists() for name in self._last_names(drawn))

    def new_picture(self, number: int) -> Path:
        """Return the path of the next snapshot."""
        path = snapshot(self.folder, number)
        self._taken.files.add(path.name)
        return path

    def look(self) -> None:
        """Check that the files are still in the folder.

        Raises FolderLost if they are not: further output would be lost.
        """
        self.lost = True
        # Those of another run that began here since are told by its lock.
        if not (self.history.path.exists() and result_file(self.folder, self._name).exists()):
            raise FolderLost(
                f"{self.folder} has been removed, moved or emptied while {self._name} was written "
                "there; if it was moved, the run can be resumed where it is now"
            )
        self._taken.lock.hold()
        self.lost = False

    def close(self) -> None:
        """Close the files."""
        try:
            self.frames.close()
        finally:
            self.history.close()

    def give_up(self) -> None:
        """Close the files of a run that did not start; remove them unless it was to resume."""
        try:
            self.close()
            if self._is_new:
                self._taken.clear()
        finally:
            self.release()

    def release(self) -> None:
        """Let others write in the folder; a second call does nothing."""
        self._taken.lock.close()

    def _last_names(self, drawn: bool) -> list[str]:
        curve, _ = self._columns[2]
        curves = [resistance_picture(self.folder, curve).name, ENERGY_PICTURE]
        return [SUMMARY, SPLITS, *(curves if drawn else ())]

    def _planned(self, n_snapshot: int) -> tuple[list[str], list[str]]:
        """Return the names of the files that a run always writes, and of those it may write.

        There may be one picture more at the end than are wanted.
        """
        always = [HISTORY, CHECKPOINT, *self._last_names(drawn=True), *self._also]
        always.append(result_file(self.folder, self._name).name)
        return always, [snapshot(self.folder, k).name for k in range(n_snapshot + 2)]

    def _open(self, kept: Written | None, frame_time: float | None) -> None:
        self.history = HistoryWriter(self.folder / HISTORY, self._columns, kept=kept)
        try:
            self.frames = VtkHdfWriter(result_file(self.folder, self._name), until=frame_time)
        except BaseException:
            self.history.close()
            raise
