"""The page that all reports share: style, script and frame around a body."""

from __future__ import annotations

import importlib.metadata
import importlib.resources
import string
import time
from html import escape

_SCRIPTS = ("page.js", "chart.js")


def page_of(
    *,
    title: str,
    heading: str,
    lead: str,
    body: str,
    style: str = "",
    script: str = "",
    last: str = "",
) -> str:
    """Return a self-contained HTML page.

    Parameters
    ----------
    title, heading, lead : str
        Texts, escaped here.
    body : str
        HTML.
    style, script : str
        Further CSS and JavaScript, after those of all reports.
    last : str
        HTML at the end of the page: scripts in elements of their own.
    """
    return string.Template(_part("page.html")).substitute(
        title=escape(title),
        heading=escape(heading),
        lead=escape(lead),
        body=body,
        footer=escape(
            f"Written by shellcut {importlib.metadata.version('shellcut')} on "
            f"{time.strftime('%Y-%m-%d %H:%M')}. Units: mm, N, s, tonne, MPa."
        ),
        style=_part("page.css") + style,
        script="\n".join([*map(_part, _SCRIPTS), script]),
        last=last,
    )


def _part(name: str) -> str:
    return (importlib.resources.files(__package__) / name).read_text(encoding="utf-8")
