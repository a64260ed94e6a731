r"""Return to the yield surface in plane stress, for von Mises and Hill, in eight lanes at once.

With T = C (ε - ε_p), back stress β, ξ = T - β and σ_eq² = ξ · P ξ, the flow is associated and taken
at the end of the step ([SimoHughes1998] 3.4):

    Δε_p = Δλ P ξ,      Δp = Δλ σ_eq,      Δβ = Δλ H_k ξ,      σ_eq = σ_y(p + Δp, Δp/Δt).

**Modes.** Let V bring both matrices to diagonals, VᵀPV = diag(μ), V Vᵀ = C (the moduli's Cholesky
factor times the eigenvectors of its congruence with P). With ξ = V z all is scalar,

    z_i = z_i^trial / (1 + Δλ (μ_i + H_k)),      g(Δλ) = σ_eq = √(Σ μ_i z_i²),
    z^trial = Vᵀ(ε - ε_p^old) - V⁻¹ β^old,

for isotropic and orthotropic moduli, von Mises and Hill alike; only V and μ differ. The scalar
equation is solved by Newton's method in the form

    φ(Δλ) = σ_y(p + Δλ g)/g - 1 = 0,

which is a straight line in Δλ where all μ_i agree and the hardening is linear, whatever the step,
and nearly one otherwise. φ < 0 at Δλ = 0, and g ≤ σ_0 bounds Δλ from above; a turn that would leave
what is known to hold the root halves it. The iteration ends one turn after all lanes that yield
have |φ| below the root of the precision; a lane that has not come there in ``_TURNS`` turns gets
nan, and the run is stopped by name. Lanes that do not yield keep their bits, whatever their
neighbours in the block do.

**Where nothing yields**, which is most of a film at most times, the block is left after the trial:
R = σ_y(p) - σ_0 is kept as history, so that no hardening is evaluated then.

**Work.** The dissipation of the step is the mean of (σ_0 + R) f at both ends times Δp: the plastic
work T · Δε_p without β · Δε_p, which linear kinematic hardening stores, ½ β · Pβ/H_k in all.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Floats, Number, Vector
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_exponentials import largest, precision_of
from shellcut.numerics.lane_functions import larger, square_root, where_above

_TURNS = 60


@always_inline
def equivalent(weight: Vector, z: Vector) -> Number:
    """Return σ_eq² of the modes z."""
    return weight[0] * z[0] * z[0] + weight[1] * z[1] * z[1] + weight[2] * z[2] * z[2]


@always_inline
def returned(z: Number, rate: float, multiplier: Number) -> Number:
    """Return a mode after the flow, z / (1 + Δλ k)."""
    return z / (1.0 + multiplier * rate)


def make_flow(hardening: Any, rate_factor: Any, has_rate: bool) -> Any:
    """Return the function that finds the flow of a step, for functions of hardening and rate.

    ``flow(p, at, z, weight, k, state, dt)`` takes the parameter row, in which σ_0 stands at ``at``,
    followed by the parameters of the hardening, and p[0] is the place of those of the rate; the
    trial modes, their weights in σ_eq² and k_i = μ_i + H_k; the history (p, R); Δt [s]. It returns
    Δλ, p and R at the end of the step, and the dissipated energy density: in lanes that do not
    yield 0, p, R and 0.
    """

    hardening, rate_factor = always_inline(hardening), always_inline(rate_factor)

    @always_inline
    def yield_stress(p, at, eq, step, dt):
        """Return σ_y after a step of p of length ``step``, its slope, and R."""
        R, slope = hardening(p, at + 1, eq)
        static = p[at] + R
        if not has_rate:
            return static, slope, R
        factor, steeper = rate_factor(p, int(p[0]), step / dt)
        return static * factor, slope * factor + static * steeper / dt, R

    @always_inline
    def flow(p, at, z, weight, k, state, dt):
        eq_old, R_old = state
        squared = equivalent(weight, z)
        start = p[at] + R_old
        none = 0.0 * squared
        # The last step may have left the stress above the surface by some round-off.
        yields = (1.0 - 64.0 * precision_of(squared)) * squared - start * start
        if has_rate and dt <= 0.0:  # no time to flow
            yields = none - 1.0
        if not largest(yields) > 0.0:
            return none, eq_old, R_old, none
        k0, k1, k2 = k
        q0 = weight[0] * z[0] * z[0]
        q1 = weight[1] * z[1] * z[1]
        q2 = weight[2] * z[2] * z[2]
        # g <= g(0)/(1 + x k_min) falls to the yield stress of the start no later than here.
        high = (square_root(squared) / start - 1.0) * (1.0 / min(k0, min(k1, k2)))
        low, x, off = none, none, none + 1.0
        eq, R, sigma = eq_old, R_old, start
        enough = 4.0 * np.sqrt(precision_of(squared))
        left, turn = 1.0, 0
        while turn < _TURNS:
            d0, d1, d2 = 1.0 + x * k0, 1.0 + x * k1, 1.0 + x * k2
            over = 1.0 / (d0 * d1 * d2)
            i0, i1, i2 = over * (d1 * d2), over * (d0 * d2), over * (d0 * d1)
            s0, s1, s2 = q0 * i0 * i0, q1 * i1 * i1, q2 * i2 * i2
            g = square_root(larger(s0 + s1 + s2, 1e-30))
            step = x * g
            sigma, slope, R = yield_stress(p, at, eq_old + step, step, dt)
            eq = eq_old + step
            if left <= enough:
                break
            inverse = 1.0 / g
            phi = sigma * inverse - 1.0
            off = where_above(yields, 0.0, larger(phi, -phi), none)
            left = largest(off)
            low = where_above(phi, 0.0, low, x)
            high = where_above(phi, 0.0, x, high)
            shrink = -(k0 * s0 * i0 + k1 * s1 * i1 + k2 * s2 * i2) * inverse
            grade = (slope * (g + x * shrink) - sigma * shrink * inverse) * inverse
            new = x - phi / larger(grade, 1e-30)
            middle = 0.5 * (low + high)
            new = where_above(low, new, middle, new)
            new = where_above(new, high, middle, new)
            x = where_above(yields, 0.0, new, none)
            turn += 1
        x = where_above(off, enough, np.nan * x, x)
        lost = 0.5 * sigma * (1.0 + start / (p[at] + R)) * (eq - eq_old)
        return (
            x,
            where_above(yields, 0.0, eq, eq_old),
            where_above(yields, 0.0, R, R_old),
            where_above(yields, 0.0, lost, none),
        )

    return flow


def modes_of(moduli: Floats, flow: Floats) -> tuple[Floats, Floats]:
    """Return V, shape (3, 3), and μ, shape (3,), with V Vᵀ = C and VᵀPV = diag(μ).

    Parameters
    ----------
    moduli : ndarray, shape (3, 3)
        C [MPa], positive definite.
    flow : ndarray, shape (3, 3)
        P, positive definite.
    """
    factor = np.linalg.cholesky(moduli)
    mu, turn = np.linalg.eigh(factor.T @ flow @ factor)
    return np.asarray(factor @ turn), np.asarray(mu)
