r"""Logarithmic strain in the plane, and its stress as second Piola-Kirchhoff.

With C = I + 2 E, the law relates ε = ½ ln C to the stress T conjugate to it
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

A' is a series of six terms where (2 m)² and (2 r)² stay below 0.0022 in all lanes of a block
(3.6 % of a strip), else of twelve where s² <= 0.0295 in all (17 %), else from logarithms.

**Small strains**, (2 m)² and (2 r)² below 8e-5 in all lanes (0.6 % of a strip), take no division.
With y = 2 m and q = 4 r²/τ², which is below 1e-4,

    1/τ = (1 - y)(1 + y²)(1 + y⁴),     τ²/D = 1/(1 - q) = (1 + q)(1 + q²),
    ¼ ln D = ½ ln(1 + y) + ¼ ln(1 - q),

the logarithms by eight and four terms, A' by three. All sums are taken in pairs: a chain of seven
dependent products would cost more time than the products.

**An isotropic elastic film** has t = K (ε_11 + ε_22) and T_d = 2 G b d. With A = A(q), so b = A/τ,
and 1/(1 - q) = τ²/D the transformation back then needs only

    S = [τ (t - G A q) I + 2 (G A - t) d]/D,      |T_d|² = (G A)² q,

which serves where strains are small and nothing has flowed: most of a film at most times.

A quad that is folded flat has D = 0 in one point or less where the strain is extrapolated through
the thickness. There τ and D are limited to ``_LEAST``: numbers stay finite, and
:mod:`shellcut.simulation.instability` gives up the run before.
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Number, Vector
from shellcut.numerics.jit import always_inline, apart
from shellcut.numerics.lane_exponentials import logarithm
from shellcut.numerics.lane_functions import any_above, larger, square_root, where_above
from shellcut.numerics.processor import not_inlined, seldom

# (E_11 + E_22)² and (2 r)² of small strains, to which the terms leave less than 2^-53.
_SMALL = 8.0e-5
# The same for six terms of A'.
_MODERATE = 0.0022
# s² to which twelve do; from here on the difference A - 1 loses no more than seven bits.
_LONG = 0.0295
# Least mean c and least determinant of C: a squeeze to a thousandth.
_LEAST = 1e-6


class StressTransform(NamedTuple):
    """The quantities of a strain that the transformation of its stress needs."""

    u: Number
    """2 u = E_11 - E_22."""
    v: Number
    """2 v = 2 E_12."""
    mean: Number
    """τ."""
    slope: Number
    """b."""
    curve: Number
    """(τ²/D - A')/τ³."""
    inverse_det: Number
    """1/D."""


@always_inline
def _small_parts(
    y: Number, y2: Number, r4: Number
) -> tuple[Number, Number, Number, Number, Number, Number]:
    """Return ½ ln D, 1/τ, 1/τ², q, A' and τ²/D of small strains: no division, short chains."""
    # 1/τ as a product of three factors, (1 - y)(1 + y²)(1 + y⁴), each by a multiply-add.
    y4 = y2 * y2
    start = 1.0 - y
    start = start + start * y2
    inverse_mean = start + start * y4
    squared = inverse_mean * inverse_mean
    q = r4 * squared
    q2 = q * q
    spread = (1.0 / 3.0 + q * (1.0 / 5.0)) + q2 * (1.0 / 7.0)
    over = 1.0 + q
    ratio = over + over * q2
    # ½ ln D = y + y² (..) - q (..): the leading term alone keeps its digits.
    of_mean = (y * (1.0 / 3.0) - 0.5) + y2 * (y * (1.0 / 5.0) - 0.25)
    of_mean = of_mean + y4 * ((y * (1.0 / 7.0) - 1.0 / 6.0) - y2 * (1.0 / 8.0))
    of_shear = (q * 0.25 + 0.5) + q2 * (q * (1.0 / 8.0) + 1.0 / 6.0)
    return y + (y2 * of_mean - q * of_shear), inverse_mean, squared, q, spread, ratio


@always_inline
def _small_strain(y: Number, y2: Number, r4: Number) -> tuple[Number, Number, Number, Number]:
    """Return ½ ln D, b, (τ²/D - A')/τ³ and 1/D of small strains."""
    both, inverse_mean, squared, q, spread, ratio = _small_parts(y, y2, r4)
    slope = inverse_mean + inverse_mean * (q * spread)
    return both, slope, (squared * inverse_mean) * (ratio - spread), squared * ratio


@always_inline
def is_small(strain: Vector) -> bool:
    """Whether :func:`small_isotropic` is good for a strain (E_11, E_22, 2 E_12) in all lanes."""
    y, u, v = strain[0] + strain[1], strain[0] - strain[1], strain[2]
    return not any_above(larger(y * y, u * u + v * v), _SMALL)


@always_inline
def small_isotropic(
    strain: Vector, bulk: Number, shear: Number
) -> tuple[Vector, Number, Number, Number]:
    """Return S, t², |T_d|² and the energy density of an isotropic elastic film at a small strain.

    strain : (E_11, E_22, 2 E_12).  bulk, shear : K and G [MPa], t = K (ε_11 + ε_22).
    """
    y, u, v = strain[0] + strain[1], strain[0] - strain[1], strain[2]
    y2, r4 = y * y, u * u + v * v
    both, _, squared, q, spread, ratio = _small_parts(y, y2, r4)
    A = 1.0 + q * spread
    # S = [τ (t - G A q) I + 2 (G A - t) d]/D with 1/D = (1/τ²)/(1 - q).
    t, GA = bulk * both, shear * A
    inverse_det, GAq = squared * ratio, GA * q
    mid = (inverse_det * (1.0 + y)) * (t - GAq)
    of_shape = inverse_det * (GA - t)
    wide = of_shape * u
    stored = 0.5 * (t * both + GAq * A)
    return (mid + wide, mid - wide, of_shape * v), t * t, GAq * GA, stored


@always_inline
def _short_series(q: Number) -> Number:
    """Return A' at q = s² up to 0.0026."""
    q2 = q * q
    low = (q * (1.0 / 5.0) + 1.0 / 3.0) + q2 * (q * (1.0 / 9.0) + 1.0 / 7.0)
    return low + (q2 * q2) * (q * (1.0 / 13.0) + 1.0 / 11.0)


@always_inline
def _long_series(q: Number) -> Number:
    """Return A' at q = s² up to ``_LONG``."""
    q2 = q * q
    q4 = q2 * q2
    low = (q * (1.0 / 5.0) + 1.0 / 3.0) + q2 * (q * (1.0 / 9.0) + 1.0 / 7.0)
    middle = (q * (1.0 / 13.0) + 1.0 / 11.0) + q2 * (q * (1.0 / 17.0) + 1.0 / 15.0)
    high = (q * (1.0 / 21.0) + 1.0 / 19.0) + q2 * (q * (1.0 / 25.0) + 1.0 / 23.0)
    return low + q4 * (middle + q4 * high)


@always_inline
def _any_spread(q: Number) -> Number:
    """Return A' at any q = s² below 1."""
    # Both are computed for all lanes, each with arguments that it can take.
    far = larger(q, _LONG)
    s = square_root(far)
    inverse = 1.0 / far
    exact = (0.5 * logarithm((1.0 + s) / (1.0 - s)) * s * inverse - 1.0) * inverse
    return where_above(q, _LONG, exact, _long_series(where_above(q, _LONG, _LONG, q)))


@always_inline
def _divided(mean: Number, excess: Number) -> tuple[Number, Number, Number]:
    """Return 1/τ, 1/D and s by one division."""
    # s = (D - 1)/(D + 1) from D - 1, which has lost no digits; D + 1 = 2 + (D - 1).
    determinant, over = 1.0 + excess, 2.0 + excess
    inverse = 1.0 / (mean * over * determinant)
    inverse_mean = inverse * (over * determinant)
    return inverse_mean, inverse * (mean * over), excess * (inverse * (mean * determinant))


@always_inline
def _slope_and_curve(
    mean: Number, inverse_mean: Number, inverse_det: Number, q: Number, spread: Number
) -> tuple[Number, Number]:
    """Return b and (τ²/D - A')/τ³ of q = 4 r²/τ² and A'."""
    slope = inverse_mean + inverse_mean * (q * spread)
    cubed = (inverse_mean * inverse_mean) * inverse_mean
    return slope, cubed * ((mean * mean) * inverse_det - spread)


@always_inline
def _moderate_strain(
    mean: Number, excess: Number, r4: Number
) -> tuple[Number, Number, Number, Number]:
    """Return ½ ln D, b, (τ²/D - A')/τ³ and 1/D of τ, D - 1 and (2 r)²."""
    inverse_mean, inverse_det, s = _divided(mean, excess)
    q_area, q_shear = s * s, r4 * (inverse_mean * inverse_mean)
    both = s * (1.0 + q_area * _short_series(q_area))
    spread = _short_series(q_shear)
    slope, curve = _slope_and_curve(mean, inverse_mean, inverse_det, q_shear, spread)
    return both, slope, curve, inverse_det


@apart
def _large_strain(
    mean: Number, excess: Number, r4: Number
) -> tuple[Number, Number, Number, Number]:
    """Return the same of any strain."""
    not_inlined()
    inverse_mean, inverse_det, s = _divided(mean, excess)
    squared = inverse_mean * inverse_mean
    q_area, q_shear = s * s, r4 * squared
    # No more than the limited D allows.
    q_most = larger(1.0 - (1.0 + excess) * squared, 0.0)
    q_shear = where_above(q_shear, 0.5, q_most, q_shear)
    if any_above(larger(q_area, q_shear), _LONG):
        both, spread = 0.5 * logarithm(1.0 + excess), _any_spread(q_shear)
    else:
        both = s * (1.0 + q_area * _long_series(q_area))
        spread = _long_series(q_shear)
    slope, curve = _slope_and_curve(mean, inverse_mean, inverse_det, q_shear, spread)
    return both, slope, curve, inverse_det


@always_inline
def sum_and_difference(strain: Vector) -> tuple[Vector, StressTransform]:
    """Return (ε_11 + ε_22, ε_11 - ε_22, 2 ε_12) of the strain (E_11, E_22, 2 E_12)."""
    y, u, v = strain[0] + strain[1], strain[0] - strain[1], strain[2]
    y2, r4 = y * y, u * u + v * v
    # The branches are by block: the shortest that is good for all its lanes.
    mean = 1.0 + y
    most = larger(y2, r4)
    if seldom(any_above(most, _SMALL)):
        excess = 2.0 * y + (y2 - r4)
        if seldom(any_above(most, _MODERATE)):
            mean = larger(mean, _LEAST)
            excess = larger(excess, _LEAST - 1.0)
            both, slope, curve, inverse_det = _large_strain(mean, excess, r4)
        else:
            both, slope, curve, inverse_det = _moderate_strain(mean, excess, r4)
    else:
        both, slope, curve, inverse_det = _small_strain(y, y2, r4)
    return (both, slope * u, slope * v), StressTransform(u, v, mean, slope, curve, inverse_det)


@always_inline
def logarithmic_strain(strain: Vector) -> tuple[Vector, StressTransform]:
    """Return (ε_11, ε_22, 2 ε_12) of the Green-Lagrange strain (E_11, E_22, 2 E_12)."""
    (both, unlike, slip), transform = sum_and_difference(strain)
    return (0.5 * (both + unlike), 0.5 * (both - unlike), slip), transform


@always_inline
def second_piola_kirchhoff(T: Vector, transform: StressTransform) -> Vector:
    """Return (S_11, S_22, S_12) of the stress (T_11, T_22, T_12) conjugate to ε."""
    return piola_of_mean(0.5 * (T[0] + T[1]), 0.5 * (T[0] - T[1]), T[2], transform)


@always_inline
def piola_of_mean(t: Number, Tu: Number, Tv: Number, transform: StressTransform) -> Vector:
    """Return the same of ½ (T_11 + T_22), ½ (T_11 - T_22) and T_12."""
    p = Tu * transform.u + Tv * transform.v
    mid = (transform.mean * t - p) * transform.inverse_det
    along = p * transform.curve - t * transform.inverse_det
    wide = transform.slope * Tu + along * transform.u
    return mid + wide, mid - wide, transform.slope * Tv + along * transform.v
