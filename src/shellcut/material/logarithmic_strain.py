r"""Logarithmic strain in the plane, and the way back from its stress to the second Piola-Kirchhoff.

With C = I + 2 E, the law stands between ε = ½ ln C and the stress T conjugate to it
([MieheApelLambrecht2002]): T is the Kirchhoff stress turned back by the rotation. In two dimensions
all follows from the mean and the deviator of E,

    E = m I + d,    |d|² = r² = u² + v²,    u = ½ (E_11 - E_22),   v = E_12,

because C has the eigenvalues c_1,2 = τ ± 2 r, τ = 1 + 2 m, and its functions are sums of I and d.
With D = c_1 c_2 = τ² - 4 r² and A(s²) = artanh(s)/s, the series of which has no trouble at s = 0,

    ε = ¼ ln D I + b d,        b = (ln c_1 - ln c_2)/(c_1 - c_2) = A(4 r²/τ²)/τ,
    ¼ ln D = ½ s A(s²),        s = (D - 1)/(D + 1),      D - 1 = 4 (m + m² - r²).

Back, S = Σ θ_ab (N_a · T N_b) N_a ⊗ N_b with θ_aa = 1/c_a and θ_12 = b. With T = t I + T_d and
p = T_d · d / 2 = T_u u + T_v v this is, written without eigenvectors,

    S = (τ t - 2 p)/D I + b T_d + [(4 p/τ³)(τ²/D - A') - 2 t/D] d,    A' = (A - 1)/s²,

since ½ (1/c_1 + 1/c_2) = τ/D, ½ (1/c_1 - 1/c_2) = -2 r/D, and their difference to b is
(4 r²/τ³)(τ²/D - A'): smooth where the eigenvalues meet, no division by their difference, one
division in all. S is symmetric by construction, and S · dE = T · dε.

A' is a series of six terms where s² <= 0.0026 in all lanes of a block (principal strains of 5 %),
else of twelve where s² <= 0.0295 in all (17 %), else from logarithms.

A quad that is folded flat has D = 0 in one point or less where the strain is extrapolated through
the thickness. There τ and D are held at ``_LEAST``: numbers stay finite, and
:mod:`shellcut.simulation.instability` gives up the run before.
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Number, Vector
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_exponentials import any_above, logarithm
from shellcut.numerics.lane_functions import larger, square_root, where_above

# s² to which six terms of A' leave less than 2^-53 of A.
_SHORT = 0.0026
# s² to which twelve do; from here on the difference A - 1 loses no more than seven bits.
_LONG = 0.0295
# Least mean c and least determinant of C: a squeeze to a thousandth.
_LEAST = 1e-6


class WayBack(NamedTuple):
    """The quantities of a strain that the way back needs."""

    u: Number
    v: Number
    mean: Number
    """τ."""
    slope: Number
    """b."""
    spread: Number
    """A'."""
    inverse_mean: Number
    """1/τ."""
    inverse_det: Number
    """1/D."""


@always_inline
def _short_series(q: Number) -> Number:
    """Return A' at q = s² up to ``_SHORT``."""
    a = q * (1.0 / 13.0) + 1.0 / 11.0
    a = a * q + 1.0 / 9.0
    a = a * q + 1.0 / 7.0
    a = a * q + 1.0 / 5.0
    return a * q + 1.0 / 3.0


@always_inline
def _long_series(q: Number) -> Number:
    """Return A' at q = s² up to ``_LONG``."""
    a = q * (1.0 / 25.0) + 1.0 / 23.0
    a = a * q + 1.0 / 21.0
    a = a * q + 1.0 / 19.0
    a = a * q + 1.0 / 17.0
    a = a * q + 1.0 / 15.0
    a = a * q + 1.0 / 13.0
    a = a * q + 1.0 / 11.0
    a = a * q + 1.0 / 9.0
    a = a * q + 1.0 / 7.0
    a = a * q + 1.0 / 5.0
    return a * q + 1.0 / 3.0


@always_inline
def _any_spread(q: Number) -> Number:
    """Return A' at any q = s² below 1."""
    far = larger(q, _LONG)
    s = square_root(far)
    inverse = 1.0 / far
    exact = (0.5 * logarithm((1.0 + s) / (1.0 - s)) * s * inverse - 1.0) * inverse
    return where_above(q, _LONG, exact, _long_series(where_above(q, _LONG, _LONG, q)))


@always_inline
def logarithmic_strain(strain: Vector) -> tuple[Vector, WayBack]:
    """Return (ε_11, ε_22, 2 ε_12) of the Green-Lagrange strain (E_11, E_22, 2 E_12)."""
    m, u, v = 0.5 * (strain[0] + strain[1]), 0.5 * (strain[0] - strain[1]), 0.5 * strain[2]
    squared = u * u + v * v
    mean = larger(1.0 + 2.0 * m, _LEAST)
    excess = larger(4.0 * (m + m * m - squared), _LEAST - 1.0)
    determinant = 1.0 + excess
    over = 2.0 + excess
    inverse = 1.0 / (mean * over * determinant)
    inverse_mean = inverse * (over * determinant)
    inverse_det = inverse * (mean * over)
    s = excess * (inverse * (mean * determinant))
    q_area = s * s
    # No more than the held D allows.
    q_shear = (4.0 * squared) * (inverse_mean * inverse_mean)
    q_most = 1.0 - determinant * (inverse_mean * inverse_mean)
    q_shear = where_above(q_shear, 0.5, larger(q_most, 0.0), q_shear)
    most = larger(q_area, q_shear)
    if any_above(most, _SHORT):
        if any_above(most, _LONG):
            mid, spread = 0.25 * logarithm(determinant), _any_spread(q_shear)
        else:
            mid = 0.5 * s * (1.0 + q_area * _long_series(q_area))
            spread = _long_series(q_shear)
    else:
        mid = 0.5 * s * (1.0 + q_area * _short_series(q_area))
        spread = _short_series(q_shear)
    slope = (1.0 + q_shear * spread) * inverse_mean
    wide = slope * u
    return (
        (mid + wide, mid - wide, slope * strain[2]),
        WayBack(u, v, mean, slope, spread, inverse_mean, inverse_det),
    )


@always_inline
def second_piola_kirchhoff(T: Vector, way: WayBack) -> Vector:
    """Return (S_11, S_22, S_12) of the stress (T_11, T_22, T_12) conjugate to ε."""
    t, Tu, Tv = 0.5 * (T[0] + T[1]), 0.5 * (T[0] - T[1]), T[2]
    p = Tu * way.u + Tv * way.v
    mid = (way.mean * t - 2.0 * p) * way.inverse_det
    ratio = way.mean * way.mean * way.inverse_det
    cubed = way.inverse_mean * way.inverse_mean * way.inverse_mean
    along = 4.0 * p * cubed * (ratio - way.spread) - 2.0 * t * way.inverse_det
    wide = way.slope * Tu + along * way.u
    return mid + wide, mid - wide, way.slope * Tv + along * way.v
