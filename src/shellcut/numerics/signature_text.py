"""Signatures of kernels as plain data, for a file that lists which kernels to compile.

With the list a first run compiles them on all cores before it begins, half as long on two; without,
each in turn on one core when it is called. A release is compiled from it, too.

==========================  ======================================================================
``"float64"``               a number, or ``"none"``
``"float64[2F]"``           an array with its dimensions and layout, ``"float64[2C!]"`` if read-only
``["a.b:Table", ...]``      a named tuple of class ``Table`` in module ``a.b``, and its fields
``["tuple", ...]``          any other tuple
``["address", table]``      the address of a table (:mod:`shellcut.numerics.table_address`)
==========================  ======================================================================
"""

# Numba's types have no types.
# mypy: disable-error-code="no-untyped-call,attr-defined,arg-type"

from __future__ import annotations

import importlib
import re
from typing import Any

from numba.core import types

from .borrowed import AddressType

_ARRAY = re.compile(r"(\w+)\[(\d)([CFA])(!?)\]")


def written(kind: Any) -> Any:
    """Return a type of Numba's as plain data.

    Raises
    ------
    TypeError
        If it is of a kind that is not listed above, as a law of the material.
    """
    if isinstance(kind, types.Array):
        return f"{kind.dtype}[{kind.ndim}{kind.layout}{'' if kind.mutable else '!'}]"
    if isinstance(kind, AddressType):
        return ["address", written(kind.kind)]
    if isinstance(kind, types.BaseNamedTuple):
        table = kind.instance_class
        return [f"{table.__module__}:{table.__qualname__}", *map(written, kind.types)]
    if isinstance(kind, types.BaseTuple):
        return ["tuple", *map(written, kind.types)]
    if isinstance(kind, (types.Number, types.Boolean, types.NoneType)):
        return str(kind)
    raise TypeError(f"{kind} is not written")


def read(data: Any) -> Any:
    """Return the type that :func:`written` gave as ``data``."""
    if isinstance(data, str):
        if array := _ARRAY.fullmatch(data):
            number, n, layout, locked = array.groups()
            return types.Array(read(number), int(n), layout, readonly=bool(locked))
        return getattr(types, "boolean" if data == "bool" else data)
    name, *fields = data
    if name == "address":
        return AddressType(read(fields[0]))
    kinds = tuple(map(read, fields))
    if name == "tuple":
        return types.Tuple(kinds)
    return types.BaseTuple.from_types(kinds, named(name))


def named(name: str) -> Any:
    """Return the object of a module with a name, ``"module:name"``."""
    module, _, inside = name.partition(":")
    return getattr(importlib.import_module(module), inside)
