"""The table of a study: inputs and values of every run, means over their common steady window."""

from __future__ import annotations

import csv
import io
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from shellcut.files.whole_file import write_text
from shellcut.results.run_results import history_in
from shellcut.results.steady_window import (
    Range,
    SteadyWindow,
    no_mean_of,
    steady_figures,
    without_means,
)
from shellcut.results.summary_figures import LABELS

from .one_run import Outcome
from .plan import Plan, PlannedRun

NOT_COMMON = "no_common_window"
"""Figure that says why a mean is over the run's own window."""

TABLE = "table.csv"

_OF_THE_MACHINE = ("wall_s", "ns_per_quad_step")
"""Figures that differ from run to run of the same inputs."""


class CommonWindow:
    """Bring the means of runs to their common window; what was read of a run is kept.

    ``folder_of`` takes the number of a run.
    """

    def __init__(self, folder_of: Callable[[int], Path]) -> None:
        self._folder_of = folder_of
        self._figures = cache(self._read)

    def __call__(self, outcomes: Mapping[int, Outcome]) -> dict[int, Outcome]:
        """Return the outcomes of some runs with their means over the window that all have.

        A run without a window of its own has no part in it. Where they have none in common, or some
        are not steady in it, each keeps the means over its own, and :data:`NOT_COMMON` says why.
        """
        common = dict(outcomes)
        for unit in ("deg", "mm"):
            first, last = f"window_from_{unit}", f"window_to_{unit}"
            own = {
                number: (one.figures[first], one.figures[last])
                for number, one in outcomes.items()
                if {first, last} <= one.figures.keys()
            }
            if len(set(own.values())) < 2:
                continue
            between = max(low for low, _ in own.values()), min(high for _, high in own.values())
            found, why = self._means(list(own), between, unit)
            said = {NOT_COMMON: f"each run has its mean over its own window: {why}"}
            for number in own:
                before = outcomes[number].figures
                figures = without_means(before) | found[number] if found else {**before, **said}
                common[number] = replace(outcomes[number], figures=figures)
        return common

    def _means(
        self, runs: list[int], between: Range, unit: str
    ) -> tuple[dict[int, dict[str, Any]], str]:
        """Return the values of all runs in their common window, or none of them and why."""
        if between[0] >= between[1]:
            return {}, "the runs have none in common"
        found = {}
        for number in runs:
            found[number] = self._figures(number, between)
            if why := found[number].get("no_window"):
                common = SteadyWindow(*between).text(unit)
                return {}, f"in that of all runs, {common}, run {number} has none, {why}"
        return found, ""

    def _read(self, number: int, between: Range) -> dict[str, Any]:
        history, units = history_in(self._folder_of(number))
        if not history:
            return {"no_window": "its history is missing"}
        _, x, resistance, *_ = history
        return steady_figures(history, (x, units[x]), (resistance, units[resistance]), between)


def columns_of(plan: Plan, outcomes: Mapping[int, Outcome]) -> tuple[list[str], list[str]]:
    """Return the keys of the factors, and the names of the values that some run has."""
    each = (figure for one in outcomes.values() for figure in one.figures.items())
    there = {name for name, v in each if isinstance(v, int | float) and not isinstance(v, bool)}
    there -= set(_OF_THE_MACHINE)
    known = [name for name in LABELS if name in there]
    return [key for f in plan.factors for key in f.keys], [*known, *sorted(there - set(known))]


def write_table(folder: Path, plan: Plan, outcomes: Mapping[int, Outcome]) -> Path:
    """Write the table as CSV: a row a run, a blank where a run has no such value.

    Means are over the steady window that all runs have in common, each with its half-width.
    ``reason`` says why a run failed, what its verdict distrusts, or why its mean is missing or over
    another window.
    Numbers are written with all their digits, so that the same runs give the same bytes.
    """
    keys, figures = columns_of(plan, outcomes)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(["run", *keys, "status", *figures, "folder", "reason"])
    for run in plan.runs:
        writer.writerow(_row(run, keys, figures, outcomes.get(run.number)))
    path = folder / TABLE
    # Excel takes UTF-8 for what it is only with this mark.
    write_text(path, text.getvalue(), "utf-8-sig")
    return path


def _row(
    run: PlannedRun, keys: Sequence[str], figures: Sequence[str], outcome: Outcome | None
) -> list[object]:
    inputs = [run.values[key] for key in keys]
    if outcome is None:
        return [run.number, *inputs, "waits", *[""] * len(figures), run.key, ""]
    given = [outcome.figures.get(name, "") for name in figures]
    reasons = [f"distrust: {doubt}" for doubt in outcome.doubts]
    if outcome.reason:
        reasons.insert(0, outcome.reason)
    if lacks_mean := outcome.figures.get("no_window"):
        reasons.append(f"no steady window: {lacks_mean}")
    lacks = (no_mean_of(name) for name in figures)
    reasons += [f"no mean: {outcome.figures[one]}" for one in lacks if one in outcome.figures]
    if own_mean := outcome.figures.get(NOT_COMMON):
        reasons.append(own_mean)
    return [run.number, *inputs, outcome.status, *given, run.key, "; ".join(reasons)]
