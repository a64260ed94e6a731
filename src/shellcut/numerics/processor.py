"""What a kernel asks of the processor besides arithmetic.

=============================  ==================================================================
:func:`align_stack`            the first line of a kernel with more lanes than registers
:func:`flush_subnormals`,      numbers too small for all their digits become zero in a kernel,
:func:`set_rounding`           and are as before after it
:func:`make_prefetch`          a function that asks for a block of a table that is needed soon
=============================  ==================================================================
"""

# Numba's extension calls are typed for users of intrinsics, not for those who write them.
# mypy: disable-error-code="arg-type, call-arg, no-untyped-call, untyped-decorator"

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, overload

from shellcut.arrays import Floats

from .lane_instructions import CACHE_LINE, I8, I32, I64, OVERLOAD_OPTIONS, vector_address

_ZERO = ir.Constant(I64, 0)

FLUSH = 0x8040  # of x86's MXCSR: results flushed to zero, operands taken as zero


def _on_x86(builder: Any) -> bool:
    return str(builder.module.triple).startswith(("x86_64", "amd64", "i386", "i686"))


def _of_mxcsr(builder: Any, name: str, value: Any) -> Any:
    """Load or store the setting from or to a number in memory."""
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
    """Return x86's setting of rounding and exceptions; 0 elsewhere."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        nothing = I32(0)
        return _of_mxcsr(builder, "stmxcsr", nothing) if _on_x86(builder) else nothing

    return types.int32(), generate


@intrinsic
def set_mxcsr(typing_context: Any, setting: Any) -> Any:
    """Give x86 that setting."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        if _on_x86(builder):
            _of_mxcsr(builder, "ldmxcsr", args[0])
        return context.get_dummy_value()

    return types.void(types.int32), generate


@intrinsic
def align_stack_of_function(typing_context: Any) -> Any:
    """Let the function that has this in its own body begin its stack on a cache line."""

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        attributes = builder.function.attributes
        attributes.alignstack = CACHE_LINE
        attributes.add("nounwind")  # true of all kernels; llvmlite writes no attributes without one
        return context.get_dummy_value()

    return types.void(), generate


def prefetch_lines(lines: int) -> Any:
    """Return the instruction that asks for the ``lines`` cache lines of block ``b`` of a table."""

    @intrinsic
    def ask(typing_context: Any, table: Any, b: Any) -> Any:
        def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            index = [args[1], _ZERO, _ZERO]
            first = vector_address(context, builder, table, args[0], index, I8)
            function = cgutils.get_or_insert_function(
                builder.module,
                ir.FunctionType(ir.VoidType(), [first.type, I32, I32, I32]),
                "llvm.prefetch.p0",
            )
            read, keep_near, data = I32(0), I32(3), I32(1)
            for line in range(lines):
                where = builder.gep(first, [ir.Constant(I64, line * CACHE_LINE)])
                builder.call(function, [where, read, keep_near, data])
            return context.get_dummy_value()

        return types.void(table, types.intp), generate

    return ask


def align_stack() -> None:
    """Let the kernel that calls this begin its stack on a cache line.

    More lanes are alive in a quad than there are registers. Without this LLVM puts those set aside
    anywhere, each across two cache lines, which costs a kernel a tenth of its time, more or less as
    the caller's stack lies.
    """


@overload(align_stack, inline="always")
def _aligned_stack():
    return lambda: align_stack_of_function()


def flush_subnormals() -> int:
    """Let numbers too small for all their digits be zero; return the setting before.

    Ahead of a wave a film moves by 1e-30 mm, then by 1e-40: in singles such numbers are subnormal,
    and arithmetic with them takes a hundred times as long on x86. Elsewhere this does nothing.
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
    """Take back the setting that :func:`flush_subnormals` returned."""


@overload(set_rounding, jit_options=OVERLOAD_OPTIONS)
def _restore_rounding(setting):
    return lambda setting: set_mxcsr(setting)


def make_prefetch(lines: int) -> Callable[[Floats, int], None]:
    """Return a function that asks for the ``lines`` cache lines of block ``b`` of a table.

    The hardware looks ahead along a few streams only; a quad's tables are more. The block after
    the last one does no harm.
    """
    ask = prefetch_lines(lines)

    def prefetch(table: Floats, b: int) -> None:
        pass

    @overload(prefetch, jit_options=OVERLOAD_OPTIONS)
    def _prefetch(table, b):
        return lambda table, b: ask(table, b)

    return prefetch
