"""Recorder: the hook that leaves a run in a folder, as it goes.

``history.csv`` (a row at equal intervals of time), ``NAME.vtkhdf`` (one temporal file) and the
pictures ``snapshot_*.png`` are written during the run, so that a killed run leaves what it had;
``summary.json``, ``splits.csv`` (time, place and force jump of every split), ``torque.png`` or
``force.png`` and ``energy.png`` when it ends, however it ends. ``NAME.pvd`` and its frames
(:mod:`shellcut.pvd`) are written beside them if asked for. ``checkpoint.h5`` is renewed now and
then, so that an interrupted run can go on (:mod:`shellcut.checkpoint`): what was written after the
checkpoint is then dropped and written again.
"""

from __future__ import annotations

import csv
import importlib.util
import json
import logging
import os
import time
from collections.abc import Callable
from dataclasses import asdict, astuple
from pathlib import Path
from typing import Any, Literal

import numpy as np
from scipy.integrate import trapezoid

from ._jit import Floats
from .account import account_line
from .capture import capture
from .checkpoint import CheckpointError, load_checkpoint, save_checkpoint
from .frame import Frame
from .frame_output import FrameOutput, result_file
from .history import HistoryWriter, read_history
from .hooks import Trigger
from .piercing import ToolWires, unfelt_penetration
from .progress import Progress
from .resistance import Resistance
from .results import read
from .simulation import Simulation

_log = logging.getLogger(__name__)

_CHECKPOINT = "checkpoint.h5"

# Fixed colour scale of the snapshots [MPa]: the strength of the paper's film.
_STRESS_LIMITS = (0.0, 18.0)

# Imbalance and kinetic energy are compared with the tool's work from this angle on [degrees], or
# after a tenth of a straight way.
_TRUSTED_FROM_DEG = 10.0

# Lines of account over a run: where it is, its energies, cracks and cables.
_N_ACCOUNT = 20

_ENERGIES = (
    "tool_work",
    "load_work",
    "support_work",
    "kinetic_translation",
    "kinetic_rotation",
    "strain",
    "cohesive_work",
    "cohesive_start_work",
    "cohesive_stored",
    "cohesive_dissipated",
    "contact_work",
    "contact_stored",
    "damping_stiffness",
    "damping_mass",
)


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
        self._stem = self.folder / name
        self.resistance = Resistance(sim.motion)
        self._sim = sim
        self._until = until
        self._row_due = Trigger(until / n_row)
        self._frame_due = Trigger(until / n_frame)
        self._account_due = Trigger(until / _N_ACCOUNT)
        self._picture_due = Trigger(until / n_snapshot) if n_snapshot else None
        # Times of the last row, of the last frame and of the last picture or frame.
        self._row_time = self._frame_time = self._captured_time = -np.inf
        self._n_picture = 0
        self._unfelt, self._largest_unfelt = 0.0, 0.0
        self._wall_before, self._drawing = 0.0, 0.0
        if resume:
            self._take_up_run()
        self._clear_folder(resume)
        self._n_tooth = sim.tool.n_body
        columns = [
            ("time", "s"),
            (self.resistance.coordinate_name, self.resistance.coordinate_unit),
        ]
        for figure, unit in self.resistance.columns:
            columns += [(figure, unit), (f"{figure}_contact", unit), (f"{figure}_joints", unit)]
        first, unit = self.resistance.columns[0]
        columns += [(f"{first}_tooth_{k + 1}", unit) for k in range(self._n_tooth)]
        columns += [(e, "N*mm") for e in _ENERGIES]
        columns += [("imbalance", "N*mm"), ("imbalance_rel", "-"), ("dt", "s")]
        columns += [(f"cables_{c}", "-") for c in ("created", "jointed", "broken")]
        columns += [("crack_length", "mm"), ("deepest_penetration", "mm")]
        columns += [("unfelt_penetration", "mm")]
        mode: Literal["w", "a"] = "a" if resume else "w"
        history, _ = self._growing_files()
        last_row, last_frame = (self._row_time, self._frame_time) if resume else (None, None)
        self._history = HistoryWriter(history, columns, mode=mode, until=last_row)
        self._frames = FrameOutput(self._stem, pvd=pvd, mode=mode, until=last_frame)
        self._can_draw = _matplotlib_is_there()
        figures = {first: unit, "imbalance": "%"}
        self._progress = (
            Progress(
                self.resistance.coordinate(until),
                name,
                self.resistance.coordinate_unit,
                figure_units=figures,
                position_name=self.resistance.coordinate_name,
                log=log,
            )
            if progress
            else None
        )
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
        now = sim.state.time
        self._complete = False
        if self._row_due(now):
            self._history.append(self._row(sim))
            self._row_time = now
        frame_due = self._frame_due(now)
        picture_due = self._picture_due is not None and self._picture_due(now)
        if frame_due or picture_due:
            frame = self._capture(sim)
            self._captured_time = now
            if frame_due:
                self._frames.append(frame)
                self._frame_time = now
                _, self._unfelt = unfelt_penetration(
                    self._wires, sim.state, sim.rotation, sim.translation
                )
                self._largest_unfelt = max(self._largest_unfelt, self._unfelt)
            if picture_due:
                self._draw(frame)
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
        if self._progress is not None:
            share = self._sim.state.time / self._until
            self._progress.note(account_line(self._sim, self.resistance, share))
            self._show_progress(self._progress)
            self._progress.close()
        try:
            # A run that died within a step, or while writing, goes on from its last checkpoint.
            if self._complete and self._sim.between_steps:
                self._save_checkpoint()
            self._show_end()
        finally:
            self._history.close()
            self._frames.close()
        wall = self._wall()
        history, _ = read_history(self.folder / "history.csv")
        summary = self.summary(history, wall)
        (self.folder / "summary.json").write_text(json.dumps(summary, indent=2) + "\n")
        self._write_splits()
        if self._can_draw and len(history["time"]) > 1:
            self._draw_curves()

    # ------------------------------------------------------------------ restart

    def _growing_files(self) -> tuple[Path, Path]:
        return self.folder / "history.csv", result_file(self._stem)

    def _clear_folder(self, resume: bool) -> None:
        """Remove what another run has left, or this one after its checkpoint."""
        self.folder.mkdir(parents=True, exist_ok=True)
        for old in self.folder.glob("snapshot_*.png"):
            number = old.stem.partition("_")[2]
            if number.isdigit() and int(number) >= self._n_picture:
                old.unlink()
        if not resume:
            (self.folder / _CHECKPOINT).unlink(missing_ok=True)
            self._stem.with_name(f"{self.name}.pvd").unlink(missing_ok=True)

    def _wall(self) -> float:
        return self._wall_before + time.perf_counter() - self._started

    def _bookmark(self) -> dict[str, Any]:
        """Return where the records are, to go with a checkpoint."""
        due = {"row": self._row_due, "frame": self._frame_due, "picture": self._picture_due}
        return {
            "due": {name: asdict(trigger) for name, trigger in due.items() if trigger},
            "row_time": self._row_time,
            "frame_time": self._frame_time,
            "n_picture": self._n_picture,
            "unfelt": self._unfelt,
            "largest_unfelt": self._largest_unfelt,
            "wall": self._wall(),
            "drawing": self._drawing,
        }

    def _take_up_run(self) -> None:
        """Put the simulation and the records where the checkpoint was made."""
        path = self.folder / _CHECKPOINT
        if not path.exists():
            raise FileNotFoundError(
                f"{self.folder} has no {_CHECKPOINT} to resume from; run it from the beginning"
            )
        gone = [str(file) for file in self._growing_files() if not file.exists()]
        if gone:
            raise FileNotFoundError(
                f"cannot append to {' and '.join(gone)}: not there; run it from the beginning"
            )
        mark = load_checkpoint(self._sim, path)
        if "due" not in mark:
            raise CheckpointError(
                f"{path} was saved by hand: it goes on with load_checkpoint, in another folder"
            )
        if self._sim.state.time >= self._until:
            raise RunEnded(f"{self.name} in {self.folder} ended already, at {self.place()}")
        due = {name: Trigger(**trigger) for name, trigger in mark["due"].items()}
        self._row_due, self._frame_due = due["row"], due["frame"]
        self._picture_due = due.get("picture")
        self._row_time, self._frame_time = mark["row_time"], mark["frame_time"]
        self._n_picture = mark["n_picture"]
        self._unfelt, self._largest_unfelt = mark["unfelt"], mark["largest_unfelt"]
        self._wall_before, self._drawing = mark["wall"], mark["drawing"]

    def _save_checkpoint(self) -> None:
        self._frames.settle()  # the frames before it shall be there when it is gone on with
        try:
            save_checkpoint(self._sim, self.folder / _CHECKPOINT, extra=self._bookmark())
            self._checkpoint_failed = False
        except OSError as problem:
            if not self._checkpoint_failed:  # once, not every minute
                _log.warning("no checkpoint could be written, the run goes on: %s", problem)
            self._checkpoint_failed = True
        self._saved = time.perf_counter()

    # ------------------------------------------------------------------ parts

    def _show_end(self) -> None:
        """Leave a frame and a picture of the end of the run.

        A film that blew up may have no finite stress: then the frames before are the last.
        """
        sim, now = self._sim, self._sim.state.time
        frame_due = now > self._frame_time
        picture_due = self._can_draw and self._picture_due is not None
        picture_due = picture_due and now > self._captured_time
        if not (frame_due or picture_due):
            return
        with np.errstate(all="ignore"):
            try:
                frame = self._capture(sim)
            except ValueError:
                if sim.between_steps:
                    raise
                return  # what broke the step is on its way to the caller
            if frame_due:
                self._frames.append(frame)
            if picture_due:
                self._draw(frame)

    def _show_progress(self, progress: Progress) -> None:
        sim, r = self._sim, self.resistance
        total = r.of(_total(sim).sum(axis=0), sim.translation)
        figures = {
            r.columns[0][0]: total[0],
            "imbalance": 100.0 * sim.ledger.relative(sim.ledger.imbalance),
        }
        progress.update(r.coordinate(sim.state.time), step=sim.state.step, **figures)

    def _row(self, sim: Simulation) -> dict[str, float]:
        s, book, origin = sim.state, sim.ledger, sim.translation
        contact, joints = sim.contact_forces.wrench, sim.cable_forces.wrench
        r = self.resistance
        row = {"time": s.time, r.coordinate_name: r.coordinate(s.time)}
        of_contact = r.of(contact.sum(axis=0), origin)
        of_joints = r.of(joints.sum(axis=0), origin)
        for (figure, _), c, j in zip(r.columns, of_contact, of_joints, strict=True):
            row |= {figure: c + j, f"{figure}_contact": c, f"{figure}_joints": j}
        first = r.columns[0][0]
        for k, wrench in enumerate(contact + joints):
            row[f"{first}_tooth_{k + 1}"] = r.of(wrench, origin)[0]
        sim.close_ledger()
        row |= {e: getattr(book, e) for e in _ENERGIES}
        row |= {
            "imbalance": book.imbalance,
            "imbalance_rel": book.relative(book.imbalance),
            "dt": s.dt,
            "cables_created": s.n_cable,
            "cables_jointed": sim.n_joint_made,
            "cables_broken": sim.n_cable_broken,
            "crack_length": s.crack_length,
            "deepest_penetration": sim.contact_forces.deepest,
            "unfelt_penetration": self._unfelt,
        }
        return row

    def _capture(self, sim: Simulation) -> Frame:
        r = self.resistance
        figures = r.of(_total(sim).sum(axis=0), sim.translation)
        scalars = dict(zip((name for name, _ in r.columns), figures, strict=True))
        return capture(
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
        path = self.folder / f"snapshot_{self._n_picture:02d}.png"
        draw_snapshot(path, frame, stress_limits=_STRESS_LIMITS)
        self._n_picture += 1
        self._drawing += time.perf_counter() - began

    def summary(self, history: dict[str, Floats], wall: float) -> dict[str, float]:
        """Return the figures of ``summary.json``; names carry the units."""
        sim, r = self._sim, self.resistance
        sim.close_ledger()
        book, s = sim.ledger, sim.state
        x = history[r.coordinate_name]
        # At the start next to no work has been done to compare with.
        turns = r.coordinate_unit == "deg"
        trusted = x >= (_TRUSTED_FROM_DEG if turns else 0.1 * r.coordinate(self._until))
        work = np.abs(history["tool_work"][trusted])
        kinetic = history["kinetic_translation"] + history["kinetic_rotation"]

        def largest_relative(energy: Floats) -> float:
            share = np.abs(energy[trusted]) / np.maximum(work, np.finfo(float).tiny)
            return float(share.max(initial=0.0))

        stepping = wall - self._drawing
        figures = {
            "n_quad": sim.mesh.n_quad,
            "n_step": s.step,
            "dt_s": s.time / max(s.step, 1),
            "wall_s": stepping,
            "ns_per_quad_step": 1e9 * stepping / sim.mesh.n_quad / max(s.step, 1),
            "pictures_s": self._drawing,
            f"{r.coordinate_name}_end_{r.coordinate_unit}": r.coordinate(s.time),
            "tool_work_Nmm": book.tool_work,
            "kinetic_Nmm": book.kinetic,
            "strain_Nmm": book.strain,
            "cohesive_work_Nmm": book.cohesive_work,
            "cohesive_dissipated_Nmm": book.cohesive_dissipated,
            "cohesive_stored_Nmm": book.cohesive_stored,
            "contact_Nmm": book.contact_work,
            "damping_Nmm": book.damping,
            "imbalance_rel": largest_relative(history["imbalance"]),
            "kinetic_rel": largest_relative(kinetic),
            "n_cable_created": s.n_cable,
            "n_cable_jointed": sim.n_joint_made,
            "n_cable_broken": sim.n_cable_broken,
            "crack_length_mm": s.crack_length,
            "n_recovery_borrowed": sim.criterion.n_borrowed if sim.criterion else 0,
            "unfelt_penetration_mm": self._largest_unfelt,
            "largest_overshoot_mm": s.cable.overshoot[: s.n_cable].max(initial=0.0),
            "added_inertia_factor": sim.shell.added_inertia_factor,
        }
        figures |= self._plateau(history)
        return {k: (int(v) if k.startswith("n_") else float(v)) for k, v in figures.items()}

    def _write_splits(self) -> None:
        with (self.folder / "splits.csv").open("w", newline="") as file:
            table = csv.writer(file)
            places = [f"{name} [mm]" for name in ("x", "y", "z", "X", "Y", "Z")]
            names = [
                "time [s]",
                "node [-]",
                "twin [-]",
                "kind [-]",
                "measure [-]",
                "force_jump [N]",
            ]
            table.writerow([*names, *places])
            for split in self._sim.state.split_log:
                row = astuple(split)
                table.writerow([*row[:3], *row[5:], *split.place, *split.reference])

    def _plateau(self, history: dict[str, Floats]) -> dict[str, float]:
        """Return mean, peak and slopes of the resistance; of a screw over 30 to 70 degrees."""
        r = self.resistance
        x = history[r.coordinate_name]
        first, unit = r.columns[0]
        turns = r.coordinate_unit == "deg"
        low, high = (30.0, 70.0) if turns else (0.4 * x[-1], x[-1])
        window = (x >= low) & (x <= high)
        if window.sum() < 3 or x[window][-1] <= x[window][0]:
            return {}
        way = x[window] / r.coordinate_scale
        slope = np.polyfit(way, history["cohesive_work"][window], 1)[0]
        name = unit.replace("*", "")
        figures = {
            f"{first}_plateau_{name}": _mean_over(way, history[first][window]),
            f"{first}_peak_{name}": float(history[first].max()),
            ("dWcoh_dtheta_Nmm" if turns else "dWcoh_ds_N"): float(slope),
            ("dW_dtheta_Nmm" if turns else "dW_ds_N"): float(
                np.polyfit(way, history["tool_work"][window], 1)[0]
            ),
        }
        if turns:
            figures["axial_force_plateau_N"] = _mean_over(way, history["axial_force"][window])
        return figures

    def _draw_curves(self) -> None:
        results = read(self.folder / f"{self.name}.vtkhdf")
        results.plot_torque()
        results.plot_energy()


def _total(sim: Simulation) -> Floats:
    """Return the wrench on every tooth, contact and joints together, shape (n_body, 6)."""
    return np.asarray(sim.contact_forces.wrench + sim.cable_forces.wrench)


def _mean_over(x: Floats, y: Floats) -> float:
    """Return the mean of y over x, by the trapezoidal rule."""
    return float(trapezoid(y, x) / (x[-1] - x[0]))


def _matplotlib_is_there() -> bool:
    return importlib.util.find_spec("matplotlib") is not None
