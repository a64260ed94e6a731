"""Pieces of HTML that the sections are made of."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

_AS_GOOD_AS_ZERO = 5e-4  # of lengths, areas and angles of a cut: mm, mm², degrees

_LONG = 15  # characters of a cell


def section(title: str, body: str) -> str:
    """Return a titled section; nothing if it is empty."""
    return f"<section><h2>{escape(title)}</h2>\n{body}\n</section>\n" if body else ""


def table(rows: Sequence[Sequence[str]], head: Sequence[str] = ()) -> str:
    """Return a table of escaped texts, the first column its row heads."""
    parts = []
    if head:
        cells = "".join(f'<th scope="col">{escape(cell)}</th>' for cell in head)
        parts.append(f"<thead><tr>{cells}</tr></thead>")
    parts.append("<tbody>")
    for first, *others in rows:
        cells = "".join(f'<td class="{_kind(cell)}">{escape(cell)}</td>' for cell in others)
        parts.append(f'<tr><th scope="row">{escape(first)}</th>{cells}</tr>')
    return f'<div class="wide"><table>{"".join(parts)}</tbody></table></div>'


def _kind(cell: str) -> str:
    # What is too long for a column of numbers may be broken on a phone.
    return "n" if len(cell) < _LONG else "n long"


def missing(text: str) -> str:
    """Return a sentence on what is not there."""
    return f'<p class="missing">{escape(text)}</p>'


def pretty(unit: str) -> str:
    """Return a unit as one prints it: "N*mm" becomes "N·mm"."""
    return unit.replace("*", "·").replace("deg", "°").replace("^2", "²")


def _gap(unit: str) -> str:
    return "" if unit == "deg" else " "


def figure_of(value: float, unit: str) -> str:
    """Return a number of three figures and its unit."""
    number = f"{value:.3g}" if abs(value) >= _AS_GOOD_AS_ZERO else "0"
    return number if unit == "-" else f"{number}{_gap(unit)}{pretty(unit)}"


def in_unit(name: str, unit: str) -> str:
    """Return the head of a row whose cells are numbers in a unit."""
    return f"{name} [{pretty(unit)}]" if unit not in ("", "-") else name
