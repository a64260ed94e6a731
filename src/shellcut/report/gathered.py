"""Data of a run, gathered piece by piece, so that one missing or broken file does not stop it."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from shellcut.files.regular_file import read_regular
from shellcut.files.run_folder import HISTORY, SPLITS, SUMMARY, USED
from shellcut.frame import Frame
from shellcut.results.comparison import Comparison
from shellcut.results.error_bars import CONVERGED, ERROR_BARS, ErrorBars, read_error_bars
from shellcut.results.history import read_splits
from shellcut.results.run_results import Results, history_in, result_in, summary_in
from shellcut.results.summary_figures import run_figures
from shellcut.results.vtkhdf_reader import VtkHdfReader
from shellcut.scene_page.page import spread

from .page import or_say

_SIGNS = (HISTORY, SUMMARY, USED)


@dataclass
class Gathered:
    """Everything readable in a run's folder."""

    results: Results
    """Without frames and history where those are missing or broken."""
    model: str = ""
    """Text of ``used.toml``, empty if there is none."""
    problems: list[str] = field(default_factory=list)
    """Missing data, in sentences for the reader."""
    measured: Comparison | None = None
    """The run compared with a measured curve."""

    @property
    def figures(self) -> dict[str, Any]:
        """The summary; for an unfinished run, its judged values up to the last record."""
        r = self.results
        if r.summary or "tool_work" not in r.history:
            return r.summary
        return run_figures(
            r.history,
            (r.coordinate_name, r.coordinate_unit),
            (r.resistance_name, r.resistance_unit),
        )

    @property
    def error_bars(self) -> ErrorBars | None:
        """Those of this model: of a study in its folder, or around it; None if there are none."""
        folder = self.results.folder
        inside, around = folder / CONVERGED, folder.resolve().parent.parent
        if (inside / ERROR_BARS).exists():
            return read_error_bars(inside / ERROR_BARS)
        if not (around / ERROR_BARS).exists():
            return None
        found = read_error_bars(around / ERROR_BARS)
        return found if found.key == folder.resolve().name else None

    def frames(self, n: int) -> list[Frame]:
        """Return up to ``n`` frames spread evenly over the run, including the last one."""
        n_frame = self.results.n_frame
        return [self.results.frame(k) for k in spread(n_frame, n)] if n_frame else []


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
    problems: list[str] = []
    frames = or_say(problems, "frames", lambda: VtkHdfReader(result_in(folder)))
    history = or_say(problems, "history", lambda: history_in(folder)) or ({}, {})
    if frames is not None and not frames.n_frame:
        problems.append("No frame was written: there are no pictures.")
    if not (folder / HISTORY).exists():
        problems.append("history.csv is missing: there are no curves.")
    elif history[0] and (len(history[0]) < 3 or len(next(iter(history[0].values()))) < 2):
        problems.append(
            "history.csv has fewer than two rows, or three columns: there are no curves."
        )
        history = {}, {}
    name = frames.path.stem if frames else folder.resolve().name
    summary = or_say(problems, "summary", lambda: summary_in(folder)) or {}
    splits = or_say(problems, "splits", lambda: read_splits(folder / SPLITS)) or ({}, {})
    run = Gathered(Results(folder, name, frames, history, summary, splits), problems=problems)
    if (folder / USED).exists():
        run.model = read_regular(folder / USED).decode(errors="replace")
    if not (folder / SUMMARY).exists():
        run.problems.append(
            "summary.json is missing: the run has not ended, or it was killed. The report shows "
            "the run up to its last record."
        )
    return run
