"""A table of poses as text: columns with units in the header, commas, semicolons or tabs.

::

    time [ms]; z [mm]; angle [deg]
    0,0;       0,0;    0
    0,5;       -0,02;  1,5

A decimal comma is read where the columns are parted by semicolons or tabs. ``#`` begins a comment.
"""

from __future__ import annotations

import re
from math import pi
from pathlib import Path

import numpy as np

from shellcut._jit import Floats

from .errors import FileError, read_lines

_TIME = {"s": 1.0, "ms": 1e-3, "us": 1e-6}
_LENGTH = {"mm": 1.0, "um": 1e-3, "cm": 10.0, "m": 1000.0, "inch": 25.4}
_ANGLE = {"rad": 1.0, "deg": pi / 180.0, "turn": 2.0 * pi}
_COLUMNS = {
    "time": _TIME,
    **dict.fromkeys(("x", "y", "z"), _LENGTH),
    **dict.fromkeys(("rx", "ry", "rz", "angle"), _ANGLE),
}
_HEADING = re.compile(r"\s*\"?\s*([A-Za-z]+)\s*[\[(/]\s*([^\])\s]+)\s*[\])]?\s*\"?\s*")


def read_motion_csv(path: str | Path) -> tuple[Floats, Floats, Floats]:
    """Read times, translations and rotation vectors.

    The columns, in any order: ``time`` [s, ms, us]; of ``x``, ``y``, ``z`` [mm, um, cm, m, inch]
    those that are not zero; ``rx``, ``ry``, ``rz``, the rotation vector, or ``angle``, the turn
    about z [rad, deg, turn]. A heading is written ``time [ms]``, ``time (ms)`` or ``time / ms``.

    Returns
    -------
    times : ndarray, shape (n_time,), [s]
    translations : ndarray, shape (n_time, 3), [mm]
    rotation_vectors : ndarray, shape (n_time, 3), [rad]

    Raises
    ------
    FileError
        Naming the heading or the line that is not understood.
    """
    path = Path(path)
    lines = [
        (number, line)
        for number, text in enumerate(read_lines(path), start=1)
        if (line := text.split("#", 1)[0].strip().lstrip("\ufeff"))
    ]
    if not lines:
        raise FileError(path, "a table must have a line of headings")
    number, heading = lines[0]
    separator = next((s for s in (";", "\t") if s in heading), ",")
    names, factors = _headings(path, number, heading.split(separator))
    rows = [_row(path, number, line, separator, len(names)) for number, line in lines[1:]]
    if len(rows) < 2:
        raise FileError(path, f"a table must have two lines of numbers or more, got {len(rows)}")
    column = dict(zip(names, (np.array(rows) * factors).T, strict=True))
    none = np.zeros(len(rows))
    translations = np.stack([column.get(axis, none) for axis in ("x", "y", "z")], axis=1)
    turns = [column.get(axis, none) for axis in ("rx", "ry")]
    turns.append(column.get("angle", column.get("rz", none)))
    return column["time"].copy(), translations, np.stack(turns, axis=1)


def _headings(path: Path, line: int, cells: list[str]) -> tuple[list[str], Floats]:
    names, factors, problems = [], [], []
    for cell in cells:
        found = _HEADING.fullmatch(cell)
        name = found[1].lower() if found else ""
        if not found or name not in _COLUMNS:
            known = ", ".join(_COLUMNS)
            problems.append(f"a heading must be 'name [unit]' of {known}, got {cell.strip()!r}")
            continue
        units = _COLUMNS[name]
        if found[2] not in units:
            problems.append(f"{name} must be in {', '.join(units)}, got {found[2]!r}")
        if name in names:
            problems.append(f"each column must stand once, got {name} again")
        names.append(name)
        factors.append(units.get(found[2], 1.0))
    if not problems and "time" not in names:
        problems.append("there must be a column time")
    if "angle" in names and {"rx", "ry", "rz"} & set(names):
        problems.append("the turn must be given as angle or as rx, ry, rz, got both")
    if problems:
        raise FileError(path, "; ".join(problems), line=line)
    return names, np.array(factors)


def _row(path: Path, line: int, text: str, separator: str, n: int) -> list[float]:
    cells = text.split(separator)
    if len(cells) != n:
        raise FileError(path, f"there must be {n} numbers, got {len(cells)}", line=line)
    values = []
    for cell in cells:
        try:
            values.append(float(cell.strip().strip('"').replace(",", ".")))
        except ValueError:
            raise FileError(path, f"must be a number, got {cell.strip()!r}", line=line) from None
    return values
