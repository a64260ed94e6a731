"""The limits of this machine: clock, peak of the fused multiply-add, memory bandwidth.

Peak: sixteen independent accumulators (twelve where there are only sixteen registers), each a
vector of the full lane width, ``a <- a x + y``, written as LLVM vectors by a Numba intrinsic, so
that no auto-vectoriser decides. One such instruction counts two flops a lane.

Clock: a chain of dependent additions and exclusive-ors of registers, one cycle each on every
machine of today. Where wide vectors lower the clock, flops a cycle come out below the whole number.

Bandwidth: triad ``a = b + s c`` as STREAM counts it, 24 bytes a row: one write, two reads, no
write-allocate. The arrays are touched first by the thread that uses them.
"""

from __future__ import annotations

import os
import platform
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import Any

import llvmlite.binding as llvm
import llvmlite.ir as ir
import numba as nb
import numpy as np
from numba.core import cgutils, types
from numba.extending import intrinsic

_TRIAD_BYTES = 24
_LEAST_CACHE = 32 * 2**20  # assumed where the system does not say


@dataclass(frozen=True)
class Machine:
    """What was measured of the machine."""

    cpu: str
    lanes: int
    """Doubles in a vector."""
    clock_ghz: float
    peak_gflops: float
    """Of one core."""
    peak_gflops_2: float | None
    """Of two threads together; twice the peak if they stand on cores of their own."""
    triad_gbytes: float
    triad_gbytes_2: float | None
    triad_array_mbytes: float
    """Size of each of the three arrays."""
    cache_mbytes: float
    """Last level."""
    n_core: int

    @property
    def flops_a_cycle(self) -> float:
        """Peak over clock."""
        return self.peak_gflops / self.clock_ghz


def n_lanes() -> int:
    """Return the doubles in the widest vector of this CPU that Numba compiles for."""
    features = getattr(nb.config, "CPU_FEATURES", None)
    flags = (
        {name for name, on in llvm.get_host_cpu_features().items() if on}
        if features is None
        else {name[1:] for name in features.split(",") if name.startswith("+")}
    )
    if "avx512f" in flags:
        return 8
    return 4 if {"avx", "fma"} <= flags else 2


def n_core() -> int:
    """Return the cores this process may use."""
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


LANES = n_lanes()
_ACCUMULATORS = 16 if LANES == 8 else 12


@intrinsic
def _fma_rounds(typing_context: Any, rounds: Any, x: Any, y: Any) -> Any:
    """Apply ``rounds`` rounds of a <- a x + y to all accumulators; return their sum."""
    signature = types.float64(types.int64, types.float64, types.float64)

    def generate(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        count, *factors = arguments
        vector = ir.VectorType(ir.DoubleType(), LANES)

        def spread(scalar: Any) -> Any:
            filled = ir.Constant(vector, ir.Undefined)
            for lane in range(LANES):
                filled = builder.insert_element(filled, scalar, ir.Constant(ir.IntType(32), lane))
            return filled

        fma = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(vector, [vector] * 3), f"llvm.fma.v{LANES}f64"
        )
        x, y = (spread(factor) for factor in factors)
        cells = [cgutils.alloca_once(builder, vector) for _ in range(_ACCUMULATORS)]
        for k, cell in enumerate(cells):
            # Unlike starts, or the compiler would see that all accumulators are one.
            builder.store(ir.Constant(vector, [float(k + 1)] * LANES), cell)
        with cgutils.for_range(builder, count):
            for cell in cells:
                builder.store(builder.call(fma, [builder.load(cell), x, y]), cell)
        total = ir.Constant(ir.DoubleType(), 0.0)
        for cell in cells:
            value = builder.load(cell)
            for lane in range(LANES):
                part = builder.extract_element(value, ir.Constant(ir.IntType(32), lane))
                total = builder.fadd(total, part)
        return total

    return signature, generate


@nb.njit(nogil=True)
def _multiply_add(rounds: int, x: float, y: float) -> float:
    total: float = _fma_rounds(rounds, x, y)
    return total


@nb.njit(nogil=True)
def _dependent_chain(rounds: int, a: int, b: int) -> int:
    """Run sixteen dependent instructions of one cycle a round."""
    x = a
    for _ in range(rounds):
        x = (x + a) ^ b
        x = (x + a) ^ b
        x = (x + a) ^ b
        x = (x + a) ^ b
        x = (x + a) ^ b
        x = (x + a) ^ b
        x = (x + a) ^ b
        x = (x + a) ^ b
    return x


@nb.njit(nogil=True)
def _triad(a: Any, b: Any, c: Any, s: float) -> None:
    for i in range(a.size):
        a[i] = b[i] + s * c[i]


@nb.njit(nogil=True)
def _touch(a: Any, value: float) -> None:
    for i in range(a.size):
        a[i] = value


def _seconds(work: Callable[[], object]) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


def clock_ghz(rounds: int = 2_000_000, repeats: int = 10) -> float:
    """Return the clock by the best of some runs [GHz]."""
    _dependent_chain(1, 3, 5)
    best = min(_seconds(lambda: _dependent_chain(rounds, 3, 5)) for _ in range(repeats))
    return 16 * rounds / best * 1e-9


def fma_peak(threads: int = 1, rounds: int = 1_000_000, repeats: int = 20) -> float:
    """Return the best multiply-add rate of some runs, all threads together [GFlop/s]."""
    work = [partial(_multiply_add, rounds, 0.999999, 1e-6)] * threads
    _multiply_add(1, 0.5, 0.5)
    best = min(_together(work) for _ in range(repeats))
    return 2 * LANES * _ACCUMULATORS * rounds * threads / best * 1e-9


def triad(threads: int, array_bytes: int, repeats: int = 5) -> float:
    """Return the best triad rate of some runs, all threads together [GB/s]."""
    rows = array_bytes // 8
    a, b, c = (np.empty(rows) for _ in range(3))
    cuts = np.linspace(0, rows, threads + 1).astype(int)
    parts = [slice(low, high) for low, high in pairwise(cuts.tolist())]

    def first_touch(part: slice) -> None:
        for array in (a, b, c):
            _touch(array[part], 1.0)

    _together([partial(first_touch, part) for part in parts])
    work = [partial(_triad, a[part], b[part], c[part], 3.0) for part in parts]
    best = min(_together(work) for _ in range(repeats))
    return _TRIAD_BYTES * rows / best * 1e-9


def _together(work: Sequence[Callable[[], object]]) -> float:
    """Run each piece of work on a thread of its own; return the time until all are done [s]."""
    if len(work) == 1:
        return _seconds(work[0])
    ready = threading.Barrier(len(work) + 1)

    def run(piece: Callable[[], object]) -> None:
        ready.wait()
        piece()

    threads = [threading.Thread(target=run, args=(piece,)) for piece in work]
    for thread in threads:
        thread.start()
    began = time.perf_counter()
    ready.wait()
    for thread in threads:
        thread.join()
    return time.perf_counter() - began


def last_level_cache() -> int:
    """Return the size of the last level of cache as the system gives it [bytes]."""
    sizes = [_LEAST_CACHE]
    for path in Path("/sys/devices/system/cpu/cpu0/cache").glob("index*/size"):
        text = path.read_text().strip()
        if text.endswith("K"):
            sizes.append(int(text[:-1]) * 2**10)
    return max(sizes)


def cpu_name() -> str:
    """Return the CPU's name as the system gives it."""
    try:
        for line in Path("/proc/cpuinfo").read_text().splitlines():
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def measure(*, array_bytes: int | None = None, rounds: int = 1_000_000) -> Machine:
    """Measure everything; arrays of twice the last-level cache unless told otherwise."""
    cache = last_level_cache()
    size = array_bytes or 2 * cache
    two = n_core() > 1
    return Machine(
        cpu=cpu_name(),
        lanes=LANES,
        clock_ghz=clock_ghz(2 * rounds),
        peak_gflops=fma_peak(1, rounds),
        peak_gflops_2=fma_peak(2, rounds) if two else None,
        triad_gbytes=triad(1, size),
        triad_gbytes_2=triad(2, size) if two else None,
        triad_array_mbytes=size / 2**20,
        cache_mbytes=cache / 2**20,
        n_core=n_core(),
    )
