"""The page that all reports share: style, scripts and frame around a body."""

from __future__ import annotations

import importlib.metadata
import importlib.resources
import string
import time
from html import escape


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
    """Return a self-contained HTML page with a body.

    Title, heading and lead are escaped here. Charts in the body bring plotly.js onto the page.
    ``style`` and ``script`` come after those of all reports, ``last`` at the end of the page:
    scripts in elements of their own.
    """
    charts = [f"/*\n{part('plotly/LICENSE')}*/", part("plotly/plotly.min.js"), part("charts.js")]
    return string.Template(part("page.html")).substitute(
        title=escape(title),
        heading=escape(heading),
        lead=escape(lead),
        body=body,
        footer=escape(
            f"Written by shellcut {importlib.metadata.version('shellcut')} on "
            f"{time.strftime('%Y-%m-%d %H:%M')}."
        ),
        style=part("page.css") + style,
        script="\n".join([*(charts if 'class="chart' in body else ()), script]),
        last=last,
    )


def part(name: str, room: str = "shellcut.report") -> str:
    """Return the text of a file beside the modules of a room."""
    return (importlib.resources.files(room) / name).read_text(encoding="utf-8")
