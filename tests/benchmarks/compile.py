"""Start-up: import, compilation on a machine's first run, and the second start.

Each figure comes from fresh processes. The compile cache is an empty folder for the first and is
used again for the second, which must find all it needs there: Numba's own counts of hits and misses
say so.
"""

from __future__ import annotations

import json
import statistics
import sys
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path

from benchmarks.harness import child


@dataclass(frozen=True)
class Start:
    """One process that imports the library and warms it up."""

    import_seconds: float
    numba_seconds: float
    """Of the import, what Numba's own takes."""
    warmup_seconds: float
    cache_hits: int
    cache_misses: int
    """Kernels that had to be compiled."""


@dataclass(frozen=True)
class Compilation:
    """First and later starts of the library."""

    cold: Start
    warm: Start
    import_seconds: float
    """Median over the processes after the first."""

    @property
    def recompiled(self) -> int:
        """Kernels that the second start compiled again."""
        return self.warm.cache_misses


def _start() -> Start:
    began = time.perf_counter()
    import numba  # noqa: F401

    numba_seconds = time.perf_counter() - began
    from shellcut import warmup

    import_seconds = time.perf_counter() - began
    began = time.perf_counter()
    warmup()
    warmup_seconds = time.perf_counter() - began
    hits, misses = _cache_counts()
    return Start(import_seconds, numba_seconds, warmup_seconds, hits, misses)


def _cache_counts() -> tuple[int, int]:
    """Return cache hits and misses of all kernels of the package that are meant to be cached."""
    from numba.core.caching import NullCache
    from numba.core.dispatcher import Dispatcher

    kernels = {
        id(thing): thing
        for name, module in list(sys.modules.items())
        if name.split(".")[0] == "shellcut"
        for thing in vars(module).values()
        if isinstance(thing, Dispatcher) and not isinstance(thing._cache, NullCache)
    }
    stats = [kernel.stats for kernel in kernels.values()]
    return (
        sum(sum(s.cache_hits.values()) for s in stats),
        sum(sum(s.cache_misses.values()) for s in stats),
    )


def measure(repeats: int = 3) -> Compilation:
    """Start once with an empty cache, then some times with the cache it left."""
    with tempfile.TemporaryDirectory() as folder:
        cold, *warm = (
            Start(**child("compile", cache=Path(folder))) for _ in range(1 + max(1, repeats))
        )
    by_time = sorted(warm, key=lambda start: start.warmup_seconds)
    return Compilation(
        cold=cold,
        warm=by_time[len(by_time) // 2],
        import_seconds=statistics.median(start.import_seconds for start in warm),
    )


if __name__ == "__main__":
    print(json.dumps(asdict(_start())))
