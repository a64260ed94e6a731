"""The report of a run: its sections, and those of words and tables themselves."""

from __future__ import annotations

import os
from collections.abc import Callable
from html import escape
from pathlib import Path

import numpy as np

from shellcut.files.file_list import target
from shellcut.frame import Frame
from shellcut.results.answers import answers, conclusion
from shellcut.results.comparison import Comparison, compare
from shellcut.results.cut_quality import LABELS, cut_quality
from shellcut.results.cut_quality import UNITS as CUT_UNITS
from shellcut.results.measured_curve import MeasuredCurve
from shellcut.results.summary_figures import key_figures
from shellcut.results.verdict import Line, verdict
from shellcut.unit import LIBRARY_UNITS, in_unit, shown, with_unit
from shellcut.view import edge_length

from . import pictures
from .gathered import Gathered, gather
from .page import made, missing, or_say, sentences, table, versions, write_page

_CONCLUSION, _TRUST = "Conclusion", "What may be trusted"
_NOTHING = 5e-4  # of lengths and areas over those of the whole, of angles [deg], of numbers
_N_QUALITY = 5  # frames for which the quality of the cut is listed


def report_run(
    folder: str | os.PathLike[str],
    path: str | os.PathLike[str] | None = None,
    *,
    measured: str | os.PathLike[str] | MeasuredCurve | Comparison | None = None,
) -> Path:
    """Write one self-contained HTML file about a run: model, verdict, results.

    Pictures are embedded; nothing is loaded from the network. The report of an interrupted or
    incomplete run says so. Curves and the scene in three dimensions need no extra; the crack map
    needs Matplotlib.

    Parameters
    ----------
    folder : str or Path
        The run's result folder.
    path : str or Path, optional
        The file to write, replaced if it exists; by default ``report.html`` in the folder.
    measured : path, MeasuredCurve or Comparison, optional
        A measured curve to show and compare with the simulated one, or the result of
        :func:`compare`, if columns and units have to be given.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileNotFoundError
        If the folder does not exist or nothing in it belongs to a run.
    FileExistsError
        If the file is an input, or one of the run, or, without a path, somebody else's.
    ValueError
        If the measured curve cannot be compared with the run.

    Examples
    --------
    >>> report_run("no/such/folder")
    Traceback (most recent call last):
        ...
    FileNotFoundError: no/such/folder must be the folder of a run, ...; there is no such folder
    """
    run = gather(Path(folder))
    inputs = [measured] if isinstance(measured, str | os.PathLike) else []
    out = target(path, run.results.folder / "report.html", inputs)
    if measured is not None:
        run.measured = measured if isinstance(measured, Comparison) else compare(folder, measured)
    name, lead = run.results.name, _lead(run)
    write_page(out, kind="run", name=name, lead=lead, sections=_sections(run))
    return out


def _lead(run: Gathered) -> str:
    results, parts = run.results, [f"Report of the run in {run.results.folder.resolve()}"]
    if results.history:
        name, unit = results.coordinate_name, results.coordinate_unit
        end = run.figures.get(f"{name}_end_{unit}", results.history[name][-1])
        parts.append(f"up to {name} {with_unit(end, unit)}")
    parts.append(f"{results.n_frame} frames")
    kept = "Lines of the run keep mm, N and s; its pictures keep the units written in them."
    converted = any(shown(unit)[1] != 1.0 for unit in LIBRARY_UNITS.values())
    return ", ".join(parts) + "." + (f" {kept}" if converted else "")


def _sections(run: Gathered) -> dict[str, str]:
    last = or_say(run.problems, "last frame", lambda: next(iter(run.frames(1)), None))
    resistance = run.results.resistance_name.capitalize() if run.results.history else "Resistance"
    makers: dict[str, Callable[[], str]] = {
        _CONCLUSION: str,
        "Answers": lambda: table(rows) if (rows := answers(run.figures)) else "",
        resistance: lambda: pictures.resistance(run),
        "Measured curve": lambda: pictures.measured(run),
        "Where the work went": lambda: pictures.energy(run),
        _TRUST: str,
        "Error bars": lambda: pictures.error_bars(run.error_bars),
        "The cut": lambda: pictures.snapshots(run),
        "In three dimensions": lambda: pictures.scene(run),
        "Crack map": lambda: pictures.crack_map(run),
        "Quality of the cut": lambda: _quality(run),
        "Values": lambda: _figures(run),
        "What was run": lambda: _what_was_run(run),
        "Versions": versions,
    }
    sections = made(makers, run.problems)
    # Last, because they report the problems of the other sections.
    sections[_CONCLUSION], sections[_TRUST] = _judged(run, last)
    return sections


def _what_was_run(run: Gathered) -> str:
    """Return the model file, or a sentence that there is none."""
    if not run.model:
        return missing("No used.toml: the model was built in Python, or the file was removed.")
    return (
        "<p>The model with all defaults filled in, as it ran (<code>used.toml</code>):</p>"
        f"<details><summary>used.toml, {len(run.model.splitlines())} lines</summary>"
        f"<pre>{escape(run.model)}</pre></details>"
    )


def _judged(run: Gathered, last: Frame | None) -> tuple[str, str]:
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


def _figures(run: Gathered) -> str:
    """Return the summary as a table."""
    rows = key_figures(run.figures)
    half = -(-len(rows) // 2)
    tables = "".join(table(part) for part in (rows[:half], rows[half:]) if part)
    return f'<div class="beside">{tables}</div>' if tables else ""


def _quality(run: Gathered) -> str:
    """Return the quality of the cut at a few frames."""
    frames = run.frames(_N_QUALITY)
    if not frames:
        return missing("The quality of the cut is unknown: there are no frames.")
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
