"""Functions that kernels call without inlining them, and tables that are lent to these."""

import gc
import sys
from typing import Annotated, NamedTuple

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from shellcut.arrays import Floats
from shellcut.numerics.borrowed import borrowed, lent
from shellcut.numerics.jit import always_inline, apart, kernel
from shellcut.numerics.processor import not_inlined, seldom


class Rods(NamedTuple):
    """A table."""

    length: Annotated[Floats, "(n,)"]
    force: Annotated[Floats, "(n,)"]


@apart
def _work(rods, k, factor):
    not_inlined()
    rods = borrowed(rods)
    return factor * rods.length[k] * rods.force[k]


@kernel
def _add(rods: Rods, factor: float, total: Floats) -> None:
    rods = borrowed(rods)
    address = lent(rods)
    for k in range(rods.length.size):
        if seldom(rods.force[k] > 2.5):
            total[1] += 1.0
        # By address, and as a table of its own.
        total[0] += _work(address, k, factor) + _work(rods, k, factor)


def test_a_lent_table_is_read_where_it_lies():
    rods = Rods(np.array([1.0, 2.0, 4.0]), np.array([3.0, 2.0, 1.0]))
    total = np.zeros(2)
    for _ in range(3):
        _add(rods, 0.5, total)
    assert total.tolist() == [33.0, 3.0]


def test_python_gets_an_error():
    if hasattr(_work, "py_func"):
        with pytest.raises(TypeError, match="Python cannot call"):
            _work(Rods(np.ones(1), np.ones(1)), 0, 1.0)


@always_inline
def _row(table, k):
    return table[k]


@always_inline
def _made(n):
    return np.ones(n)[n - 1]


@kernel
def _sum_of_rows(table: Floats) -> float:
    total = 0.0
    for k in range(table.shape[0]):
        total += _row(table, k)[0]
    return total


@kernel
def _from_made(n: int) -> float:
    return _made(n)


def test_an_inlined_function_that_returns_an_array_counts_its_references():
    table = np.arange(12.0).reshape(6, 2)
    before = sys.getrefcount(table)
    for _ in range(5):
        assert _sum_of_rows(table) == 30.0
    assert sys.getrefcount(table) == before


@always_inline
def _if_asked(table, asked):
    if asked:
        return table
    return None


@kernel
def _twice_read(n: int, asked: bool) -> float:
    table = np.ones(n)
    row = _if_asked(table, asked)
    if row is None:
        return 0.0
    return row[0] + table[n - 1]


@pytest.fixture
def no_collection():
    """Arrays of earlier tests that wait for the collector are freed before, not during the test."""
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("no_collection")
def test_an_inlined_function_that_makes_or_may_return_an_array_frees_it():
    _nrt_python.memsys_enable_stats()
    before = rtsys.get_allocation_stats()
    for n in range(100, 200):
        assert _from_made(n) == 1.0
        assert _twice_read(n, True) == 2.0
        assert _twice_read(n, False) == 0.0
    after = rtsys.get_allocation_stats()
    assert after.alloc - before.alloc == after.free - before.free >= 300
