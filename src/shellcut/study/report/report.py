"""The report of a study, of a fit or of a search: its sections, those of words and tables here."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path

import numpy as np

from shellcut.card import image
from shellcut.files.distribution import pip_install
from shellcut.files.file_list import target
from shellcut.files.regular_file import read_regular
from shellcut.report.page import link_to, made, missing, sentences, versions, write_page
from shellcut.report.pictures import error_bars
from shellcut.results.error_bars import ERROR_BARS, read_error_bars
from shellcut.scene_page.page import part
from shellcut.study.plan import RUNS, STUDY
from shellcut.study.table import TABLE
from shellcut.unit import in_unit

from .pictures import curves, scatter
from .studied import Study, read_folder

_STATE = "Study"

_MOST_ROWS = 2000
"""Runs in the table of the page; table.csv has all."""

_SHOWN = 8
"""Digits of the name of a folder."""

_DESIGNS = {
    "grid": "every combination of the values",
    "sobol": "Sobol' points",
    "lhs": "a Latin hypercube",
}


def report_study(
    folder: str | os.PathLike[str], path: str | os.PathLike[str] | None = None
) -> Path:
    """Write one self-contained HTML file about a study: table, curves, values over factors.

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
    figures: dict[str, Callable[[], str]] = {"Values over factors": lambda: scatter(study)}
    if bars.exists():
        figures = {"Error bars": lambda: error_bars(read_error_bars(bars))}
    makers: dict[str, Callable[[], str]] = {
        _STATE: str,
        "Runs": lambda: _runs(study, out),
        "Curves": lambda: curves(study),
        **figures,
        "What was run": lambda: _what_was_run(study),
        "Versions": versions,
    }
    sections = made(makers, problems)
    lost = (("doubt", "missing", problem) for problem in problems)
    sections[_STATE] = sentences([*_said(study), *lost])  # last, with the problems of the others
    return sections


def _said(study: Study) -> Iterator[tuple[str, str, str]]:
    """Yield what is done, what failed, and what the report cannot show."""
    n, n_done = len(study.status), study.count("done")
    if failed := study.count("failed"):
        # The same reason names another folder in each run.
        reasons = dict.fromkeys(
            reason.replace(key, "...")
            for reason, key, how in zip(study.reasons, study.keys, study.status, strict=True)
            if how == "failed"
        )
        first = next(iter(reasons))
        more = f" ({len(reasons) - 1} other reasons in the table)" if len(reasons) > 1 else ""
        yield "doubt", "failed", f"{failed} of {n} runs failed: {first}{more}."
    if open_ := n - n_done - failed:
        yield (
            "note",
            "not done",
            f"{open_} of {n} runs are not done. To go on, call shellcut sweep again.",
        )
    if n_done:
        yield "good" if n_done == n else "note", "done", f"{n_done} of {n} runs are done."
    else:
        yield "doubt", "nothing", "No run is done, so there are no values: see the table for why."
    if n_doubt := int(study.doubted.sum()):
        first = study.reasons[int(np.argmax(study.doubted))]
        yield (
            "doubt",
            "distrust",
            f"{n_doubt} of {n_done} done runs are distrusted by their own verdict, and count in "
            "all pictures below: the table says why, hollow points are "
            f"theirs. The first: {first}.",
        )
    for name in study.lacking:
        yield "doubt", "missing", f"{STUDY} asks for the value {name}, which no run has."
    if n_done and not study.figures:
        yield "doubt", "missing", f"The runs have none of the usual values; name some in {STUDY}."
    if not study.factors:
        yield "note", "one model", "No key has several values, so there is nothing to compare."
    share = study.all_figures.get("share_done", np.ones(n))
    if early := int(np.sum(study.done & (share < 1.0 - 1e-6))):
        yield "note", "stopped", f"{early} runs ended before their time; their values are partial."


def _runs(study: Study, page: Path) -> str:
    """Return the table of all runs; its headings sort it."""
    heads = [("run", "run"), *((in_unit(f.name, f.unit), f.key) for f in study.inputs)]
    heads += [(in_unit(f.name, f.unit), f.key) for f in study.figures]
    heads += [("status", "done, failed, stopped or waits"), ("folder", "of the run")]
    head = "".join(
        f'<th scope="col" title="{escape(key)}">{escape(text)}</th>' for text, key in heads
    )
    body = "".join(_row(study, row, page) for row in range(min(len(study.status), _MOST_ROWS)))
    cut = ""
    if len(study.status) > _MOST_ROWS:
        cut = missing(f"The first {_MOST_ROWS:,} of {len(study.status):,} runs; {TABLE} has all.")
    link = escape(link_to(study.folder / TABLE, page))
    return (
        f'<div class="wide tall"><table class="sortable"><thead><tr>{head}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>{cut}"
        f'<p class="caption">A click on a heading sorts. All values of all runs are in '
        f'<a href="{link}">{TABLE}</a>.</p>'
    )


def _row(study: Study, row: int, page: Path) -> str:
    status = study.status[row]
    cells = [_cell(one.texts[row] if one.names else one.values[row]) for one in study.inputs]
    cells += [_cell(figure.values[row]) for figure in study.figures]
    kind = {"failed": "bad", "done": "doubted" if study.doubted[row] else ""}.get(status, "waits")
    reason = f"<small>{escape(study.reasons[row])}</small>" if study.reasons[row] else ""
    cells.append(f'<td class="status {kind}">{escape(status)}{reason}</td>')
    folder = study.run_folder(row)
    text = f"<code>{escape(study.keys[row][:_SHOWN])}</code>"
    if folder.is_dir():
        text = f'<a href="{escape(link_to(folder, page))}/">{text}</a>'
    number = escape(study.numbers[row])
    return (
        f'<tr><th scope="row" data-v="{number}">{number}</th>{"".join(cells)}<td>{text}</td></tr>'
    )


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return f'<td data-v="{escape(value)}">{escape(value)}</td>'
    if np.isnan(value):
        return '<td class="n" data-v="">–</td>'
    return f'<td class="n" data-v="{float(value)!r}">{f"{value:.5g}".replace("-", "−")}</td>'


def _what_was_run(study: Study) -> str:
    """Return the study file and the design in words."""
    design = study.file.design
    how = _DESIGNS[design.kind]
    if design.kind != "grid":
        how += f", {design.n} of them, seed {design.seed}"
    text = (study.folder / STUDY).read_text(encoding="utf-8", errors="replace")
    return (
        f"<p>The design is {escape(how)}. The study as a file, from which "
        f"<code>shellcut sweep</code> makes the same runs:</p><details open><summary>{STUDY}"
        f"</summary><pre>{escape(text)}</pre></details>"
    )


# --- a fit, a search ------------------------------------------------------------------------------


def report_found(file: Path, path: str | os.PathLike[str] | None = None) -> Path:
    """Write a page about a fit or a search, by its ``fit.json`` or ``optimum.json``; return it.

    By default it is ``report.html`` beside. ValueError if the file is none of these.
    """
    folder = file.parent
    out = target(path, folder / "report.html")
    content = read_regular(file).decode()
    try:
        said = json.loads(content)["said"]
    except (ValueError, KeyError, TypeError):
        raise ValueError(
            f"{file} is not as shellcut writes it: call fit or optimise again"
        ) from None
    picture, runs = file.with_suffix(".png"), escape(link_to(folder / RUNS, out))
    curves = missing(f"Not drawn: pictures need Matplotlib ({pip_install('plot')}).")
    if picture.is_file():
        curves = f"<figure>{image(picture.read_bytes(), 'Curves of the runs')}</figure>"
    sections = {
        "What was found": f"<pre>{escape(said)}</pre>",
        "Curves": curves,
        "Runs": f'<p>The folders of the runs are in <a href="{runs}/">{RUNS}</a>.</p>'
        f"<details><summary>{file.name}</summary><pre>{escape(content)}</pre></details>",
        "Versions": versions(),
    }
    name = folder.resolve().name
    lead = f"Report of {file.resolve()}."
    write_page(out, kind="search", name=name, lead=lead, sections=sections)
    return out
