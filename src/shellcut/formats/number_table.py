"""Text tables of numbers, as written by spreadsheets and test machines.

::

    Pruefung 3; 12.05.2024
    Winkel [Grad];Drehmoment [Ncm]
    0,0;0,00
    0,5;1,32

Columns are separated by semicolons, tabs, commas or blanks, whichever turns most lines into rows of
numbers; a comma in a cell is then a decimal comma. Lines above the first row are a preamble; its
last line contains the headings if it has one cell per column; a line of units may follow them.
Lines starting with ``#``, ``%`` or ``//`` are comments, as is text after ``#`` in a row.
"""

from __future__ import annotations

import codecs
import csv
import re
from collections import Counter
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats
from shellcut.unit import canonical

from .errors import FileError, read_bytes

_SEPARATORS = (";", "\t", ",", " ")
_MOST_PROBLEMS = 6  # problems listed in a message
_COMMENTS = ("#", "%", "//")
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf(inity)?)", re.I)
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(([.,'’\u00a0\u202f ])\d{3})((\2\d{3})*[.,]\d+|(\2\d{3})+)")
_HEADING = re.compile(r"(?P<name>.*?)\s*(\[(?P<a>[^\]]*)\]|\((?P<b>[^)]*)\)|/\s*(?P<c>[^/]*?))\s*")


@dataclass(frozen=True)
class Heading:
    """Name and unit of a column, as written; both may be empty."""

    name: str
    unit: str
    text: str
    """The whole cell."""


@dataclass(frozen=True, eq=False)
class NumberTable:
    """The rows of a table as text, with their line numbers."""

    path: Path
    headings: tuple[Heading, ...]
    """One per column, or none."""
    heading_line: int
    """Line number of the headings in the file; 0 without headings."""
    rows: tuple[tuple[str, ...], ...]
    lines: tuple[int, ...]
    """Line number of each row in the file."""
    separator: str

    @property
    def n_column(self) -> int:
        """Number of columns."""
        return len(self.headings) or (len(self.rows[0]) if self.rows else 0)

    def numbers(self, columns: list[int]) -> Floats:
        """Return some of the columns, shape (n_row, len(columns)).

        Raises
        ------
        FileError
            Lists rows of another length and cells that are not numbers, with their lines.
        """
        problems: list[str] = []
        values = np.full((len(self.rows), len(columns)), np.nan)
        mark: dict[str, tuple[str, int]] = {}  # first cell with "." and with ","
        for i, (cells, line) in enumerate(zip(self.rows, self.lines, strict=True)):
            if len(cells) != self.n_column:
                problems.append(
                    f"line {line}: there must be {self.n_column} numbers, got {len(cells)}"
                )
                continue
            for k, column in enumerate(columns):
                cell = cells[column]
                if _NUMBER.fullmatch(cell):
                    values[i, k] = float(cell.replace(",", "."))
                    mark |= {m: (cell, line) for m in ".," if m in cell and m not in mark}
                else:
                    problems.append(f"line {line}: {_no_number(cell)}")
        if len(mark) == 2:
            (point, at), (comma, there) = mark["."], mark[","]
            problems.append(
                f"decimals must be written one way, got {point!r} in line {at} and {comma!r} in "
                f"line {there}; thousands separators are not read"
            )
        if problems:
            raise FileError(self.path, _listed(problems))
        return values


def read_number_table(path: str | Path) -> NumberTable:
    """Read a table of numbers; its cells are converted only when columns are requested.

    Raises
    ------
    FileError
        If the file cannot be read or contains only comments.
    """
    path = Path(path)
    lines = [
        (number, text.rstrip())
        for number, text in enumerate(_decode(read_bytes(path)).splitlines(), start=1)
        if text.strip() and not text.lstrip().startswith(_COMMENTS)
    ]
    if not lines:
        raise FileError(path, "a table must have a line of headings and lines of numbers")
    separator, first = _layout([text for _, text in lines])
    rows = [_cells(text.split("#", 1)[0], separator) for _, text in lines[first:]]
    # A separator at the end of every row does not make a column.
    if rows and all(len(cells) > 1 and not cells[-1] for cells in rows):
        rows = [cells[:-1] for cells in rows]
    n = Counter(map(len, rows)).most_common(1)[0][0] if rows else 0
    headings, heading_line = _headings(lines[:first], separator, n)
    return NumberTable(
        path=path,
        headings=tuple(headings),
        heading_line=heading_line,
        rows=tuple(map(tuple, rows)),
        lines=tuple(number for number, _ in lines[first:]),
        separator=separator,
    )


def split_heading(text: str) -> Heading:
    """Split ``torque [N*mm]``, ``torque (N*mm)`` or ``torque / N*mm`` into name and unit.

    Examples
    --------
    >>> split_heading("Winkel [Grad]")
    Heading(name='Winkel', unit='Grad', text='Winkel [Grad]')
    """
    found = _HEADING.fullmatch(text)
    if not found or not found["name"]:
        return Heading(text, "", text)
    unit = next(u for u in (found["a"], found["b"], found["c"]) if u is not None)
    return Heading(found["name"], unit.strip(), text)


def _decode(content: bytes) -> str:
    # Spreadsheets write UTF-8 with or without BOM, UTF-16 with BOM, or the Western code page.
    if content.startswith((codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)):
        return content.decode("utf-16", errors="replace")
    try:
        return content.decode("utf-8-sig")
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace")


def _cells(text: str, separator: str) -> list[str]:
    if separator == " ":
        return text.split()
    return [
        cell.strip()
        for cell in next(csv.reader([text], delimiter=separator, skipinitialspace=True))
    ]


def _layout(lines: list[str]) -> tuple[str, int]:
    """Return the separator and the index of the first row of numbers."""
    best: tuple[int, str, int] = (0, "", 0)
    for separator in _SEPARATORS:
        widths = [_row_width(_cells(text.split("#", 1)[0], separator)) for text in lines]
        rows = Counter(width for width in widths if width)
        if rows:
            width, count = rows.most_common(1)[0]
            if count > best[0]:
                best = (count, separator, widths.index(width))
    if best[0]:
        return best[1:]
    # One column, or no line like a row: use the headings; later checks report the rest.
    separator = next((s for s in _SEPARATORS[:2] if s in lines[0]), ",")
    alone = (i for i, text in enumerate(lines) if _is_number(text.split("#", 1)[0].strip(' "')))
    return separator, next(alone, min(1, len(lines)))


def _row_width(cells: list[str]) -> int:
    """Return the number of cells of a line that looks like a row of numbers, otherwise 0."""
    n_number = sum(map(_is_number, cells))
    n_word = sum(bool(cell) for cell in cells) - n_number
    return len(cells) if n_number >= 2 and n_number >= n_word else 0


def _is_number(cell: str) -> bool:
    return bool(_NUMBER.fullmatch(cell) or _THOUSANDS.fullmatch(cell))


def _headings(preamble: list[tuple[int, str]], separator: str, n: int) -> tuple[list[Heading], int]:
    found = [
        (line, cells) for line, text in preamble if (cells := _heading_cells(text, separator, n))
    ]
    if not found:
        return [], 0
    line, cells = found[-1]
    units = [cell.strip("[]() ") for cell in cells]
    if len(found) > 1 and all(not u or canonical(u) for u in units):
        line, names = found[-2]
        return [Heading(name, unit, name) for name, unit in zip(names, units, strict=True)], line
    return [split_heading(cell) for cell in cells], line


def _heading_cells(text: str, separator: str, n: int) -> list[str]:
    """Return the ``n`` cells of a heading line, or an empty list if their number differs."""
    if separator == " ":
        # "angle [deg]" is one cell; so are words with one blank if cells are separated by two.
        ways = [re.split(r"\s+(?![\[(])", text.strip()), re.split(r"\s{2,}|\t", text.strip())]
    else:
        cells = _cells(text, separator)
        ways = [cells, cells[:-1] if not cells[-1] else cells]
    return next((cells for cells in ways if len(cells) == n and any(cells)), [])


def _no_number(cell: str) -> str:
    if not cell:
        return "a number is missing"
    if _THOUSANDS.fullmatch(cell):
        return f"thousands separators are not read, got {cell!r}"
    return f"must be a number, got {cell!r}"


def _listed(problems: list[str]) -> str:
    left = len(problems) - _MOST_PROBLEMS
    more = f"; and {left} more" if left > 0 else ""
    return "; ".join(problems[:_MOST_PROBLEMS]) + more
