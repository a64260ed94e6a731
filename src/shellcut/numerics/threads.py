"""Two or more threads for large films, one for the others.

A step of a small film is shorter than handing its parts out would take, so threads are used only
above a size; the caller may ask for a number. Results do not depend on it: who divides the work
divides it the same way for any number of threads. Plain Python threads serve, because kernels
release the interpreter's lock: Numba's own pools cost up to fifty microseconds a region, and one of
them slows down by a hundred when other programs want the cores.
"""

from __future__ import annotations

import logging
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import numpy as np

from shellcut.arrays import Floats

NODE_CHUNK = 16_384
"""Nodes that one part of a loop over nodes takes. Sums over a chunk are added in the order of the
chunks, whichever thread computed them, so the number belongs to the result."""

_PAYS_FROM = 50_000
"""Quads from which on a second thread pays: a step then takes over a millisecond."""
_MOST = 8
_LARGEST = 256
"""Threads that may be asked for: more than a film keeps busy, and than any system starts gladly."""

_log = logging.getLogger(__name__)


def in_order(sums: Floats) -> list[float]:
    """Return the totals of sums : (n_part, n), the parts added in their order."""
    # A film of one part is not worth a call of NumPy's reduction, 2 µs amid a step.
    row: list[float] = (sums[0] if len(sums) == 1 else np.add.reduce(sums)).tolist()
    return row


def available_cores() -> int:
    """Return the cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS and Windows do not know affinity
        return os.cpu_count() or 1


class Workers:
    """Run the parts of a loop side by side.

    Parameters
    ----------
    n_quad : int
        Size of the film.
    threads : int, optional
        How many threads, at most 256; by default one for a small film, else the cores there are,
        at most eight. More than there are cores are taken as told, which is said: they slow a run
        down.

    Raises
    ------
    ValueError
        If ``threads`` is not a whole number from 1 to 256.
    """

    def __init__(self, n_quad: int, threads: int | None = None) -> None:
        if threads is not None and not (isinstance(threads, int) and 1 <= threads <= _LARGEST):
            raise ValueError(
                f"threads must be a whole number from 1 to {_LARGEST}, or None, got {threads!r}; "
                f"more than the {available_cores()} cores there are here slow a run down"
            )
        if threads is not None and threads > available_cores():
            _log.warning(
                "%d threads share %d cores: the run is slower than with as many as there are",
                threads,
                available_cores(),
            )
        if threads is None:
            threads = min(_MOST, available_cores()) if n_quad >= _PAYS_FROM else 1
        self.count = threads
        """Number of threads."""
        self._pool = ThreadPoolExecutor(threads - 1) if threads > 1 else None

    def run(self, part: Callable[[int], None]) -> None:
        """Call ``part`` with 0, 1, ... count - 1, each on a thread, and wait for all."""
        if self._pool is None:
            part(0)
            return
        others = [self._pool.submit(part, k) for k in range(1, self.count)]
        part(0)
        for other in others:
            other.result()
