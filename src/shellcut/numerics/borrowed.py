"""Tables whose arrays do not count their references, for the loops of kernels.

An array that is taken out of a table inside a kernel counts its references, 5 ns each time and in
every round of a loop; a term of the tool touches dozens of arrays for each node or cable. A kernel
therefore begins with ``tables = borrowed(tables)``. The same line reads a table that has been laid
out beforehand (:mod:`shellcut.numerics.table_address`).
"""

# Numba's extension calls are typed for users of intrinsics, not for those who write them.
# mypy: disable-error-code="no-untyped-call,no-untyped-def,call-arg,var-annotated,arg-type"

from __future__ import annotations

from typing import Any, TypeVar

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import models, register_model

from .intrinsics import in_kernels

T = TypeVar("T")


def borrowed(table: T) -> T:
    """Return a table or array that counts no references, for use within a kernel.

    The caller of the kernel keeps the arrays alive meanwhile; the kernel must not return them.
    """
    return table


borrowed.owns_nothing = True  # type: ignore[attr-defined]  # for numerics/inlined_code.py


def lent(table: T) -> T:
    """Return the address of a borrowed table, to pass to a function that is not inlined.

    Such a function would take an array in ten pieces. It begins with ``table = borrowed(table)``.
    Arrays that the kernel itself has made must not be lent: their memory may be freed.
    """
    return table


class AddressType(types.Type):
    """Numba's type of the address of a table of a certain kind."""

    def __init__(self, kind: Any) -> None:
        self.kind = kind
        super().__init__(name=f"Address({kind})")


@register_model(AddressType)
class _AddressModel(models.OpaqueModel):
    """A pointer."""


@in_kernels(borrowed)
def _borrowed(table: Any) -> Any:
    if isinstance(table, types.NoneType):
        return table(table), lambda context, builder, given: given[0]
    kind = table.kind if isinstance(table, AddressType) else table

    def code(context: Any, builder: Any, given: Any) -> Any:
        (value,) = given
        if table is not kind:
            laid_out = ir.PointerType(context.get_value_type(kind))
            value = builder.load(builder.bitcast(value, laid_out))
        return without_owner(context, builder, kind, value)

    return kind(table), code


@in_kernels(lent)
def _lent(table: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> Any:
        bare = without_owner(context, builder, table, given[0])
        return builder.bitcast(cgutils.alloca_once_value(builder, bare), cgutils.voidptr_t)

    return AddressType(table)(table), code


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
