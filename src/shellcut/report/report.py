"""Put the sections into the page."""

from __future__ import annotations

import importlib.metadata
import importlib.resources
import os
import string
import time
from collections.abc import Callable
from html import escape
from pathlib import Path

from . import sections
from .gathered import Gathered, gather, run_or_say
from .sections import section


def report(folder: str | os.PathLike[str], path: str | os.PathLike[str] | None = None) -> Path:
    """Write one self-contained HTML file on a run: what ran, what may be trusted, what came out.

    Pictures are embedded, nothing is loaded from the network. A run that was interrupted or lacks
    files gets a report that says so. Curves need nothing; crack map and film strip need Matplotlib.

    Parameters
    ----------
    folder : str or Path
        The run's result folder.
    path : str or Path, optional
        The file to write, replaced if it exists; by default ``report.html`` in the folder.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileNotFoundError
        If the folder is not there or nothing in it is of a run.

    Examples
    --------
    >>> report("no/such/folder")
    Traceback (most recent call last):
        ...
    FileNotFoundError: no/such/folder must be the folder of a run, ...; there is no such folder
    """
    run = gather(Path(folder))
    out = run.folder / "report.html" if path is None else Path(path)
    style, script, page = (_part(name) for name in ("page.css", "page.js", "page.html"))
    html = string.Template(page).substitute(
        title=escape(f"{run.name} - report of a run"),
        heading=escape(run.name),
        lead=escape(_lead(run)),
        body=_body(run, out),
        footer=escape(
            f"Written by shellcut {importlib.metadata.version('shellcut')} on "
            f"{time.strftime('%Y-%m-%d %H:%M')}. Units: mm, N, s, tonne, MPa."
        ),
        style=style,
        script=script,
    )
    out.write_text(html, encoding="utf-8")
    return out


def _part(name: str) -> str:
    return (importlib.resources.files(__package__) / name).read_text(encoding="utf-8")


def _lead(run: Gathered) -> str:
    words = [f"Report of the run in {run.folder.resolve()}"]
    if run.history:
        name, unit = run.coordinate
        end = run.history[name][-1]
        gap = "" if unit == "deg" else " "
        words.append(f"up to {name} {end:.4g}{gap}{unit.replace('deg', '°')}")
    if run.results is not None:
        words.append(f"{run.results.n_frame} frames")
    return ", ".join(words) + "."


def _body(run: Gathered, out: Path) -> str:
    last = run_or_say(run, "last frame", lambda: run.last_frame)
    resistance = run.resistance[0].capitalize() if run.history else "Resistance"
    makers: dict[str, Callable[[], str]] = {
        "Key figures": lambda: sections.figures(run),
        resistance: lambda: sections.resistance_curve(run),
        "The cut": lambda: sections.film_strip(run),
        "Snapshots": lambda: sections.snapshots(run),
        "Crack map": lambda: sections.crack_map(run),
        "Quality of the cut": lambda: sections.quality(run),
        "Energy ledger": lambda: sections.energy_curve(run),
        "Splits": lambda: sections.splits(run),
        "Tool": lambda: sections.tool(run, last),
        "Time step": lambda: sections.step_curve(run),
        "What was run": lambda: sections.what_was_run(run),
        "Versions": sections.versions,
        "Files": lambda: sections.files(run, out),
    }
    made = {title: run_or_say(run, title.lower(), make) or "" for title, make in makers.items()}
    # Last, since it tells what went wrong in the others.
    verdict = sections.judgement(run, last)
    return "".join(section(title, body) for title, body in {"Verdict": verdict, **made}.items())
