"""Several threads for large films, one for small ones.

A step of a small film takes less time than distributing its parts, so threads are used only above a
size; the caller may ask for a number. Results do not depend on it: the work is divided in the same
manner for any number of threads. Plain Python threads suffice, because kernels release the
interpreter's lock. Numba's own pools cost up to fifty microseconds per region, and one of them
becomes a hundred times slower when other programs use the cores.
"""

from __future__ import annotations

import logging
import os
from concurrent.futures import ThreadPoolExecutor
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats

from .jit import BoundOnce

NODE_CHUNK = 16_384
"""Nodes per chunk of a loop over nodes. The sums of the chunks are added in their order, whichever
thread computed them, so this number affects the last digits of results."""

_PAYS_FROM = 50_000
"""Number of quads from which a second thread helps: a step then takes over a millisecond."""
_MOST = 8

Threads: TypeAlias = Annotated[
    int | None,
    Option(
        "",
        "threads of a run; results do not depend on their number",
        least=1,
        most=256,
        why="more threads than cores slow a run down",
        unset="one for a small film, otherwise all cores, 8 at most",
    ),
]

_log = logging.getLogger(__name__)


def in_order(sums: Floats) -> list[float]:
    """Return the totals of sums : (n_part, n), with the parts added in order."""
    # With one part, skip NumPy's reduction, which takes 2 µs within a step.
    row: list[float] = (sums[0] if len(sums) == 1 else np.add.reduce(sums)).tolist()
    return row


def available_cores() -> int:
    """Return the cores this process may use."""
    try:
        return len(os.sched_getaffinity(0))
    except AttributeError:  # macOS and Windows have no affinity
        return os.cpu_count() or 1


@checked
class Workers:
    """Run the parts of a loop in parallel.

    More threads than cores are accepted with a warning: they slow a run down.

    Parameters
    ----------
    n_quad : int
        Size of the film.
    """

    def __init__(self, n_quad: int, threads: Threads = None) -> None:
        if threads is not None and threads > available_cores():
            _log.warning(
                "%d threads share %d cores: the run is slower than with one thread per core",
                threads,
                available_cores(),
            )
        if threads is None:
            threads = min(_MOST, available_cores()) if n_quad >= _PAYS_FROM else 1
        self.count = threads
        """Number of threads."""
        self._pool = ThreadPoolExecutor(threads - 1) if threads > 1 else None

    def run(self, kernel: BoundOnce[None], *arguments: object) -> None:
        """Call ``kernel(k, count, *arguments)`` for k = 0, 1, ... count - 1, and wait for all.

        Each on a thread; it treats every ``count``-th chunk from the k-th on.
        """
        if self._pool is None:
            kernel.code(0, 1, *arguments)
            return
        part, count = kernel, self.count
        others = [self._pool.submit(part, k, count, *arguments) for k in range(1, count)]
        part(0, count, *arguments)
        for other in others:
            other.result()
