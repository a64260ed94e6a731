"""Recorder: the hook that writes a run to a folder while it proceeds.

History, frames and pictures are written during the run, so a killed run leaves them behind;
values, splits and curves are written when it ends, for whatever reason
(:mod:`shellcut.files.run_folder` lists the files). A checkpoint is saved at intervals, so that an
interrupted run can resume: it drops the output after the checkpoint and writes it again.
"""

from __future__ import annotations

import json
import logging
import os
import time
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import asdict, replace
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from shellcut.arguments import checked
from shellcut.checks import ModelCheck, check_model
from shellcut.files.file_list import folder_named
from shellcut.files.run_folder import CHECKPOINT, SPLITS, SUMMARY, result_file
from shellcut.files.whole_file import write_text
from shellcut.frame import Frame
from shellcut.numerics.trigger import Trigger
from shellcut.results.energy_account import KINETIC_IN_FILM, TOOL_WORK_IN_FILM
from shellcut.results.history import write_splits
from shellcut.results.run_results import read
from shellcut.results.steady_window import CUT_LENGTH, PROCESS_ZONE, TO_SPARE, UNCUT_AHEAD
from shellcut.results.verdict import Line, say, verdict
from shellcut.unit import shown
from shellcut.view import Look, can_draw, draw_scene
from shellcut.view.progress import Progress

from .checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from .cut_front import CutFront
from .frame_capture import frame_of
from .overstress import Overstress
from .resistance import resistance_of
from .run_files import RunFiles
from .run_options import RunArguments, RunOptions
from .run_summary import cut_evidence, run_summary
from .schedule import Schedule
from .status_line import status_line
from .unfelt_penetration import Unfelt, UnfeltPenetration

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from shellcut.simulation.simulation import Simulation

_log = logging.getLogger(__name__)

# Status lines over a run.
_N_STATUS = 20

# Wall time between two checks that the files are still in place [s].
_LOOK_EVERY = 1.0


class RunEnded(Exception):
    """The run to resume has already reached its end: there is nothing left to do."""


class Recorder:
    """Write history, frames, snapshots and a summary of a run with a moving tool or support.

    Parameters
    ----------
    sim : Simulation
        The run; a tool or a support must move.
    folder : path
        Output folder; created if missing, and locked until :meth:`close`: no other run can write
        there. All files of an earlier run, and no others, are removed unless it is resumed.
    until : float
        End of the run [s]; sets the intervals and the progress.
    name : str
        Stem of the result file and title of the pictures.
    check : ModelCheck, optional
        Check of this model, if already made; otherwise it is made here.
    also : sequence of str
        Names of further files in the folder that belong to the run.
    **options
        Fields of :class:`~shellcut.recording.run_options.RunOptions`.

    Attributes
    ----------
    verdict : tuple of Line
        How far the results can be trusted; empty before the end of the run.

    Raises
    ------
    FolderInUse
        If another run, of this or another process, writes in the folder; that run is not disturbed.
    FileExistsError
        If this would replace a file that no run has written, or an earlier run that must not be
        replaced; nothing in the folder has been changed.
    FileNotFoundError
        If there is no run to resume in the folder, or one of its files is missing.
    CheckpointError
        If the run in the folder was one of another model.
    RunEnded
        If the run to resume has reached ``until``; nothing in the folder has been changed.
    RefusedModel
        If a check refuses the model; nothing in the folder has been changed.
    FolderLost
        During the run, if somebody removes, moves or empties the folder.
    OSError
        During the run, if a file cannot be written, as on a full disk; ``resume`` continues it.
    """

    @checked
    def __init__(
        self,
        sim: Simulation,
        folder: str | os.PathLike[str],
        *,
        until: float,
        name: str,
        check: ModelCheck | None = None,
        also: Sequence[str] = (),
        **options: Unpack[RunArguments],
    ) -> None:
        if not (isfinite(until) and until > 0.0):
            raise ValueError(f"until must be a positive time in s, got {until!r}")
        self.folder = folder_named(folder)
        self.resistance = resistance_of(sim, until)
        chosen = RunOptions(**options)
        self._check = check or check_model(sim, until)
        if not chosen.resume:
            self._check.enforce(force=chosen.force)
        self.verdict: tuple[Line, ...] = ()
        self.name = name
        self._sim = sim
        self._front = CutFront(sim, until)
        self._until = until
        self._can_draw = can_draw()
        self._draws_curves = chosen.curves and self._can_draw
        # One stress scale for all pictures: from 0 to the strength. Without a law the maximum is
        # not known beforehand, so each picture has its own scale.
        self._strength = None if sim.law is None else sim.law.strength
        self._schedule = Schedule.at_start(until, chosen)
        if chosen.resume and not (self.folder / CHECKPOINT).exists():
            raise FileNotFoundError(
                f"{self.folder} has no {CHECKPOINT} to resume from; run it from the beginning"
            )
        self._open_files(chosen, also)
        self._check.say()
        self._status_due = Trigger(until / _N_STATUS)
        self._status_step = -1  # step of the last status line
        self._progress, self._log = None, chosen.log
        if chosen.progress:
            (first, unit), coordinate = self.resistance.columns[0], self.resistance.coordinate_name
            units = {coordinate: self.resistance.coordinate_unit, first: unit, "imbalance": "%"}
            self._progress = Progress(name, figure_units=units, log=chosen.log)
        self._unfelt, self._overstress = UnfeltPenetration(sim), Overstress(sim)
        self._checkpoint_every = (
            np.inf if chosen.checkpoint_every is None else chosen.checkpoint_every
        )
        self._checkpoint_failed = False
        self._started = self._looked = time.perf_counter()
        self._saved = self._started if chosen.resume else -np.inf
        self._record_failed = self._closed = False

    def _open_files(self, chosen: RunOptions, also: Sequence[str]) -> None:
        """Begin the files of the run, or resume them where its checkpoint is."""
        self._files = RunFiles(
            self.folder,
            self.name,
            columns=[(column, unit) for column, unit, _ in self._row()],
            also=also,
            n_node=self._sim.mesh.n_node,
        )
        with ExitStack() as on_error:
            on_error.callback(self._files.release)
            if chosen.resume:
                self._schedule = self._resume_from_checkpoint()
                self._files.resume(
                    history=self._schedule.history,
                    frame_time=self._schedule.frame_time,
                    n_picture=self._schedule.n_picture,
                )
            else:
                self._files.begin(n_snapshot=chosen.n_snapshot, replace=chosen.replace)
            self._schedule.history = self._files.history.written
            on_error.pop_all()

    def due(self, sim: Simulation) -> bool:
        """Whether a row, a frame or a picture may be due, or the progress display."""
        return sim.state.step % 10 == 0

    def __call__(self, sim: Simulation) -> None:
        """Write what is due."""
        if self._closed:
            raise ValueError(
                f"a Recorder records one run, and that in {self.folder} has ended: make another "
                "one, in another folder or with resume=True"
            )
        now, clock = sim.state.time, time.perf_counter()
        # Before the rest, which a resumed run writes: it need not wait for the first picture.
        if clock - self._saved >= self._checkpoint_every:
            self._files.look()  # a checkpoint alone cannot be resumed
            self._save_checkpoint()
        if self._schedule.due(now):
            before = self._schedule.copied()
            try:
                self._record(sim, now, self._schedule)
            except BaseException:
                # Record the same again when the run is resumed.
                self._schedule, self._record_failed = before, True
                raise
        if self._progress is not None:
            if self._status_due(now) and now > 0.0:
                self._note_status()
            if self._progress.wants:
                self._show_progress(self._progress)
        if clock - self._looked >= _LOOK_EVERY:
            self._looked = clock
            self._files.look()

    def _record(self, sim: Simulation, now: float, schedule: Schedule) -> None:
        if schedule.row_due(now):
            self._files.history.append(self._now())
            schedule.history, schedule.row_time = self._files.history.written, now
        if schedule.look_due(now):
            schedule.note_unfelt(self._unfelt.now())
            schedule.note_stress(self._overstress.now())
        frame_due = schedule.frame_due(now)
        picture_due = schedule.picture_due is not None and schedule.picture_due(now)
        if frame_due or picture_due:
            self._show(sim, to_file=frame_due, to_picture=picture_due)
            schedule.captured_time = now
            if frame_due:
                schedule.frame_time = now

    def place(self) -> str:
        """Return where the run is, like "angle 34.5 deg"."""
        r = self.resistance
        at = r.coordinate(self._sim.state.time)
        return f"{r.coordinate_name} {at:.4g} {r.coordinate_unit}"

    def close(self) -> None:
        """Write checkpoint, summary and curves, log the verdict, close files and folder.

        After a failed write, only the checkpoint is written, if possible: the rest describes a
        completed run and is written once this run has been resumed.
        """
        if self._closed:
            return
        self._closed = True
        with ExitStack() as at_last:  # do everything, even if one part fails
            at_last.callback(self._files.release)
            at_last.callback(self._files.pictures.close)
            with ExitStack() as before:
                before.callback(self._end_progress)
                before.callback(self._files.close)
                self._end_records()
            if not self._has_failed():
                self._sum_up()
        say(self.verdict)

    def give_up(self) -> None:
        """Close the files of a run that does not start; a resumed run's files stay as they were."""
        if not self._closed:
            self._closed = True
            self._files.give_up()

    def _end_records(self) -> None:
        self._files.look()
        # A run that failed within a step, or lost a picture, resumes from its last checkpoint.
        if self._sim.between_steps and not (self._files.lost or self._files.pictures.failed):
            self._save_checkpoint()
        if not self._has_failed():
            self._show_end()

    def _has_failed(self) -> bool:
        picture_failed = self._files.pictures.failed and self._sim.between_steps
        return self._record_failed or self._files.lost or picture_failed

    # ------------------------------------------------------------------ restart

    def _wall(self) -> float:
        return self._schedule.wall + time.perf_counter() - self._started

    def _resume_from_checkpoint(self) -> Schedule:
        """Load the checkpoint into the simulation; return the schedule."""
        path = self.folder / CHECKPOINT
        saved = load_checkpoint(self._sim, path)
        self._front.restore(saved.pop("cut_front", self._front.saved()))
        schedule = Schedule.restored(saved)
        if schedule is None:
            raise CheckpointError(
                f"{path} was saved by hand: resume it with load_checkpoint, in another folder"
            )
        # A run that was killed or failed after its last step still needs its summary.
        if self._sim.state.time >= self._until and self._files.are_summed_up(self._draws_curves):
            raise RunEnded(f"{self.name} in {self.folder} has already ended, at {self.place()}")
        return schedule

    def _save_checkpoint(self) -> None:
        # A resumed run must find the pictures so far.
        self._files.pictures.settle()
        schedule = replace(self._schedule, wall=self._wall())
        try:
            saved = {**schedule.saved(), "cut_front": self._front.saved()}
            self._files.frames.sync()
            self._files.history.sync()
            save_checkpoint(self._sim, self.folder / CHECKPOINT, extra=saved)
            self._checkpoint_failed = False
        except OSError as problem:
            if not self._checkpoint_failed:  # once, not every minute
                _log.warning("no checkpoint could be written, the run continues: %s", problem)
            self._checkpoint_failed = True
        self._saved = time.perf_counter()

    # ------------------------------------------------------------------ parts

    def _row(self) -> Iterator[tuple[str, str, float]]:
        """Yield name, unit and value of every column of the history, the plotted value third."""
        sim, r = self._sim, self.resistance
        s = sim.state
        yield "time", "s", s.time
        yield r.coordinate_name, r.coordinate_unit, r.coordinate(s.time)
        yield from r.row(sim)
        ledger = sim.close_ledger()
        yield from ((name, "N*mm", energy) for name, energy in vars(ledger).items())
        imbalance = ledger.imbalance
        yield "imbalance", "N*mm", imbalance
        yield "imbalance_rel", "-", ledger.relative(imbalance)
        yield "dt", "s", s.dt
        if sim.film_motion is not None:
            yield KINETIC_IN_FILM, "N*mm", sim.kinetic_in_film
            yield TOOL_WORK_IN_FILM, "N*mm", sim.work_in_film
        if sim.pace.share is not None:
            yield "pace", "-", sim.pace.now
        yield "cables_created", "-", s.n_cable
        yield "cables_jointed", "-", sim.cables.n_joint_made
        yield "cables_broken", "-", sim.cables.n_broken
        yield "crack_length", "mm", s.crack_length
        front = (CUT_LENGTH, PROCESS_ZONE, UNCUT_AHEAD, TO_SPARE)
        for edge, row in enumerate(self._front.rows(sim).tolist(), start=1):
            yield from ((f"{what}{edge}", "mm", mm) for what, mm in zip(front, row, strict=True))
        if sim.contact is not None:
            yield "deepest_penetration", "mm", sim.contact.forces.deepest
            yield "unfelt_penetration", "mm", self._schedule.unfelt

    def _now(self) -> dict[str, float]:
        return {column: value for column, _, value in self._row()}

    def _show_end(self) -> None:
        """Write a row, a frame and a picture of the end of the run.

        The checkpoint comes before them: a run that goes on drops them again. A film that blew up
        may have no finite stress: then the earlier frames are the last ones.
        """
        sim, now = self._sim, self._sim.state.time
        if sim.between_steps and now > self._schedule.row_time:
            self._files.history.append(self._now())
        frame_due = now > self._schedule.frame_time
        picture_due = (
            self._can_draw
            and self._schedule.picture_due is not None
            and now > self._schedule.captured_time
        )
        if frame_due or picture_due:
            with np.errstate(all="ignore"):
                self._show(sim, to_file=frame_due, to_picture=picture_due)

    def _end_progress(self) -> None:
        if self._progress is not None:
            if self._status_step < self._sim.state.step:
                self._note_status()
            self._show_progress(self._progress)
            self._progress.close()

    def _note_status(self) -> None:
        if self._log is not None:
            share = self._sim.state.time / self._until
            self._log(status_line(self._sim, self.resistance, share))
        self._status_step = self._sim.state.step

    def _show_progress(self, progress: Progress) -> None:
        sim, r = self._sim, self.resistance
        figures = {
            r.coordinate_name: r.coordinate(sim.state.time),
            r.columns[0][0]: r.felt(sim)[0],
        }
        if sim.imbalance is not None:
            figures["imbalance"] = 100.0 * sim.imbalance
        progress.update(sim.state.time / self._until, step=sim.state.step, **figures)

    def _show(self, sim: Simulation, *, to_file: bool, to_picture: bool) -> None:
        """Write and draw the present frame; a film that has blown up has none."""
        r, n = self.resistance, sim.state.node
        scalars = dict(zip((name for name, _ in r.columns), r.felt(sim), strict=True))
        try:
            frame = frame_of(
                sim,
                coordinate=r.coordinate(sim.state.time),
                coordinate_name=r.coordinate_name,
                coordinate_unit=r.coordinate_unit,
                scalars=scalars | {"crack length": sim.state.crack_length},
                scalar_units=dict(r.columns) | {"crack length": "mm"},
            )
        except ValueError as problem:
            moved = np.hstack([n.x, n.t, n.velocity_half])[: sim.state.n_node]
            if sim.between_steps and np.isfinite(moved).all():
                raise
            # The next step says so, or has said so.
            _log.warning("the frame at %s could not be made: %s", self.place(), problem)
            return
        if to_file:
            self._files.frames.append(frame)
        if to_picture and self._can_draw:
            path = self._files.new_picture(self._schedule.n_picture)
            self._schedule.n_picture += 1
            high = None if self._strength is None else shown("MPa")[1] * self._strength
            self._files.pictures.draw(_draw_snapshot, path, frame, Look(low=0.0, high=high))

    def _sum_up(self) -> None:
        """Write the files of a completed run: values, splits, curves."""
        results = read(result_file(self.folder, self.name))
        figures = run_summary(
            self._sim,
            self.resistance,
            results.history,
            self._now() if self._sim.between_steps else None,
            wall=self._wall(),
            unfelt=Unfelt(self._schedule.largest_unfelt, self._schedule.largest_unfelt_edge),
        )
        figures |= cut_evidence(self._sim, self._check.sweep)
        if self._sim.law is not None and isfinite(self._schedule.lasting_stress):
            figures["overstress_rel"] = self._schedule.lasting_stress
        figures["share_done"] = min(self._sim.state.time / self._until, 1.0)
        if not self._sim.between_steps:
            figures["broke_off"] = 1
        elif figures["share_done"] < 1.0 and self._sim.imbalance is None:  # hardly any work
            figures = {
                k: v for k, v in figures.items() if k not in ("imbalance_rel", "kinetic_rel")
            }
        self.verdict = tuple(verdict(figures, map(str, self._check.doubts)))
        said = {**figures, "verdict": [asdict(line) for line in self.verdict]}
        self._files.pictures.settle()
        write_splits(self.folder / SPLITS, self._sim.state.splits)
        write_text(self.folder / SUMMARY, json.dumps(said, indent=2) + "\n")
        if self._draws_curves and len(results.history["time"]) > 1:
            self._files.pictures.draw(_draw_curves, result_file(self.folder, self.name))


def _draw_snapshot(path: Path, frame: Frame, look: Look) -> None:
    draw_scene(path, frame, look=look, close_up=True, size=(1170, 630))


def _draw_curves(path: Path) -> None:
    results = read(path)
    results.plot_torque()
    results.plot_energy()
