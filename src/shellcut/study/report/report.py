"""The report of a study: which sections it has, and what its lead says."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from shellcut.files.file_list import target
from shellcut.report.error_bars import error_bars
from shellcut.report.page import made, write_page
from shellcut.report.words import versions
from shellcut.results.error_bars import ERROR_BARS, read_error_bars
from shellcut.scene_page.page import part

from . import words
from .curves import curves
from .scatter import scatter
from .studied import Study, read_folder

_STATE = "Study"


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
    write_page(
        out,
        kind="study",
        name=study.name,
        lead=f"Report of the study in {study.folder.resolve()}: {n} runs of "
        f"{Path(study.file.model).name}, {n_done} done.",
        sections=_sections(study, out),
        style=part(__package__, "study.css"),
        script=part(__package__, "study.js"),
    )
    return out


def _sections(study: Study, out: Path) -> dict[str, str]:
    problems: list[str] = []
    bars = study.folder / ERROR_BARS
    figures: dict[str, Callable[[], str]] = {"Figures over factors": lambda: scatter(study)}
    if bars.exists():
        figures = {"Error bars": lambda: error_bars(read_error_bars(bars))}
    makers: dict[str, Callable[[], str]] = {
        _STATE: str,
        "Runs": lambda: words.runs(study, out),
        "Curves": lambda: curves(study),
        **figures,
        "What was run": lambda: words.what_was_run(study),
        "Versions": versions,
    }
    sections = made(makers, problems)
    sections[_STATE] = words.state(study, problems)  # last, with the problems of the others
    return sections
