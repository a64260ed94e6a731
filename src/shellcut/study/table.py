"""The table of a study: inputs and values of every run, in the order of the design."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence
from pathlib import Path

from shellcut.files.whole_file import write_text
from shellcut.results.summary_figures import LABELS

from .common_window import NOT_COMMON
from .one_run import Outcome
from .plan import Plan, PlannedRun

TABLE = "table.csv"

_OF_THE_MACHINE = ("wall_s", "ns_per_quad_step")
"""Figures that differ from run to run of the same inputs."""


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
    if own_mean := outcome.figures.get(NOT_COMMON):
        reasons.append(own_mean)
    return [run.number, *inputs, outcome.status, *given, run.key, "; ".join(reasons)]
