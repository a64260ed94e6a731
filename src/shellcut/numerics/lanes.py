"""Lanes: eight doubles that a kernel treats as one number.

The compiler does not vectorise a loop over quads written with plain floats, because of the gathers
at its start and the scatters at its end. Lanes are explicit vectors. The mechanics are functions of
*numbers* (:data:`shellcut.arrays.Number`); given floats they treat one quad, given lanes all
quads of a block.

Only loads and stores differ, and the functions here hide that. Their argument ``lane`` selects
quads of a block: an integer takes one, as a float; ``None`` takes all eight:

=====================================  ===================================================
:func:`pick`, :func:`put`              one number of a table in blocks, (n_block, n, 8)
:func:`pick_all`, :func:`put_all`      a tuple of numbers that follow each other there
:func:`corner_node`                    node ids of a corner
:func:`first_node`                     the first of them, for consecutive ids
:func:`at`, :func:`vector_at`,         read values at nodes
:func:`along`
:func:`put_at`                         write them
:func:`scatter_add`                    nodal forces, added row by row, so nodes may repeat
:func:`row_columns`                    read the first six columns of consecutive force rows
:func:`add_row_columns`                add to the first three
:func:`clear_rows`                     set the rows to zero
:func:`zero`, :func:`total`            zero, and the sum over the lanes in order
:func:`multiply_add`                   a b + c, one instruction if available
=====================================  ===================================================

Lanes support + - * / and negation, with lanes and with floats; a multiplication and an addition may
become one fused instruction, nothing is reassociated. LLVM lowers ``<8 x double>`` to
one AVX-512 register, two of AVX2, four of SSE or NEON. Without the compiler (NUMBA_DISABLE_JIT=1)
the same functions run on NumPy arrays.
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="arg-type, call-arg, no-untyped-call"

from __future__ import annotations

from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt
from numba.extending import overload

from shellcut.arrays import Floats, Number, SmallIds, Vector

from .jit import always_inline
from .lane_arithmetic import fused, sum_of_lanes
from .lane_instructions import (
    CACHE_LINE,
    OVERLOAD_OPTIONS,
    WIDTH,
    Lane,
    LaneIdsType,
    LanesType,
    add_to_rows,
    gather_column,
    load_lanes,
    load_row_columns,
    no_lanes,
    numbers_loader,
    scatter_add_rows,
    store_lanes,
    store_numbers,
    takes_all,
    zero_rows,
)


def _one(lane: Lane) -> TypeGuard[int]:
    """Whether ``lane`` selects one place."""
    return isinstance(lane, int | np.integer)


def aligned_zeros(shape: tuple[int, ...], dtype: npt.DTypeLike = float) -> Any:
    """Return an array of zeros that starts on a cache line, so that no vector straddles two."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    raw = np.zeros(size + CACHE_LINE, np.uint8)
    start = -raw.ctypes.data % CACHE_LINE
    return raw[start : start + size].view(dtype).reshape(shape)


# ---------------------------------------------------------------- the functions kernels call


def pick(table: Floats, b: int, k: int, lane: Lane) -> Number:
    """Return number ``k`` of block ``b`` of a table : (n_block, n, 8)."""
    return table[b, k, lane] if _one(lane) else table[b, k].copy()


@overload(pick, jit_options=OVERLOAD_OPTIONS)
def _pick(table, b, k, lane):
    if takes_all(lane):
        return lambda table, b, k, lane: load_lanes(table, (b, k, 0))
    return lambda table, b, k, lane: table[b, k, lane]


def put(table: Floats, b: int, k: int, lane: Lane, value: Number) -> None:
    """Write number ``k`` of block ``b`` of a table : (n_block, n, 8)."""
    if _one(lane):
        table[b, k, lane] = value
    else:
        table[b, k] = value


@overload(put, jit_options=OVERLOAD_OPTIONS)
def _put(table, b, k, lane, value):
    if takes_all(lane):
        return lambda table, b, k, lane, value: store_lanes(table, (b, k, 0), value)

    def one(table, b, k, lane, value):
        table[b, k, lane] = value

    return one


def pick_all(table: Floats, b: int, first: int, n: int, lane: Lane) -> tuple[Number, ...]:
    """Return n numbers of block ``b`` of a table : (n_block, m, 8), from ``first``; n is fixed."""
    return tuple(pick(table, b, first + k, lane) for k in range(n))


@overload(pick_all, jit_options=OVERLOAD_OPTIONS, prefer_literal=True)
def _pick_all(table, b, first, n, lane):
    load = numbers_loader(n.literal_value)
    return lambda table, b, first, n, lane: load(table, b, first, lane)


def put_all(table: Floats, b: int, first: int, lane: Lane, values: tuple[Number, ...]) -> None:
    """Write numbers of block ``b`` of a table : (n_block, m, 8), from ``first`` on."""
    for k, value in enumerate(values):
        put(table, b, first + k, lane, value)


@overload(put_all, jit_options=OVERLOAD_OPTIONS)
def _put_all(table, b, first, lane, values):
    return lambda table, b, first, lane, values: store_numbers(table, b, first, lane, values)


def corner_node(corner: SmallIds, b: int, a: int, lane: Lane) -> Any:
    """Return the node ids at corner ``a`` of block ``b``, for :func:`at`."""
    return int(corner[b, a, lane]) if _one(lane) else corner[b, a]


@overload(corner_node, jit_options=OVERLOAD_OPTIONS)
def _corner_node(corner, b, a, lane):
    if takes_all(lane):
        return lambda corner, b, a, lane: load_lanes(corner, (b, a, 0))
    return lambda corner, b, a, lane: np.int64(corner[b, a, lane])


def first_node(corner: SmallIds, b: int, a: int, lane: Lane) -> int:
    """Return the node id at corner ``a`` of block ``b``; of the first place if all are selected."""
    return int(corner[b, a, lane if _one(lane) else 0])


@overload(first_node, jit_options=OVERLOAD_OPTIONS)
def _first_node(corner, b, a, lane):
    if takes_all(lane):
        return lambda corner, b, a, lane: np.int64(corner[b, a, 0])
    return lambda corner, b, a, lane: np.int64(corner[b, a, lane])


def scatter_add(
    rows: Floats, corner: SmallIds, b: int, a: int, lane: Lane, force: tuple[Number, ...]
) -> None:
    """Add six numbers to the rows : (n, 8) of the nodes at corner ``a``, lane after lane."""
    for place in (lane,) if _one(lane) else range(corner.shape[2]):
        for c in range(6):
            rows[corner[b, a, place], c] += force[c] if _one(lane) else force[c][place]


@overload(scatter_add, jit_options=OVERLOAD_OPTIONS)
def _scatter_add(rows, corner, b, a, lane, force):
    if takes_all(lane):
        return lambda rows, corner, b, a, lane, force: scatter_add_rows(rows, corner, b, a, force)

    def one(rows, corner, b, a, lane, force):
        for c in range(6):
            rows[corner[b, a, lane], c] += force[c]

    return one


def at(values: Floats, n: Any, c: int, lane: Lane) -> Number:
    """Return column ``c`` of values : (m, 3), one column after the other, at nodes.

    n : of :func:`corner_node`; or a node id, and with lanes the eight from there on.
    """
    if _one(lane) or np.ndim(n):
        return values[n, c]
    return values[n : n + WIDTH, c].copy()


@overload(at, jit_options=OVERLOAD_OPTIONS)
def _at(values, n, c, lane):
    if isinstance(n, LaneIdsType):
        return lambda values, n, c, lane: gather_column(values, c, n)
    if takes_all(lane):
        return lambda values, n, c, lane: load_lanes(values, (n, c))
    return lambda values, n, c, lane: values[n, c]


@always_inline
def vector_at(values: Floats, n: Any, lane: Lane) -> Vector:
    """Return the three columns of :func:`at`."""
    return at(values, n, 0, lane), at(values, n, 1, lane), at(values, n, 2, lane)


def along(values: Floats, n: int, lane: int | None) -> Number:
    """Return values : (m,) at node ``n``, or at the eight nodes from ``n``."""
    return values[n : n + WIDTH].copy() if lane is None else values[n]


@overload(along, jit_options=OVERLOAD_OPTIONS)
def _along(values, n, lane):
    if takes_all(lane):
        return lambda values, n, lane: load_lanes(values, (n,))
    return lambda values, n, lane: values[n]


def put_at(values: Floats, n: int, c: int, lane: int | None, value: Number) -> None:
    """Write column ``c`` of values : (m, 3) at node ``n``, or at the eight nodes from ``n``."""
    if lane is None:
        values[n : n + WIDTH, c] = value
    else:
        values[n, c] = value


@overload(put_at, jit_options=OVERLOAD_OPTIONS)
def _put_at(values, n, c, lane, value):
    if takes_all(lane):
        return lambda values, n, c, lane, value: store_lanes(values, (n, c), value)

    def one(values, n, c, lane, value):
        values[n, c] = value

    return one


def row_columns(rows: Floats, n: int, lane: int | None) -> tuple[Number, ...]:
    """Return the first six columns of rows : (m, 8) at node ``n``, or the eight from ``n``."""
    if lane is None:
        return tuple(rows[n : n + WIDTH, c].copy() for c in range(6))
    return tuple(rows[n, c] for c in range(6))


@overload(row_columns, jit_options=OVERLOAD_OPTIONS)
def _row_columns(rows, n, lane):
    if takes_all(lane):
        return lambda rows, n, lane: load_row_columns(rows, n)

    def one(rows, n, lane):
        return rows[n, 0], rows[n, 1], rows[n, 2], rows[n, 3], rows[n, 4], rows[n, 5]

    return one


def add_row_columns(rows: Floats, n: int, lane: int | None, columns: Vector) -> None:
    """Add to the first three columns of rows : (m, 8) at node ``n``, or at the eight from ``n``."""
    for c, column in enumerate(columns):
        rows[n : n + (WIDTH if lane is None else 1), c] += column


@overload(add_row_columns, jit_options=OVERLOAD_OPTIONS)
def _add_row_columns(rows, n, lane, columns):
    if takes_all(lane):
        return lambda rows, n, lane, columns: add_to_rows(rows, n, columns)

    def add(rows, n, lane, columns):
        for c in range(3):
            rows[n, c] += columns[c]

    return add


def clear_rows(rows: Floats, n: int, lane: int | None) -> None:
    """Set rows : (m, 8) to zero at node ``n``, or at the eight nodes from ``n``."""
    rows[n : n + (WIDTH if lane is None else 1)] = 0.0


@overload(clear_rows, jit_options=OVERLOAD_OPTIONS)
def _clear_rows(rows, n, lane):
    if takes_all(lane):
        return lambda rows, n, lane: zero_rows(rows, n)

    def clear(rows, n, lane):
        for c in range(8):
            rows[n, c] = 0.0

    return clear


def zero(lane: Lane) -> Number:
    """Return zero, to start a sum."""
    return 0.0 if _one(lane) else np.zeros(WIDTH)


@overload(zero, jit_options=OVERLOAD_OPTIONS)
def _zero(lane):
    if takes_all(lane):
        return lambda lane: no_lanes()
    return lambda lane: 0.0


def total(value: Number) -> float:
    """Return the sum over the lanes from the first to the last."""
    sum_ = 0.0
    for one in np.atleast_1d(value):
        sum_ += float(one)
    return sum_


@overload(total, jit_options=OVERLOAD_OPTIONS)
def _total(value):
    if isinstance(value, LanesType):
        return lambda value: sum_of_lanes(value)
    return lambda value: value


def multiply_add(a: Number, b: Number, c: Number) -> Number:
    """Return a b + c, rounded once where the processor can.

    In a b + c d the compiler may fuse either product with the sum, differently in each kernel; this
    fixes the choice where two kernels must give the same bits.
    """
    return a * b + c


@overload(multiply_add, jit_options=OVERLOAD_OPTIONS)
def _multiply_add(a, b, c):
    if isinstance(a, LanesType):
        return lambda a, b, c: fused(a, b, c)
    return lambda a, b, c: fused(np.float64(a), np.float64(b), np.float64(c))
