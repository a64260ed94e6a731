"""Assemble the sections of the report of a study into a page."""

from __future__ import annotations

import os
from pathlib import Path

from shellcut.files.file_list import target
from shellcut.files.whole_file import write_text
from shellcut.report.error_bars import error_bars
from shellcut.report.markup import section
from shellcut.report.page import page_of, part
from shellcut.report.words import versions
from shellcut.results.error_bars import ERROR_BARS, read_error_bars

from . import words
from .curves import curves
from .scatter import scatter
from .studied import Study, read_folder


def report_study(
    folder: str | os.PathLike[str], path: str | os.PathLike[str] | None = None
) -> Path:
    """Write one self-contained HTML file about a study: table, curves, figures over factors.

    It can be written while the study runs; it then shows the runs that are done.

    Parameters
    ----------
    folder : str or Path
        The folder of the study.
    path : str or Path, optional
        The file to write, replaced if it exists; by default ``report.html`` in the folder.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    FileNotFoundError
        If the folder holds no study, or no run of it has ended.
    FileExistsError
        If the file is somebody else's, without a path, or belongs to a run.
    ValueError
        If its files are not those of a study.

    Examples
    --------
    >>> report_study("no/such/folder")
    Traceback (most recent call last):
        ...
    FileNotFoundError: no/such/folder must be the folder of a study, with study.toml
    """
    study = read_folder(Path(folder))
    out = target(path, study.folder / "report.html")
    n, n_done = len(study.status), study.count("done")
    html = page_of(
        title=f"{study.name} - report of a study",
        heading=study.name,
        lead=f"Report of the study in {study.folder.resolve()}: {n} runs of "
        f"{Path(study.file.model).name}, {n_done} done.",
        body=_body(study, out),
        style=part("study.css", __package__),
        script=part("study.js", __package__),
    )
    write_text(out, html, errors="backslashreplace")
    return out


def _body(study: Study, out: Path) -> str:
    bars = study.folder / ERROR_BARS
    converged = {"Error bars": error_bars(read_error_bars(bars))} if bars.exists() else None
    made = {
        "Study": words.state(study),
        "Runs": words.runs(study, out),
        "Curves": curves(study),
        **(converged or {"Figures over factors": scatter(study)}),
        "What was run": words.what_was_run(study),
        "Versions": versions(),
    }
    return "".join(section(title, body) for title, body in made.items())
