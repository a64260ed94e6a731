"""A table of poses as text, with units in its column headings.

::

    time [ms]; z [mm]; angle [deg]
    0,0;       0,0;    0
    0,5;       -0,02;  1,5

Separators, decimal commas and comments are those of :mod:`shellcut.formats.number_table`.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from shellcut.arrays import Floats
from shellcut.unit import conversion

from .errors import FileError
from .number_table import Heading, read_number_table

_COLUMNS = {
    "time": "s",
    **dict.fromkeys(("x", "y", "z"), "mm"),
    **dict.fromkeys(("rx", "ry", "rz", "angle"), "rad"),
}


def read_motion_csv(path: str | Path) -> tuple[Floats, Floats, Floats]:
    """Read times [s], translations [mm] and rotation vectors [rad], one row per time.

    The columns, in any order: ``time``; those of ``x``, ``y``, ``z`` that are not zero; ``rx``,
    ``ry``, ``rz`` (the rotation vector) or ``angle`` (the rotation about z). A heading is written
    ``time [ms]``, ``time (ms)`` or ``time / ms``; :mod:`shellcut.unit` lists the units.
    """
    table = read_number_table(path)
    if not table.headings:
        raise FileError(path, "a table must have a line of headings above its numbers")
    names, factors = _headings(table.path, table.heading_line, table.headings)
    if len(table.rows) < 2:
        raise FileError(
            path, f"a table must have two lines of numbers or more, got {len(table.rows)}"
        )
    rows = table.numbers(list(range(len(names))))
    column = dict(zip(names, (rows * factors).T, strict=True))
    none = np.zeros(len(rows))
    translations = np.stack([column.get(axis, none) for axis in ("x", "y", "z")], axis=1)
    turns = [column.get(axis, none) for axis in ("rx", "ry")]
    turns.append(column.get("angle", column.get("rz", none)))
    return column["time"].copy(), translations, np.stack(turns, axis=1)


def _headings(path: Path, line: int, headings: tuple[Heading, ...]) -> tuple[list[str], Floats]:
    names, factors, problems = [], [], []
    for heading in headings:
        name = heading.name.lower()
        if name not in _COLUMNS or not heading.unit:
            known = ", ".join(_COLUMNS)
            problems.append(f"a heading must be 'name [unit]' of {known}, got {heading.text!r}")
            continue
        try:
            factors.append(conversion(heading.unit, _COLUMNS[name]))
        except ValueError as problem:
            problems.append(f"{name} {problem}")
        if name in names:
            problems.append(f"each column must occur once, got {name} again")
        names.append(name)
    if not problems and "time" not in names:
        problems.append("there must be a column time")
    if "angle" in names and {"rx", "ry", "rz"} & set(names):
        problems.append("the rotation must be given as angle or as rx, ry, rz, got both")
    if problems:
        raise FileError(path, "; ".join(problems), line=line)
    return names, np.array(factors)
