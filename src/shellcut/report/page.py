"""The page that all reports share: a section that fails costs no other; frame, HTML elements."""

from __future__ import annotations

import importlib.metadata
import os
import platform
import string
import time
import urllib.parse
from collections.abc import Callable, Iterable, Mapping, Sequence
from html import escape
from pathlib import Path
from typing import TypeVar

from shellcut.files.distribution import DISTRIBUTION, VERSION
from shellcut.files.whole_file import write_text
from shellcut.scene_page.page import part, scene_scripts

CHART, SCENE = 'class="chart', 'class="scene3d"'
"""What a page with a chart, or with a scene, contains."""

_ROOM = "shellcut.report"
_LONG = 15  # characters of a cell that may be wrapped
_SAID = 40  # characters of a cell that is read as a sentence, not as a number

T = TypeVar("T")


def or_say(problems: list[str], what: str, attempt: Callable[[], T]) -> T | None:
    """Return the attempt's result; if it fails, add the reason to the problems."""
    try:
        return attempt()
    except KeyError as error:
        problems.append(f"The {what} cannot be shown: the files contain no {error}.")
        return None
    except (OSError, ValueError, IndexError) as error:
        problems.append(f"The {what} cannot be shown: {error}.")
        return None


def made(makers: Mapping[str, Callable[[], str]], problems: list[str]) -> dict[str, str]:
    """Return sections by their titles; of one that fails the reason is added to the problems."""
    return {
        title: or_say(problems, f'section "{title}"', maker) or ""
        for title, maker in makers.items()
    }


def write_page(
    path: Path,
    *,
    kind: str,
    name: str,
    lead: str,
    sections: Mapping[str, str],
    style: str = "",
    script: str = "",
) -> None:
    """Write a self-contained HTML page about a run or a study, its kind, with these sections.

    Name, lead and titles are escaped here; an empty section is left out. Charts bring plotly.js
    onto the page, a scene brings three.js. ``style`` and ``script`` come after those of all
    reports.
    """
    body = "".join(section(title, text) for title, text in sections.items())
    charts = ""
    if CHART in body:
        licence, library = part(_ROOM, "plotly/LICENSE"), part(_ROOM, "plotly/plotly.min.js")
        charts = f"/*\n{licence}*/\n{library}\n{part(_ROOM, 'charts.js')}\n"
    has_scene = SCENE in body
    html = string.Template(part(_ROOM, "page.html")).substitute(
        title=escape(f"{name} - report of a {kind}"),
        heading=escape(name),
        lead=escape(lead),
        body=body,
        footer=escape(f"Written by shellcut {VERSION} on {time.strftime('%Y-%m-%d %H:%M')}."),
        style=part(_ROOM, "page.css")
        + (part("shellcut.scene_page", "scene.css") if has_scene else "")
        + style,
        script=charts + script,
        last=scene_scripts() if has_scene else "",
    )
    write_text(path, html, errors="backslashreplace")


def versions() -> str:
    """Return the versions of the packages that wrote the report."""
    rows = [("Python", platform.python_version()), ("machine", platform.platform(terse=True))]
    for package in (DISTRIBUTION, "numpy", "scipy", "numba", "h5py", "matplotlib"):
        try:
            rows.append((package, importlib.metadata.version(package)))
        except importlib.metadata.PackageNotFoundError:
            rows.append((package, "not installed"))
    return table(rows) + '<p class="caption">In the installation that wrote this report.</p>'


# --- elements ------------------------------------------------------------------------------------


def section(title: str, body: str) -> str:
    """Return a titled section; "" if it is empty."""
    return f"<section><h2>{escape(title)}</h2>\n{body}\n</section>\n" if body else ""


def table(rows: Sequence[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return a table of escaped texts with row heads in the first column."""
    parts = []
    if head:
        cells = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
        parts.append(f"<thead><tr>{cells}</tr></thead>")
    parts.append("<tbody>")
    kinds = [_kind(max(map(len, column))) for column in zip(*rows, strict=True)]
    for first, *others in rows:
        each = zip(kinds[1:], others, strict=True)
        cells = "".join(f'<td class="{kind}">{escape(cell)}</td>' for kind, cell in each)
        parts.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return f'<div class="wide"><table>{"".join(parts)}</tbody></table></div>'


def _kind(longest: int) -> str:
    """Return the class of the cells of a column from the length of the longest."""
    # Text too long for a column of numbers may wrap on a phone, a sentence on every page.
    if longest > _SAID:
        return "said"
    return "n" if longest < _LONG else "n long"


def sentences(lines: Iterable[tuple[str, str, str]]) -> str:
    """Return sentences by kind (good, doubt or note) with a word before each; "" for none."""
    items = "".join(
        f'<li class="{kind}"><b>{word}</b>{escape(text)}</li>' for kind, word, text in lines
    )
    return f'<ul class="verdict">{items}</ul>' if items else ""


def legend(names: Iterable[tuple[str, str]]) -> str:
    """Return names with a spot of their colours."""
    items = "".join(
        f'<li><span class="spot" style="background:{color}"></span>{escape(name)}</li>'
        for name, color in names
    )
    return f'<ul class="legend">{items}</ul>'


def missing(text: str) -> str:
    """Return a sentence about missing content."""
    return f'<p class="missing">{escape(text)}</p>'


def link_to(path: Path, report: Path) -> str:
    """Return the address of a file or folder, relative to that of the report where it can be."""
    try:
        relative = os.path.relpath(path.resolve(), report.resolve().parent)
    except ValueError:  # on another drive
        return path.resolve().as_uri()
    return urllib.parse.quote(Path(relative).as_posix())
