"""Logarithm, exponential and power of numbers.

As in :mod:`shellcut.numerics.lane_functions` the same call works on one float or on all lanes of a
block. A vector call of the C library would be split into eight calls, so lanes are computed here:

* ln x with x = 2^k m, √½ <= m < √2: ln m = 2 artanh s, s = (m - 1)/(m + 1), s² < 0.0295, by the
  series of artanh to s^23, whose next term is below 2^-53;
* exp x = 2^k exp r with |r| <= ½ ln 2, by the series to r^13, with the same remainder.

Both are within two units of the last place of doubles. The series are summed in pairs, and pairs of
pairs: each product of a chain waits for the previous product.
"""

# Numba's extension calls are typed for users of intrinsics, not for their authors.
# mypy: disable-error-code="no-untyped-call, no-untyped-def"

from __future__ import annotations

from typing import Any

import numpy as np
from llvmlite import ir
from numba.extending import overload

from shellcut.arrays import Number

from .intrinsics import for_kernels
from .jit import ALWAYS_INLINED
from .lane_functions import called, where_above
from .lane_instructions import (
    I64,
    LANES,
    WIDTH,
    LanesType,
    vector_constant,
)

# Mantissa bits, bits of √½, and the exponent's bias of doubles.
_MANTISSA, _ROOT_HALF, _BIAS = 52, 0x3FE6A09E667F3BCD, 1023

_LN2 = 0.6931471805599453
_LN2_HIGH, _LN2_LOW = 0.693147180369123816490, 1.90821492927058770002e-10
_LOG2_E = 1.4426950408889634
# Beyond, 2^k leaves the normal numbers: the result is 0 or inf.
_MOST = 708.0

_INTEGERS = ir.VectorType(I64, WIDTH)


def _constants(value: int) -> Any:
    return vector_constant(I64, [value] * WIDTH)


def _bits_above_root_half(builder: Any, value: Any) -> tuple[Any, Any]:
    """Return the bits of lanes, and k of x = 2^k m as integers."""
    bits = builder.bitcast(value, _INTEGERS)
    power = builder.ashr(builder.sub(bits, _constants(_ROOT_HALF)), _constants(_MANTISSA))
    return bits, power


@for_kernels
def _binary_exponent(x: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> Any:
        return builder.sitofp(_bits_above_root_half(builder, *given)[1], LANES)

    return x(x), code


@for_kernels
def _mantissa(x: Any) -> Any:
    def code(context: Any, builder: Any, given: Any) -> Any:
        bits, power = _bits_above_root_half(builder, *given)
        shifted = builder.shl(power, _constants(_MANTISSA))
        return builder.bitcast(builder.sub(bits, shifted), LANES)

    return x(x), code


@for_kernels
def _nearest_integer(x: Any) -> Any:
    return x(x), lambda context, builder, given: called(builder, "rint", *given)


@for_kernels
def _two_to_the(k: Any) -> Any:
    """Return 2^k of lanes that contain whole numbers k of normal powers."""

    def code(context: Any, builder: Any, given: Any) -> Any:
        power = builder.add(builder.fptosi(*given, _INTEGERS), _constants(_BIAS))
        return builder.bitcast(builder.shl(power, _constants(_MANTISSA)), LANES)

    return k(k), code


def logarithm(a: Number) -> Number:
    """Return ln a of positive normal numbers."""
    log = np.log(a)
    return log if np.ndim(log) else float(log)


@overload(logarithm, jit_options=ALWAYS_INLINED)
def _logarithm(a):
    if not isinstance(a, LanesType):
        return lambda a: np.log(a)

    def of_lanes(a):
        m = _mantissa(a)
        s = (m - 1.0) / (m + 1.0)
        q = s * s
        q2 = q * q
        q4 = q2 * q2
        low = (q * (1.0 / 3.0) + 1.0) + q2 * (q * (1.0 / 7.0) + 1.0 / 5.0)
        middle = (q * (1.0 / 11.0) + 1.0 / 9.0) + q2 * (q * (1.0 / 15.0) + 1.0 / 13.0)
        high = (q * (1.0 / 19.0) + 1.0 / 17.0) + q2 * (q * (1.0 / 23.0) + 1.0 / 21.0)
        series = low + q4 * (middle + q4 * high)
        return _binary_exponent(a) * _LN2 + (s + s) * series

    return of_lanes


def exponential(a: Number) -> Number:
    """Return exp a; below -708 it is that of -708, above 708 that of 708."""
    power = np.exp(np.clip(a, -708.0, 708.0))
    return power if np.ndim(power) else float(power)


@overload(exponential, jit_options=ALWAYS_INLINED)
def _exponential(a):
    if not isinstance(a, LanesType):
        return lambda a: np.exp(min(max(a, -708.0), 708.0))

    def of_lanes(a):
        x = where_above(a, -_MOST, a, -_MOST)
        x = where_above(x, _MOST, _MOST, x)
        k = _nearest_integer(x * _LOG2_E)
        r = (x - k * _LN2_HIGH) - k * _LN2_LOW
        r2 = r * r
        r4 = r2 * r2
        low = (r * (1.0 / 6.0) + 0.5) + r2 * (r * (1.0 / 120.0) + 1.0 / 24.0)
        middle = (r * (1.0 / 5040.0) + 1.0 / 720.0) + r2 * (r * (1.0 / 362880.0) + 1.0 / 40320.0)
        high = r * (1.0 / 39916800.0) + 1.0 / 3628800.0
        high = high + r2 * (r * (1.0 / 6227020800.0) + 1.0 / 479001600.0)
        series = low + r4 * (middle + r4 * high)
        return _two_to_the(k) * (1.0 + (r + r2 * series))

    return of_lanes


def power(a: Number, exponent: float) -> Number:
    """Return a to a power, of positive a: exp(exponent ln a)."""
    of = np.power(a, exponent)
    return of if np.ndim(of) else float(of)


@overload(power, jit_options=ALWAYS_INLINED)
def _power(a, exponent):
    if isinstance(a, LanesType):
        return lambda a, exponent: exponential(exponent * logarithm(a))
    return lambda a, exponent: a**exponent
