"""Lanes against floats: arithmetic, loads and stores, gather and scatter."""

import os
import platform
import subprocess
import sys

import numpy as np
import pytest

from shellcut.numerics.jit import kernel
from shellcut.numerics.lane_functions import larger, square_root, where_above
from shellcut.numerics.lanes import (
    add_row_columns,
    aligned_zeros,
    along,
    at,
    clear_rows,
    corner_node,
    first_node,
    multiply_add,
    pick,
    pick_all,
    put,
    put_all,
    put_at,
    put_row_columns,
    row_columns,
    scatter_add,
    total,
    vector_at,
    zero,
)
from shellcut.numerics.processor import align_stack, flush_subnormals, set_rounding

RNG = np.random.default_rng(8)
LANES = ((None,), tuple(range(8)))
"""All at once, and one after the other."""


@kernel
def _arithmetic(table, out, one):
    a, b = pick(table, 1, 0, one), pick(table, 1, 1, one)
    c = zero(one) - (2.0 * a + b * 0.5) / (b - 3.0) + -(1.0 / a) * (b + 1.0) - (4.0 - a) / 8.0
    put(out, 0, 0, one, multiply_add(a, b, c))


@kernel
def _choices(table, out, one):
    a, b = pick(table, 0, 0, one), pick(table, 0, 1, one)
    put(out, 0, 0, one, where_above(a, b, a - 1.0, 2.0))
    put(out, 0, 1, one, larger(a, b))
    put(out, 0, 2, one, larger(a, 0.25) + larger(-0.25, b) + where_above(0.5, a, 1.0, b))
    put(out, 0, 3, one, square_root(a * a + b * b))


@kernel
def _swapped(table, out, one):
    a, b, c = pick_all(table, 1, 2, 3, one)
    put_all(out, 0, 1, one, (c, a, a + b))


@pytest.mark.parametrize("lanes", LANES)
def test_numbers_that_follow_each_other_come_as_a_tuple(lanes):
    table, out = RNG.uniform(1, 2, (2, 6, 8)), np.zeros((1, 5, 8))
    for lane in lanes:
        _swapped(table, out, lane)
    a, b, c = table[1, 2:5]
    np.testing.assert_array_equal(out[0], [0 * a, c, a, a + b, 0 * a])


@pytest.mark.parametrize("lanes", LANES)
def test_choices_and_roots_are_those_of_floats(lanes):
    table = aligned_zeros((1, 2, 8))
    table[:] = RNG.normal(size=(1, 2, 8))
    table[0, 1, 0] = table[0, 0, 0]
    table[0, 0, 1], table[0, 1, 2] = np.nan, np.nan
    out = aligned_zeros((1, 4, 8))
    for lane in lanes:
        _choices(table, out, lane)
    a, b = table[0]
    wanted = [
        np.where(a > b, a - 1, 2.0),
        np.where(b > a, b, a),
        np.where(a < 0.25, 0.25, a) + np.where(b > -0.25, b, -0.25) + np.where(a < 0.5, 1.0, b),
        np.sqrt(a * a + b * b),
    ]
    # Exact but for the fused sum under the root and the sum of three.
    eps = 4 * np.finfo(float).eps
    np.testing.assert_array_equal(out[0, :2], wanted[:2])
    np.testing.assert_allclose(out[0, 2:], wanted[2:], rtol=eps, atol=eps)


@kernel
def _total(table, k, one):
    return total(pick(table, 0, k, one))


@kernel
def _corners(corner, x, rows, out, one):
    for a in range(4):
        v = vector_at(x, corner_node(corner, 0, a, one), one)
        put(out, 0, a, one, v[0] + v[1] * v[2])
        six = (v[0], v[1], v[2], 2.0 * v[0], 2.0 * v[1], 2.0 * v[2])
        scatter_add(rows, corner, 0, a, one, six)


@kernel
def _nodes(x, mass, rows, more, other, first, out, lane):
    for turn in range(8 if lane is not None else 1):
        n = first + turn
        r = row_columns(rows, n, lane)
        put_at(out, n, 0, lane, at(x, n, 0, lane) + along(mass, n, lane) * r[0])
        put_at(out, n, 1, lane, r[1] * r[2] + r[3])
        put_at(out, n, 2, lane, r[4] - r[5])
        v = at(x, n, 0, lane), at(x, n, 1, lane), at(x, n, 2, lane)
        add_row_columns(more, n, lane, v)
        clear_rows(rows, n, lane)
        put_row_columns(other, n, lane, v)


def test_arithmetic_is_that_of_floats():
    for lanes in LANES:
        table = RNG.uniform(1, 2, (2, 2, 8))
        a, b = table[1]
        wanted = 0.0 - (2.0 * a + b * 0.5) / (b - 3.0) + -(1.0 / a) * (b + 1.0) - (4.0 - a) / 8.0
        wanted += a * b
        out = np.full((1, 1, 8), np.nan)
        for lane in lanes:
            _arithmetic(table, out, lane)
        # Rounded in other places: a few units in the last.
        np.testing.assert_allclose(out[0, 0], wanted, rtol=50 * np.finfo(float).eps)


def test_total_runs_from_the_first_lane_to_the_last():
    # 1e16 swallows a one that comes after it, and not one that came before.
    table = np.array([[[1.0, 1.0, 1e16, 1.0, -1e16, 1.0, 0.0, 0.0]]])
    wanted = 0.0
    for v in table[0, 0]:
        wanted += v
    assert _total(table, 0, None) == total(table[0, 0]) == wanted
    assert _total(table, 0, 2) == 1e16


def test_gather_and_scatter_with_nodes_that_repeat():
    for lanes in LANES:
        # All lanes of the first corner are one node: adding them at once would lose the others.
        corner = np.zeros((1, 4, 8), np.int32)
        corner[0, 0] = 3
        corner[0, 1:] = RNG.integers(0, 12, (3, 8))
        x = np.asfortranarray(RNG.uniform(-1, 1, (12, 3)))
        wanted_rows = np.zeros((12, 6))
        for a in range(4):
            for node in corner[0, a]:
                wanted_rows[node] += np.concatenate([x[node], 2 * x[node]])
        ids = corner[0]
        wanted = x[ids, 0] + x[ids, 1] * x[ids, 2]
        rows, out = aligned_zeros((12, 8)), np.full((1, 4, 8), np.nan)
        for lane in lanes:
            _corners(corner, x, rows, out, lane)
        # Sums of up to eight terms of size one.
        round_off = 50 * np.finfo(float).eps
        np.testing.assert_allclose(out[0], wanted, rtol=0, atol=round_off)
        np.testing.assert_allclose(rows[:, :6], wanted_rows, rtol=0, atol=round_off)


def test_consecutive_nodes():
    x, mass = np.asfortranarray(RNG.uniform(-1, 1, (20, 3))), RNG.uniform(1, 2, 20)
    full = aligned_zeros((20, 8))
    full[:] = RNG.uniform(-1, 1, (20, 8))
    some = slice(5, 13)
    wanted = np.stack(
        [
            x[some, 0] + mass[some] * full[some, 0],
            full[some, 1] * full[some, 2] + full[some, 3],
            full[some, 4] - full[some, 5],
        ],
        axis=1,
    )
    for lane in (None, 0):
        rows, out = full.copy(), np.full((20, 3), np.nan, order="F")
        more, other = full.copy(), full.copy()
        _nodes(x, mass, rows, more, other, 5, out, lane)
        np.testing.assert_allclose(out[some], wanted, rtol=0, atol=1e-15)
        assert np.isnan(out[:5]).all()
        assert np.isnan(out[13:]).all()
        assert not rows[some].any()
        np.testing.assert_array_equal(more[some, :3], full[some, :3] + x[some])
        more[some, :3] = full[some, :3]
        np.testing.assert_array_equal(more, full)
        np.testing.assert_array_equal(other[some, :3], x[some])
        assert not other[some, 3:].any()
        other[some] = full[some]
        np.testing.assert_array_equal(other, full)
        np.testing.assert_array_equal(rows[13:], full[13:])


def test_arrays_start_on_a_cache_line():
    for shape, dtype in (((7, 8), float), ((3,), np.int32), ((0, 16, 8), float)):
        array = aligned_zeros(shape, dtype)
        assert array.ctypes.data % 64 == 0 or array.size == 0
        assert (array.shape, array.dtype) == (shape, np.dtype(dtype))
        assert not array.any()


@kernel
def _first_nodes(corner, out, one):
    align_stack()
    out[0] = first_node(corner, 1, 2, one)


def test_first_node_is_that_of_the_first_place_or_of_the_place_asked_for():
    corner, out = RNG.integers(0, 99, (2, 4, 8)).astype(np.int32), np.zeros(1, int)
    for lane, place in ((None, 0), (0, 0), (5, 5)):
        _first_nodes(corner, out, lane)
        assert out[0] == corner[1, 2, place]


@kernel
def _halved(values, out):
    before = flush_subnormals()
    out[0] = 0.5 * values[0]
    set_rounding(before)
    out[1] = 0.5 * values[1]


@pytest.mark.skipif(
    platform.machine().lower() not in ("x86_64", "amd64"), reason="x86 only has the setting"
)
def test_subnormals_are_flushed_where_asked_and_nowhere_else():
    out = np.ones(2)
    least = np.full(2, 2.0**-1022)  # of the doubles with all their digits
    _halved(least, out)
    assert out.tolist() == [0.0, 2.0**-1023]
    assert (0.5 * least == 2.0**-1023).all()  # and not in what follows


_ELSEWHERE = """
import numba
print(numba.config.DISABLE_JIT, numba.config.CPU_NAME)
import test_lanes as tests
tests.test_arithmetic_is_that_of_floats()
tests.test_total_runs_from_the_first_lane_to_the_last()
tests.test_gather_and_scatter_with_nodes_that_repeat()
tests.test_consecutive_nodes()
tests.test_first_node_is_that_of_the_first_place_or_of_the_place_asked_for()
"""

X86 = pytest.mark.skipif(
    platform.machine().lower() not in ("x86_64", "amd64"), reason="a processor of this kind only"
)


@pytest.mark.parametrize(
    ("environment", "told"),
    [
        pytest.param({"NUMBA_DISABLE_JIT": "1"}, "1 None", id="no compiler"),
        # Of the registers of eight, four or two doubles that LLVM puts lanes into.
        pytest.param(
            {"NUMBA_CPU_NAME": "haswell", "NUMBA_CPU_FEATURES": ""},
            "0 haswell",
            id="AVX2",
            marks=[X86, pytest.mark.slow],
        ),
        pytest.param(
            {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""},
            "0 generic",
            id="SSE2",
            marks=[X86, pytest.mark.slow],
        ),
    ],
)
def test_the_same_on_other_processors_and_without_the_compiler(environment, told):
    here = {name: text for name, text in os.environ.items() if not name.startswith("NUMBA_CPU_")}
    done = subprocess.run(
        [sys.executable, "-c", _ELSEWHERE],
        check=True,
        capture_output=True,
        text=True,
        cwd=os.path.dirname(__file__),
        env={**here, **environment},
    )
    assert done.stdout.split() == told.split()
