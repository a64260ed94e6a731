"""Choices and square roots of numbers, which material laws need besides + - * /.

As in :mod:`shellcut.numerics.lanes` the same call works on one float or on all lanes of a block.
Lanes cannot branch; :func:`where_above` selects, lane by lane, one of two computed numbers, and on
:func:`any_above` a function may branch: to leave out work that no lane needs, or to end an
iteration.
"""

# Numba's and llvmlite's calls have no types.
# mypy: disable-error-code="no-untyped-call"

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba import types

from shellcut.arrays import Number

from .intrinsics import in_kernels
from .lane_arithmetic import broadcast, called
from .lane_instructions import DOUBLE, DOUBLES, LANES, WIDTH, ZEROS, LanesType


def _number(*kinds: Any) -> Any:
    """Return the common type of some numbers: lanes if one of them is lanes."""
    return DOUBLES if any(isinstance(kind, LanesType) for kind in kinds) else types.float64


def zero_like(a: Number) -> Number:
    """Return zero, or lanes of zeros, as ``a`` is."""
    none = np.zeros_like(a)
    return none if np.ndim(none) else 0.0


@in_kernels(zero_like)
def _zero_like(a: Any) -> Any:
    nothing = ZEROS if isinstance(a, LanesType) else ir.Constant(DOUBLE, 0.0)
    return _number(a)(a), lambda context, builder, given: nothing


def where_above(a: Number, b: Number, yes: Number, no: Number) -> Number:
    """Return ``yes`` where a > b, else ``no``, also for nan."""
    chosen: Any = np.where(np.asarray(a) > b, yes, no)
    return chosen if chosen.ndim else float(chosen)


@in_kernels(where_above)
def _where_above(*kinds: Any) -> Any:
    number = _number(*kinds)

    def code(context: Any, builder: Any, given: Any) -> Any:
        if number == DOUBLES:
            given = [v if v.type == LANES else broadcast(builder, v) for v in given]
        return builder.select(builder.fcmp_ordered(">", *given[:2]), *given[2:])

    return number(*map(_number, kinds)), code


def larger(a: Number, b: Number) -> Number:
    """Return the larger of two numbers; the first if they are equal or ``b`` is nan."""
    return where_above(b, a, b, a)


@in_kernels(larger)
def _larger(a: Any, b: Any) -> Any:
    _, choose = _where_above(b, a, b, a)

    def code(context: Any, builder: Any, given: Any) -> Any:
        return choose(context, builder, [*reversed(given), *reversed(given)])

    return _number(a, b)(_number(a), _number(b)), code


def square_root(a: Number) -> Number:
    """Return the square root."""
    root = np.sqrt(a)
    return root if np.ndim(root) else float(root)


@in_kernels(square_root)
def _square_root(a: Any) -> Any:
    return _number(a)(_number(a)), lambda context, builder, given: called(builder, "sqrt", *given)


def any_above(a: Number, b: float) -> bool:
    """Whether a > b in any lane."""
    return bool(np.any(np.asarray(a) > b))


@in_kernels(any_above)
def _any_above(a: Any, b: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> Any:
        value, limit = given
        if value.type != LANES:
            return builder.fcmp_ordered(">", value, limit)
        above = builder.fcmp_ordered(">", value, broadcast(builder, limit))
        mask = builder.bitcast(above, ir.IntType(WIDTH))
        return builder.icmp_unsigned("!=", mask, ir.Constant(mask.type, 0))

    return types.boolean(_number(a), types.float64), code
