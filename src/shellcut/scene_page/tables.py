"""Tables that change from frame to frame, packed for a page.

Every frame has one table of integers, its rows the entities (nodes, quads, cables), which may be
more or fewer in the next. A table is packed as the difference to the frame before, of the rows that
both have, column after column: the film moves little between two frames, so nearly all bytes are
zero. Negative differences are folded between the positive ones (0, -1, 1, -2, ...), the low bytes
of a frame come before its high bytes, and zlib takes the rest. ``tables.js`` unpacks them.
"""

from __future__ import annotations

import base64
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats, Ints

_LEVEL = 7  # of zlib
_LARGEST = 65535

Unsigned = npt.NDArray[Any]


@dataclass(frozen=True)
class PackedTable:
    """One table of all frames."""

    columns: int
    rows: list[int]
    """Number of rows in every frame."""
    bytes: int
    """Of a number, 2 or 4."""
    low: list[float]
    """Value of the integer 0, column by column; empty for ids."""
    step: list[float]
    """Value of a difference of 1, column by column; empty for ids."""
    data: str
    """The packed bytes in base64."""

    def described(self) -> dict[str, Any]:
        """Return what unpacking needs beside the data."""
        return {name: value for name, value in vars(self).items() if name != "data"}


def pack_ids(tables: Sequence[Ints]) -> PackedTable:
    """Pack integers from 0 on, exactly; one table, shape (n_row, n_column), for each frame.

    A table of fewer columns than the others repeats its last one.
    """
    columns = max(table.shape[1] for table in tables)
    largest = max((int(table.max()) for table in tables if table.size), default=0)
    kind: Any = np.uint16 if largest <= _LARGEST else np.uint32
    whole = [
        np.pad(table, ((0, 0), (0, columns - table.shape[1])), mode="edge").astype(kind)
        if len(table)
        else np.zeros((0, columns), kind)
        for table in tables
    ]
    return _packed(whole, [], [])


def pack_numbers(tables: Sequence[Floats]) -> PackedTable:
    """Pack numbers in 65,536 steps over the range of their column: exact to half a step."""
    filled = [table for table in tables if len(table)] or [np.zeros((1, tables[0].shape[1]))]
    low = np.min([table.min(axis=0) for table in filled], axis=0).astype(float)
    high = np.max([table.max(axis=0) for table in filled], axis=0).astype(float)
    step = (high - low) / _LARGEST
    step[step == 0.0] = 1.0
    whole = [np.rint((table - low) / step).astype(np.uint16) for table in tables]
    return _packed(whole, low.tolist(), step.tolist())


def _packed(tables: Sequence[Unsigned], low: list[float], step: list[float]) -> PackedTable:
    n_byte, columns = tables[0].dtype.itemsize, tables[0].shape[1]
    packer = zlib.compressobj(_LEVEL)
    parts = []
    before = tables[0][:0]
    for table in tables:
        common = min(len(before), len(table))
        change = table.copy()
        change[:common] -= before[:common]  # wraps, and so does the sum that unpacks it
        parts.append(packer.compress(_planes(change)))
        before = table
    parts.append(packer.flush())
    data = base64.b64encode(b"".join(parts)).decode("ascii")
    return PackedTable(columns, [len(table) for table in tables], n_byte, low, step, data)


def _planes(change: Unsigned) -> bytes:
    """Return the folded numbers, column after column, all low bytes before all high bytes."""
    n_byte = change.dtype.itemsize
    signed = np.ascontiguousarray(change.T).ravel().astype(f"<u{n_byte}").view(f"<i{n_byte}")
    folded = (signed << 1) ^ (signed >> (8 * n_byte - 1))
    return np.ascontiguousarray(folded.view(np.uint8).reshape(-1, n_byte).T).tobytes()
