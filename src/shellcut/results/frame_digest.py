"""Digests of the frames in a result file, which reveal damage.

Each frame has two 32-bit CRCs (zlib): one of its row (time, coordinate, values, pose, counts,
positions of its arrays, names and units) and one of its arrays. They are computed from the numbers
as a reader gets them, and so cover everything in between: data, shapes of the columns, and the
index of their chunks, which HDF5 itself does not protect.
"""

from __future__ import annotations

import zlib
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

DIGESTS = "crc32"
"""Column of the digests of row and arrays, beside VTK's own columns."""

PLACES = (
    "PartOffsets",
    "NumberOfParts",
    "PointOffsets",
    "CellDataOffsets/part",
    "CellOffsets",
    "ConnectivityIdOffsets",
    "FieldDataOffsets/time [s]",
    "FieldDataSizes/time [s]",
)
"""Columns of ``Steps`` with the positions of a frame's arrays."""

SIZES = ("NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds")
"""Columns with the lengths of the parts."""


def digest_of_arrays(arrays: Mapping[str, Any]) -> int:
    """Return the digest of named arrays, in any order; their types are included."""
    crc = 0
    for name in sorted(arrays):
        rows = np.ascontiguousarray(arrays[name])
        crc = zlib.crc32(f"{name}{rows.dtype.str}{rows.shape}".encode(), crc)
        crc = zlib.crc32(rows.reshape(-1).view(np.uint8).data, crc)
    return crc


def digest_of_row(description: str, numbers: Iterable[float], places: Iterable[int]) -> int:
    """Return the digest of a frame's row, of its :func:`described` names and units.

    The numbers are time, the series in the order of their names, pose; the places are the counts,
    then the values of :data:`PLACES` and :data:`SIZES`.
    """
    crc = zlib.crc32(description.encode())
    crc = zlib.crc32(np.array([*numbers], "<f8").tobytes(), crc)
    return zlib.crc32(np.array([*places], "<i8").tobytes(), crc)


def described(attributes: Mapping[str, Any], series_names: Iterable[str]) -> str:
    """Return version, names and units of a result file as one text, from its attributes."""
    texts = [str(attributes["version"])]
    for name in ("coordinate", "scalar_names", "scalar_units"):
        texts += [name, *map(str, attributes[name])]
    return "\n".join([*texts, *sorted(series_names)])


def damaged_row(root: Any, beside: Any, n_frame: int) -> int | None:
    """Return the first of the frames whose row has changed since it was written, None if none.

    ``root`` and ``beside`` are VTK's group of the file and the library's own.
    """
    if not n_frame:
        return None
    steps, series = root["Steps"], root["FieldData"]
    description = described(beside.attrs, series)

    def rows(column: Any) -> Any:
        return column[:n_frame].reshape(n_frame, -1)

    part = rows(steps["PartOffsets"])[:, 0]
    sizes = [root[name][()][part][:, None] for name in SIZES]
    places = [rows(beside["counts"]), *(rows(steps[name]) for name in PLACES), *sizes]
    numbers = [rows(steps["Values"]), *(rows(series[name]) for name in sorted(series))]
    table = np.concatenate([*numbers, rows(beside["pose"])], axis=1)
    where = np.concatenate(places, axis=1)
    rows_of_both = zip(table.tolist(), where.tolist(), strict=True)
    now = np.array([digest_of_row(description, *row) for row in rows_of_both], np.uint32)
    wrong = np.flatnonzero(beside[DIGESTS][:n_frame, 0] != now)
    return int(wrong[0]) if wrong.size else None
