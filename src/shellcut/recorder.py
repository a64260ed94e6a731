"""Recorder: the hook that leaves a run in a folder, as it goes.

History, frames and pictures of the film are written during the run, so that a killed run leaves
what it had; figures, splits and curves when it ends, however it ends (:mod:`shellcut.run_folder`
lists the files). The checkpoint is renewed now and then, so that an interrupted run can go on: what
was written after it is then dropped and written again.
"""

from __future__ import annotations

import importlib.util
import json
import logging
import os
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from .account import account_line
from .bookmark import Bookmark
from .capture import Exposure
from .checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from .frame import Frame
from .frame_output import FrameOutput
from .history import HistoryWriter
from .history_row import history_row
from .hooks import Trigger
from .piercing import ToolWires, unfelt_penetration
from .progress import Progress
from .resistance import Resistance
from .results import read
from .run_folder import (
    CHECKPOINT,
    ENERGY_PICTURE,
    HISTORY,
    SPLITS,
    SUMMARY,
    frame_list,
    resistance_picture,
    result_file,
    snapshot,
    snapshots,
)
from .run_summary import run_summary
from .simulation import Simulation
from .split_table import write_splits

_log = logging.getLogger(__name__)

# Fixed colour scale of the snapshots [MPa]: the strength of the paper's film.
_STRESS_LIMITS = (0.0, 18.0)

# Lines of account over a run: where it is, its energies, cracks and cables.
_N_ACCOUNT = 20


class RunEnded(Exception):
    """A run to be resumed has reached its end already: there is nothing left to do."""


class Recorder:
    """Write history, frames, snapshots and a summary of a run with a moving tool.

    Parameters
    ----------
    sim : Simulation
        The run; it must have a tool.
    folder : path
        Where to; made if need be. An earlier run's files in it are replaced, unless it is resumed.
    until : float
        End of the run [s], for the intervals and the progress.
    name : str
        Stem of the result file and title of the pictures.
    n_row, n_frame, n_snapshot : int
        How many rows, frames and pictures over the run.
    progress : bool
        Whether to show on standard error how far the run is, with a line of account every 5 %.
    pvd : bool
        Whether to write the frames as PVD + VTU too, for ParaView before 5.12; that takes some
        eight times as long as a frame else.
    log : callable, optional
        Also given each line that is shown.
    checkpoint_every : float or None
        Wall time between two checkpoints [s]; None makes one only when the run ends or is
        interrupted. One is always made then, unless the run died within a step.
    resume : bool
        Go on from the checkpoint in ``folder``: ``sim``, just built, is put into its state, and the
        files are appended to. Rows, frames and pictures keep the intervals they began with.

    Raises
    ------
    FileNotFoundError
        If there is no run in the folder to resume, or one of its files is gone.
    CheckpointError
        If it was a run of another model.
    RunEnded
        If the run to resume has reached ``until``; nothing in the folder has been touched.
    """

    def __init__(
        self,
        sim: Simulation,
        folder: str | os.PathLike[str],
        *,
        until: float,
        name: str,
        n_row: int = 1900,
        n_frame: int = 100,
        n_snapshot: int = 5,
        progress: bool = True,
        pvd: bool = False,
        log: Callable[[str], None] | None = None,
        checkpoint_every: float | None = 60.0,
        resume: bool = False,
    ) -> None:
        if sim.motion is None or sim.tool is None:
            raise ValueError("a Recorder needs a simulation with a tool and its motion")
        if checkpoint_every is not None and not checkpoint_every >= 0:
            raise ValueError(
                f"checkpoint_every must be a wall time in s, or None, got {checkpoint_every!r}"
            )
        self.folder = Path(folder)
        self.name = name
        self.resistance = Resistance(sim.motion)
        self._sim = sim
        self._until = until
        self._can_draw = _matplotlib_is_there()
        self._mark = Bookmark.at_start(
            until=until, n_row=n_row, n_frame=n_frame, n_snapshot=n_snapshot
        )
        if resume:
            self._mark = self._take_up_run()
        self._account_due = Trigger(until / _N_ACCOUNT)
        self._captured_time = -np.inf  # of the last frame or picture [s]
        self._clear_folder(resume)
        mode: Literal["w", "a"] = "a" if resume else "w"
        columns = [(column, unit) for column, unit, _ in self._row()]
        self._history = HistoryWriter(
            self.folder / HISTORY, columns, mode=mode, until=self._mark.row_time if resume else None
        )
        try:
            self._frames = FrameOutput(
                self.folder,
                name,
                pvd=pvd,
                mode=mode,
                until=self._mark.frame_time if resume else None,
            )
        except BaseException:
            self._history.close()
            raise
        self._progress = self._make_progress(log) if progress else None
        self._wires = ToolWires(sim.tool)
        self._checkpoint_every = np.inf if checkpoint_every is None else checkpoint_every
        self._checkpoint_failed = False
        self._started = self._saved = time.perf_counter()
        self._complete = True  # False while something is being written
        self._closed = False

    def due(self, sim: Simulation) -> bool:
        """Whether a row, a frame or a picture is due, or the progress wants to be shown."""
        return sim.state.step % 10 == 0

    def __call__(self, sim: Simulation) -> None:
        """Write what is due."""
        now, mark = sim.state.time, self._mark
        self._complete = False
        if mark.row_due(now):
            self._history.append({column: value for column, _, value in self._row()})
            mark.row_time = now
        frame_due = mark.frame_due(now)
        picture_due = mark.picture_due is not None and mark.picture_due(now)
        if frame_due or picture_due:
            exposure = self._expose(sim)
            self._captured_time = now
            if frame_due:
                _, mark.unfelt = unfelt_penetration(
                    self._wires, sim.state, sim.rotation, sim.translation
                )
                mark.largest_unfelt = max(mark.largest_unfelt, mark.unfelt)
                self._frames.append(exposure.frame)
                mark.frame_time = now
            if picture_due:
                self._draw(exposure.frame())
        self._complete = True
        if self._progress is not None:
            if self._account_due(now) and now > 0.0:
                self._progress.note(account_line(sim, self.resistance, now / self._until))
            if self._progress.wants:
                self._show_progress(self._progress)
        if time.perf_counter() - self._saved >= self._checkpoint_every:
            self._save_checkpoint()

    def place(self) -> str:
        """Return where the run is, like "angle 34.5 deg"."""
        r = self.resistance
        at = r.coordinate(self._sim.state.time)
        return f"{r.coordinate_name} {at:.4g} {r.coordinate_unit}"

    def close(self) -> None:
        """Write summary and curves, close the files."""
        if self._closed:
            return
        self._closed = True
        if not self._sim.between_steps:
            self._settle_quietly()
        with ExitStack() as at_last:  # all of it, whatever goes wrong with any
            at_last.callback(self._end_progress)
            at_last.callback(self._history.close)
            at_last.callback(self._frames.close)
            # A run that died within a step, or while writing, goes on from its last checkpoint.
            if self._complete and self._sim.between_steps:
                self._save_checkpoint()
            self._show_end()
        self._sum_up()

    def _settle_quietly(self) -> None:
        """Wait for a frame on its way: what broke the step is what the caller shall be told."""
        try:
            self._frames.settle()
        except ValueError as problem:
            _log.warning("the last frame before the end could not be made: %s", problem)

    # ------------------------------------------------------------------ restart

    def _clear_folder(self, resume: bool) -> None:
        """Remove what another run has left, or this one after its checkpoint."""
        self.folder.mkdir(parents=True, exist_ok=True)
        curve = resistance_picture(self.folder, self.resistance.columns[0][0])
        # They tell that a run has ended.
        old = [curve, *(self.folder / name for name in (SUMMARY, SPLITS, ENERGY_PICTURE))]
        old += snapshots(self.folder, first=self._mark.n_picture)
        if not resume:
            old += [self.folder / CHECKPOINT, frame_list(self.folder, self.name)]
        for path in old:
            path.unlink(missing_ok=True)

    def _wall(self) -> float:
        return self._mark.wall + time.perf_counter() - self._started

    def _take_up_run(self) -> Bookmark:
        """Put the simulation where the checkpoint was made; return where the records were."""
        path = self.folder / CHECKPOINT
        if not path.exists():
            raise FileNotFoundError(
                f"{self.folder} has no {CHECKPOINT} to resume from; run it from the beginning"
            )
        growing = (self.folder / HISTORY, result_file(self.folder, self.name))
        gone = [str(file) for file in growing if not file.exists()]
        if gone:
            raise FileNotFoundError(
                f"cannot append to {' and '.join(gone)}: not there; run it from the beginning"
            )
        mark = Bookmark.restored(load_checkpoint(self._sim, path))
        if mark is None:
            raise CheckpointError(
                f"{path} was saved by hand: it goes on with load_checkpoint, in another folder"
            )
        if self._sim.state.time >= self._until:
            raise RunEnded(f"{self.name} in {self.folder} ended already, at {self.place()}")
        return mark

    def _save_checkpoint(self) -> None:
        self._frames.settle()  # the frames before it shall be there when it is gone on with
        mark = replace(self._mark, wall=self._wall())
        try:
            save_checkpoint(self._sim, self.folder / CHECKPOINT, extra=mark.saved())
            self._checkpoint_failed = False
        except OSError as problem:
            if not self._checkpoint_failed:  # once, not every minute
                _log.warning("no checkpoint could be written, the run goes on: %s", problem)
            self._checkpoint_failed = True
        self._saved = time.perf_counter()

    # ------------------------------------------------------------------ parts

    def _row(self) -> Iterator[tuple[str, str, float]]:
        return history_row(self._sim, self.resistance, unfelt=self._mark.unfelt)

    def _felt(self) -> list[float]:
        """Return the figures of the resistance, contact and joints of all teeth together."""
        sim = self._sim
        return self.resistance.of(sim.tooth_wrenches.sum(axis=0), sim.translation)

    def _show_end(self) -> None:
        """Leave a frame and a picture of the end of the run.

        A film that blew up may have no finite stress: then the frames before are the last.
        """
        sim, now = self._sim, self._sim.state.time
        frame_due = now > self._mark.frame_time
        picture_due = self._can_draw and self._mark.picture_due is not None
        picture_due = picture_due and now > self._captured_time
        if not (frame_due or picture_due):
            return
        with np.errstate(all="ignore"):
            try:
                frame = self._expose(sim).frame()
            except ValueError:
                if sim.between_steps:
                    raise
                return  # what broke the step is on its way to the caller
            if frame_due:
                self._frames.append(lambda: frame)
            if picture_due:
                self._draw(frame)

    def _make_progress(self, log: Callable[[str], None] | None) -> Progress:
        r = self.resistance
        first, unit = r.columns[0]
        return Progress(
            r.coordinate(self._until),
            self.name,
            r.coordinate_unit,
            figure_units={first: unit, "imbalance": "%"},
            position_name=r.coordinate_name,
            log=log,
        )

    def _end_progress(self) -> None:
        if self._progress is not None:
            share = self._sim.state.time / self._until
            self._progress.note(account_line(self._sim, self.resistance, share))
            self._show_progress(self._progress)
            self._progress.close()

    def _show_progress(self, progress: Progress) -> None:
        sim, r = self._sim, self.resistance
        figures = {
            r.columns[0][0]: self._felt()[0],
            "imbalance": 100.0 * sim.ledger.relative(sim.ledger.imbalance),
        }
        progress.update(r.coordinate(sim.state.time), step=sim.state.step, **figures)

    def _expose(self, sim: Simulation) -> Exposure:
        r = self.resistance
        scalars = dict(zip((name for name, _ in r.columns), self._felt(), strict=True))
        return Exposure.of(
            sim,
            coordinate=r.coordinate(sim.state.time),
            coordinate_name=r.coordinate_name,
            coordinate_unit=r.coordinate_unit,
            scalars=scalars | {"crack length": sim.state.crack_length},
            scalar_units=dict(r.columns) | {"crack length": "mm"},
        )

    def _draw(self, frame: Frame) -> None:
        if not self._can_draw:
            return
        from .view import draw_snapshot

        began = time.perf_counter()
        path = snapshot(self.folder, self._mark.n_picture)
        draw_snapshot(path, frame, stress_limits=_STRESS_LIMITS)
        self._mark.n_picture += 1
        self._mark.drawing += time.perf_counter() - began

    def _sum_up(self) -> None:
        """Write what is known at the end: figures, splits, curves."""
        results = read(result_file(self.folder, self.name))
        figures = run_summary(
            self._sim,
            self.resistance,
            results.history,
            until=self._until,
            stepping=self._wall() - self._mark.drawing,
            drawing=self._mark.drawing,
            unfelt=self._mark.largest_unfelt,
        )
        (self.folder / SUMMARY).write_text(json.dumps(figures, indent=2) + "\n", encoding="utf-8")
        write_splits(self.folder / SPLITS, self._sim.state.split_log)
        if self._can_draw and len(results.history["time"]) > 1:
            results.plot_torque()
            results.plot_energy()


def _matplotlib_is_there() -> bool:
    return importlib.util.find_spec("matplotlib") is not None
