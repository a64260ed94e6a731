"""Lanes: eight doubles, or sixteen singles, that a kernel handles as one number.

A loop over quads written with plain floats is not turned into vector instructions by the compiler:
the gathers at its start and the scatters at its end stand in the way. Lanes say it outright. The
mechanics are functions of *numbers* (:data:`shellcut._jit.Number`); given floats they treat one
quad, given lanes as many at a time as a block has.

Where a number comes from is the only difference, and the functions here hide it. Their argument
``lane`` says which of a block are meant: an integer takes one, as a float; ``None`` takes all
eight, as doubles; :data:`SIXTEEN` takes all sixteen, as singles. What is read at nodes is double
always, and :func:`narrow` makes singles of it:

=====================================  ===================================================
:func:`turns`, :func:`nth`             the visits that a block takes
:func:`pick`, :func:`put`              one number of a table in blocks, (n_block, n, 8 or 16)
:func:`corner_node`, :func:`gather`    node ids of a corner, values at these nodes
:func:`first_node`                     the first of them, for :func:`at` where they follow
                                       each other
:func:`scatter_add`                    nodal forces, added row by row, so nodes may repeat
:func:`at`, :func:`along`              values at consecutive nodes, and
:func:`put_at`                         how they are written
:func:`row_columns`,                   the first six columns of consecutive force rows,
:func:`add_row_columns`,               what is added to the first three,
:func:`put_row_columns`,               what they become, the others zero,
:func:`clear_rows`                     and how the rows are cleared
:func:`narrow`, :func:`widen`          from doubles to what is meant, and back
:func:`zero`, :func:`total`            nothing, and the sum over the lanes in their order
:func:`multiply_add`                   a b + c, one instruction where there is one
:func:`make_prefetch`                  a function that asks for a block needed soon
:func:`align_stack`                    the first line of a kernel that handles lanes
:func:`flush_subnormals`               what numbers too small do in a kernel, and
:func:`set_rounding`                   what they did before
=====================================  ===================================================

Lanes know + - * / and the change of sign, with lanes and with floats; a multiplication and an
addition may become one fused instruction, nothing is reassociated. LLVM lowers ``<8 x double>`` and
``<16 x float>`` to one AVX-512 register, two of AVX2, four of SSE or NEON. Without the compiler
(NUMBA_DISABLE_JIT=1) the same functions run on NumPy arrays.
"""

# Numba's extension calls are typed for users of intrinsics, not for those who write them.
# mypy: disable-error-code="arg-type, call-arg, no-untyped-call"

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any, TypeAlias, TypeGuard

import numpy as np
import numpy.typing as npt
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import (
    NativeValue,
    intrinsic,
    models,
    overload,
    register_model,
    typeof_impl,
    unbox,
)

from ._jit import Floats, Number, Numbers, SmallIds, Vector

WIDTH = 8
"""Doubles in one vector: nodes are taken so many at a time."""


class _Sixteen:
    """The type of :data:`SIXTEEN`."""


SIXTEEN = _Sixteen()
"""All of a block of sixteen, in single precision."""

Lane: TypeAlias = int | _Sixteen | None


def _one(lane: Lane) -> TypeGuard[int]:
    """Whether one place is meant."""
    return isinstance(lane, int | np.integer)


def block_width(lane: Lane) -> int:
    """Return how many quads a block has that is taken whole; by floats, one by one, eight."""
    return 2 * WIDTH if lane is SIXTEEN else WIDTH


def block_dtype(lane: Lane) -> npt.DTypeLike:
    """Return the kind of number that tables in blocks hold."""
    return np.float32 if lane is SIXTEEN else np.float64


_CACHE_LINE = 64

_I1, _I8, _I32, _I64 = (ir.IntType(bits) for bits in (1, 8, 32, 64))
_DOUBLE = ir.DoubleType()
_LANES = ir.VectorType(_DOUBLE, WIDTH)
_CONTRACT = ("contract",)


def aligned_zeros(shape: tuple[int, ...], dtype: npt.DTypeLike = float) -> Any:
    """Return an array of zeros that starts on a cache line, so that no vector straddles two."""
    size = int(np.prod(shape)) * np.dtype(dtype).itemsize
    raw = np.zeros(size + _CACHE_LINE, np.uint8)
    start = -raw.ctypes.data % _CACHE_LINE
    return raw[start : start + size].view(dtype).reshape(shape)


# ---------------------------------------------------------------- the types


class _LanesType(types.Type):
    """Several floating-point numbers."""

    def __init__(self, bits: int, width: int) -> None:
        self.bits, self.width = bits, width
        super().__init__(name=f"Lanes({width} x f{bits})")

    @property
    def one(self) -> Any:
        """LLVM's type of one of them."""
        return _DOUBLE if self.bits == 64 else ir.FloatType()

    @property
    def all(self) -> Any:
        """LLVM's type of all."""
        return ir.VectorType(self.one, self.width)

    @property
    def suffix(self) -> str:
        """Of the names of LLVM's functions."""
        return f"v{self.width}f{self.bits}"


class _LaneIdsType(types.Type):
    """Several node ids."""

    def __init__(self, width: int) -> None:
        self.width = width
        super().__init__(name=f"LaneIds({width})")


class _SixteenType(types.Opaque):
    pass


_DOUBLES, _SINGLES = _LanesType(64, WIDTH), _LanesType(32, 2 * WIDTH)
_WIDE = _LanesType(64, 2 * WIDTH)  # sixteen doubles: what is to become singles, and sums of them
_sixteen_type = _SixteenType("Sixteen")


@register_model(_LanesType)
class _LanesModel(models.PrimitiveModel):
    def __init__(self, manager: Any, front_end_type: Any) -> None:
        super().__init__(manager, front_end_type, front_end_type.all)


@register_model(_LaneIdsType)
class _LaneIdsModel(models.PrimitiveModel):
    def __init__(self, manager: Any, front_end_type: Any) -> None:
        super().__init__(manager, front_end_type, ir.VectorType(_I32, front_end_type.width))


register_model(_SixteenType)(models.OpaqueModel)


@typeof_impl.register(_Sixteen)
def _type_of_sixteen(value: _Sixteen, context: Any) -> Any:
    return _sixteen_type


@unbox(_SixteenType)
def _unbox_sixteen(kind: Any, value: Any, context: Any) -> Any:
    return NativeValue(context.context.get_dummy_value())


# ---------------------------------------------------------------- arithmetic


def _constant(kind: Any, values: list[int]) -> Any:
    return ir.Constant(ir.VectorType(kind, len(values)), values)


def _broadcast(builder: Any, value: Any, kind: _LanesType) -> Any:
    """Return lanes that are all one double."""
    if kind.bits == 32:
        value = builder.fptrunc(value, kind.one)
    nothing = ir.Constant(kind.all, ir.Undefined)
    one = builder.insert_element(nothing, value, ir.Constant(_I32, 0))
    return builder.shuffle_vector(one, one, _constant(_I32, [0] * kind.width))


def _add_binary_operator(op: Callable[..., Any], instruction: str) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            kinds = {a for a in args if isinstance(a, _LanesType)}
            if len(kinds) != 1 or not all(a in kinds or isinstance(a, types.Float) for a in args):
                return None
            (kind,) = kinds
            return signature(kind, *(a if a == kind else types.float64 for a in args))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        operands = [
            a if t == sig.return_type else _broadcast(builder, a, sig.return_type)
            for a, t in zip(args, sig.args, strict=True)
        ]
        return getattr(builder, instruction)(*operands, flags=_CONTRACT)

    for pair in ((_LanesType,) * 2, (_LanesType, types.Float), (types.Float, _LanesType)):
        lower_builtin(op, *pair)(lower)


for _op, _instruction in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _add_binary_operator(_op, _instruction)


@infer_global(operator.neg)
class _NegativeTyping(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        return signature(*args * 2) if isinstance(args[0], _LanesType) else None


@lower_builtin(operator.neg, _LanesType)
def _negative(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0])


# ---------------------------------------------------------------- addresses and transposition


def _address(context: Any, builder: Any, array_type: Any, array: Any, index: list[Any]) -> Any:
    made = context.make_array(array_type)(context, builder, array)
    shape = cgutils.unpack_tuple(builder, made.shape, array_type.ndim)
    strides = cgutils.unpack_tuple(builder, made.strides, array_type.ndim)
    return cgutils.get_item_pointer2(
        context, builder, made.data, shape, strides, array_type.layout, index, wraparound=False
    )


def _vector_address(
    context: Any, builder: Any, array_type: Any, array: Any, index: list[Any], kind: Any
) -> Any:
    address = _address(context, builder, array_type, array, index)
    return builder.bitcast(address, kind.as_pointer())


def _row_address(context: Any, builder: Any, array_type: Any, array: Any, row: Any) -> Any:
    """Address of a row of eight in a C-ordered (n, 8) array: a shift instead of a product."""
    made = context.make_array(array_type)(context, builder, array)
    return builder.gep(builder.bitcast(made.data, _LANES.as_pointer()), [row])


def _transpose(builder: Any, rows: list[Any]) -> list[Any]:
    """Turn eight rows into eight columns by 2 x 2, 4 x 4 and 8 x 8 exchanges.

    Fewer than eight are filled up: what then stands in the last columns means nothing.
    """
    rows = [*rows, *[ir.Constant(rows[0].type, ir.Undefined)] * (WIDTH - len(rows))]

    def exchange(a: Any, b: Any, order: list[int]) -> Any:
        return builder.shuffle_vector(a, b, _constant(_I32, order))

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


_ZERO = ir.Constant(_I64, 0)


def _of_table(table: Any) -> _LanesType:
    """Return the lanes of a table in blocks."""
    return _SINGLES if table.dtype == types.float32 else _DOUBLES


@intrinsic
def _load_block(typing_context: Any, table: Any, b: Any, k: Any) -> Any:
    kind = _of_table(table)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        index = [args[1], args[2], _ZERO]
        where = _vector_address(context, builder, table, args[0], index, kind.all)
        return builder.load(where, align=kind.bits // 8)

    return kind(table, types.intp, types.intp), generate


@intrinsic
def _store_block(typing_context: Any, table: Any, b: Any, k: Any, value: Any) -> Any:
    kind = _of_table(table)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        index = [args[1], args[2], _ZERO]
        where = _vector_address(context, builder, table, args[0], index, kind.all)
        builder.store(args[3], where, align=kind.bits // 8)
        return context.get_dummy_value()

    return types.void(table, types.intp, types.intp, kind), generate


@intrinsic
def _load_at(typing_context: Any, values: Any, n: Any, c: Any, lane: Any) -> Any:
    kind = _of_nodes(lane)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        where = _vector_address(context, builder, values, args[0], args[1:3], kind.all)
        return builder.load(where, align=8)

    return kind(values, types.intp, types.intp, lane), generate


@intrinsic
def _load_along(typing_context: Any, values: Any, n: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        where = _vector_address(context, builder, values, args[0], [args[1]], _LANES)
        return builder.load(where, align=8)

    return _DOUBLES(values, types.intp), generate


@intrinsic
def _store_at(typing_context: Any, values: Any, n: Any, c: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        where = _vector_address(context, builder, values, args[0], [args[1], args[2]], _LANES)
        builder.store(args[3], where, align=8)
        return context.get_dummy_value()

    return types.void(values, types.intp, types.intp, _DOUBLES), generate


@intrinsic
def _load_ids(typing_context: Any, corner: Any, b: Any, a: Any, lane: Any) -> Any:
    kind = _LaneIdsType(_of_nodes(lane).width)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        index = [args[1], args[2], _ZERO]
        ids = ir.VectorType(_I32, kind.width)
        where = _vector_address(context, builder, corner, args[0], index, ids)
        return builder.load(where, align=4)

    return kind(corner, types.intp, types.intp, lane), generate


@intrinsic
def _gather_column(typing_context: Any, values: Any, c: Any, ids: Any) -> Any:
    kind = _LanesType(64, ids.width)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        column = _address(context, builder, values, args[0], [_ZERO, args[1]])
        # llvmlite does not build an address per lane from one base; LLVM does, and then needs no
        # vector of addresses in registers.
        where = builder.gep(column, [_ZERO])
        where.indices = [args[2]]
        where.operands = [column, args[2]]
        where.type = ir.VectorType(_DOUBLE.as_pointer(), kind.width)
        mask = _constant(_I1, [1] * kind.width)
        function = cgutils.get_or_insert_function(
            builder.module,
            ir.FunctionType(kind.all, [where.type, _I32, mask.type, kind.all]),
            f"llvm.masked.gather.{kind.suffix}.v{kind.width}p0",
        )
        return builder.call(
            function, [where, ir.Constant(_I32, 8), mask, ir.Constant(kind.all, ir.Undefined)]
        )

    return kind(values, types.intp, ids), generate


@intrinsic
def _fewer_bits(typing_context: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fptrunc(args[0], _SINGLES.all)

    return _SINGLES(value), generate


@intrinsic
def _more_bits(typing_context: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return builder.fpext(args[0], _WIDE.all)

    return _WIDE(value), generate


@intrinsic
def _scatter_add_rows(
    typing_context: Any, rows: Any, corner: Any, b: Any, a: Any, force: Any
) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        columns = cgutils.unpack_tuple(builder, args[4], 6)
        lane = 0
        for first in range(0, force.dtype.width, WIDTH):
            for row in _transpose(builder, [_eight(builder, c, first) for c in columns]):
                index = [args[2], args[3], ir.Constant(_I64, lane)]
                node = builder.load(_address(context, builder, corner, args[1], index))
                where = _row_address(context, builder, rows, args[0], builder.sext(node, _I64))
                more = builder.fpext(row, _LANES) if force.dtype.bits == 32 else row
                builder.store(builder.fadd(builder.load(where, align=8), more), where, align=8)
                lane += 1
        return context.get_dummy_value()

    return types.void(rows, corner, types.intp, types.intp, force), generate


def _eight(builder: Any, value: Any, first: int) -> Any:
    """Return eight of the lanes."""
    if value.type.count == WIDTH:
        return value
    return builder.shuffle_vector(value, value, _constant(_I32, list(range(first, first + WIDTH))))


@intrinsic
def _load_row_columns(typing_context: Any, rows: Any, n: Any) -> Any:
    returns = types.UniTuple(_DOUBLES, 6)

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        loaded = []
        for lane in range(WIDTH):
            row = builder.add(args[1], ir.Constant(_I64, lane))
            where = _row_address(context, builder, rows, args[0], row)
            loaded.append(builder.load(where, align=8))
        return context.make_tuple(builder, returns, _transpose(builder, loaded)[:6])

    return returns(rows, types.intp), generate


def _to_rows(rows: Any, columns: Any, *, adding: bool) -> Any:
    """Return what writes columns, filled up with zeros, to eight rows or adds them."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        given = cgutils.unpack_tuple(builder, args[2], columns.count)
        nothing = [ir.Constant(_LANES, [0.0] * WIDTH)] * (WIDTH - columns.count)
        for lane, row in enumerate(_transpose(builder, [*given, *nothing])):
            index = builder.add(args[1], ir.Constant(_I64, lane))
            where = _row_address(context, builder, rows, args[0], index)
            written = builder.fadd(builder.load(where, align=8), row) if adding else row
            builder.store(written, where, align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp, columns), generate


@intrinsic
def _add_to_rows(typing_context: Any, rows: Any, n: Any, columns: Any) -> Any:
    return _to_rows(rows, columns, adding=True)


@intrinsic
def _put_into_rows(typing_context: Any, rows: Any, n: Any, columns: Any) -> Any:
    return _to_rows(rows, columns, adding=False)


@intrinsic
def _zero_rows(typing_context: Any, rows: Any, n: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        for lane in range(WIDTH):
            row = builder.add(args[1], ir.Constant(_I64, lane))
            where = _row_address(context, builder, rows, args[0], row)
            builder.store(ir.Constant(_LANES, [0.0] * WIDTH), where, align=8)
        return context.get_dummy_value()

    return types.void(rows, types.intp), generate


@intrinsic
def _no_lanes(typing_context: Any, lane: Any) -> Any:
    kind = _SINGLES if lane == _sixteen_type else _DOUBLES

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return ir.Constant(kind.all, [0.0] * kind.width)

    return kind(lane), generate


@intrinsic
def _sum_of_lanes(typing_context: Any, value: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        sum_ = builder.extract_element(args[0], ir.Constant(_I32, 0))
        for lane in range(1, value.width):
            sum_ = builder.fadd(sum_, builder.extract_element(args[0], ir.Constant(_I32, lane)))
        return sum_

    return types.float64(value), generate


@intrinsic
def _fused(typing_context: Any, a: Any, b: Any, c: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        kind = context.get_value_type(a)
        suffix = a.suffix if isinstance(a, _LanesType) else f"f{a.bitwidth}"
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(kind, [kind] * 3), f"llvm.fmuladd.{suffix}"
        )
        return builder.call(function, args)

    return (a(a, a, a) if a == b == c else None), generate


_FLUSH = 0x8040  # of x86's MXCSR: results flushed to zero, operands taken as zero


def _on_x86(builder: Any) -> bool:
    return str(builder.module.triple).startswith(("x86_64", "amd64", "i386", "i686"))


def _of_mxcsr(builder: Any, name: str, value: Any) -> Any:
    """Load or store the setting from or to a number in memory."""
    where = cgutils.alloca_once_value(builder, value)
    address = builder.bitcast(where, _I8.as_pointer())
    function = cgutils.get_or_insert_function(
        builder.module,
        ir.FunctionType(ir.VoidType(), [address.type]),
        f"llvm.x86.sse.{name}",
    )
    builder.call(function, [address])
    return builder.load(where)


@intrinsic
def _rounding(typing_context: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        nothing = _I32(0)
        return _of_mxcsr(builder, "stmxcsr", nothing) if _on_x86(builder) else nothing

    return types.int32(), generate


@intrinsic
def _set_rounding(typing_context: Any, setting: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if _on_x86(builder):
            _of_mxcsr(builder, "ldmxcsr", args[0])
        return context.get_dummy_value()

    return types.void(types.int32), generate


@intrinsic
def _align_stack(typing_context: Any) -> Any:
    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        attributes = builder.function.attributes
        attributes.alignstack = _CACHE_LINE
        attributes.add("nounwind")  # true of all kernels; llvmlite writes no attributes without one
        return context.get_dummy_value()

    return types.void(), generate


# ---------------------------------------------------------------- the functions kernels call

_OPTIONS = {"forceinline": True, "fastmath": {"contract"}, "error_model": "numpy"}


def _all(lane: Any) -> bool:
    return isinstance(lane, types.NoneType) or lane == _sixteen_type


def _of_nodes(lane: Any) -> _LanesType:
    """Return the lanes of what is read at nodes."""
    return _WIDE if lane == _sixteen_type else _DOUBLES


def turns(table: Numbers, lane: Lane) -> int:
    """Return how often a block must be visited: once by lanes, or as often as it has places."""
    return int(table.shape[2]) if _one(lane) else 1


@overload(turns, jit_options=_OPTIONS)
def _turns(table, lane):
    return (lambda table, lane: 1) if _all(lane) else (lambda table, lane: table.shape[2])


def nth(lane: Lane, turn: int) -> Lane:
    """Return the lane of a visit: all of them, or the one whose turn it is."""
    return turn if _one(lane) else lane


@overload(nth, jit_options=_OPTIONS)
def _nth(lane, turn):
    return (lambda lane, turn: lane) if _all(lane) else (lambda lane, turn: turn)


def pick(table: Numbers, b: int, k: int, lane: Lane) -> Number:
    """Return number ``k`` of block ``b`` of a table : (n_block, n, 8 or 16)."""
    return table[b, k, lane] if _one(lane) else table[b, k].copy()


@overload(pick, jit_options=_OPTIONS)
def _pick(table, b, k, lane):
    if _all(lane):
        return lambda table, b, k, lane: _load_block(table, b, k)
    return lambda table, b, k, lane: table[b, k, lane]


def put(table: Numbers, b: int, k: int, lane: Lane, value: Number) -> None:
    """Write number ``k`` of block ``b`` of a table : (n_block, n, 8 or 16)."""
    if _one(lane):
        table[b, k, lane] = value
    else:
        table[b, k] = value


@overload(put, jit_options=_OPTIONS)
def _put(table, b, k, lane, value):
    if _all(lane):
        return lambda table, b, k, lane, value: _store_block(table, b, k, value)

    def one(table, b, k, lane, value):
        table[b, k, lane] = value

    return one


def corner_node(corner: SmallIds, b: int, a: int, lane: Lane) -> Any:
    """Return the node ids at corner ``a`` of block ``b``, for :func:`gather`."""
    return int(corner[b, a, lane]) if _one(lane) else corner[b, a]


@overload(corner_node, jit_options=_OPTIONS)
def _corner_node(corner, b, a, lane):
    if _all(lane):
        return lambda corner, b, a, lane: _load_ids(corner, b, a, lane)
    return lambda corner, b, a, lane: np.int64(corner[b, a, lane])


def first_node(corner: SmallIds, b: int, a: int, lane: Lane) -> int:
    """Return the node id at corner ``a`` of block ``b``, of the first place if all are meant."""
    return int(corner[b, a, lane if _one(lane) else 0])


@overload(first_node, jit_options=_OPTIONS)
def _first_node(corner, b, a, lane):
    if _all(lane):
        return lambda corner, b, a, lane: np.int64(corner[b, a, 0])
    return lambda corner, b, a, lane: np.int64(corner[b, a, lane])


def gather(values: Floats, c: int, ids: Any) -> Number:
    """Return column ``c`` of values : (n, 3), one column after the other, at some nodes."""
    return values[ids, c]


@overload(gather, jit_options=_OPTIONS)
def _gather(values, c, ids):
    if isinstance(ids, _LaneIdsType):
        return lambda values, c, ids: _gather_column(values, c, ids)
    return lambda values, c, ids: values[ids, c]


def scatter_add(
    rows: Floats, corner: SmallIds, b: int, a: int, lane: Lane, force: tuple[Number, ...]
) -> None:
    """Add six numbers to the rows : (n, 8) of the nodes at corner ``a``, lane after lane."""
    for place in (lane,) if _one(lane) else range(corner.shape[2]):
        for c in range(6):
            rows[corner[b, a, place], c] += force[c] if _one(lane) else force[c][place]


@overload(scatter_add, jit_options=_OPTIONS)
def _scatter_add(rows, corner, b, a, lane, force):
    if _all(lane):
        return lambda rows, corner, b, a, lane, force: _scatter_add_rows(rows, corner, b, a, force)

    def one(rows, corner, b, a, lane, force):
        for c in range(6):
            rows[corner[b, a, lane], c] += force[c]

    return one


def at(values: Floats, n: int, c: int, lane: Lane) -> Number:
    """Return column ``c`` of values : (m, 3) at node ``n``, or at the 8 or 16 nodes from ``n``."""
    return values[n, c] if _one(lane) else values[n : n + block_width(lane), c].copy()


@overload(at, jit_options=_OPTIONS)
def _at(values, n, c, lane):
    if _all(lane):
        return lambda values, n, c, lane: _load_at(values, n, c, lane)
    return lambda values, n, c, lane: values[n, c]


def along(values: Floats, n: int, lane: Lane) -> Number:
    """Return values : (m,) at node ``n``, or at the eight nodes from ``n``."""
    return values[n : n + WIDTH].copy() if lane is None else values[n]


@overload(along, jit_options=_OPTIONS)
def _along(values, n, lane):
    if _all(lane):
        return lambda values, n, lane: _load_along(values, n)
    return lambda values, n, lane: values[n]


def put_at(values: Floats, n: int, c: int, lane: Lane, value: Number) -> None:
    """Write column ``c`` of values : (m, 3) at node ``n``, or at the eight nodes from ``n``."""
    if lane is None:
        values[n : n + WIDTH, c] = value
    else:
        values[n, c] = value


@overload(put_at, jit_options=_OPTIONS)
def _put_at(values, n, c, lane, value):
    if _all(lane):
        return lambda values, n, c, lane, value: _store_at(values, n, c, value)

    def one(values, n, c, lane, value):
        values[n, c] = value

    return one


def row_columns(rows: Floats, n: int, lane: Lane) -> tuple[Number, ...]:
    """Return the first six columns of rows : (m, 8) at node ``n``, or the eight from ``n``."""
    if lane is None:
        return tuple(rows[n : n + WIDTH, c].copy() for c in range(6))
    return tuple(rows[n, c] for c in range(6))


@overload(row_columns, jit_options=_OPTIONS)
def _row_columns(rows, n, lane):
    if _all(lane):
        return lambda rows, n, lane: _load_row_columns(rows, n)

    def one(rows, n, lane):
        return rows[n, 0], rows[n, 1], rows[n, 2], rows[n, 3], rows[n, 4], rows[n, 5]

    return one


def add_row_columns(rows: Floats, n: int, lane: Lane, columns: Vector) -> None:
    """Add to the first three columns of rows : (m, 8) at node ``n``, or at the eight from ``n``."""
    for c, column in enumerate(columns):
        rows[n : n + (WIDTH if lane is None else 1), c] += column


@overload(add_row_columns, jit_options=_OPTIONS)
def _add_row_columns(rows, n, lane, columns):
    if _all(lane):
        return lambda rows, n, lane, columns: _add_to_rows(rows, n, columns)

    def add(rows, n, lane, columns):
        for c in range(3):
            rows[n, c] += columns[c]

    return add


def put_row_columns(rows: Floats, n: int, lane: Lane, columns: Vector) -> None:
    """Set rows : (m, 8) at node ``n``, or the eight from ``n``: three columns, the others zero."""
    clear_rows(rows, n, lane)
    add_row_columns(rows, n, lane, columns)


@overload(put_row_columns, jit_options=_OPTIONS)
def _put_row_columns(rows, n, lane, columns):
    if _all(lane):
        return lambda rows, n, lane, columns: _put_into_rows(rows, n, columns)

    def put_one(rows, n, lane, columns):
        for c in range(3):
            rows[n, c] = columns[c]
        for c in range(3, 8):
            rows[n, c] = 0.0

    return put_one


def clear_rows(rows: Floats, n: int, lane: Lane) -> None:
    """Set rows : (m, 8) to zero at node ``n``, or at the eight nodes from ``n``."""
    rows[n : n + (WIDTH if lane is None else 1)] = 0.0


@overload(clear_rows, jit_options=_OPTIONS)
def _clear_rows(rows, n, lane):
    if _all(lane):
        return lambda rows, n, lane: _zero_rows(rows, n)

    def clear(rows, n, lane):
        for c in range(8):
            rows[n, c] = 0.0

    return clear


def narrow(value: Number, lane: Lane) -> Number:
    """Return what was read at nodes in the precision of the tables in blocks."""
    return value.astype(np.float32) if lane is SIXTEEN else value


@overload(narrow, jit_options=_OPTIONS)
def _narrow(value, lane):
    if lane == _sixteen_type:
        return lambda value, lane: _fewer_bits(value)
    return lambda value, lane: value


def widen(value: Number, lane: Lane) -> Number:
    """Return a number in double precision, to sum it over many blocks."""
    return value.astype(np.float64) if lane is SIXTEEN else value


@overload(widen, jit_options=_OPTIONS)
def _widen(value, lane):
    if lane == _sixteen_type:
        return lambda value, lane: _more_bits(value)
    return lambda value, lane: value


def zero(lane: Lane) -> Number:
    """Return nothing to begin a sum with."""
    return 0.0 if _one(lane) else np.zeros(block_width(lane), block_dtype(lane))


@overload(zero, jit_options=_OPTIONS)
def _zero(lane):
    if _all(lane):
        return lambda lane: _no_lanes(lane)
    return lambda lane: 0.0


def total(value: Number) -> float:
    """Return the sum over the lanes, doubles, from the first to the last."""
    sum_ = 0.0
    for one in np.atleast_1d(value):
        sum_ += float(one)
    return sum_


@overload(total, jit_options=_OPTIONS)
def _total(value):
    if isinstance(value, _LanesType):
        return lambda value: _sum_of_lanes(value)
    return lambda value: value


def multiply_add(a: Number, b: Number, c: Number) -> Number:
    """Return a b + c, rounded once where the processor can.

    Of a b + c d the compiler fuses either product with the sum, in one kernel this and in another
    that; this says which, where two kernels must get the same bits.
    """
    return a * b + c


@overload(multiply_add, jit_options=_OPTIONS)
def _multiply_add(a, b, c):
    if isinstance(a, _LanesType):
        return lambda a, b, c: _fused(a, b, c)
    return lambda a, b, c: _fused(np.float64(a), np.float64(b), np.float64(c))


def align_stack() -> None:
    """Let the kernel that calls this begin its stack on a cache line.

    More lanes are alive in a quad than there are registers. Without this LLVM puts those set aside
    anywhere, each across two cache lines, which costs a kernel a tenth of its time, more or less as
    the caller's stack lies.
    """


@overload(align_stack, inline="always")
def _aligned_stack():
    return lambda: _align_stack()


def flush_subnormals() -> int:
    """Let numbers too small for all their digits be zero; return the setting before.

    Ahead of a wave a film moves by 1e-30 mm, then by 1e-40: in singles such numbers are subnormal,
    and arithmetic with them takes a hundred times as long on x86. Elsewhere this does nothing.
    """
    return 0


@overload(flush_subnormals, jit_options=_OPTIONS)
def _flush_subnormals():
    def flush():
        before: int = _rounding()
        _set_rounding(before | _FLUSH)
        return before

    return flush


def set_rounding(setting: int) -> None:
    """Take back the setting that :func:`flush_subnormals` returned."""


@overload(set_rounding, jit_options=_OPTIONS)
def _restore_rounding(setting):
    return lambda setting: _set_rounding(setting)


def make_prefetch(lines: int) -> Callable[[Floats, int], None]:
    """Return a function that asks for the ``lines`` cache lines of block ``b`` of a table.

    The hardware looks ahead along a few streams only; a quad's tables are more. The block after
    the last one does no harm.
    """

    @intrinsic
    def ask(typing_context: Any, table: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            index = [args[1], _ZERO, _ZERO]
            first = _vector_address(context, builder, table, args[0], index, _I8)
            function = cgutils.get_or_insert_function(
                builder.module,
                ir.FunctionType(ir.VoidType(), [first.type, _I32, _I32, _I32]),
                "llvm.prefetch.p0",
            )
            read, keep_near, data = _I32(0), _I32(3), _I32(1)
            for line in range(lines):
                where = builder.gep(first, [ir.Constant(_I64, line * _CACHE_LINE)])
                builder.call(function, [where, read, keep_near, data])
            return context.get_dummy_value()

        return types.void(table, types.intp), generate

    def prefetch(table: Floats, b: int) -> None:
        pass

    @overload(prefetch, jit_options=_OPTIONS)
    def _prefetch(table, b):
        return lambda table, b: ask(table, b)

    return prefetch
