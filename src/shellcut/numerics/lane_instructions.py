"""The types of lanes, and the LLVM instructions that load and store them.

:mod:`shellcut.numerics.lanes` explains them and has the functions that kernels call.

==============  =========================================
``DOUBLES``     ``<8 x double>``, one number of each quad
``LANE_IDS``    ``<8 x i32>``, a node id of each
==============  =========================================
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="no-untyped-call, untyped-decorator"

from __future__ import annotations

from typing import Any, TypeAlias

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import models, register_model

WIDTH = 8
"""Doubles in one vector; nodes are treated in groups of this size."""

Lane: TypeAlias = int | None

CACHE_LINE = 64
"""Bytes."""

I1, I8, I32, I64 = (ir.IntType(bits) for bits in (1, 8, 32, 64))
DOUBLE = ir.DoubleType()
LANES, LANES_NAME = ir.VectorType(DOUBLE, WIDTH), f"v{WIDTH}f64"
"""Lanes as LLVM's type, and their suffix in the names of its functions."""
ZERO, ZEROS = ir.Constant(I64, 0), ir.Constant(LANES, [0.0] * WIDTH)


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
        super().__init__(manager, front_end_type, ir.VectorType(I32, WIDTH))


def takes_all(lane: Any) -> bool:
    """Whether the type of ``lane`` means all of a block."""
    return isinstance(lane, types.NoneType)


def numbers_of(lane: Any) -> Any:
    """Return the type of the numbers that a type of ``lane`` selects."""
    return DOUBLES if takes_all(lane) else types.float64


def lane_of(lane: Any) -> Any:
    """Return the type in which a function takes its argument ``lane``."""
    return lane if takes_all(lane) else types.intp


# ---------------------------------------------------------------- addresses and transposition


def vector_constant(kind: Any, values: list[int]) -> Any:
    """Return a constant vector of integers."""
    return ir.Constant(ir.VectorType(kind, len(values)), values)


def shifted(builder: Any, index: Any, by: int) -> Any:
    """Return an index plus a number."""
    return builder.add(index, ir.Constant(I64, by))


def address(
    context: Any, builder: Any, array_type: Any, array: Any, index: list[Any], kind: Any
) -> Any:
    """Return the address of an element of an array, as a pointer to ``kind``."""
    made = context.make_array(array_type)(context, builder, array)
    shape = cgutils.unpack_tuple(builder, made.shape, array_type.ndim)
    strides = cgutils.unpack_tuple(builder, made.strides, array_type.ndim)
    where = cgutils.get_item_pointer2(
        context, builder, made.data, shape, strides, array_type.layout, index, wraparound=False
    )
    return builder.bitcast(where, kind.as_pointer())


def row_address(context: Any, builder: Any, array_type: Any, array: Any, row: Any) -> Any:
    """Return the address of a row of a C-ordered (n, 8) array, by a shift instead of a product."""
    made = context.make_array(array_type)(context, builder, array)
    return builder.gep(builder.bitcast(made.data, LANES.as_pointer()), [row])


def add_to(builder: Any, where: Any, value: Any, flags: tuple[str, ...] = ()) -> None:
    """Add to what is stored at an address."""
    builder.store(builder.fadd(builder.load(where, align=8), value, flags=flags), where, align=8)


def gathered(builder: Any, column: Any, ids: Any) -> Any:
    """Return the doubles at eight places of a column."""
    # llvmlite cannot build one address per lane from a single base; LLVM can, and then needs no
    # vector of addresses in registers.
    where = builder.gep(column, [ZERO])
    where.indices = [ids]
    where.operands = [column, ids]
    where.type = ir.VectorType(DOUBLE.as_pointer(), WIDTH)
    mask = vector_constant(I1, [1] * WIDTH)
    function = cgutils.get_or_insert_function(
        builder.module,
        ir.FunctionType(LANES, [where.type, I32, mask.type, LANES]),
        f"llvm.masked.gather.{LANES_NAME}.v{WIDTH}p0",
    )
    nothing = ir.Constant(LANES, ir.Undefined)
    return builder.call(function, [where, ir.Constant(I32, 8), mask, nothing])


def transposed(builder: Any, rows: list[Any]) -> list[Any]:
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
