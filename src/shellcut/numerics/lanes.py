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

# Numba's and llvmlite's calls have no types.
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

import functools
from typing import Any, TypeGuard

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.core import cgutils

from shellcut.arrays import Floats, Number, SmallIds, Vector

from .intrinsics import in_kernels
from .jit import always_inline
from .lane_arithmetic import CONTRACT, called
from .lane_instructions import (
    CACHE_LINE,
    DOUBLE,
    DOUBLES,
    I32,
    I64,
    LANE_IDS,
    LANES,
    WIDTH,
    ZERO,
    ZEROS,
    Lane,
    LaneIdsType,
    LanesType,
    add_to,
    address,
    gathered,
    lane_of,
    numbers_of,
    row_address,
    shifted,
    takes_all,
    transposed,
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


def _addresses(context: Any, builder: Any, kinds: Any, values: Any, n: int) -> list[Any]:
    """Return the addresses of n numbers of a block, of table, b, first, lane."""
    table, b, first, lane = values[:4]
    one = not takes_all(kinds[3])
    kind, last = (DOUBLE, lane) if one else (LANES, ZERO)
    places = ([b, shifted(builder, first, i), last] for i in range(n))
    return [address(context, builder, kinds[0], table, place, kind) for place in places]


def pick(table: Floats, b: int, k: int, lane: Lane) -> Number:
    """Return number ``k`` of block ``b`` of a table : (n_block, n, 8)."""
    return table[b, k, lane] if _one(lane) else table[b, k].copy()


@in_kernels(pick)
def _pick(*kinds: Any) -> Any:
    table, _, _, lane = kinds

    def code(context: Any, builder: Any, values: Any) -> Any:
        (where,) = _addresses(context, builder, kinds, values, 1)
        return builder.load(where, align=8)

    return numbers_of(lane)(table, types.intp, types.intp, lane_of(lane)), code


def put(table: Floats, b: int, k: int, lane: Lane, value: Number) -> None:
    """Write number ``k`` of block ``b`` of a table : (n_block, n, 8)."""
    if _one(lane):
        table[b, k, lane] = value
    else:
        table[b, k] = value


@in_kernels(put)
def _put(*kinds: Any) -> Any:
    table, _, _, lane, _ = kinds

    def code(context: Any, builder: Any, values: Any) -> None:
        (where,) = _addresses(context, builder, kinds, values, 1)
        builder.store(values[4], where, align=8)

    return types.void(table, types.intp, types.intp, lane_of(lane), numbers_of(lane)), code


def pick_all(table: Floats, b: int, first: int, n: int, lane: Lane) -> tuple[Number, ...]:
    """Return n numbers of block ``b`` of a table : (n_block, m, 8), from ``first``; n is fixed."""
    return tuple(pick(table, b, first + k, lane) for k in range(n))


@in_kernels(pick_all)
def _pick_all(table: Any, b: Any, first: Any, n: Any, lane: Any) -> Any:
    if not isinstance(n, types.IntegerLiteral):
        return None
    returned = types.UniTuple(numbers_of(lane), n.literal_value)

    def code(context: Any, builder: Any, values: Any) -> Any:
        table_, b_, first_, _, lane_ = values
        kinds, places = (table, b, first, lane), (table_, b_, first_, lane_)
        where = _addresses(context, builder, kinds, places, n.literal_value)
        loaded = [builder.load(one, align=8) for one in where]
        return context.make_tuple(builder, returned, loaded)

    return returned(table, types.intp, types.intp, n, lane_of(lane)), code


def put_all(table: Floats, b: int, first: int, lane: Lane, values: tuple[Number, ...]) -> None:
    """Write numbers of block ``b`` of a table : (n_block, m, 8), from ``first`` on."""
    for k, value in enumerate(values):
        put(table, b, first + k, lane, value)


@in_kernels(put_all)
def _put_all(*kinds: Any) -> Any:
    table, _, _, lane, numbers = kinds
    n = len(numbers)

    def code(context: Any, builder: Any, values: Any) -> None:
        given = cgutils.unpack_tuple(builder, values[4], n)
        for where, value in zip(_addresses(context, builder, kinds, values, n), given, strict=True):
            builder.store(value, where, align=8)

    taken = types.UniTuple(numbers_of(lane), n)
    return types.void(table, types.intp, types.intp, lane_of(lane), taken), code


def corner_node(corner: SmallIds, b: int, a: int, lane: Lane) -> Any:
    """Return the node ids at corner ``a`` of block ``b``, for :func:`at`."""
    return int(corner[b, a, lane]) if _one(lane) else corner[b, a]


@in_kernels(corner_node)
def _corner_node(corner: Any, b: Any, a: Any, lane: Any) -> Any:
    every = takes_all(lane)

    def code(context: Any, builder: Any, values: Any) -> Any:
        corner_, b_, a_, lane_ = values
        kind, last = (ir.VectorType(I32, WIDTH), ZERO) if every else (I32, lane_)
        where = address(context, builder, corner, corner_, [b_, a_, last], kind)
        ids = builder.load(where, align=4)
        return ids if every else builder.sext(ids, I64)

    returned = LANE_IDS if every else types.intp
    return returned(corner, types.intp, types.intp, lane_of(lane)), code


def first_node(corner: SmallIds, b: int, a: int, lane: Lane) -> int:
    """Return the node id at corner ``a`` of block ``b``; of the first place if all are selected."""
    return int(corner[b, a, lane if _one(lane) else 0])


@in_kernels(first_node)
def _first_node(corner: Any, b: Any, a: Any, lane: Any) -> Any:
    def code(context: Any, builder: Any, values: Any) -> Any:
        corner_, b_, a_, lane_ = values
        index = [b_, a_, ZERO if takes_all(lane) else lane_]
        return builder.sext(
            builder.load(address(context, builder, corner, corner_, index, I32)), I64
        )

    return types.intp(corner, types.intp, types.intp, lane_of(lane)), code


def scatter_add(
    rows: Floats, corner: SmallIds, b: int, a: int, lane: Lane, force: tuple[Number, ...]
) -> None:
    """Add six numbers to the rows : (n, 8) of the nodes at corner ``a``, lane after lane."""
    for place in (lane,) if _one(lane) else range(corner.shape[2]):
        for c in range(6):
            rows[corner[b, a, place], c] += force[c] if _one(lane) else force[c][place]


@in_kernels(scatter_add)
def _scatter_add(rows: Any, corner: Any, b: Any, a: Any, lane: Any, force: Any) -> Any:
    def code(context: Any, builder: Any, values: Any) -> None:
        rows_, corner_, b_, a_, lane_, force_ = values
        columns = cgutils.unpack_tuple(builder, force_, 6)

        def row_of(place: Any) -> Any:
            node = builder.load(address(context, builder, corner, corner_, [b_, a_, place], I32))
            return row_address(context, builder, rows, rows_, builder.sext(node, I64))

        if not takes_all(lane):
            _add_to_row(builder, row_of(lane_), columns)
            return
        for place, row in enumerate(transposed(builder, columns)):
            add_to(builder, row_of(ir.Constant(I64, place)), row)

    taken = types.UniTuple(numbers_of(lane), 6)
    return types.void(rows, corner, types.intp, types.intp, lane_of(lane), taken), code


def _add_to_row(builder: Any, row: Any, columns: list[Any]) -> None:
    """Add doubles to the first columns of a row at an address."""
    first = builder.bitcast(row, DOUBLE.as_pointer())
    for c, column in enumerate(columns):
        add_to(builder, builder.gep(first, [ir.Constant(I64, c)]), column, CONTRACT)


def at(values: Floats, n: Any, c: int, lane: Lane) -> Number:
    """Return column ``c`` of values : (m, 3), one column after the other, at nodes.

    n : of :func:`corner_node`; or a node id, and with lanes the eight from there on.
    """
    if _one(lane) or np.ndim(n):
        return values[n, c]
    return values[n : n + WIDTH, c].copy()


@in_kernels(at)
def _at(values: Any, n: Any, c: Any, lane: Any) -> Any:
    of_ids = isinstance(n, LaneIdsType)

    def code(context: Any, builder: Any, given: Any) -> Any:
        values_, n_, c_, _ = given
        if of_ids:
            column = address(context, builder, values, values_, [ZERO, c_], DOUBLE)
            return gathered(builder, column, n_)
        kind = LANES if takes_all(lane) else DOUBLE
        return builder.load(address(context, builder, values, values_, [n_, c_], kind), align=8)

    taken = values, n if of_ids else types.intp, types.intp, lane_of(lane)
    return numbers_of(lane)(*taken), code


@always_inline
def vector_at(values: Floats, n: Any, lane: Lane) -> Vector:
    """Return the three columns of :func:`at`."""
    return at(values, n, 0, lane), at(values, n, 1, lane), at(values, n, 2, lane)


def along(values: Floats, n: int, lane: int | None) -> Number:
    """Return values : (m,) at node ``n``, or at the eight nodes from ``n``."""
    return values[n : n + WIDTH].copy() if lane is None else values[n]


@in_kernels(along)
def _along(values: Any, n: Any, lane: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> Any:
        kind = LANES if takes_all(lane) else DOUBLE
        return builder.load(address(context, builder, values, given[0], [given[1]], kind), align=8)

    return numbers_of(lane)(values, types.intp, lane_of(lane)), code


def put_at(values: Floats, n: int, c: int, lane: int | None, value: Number) -> None:
    """Write column ``c`` of values : (m, 3) at node ``n``, or at the eight nodes from ``n``."""
    if lane is None:
        values[n : n + WIDTH, c] = value
    else:
        values[n, c] = value


@in_kernels(put_at)
def _put_at(values: Any, n: Any, c: Any, lane: Any, value: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> None:
        values_, n_, c_, _, value_ = given
        where = address(context, builder, values, values_, [n_, c_], value_.type)
        builder.store(value_, where, align=8)

    return types.void(values, types.intp, types.intp, lane_of(lane), numbers_of(lane)), code


def _rows_at(context: Any, builder: Any, kinds: Any, given: Any) -> list[Any]:
    """Return the addresses of the row at a node, or of eight rows, of rows, n, lane."""
    rows, n, _ = given[:3]
    count = WIDTH if takes_all(kinds[2]) else 1
    places = (shifted(builder, n, i) for i in range(count))
    return [row_address(context, builder, kinds[0], rows, place) for place in places]


def row_columns(rows: Floats, n: int, lane: int | None) -> tuple[Number, ...]:
    """Return the first six columns of rows : (m, 8) at node ``n``, or the eight from ``n``."""
    if lane is None:
        return tuple(rows[n : n + WIDTH, c].copy() for c in range(6))
    return tuple(rows[n, c] for c in range(6))


@in_kernels(row_columns)
def _row_columns(*kinds: Any) -> Any:
    rows, _, lane = kinds
    returned = types.UniTuple(numbers_of(lane), 6)

    def code(context: Any, builder: Any, given: Any) -> Any:
        loaded = [builder.load(row, align=8) for row in _rows_at(context, builder, kinds, given)]
        if takes_all(lane):
            columns = transposed(builder, loaded)[:6]
        else:
            columns = [builder.extract_element(loaded[0], ir.Constant(I32, c)) for c in range(6)]
        return context.make_tuple(builder, returned, columns)

    return returned(rows, types.intp, lane_of(lane)), code


def add_row_columns(rows: Floats, n: int, lane: int | None, columns: Vector) -> None:
    """Add to the first three columns of rows : (m, 8) at node ``n``, or at the eight from ``n``."""
    for c, column in enumerate(columns):
        rows[n : n + (WIDTH if lane is None else 1), c] += column


@in_kernels(add_row_columns)
def _add_row_columns(*kinds: Any) -> Any:
    rows, _, lane, columns = kinds

    def code(context: Any, builder: Any, given: Any) -> None:
        added = cgutils.unpack_tuple(builder, given[3], columns.count)
        where = _rows_at(context, builder, kinds, given)
        if not takes_all(lane):
            _add_to_row(builder, where[0], added)
            return
        padded = [*added, *[ZEROS] * (WIDTH - columns.count)]
        for place, row in zip(where, transposed(builder, padded), strict=True):
            add_to(builder, place, row)

    taken = types.UniTuple(numbers_of(lane), 3)
    return types.void(rows, types.intp, lane_of(lane), taken), code


def clear_rows(rows: Floats, n: int, lane: int | None) -> None:
    """Set rows : (m, 8) to zero at node ``n``, or at the eight nodes from ``n``."""
    rows[n : n + (WIDTH if lane is None else 1)] = 0.0


@in_kernels(clear_rows)
def _clear_rows(*kinds: Any) -> Any:
    rows, _, lane = kinds

    def code(context: Any, builder: Any, given: Any) -> None:
        for row in _rows_at(context, builder, kinds, given):
            builder.store(ZEROS, row, align=8)

    return types.void(rows, types.intp, lane_of(lane)), code


def zero(lane: Lane) -> Number:
    """Return zero, to start a sum."""
    return 0.0 if _one(lane) else np.zeros(WIDTH)


@in_kernels(zero)
def _zero(lane: Any) -> Any:
    nothing = ZEROS if takes_all(lane) else ir.Constant(DOUBLE, 0.0)
    return numbers_of(lane)(lane_of(lane)), lambda context, builder, given: nothing


def total(value: Number) -> float:
    """Return the sum over the lanes from the first to the last."""
    sum_ = 0.0
    for one in np.atleast_1d(value):
        sum_ += float(one)
    return sum_


@in_kernels(total)
def _total(value: Any) -> Any:
    if not isinstance(value, LanesType):
        return types.float64(types.float64), lambda context, builder, given: given[0]

    def code(context: Any, builder: Any, given: Any) -> Any:
        lanes = [builder.extract_element(given[0], ir.Constant(I32, k)) for k in range(WIDTH)]
        return functools.reduce(builder.fadd, lanes)

    return types.float64(value), code


def multiply_add(a: Number, b: Number, c: Number) -> Number:
    """Return a b + c, rounded once where the processor can.

    In a b + c d the compiler may fuse either product with the sum, differently in each kernel; this
    fixes the choice where two kernels must give the same bits.
    """
    return a * b + c


@in_kernels(multiply_add)
def _multiply_add(a: Any, b: Any, c: Any) -> Any:
    kind = DOUBLES if isinstance(a, LanesType) else types.float64
    return kind(kind, kind, kind), lambda context, builder, given: called(
        builder, "fmuladd", *given
    )
