"""The types of lanes and the LLVM instructions that load and store them.

Kernels call these through :mod:`shellcut.numerics.lanes`, which explains them.

==============  =========================================
``DOUBLES``     ``<8 x double>``, one number of each quad
``LANE_IDS``    ``<8 x i32>``, a node id of each
==============  =========================================
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="arg-type, call-arg, no-untyped-call, untyped-decorator"

from __future__ import annotations

import functools
from typing import Any, TypeAlias

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, models, register_model

from .inlined_code import InlinedCompiler

WIDTH = 8
"""Doubles in one vector; nodes are treated in groups of this size."""

Lane: TypeAlias = int | None


def takes_all(lane: Any) -> bool:
    """Whether the type of ``lane`` means all of a block."""
    return isinstance(lane, types.NoneType)


CACHE_LINE = 64
"""Bytes."""

OVERLOAD_OPTIONS = {
    "forceinline": True,
    "fastmath": {"contract"},
    "error_model": "numpy",
    "no_cpython_wrapper": True,
    "no_cfunc_wrapper": True,
    "pipeline_class": InlinedCompiler,
}
"""Options for the functions of lanes that kernels call: those of ``always_inline``."""

_I1, I8, I32, I64 = (ir.IntType(bits) for bits in (1, 8, 32, 64))
_DOUBLE = ir.DoubleType()
LANES, LANES_NAME = ir.VectorType(_DOUBLE, WIDTH), f"v{WIDTH}f64"
"""Lanes as LLVM's type, and their suffix in the names of its functions."""
_IDS = ir.VectorType(I32, WIDTH)


# ---------------------------------------------------------------- the types


class LanesType(types.Type):
    """Eight doubles."""


class LaneIdsType(types.Type):
    """Eight node ids."""


DOUBLES, LANE_IDS = LanesType("Lanes"), LaneIdsType("LaneIds")


@register_model(LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, front_end_type: Any) -> None:
        super().__init__(manager, front_end_type, LANES)


@register_model(LaneIdsType)
class _LaneIdsModel(models.PrimitiveModel):
    def __init__(self, manager: Any, front_end_type: Any) -> None:
        super().__init__(manager, front_end_type, _IDS)


# ---------------------------------------------------------------- addresses and transposition


def vector_constant(kind: Any, values: list[int]) -> Any:
    """Return a constant vector of integers."""
    return ir.Constant(ir.VectorType(kind, len(values)), values)


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: list[Any]) -> Any:
    made = context.make_array(array_type)(context, builder, array)
    shape = cgutils.unpack_tuple(builder, made.shape, array_type.ndim)
    strides = cgutils.unpack_tuple(builder, made.strides, array_type.ndim)
    return cgutils.get_item_pointer2(
        context, builder, made.data, shape, strides, array_type.layout, index, wraparound=False
    )


def vector_address(
    context: Any, builder: Any, array_type: Any, array: Any, index: list[Any], kind: Any
) -> Any:
    """Return the address of an element of an array, as a pointer to ``kind``."""
    address = _address(context, builder, array_type, array, index)
    return builder.bitcast(address, kind.as_pointer())


def _row_address(context: Any, builder: Any, array_type: Any, array: Any, row: Any) -> Any:
    """Return the address of a row of a C-ordered (n, 8) array, by a shift instead of a product."""
    made = context.make_array(array_type)(context, builder, array)
    return builder.gep(builder.bitcast(made.data, LANES.as_pointer()), [row])


def _transpose(builder: Any, rows: list[Any]) -> list[Any]:
    """Transpose eight rows into eight columns by 2 x 2, 4 x 4 and 8 x 8 exchanges.

    Fewer than eight are padded: the last columns are then meaningless.
    """
    rows = [*rows, *[ir.Constant(rows[0].type, ir.Undefined)] * (WIDTH - len(rows))]

    def exchange(a: Any, b: Any, order: list[int]) -> Any:
        return builder.shuffle_vector(a, b, vector_constant(I32, order))

    pairs = [None] * 8
    for k in range(0, 8, 2):
        pairs[k] = exchange(rows[k], rows[k + 1], [0, 8, 2, 10, 4, 12, 6, 14])
        pairs[k + 1] = exchange(rows[k], rows[k + 1], [1, 9, 3, 11, 5, 13, 7, 15])
    fours = [None] * 8
    for k in (0, 1, 4, 5):
        fours[k] = exchange(pairs[k], pairs[k + 2], [0, 1, 8, 9, 4, 5, 12, 13])
        fours[k + 2] = exchange(pairs[k], pairs[k + 2], [2, 3, 10, 11, 6, 7, 14, 15])
    columns = [None] * 8
    for k in range(4):
        columns[k] = exchange(fours[k], fours[k + 4], [0, 1, 2, 3, 8, 9, 10, 11])
        columns[k + 4] = exchange(fours[k], fours[k + 4], [4, 5, 6, 7, 12, 13, 14, 15])
    return columns


_ZERO = ir.Constant(I64, 0)


@intrinsic
def load_lanes(typing_context: Any, array: Any, index: Any) -> Any:
    """Load eight numbers, doubles or node ids, that begin at an element of an array."""
    kind, vector, size = (LANE_IDS, _IDS, 4) if array.dtype == types.int32 else (DOUBLES, LANES, 8)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = cgutils.unpack_tuple(builder, args[1], array.ndim)
        where = vector_address(context, builder, array, args[0], place, vector)
        return builder.load(where, align=size)

    return kind(array, types.UniTuple(types.intp, array.ndim)), generate


@intrinsic
def store_lanes(typing_context: Any, array: Any, index: Any, value: Any) -> Any:
    """Store eight doubles that begin at an element of an array."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        place = cgutils.unpack_tuple(builder, args[1], array.ndim)
        where = vector_address(context, builder, array, args[0], place, LANES)
        builder.store(args[2], where, align=8)
        return context.get_dummy_value()

    return types.void(array, types.UniTuple(types.intp, array.ndim), DOUBLES), generate


def _numbers_from(context: Any, builder: Any, sig: Any, args: Any, n: int) -> list[Any]:
    """Return the addresses of n numbers, of one quad or all lanes; args: table, b, first, lane."""
    table, b, first, lane = args[:4]
    one = not takes_all(sig.args[3])
    kind = _DOUBLE if one else LANES
    places = (builder.add(first, ir.Constant(I64, i)) for i in range(n))
    index = ([b, place, lane if one else _ZERO] for place in places)
    return [vector_address(context, builder, sig.args[0], table, at, kind) for at in index]


def _places_of(table: Any, lane: Any) -> tuple[Any, ...]:
    return table, types.intp, types.intp, lane if takes_all(lane) else types.intp


@functools.cache
def numbers_loader(n: int) -> Any:
    """Return an intrinsic that loads n numbers of a block from ``first`` on, as a tuple."""

    @intrinsic
    def load(typing_context: Any, table: Any, b: Any, first: Any, lane: Any) -> Any:
        returns = types.UniTuple(DOUBLES if takes_all(lane) else types.float64, n)

        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            places = _numbers_from(context, builder, sig, args, n)
            loaded = [builder.load(where, align=8) for where in places]
            return context.make_tuple(builder, returns, loaded)

        return returns(*_places_of(table, lane)), generate

    return load


@intrinsic
def store_numbers(
    typing_context: Any, table: Any, b: Any, first: Any, lane: Any, values: Any
) -> Any:
    """Store the numbers of a tuple from number ``first`` of a block on."""
    n = len(values)
    kinds = types.UniTuple(DOUBLES if takes_all(lane) else types.float64, n)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        given = cgutils.unpack_tuple(builder, args[4], n)
        places = _numbers_from(context, builder, sig, args, n)
        for where, value in zip(places, given, strict=True):
            builder.store(value, where, align=8)
        return context.get_dummy_value()

    return types.void(*_places_of(table, lane), kinds), generate


@intrinsic
def gather_column(typing_context: Any, values: Any, c: Any, ids: Any) -> Any:
    """Load column ``c`` at nodes."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        column = _address(context, builder, values, args[0], [_ZERO, args[1]])
        # llvmlite cannot build one address per lane from a single base; LLVM can, and then needs no
        # vector of addresses in registers.
        where = builder.gep(column, [_ZERO])
        where.indices = [args[2]]
        where.operands = [column, args[2]]
        where.type = ir.VectorType(_DOUBLE.as_pointer(), WIDTH)
        mask = vector_constant(_I1, [1] * WIDTH)
        function = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(LANES, [where.type, I32, mask.type, LANES]),
            f"llvm.masked.gather.{LANES_NAME}.v{WIDTH}p0",
        )
        nothing = ir.Constant(LANES, ir.Undefined)
        return builder.call(function, [where, ir.Constant(I32, 8), mask, nothing])

    return DOUBLES(values, types.intp, ids), generate


@intrinsic
def scatter_add_rows(
    typing_context: Any, rows: Any, corner: Any, b: Any, a: Any, force: Any
) -> Any:
    """Add six numbers per lane to the rows of the nodes at a corner, lane after lane."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        columns = cgutils.unpack_tuple(builder, args[4], 6)
        for lane, row in enumerate(_transpose(builder, columns)):
            index = [args[2], args[3], ir.Constant(I64, lane)]
            node = builder.load(_address(context, builder, corner, args[1], index))
            where = _row_address(context, builder, rows, args[0], builder.sext(node, I64))
            builder.store(builder.fadd(builder.load(where, align=8), row), where, align=8)
        return context.get_dummy_value()

    return types.void(rows, corner, types.intp, types.intp, force), generate


@intrinsic
def load_row_columns(typing_context: Any, rows: Any, n: Any) -> Any:
    """Load the first six columns of eight rows."""
    returns = types.UniTuple(DOUBLES, 6)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        loaded = []
        for lane in range(WIDTH):
            row = builder.add(args[1], ir.Constant(I64, lane))
            where = _row_address(context, builder, rows, args[0], row)
            loaded.append(builder.load(where, align=8))
        return context.make_tuple(builder, returns, _transpose(builder, loaded)[:6])

    return returns(rows, types.intp), generate


@intrinsic
def add_to_rows(typing_context: Any, rows: Any, n: Any, columns: Any) -> Any:
    """Add columns, padded with zeros, to eight rows."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        given = cgutils.unpack_tuple(builder, args[2], columns.count)
        nothing = [ir.Constant(LANES, [0.0] * WIDTH)] * (WIDTH - columns.count)
        for lane, row in enumerate(_transpose(builder, [*given, *nothing])):
            index = builder.add(args[1], ir.Constant(I64, lane))
            where = _row_address(context, builder, rows, args[0], index)
            builder.store(builder.fadd(builder.load(where, align=8), row), where, align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp, columns), generate


@intrinsic
def zero_rows(typing_context: Any, rows: Any, n: Any) -> Any:
    """Clear eight rows."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        for lane in range(WIDTH):
            row = builder.add(args[1], ir.Constant(I64, lane))
            where = _row_address(context, builder, rows, args[0], row)
            builder.store(ir.Constant(LANES, [0.0] * WIDTH), where, align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp), generate


@intrinsic
def no_lanes(typing_context: Any) -> Any:
    """Return zeros."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return ir.Constant(LANES, [0.0] * WIDTH)

    return DOUBLES(), generate
