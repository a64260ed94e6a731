"""The report of a run: which sections it has, and what its lead says."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from shellcut.files.file_list import target
from shellcut.results.comparison import Comparison, compare
from shellcut.results.measured_curve import MeasuredCurve
from shellcut.unit import LIBRARY_UNITS, shown, with_unit

from . import pictures, words
from .error_bars import error_bars
from .gathered import Gathered, gather
from .page import made, or_say, write_page

_CONCLUSION, _TRUST = "Conclusion", "What may be trusted"


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
        name, unit = run.coordinate
        end = run.figures.get(f"{name}_end_{unit}", results.history[name][-1])
        parts.append(f"up to {name} {with_unit(end, unit)}")
    parts.append(f"{results.n_frame} frames")
    kept = "What the run has said keeps mm, N and s; its pictures keep the units they bear."
    converted = any(shown(unit)[1] != 1.0 for unit in LIBRARY_UNITS.values())
    return ", ".join(parts) + "." + (f" {kept}" if converted else "")


def _sections(run: Gathered) -> dict[str, str]:
    last = or_say(run.problems, "last frame", lambda: next(iter(run.frames(1)), None))
    resistance = run.resistance[0].capitalize() if run.results.history else "Resistance"
    makers: dict[str, Callable[[], str]] = {
        _CONCLUSION: str,
        resistance: lambda: pictures.resistance(run),
        "Measured curve": lambda: pictures.measured(run),
        "Where the work went": lambda: pictures.energy(run),
        _TRUST: str,
        "Error bars": lambda: error_bars(run.error_bars),
        "The cut": lambda: pictures.snapshots(run),
        "In three dimensions": lambda: pictures.scene(run),
        "Crack map": lambda: pictures.crack_map(run),
        "Quality of the cut": lambda: words.quality(run),
        "Figures": lambda: words.figures(run),
        "What was run": lambda: words.what_was_run(run),
        "Versions": words.versions,
    }
    sections = made(makers, run.problems)
    # Last, because they report the problems of the other sections.
    sections[_CONCLUSION], sections[_TRUST] = words.judged(run, last)
    return sections
