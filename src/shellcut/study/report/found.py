"""The report of a fit, or of a search for the best values: what was found, values, runs, curves."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator
from html import escape
from pathlib import Path
from typing import Any

from shellcut.card import image
from shellcut.files.file_list import target
from shellcut.files.regular_file import read_regular
from shellcut.report.chart import chart
from shellcut.report.markup import link_to, missing, sentences, table
from shellcut.report.page import made, versions, write_page
from shellcut.results.summary_figures import label_of
from shellcut.study.fit_result import FIT, PICTURE
from shellcut.study.optimise import OPTIMUM, Optimum, read_optimum
from shellcut.study.plan import RUNS
from shellcut.unit import in_unit

_FOUND = "What was found"


def report_found(
    folder: str | os.PathLike[str], path: str | os.PathLike[str] | None = None
) -> Path:
    """Write one self-contained HTML file about a fit, or a search for the best values.

    Parameters
    ----------
    folder : str or Path
        Of the fit, with ``fit.json``, or of the search, with ``optimum.json``.
    path : str or Path, optional
        The file to write, replaced if it exists; by default ``report.html`` in the folder.

    Raises
    ------
    FileNotFoundError
        If the folder holds neither.
    FileExistsError
        If the file is somebody else's, without a path.

    Examples
    --------
    >>> report_found("no/such/folder")
    Traceback (most recent call last):
        ...
    FileNotFoundError: no/such/folder must be the folder of a fit, with fit.json, or of a search...
    """
    place = Path(folder)
    out = target(path, place / "report.html")
    if (place / FIT).is_file():
        kind, makers = "fit", _of_fit(place)
    elif (place / OPTIMUM).is_file():
        kind, makers = "search", _of_search(place, out)
    else:
        raise FileNotFoundError(
            f"{place} must be the folder of a fit, with {FIT}, or of a search, with {OPTIMUM}"
        )
    problems: list[str] = []
    sections = made({**makers, "Versions": versions}, problems)
    lost = sentences([("doubt", "missing", problem) for problem in problems])
    sections[_FOUND] = lost + sections[_FOUND]
    lead = f"Report of the {kind} in {place.resolve()}."
    write_page(out, kind=kind, name=place.resolve().name, lead=lead, sections=sections)
    return out


def _of_fit(folder: Path) -> dict[str, Callable[[], str]]:
    found: dict[str, Any] = json.loads(read_regular(folder / FIT))
    percent = [100.0 * found[name] for name in ("rms_relative", "rms_relative_at_start")]
    said = [
        f"The curves differ by {percent[0]:.3g} % of the peak (rms), by {percent[1]:.3g} % at the "
        f"start; {found['n_run']} runs.",
        *found["notes"],
    ]
    return {
        _FOUND: lambda: sentences(map(_judged, said)),
        "Values": lambda: table(
            [list(_fitted(one)) for one in found["values"]],
            ["key", "at the start", "fitted", "95 % interval"],
        ),
        "Curves": lambda: _picture(folder / PICTURE),
    }


def _judged(line: str) -> tuple[str, str, str]:
    """Return kind, word and text of a sentence."""
    word, colon, rest = line.partition(",")
    return ("doubt", word, rest) if colon and word == "distrust" else ("note", "found", line)


def _fitted(value: dict[str, Any]) -> Iterator[str]:
    yield in_unit(value["key"], value["unit"])
    yield from (f"{value[name]:.5g}" for name in ("start", "value"))
    is_free = value["low"] is not None
    yield f"{value['low']:.4g} to {value['high']:.4g}" if is_free else "follows"


def _picture(path: Path) -> str:
    if not path.is_file():
        return missing("Not drawn: pictures need Matplotlib (pip install shellcut[plot]).")
    return f"<figure>{image(path.read_bytes(), 'Measured and simulated curves')}</figure>"


def _of_search(folder: Path, page: Path) -> dict[str, Callable[[], str]]:
    found = read_optimum(folder / OPTIMUM)
    name = label_of(found.figure)
    return {
        _FOUND: lambda: f"<pre>{escape(str(found))}</pre>",
        f"{name} of each run".capitalize(): lambda: chart(found.diagram(), f"{name} of each run"),
        "Runs": lambda: _runs(found, folder, page),
    }


def _runs(found: Optimum, folder: Path, page: Path) -> str:
    rows = []
    for number, one in enumerate(found.trials, 1):
        values = ", ".join(f"{key} = {value}" for key, value in one.values.items())
        state = found.state(one) or ("best" if one == found.best else "")
        name = Path(one.folder).name
        rows.append([str(number), values or "as given", found.said(one), state, name])
    head = ["run", "values", label_of(found.figure), "", "folder"]
    link = escape(link_to(folder / RUNS, page))
    where = f'<p class="caption">The folders are in <a href="{link}/">{RUNS}</a>.</p>'
    return table(rows, head) + where
