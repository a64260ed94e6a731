"""A held table is read by kernels as the table itself."""

import gc
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from shellcut.arrays import Bools, Floats, Ints
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, kernel


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


def test_kernels_read_and_write_through_it():
    frame = _frame()
    held = Holder()(frame)
    by_table, by_held = BoundOnce(_sum_up), BoundOnce(_sum_up)
    assert by_held(held, 1.0) == 11.0 + 0.5 * (2.0 + 5.0 * 7)
    assert frame.rods.pull.tolist() == [3.0, 4.0, 6.0]
    assert by_held(held, 0.0) == by_table(frame, 0.0)
    # Written from outside, it is read at the next call: the arrays are the same ones.
    frame.rods.pull[:] = 1.0
    assert by_held(held, 0.0) == by_table(frame, 0.0) == 11.0 + 0.5 * 8


def test_it_keeps_its_arrays_alive():
    held = Holder()(_frame())
    call = BoundOnce(_sum_up)
    gc.collect()
    others = [np.full(3, 1e300) for _ in range(100)]
    assert call(held, 0.0) == 11.0 + 0.5 * 37.0
    assert len(others) == 100


def test_the_next_table_takes_its_place():
    hold, call = Holder(), BoundOnce(_sum_up)
    frame = _frame()
    first = hold(frame)
    grown = frame._replace(rods=Rods(*(np.repeat(rows, 2, axis=0) for rows in frame.rods)), count=6)
    assert call(hold(grown), 0.0) == 11.0 + 2 * 0.5 * 37.0
    assert call(first, 0.0) == 11.0 + 0.5 * 37.0


def test_other_types_are_refused():
    hold = Holder()
    frame = _frame()
    hold(frame)
    single = frame.rods._replace(pull=frame.rods.pull.astype(np.float32))
    with pytest.raises(TypeError, match="other types"):
        hold(frame._replace(rods=single))
    with pytest.raises(TypeError, match=r"Rods\.free must be an array of bool"):
        Holder()(frame._replace(rods=frame.rods._replace(free=frame.rods.pull)))
