r"""Return to the yield surface in plane stress, for von Mises and Hill, in eight lanes at once.

With T = C (ε - ε_p), back stress β, ξ = T - β and σ_eq² = ξ · P ξ, the flow is associated and taken
at the end of the step ([SimoHughes1998] 3.4):

    Δε_p = Δλ P ξ,      Δp = Δλ σ_eq,      Δβ = Δλ H_k ξ,      σ_eq = σ_y(p + Δp, Δp/Δt).

**Modes.** Let V bring both matrices to diagonals, VᵀPV = diag(μ), V Vᵀ = C (the moduli's Cholesky
factor times the eigenvectors of its congruence with P). With ξ = V z all is scalar,

    z_i = z_i^trial / (1 + Δλ (μ_i + H_k)),      g(Δλ) = σ_eq = √(Σ μ_i z_i²),
    z^trial = Vᵀ(ε - ε_p^old) - V⁻¹ β^old,

for isotropic and orthotropic moduli, von Mises and Hill alike; only V and μ differ. With Δλ =
Δp/σ_y, k_i = μ_i + H_k and q_i = μ_i (z_i^trial)², the one equation left has no root in it:

    G(Δp) = Σ q_i/(σ_y + k_i Δp)² = 1,       σ_y = σ_y(p + Δp, Δp/Δt).

Newton's method for 1/√G, which is a straight line in Δp where all k_i agree and the hardening is
linear, whatever the step, and nearly one otherwise:

    Δp <- Δp + (G √G - G)/B,       B = Σ q_i (dσ_y/dp + k_i)/(σ_y + k_i Δp)³ = -G'/2,

with a series for the root near G = 1. The iteration ends when |G - 1| < 4e-6 (singles: 1e-3) in all
lanes that yield; the last correction is added to the first order, which leaves 1e-11. If that takes
more than ``_FREE_TURNS`` turns, it begins anew with a bracket: G > 1 at Δp = 0, and σ_eq^trial
bounds Δp from above; a turn that would leave it halves it. A lane that is not solved in ``_TURNS``
turns gets nan, and the run is stopped by name. Lanes that do not yield keep their bits, whatever
their neighbours in the block do.

**Where nothing yields**, which is most of a film at most times, the block is left after the trial:
R = σ_y(p) - σ_0 is kept as history, so that no hardening is evaluated then.

**Work.** The dissipation of the step is the mean of (σ_0 + R) f at both ends times Δp: the plastic
work T · Δε_p without β · Δε_p, which linear kinematic hardening stores, ½ β · Pβ/H_k in all.
"""

# Its functions are made for each law and take numbers of several kinds.
# mypy: disable-error-code="no-untyped-def"

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Number, Vector
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_exponentials import any_above, precision_of
from shellcut.numerics.lane_functions import larger, square_root, where_above

_TURNS = 80
# Of Newton alone; after them the root is bracketed.
_FREE_TURNS = 6
# |G - 1| over the root of the precision at which the last correction ends the iteration.
_ENOUGH = 256.0


@always_inline
def equivalent(weight: Vector, z: Vector) -> Number:
    """Return σ_eq² of the modes z."""
    return weight[0] * z[0] * z[0] + weight[1] * z[1] * z[1] + weight[2] * z[2] * z[2]


class Flow(NamedTuple):
    """What flows in a step; in lanes that do not yield nothing does."""

    by_mode: Vector
    """Δλ z_i/z_i^trial = Δp/(σ_y + k_i Δp) [1/MPa]."""
    plastic: Number
    """p at the end of the step."""
    hardening: Number
    """R at the end of the step [MPa]."""
    lost: Number
    """Dissipated energy density [N/mm²]."""


@always_inline
def excess(weight: Vector, z: Vector, start: Number, may_flow: bool) -> Number:
    """Return by how much the trial is beyond the yield surface, σ_eq² - start² [MPa²].

    start : (σ_0 + R) at the start of the step [MPa].  The last step may have left the stress above
    the surface by some round-off, which is not taken for flow.
    """
    squared = equivalent(weight, z)
    beyond = (1.0 - 64.0 * precision_of(squared)) * squared - start * start
    return beyond if may_flow else -start * start


@always_inline
def _newton_turn(yielding, q, k, dp):
    """Return G, 1/(σ_y + k_i Δp) and their slopes, and B; see the head of the module.

    yielding : σ_y and its slope at p + Δp.
    """
    sigma, slope = yielding
    a0, a1, a2 = sigma + k[0] * dp, sigma + k[1] * dp, sigma + k[2] * dp
    over = 1.0 / (a0 * a1 * a2)
    i0, i1, i2 = over * (a1 * a2), over * (a0 * a2), over * (a0 * a1)
    r0, r1, r2 = (slope + k[0]) * i0, (slope + k[1]) * i1, (slope + k[2]) * i2
    s0, s1, s2 = q[0] * i0 * i0, q[1] * i1 * i1, q[2] * i2 * i2
    return s0 + s1 + s2, (i0, i1, i2), (r0, r1, r2), s0 * r0 + s1 * r1 + s2 * r2


def make_flow(hardening: Any, rate_factor: Any, has_rate: bool) -> Any:
    """Return the function that finds the flow of a step, for functions of hardening and rate.

    ``flow(p, at, q, k, beyond, state, dt)`` takes the parameter row, in which σ_0 stands at ``at``,
    followed by the parameters of the hardening, and p[0] is the place of those of the rate; the
    shares q_i of the trial modes in σ_eq²; k_i = μ_i + H_k; :func:`excess`, above zero in at least
    one lane; the history (p, R); Δt [s]. It returns a :class:`Flow`.
    """
    hardening, rate_factor = always_inline(hardening), always_inline(rate_factor)

    @always_inline
    def yield_stress(p, at, eq, dp, dt):
        """Return σ_y with its slope, and R with its slope, after a step of p of length ``dp``."""
        R, steep = hardening(p, at + 1, eq + dp)
        static = p[at] + R
        if not has_rate:
            return (static, steep), (R, steep)
        factor, steeper = rate_factor(p, int(p[0]), dp / dt)
        return (static * factor, steep * factor + static * steeper / dt), (R, steep)

    @always_inline
    def flow(p, at, q, k, beyond, state, dt):
        eq, R_old = state
        none = 0.0 * eq
        start = p[at] + R_old
        enough = min(_ENOUGH * np.sqrt(precision_of(eq)), 1e-3)
        dp, low, high = none, none, none
        turn = 0
        while True:
            yielding, isotropic = yield_stress(p, at, eq, dp, dt)
            G, inverse, rates, B = _newton_turn(yielding, q, k, dp)
            off = where_above(beyond, 0.0, larger(G - 1.0, 1.0 - G), none)
            if any_above(off, 0.1):
                change = G * (square_root(G) - 1.0)
            else:
                d = G - 1.0
                change = d * (0.5 + d * (0.375 - d * (0.0625 - 0.0234375 * d)))
            change = change / B
            turn += 1
            if turn == _TURNS or not any_above(off, enough):
                break
            if turn < _FREE_TURNS:
                dp = where_above(beyond, 0.0, dp + change, none)
            elif turn == _FREE_TURNS:
                # σ_eq <= σ_eq^trial/(1 + Δλ k_min) has come down to the first yield by here.
                high = (square_root(q[0] + q[1] + q[2]) - start) / min(k[0], min(k[1], k[2]))
                dp = where_above(beyond, 0.0, 0.5 * high, none)
            else:
                low = where_above(G, 1.0, dp, low)
                high = where_above(G, 1.0, high, dp)
                new, middle = dp + change, 0.5 * (low + high)
                new = where_above(new, low, new, middle)
                new = where_above(high, new, new, middle)
                dp = where_above(beyond, 0.0, new, none)
        sigma, slope = yielding
        R, steep = isotropic
        dp, sigma, R = dp + change, sigma + slope * change, R + steep * change
        # The last correction to the first order; nan where the equation is not solved.
        dp = where_above(off, enough, np.nan * dp, dp)
        mean = 0.5 * (start + sigma)
        if has_rate:
            mean = 0.5 * sigma * (1.0 + start / (p[at] + R))
        return Flow(
            (
                where_above(beyond, 0.0, dp * inverse[0] * (1.0 - rates[0] * change), none),
                where_above(beyond, 0.0, dp * inverse[1] * (1.0 - rates[1] * change), none),
                where_above(beyond, 0.0, dp * inverse[2] * (1.0 - rates[2] * change), none),
            ),
            where_above(beyond, 0.0, eq + dp, eq),
            where_above(beyond, 0.0, R, R_old),
            where_above(beyond, 0.0, mean * dp, none),
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
