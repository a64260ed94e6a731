"""The report of a fit, or of a search for the best values: what was found, and its curves."""

from __future__ import annotations

import json
import os
from html import escape
from pathlib import Path

from shellcut.card import image
from shellcut.files.distribution import pip_install
from shellcut.files.file_list import target
from shellcut.files.regular_file import read_regular
from shellcut.report.page import link_to, missing, versions, write_page
from shellcut.study.plan import RUNS


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
