"""A proven upper bound of the largest eigenvalue of single quads, close to it.

A power iteration approaches omega², the largest eigenvalue of K on M, from below. The factorisation
of sigma M - K proves that sigma is not below omega²: otherwise some pivot would not be positive.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.numerics.jit import inline, kernel

from .tangent import N_FREEDOM

# Relative excess of the tried bound over the power iteration's value, and iterations per try. Two
# eigenvalues with a ratio of 0.8 are separated to 1e-5 in twelve iterations; closer ones need not
# be.
_ABOVE = 1.002
_TURNS = 12
_TRIES = 4


@kernel
def bound_largest_eigenvalues(
    tangent: Floats, mass: Floats, inertia: Floats, squared: Floats
) -> None:
    """Write a bound of the largest eigenvalue of M⁻¹ K of single quads [1/s²] to squared : (n,).

    tangent : (n, 20, 20), scaled by the mass on return.  mass, inertia : (n, 4), each quad's own
    share at its nodes.
    """
    n = N_FREEDOM
    scale = np.empty(n)
    v, w = np.empty(n), np.empty(n)
    left = np.empty((n, n))
    for i in range(tangent.shape[0]):
        K = tangent[i]
        for a in range(4):
            for c in range(3):
                scale[3 * a + c] = 1.0 / np.sqrt(mass[i, a])
            for b in range(2):
                scale[12 + 2 * a + b] = 1.0 / np.sqrt(inertia[i, a])
        for k in range(n):
            for j in range(n):
                K[k, j] *= scale[k] * scale[j]
            v[k] = 1.0 + 0.37 * ((7 * k) % 11)  # along no symmetry of any quad
        proved = False
        value = 0.0
        for _ in range(_TRIES):
            for _ in range(_TURNS):
                value = _turn(K, v, w)
            value *= _ABOVE
            if _is_above(value, K, left):
                proved = True
                break
        if not proved:  # by rows, always true
            value = 0.0
            for k in range(n):
                value = max(value, np.abs(K[k]).sum())
        squared[i] = value


@inline
def _turn(K: Floats, v: Floats, w: Floats) -> float:
    """Replace v by K v of unit length; return the Rayleigh quotient of the old v."""
    n = N_FREEDOM  # a constant: the loops are unrolled
    for k in range(n):
        w[k] = 0.0
    for j in range(n):
        for k in range(n):
            w[k] += K[j, k] * v[j]
    vv = vw = ww = 0.0
    for k in range(n):
        vv += v[k] * v[k]
        vw += v[k] * w[k]
        ww += w[k] * w[k]
    size = 1.0 / np.sqrt(ww)
    for k in range(n):
        v[k] = size * w[k]
    return float(vw / vv)


@inline
def _is_above(value: float, K: Floats, left: Floats) -> bool:
    """Whether value exceeds all eigenvalues of K : (n, n): all pivots of value - K are positive."""
    n = N_FREEDOM
    for k in range(n):
        for j in range(n):
            left[k, j] = -K[k, j]
        left[k, k] += value
    for k in range(n):
        pivot = left[k, k]
        if not pivot > 0.0:
            return False
        for i in range(k + 1, n):
            f = left[i, k] / pivot
            for j in range(k + 1, n):
                left[i, j] -= f * left[k, j]
    return True
