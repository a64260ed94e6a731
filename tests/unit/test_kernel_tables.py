"""Arrays in the wrong field of a kernel's table are refused where the kernel is bound."""

import sys
from typing import Annotated, NamedTuple

import numpy as np
import pytest

from notched_strip import cutting
from shellcut.arrays import Bools, Floats, Ints, Numbers
from shellcut.cables import directional_cable
from shellcut.contact import press_kernel
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.kernel_tables import check_tables


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


def test_right_tables_pass():
    check_tables([bars(), 3.0, np.zeros(2), Truss(bars=bars(), colour=np.zeros(4))])


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (
            {"area": np.zeros((4, 3)), "force": np.zeros(4)},
            r"Bars\.area must be an array of float64 of shape \(n_bar,\), got float64 of \(4, 3\)",
        ),
        ({"ends": np.zeros((4, 3), np.int64)}, r"Bars\.ends .* shape \(n_bar, 2\), got int64 of"),
        ({"ends": np.zeros((4, 2))}, r"Bars\.ends must be an array of integer"),
        ({"broken": np.zeros(4)}, r"Bars\.broken must be an array of bool"),
        ({"any_kind": 2.0}, r"Bars\.any_kind must be an array of shape \(n_any,\), got 2\.0"),
        (
            {"force": np.zeros((5, 3))},
            r"Bars\.force .* where n_bar is 4 in Bars\.ends, got float64",
        ),
    ],
)
def test_an_array_in_the_wrong_place_is_named(changed, sentence):
    with pytest.raises(TypeError, match=sentence):
        check_tables([bars(**changed)])


def test_a_length_is_the_same_in_every_table_of_a_call():
    with pytest.raises(TypeError, match=r"Truss\.colour .* n_bar is 4 in Bars\.ends"):
        check_tables([Truss(bars=bars(), colour=np.zeros(5))])
    with pytest.raises(TypeError, match=r"Truss\.colour .* n_bar is 4 in Bars\.ends"):
        check_tables([bars(), Truss(bars=bars(), colour=np.zeros(5))])


@pytest.fixture(scope="module")
def run():
    sim = cutting()
    while not sim.state.n_cable:
        sim.step()
    sim.step()
    return sim


def test_swapped_fields_of_the_cables_are_refused(run):
    tables = run.cables._tables.table
    rows = tables.cables
    swapped = tables._replace(cables=rows._replace(area=rows.m, m=rows.area))
    call = BoundOnce(directional_cable._add_cable_forces)
    with pytest.raises(TypeError, match=r"CableRows\.area .* is another array in its place\?"):
        call(run.pose, 1e-9, 0.0, swapped, run.cables.touch)
    with pytest.raises(TypeError, match=r"CableRows\.area .* is another array in its place\?"):
        Holder()(swapped)


def test_swapped_fields_of_the_contact_are_refused(run):
    tables = run.contact.tables.table
    swapped = tables._replace(looks=tables.looks._replace(lasts=tables.nodes.contact_mass))
    call = BoundOnce(press_kernel.add_press_forces)
    with pytest.raises(TypeError, match=r"Looks\.lasts .* where n_row is"):
        call(run.pose, run.pose, 1e-9, swapped, run.contact.touch)


@kernel
def _lengthen(truss: Truss) -> float:
    """Add one to the area of each bar, return the sum of area times colour."""
    truss = borrowed(truss)
    total = 0.0
    for i in range(truss.colour.shape[0]):
        truss.bars.area[i] += 1.0
        total += truss.bars.area[i] * truss.colour[i]
    return total


def test_borrowed_arrays_are_those_of_the_caller():
    """Read and written in place, and held as often after the call as before."""
    truss = Truss(bars=bars(area=np.arange(4.0)), colour=np.array([1.0, 10.0, 100.0, 1000.0]))
    held = sys.getrefcount(truss.bars.area), sys.getrefcount(truss.colour)
    for lengthen in (_lengthen, getattr(_lengthen, "py_func", _lengthen)):
        truss.bars.area[:] = np.arange(4.0)
        assert lengthen(truss) == 1.0 + 20.0 + 300.0 + 4000.0
        np.testing.assert_array_equal(truss.bars.area, [1.0, 2.0, 3.0, 4.0])
    assert held == (sys.getrefcount(truss.bars.area), sys.getrefcount(truss.colour))
