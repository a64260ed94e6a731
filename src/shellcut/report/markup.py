"""HTML elements of the sections."""

from __future__ import annotations

import os
import urllib.parse
from collections.abc import Iterable, Sequence
from html import escape
from pathlib import Path

_LONG = 15  # characters of a cell that may be wrapped
_SAID = 40  # characters of a cell that is read as a sentence, not as a number


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
