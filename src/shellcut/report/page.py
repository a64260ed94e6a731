"""The page that all reports share: a section that fails costs no other; style, scripts, frame."""

from __future__ import annotations

import importlib.metadata
import platform
import string
import time
from collections.abc import Callable, Mapping
from html import escape
from pathlib import Path
from typing import TypeVar

from shellcut.files.distribution import DISTRIBUTION, VERSION
from shellcut.files.whole_file import write_text
from shellcut.scene_page.page import part, scene_scripts

from .markup import section, table

CHART, SCENE = 'class="chart', 'class="scene3d"'
"""What a page with a chart, or with a scene, contains."""

_ROOM = "shellcut.report"

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
