"""The digest of a run: 64 hexadecimal digits that stand for every bit of its state and history."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Numbers


def run_digest(saved: Mapping[str, Any], history: Mapping[str, Floats]) -> str:
    """Return the SHA-256 of the tables of a state and of a history.

    In the order of their names; of each its name, shape and numbers, as little-endian doubles or
    64-bit integers, or its texts. All that is not a number counts as the same. The state is that of
    :meth:`Simulation.saved`.
    """
    digest = hashlib.sha256()
    for name, rows in _tables("", {"history": history, "run": saved}):
        digest.update(f"{name} {rows.shape}\n".encode())
        digest.update(_bytes_of(rows))
    return digest.hexdigest()


def _tables(name: str, content: Any) -> Iterator[tuple[str, Numbers]]:
    if not isinstance(content, Mapping):
        yield name, np.asarray(content)
        return
    for key in sorted(content):
        yield from _tables(f"{name}/{key}", content[key])


def _bytes_of(rows: Numbers) -> bytes:
    if rows.dtype.kind == "f":
        numbers = rows.astype("<f8")
        numbers[np.isnan(numbers)] = np.nan  # its sign has no meaning
        return numbers.tobytes()
    if rows.dtype.kind in "biu":
        return rows.astype("<i8").tobytes()
    return "\n".join(map(str, rows.ravel())).encode()
