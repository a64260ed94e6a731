"""Data of a run, gathered piece by piece, so that one missing or broken file does not stop it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, TypeVar

import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.files.regular_file import read_regular
from shellcut.files.run_folder import HISTORY, SUMMARY, USED
from shellcut.frame import Frame
from shellcut.results.comparison import Comparison
from shellcut.results.error_bars import CONVERGED, ERROR_BARS, ErrorBars, read_error_bars
from shellcut.results.history import read_history
from shellcut.results.run_figures import run_figures
from shellcut.results.run_results import Results, read
from shellcut.scene_page.page import spread

T = TypeVar("T")

_SIGNS = (HISTORY, SUMMARY, USED)


@dataclass
class Gathered:
    """Everything readable in a run's folder."""

    folder: Path
    name: str
    """Name of the run, otherwise of the folder."""
    results: Results | None = None
    """None if the result file is missing or broken."""
    history: dict[str, Floats] = field(default_factory=dict)
    units: dict[str, str] = field(default_factory=dict)
    """As in :class:`Results`, empty if there are no results."""
    model: str = ""
    """Text of ``used.toml``, empty if there is none."""
    problems: list[str] = field(default_factory=list)
    """Missing data, in sentences for the reader."""
    measured: Comparison | None = None
    """The run compared with a measured curve."""

    @property
    def summary(self) -> dict[str, Any]:
        """``summary.json``; empty if the run has not ended."""
        return self.results.summary if self.results else {}

    @property
    def splits(self) -> dict[str, npt.NDArray[Any]]:
        """The columns of ``splits.csv``."""
        return self.results.splits if self.results else {}

    @property
    def coordinate(self) -> tuple[str, str]:
        """Name and unit of the curves' abscissa, the history's second column."""
        name = list(self.history)[1]
        return name, self.units[name]

    @property
    def resistance(self) -> tuple[str, str]:
        """Name and unit of the resistance, the history's third column."""
        name = list(self.history)[2]
        return name, self.units[name]

    @property
    def figures(self) -> dict[str, Any]:
        """The summary; for an unfinished run, its judged figures up to the last record."""
        h = self.history
        if self.summary or "tool_work" not in h:
            return self.summary
        return run_figures(h, self.coordinate, self.resistance)

    @property
    def error_bars(self) -> ErrorBars | None:
        """Those of this model: of a study in its folder, or around it; None if there are none."""
        inside, around = self.folder / CONVERGED, self.folder.resolve().parent.parent
        if (inside / ERROR_BARS).exists():
            return read_error_bars(inside / ERROR_BARS)
        if not (around / ERROR_BARS).exists():
            return None
        found = read_error_bars(around / ERROR_BARS)
        return found if found.key == self.folder.resolve().name else None

    def frames(self, n: int) -> list[Frame]:
        """Return up to ``n`` frames spread evenly over the run, including the last one."""
        if self.results is None or not self.results.n_frame:
            return []
        return [self.results.frame(k) for k in spread(self.results.n_frame, n)]


def gather(folder: Path) -> Gathered:
    """Read everything in the folder."""
    there = folder.is_dir() and (
        any((folder / sign).exists() for sign in _SIGNS) or any(folder.glob("*.vtkhdf"))
    )
    if not there:
        raise FileNotFoundError(
            f"{folder} must be the folder of a run, with history.csv, NAME.vtkhdf or summary.json; "
            + ("none of them is there" if folder.is_dir() else "there is no such folder")
        )
    run = Gathered(folder, folder.resolve().name)
    run.results = run_or_say(run, "frames", lambda: read(folder))
    if run.results is not None:
        run.name = run.results.name
        if not run.results.n_frame:
            run.problems.append("No frame was written: there are no pictures.")
    if run.results is not None and run.results.history:
        run.history, run.units = run.results.history, run.results.units
    elif (folder / HISTORY).exists():
        table = run_or_say(run, "history", lambda: read_history(folder / HISTORY))
        run.history, run.units = table or ({}, {})
    else:
        run.problems.append("history.csv is missing: there are no curves.")
    if run.history and (len(run.history) < 3 or len(next(iter(run.history.values()))) < 2):
        run.problems.append(
            "history.csv has fewer than two rows, or three columns: there are no curves."
        )
        run.history, run.units = {}, {}
    if (folder / USED).exists():
        run.model = read_regular(folder / USED).decode(errors="replace")
    if not (folder / SUMMARY).exists():
        run.problems.append(
            "summary.json is missing: the run has not ended, or it was killed. The report shows "
            "the run up to its last record."
        )
    return run


def run_or_say(run: Gathered, what: str, attempt: Callable[[], T]) -> T | None:
    """Return the attempt's result; if it fails, add the reason to the problems."""
    try:
        return attempt()
    except KeyError as error:
        run.problems.append(f"The {what} cannot be shown: the files contain no {error}.")
        return None
    except (OSError, ValueError, IndexError) as error:
        run.problems.append(f"The {what} cannot be shown: {error}.")
        return None
