"""Choices and square roots of numbers, which material laws need besides + - * /.

As in :mod:`shellcut.numerics.lanes` the same call works on one float or on all lanes of a block.
Lanes cannot branch; :func:`where_above` selects, lane by lane, one of two computed numbers.
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="arg-type, call-arg, no-untyped-call"

from __future__ import annotations

from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic, overload

from shellcut.arrays import Number

from .lane_arithmetic import broadcast, called, of_lanes
from .lane_instructions import DOUBLES, OVERLOAD_OPTIONS, LanesType, no_lanes


@intrinsic
def _choose_lanes(typing_context: Any, a: Any, b: Any, yes: Any, no: Any) -> Any:
    taken = [v if v == DOUBLES else types.float64 for v in (a, b, yes, no)]

    def generate(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        given = [
            value if v == DOUBLES else broadcast(builder, value)
            for value, v in zip(args, sig.args, strict=True)
        ]
        above = builder.fcmp_ordered(">", given[0], given[1])
        return builder.select(above, given[2], given[3])

    return DOUBLES(*taken), generate


@of_lanes
def _root_of_lanes(builder: Any, x: Any) -> Any:
    return called(builder, "sqrt", x)


def zero_like(a: Number) -> Number:
    """Return zero, or lanes of zeros, as ``a`` is."""
    none = np.zeros_like(a)
    return none if np.ndim(none) else 0.0


@overload(zero_like, jit_options=OVERLOAD_OPTIONS)
def _zero_like(a):
    if isinstance(a, LanesType):
        return lambda a: no_lanes()
    return lambda a: 0.0


def where_above(a: Number, b: Number, yes: Number, no: Number) -> Number:
    """Return ``yes`` where a > b, else ``no``, also for nan."""
    chosen: Any = np.where(np.asarray(a) > b, yes, no)
    return chosen if chosen.ndim else float(chosen)


@overload(where_above, jit_options=OVERLOAD_OPTIONS)
def _where_above(a, b, yes, no):
    if any(isinstance(v, LanesType) for v in (a, b, yes, no)):
        return lambda a, b, yes, no: _choose_lanes(a, b, yes, no)
    return lambda a, b, yes, no: np.float64(yes) if a > b else np.float64(no)


def square_root(a: Number) -> Number:
    """Return the square root."""
    root = np.sqrt(a)
    return root if np.ndim(root) else float(root)


@overload(square_root, jit_options=OVERLOAD_OPTIONS)
def _square_root(a):
    if isinstance(a, LanesType):
        return lambda a: _root_of_lanes(a)
    return lambda a: np.sqrt(a)


def larger(a: Number, b: Number) -> Number:
    """Return the larger of two numbers; the first if they are equal or ``b`` is nan."""
    return where_above(b, a, b, a)


@overload(larger, jit_options=OVERLOAD_OPTIONS)
def _larger(a, b):
    return lambda a, b: where_above(b, a, b, a)
