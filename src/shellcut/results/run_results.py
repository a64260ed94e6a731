"""Results of a run read from its folder; also of a killed or running one.

>>> from shellcut.results.run_results import read
>>> read("no/such/folder")
Traceback (most recent call last):
    ...
FileNotFoundError: no/such/folder must be the folder of a run or its .vtkhdf file, there is neither
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Iterator
from contextlib import suppress
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.card import Figures, card, image
from shellcut.files.file_list import FileList
from shellcut.files.regular_file import read_regular
from shellcut.files.run_folder import ENERGY_PICTURE, HISTORY, SPLITS, SUMMARY, resistance_picture
from shellcut.formats.errors import counted
from shellcut.frame import Frame
from shellcut.tool.pose import Pose
from shellcut.view import Look, draw_curves, png_of

from .cut_quality import UNITS, cut_quality
from .history import read_history, read_splits
from .run_curves import energy_diagram, imbalance_diagram, resistance_diagram
from .steady_window import SteadyWindow, steady_figures, steady_window
from .summary_figures import LABELS, key_figures
from .verdict import Line
from .vtkhdf_reader import VtkHdfReader

_IN_CARD = "_plateau_|_peak_[A-Z]|^crack_length|_end_|^tool_work|^n_loose"
"""Figures that a notebook shows."""


class FrameFigures(dict[str, Floats]):
    """Values over the frames by name, arrays of shape (n_frame,); ``units`` by the same names."""

    def __init__(self, columns: dict[str, Floats], units: dict[str, str]) -> None:
        super().__init__(columns)
        self.units = units


class Results:
    """A run's history, frames and values; built by :func:`read`.

    It is a snapshot of the folder: for a run in progress, read again to see more.
    """

    def __init__(
        self,
        folder: Path,
        name: str,
        frames: VtkHdfReader | None,
        history: tuple[dict[str, Floats], dict[str, str]],
        summary: dict[str, Any],
        splits: tuple[dict[str, npt.NDArray[Any]], dict[str, str]],
    ) -> None:
        self.folder = folder
        self.name = name
        """Name of the run, the stem of its ``.vtkhdf`` file."""
        self._frames = frames
        self.n_frame = frames.n_frame if frames else 0
        """Number of complete frames."""
        self.times = frames.times if frames else np.zeros(0)
        self.coordinates = frames.coordinates if frames else np.zeros(0)
        """Time [s] and coordinate, in ``coordinate_unit``, of every frame, shape (n_frame,)."""
        self.history, self.units = history
        """The columns of ``history.csv`` by name, shape (n_row,), and their units; empty if the
        file is missing."""
        self.summary = summary
        """``summary.json``; empty if the run has not ended."""
        self.splits, self.split_units = splits
        """The columns of ``splits.csv`` by name, shape (n_split,), and their units; empty if the
        run has not ended."""

    def __repr__(self) -> str:
        n_row = len(next(iter(self.history.values()), ()))
        lines = [f"Results of {self.name!r} in {self.folder}", f"  history: {n_row} rows"]
        if self.history:
            lines[-1] += f" of {', '.join(self.history)}"
        frames = f"  frames: {self.n_frame}"
        if self.n_frame:
            name, unit, way = self.coordinate_name, self.coordinate_unit, self.coordinates
            frames += f", {name} {way[0]:.4g} to {way[-1]:.4g} {unit}"
            frames += f", time {self.times[0]:.4g} to {self.times[-1]:.4g} s"
        ended = f"{len(self.summary)} figures" if self.summary else "none, the run has not ended"
        return "\n".join([*lines, frames, f"  summary: {ended}"])

    def _repr_html_(self) -> str:
        names = [name for name in LABELS if re.search(_IN_CARD, name) and name in self.summary]
        figures: Figures = [("frames", self.n_frame, "")]
        figures += [(label, shown, "") for label, shown in key_figures(self.summary, names)]
        lines = [Line(**line) for line in self.summary.get("verdict", ())]
        n_good = sum(line.kind == "good" for line in lines)
        said = [(line.kind, str(line)) for line in lines if line.kind == "doubt"]
        said.append(("good", counted(n_good, "check holds", "checks hold")))
        # Of a note what it is about; report and summary have all of it.
        heads = (re.split(r"[:,] |\. ", line.text)[0] for line in lines if line.kind == "note")
        said += [("note", f"note: {head.removesuffix('.')}") for head in heads]
        if not lines:
            said = [("note", "There is no verdict: the run has not ended.")]
        picture = ""
        if self.n_frame:
            with suppress(ImportError):  # without Pillow
                picture = image(png_of(self.frame(-1), Look(), (220, 340)), "the last frame")
        return card(f"Results of {self.name}", figures, said, picture)

    # ------------------------------------------------------------------ history

    @property
    def coordinate_name(self) -> str:
        """Abscissa of all curves, ``"angle"`` or ``"path"``."""
        return (self._frames and self._frames.coordinate_name) or self._column(1)

    @property
    def coordinate_unit(self) -> str:
        """Unit of the coordinate."""
        return (self._frames and self._frames.coordinate_unit) or self.units[self._column(1)]

    @property
    def resistance_name(self) -> str:
        """Resistance against the tool: ``"torque"`` or ``"force"``."""
        return self._column(2)

    @property
    def resistance_unit(self) -> str:
        """Unit of the resistance."""
        return self.units[self.resistance_name]

    @property
    def steady_window(self) -> SteadyWindow:
        """Steady window of the cut, from the history; also for a run that has not ended."""
        return steady_window(self.history, (self.coordinate_name, self.coordinate_unit))

    # ------------------------------------------------------------------ frames

    def frame(self, k: int) -> Frame:
        """Return frame ``k``, negative from the end, as in :meth:`VtkHdfReader.frame`.

        Raises
        ------
        IndexError
            If there is no such frame.
        """
        return self._reader.frame(k)

    def frames(self) -> Iterator[Frame]:
        """Iterate over the frames in order of time."""
        return (self.frame(k) for k in range(self.n_frame))

    def tool_pose(self, k: int) -> Pose | None:
        """Return rotation R (3, 3) and translation r (3,) [mm] of the tool, x = R X + r, exact.

        None if the run has no tool.
        """
        return self._reader.pose(k)

    def cut_quality(self) -> FrameFigures:
        """Return the quality of the cut over the frames.

        ``time``, the coordinate, and all of :data:`shellcut.results.cut_quality.UNITS`, defined in
        docs/howto/read-results.md. For all details of one frame, use
        ``cut_quality(results.frame(k))``.
        """
        rows = [cut_quality(frame).figures() for frame in self.frames()]
        columns = {name: np.array([row[name] for row in rows], dtype=float) for name in UNITS}
        way = {"time": self.times, self.coordinate_name: self.coordinates}
        units = {"time": "s", self.coordinate_name: self.coordinate_unit}
        return FrameFigures(way | columns, units | UNITS)

    # ------------------------------------------------------------------ pictures

    def plot_torque(self, path: str | os.PathLike[str] | None = None) -> Path:
        """Draw the torque (or force), in total, in parts and per tooth; return the path.

        Parameters
        ----------
        path : str or Path, optional
            By default ``torque.png`` or ``force.png`` in the folder of the run.

        Raises
        ------
        ImportError
            If Matplotlib is not installed.
        """
        coordinate = self.coordinate_name, self.coordinate_unit
        resistance = self.resistance_name, self.resistance_unit
        path = resistance_picture(self.folder, resistance[0]) if path is None else Path(path)
        figures = steady_figures(self.history, coordinate, resistance)
        diagram = resistance_diagram(self.history, self.units, figures)
        draw_curves(path, [replace(diagram, title=self.name)])
        return path

    def plot_energy(self, path: str | os.PathLike[str] | None = None) -> Path:
        """Draw the energy balance; return the picture's path, by default ``energy.png``.

        The imbalance is in per cent of the energy put in, from a tenth of its largest value.

        Raises
        ------
        ImportError
            If Matplotlib is not installed.
        """
        path = self.folder / ENERGY_PICTURE if path is None else Path(path)
        energies = replace(energy_diagram(self.history, self.units), title=self.name)
        imbalance = imbalance_diagram(self.history, self.units)
        draw_curves(path, [energies, imbalance], size=(9.0, 6.6))
        return path

    # ------------------------------------------------------------------ parts

    @property
    def _reader(self) -> VtkHdfReader:
        if self._frames is None:
            raise IndexError(f"there are no frames, as {self.folder} has no result file to read")
        return self._frames

    def _column(self, k: int) -> str:
        # Time, coordinate and the plotted figure are the first three columns of every history.
        if not self.history:
            raise ValueError(f"{self.folder} must contain the run's history.csv for this")
        return list(self.history)[k]


def read(path: str | os.PathLike[str]) -> Results:
    """Read the results of a finished, killed or running run.

    Parameters
    ----------
    path : str or Path
        The run's folder, or the ``.vtkhdf`` file in it.

    Raises
    ------
    FileNotFoundError
        If there is no such folder, or no result file in it.
    ValueError
        If it contains more than one and does not list which one belongs to the run, or the file
        is not one of shellcut.

    Examples
    --------
    >>> import shellcut
    >>> results = shellcut.read("out")  # doctest: +SKIP
    >>> results.history["torque"].max(), results.units["torque"]  # doctest: +SKIP
    (164.1, 'N*mm')
    >>> results.frame(-1).points.shape  # doctest: +SKIP
    (3219, 3)
    """
    file = result_in(Path(path)).absolute()
    folder = file.parent
    history, summary, splits = history_in(folder), summary_in(folder), read_splits(folder / SPLITS)
    return Results(folder, file.stem, VtkHdfReader(file), history, summary, splits)


def history_in(folder: Path) -> tuple[dict[str, Floats], dict[str, str]]:
    """Return the columns of a run's history and their units; empty if there is none."""
    return read_history(folder / HISTORY) if (folder / HISTORY).exists() else ({}, {})


def summary_in(folder: Path) -> dict[str, Any]:
    """Return the summary of a run; empty if it has not ended.

    ValueError if the file is damaged: it is moved into place when it is complete.
    """
    path = folder / SUMMARY
    try:
        found = json.loads(read_regular(path).decode(errors="backslashreplace"))
    except FileNotFoundError:
        return {}
    except json.JSONDecodeError as problem:
        where = f"line {problem.lineno}, column {problem.colno}"
        raise ValueError(f"{path}, {where}: must be JSON, but {problem.msg}") from None
    if not isinstance(found, dict):
        raise ValueError(f"{path} must have values by name, got {type(found).__name__}")
    return found


def result_in(path: Path) -> Path:
    """Return the result file of a run, given its folder or the file."""
    if not path.exists():
        raise FileNotFoundError(
            f"{path} must be the folder of a run or its .vtkhdf file, there is neither"
        )
    if path.is_dir():
        found = sorted(path.glob("*.vtkhdf"))
        if not found:
            raise FileNotFoundError(
                f"{path} must hold the result of a run, NAME.vtkhdf; none there"
            )
        if len(found) > 1:  # there may be others beside that of the run
            listed = FileList(path).names
            found = [file for file in found if file.name in listed] or found
        if len(found) > 1:
            names = ", ".join(file.name for file in found)
            raise ValueError(f"{path} must hold one .vtkhdf file, got {names}; give one of them")
        path = found[0]
    return path
