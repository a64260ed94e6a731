"""Tables whose arrays do not count their references, for the loops of kernels.

An array that is taken out of a table inside a kernel counts its references, 5 ns each time and in
every round of a loop; a term of the tool touches dozens of arrays for each node or cable. A kernel
therefore begins with ``tables = borrowed(tables)``. The same line reads a table that has been laid
out beforehand (:mod:`shellcut.numerics.held_table`).
"""

# Numba's extension calls are typed for users of intrinsics, not for those who write them.
# mypy: disable-error-code="no-untyped-call,no-untyped-def,call-arg,var-annotated,arg-type"

from __future__ import annotations

from typing import Any, TypeVar

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic, models, overload, register_model

from .lane_instructions import OVERLOAD_OPTIONS

T = TypeVar("T")


def borrowed(table: T) -> T:
    """Return a table or array that counts no references, for use within a kernel.

    The caller of the kernel holds the arrays all the while; the kernel must not return them.
    """
    return table


borrowed.owns_nothing = True  # type: ignore[attr-defined]  # for numerics/inlined_code.py


def lent(table: T) -> T:
    """Return the address of a borrowed table, to pass to a function that is not inlined.

    Such a function would take an array in ten pieces. It begins with ``table = borrowed(table)``.
    Arrays that the kernel itself has made must not be lent: their memory may be gone.
    """
    return table


class HeldType(types.Type):
    """Numba's type of the address of a table of a certain kind."""

    def __init__(self, kind: Any) -> None:
        self.kind = kind
        super().__init__(name=f"Held({kind})")


@register_model(HeldType)
class _HeldModel(models.OpaqueModel):
    """A pointer."""


# Inlined by force: behind a call, which LLVM leaves in large kernels, it does not see that nothing
# is owned, and every use of an array counts again (the cables' kernel took three times as long).
@overload(borrowed, jit_options=OVERLOAD_OPTIONS)
def _borrowed_in_kernel(table):
    if isinstance(table, HeldType):
        return lambda table: _read(table)
    if isinstance(table, types.NoneType):
        return lambda table: None
    return lambda table: _borrowed(table)


@intrinsic
def _borrowed(_typing, table):
    def code(context, builder, signature, arguments):
        return without_owner(context, builder, signature.args[0], arguments[0])

    return table(table), code


# In the kernel itself, whose memory the address must stay.
@overload(lent, inline="always")
def _lent_in_kernel(table):
    return lambda table: _lend(table)


@intrinsic
def _lend(_typing, table):
    def code(context, builder, signature, arguments):
        bare = without_owner(context, builder, signature.args[0], arguments[0])
        return builder.bitcast(cgutils.alloca_once_value(builder, bare), cgutils.voidptr_t)

    return HeldType(table)(table), code


@intrinsic
def _read(_typing, held):
    def code(context, builder, signature, arguments):
        kind = context.get_value_type(signature.return_type)
        table = builder.load(builder.bitcast(arguments[0], ir.PointerType(kind)))
        return without_owner(context, builder, signature.return_type, table)

    return held.kind(held), code


def without_owner(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """Return code for an array or tuple without the pointers to the owners of its memory."""
    if isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value)
        for owner in ("meminfo", "parent"):
            setattr(array, owner, cgutils.get_null_value(getattr(array, owner).type))
        return array._getvalue()
    if isinstance(kind, types.BaseTuple):
        fields = [
            without_owner(context, builder, field, builder.extract_value(value, i))
            for i, field in enumerate(kind)
        ]
        return context.make_tuple(builder, kind, fields)
    return value
