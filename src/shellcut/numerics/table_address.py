"""Tables that are laid out for kernels once, and then passed as one address.

At a call from Python Numba unpacks every array of a table: 40 ns each while it is in the cache, and
several times that within a step, when the film's own arrays have pushed the Python objects out. The
tables of contact, cables and nodes have a hundred arrays, the same ones until the next split. Their
owner lays them out once with a :class:`TableWriter`, and passes the address. The kernel begins with
``tables = borrowed(tables)`` in any case, and reads them from there.
"""

# Numba's extension calls are typed for users of intrinsics, not for those who write them.
# mypy: disable-error-code="no-untyped-call,no-untyped-def,call-arg,var-annotated,arg-type,misc"

from __future__ import annotations

from typing import Any, TypeVar, cast

import numba as nb
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.core.registry import cpu_target
from numba.extending import NativeValue, typeof_impl, unbox

from .borrowed import AddressType, without_owner
from .intrinsics import for_kernels
from .jit import kernel
from .kernel_tables import TableAddress, check_tables

T = TypeVar("T")


class TableWriter:
    """Lay out tables for kernels, all of the same types, and give their addresses.

    Examples
    --------
    >>> from typing import Annotated, NamedTuple
    >>> from shellcut.arrays import Floats
    >>> class Rod(NamedTuple):
    ...     length: Annotated[Floats, "(n,)"]
    >>> address = TableWriter()(Rod(length=np.ones(3)))
    >>> type(address).__name__, address.table.length.sum()
    ('TableAddress', 3.0)
    """

    def __init__(self) -> None:
        self._kind: Any = None
        self._lay_out: Any = None
        self._size = 0
        self._known: set[Any] = set()

    def __call__(self, table: T) -> T:
        """Return the address of a table, which kernels take in place of ``table``.

        The arrays may change their contents, not their place: the owner lays out a table anew when
        it has replaced one of them.

        Raises
        ------
        TypeError
            If an array is in the wrong field, or of another type than in the first table.
        """
        plain = _plain(table)
        if (key := _type_key(table)) not in self._known:
            self._take_kind(table, plain)
            self._known.add(key)
        memory = np.zeros(self._size, np.uint8)
        self._lay_out(plain, memory)
        address = TableAddress(memory.ctypes.data)
        address.table, address.kind, address.memory = table, self._kind, memory
        return cast("T", address)

    def _take_kind(self, table: Any, plain: Any) -> None:
        """Find Numba's type of a table, which must be that of the first one."""
        kind = nb.typeof(table)
        if self._kind is None:
            check_tables([table])
            self._kind, context, laid = kind, cpu_target.target_context, nb.typeof(plain)
            self._size = context.get_abi_sizeof(context.get_value_type(laid))
            memory = nb.typeof(np.zeros(0, np.uint8))
            self._lay_out = cast("Any", _lay_out).compile((laid, memory))
        if kind != self._kind:
            raise TypeError(f"a table was given with other types: {kind} after {self._kind}")


def _type_key(value: Any) -> Any:
    """Return what Numba's type of a table depends on, quickly.

    Tables are laid out anew after every search near the tool. Numba takes a millisecond for a table
    of fifty arrays, this a fiftieth of it.
    """
    if isinstance(value, tuple):
        return type(value), *map(_type_key, value)
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.num
    return type(value)


def _plain(table: Any) -> Any:
    """Return a table and those within it as plain tuples, which lie in memory as they do.

    What is compiled for a table, and kept in Numba's cache, then does not name its class: a cache
    that names a class which a newer version has renamed cannot be opened.
    """
    return tuple(map(_plain, table)) if isinstance(table, tuple) else table


@typeof_impl.register(TableAddress)
def _type_of(value, _context):
    return AddressType(value.kind)


@unbox(AddressType)
def _unbox(_type, value, context):
    return NativeValue(context.pyapi.long_as_voidptr(value))


@for_kernels
def _write(table, memory):
    def code(context, builder, given):
        place = context.make_array(memory)(context, builder, given[1]).data
        value = without_owner(context, builder, table, given[0])
        builder.store(value, builder.bitcast(place, ir.PointerType(value.type)))

    return types.void(table, memory), code


@kernel
def _lay_out(table: Any, memory: Any) -> None:
    """Write a table, without the owners of its arrays, to memory : (size,) bytes."""
    _write(table, memory)
