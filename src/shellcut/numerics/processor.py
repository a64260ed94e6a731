"""Processor features for kernels: stack alignment, subnormals, branches.

=============================  ==================================================================
:func:`align_stack`            the first line of a kernel with more lanes than registers
:func:`flush_subnormals`,      subnormal numbers are flushed to zero in a kernel,
:func:`set_rounding`           and the setting is restored after it
:func:`not_inlined`            the first line of a function that kernels call, :func:`.jit.apart`
:func:`seldom`                 marks a branch as one that is seldom taken
=============================  ==================================================================
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="arg-type, call-arg, no-untyped-call, untyped-decorator"

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from .lane_instructions import CACHE_LINE, I8, I32, OVERLOAD_OPTIONS

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


@intrinsic
def mxcsr(typing_context: Any) -> Any:
    """Return x86's floating-point setting (MXCSR); 0 elsewhere."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        nothing = I32(0)
        return _of_mxcsr(builder, "stmxcsr", nothing) if _on_x86(builder) else nothing

    return types.int32(), generate


@intrinsic
def set_mxcsr(typing_context: Any, setting: Any) -> Any:
    """Set x86's floating-point setting."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if _on_x86(builder):
            _of_mxcsr(builder, "ldmxcsr", args[0])
        return context.get_dummy_value()

    return types.void(types.int32), generate


def _marking(*attributes: str) -> Any:
    """Return an intrinsic that aligns the stack of the function around it, and marks it."""

    @intrinsic
    def mark(typing_context: Any) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            builder.function.attributes.alignstack = CACHE_LINE
            for one in attributes:
                builder.function.attributes.add(one)
            return context.get_dummy_value()

        return types.void(), generate

    return mark


# True for all kernels; llvmlite needs an attribute to write others.
_aligned, _apart = _marking("nounwind"), _marking("noinline", "nounwind")


def align_stack() -> None:
    """Align the stack of the calling kernel to a cache line.

    A quad has more live lanes than there are registers. Without this LLVM spills lanes across two
    cache lines each, which costs a kernel about a tenth of its time, depending on the caller's
    stack.
    """


@overload(align_stack, inline="always")
def _aligned_stack():
    return lambda: _aligned()


def not_inlined() -> None:
    """Keep the calling function apart from the kernels that call it, with a stack of its own.

    For many operations on few numbers, or that are seldom needed: their registers are then their
    own, a kernel with several calls holds them once, and compiles faster.
    """


@overload(not_inlined, inline="always")
def _kept_apart():
    return lambda: _apart()


def seldom(condition: bool) -> bool:
    """Return a condition that a branch asks for and that is seldom true.

    The compiler then keeps in registers what the other branch needs.
    """
    return condition


@intrinsic
def expect_false(typing_context: Any, condition: Any) -> Any:
    """Return a truth value, with the compiler told that it is most often false."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        bit = args[0].type
        function = cgutils.get_or_insert_function(
            builder.module, ir.FunctionType(bit, [bit, bit]), "llvm.expect.i1"
        )
        return builder.call(function, [args[0], ir.Constant(bit, 0)])

    return types.boolean(types.boolean), generate


# In the function that branches: the hint does not survive inlining.
@overload(seldom, inline="always")
def _seldom(condition):
    return lambda condition: expect_false(condition)


def flush_subnormals() -> int:
    """Flush subnormal numbers to zero; return the previous setting.

    Far ahead of a wave a film moves by 1e-160 mm and less: products of such numbers are subnormal,
    and arithmetic with them takes a hundred times as long on x86. On other processors this does
    nothing.
    """
    return 0


@overload(flush_subnormals, jit_options=OVERLOAD_OPTIONS)
def _flush_subnormals():
    def flush():
        before: int = mxcsr()
        set_mxcsr(before | FLUSH)
        return before

    return flush


def set_rounding(setting: int) -> None:
    """Restore the setting that :func:`flush_subnormals` returned."""


@overload(set_rounding, jit_options=OVERLOAD_OPTIONS)
def _restore_rounding(setting):
    return lambda setting: set_mxcsr(setting)
