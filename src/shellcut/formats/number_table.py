"""Text tables of numbers, as written by spreadsheets and test machines.

::

    Pruefung 3; 12.05.2024
    Winkel [Grad];Drehmoment [Ncm]
    0,0;0,00
    0,5;1,32

Columns are separated by semicolons, tabs, commas or blanks, whichever turns most lines into rows of
numbers; a comma in a cell is then a decimal comma. Lines above the first row are a preamble; its
last line contains the headings if it has one cell per column; a line of units may follow them.
Lines starting with ``#``, ``%`` or ``//`` are comments, as is text after ``#`` in a row; where no
other line holds the headings, the last such comment above the numbers does.
"""

from __future__ import annotations

import csv
import re
import unicodedata
from collections import Counter
from dataclasses import dataclass
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats
from shellcut.unit import dimension

from .errors import FileError, read_lines

_SEPARATORS = (";", "\t", ",", " ")
_MOST_PROBLEMS = 6  # problems listed in a message
_FEW = 10  # rows of a table for each of the results above it
_SHOWN = 40  # columns in a message, and letters of each
_COMMENTS = ("#", "%", "//")
_MARK = re.compile(r"\s*(#+|%|//)\s*")
_NUMBER = re.compile(r"[+-]?(\d+([.,]\d*)?|[.,]\d+)([eE][+-]?\d+)?|[+-]?(nan|inf(inity)?)", re.I)
_THOUSANDS = re.compile(r"[+-]?\d{1,3}(([.,'’\u00a0\u202f ])\d{3})((\2\d{3})*[.,]\d+|(\2\d{3})+)")
_GROUPED = re.compile(r"[+-]?[1-9]\d{0,2}[.,]\d{3}")  # 1,020: may be 1020
_BELOW_THOUSAND, _WHOLE = re.compile(r"[+-]?[1-9]\d{0,2}"), re.compile(r"[+-]?[1-9]\d*")
_BRACKETS = re.compile(r"(?P<name>.*?)\s*(\[(?P<a>[^\]]*)\]|\((?P<b>[^)]*)\))\s*")
_SLASH = re.compile(r"(?P<name>.*?)\s*/\s*(?P<unit>[^/]*?)\s*")
_PER_CENT_FIRST = re.compile(r"(%|percent(age)?\b|prozent\b)\s*", re.I)
_BEFORE_UNIT = re.compile(r"[\s,:;_/]+")
_MOST_WORDS = 4  # of a unit, as "N / mm ²"
_LONGEST = 300  # characters of a heading


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
        """Return some of the columns, shape (n_row, len(columns))."""
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
                    said = f"must be a number, got {cell!r}" if cell else "a number is missing"
                    if _THOUSANDS.fullmatch(cell):
                        said = f"thousands separators are not read, got {cell!r}"
                    problems.append(f"line {line}: {said}")
        if len(mark) == 2:
            (point, at), (comma, there) = mark["."], mark[","]
            problems.append(
                f"all numbers must have the same decimal sign, got {point!r} in line {at} and "
                f"{comma!r} in line {there}; thousands separators are not read"
            )
        if problems := problems or self._ambiguous(columns):
            more = len(problems) - _MOST_PROBLEMS
            listed = [*problems[:_MOST_PROBLEMS], *([f"and {more} more"] if more > 0 else [])]
            raise FileError(self.path, "; ".join(listed))
        return values

    def _ambiguous(self, columns: list[int]) -> list[str]:
        """Return which columns may have thousands separators, by their first such cell.

        Numbers below a thousand have none of these, so the column has whole numbers without a sign,
        and others with a sign before three digits. Decimals are written with as many digits in all
        rows, then no number is whole, or with as many as each needs, then hardly all need three. A
        zero says nothing: it is often written without decimals. In a file with 0,5 the comma is the
        decimal sign.
        """
        signed = (cell for cells in self.rows for cell in cells if "." in cell or "," in cell)
        if any(_NUMBER.fullmatch(cell) and not _GROUPED.fullmatch(cell) for cell in signed):
            return []
        problems = []
        for column in dict.fromkeys(columns):
            cells = [(row[column], line) for row, line in zip(self.rows, self.lines, strict=True)]
            grouped = [(cell, line) for cell, line in cells if _GROUPED.fullmatch(cell)]
            whole = [(cell, line) for cell, line in cells if _WHOLE.fullmatch(cell)]
            if grouped and whole and all(_BELOW_THOUSAND.fullmatch(cell) for cell, _ in whole):
                (cell, at), (other, there) = grouped[0], whole[0]
                digits = re.sub("[.,]", "", cell)
                problems.append(
                    f"{self.name(column)} is ambiguous: {cell!r} in line {at} may be "
                    f"{digits} or {cell.replace(',', '.')}, as {other!r} in line {there} has no "
                    f"decimals; write {digits}, or decimals in every number, as in {other}.0"
                )
        return problems

    def column(self, which: str | int) -> int:
        """Return the index of a column given by heading, with or without unit, or number from 1.

        Raises ValueError if there is none, or more than one, with a list of the columns.
        """
        if isinstance(which, str):
            hits = self.headed(which)
            if len(hits) > 1:
                numbers = " and ".join(str(k + 1) for k in hits)
                raise ValueError(f"{which!r} is the heading of columns {numbers}: give the number")
            if hits:
                return hits[0]
            if not which.strip().isdecimal():
                names = {heading.name.casefold(): heading.name for heading in self.headings}
                near = get_close_matches(which.strip().casefold(), names, n=1)
                hint = f"did you mean {names[near[0]]!r}? " if near else ""
                raise ValueError(f"no column {which!r}: {hint}there are {self.listing()}")
            which = int(which)
        if not 1 <= which <= self.n_column:
            raise ValueError(
                f"column must be a number from 1 to {self.n_column}, got {which}; there are "
                f"{self.listing()}"
            )
        return which - 1

    def headed(self, name: str) -> list[int]:
        """Return the columns with a heading, in any case, with its unit or without."""
        wanted = unicodedata.normalize("NFC", name).strip().casefold()
        whole = [k for k, h in enumerate(self.headings) if h.text.strip().casefold() == wanted]
        return whole or [k for k, h in enumerate(self.headings) if h.name.casefold() == wanted]

    def name(self, column: int) -> str:
        """Return the name of a column, its number where it has none."""
        name = self.headings[column].name if self.headings else ""
        return name or f"column {column + 1}"

    def listing(self) -> str:
        """Return all columns with their numbers in words."""
        if not self.headings:
            commas = self.separator == ","
            hint = "; if these are decimal commas, separate the columns by semicolons"
            return f"{self.n_column} columns without headings{hint if commas else ''}"
        shown = [f"{k}: {h.text[:_SHOWN]!r}" for k, h in enumerate(self.headings[:_SHOWN], 1)]
        more = [f"and {self.n_column - _SHOWN} more"] if self.n_column > _SHOWN else []
        return ", ".join(shown + more)


def read_number_table(path: str | Path) -> NumberTable:
    """Read a table of numbers; its cells are converted only when columns are requested."""
    path = Path(path)
    # An accent may be a character of its own; headings are compared with those that a user types.
    every = enumerate((unicodedata.normalize("NFC", line) for line in read_lines(path)), start=1)
    written = [(number, text.rstrip()) for number, text in every if text.strip()]
    lines = [(number, text) for number, text in written if not _is_comment(text)]
    if not lines:
        raise FileError(path, "a table must have a line of headings and lines of numbers")
    separator, first = _layout([text for _, text in lines])
    rows = [_cells(text.split("#", 1)[0], separator) for _, text in lines[first:]]
    # A separator at the end of every row does not make a column.
    if rows and all(len(cells) > 1 and not cells[-1] for cells in rows):
        rows = [cells[:-1] for cells in rows]
    n = Counter(map(len, rows)).most_common(1)[0][0] if rows else 0
    before = lines[first][0] if first < len(lines) else 0
    marked = [
        (number, _MARK.sub("", text, count=1))
        for number, text in written
        if number < before and _is_comment(text)
    ]
    others = filter(None, (_headings(marked, other, n) for other in _SEPARATORS))
    headings, heading_line = (
        _headings(lines[:first], separator, n)
        or _headings(marked, separator, n)
        or next((found for found in others if any(dimension(h.unit) for h in found[0])), None)
        or ([], 0)
    )
    return NumberTable(
        path=path,
        headings=tuple(headings),
        heading_line=heading_line,
        rows=tuple(map(tuple, rows)),
        lines=tuple(number for number, _ in lines[first:]),
        separator=separator,
    )


def split_heading(text: str) -> Heading:
    """Split a heading into name and unit.

    The unit is in brackets, ``torque [N*mm]`` or ``torque (N*mm)``, or at the end,
    ``torque / N*mm``, ``Strain, %``, ``Stress MPa``, ``Kraft in N``; at the end without a slash,
    and in front as in ``% strain``, only known units count.

    Examples
    --------
    >>> split_heading("Winkel [Grad]")
    Heading(name='Winkel', unit='Grad', text='Winkel [Grad]')
    >>> split_heading("Strain, %").unit, split_heading("Load cell in N").name
    ('%', 'Load cell')
    """
    if len(text) > _LONGEST:
        return Heading(text, "", text)
    found = _BRACKETS.fullmatch(text)
    brackets = (found["name"], (found["a"] or found["b"] or "").strip()) if found else ("", "")
    if found and (not brackets[1] or dimension(brackets[1])):
        return Heading(*brackets, text)
    if first := _PER_CENT_FIRST.match(text):
        return Heading(text[first.end() :] or text, "%", text)
    _, word, end = text.rpartition(" in ")
    starts = [len(text) - len(end)] * bool(word)
    starts += [0, *(gap.end() for gap in _BEFORE_UNIT.finditer(text))][-_MOST_WORDS:]
    for start in starts:  # the longest unit first
        name, unit = text[:start].rstrip(" \t,:;_/-").removesuffix(" in"), text[start:].strip()
        if _is_unit(unit) and not (text[:start].endswith("/") and _ends_in_unit(name)):
            return Heading(name or text, unit, text)
    if found:  # "Stress MPa (MD)"
        inner = split_heading(brackets[0])
        if inner.unit and dimension(inner.unit):
            return Heading(f"{inner.name} {brackets[1]}", inner.unit, text)
        return Heading(*brackets, text)
    slash = _SLASH.fullmatch(text)
    if slash and not _ends_in_unit(slash["name"]):
        return Heading(slash["name"], slash["unit"], text)
    return Heading(text, "", text)


def _is_unit(text: str) -> bool:
    # a number is none, though 1 is also written as the unit of ratios
    return not text[:1].isdecimal() and text[:2] != "- " and dimension(text) is not None


def _ends_in_unit(name: str) -> bool:
    _, blank, last = name.rpartition(" ")
    return bool(blank) and _is_unit(last)


def _is_comment(text: str) -> bool:
    # A line of units may begin with that of per cent.
    if not text.lstrip().startswith(_COMMENTS):
        return False
    units = (_units(_cells(text, separator)) for separator in _SEPARATORS)
    return not any(len(given) > 1 and all(map(dimension, given)) for given in units)


def _units(cells: list[str]) -> list[str]:
    return [cell.strip("[]() ") for cell in cells if cell]


def _cells(text: str, separator: str) -> list[str]:
    if separator == " ":
        return text.split()
    try:
        (cells,) = csv.reader([text], delimiter=separator, skipinitialspace=True)
    except csv.Error:  # longer than any number
        return [text]
    return [cell.strip() for cell in cells]


def _layout(lines: list[str]) -> tuple[str, int]:
    """Return the separator and the index of the first row of numbers."""
    most = 0
    for separator in _SEPARATORS:
        each = [_row_width(_cells(text.split("#", 1)[0], separator)) for text in lines]
        rows = Counter(width for width in each if width)
        if rows and rows.most_common(1)[0][1] > most:
            ((width, most),) = rows.most_common(1)
            best, widths = separator, each
    if most:
        first = k = widths.index(width)
        before, after = 0, most
        while _FEW * before <= after and k < len(lines):
            counted = widths[k] == width
            before, after = before + counted, after - counted
            # a table of results above the record: few rows, and headings with units below
            cells = [] if widths[k] else _cells(lines[k], best)
            if len(cells) == width and any(split_heading(cell).unit for cell in cells):
                first, before = widths.index(width, k), 0
            k += 1
        return best, first
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


def _headings(
    preamble: list[tuple[int, str]], separator: str, n: int
) -> tuple[list[Heading], int] | None:
    each = ((line, _heading_cells(text, separator, n)) for line, text in preamble)
    found = [(line, cells) for line, cells in each if cells]
    if not found:
        return None
    line, cells = found[-1]
    # a line of units: half of them known, as a test machine has more
    given = _units(cells)
    known = sum(dimension(unit) is not None for unit in given)
    are_units = 0 < known >= len(given) - known and not any(map(_is_number, given))
    if len(found) > 1 and are_units:
        units = [cell.strip("[]() ") for cell in cells]
        line, names = found[-2]
        return [Heading(name, unit, name) for name, unit in zip(names, units, strict=True)], line
    return [split_heading(cell) for cell in cells], line


def _heading_cells(text: str, separator: str, n: int) -> list[str]:
    """Return the ``n`` cells of a heading line, or an empty list if their number differs."""
    if separator == " ":
        # "angle [deg]" is one cell; so are words with one blank if cells are separated by two.
        text = re.sub(r"[,;](?=\s|$)", "", text)
        splits = [re.split(r"\s+(?![\[(])", text.strip()), re.split(r"\s{2,}|\t", text.strip())]
        splits.append(re.split(r"(?<=[\])])\s+", text.strip()))
    else:
        cells = _cells(text, separator)
        splits = [cells, cells[:-1] if not cells[-1] else cells]
    names, units = splits[0][::2], splits[0][1::2]
    if len(units) == n and all(map(dimension, units)):  # "Strain, %, Stress, MPa"
        splits.append([f"{name} [{unit}]" for name, unit in zip(names, units, strict=False)])
    return next((cells for cells in splits if len(cells) == n and any(cells)), [])
