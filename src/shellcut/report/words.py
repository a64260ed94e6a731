"""Sections of text and numbers: verdict, figures, quality, versions."""

from __future__ import annotations

import importlib.metadata
import platform
from html import escape

import numpy as np

from shellcut.frame import Frame
from shellcut.results.cut_quality import LABELS, cut_quality
from shellcut.results.cut_quality import UNITS as CUT_UNITS
from shellcut.results.summary_figures import conclusion, key_figures
from shellcut.results.verdict import Line, verdict
from shellcut.unit import in_unit, shown
from shellcut.view import edge_length

from .gathered import Gathered
from .markup import missing, sentences, table

_NOTHING = 5e-4  # of lengths and areas over those of the whole, of angles [deg], of numbers
_N_QUALITY = 5  # frames for which the quality of the cut is listed


def what_was_run(run: Gathered) -> str:
    """Return the model file, or a sentence that there is none."""
    if not run.model:
        return missing("No used.toml: the model was built in Python, or the file was removed.")
    return (
        "<p>The model with all defaults filled in, as it ran (<code>used.toml</code>):</p>"
        f"<details><summary>used.toml, {len(run.model.splitlines())} lines</summary>"
        f"<pre>{escape(run.model)}</pre></details>"
    )


def judged(run: Gathered, last: Frame | None) -> tuple[str, str]:
    """Return the conclusion; the verdict with the list of missing data, doubts first."""
    if "verdict" in run.results.summary:  # the run's own verdict
        lines = [Line(**line) for line in run.results.summary["verdict"]]
    else:
        figures = run.figures
        if last is not None:
            figures = {"edge_length_mm": edge_length(last), **figures}
        lines = verdict(figures)
    told = [("doubt", "missing", problem) for problem in run.problems]
    told += [(line.kind, line.word, line.text) for line in lines]
    said = conclusion(run.figures, sum(kind == "doubt" for kind, *_ in told))
    return f"<p>{escape(said)}</p>" if said else "", sentences(told)


def figures(run: Gathered) -> str:
    """Return the summary as a table."""
    rows = key_figures(run.figures)
    half = -(-len(rows) // 2)
    tables = "".join(table(part) for part in (rows[:half], rows[half:]) if part)
    return f'<div class="beside">{tables}</div>' if tables else ""


def quality(run: Gathered) -> str:
    """Return the quality of the cut at a few frames."""
    frames = run.frames(_N_QUALITY)
    if not frames:
        return missing("No figures of the cut: there are no frames.")
    rows = [cut_quality(frame).figures() for frame in frames]
    coordinate, (unit, along) = frames[0].coordinate_name, shown(frames[0].coordinate_unit)
    # Give units once per row, so that the numbers fit beside each other on a phone.
    head = [in_unit(f"at {coordinate}", unit), *(f"{along * f.coordinate:.3g}" for f in frames)]
    # a 25th of the film: 5e-4 of that is nothing to be seen
    part = 0.04 * float(np.linalg.norm(np.ptp(frames[0].reference, axis=0)))
    least = {"mm": _NOTHING * part, "mm^2": _NOTHING * part * part}
    lines = []
    for name, label in LABELS.items():
        unit, factor = shown(CUT_UNITS[name])
        floor = least.get(CUT_UNITS[name], _NOTHING)
        values = (factor * row[name] if abs(row[name]) >= floor else 0.0 for row in rows)
        lines.append([in_unit(label, unit), *(f"{value:.3g}" for value in values)])
    return table(lines, head) + (
        '<p class="caption">Evaluated on the frames; cables are not film. A bridge is film between '
        "two crack ends that face each other; the cut-out is the piece to be cut free.</p>"
    )


def versions() -> str:
    """Return the versions of the packages that wrote the report."""
    rows = [("Python", platform.python_version()), ("machine", platform.platform(terse=True))]
    for package in ("shellcut", "numpy", "scipy", "numba", "h5py", "matplotlib"):
        try:
            rows.append((package, importlib.metadata.version(package)))
        except importlib.metadata.PackageNotFoundError:
            rows.append((package, "not installed"))
    return table(rows) + '<p class="caption">In the installation that wrote this report.</p>'
