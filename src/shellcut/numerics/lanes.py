"""Lanes: eight doubles that a kernel treats as one number.

The compiler does not vectorise a loop over quads written with plain floats, because of the gathers
at its start and the scatters at its end. Lanes are explicit vectors. The mechanics are functions of
*numbers* (:data:`shellcut.arrays.Number`); given floats they treat one quad, given lanes all
quads of a block.

Only loads and stores differ, and the functions here hide that. Their argument ``lane`` selects
quads of a block: an integer selects one, as a float; ``None`` selects all eight:

=====================================  ===================================================
:func:`pick`, :func:`put`              one number of a table in blocks, (n_block, n, 8)
:func:`pick_all`, :func:`put_all`      a tuple of numbers that follow each other there
:func:`repeated`                       a tuple of one number
:func:`corner_node`                    node ids of a corner
:func:`first_node`                     the first of them, for consecutive ids
:func:`at`, :func:`vector_at`,         read values at nodes
:func:`along`
:func:`put_at`                         write them
:func:`scatter_add`                    nodal forces, added row by row, so nodes may repeat
:func:`row_columns`                    read the first six columns of consecutive force rows
:func:`add_row_columns`                add to the first three
:func:`zero`, :func:`total`            zero, and the sum over the lanes in order
:func:`multiply_add`                   a b + c, one instruction if available
=====================================  ===================================================

Lanes support + - * / and negation, with lanes and with floats; a multiplication and an addition may
become one fused instruction, nothing is reassociated. LLVM lowers ``<8 x double>`` to
one AVX-512 register, two of AVX2, four of SSE or NEON.
"""

# Numba's and llvmlite's calls have no types.
# mypy: disable-error-code="call-overload, no-untyped-call"

from __future__ import annotations

import functools
from typing import Any

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.core import cgutils

from shellcut.arrays import Floats, Number, SmallIds, Vector

from .intrinsics import for_kernels
from .jit import always_inline
from .lane_functions import CONTRACT, called
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


def aligned_zeros(shape: tuple[int, ...], dtype: npt.DTypeLike = float) -> Any:
    """Return an array of zeros that starts on a cache line, so that no vector straddles two."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    raw = np.zeros(size + CACHE_LINE, np.uint8)
    start = -raw.ctypes.data % CACHE_LINE
    return raw[start : start + size].view(dtype).reshape(shape)


# ---------------------------------------------------------------- the functions kernels call


def _addresses(context: Any, builder: Any, table: Any, lane: Any, values: Any, n: int) -> list[Any]:
    """Return the addresses of n numbers of a block, from table, b, first and lane."""
    array, b, first, one = values[:4]
    kind, last = (LANES, ZERO) if takes_all(lane) else (DOUBLE, one)
    places = ([b, shifted(builder, first, i), last] for i in range(n))
    return [address(context, builder, table, array, place, kind) for place in places]


@for_kernels
def pick_all(table: Floats, b: int, first: int, n: Any, lane: Lane) -> tuple[Number, ...]:
    """Return n numbers of block ``b`` of a table : (n_block, m, 8), from ``first``; n is fixed."""
    returned = types.UniTuple(numbers_of(lane), n.literal_value)

    def code(context: Any, builder: Any, values: Any) -> Any:
        places = *values[:3], values[4]
        where = _addresses(context, builder, table, lane, places, returned.count)
        loaded = [builder.load(address, align=8) for address in where]
        return context.make_tuple(builder, returned, loaded)

    return returned(table, types.intp, types.intp, n, lane_of(lane)), code


@for_kernels
def put_all(table: Floats, b: int, first: int, lane: Lane, values: tuple[Number, ...]) -> Any:
    """Write numbers of block ``b`` of a table : (n_block, m, 8), from ``first`` on."""
    n = len(values)

    def code(context: Any, builder: Any, given: Any) -> None:
        numbers = cgutils.unpack_tuple(builder, given[4], n)
        where = _addresses(context, builder, table, lane, given, n)
        for place, value in zip(where, numbers, strict=True):
            builder.store(value, place, align=8)

    taken = types.UniTuple(numbers_of(lane), n)
    return types.void(table, types.intp, types.intp, lane_of(lane), taken), code


@always_inline
def pick(table: Floats, b: int, k: int, lane: Lane) -> Number:
    """Return number ``k`` of block ``b`` of a table : (n_block, n, 8)."""
    return pick_all(table, b, k, 1, lane)[0]


@always_inline
def put(table: Floats, b: int, k: int, lane: Lane, value: Number) -> None:
    """Write number ``k`` of block ``b`` of a table : (n_block, n, 8)."""
    put_all(table, b, k, lane, (value,))


@for_kernels
def repeated(number: Number, n: Any) -> tuple[Number, ...]:
    """Return a tuple that has a number n times; n is fixed."""
    returned = types.UniTuple(number, n.literal_value)
    return returned(number, n), lambda context, builder, given: context.make_tuple(
        builder, returned, [given[0]] * returned.count
    )


@for_kernels
def corner_node(corner: SmallIds, b: int, a: int, lane: Lane) -> Any:
    """Return the node ids at corner ``a`` of block ``b``, for :func:`at`."""
    every = takes_all(lane)

    def code(context: Any, builder: Any, values: Any) -> Any:
        corner_, b_, a_, lane_ = values
        kind, last = (ir.VectorType(I32, WIDTH), ZERO) if every else (I32, lane_)
        where = address(context, builder, corner, corner_, [b_, a_, last], kind)
        ids = builder.load(where, align=4)
        return ids if every else builder.sext(ids, I64)

    returned = LANE_IDS if every else types.intp
    return returned(corner, types.intp, types.intp, lane_of(lane)), code


@for_kernels
def first_node(corner: SmallIds, b: int, a: int, lane: Lane) -> Any:
    """Return the node id at corner ``a`` of block ``b``; of the first place if all are selected."""

    def code(context: Any, builder: Any, values: Any) -> Any:
        corner_, b_, a_, lane_ = values
        index = [b_, a_, ZERO if takes_all(lane) else lane_]
        return builder.sext(
            builder.load(address(context, builder, corner, corner_, index, I32)), I64
        )

    return types.intp(corner, types.intp, types.intp, lane_of(lane)), code


@for_kernels
def scatter_add(
    rows: Floats, corner: SmallIds, b: int, a: int, lane: Lane, force: tuple[Number, ...]
) -> Any:
    """Add six numbers to the rows : (n, 8) of the nodes at corner ``a``, lane after lane."""

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


@for_kernels
def at(values: Floats, n: Any, c: int, lane: Lane) -> Number:
    """Return column ``c`` of values : (m, 3), one column after the other, at nodes.

    n : of :func:`corner_node`; or a node id, and with lanes the eight from there on.
    """
    of_ids = isinstance(n, LaneIdsType)

    def code(context: Any, builder: Any, given: Any) -> Any:
        values_, n_, c_, _ = given
        if of_ids:
            column = address(context, builder, values, values_, [ZERO, c_], DOUBLE)
            return gathered(builder, column, n_)
        kind = LANES if takes_all(lane) else DOUBLE
        return builder.load(address(context, builder, values, values_, [n_, c_], kind), align=8)

    row = n if of_ids else types.intp
    return numbers_of(lane)(values, row, types.intp, lane_of(lane)), code


@always_inline
def vector_at(values: Floats, n: Any, lane: Lane) -> Vector:
    """Return the three columns of :func:`at`."""
    return at(values, n, 0, lane), at(values, n, 1, lane), at(values, n, 2, lane)


@for_kernels
def along(values: Floats, n: int, lane: Lane) -> Number:
    """Return values : (m,) at node ``n``, or at the eight nodes from ``n``."""

    def code(context: Any, builder: Any, given: Any) -> Any:
        kind = LANES if takes_all(lane) else DOUBLE
        return builder.load(address(context, builder, values, given[0], [given[1]], kind), align=8)

    return numbers_of(lane)(values, types.intp, lane_of(lane)), code


@for_kernels
def put_at(values: Floats, n: int, c: int, lane: Lane, value: Number) -> Any:
    """Write column ``c`` of values : (m, 3) at node ``n``, or at the eight nodes from ``n``."""

    def code(context: Any, builder: Any, given: Any) -> None:
        values_, n_, c_, _, value_ = given
        where = address(context, builder, values, values_, [n_, c_], value_.type)
        builder.store(value_, where, align=8)

    return types.void(values, types.intp, types.intp, lane_of(lane), numbers_of(lane)), code


def _rows_at(context: Any, builder: Any, kind: Any, lane: Any, given: Any) -> list[Any]:
    """Return the addresses of the row at a node, or of eight rows, from rows and n."""
    rows, n = given[:2]
    places = (shifted(builder, n, i) for i in range(WIDTH if takes_all(lane) else 1))
    return [row_address(context, builder, kind, rows, place) for place in places]


@for_kernels
def row_columns(rows: Floats, n: int, lane: Lane) -> tuple[Number, ...]:
    """Return the first six columns of rows : (m, 8) at node ``n``, or the eight from ``n``."""
    returned = types.UniTuple(numbers_of(lane), 6)

    def code(context: Any, builder: Any, given: Any) -> Any:
        where = _rows_at(context, builder, rows, lane, given)
        loaded = [builder.load(row, align=8) for row in where]
        if takes_all(lane):
            columns = transposed(builder, loaded)[:6]
        else:
            columns = [builder.extract_element(loaded[0], ir.Constant(I32, c)) for c in range(6)]
        return context.make_tuple(builder, returned, columns)

    return returned(rows, types.intp, lane_of(lane)), code


@for_kernels
def add_row_columns(rows: Floats, n: int, lane: Lane, columns: Vector) -> Any:
    """Add to the first three columns of rows : (m, 8) at node ``n``, or at the eight from ``n``."""

    def code(context: Any, builder: Any, given: Any) -> None:
        added = cgutils.unpack_tuple(builder, given[3], 3)
        where = _rows_at(context, builder, rows, lane, given)
        if not takes_all(lane):
            _add_to_row(builder, where[0], added)
            return
        padded = [*added, *[ZEROS] * (WIDTH - 3)]
        for place, row in zip(where, transposed(builder, padded), strict=True):
            add_to(builder, place, row)

    taken = types.UniTuple(numbers_of(lane), 3)
    return types.void(rows, types.intp, lane_of(lane), taken), code


@for_kernels
def zero(lane: Lane) -> Number:
    """Return zero, to start a sum."""
    nothing = ZEROS if takes_all(lane) else ir.Constant(DOUBLE, 0.0)
    return numbers_of(lane)(lane_of(lane)), lambda context, builder, given: nothing


@for_kernels
def total(value: Number) -> Any:
    """Return the sum over the lanes from the first to the last."""
    if not isinstance(value, LanesType):
        return types.float64(types.float64), lambda context, builder, given: given[0]

    def code(context: Any, builder: Any, given: Any) -> Any:
        lanes = [builder.extract_element(given[0], ir.Constant(I32, k)) for k in range(WIDTH)]
        return functools.reduce(builder.fadd, lanes)

    return types.float64(value), code


@for_kernels
def multiply_add(a: Number, b: Number, c: Number) -> Number:
    """Return a b + c, rounded once where the processor can.

    In a b + c d the compiler may fuse either product with the sum, differently in each kernel; this
    fixes the choice where two kernels must give bitwise identical results.
    """
    kind = DOUBLES if isinstance(a, LanesType) else types.float64
    return kind(kind, kind, kind), lambda context, builder, given: called(
        builder, "fmuladd", *given
    )
