"""LLVM code for arithmetic with lanes: operators, and functions of LLVM's."""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="no-untyped-call, untyped-decorator"

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature

from .lane_instructions import DOUBLES, I32, LANES, LANES_NAME, WIDTH, LanesType, vector_constant

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
