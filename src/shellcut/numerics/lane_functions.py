"""Arithmetic with lanes: + - * / and negation, choices, square roots.

As in :mod:`shellcut.numerics.lanes` the same call works on one float or on all lanes of a block.
Lanes cannot branch; :func:`where_above` selects, lane by lane, one of two computed numbers, and on
:func:`any_above` a function may branch: to leave out work that no lane needs, or to end an
iteration.
"""

# Numba's and llvmlite's calls have no types.
# mypy: disable-error-code="no-untyped-call, untyped-decorator"

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature

from shellcut.arrays import Number

from .intrinsics import in_kernels
from .lane_instructions import (
    DOUBLE,
    DOUBLES,
    I32,
    LANES,
    LANES_NAME,
    WIDTH,
    ZEROS,
    LanesType,
    vector_constant,
)

CONTRACT = ("contract",)
"""Flag of what may become one fused instruction."""


def broadcast(builder: Any, value: Any) -> Any:
    """Return lanes that all contain the same double."""
    nothing = ir.Constant(LANES, ir.Undefined)
    first = builder.insert_element(nothing, value, ir.Constant(I32, 0))
    return builder.shuffle_vector(first, first, vector_constant(I32, [0] * WIDTH))


def called(builder: Any, name: str, *given: Any) -> Any:
    """Return what a function of LLVM's gives of doubles, or of lanes."""
    kind = given[0].type
    suffix = LANES_NAME if kind == LANES else "f64"
    function = cgutils.get_or_insert_function(
        builder.module, ir.FunctionType(kind, [kind] * len(given)), f"llvm.{name}.{suffix}"
    )
    return builder.call(function, given)


def _add_binary_operator(op: Callable[..., Any], instruction: str) -> None:
    @infer_global(op)
    class _Typing(AbstractTemplate):
        def generic(self, args: Any, kws: Any) -> Any:
            if DOUBLES not in args or not all(isinstance(a, LanesType | types.Float) for a in args):
                return None
            return signature(DOUBLES, *(a if a == DOUBLES else types.float64 for a in args))

    def lower(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        operands = [
            a if t == DOUBLES else broadcast(builder, a)
            for a, t in zip(args, sig.args, strict=True)
        ]
        return getattr(builder, instruction)(*operands, flags=CONTRACT)

    for pair in ((LanesType,) * 2, (LanesType, types.Float), (types.Float, LanesType)):
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
        return signature(args[0], args[0]) if isinstance(args[0], LanesType) else None


@lower_builtin(operator.neg, LanesType)
def _negative(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.fneg(args[0])


def _number(*kinds: Any) -> Any:
    """Return the common type of some numbers: lanes if one of them is lanes."""
    return DOUBLES if any(isinstance(kind, LanesType) for kind in kinds) else types.float64


def zero_like(a: Number) -> Number:
    """Return zero, or lanes of zeros, as ``a`` is."""
    none = np.zeros_like(a)
    return none if np.ndim(none) else 0.0


@in_kernels(zero_like)
def _zero_like(a: Any) -> Any:
    nothing = ZEROS if isinstance(a, LanesType) else ir.Constant(DOUBLE, 0.0)
    return _number(a)(a), lambda context, builder, given: nothing


def where_above(a: Number, b: Number, yes: Number, no: Number) -> Number:
    """Return ``yes`` where a > b, else ``no``, also for nan."""
    chosen: Any = np.where(np.asarray(a) > b, yes, no)
    return chosen if chosen.ndim else float(chosen)


@in_kernels(where_above)
def _where_above(*kinds: Any) -> Any:
    number = _number(*kinds)

    def code(context: Any, builder: Any, given: Any) -> Any:
        if number == DOUBLES:
            given = [v if v.type == LANES else broadcast(builder, v) for v in given]
        return builder.select(builder.fcmp_ordered(">", *given[:2]), *given[2:])

    return number(*map(_number, kinds)), code


def larger(a: Number, b: Number) -> Number:
    """Return the larger of two numbers; the first if they are equal or ``b`` is nan."""
    return where_above(b, a, b, a)


@in_kernels(larger)
def _larger(a: Any, b: Any) -> Any:
    _, choose = _where_above(b, a, b, a)

    def code(context: Any, builder: Any, given: Any) -> Any:
        return choose(context, builder, [*reversed(given), *reversed(given)])

    return _number(a, b)(_number(a), _number(b)), code


def square_root(a: Number) -> Number:
    """Return the square root."""
    root = np.sqrt(a)
    return root if np.ndim(root) else float(root)


@in_kernels(square_root)
def _square_root(a: Any) -> Any:
    return _number(a)(_number(a)), lambda context, builder, given: called(builder, "sqrt", *given)


def any_above(a: Number, b: float) -> bool:
    """Whether a > b in any lane."""
    return bool(np.any(np.asarray(a) > b))


@in_kernels(any_above)
def _any_above(a: Any, b: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> Any:
        value, limit = given
        if value.type != LANES:
            return builder.fcmp_ordered(">", value, limit)
        above = builder.fcmp_ordered(">", value, broadcast(builder, limit))
        mask = builder.bitcast(above, ir.IntType(WIDTH))
        return builder.icmp_unsigned("!=", mask, ir.Constant(mask.type, 0))

    return types.boolean(_number(a), types.float64), code
