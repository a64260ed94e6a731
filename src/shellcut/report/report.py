"""Put the sections into the page."""

from __future__ import annotations

import importlib.metadata
import importlib.resources
import os
import string
import time
from html import escape
from pathlib import Path

from . import sections
from .gathered import Gathered, gather
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
    FileNotFoundError: no/such/folder must be the folder of a run (...); there is no such folder
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
    last = run.last_frame
    # Drawn first: what goes wrong in drawing is told in the verdict.
    strip, crack = sections.film_strip(run), sections.crack_map(run)
    parts = [
        ("Verdict", sections.judgement(run, last)),
        ("Key figures", sections.figures(run)),
        (
            run.resistance[0].capitalize() if run.history else "Torque",
            sections.resistance_curve(run),
        ),
        ("The cut", strip),
        ("Snapshots", sections.snapshots(run)),
        ("Crack map", crack),
        ("Energy ledger", sections.energy_curve(run)),
        ("Splits", sections.splits(run)),
        ("Tool", sections.tool(run, last)),
        ("Time step", sections.step_curve(run)),
        ("What was run", sections.what_was_run(run)),
        ("Versions", sections.versions()),
        ("Files", sections.files(run, out)),
    ]
    return "".join(section(title, body) for title, body in parts)
