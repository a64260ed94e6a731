"""``splits.csv``: time, place and force jump of every split of a run."""

from __future__ import annotations

import csv
from collections.abc import Iterable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from shellcut.files.regular_file import read_regular
from shellcut.files.whole_file import atomic_write

if TYPE_CHECKING:
    from shellcut.state import SplitRecord

_COLUMNS: dict[str, tuple[str, type]] = {
    "time": ("s", float),
    "node": ("-", int),
    "twin": ("-", int),
    "kind": ("-", str),
    "measure": ("-", float),
    "force_jump": ("N", float),
    **dict.fromkeys(("x", "y", "z", "X", "Y", "Z", "X_end", "Y_end", "Z_end"), ("mm", float)),
    "edge": ("-", int),
    "force": ("N", float),
    "depth": ("mm", float),
    "work": ("N*mm", float),
}
"""Unit and type of every column; x, y, z in space, X, Y, Z in the reference. The last four are
those of a puncture: cutting edge from 1, 0 for none, and :class:`~shellcut.state.SplitRecord`."""


def write_splits(path: Path, splits: Iterable[SplitRecord]) -> None:
    """Write one row per split, in order."""
    with atomic_write(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow([f"{name} [{unit}]" for name, (unit, _) in _COLUMNS.items()])
        for s in splits:
            row = (s.time, s.node, s.twin, s.kind, s.measure, s.force_jump)
            pierced = (s.edge + 1, s.force, s.depth, s.work)
            table.writerow([*row, *s.place, *s.reference, *s.end, *pierced])


def read_splits(path: Path) -> tuple[dict[str, npt.NDArray[Any]], dict[str, str]]:
    """Return the columns, each of shape (n_split,), and their units; empty without a file."""
    if not path.exists():
        return {}, {}
    header, *rows = csv.reader(read_regular(path).decode().splitlines())
    columns: dict[str, npt.NDArray[Any]] = {}
    units: dict[str, str] = {}
    cells = zip(*rows, strict=True) if rows else [()] * len(header)
    for heading, column in zip(header, cells, strict=True):
        name, _, unit = heading.rstrip("]").partition(" [")
        _, kind = _COLUMNS.get(name, ("", float))
        columns[name], units[name] = np.array(column, dtype=kind), unit
    return columns, units
