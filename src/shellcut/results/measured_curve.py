"""A measured curve in the library's units.

The file is a table as read by :mod:`shellcut.formats.number_table`; its columns are selected by
heading or number, their units come from the headings or are given.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.formats.errors import FileError, named
from shellcut.formats.number_table import NumberTable, read_number_table
from shellcut.unit import DIMENSIONS, LIBRARY_UNITS, conversion, dimension

_JITTER = 0.01
"""Relative to the range: backward motion of a coordinate up to this is encoder noise."""


@dataclass(frozen=True, eq=False)
class MeasuredCurve:
    """A measured quantity over an increasing coordinate.

    Examples
    --------
    >>> curve = MeasuredCurve([0.0, 45.0, 90.0], [0.0, 0.14, 0.13], x_unit="deg", y_unit="N*m")
    >>> curve.y, curve.y_unit
    (array([  0., 140., 130.]), 'N*mm')
    """

    x: npt.ArrayLike
    """Coordinate, increasing, shape (n,); given in ``x_unit``, stored in the library's unit."""
    y: npt.ArrayLike
    """Measured values, shape (n,); given in ``y_unit``, stored in the library's unit."""
    x_unit: str
    """Given in common notation, stored as the library's unit of that dimension: deg, mm or s."""
    y_unit: str
    """The same for ``y``: N*mm, N, ..."""
    x_name: str = "x"
    y_name: str = "y"
    notes: tuple[str, ...] = ()
    """Changes made to the points, in words."""

    def __post_init__(self) -> None:
        x, y = np.array(self.x, dtype=float), np.array(self.y, dtype=float)
        problems = []
        if x.ndim != 1 or x.shape != y.shape or len(x) < 2:
            problems.append(
                "x and y must have one dimension and the same length of two or more, got shapes "
                f"{x.shape} and {y.shape}"
            )
        elif not (np.isfinite(x).all() and np.isfinite(y).all()):
            rows = np.flatnonzero(~np.isfinite(x) | ~np.isfinite(y))
            problems.append(f"x and y must be finite, but are not in rows {named(rows)}")
        problems += [
            f"{name}: {_unknown(unit)}"
            for name, unit in (("x_unit", self.x_unit), ("y_unit", self.y_unit))
            if dimension(unit) is None
        ]
        if problems:
            raise ValueError("; ".join(problems))
        x, y, notes = _in_order(x, y)
        for name, values, unit in (("x", x, self.x_unit), ("y", y, self.y_unit)):
            ours = LIBRARY_UNITS[str(dimension(unit))]
            values *= conversion(unit, ours)
            values.flags.writeable = False
            object.__setattr__(self, name, values)
            object.__setattr__(self, f"{name}_unit", ours)
        object.__setattr__(self, "notes", (*self.notes, *notes))


def read_measured_curve(
    path: str | Path,
    x: str | int | None = None,
    y: str | int | None = None,
    *,
    units: str | Sequence[str] | None = None,
    expected: tuple[str, str] | None = None,
) -> MeasuredCurve:
    """Read two columns of a text table.

    Parameters
    ----------
    path : str or Path
        A file with semicolons, tabs, commas or blanks between its columns.
    x, y : str or int, optional
        Columns by heading (with or without unit, any case) or by number from 1; by default those
        with the ``expected`` headings, or the first and second of a table of two columns.
    units : str or (str, str), optional
        Units of ``x`` and ``y``, as ``"deg, N*mm"``; by default those of the headings.
    expected : (str, str), optional
        Headings to use if ``x`` or ``y`` is not given, as ``("angle", "torque")``.

    Returns
    -------
    MeasuredCurve
        In the library's units, with increasing coordinate.

    Raises
    ------
    FileError
        Lists missing columns, unknown units, and lines that are not numbers.

    Examples
    --------
    >>> from pathlib import Path
    >>> lines = "Winkel [Grad];Drehmoment [Ncm]", "0,0;0,00", "0,5;1,32"
    >>> with Path("cap.csv").open("w") as file:
    ...     print(*lines, sep=chr(10), file=file)
    >>> curve = read_measured_curve("cap.csv")
    >>> curve.y, curve.y_unit
    (array([ 0. , 13.2]), 'N*mm')
    """
    table = read_number_table(path)
    texts = units.split(",") if isinstance(units, str) else units or ("", "")
    given = [text.strip() for text in texts]
    if len(given) != 2:
        raise ValueError(f'units must be two, of x and y, as "deg, N*mm", got {units!r}')
    problems: list[str] = []
    columns = []
    for k, (which, name) in enumerate(zip((x, y), expected or ("", ""), strict=True)):
        try:
            columns.append(_column(table, which, k, name))
        except ValueError as problem:
            problems.append(str(problem))
    if len(columns) == 2 and columns[0] == columns[1]:
        problems.append(f"x and y must be two columns, both are {table.name(columns[0])}")
    if problems:
        raise FileError(path, "; ".join(dict.fromkeys(problems)))
    notes, taken = list[str](), list[str]()
    for column, unit in zip(columns, given, strict=True):
        written = table.headings[column].unit if table.headings else ""
        name = table.name(column)
        taken.append(unit or written)
        if not unit and not written:
            problems.append(f'the unit of {name} must be given, as units="deg, N*mm"')
        elif dimension(unit or written) is None:
            problems.append(f"{name}: {_unknown(unit or written)}")
        elif unit and written:
            alike = dimension(written) == dimension(unit) and conversion(written, unit) == 1.0
            note = f"{name} has the heading unit {written}, but is read as {unit} as given"
            notes += [] if alike else [note]
    if problems:
        raise FileError(path, "; ".join(problems))
    values = table.numbers(columns)
    rows = np.flatnonzero(~np.isfinite(values).all(axis=1))
    if len(rows):
        where = named(table.lines[row] for row in rows)
        raise FileError(path, f"numbers must be finite, they are not in lines {where}")
    try:
        return MeasuredCurve(
            values[:, 0],
            values[:, 1],
            x_unit=taken[0],
            y_unit=taken[1],
            x_name=table.name(columns[0]),
            y_name=table.name(columns[1]),
            notes=tuple(notes),
        )
    except _RunsBack as back:
        raise FileError(path, f"{back}; there in line {table.lines[back.row]}") from None
    except ValueError as problem:
        raise FileError(path, str(problem)) from None


def _column(table: NumberTable, which: str | int | None, position: int, name: str) -> int:
    """Return the index of a column; ValueError describes the problem."""
    if which is not None:
        return table.column(which)
    hits = table.headed(name) if name else []
    if len(hits) == 1:
        return hits[0]
    if table.n_column == 2:
        return position
    raise ValueError(
        f"a table of {table.n_column} columns needs a choice of columns; there are "
        f"{table.listing()}"
    )


def _unknown(unit: str) -> str:
    known = "; ".join(
        f"{what}: {', '.join(sizes)}" for what, sizes in DIMENSIONS.items() if what != "ratio"
    )
    return f"unit must be one of {known}; got {unit!r}"


class _RunsBack(ValueError):
    """The coordinate reverses in a row."""

    def __init__(self, problem: str, row: int):
        super().__init__(problem)
        self.row = row


def _reversal(x: Floats, sign: float) -> _RunsBack:
    # x in the order of the file, increasing but for the fault; sign times x was written
    def in_order(rows: Floats) -> bool:
        back = (np.maximum.accumulate(rows) - rows).max()
        return bool(back <= _JITTER * float(np.ptp(rows)))

    behind = np.maximum.accumulate(x) - x
    row = int(np.argmax(behind > _JITTER * float(np.ptp(x))))
    if row < len(x) - 1 and in_order(np.delete(x, row - 1)):
        row -= 1
    alone = in_order(np.delete(x, row))
    cure = "in this row alone: correct or drop it" if alone else "keep one stroke"
    return _RunsBack(
        f"the coordinate must keep its direction, but reverses at {sign * x[row]:g}: {cure}", row
    )


def _in_order(x: Floats, y: Floats) -> tuple[Floats, Floats, list[str]]:
    """Return the points with x strictly increasing, and the changes made to them."""
    notes = []
    n = len(x)
    reach = float(np.ptp(x))
    if reach == 0.0:
        raise ValueError(f"the coordinate must increase, but all {n} points are at {x[0]:g}")
    # the way that most rows go; one row that leaps does not turn it
    if falling := bool(np.sign(np.diff(x)).sum() < 0.0):
        notes.append("the coordinate decreases: the order of the points was reversed")
        x, y = x[::-1], y[::-1]
    behind = np.maximum.accumulate(x) - x
    if behind.max() > _JITTER * reach:
        raise _reversal(-x[::-1] if falling else x, -1.0 if falling else 1.0)
    if behind.any():
        notes.append(f"{np.count_nonzero(behind)} points ran back by up to {behind.max():.3g}")
    places, member, count = np.unique(x, return_inverse=True, return_counts=True)
    if len(places) < n:
        notes.append(f"{n - len(places)} points at a repeated coordinate: averaged")
    return places, np.bincount(member, y) / count, notes
