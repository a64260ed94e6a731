"""Tables of arrays that kernels take: checked where a kernel is bound, read in place, let go."""

import gc
import sys
from typing import Annotated, NamedTuple

import numpy as np
import pytest
from numba.core.runtime import _nrt_python, rtsys

from shellcut.arrays import Bools, Floats, Ints, Numbers
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, always_inline, kernel
from shellcut.numerics.kernel_tables import check_tables
from shellcut.numerics.table_address import TableWriter


class Bars(NamedTuple):
    ends: Annotated[Ints, "(n_bar, 2)"]
    area: Annotated[Floats, "(n_bar,)"]
    force: Annotated[Floats, "(n_bar, 3)"]
    broken: Annotated[Bools, "(n_bar,)"]
    any_kind: Annotated[Numbers, "(n_any,)"]
    length: float
    unchecked: Floats


class Truss(NamedTuple):
    bars: Bars
    colour: Annotated[Floats, "(n_bar,)"]


def bars(**changed):
    right = {
        "ends": np.zeros((4, 2), np.int32),
        "area": np.zeros(4),
        "force": np.zeros((4, 3)),
        "broken": np.zeros(4, np.bool_),
        "any_kind": np.zeros(7, np.float32),
        "length": 1.0,
        "unchecked": np.zeros(2, np.int8),
    }
    return Bars(**(right | changed))


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (
            {"area": np.zeros((4, 3)), "force": np.zeros(4)},
            r"area must be an array of float64 of shape \(n_bar,\), got float64 of \(4, 3\)",
        ),
        ({"ends": np.zeros((4, 3), np.int64)}, r"ends .* shape \(n_bar, 2\), got int64 of"),
        ({"ends": np.zeros((4, 2))}, r"ends must be an array of integer"),
        ({"broken": np.zeros(4)}, r"broken must be an array of bool"),
        ({"any_kind": 2.0}, r"any_kind must be an array of shape \(n_any,\), got 2\.0"),
        ({"force": np.zeros((5, 3))}, r"force .* where n_bar is 4 in Bars\.ends, got float64"),
    ],
)
def test_an_array_in_the_wrong_place_is_named(changed, sentence):
    with pytest.raises(TypeError, match=rf"Bars\.{sentence}"):
        check_tables([bars(**changed)])


def test_a_length_is_the_same_in_every_table_of_a_call():
    for tables in ([Truss(bars=bars(), colour=np.zeros(5))], [bars(), Truss(bars(), np.zeros(5))]):
        with pytest.raises(TypeError, match=r"Truss\.colour .* n_bar is 4 in Bars\.ends"):
            check_tables(tables)


class Rods(NamedTuple):
    ends: Annotated[Ints, "(n_rod, 2)"]
    free: Annotated[Bools, "(n_rod,)"]
    pull: Annotated[Floats, "(n_rod,)"]
    """Written."""


class Frame(NamedTuple):
    heavy: bool
    """One byte before a table of pointers: its place must be that of the machine's layout."""
    rods: Rods
    count: int
    scale: float
    pair: tuple[float, float]


@kernel
def _sum_up(frame: Frame, step: float) -> float:
    frame = borrowed(frame)
    rods, total = frame.rods, frame.pair[1]
    for i in range(frame.count):
        if rods.free[i] and frame.heavy:
            total += frame.scale * rods.pull[i] * (rods.ends[i, 1] - rods.ends[i, 0])
        rods.pull[i] += step
    return total


def _frame() -> Frame:
    rods = Rods(
        ends=np.array([[0, 1], [3, 7], [2, 9]]),
        free=np.array([True, False, True]),
        pull=np.array([2.0, 3.0, 5.0]),
    )
    return Frame(heavy=True, rods=rods, count=3, scale=0.5, pair=(7.0, 11.0))


def test_borrowed_arrays_are_those_of_the_caller():
    """Read and written in place, and held as often after the call as before."""
    for sum_up in (_sum_up, getattr(_sum_up, "py_func", _sum_up)):
        frame = _frame()
        held = sys.getrefcount(frame.rods.pull), sys.getrefcount(frame.rods.ends)
        assert sum_up(frame, 1.0) == 11.0 + 0.5 * (2.0 + 5.0 * 7)
        assert frame.rods.pull.tolist() == [3.0, 4.0, 6.0]
        assert held == (sys.getrefcount(frame.rods.pull), sys.getrefcount(frame.rods.ends))


def test_a_table_address_keeps_its_arrays_alive():
    frame = _frame()
    address_of, call = TableWriter(), BoundOnce(_sum_up)
    address = address_of(frame)
    assert call(address, 1.0) == 11.0 + 0.5 * (2.0 + 5.0 * 7)
    assert frame.rods.pull.tolist() == [3.0, 4.0, 6.0]
    # Written from outside, it is read at the next call: the arrays are the same ones.
    frame.rods.pull[:] = 1.0
    grown = frame._replace(rods=Rods(*(np.repeat(rows, 2, axis=0) for rows in frame.rods)), count=6)
    assert call(address_of(grown), 0.0) == 11.0 + 2 * 0.5 * 8
    del frame, grown
    gc.collect()
    others = [np.full(3, 1e300) for _ in range(100)]
    assert call(address, 0.0) == 11.0 + 0.5 * 8
    assert len(others) == 100


def test_other_types_are_refused():
    address_of = TableWriter()
    frame = _frame()
    address_of(frame)
    single = frame.rods._replace(pull=frame.rods.pull.astype(np.float32))
    with pytest.raises(TypeError, match="other types"):
        address_of(frame._replace(rods=single))
    with pytest.raises(TypeError, match=r"Rods\.free must be an array of bool"):
        TableWriter()(frame._replace(rods=frame.rods._replace(free=frame.rods.pull)))


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
