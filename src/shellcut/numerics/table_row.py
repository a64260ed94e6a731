"""A row of a table as the address of its first number, for the inner loops of kernels.

``table[k]`` makes an array that counts its references. Where a loop or a branch follows, the calls
that count stay in the machine code, and around each of them all lanes are saved to memory and read
again. The address counts nothing; it is read with ``row[i]`` like the array.
"""

# Numba's extension calls are typed for users of intrinsics, not for those who write them.
# mypy: disable-error-code="no-untyped-call,no-untyped-def,untyped-decorator,call-arg,arg-type"

from __future__ import annotations

import operator
from typing import Any

from llvmlite import ir
from numba import types
from numba.core import cgutils
from numba.core.imputils import lower_builtin
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, models, overload, register_model

from shellcut.arrays import Floats

from .lane_instructions import OVERLOAD_OPTIONS


class TableRowType(types.Type):
    """Numba's type of the address of a row of doubles."""

    def __init__(self) -> None:
        super().__init__(name="TableRow")


TABLE_ROW = TableRowType()


@register_model(TableRowType)
class _TableRowModel(models.PrimitiveModel):
    def __init__(self, manager: Any, front_end_type: Any) -> None:
        super().__init__(manager, front_end_type, ir.PointerType(ir.DoubleType()))


def table_row(table: Floats, k: int) -> Floats:
    """Return row ``k`` of a table (n, m) whose rows are contiguous."""
    row: Floats = table[k]
    return row


@overload(table_row, jit_options=OVERLOAD_OPTIONS)
def _table_row(table, k):
    return lambda table, k: _address(table, k)


@intrinsic
def _address(typing_context, table, k):
    def generate(context, builder, sig, args):
        array = context.make_array(sig.args[0])(context, builder, args[0])
        strides = cgutils.unpack_tuple(builder, array.strides, 2)
        index = context.cast(builder, args[1], sig.args[1], types.intp)
        raw = builder.bitcast(array.data, ir.PointerType(ir.IntType(8)))
        at = builder.gep(raw, [builder.mul(index, strides[0])])
        return builder.bitcast(at, ir.PointerType(ir.DoubleType()))

    return TABLE_ROW(table, k), generate


@infer_global(operator.getitem)
class _Reading(AbstractTemplate):
    def generic(self, args: Any, kws: Any) -> Any:
        if args[0] != TABLE_ROW or not isinstance(args[1], types.Integer):
            return None
        return signature(types.float64, args[0], types.intp)


@lower_builtin(operator.getitem, TableRowType, types.Integer)
def _read(context: Any, builder: Any, sig: Any, args: Any) -> Any:
    return builder.load(builder.gep(args[0], [args[1]]))
