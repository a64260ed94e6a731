"""The tables of a run, CSV files with units in their headers: its time histories, its splits.

Each row of the histories is flushed: a killed run leaves complete lines, because each line goes to
the operating system in one piece before `HistoryWriter.append` returns. Any spreadsheet reads the
files, and so does one line of NumPy. Numbers have the fewest digits that give the same double back.
"""

from __future__ import annotations

import csv
import os
from collections.abc import Iterable, Mapping, Sequence
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.files.regular_file import read_regular
from shellcut.files.text_content import in_one_form
from shellcut.files.whole_file import atomic_write, opened, write_all

if TYPE_CHECKING:
    from shellcut.state import SplitRecord

_FORBIDDEN = ',"[]\r\n'
_SHOWN_BYTES = 120  # part of a foreign file's first line quoted in an error message


_OF_SPLITS: dict[str, tuple[str, type]] = {
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


def _header(columns: Iterable[tuple[str, str]]) -> list[str]:
    return [f"{name} [{unit}]" for name, unit in columns]


def _parse_header(line: str, path: Path) -> list[tuple[str, str]]:
    columns = []
    for cell in line.split(","):
        name, bracket, unit = cell.partition(" [")
        if not bracket or not unit.endswith("]"):
            raise ValueError(
                f"{path} is not a history file: its header must be 'name [unit],...', "
                f"got {cell[:_SHOWN_BYTES]!r}"
            )
        columns.append((name, unit[:-1]))
    return columns


class HistoryWriter:
    """Write rows of named numbers to a CSV file, e.g. ``time [s],angle [deg],torque [N*mm]``.

    Parameters
    ----------
    path : str or Path
        The file.
    columns : sequence of (name, unit)
        Names and units in the order of the columns; ``"-"`` is the unit of a pure number.
    until : float, optional
        Appends to the file of an interrupted run: an unfinished last line is dropped, and the rows
        whose first column exceeds this, in its unit; a row must have just this, unless it is
        infinite. Without it a file that is there is replaced.

    Raises
    ------
    ValueError
        If a name or unit is invalid in the header, or the file to append to has other columns or
        lacks rows.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        columns: Sequence[tuple[str, str]],
        *,
        until: float | None = None,
    ) -> None:
        self.path = Path(path)
        self.columns = tuple((str(name), str(unit)) for name, unit in columns)
        self._names = tuple(name for name, _ in self.columns)
        self._check_columns()
        if until is None:
            self._file: BinaryIO = opened(self.path, "w")
            write_all(self._file, (",".join(_header(self.columns)) + "\n").encode())
        else:
            kept = self._kept_bytes(until)
            self._file = opened(self.path, "r+")
            self._file.truncate(kept)
            self._file.seek(kept)

    def __enter__(self) -> HistoryWriter:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def append(self, row: Mapping[str, float]) -> None:
        """Write one row, by the names of the columns.

        After an OSError, of a full disk, part of the row may have been written, which is dropped
        when the file is reopened.
        """
        line = ",".join(repr(float(row[name])) for name in self._names) + "\n"
        write_all(self._file, line.encode("ascii"))

    def sync(self) -> None:
        """Wait until all rows are on the disk; OSError if that fails."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()

    def _check_columns(self) -> None:
        if not self.columns:
            raise ValueError("columns must name at least one (name, unit)")
        if len(set(self._names)) != len(self._names):
            twice = sorted({name for name in self._names if self._names.count(name) > 1})
            raise ValueError(f"columns must differ in name, {twice} come twice")
        for text in (text for column in self.columns for text in column):
            if not text or text != text.strip() or any(c in _FORBIDDEN for c in text):
                raise ValueError(
                    f"a column's name and unit must be non-empty, without outer blanks and "
                    f"without any of {_FORBIDDEN!r}, got {text!r}"
                )

    def _kept_bytes(self, until: float) -> int:
        lines = read_regular(self.path).splitlines(keepends=True)
        if lines and not lines[-1].endswith(b"\n"):
            lines.pop()
        found = lines[0].decode(errors="replace").rstrip("\r\n") if lines else ""
        if found != ",".join(_header(self.columns)):
            raise ValueError(
                f"{self.path} has other columns than this run: {found[:_SHOWN_BYTES]!r}; "
                "move it away or start anew"
            )
        at = [-np.inf, *(float(line.split(b",", 1)[0]) for line in lines[1:])]
        while at[-1] > until:
            at.pop()
        require_all(self.path, at[-1], until)
        return sum(map(len, lines[: len(at)]))


def require_all(path: Path, last: float, until: float) -> None:
    """Refuse the file of an interrupted run that ends before its checkpoint [s].

    Raises
    ------
    ValueError
        If it does; as after a power cut, or when an older copy has been put there.
    """
    if last < until < np.inf:
        end = f"ends at {last:.6g} s" if np.isfinite(last) else "is empty"
        raise ValueError(
            f"{path} must reach to the checkpoint, that is to {until:.6g} s, but {end}; run it "
            "from the beginning"
        )


def read_history(path: str | os.PathLike[str]) -> tuple[dict[str, Floats], dict[str, str]]:
    """Return the columns of a history file and their units, both by name.

    Parameters
    ----------
    path : str or Path
        A file of `HistoryWriter`, from a finished, killed or running run.

    Returns
    -------
    columns : dict of ndarray, shape (n_row,)
        The columns in the order of the file, each in its unit.
    units : dict of str
        Their units.

    Raises
    ------
    ValueError
        If the header is not ``name [unit],...`` or a line has another number of cells.
    """
    path = Path(path)
    lines = in_one_form(read_regular(path)).decode().split("\n")
    # After the last line break there is nothing, or an unfinished line.
    header, rows = lines[0].rstrip("\r"), lines[1:-1]
    columns = _parse_header(header, path)
    for i, row in enumerate(rows):
        n_cell = row.count(",") + 1
        if n_cell != len(columns):
            wrong = f"must have {len(columns)} numbers, got {n_cell}"
            raise ValueError(f"{path}, line {i + 2}: {wrong}")
    cells = chain.from_iterable(row.split(",") for row in rows)
    table = np.fromiter(map(float, cells), float).reshape(-1, len(columns))
    values = {name: table[:, k].copy() for k, (name, _) in enumerate(columns)}
    return values, dict(columns)


def write_splits(path: Path, splits: Iterable[SplitRecord]) -> None:
    """Write one row per split, in order."""
    with atomic_write(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(_header((name, unit) for name, (unit, _) in _OF_SPLITS.items()))
        for s in splits:
            row = (s.time, s.node, s.twin, s.kind, s.measure, s.force_jump)
            pierced = (s.edge + 1, s.force, s.depth, s.work)
            table.writerow([*row, *s.place, *s.reference, *s.end, *pierced])


def read_splits(path: Path) -> tuple[dict[str, npt.NDArray[Any]], dict[str, str]]:
    """Return the columns, each of shape (n_split,), and their units; empty without a file."""
    if not path.exists():
        return {}, {}
    header, *rows = csv.reader(in_one_form(read_regular(path)).decode().splitlines())
    columns: dict[str, npt.NDArray[Any]] = {}
    units: dict[str, str] = {}
    cells = zip(*rows, strict=True) if rows else [()] * len(header)
    for heading, column in zip(header, cells, strict=True):
        name, _, unit = heading.rstrip("]").partition(" [")
        _, kind = _OF_SPLITS.get(name, ("", float))
        columns[name], units[name] = np.array(column, dtype=kind), unit
    return columns, units
