"""Processor features for kernels: stack alignment, subnormals, branches.

=============================  ==================================================================
:func:`align_stack`            the first line of a kernel with more lanes than registers
:func:`flush_subnormals`,      subnormal numbers are flushed to zero in a kernel,
:func:`set_rounding`           and the setting is restored after it
:func:`not_inlined`            the first line of a function that kernels call, :func:`.jit.apart`
:func:`seldom`                 marks a branch as one that is seldom taken
=============================  ==================================================================
"""

# Numba's and llvmlite's calls have no types.
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils

from .intrinsics import for_kernels
from .lane_instructions import CACHE_LINE, I8, I32

FLUSH = 0x8040  # bits of x86's MXCSR: flush results to zero, treat operands as zero


def _on_x86(builder: Any) -> bool:
    return str(builder.module.triple).startswith(("x86_64", "amd64", "i386", "i686"))


def _of_mxcsr(builder: Any, name: str, value: Any) -> Any:
    """Load the setting from memory or store it there."""
    where = cgutils.alloca_once_value(builder, value)
    address = builder.bitcast(where, I8.as_pointer())
    function = cgutils.get_or_insert_function(
        builder.module,
        ir.FunctionType(ir.VoidType(), [address.type]),
        f"llvm.x86.sse.{name}",
    )
    builder.call(function, [address])
    return builder.load(where)


def _aligned(*marks: str) -> Any:
    """Return what aligns the stack of the function around a call, and marks that function.

    ``nounwind`` is true of all; llvmlite writes an alignment only beside an attribute.
    """

    def code(context: Any, builder: Any, given: Any) -> None:
        builder.function.attributes.alignstack = CACHE_LINE
        for mark in marks:
            builder.function.attributes.add(mark)

    return types.void(), code


@for_kernels
def align_stack() -> Any:
    """Align the stack of the calling kernel to a cache line.

    A quad has more live lanes than there are registers. Without this LLVM spills lanes across two
    cache lines each, which costs a kernel about a tenth of its time, depending on the caller's
    stack.
    """
    return _aligned("nounwind")


@for_kernels
def not_inlined() -> Any:
    """Keep the calling function apart from the kernels that call it, with a stack of its own.

    For many operations on few numbers, or that are seldom needed: their registers are then their
    own, a kernel with several calls contains them once, and compiles faster.
    """
    return _aligned("noinline", "nounwind")


@for_kernels
def seldom(condition: bool) -> Any:
    """Return a condition of a branch that is seldom true.

    The compiler then keeps in registers what the other branch needs.
    """

    def code(context: Any, builder: Any, given: Any) -> Any:
        bit = given[0].type
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(bit, [bit, bit]), "llvm.expect.i1"
        )
        return builder.call(function, [given[0], ir.Constant(bit, 0)])

    return types.boolean(types.boolean), code


@for_kernels
def flush_subnormals() -> Any:
    """Flush subnormal numbers to zero; return the previous setting.

    Far ahead of a wave a film moves by 1e-160 mm and less: products of such numbers are subnormal,
    and arithmetic with them takes a hundred times as long on x86. On other processors this does
    nothing.
    """

    def code(context: Any, builder: Any, given: Any) -> Any:
        if not _on_x86(builder):
            return I32(0)
        before = _of_mxcsr(builder, "stmxcsr", I32(0))
        _of_mxcsr(builder, "ldmxcsr", builder.or_(before, I32(FLUSH)))
        return before

    return types.int32(), code


@for_kernels
def set_rounding(setting: int) -> Any:
    """Restore the setting that :func:`flush_subnormals` returned."""

    def code(context: Any, builder: Any, given: Any) -> None:
        if _on_x86(builder):
            _of_mxcsr(builder, "ldmxcsr", given[0])

    return types.void(types.int32), code
