"""The tables of a run, CSV files with units in their headers: its time histories, its splits.

Each row of the histories is flushed: a killed run leaves complete lines, because each line goes to
the operating system in one piece before `HistoryWriter.append` returns. Any spreadsheet reads the
files, and so does one line of NumPy. Numbers have the fewest digits that give the same double back.
"""

from __future__ import annotations

import csv
import hashlib
import os
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, TypeAlias

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
"""Unit and type of every column of the splits; x, y, z in space, X, Y, Z in the reference. Cutting
edges count from 1, 0 is none. The last three are those of a puncture:
:class:`~shellcut.state.SplitRecord`."""


_Table: TypeAlias = tuple[dict[str, npt.NDArray[Any]], dict[str, str]]
"""The columns of a file and their units, by name."""


def _header(columns: Iterable[tuple[str, str]]) -> list[str]:
    return [f"{name} [{unit}]" for name, unit in columns]


@dataclass(frozen=True)
class Written:
    """What a history file has so far, as a checkpoint remembers it."""

    length: int = 0
    """Bytes of the header and of whole rows."""
    digest: str = ""
    """Their SHA-256, hexadecimal."""


class HistoryWriter:
    """Write rows of named numbers to a CSV file, e.g. ``time [s],angle [deg],torque [N*mm]``.

    Parameters
    ----------
    path : str or Path
        The file.
    columns : sequence of (name, unit)
        Names and units in the order of the columns; ``"-"`` is the unit of a pure number.
    kept : Written, optional
        Appends to the file of an interrupted run: what had been ``written`` until then stays, and
        must be there unchanged; all after it is dropped. Without it a file that is there is
        replaced.

    Raises
    ------
    ValueError
        If a name or unit is invalid in the header, or the file to append to has other columns,
        lacks rows or has been changed.
    """

    def __init__(
        self,
        path: str | os.PathLike[str],
        columns: Sequence[tuple[str, str]],
        *,
        kept: Written | None = None,
    ) -> None:
        self.path = Path(path)
        self.columns = tuple((str(name), str(unit)) for name, unit in columns)
        self._names = tuple(name for name, _ in self.columns)
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
        self._digest, self._length = hashlib.sha256(), 0
        if kept is None:
            self._file: BinaryIO = opened(self.path, "w")
            self._write((",".join(_header(self.columns)) + "\n").encode())
        else:
            self._take(self._kept_part(kept))
            self._file = opened(self.path, "r+")
            self._file.truncate(kept.length)
            self._file.seek(kept.length)

    @property
    def written(self) -> Written:
        """What the file has so far."""
        return Written(self._length, self._digest.hexdigest())

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
        self._write(line.encode("ascii"))

    def sync(self) -> None:
        """Wait until all rows are on the disk; OSError if that fails."""
        os.fsync(self._file.fileno())

    def close(self) -> None:
        """Close the file; a second call does nothing."""
        self._file.close()

    def _write(self, line: bytes) -> None:
        write_all(self._file, line)
        self._take(line)

    def _take(self, part: bytes) -> None:
        self._digest.update(part)
        self._length += len(part)

    def _kept_part(self, kept: Written) -> bytes:
        content = read_regular(self.path)
        found = content.partition(b"\n")[0].decode(errors="replace").rstrip("\r")
        if found != ",".join(_header(self.columns)):
            raise ValueError(
                f"{self.path} has other columns than this run: {found[:_SHOWN_BYTES]!r}; "
                "move it away or start anew"
            )
        part = content[: kept.length]
        anew = "put the file of that run back, or run it from the beginning"
        if len(part) < kept.length:
            raise ValueError(
                f"{self.path} must reach to the checkpoint, that is have {kept.length} bytes or "
                f"more, got {len(part)}; {anew}"
            )
        if hashlib.sha256(part).hexdigest() != kept.digest:
            where = ""
            try:
                _parsed(part, self.path)
            except ValueError as problem:
                where = f": {problem}"
            raise ValueError(
                f"{self.path} must be as it was at the checkpoint, but its first {kept.length} "
                f"bytes have been changed{where}; {anew}"
            )
        return part


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
        If the header is not ``name [unit],...``, a line has another number of cells, or a cell is
        no number: it names file, line and column.
    """
    path = Path(path)
    return _parsed(read_regular(path), path)


def _parsed(content: bytes, path: Path, kinds: Mapping[str, type] | None = None) -> _Table:
    """Return the table in a file that a run appends to; numbers are floats.

    Its last line may be unfinished. That of a file written at once, whose columns have ``kinds`` of
    their own, is whole.
    """
    *lines, last = in_one_form(content).decode(errors="backslashreplace").split("\n")
    if last and kinds is not None:
        lines.append(last)
    header, *rows = [line.rstrip("\r") for line in lines] or [last]
    columns = []
    for cell in header.split(","):
        name, bracket, unit = cell.partition(" [")
        if not bracket or not unit.endswith("]"):
            raise ValueError(
                f"{path}, line 1: must name the columns as 'name [unit],...', "
                f"got {cell[:_SHOWN_BYTES]!r}"
            )
        columns.append((name, unit[:-1]))
    for i, row in enumerate(rows):
        n_cell = row.count(",") + 1
        if n_cell != len(columns):
            raise ValueError(f"{path}, line {i + 2}: must have {len(columns)} cells, got {n_cell}")
    cells = zip(*(row.split(",") for row in rows), strict=True) if rows else [()] * len(columns)
    values = {
        name: _numbers(column, (kinds or {}).get(name, float), path, f"{name} [{unit}]")
        for (name, unit), column in zip(columns, cells, strict=True)
    }
    return values, dict(columns)


def _numbers(cells: Sequence[str], kind: Any, path: Path, heading: str) -> npt.NDArray[Any]:
    """Return the cells of a column as an array; ValueError names the first that is none."""
    try:
        return np.array([kind(cell) for cell in cells], dtype=kind)
    except (ValueError, OverflowError):
        for i, cell in enumerate(cells):
            try:
                np.array(kind(cell), dtype=kind)
            except (ValueError, OverflowError):
                words = "an integer" if kind is int else "a number"
                raise ValueError(
                    f"{path}, line {i + 2}, column {heading!r}: must be {words}, got "
                    f"{cell[:_SHOWN_BYTES]!r}"
                ) from None
        raise


def write_splits(path: Path, splits: Iterable[SplitRecord]) -> None:
    """Write one row per split, in order."""
    with atomic_write(path) as temporary, temporary.open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file)
        table.writerow(_header((name, unit) for name, (unit, _) in _OF_SPLITS.items()))
        for s in splits:
            row = [s.time, s.node, s.twin, s.kind, s.measure, s.force_jump]
            row += [*s.place, *s.reference, *s.end]
            table.writerow([*row, s.edge + 1, s.force, s.depth, s.work])


def read_splits(path: Path) -> _Table:
    """Return the columns, each of shape (n_split,), and their units; empty without a file."""
    if not path.exists():
        return {}, {}
    kinds = {name: kind for name, (_, kind) in _OF_SPLITS.items()}
    columns, units = _parsed(read_regular(path), path, kinds)
    if missing := [name for name in kinds if name not in columns]:
        raise ValueError(f"{path}, line 1: must name the columns of splits, lacks {missing[0]!r}")
    return columns, units
