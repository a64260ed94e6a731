r"""Return to the yield surface in plane stress, for von Mises and Hill, in eight lanes at once.

With T = C (ε - ε_p) and σ_eq² = T · P T, the flow is associated and taken at the end of the step
([SimoHughes1998] 3.4):

    (1)  Δε_p = Δλ P T,      Δp = Δλ σ_eq,
    (2)  σ_eq = σ_y(p + Δp, Δp/Δt).

**Modes.** Let V bring both matrices to diagonals, VᵀPV = diag(μ), V Vᵀ = C (the moduli's Cholesky
factor times the eigenvectors of its congruence with P). With T = V z all is scalar,

    (3)  z_i = z_i^trial / (1 + Δλ μ_i),    σ_eq = √(Σ μ_i z_i²),    z^trial = Vᵀ(ε - ε_p^old),

for isotropic and orthotropic moduli, von Mises and Hill alike; only V and μ differ. With

    (4)  Δλ = Δp/σ_y,    q_i = μ_i (z_i^trial)²,

the one equation left has no root in it:

    (5)  G(Δp) = Σ q_i/(σ_y + μ_i Δp)² = 1,       σ_y = σ_y(p + Δp, Δp/Δt).

It is solved as 1/√G = 1 by Newton's method: 1/√G is a straight line in Δp where all μ_i agree and
the hardening is linear, whatever the step, and nearly one otherwise:

    (6)  Δp <- Δp + (G √G - G)/B,       B = Σ q_i (dσ_y/dp + μ_i)/(σ_y + μ_i Δp)³ = -G'/2,

with a series for the root near G = 1. In the first turn, Δp = 0, all σ_y + μ_i Δp are σ_0 + R:

    (7)  Δp = Q (√Q - σ_y)/(Q dR/dp + Σ q_i μ_i),       Q = Σ q_i.

The straight part of the hardening that holds the least p of the lanes that yield is found once;
every iteration starts its search there, and passes as many parts as the lanes are apart.

**With a rate factor** σ_y rises from Δp = 0 like the fifth root of Δp, or steeper: a straight line
from the right of the root ends below zero. In ln Δp it is no steeper than its own height, and its
slope only grows: Newton's method for 1/√G over ln Δp descends to the root from the right, and a
first turn from the left takes it there,

    (8)  Δp <- Δp exp x,      x = (G √G - G)/(B Δp).

The iteration ends when |G - 1| < 8e-6 in all lanes that yield, with a rate factor |x| < 8e-6; the
last correction is added to the first order, which leaves 1e-11 to 1e-10 of the stress, and less
than 4e-6 where it passes a corner of the hardening. A flow that changes the stress by less than its
round-off is found as it is: just above the yield stress at rest, a rate factor asks for flows of
1e-30 and less, of which G cannot tell. Any further turn stays within a bracket: G > 1 at Δp = 0,
and σ_eq^trial bounds Δp from above; a turn that would leave it halves it, and the iteration ends
when the bracket has closed to round-off at the latest. A lane that is not solved in ``_TURNS``
turns gets nan, and the run is stopped by name. The flow changes no bit of lanes that do not yield;
that a block leaves the short path of an elastic film when one of its lanes first yields
(:mod:`.plastic`) changes the others by round-off. Isotropic moduli with von Mises have two modes,
the mean and the deviator.

**Where nothing yields**, which is most of a film at most times, the block is left after the trial:
R = σ_y(p) - σ_0 is kept as history, so that no hardening is evaluated then.

**Work.** The dissipation of the step is the mean of (σ_0 + R) f at both ends times Δp, f being the
rate factor: the plastic work T · Δε_p.

**In the code** ``p`` is the row of parameters, ``at`` the place of σ_0 in it, and ``eq`` the
plastic strain p of the formulas at the start of the step.
"""

# Its functions are made for each law and take numbers of several kinds.
# mypy: disable-error-code="no-untyped-def"

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Number, product
from shellcut.numerics.jit import always_inline, apart_as
from shellcut.numerics.lane_exponentials import exponential
from shellcut.numerics.lane_functions import any_above, larger, square_root, where_above, zero_like
from shellcut.numerics.processor import not_inlined, seldom
from shellcut.numerics.small_matrices import symmetric_eigen

from . import hardening

_part_of, _rise = always_inline(hardening.part_of), always_inline(hardening.rise)

_TURNS = 80
# Relative spacing of doubles.
_ROUND_OFF = 2.0**-52
# |G - 1|, or |x|, at which the last correction ends the iteration.
_ENOUGH = 512.0 * 2.0**-26
# The largest x of a turn.
_MOST = 2.0


class Flow(NamedTuple):
    """What flows in a step; in lanes that do not yield nothing does."""

    by_mode: tuple[Number, ...]
    """Δλ z_i/z_i^trial = Δp/(σ_y + μ_i Δp) [1/MPa]."""
    plastic: Number
    """p at the end of the step."""
    hardening: Number
    """R at the end of the step [MPa]."""
    lost: Number
    """Dissipated energy density [N/mm²]."""


class _Turn(NamedTuple):
    """What a turn of Newton's method found at p + Δp."""

    sigma: Number
    """σ_y [MPa]."""
    sigma_slope: Number
    """dσ_y/dΔp [MPa]."""
    R: Number
    """R [MPa]."""
    R_slope: Number
    """dR/dp [MPa]."""
    inverse: tuple[Number, ...]
    """1/(σ_y + μ_i Δp) of each mode [1/MPa]."""
    rates: tuple[Number, ...]
    """Derivative of σ_y + μ_i Δp with respect to Δp, times its inverse."""
    G: Number
    """G of (5)."""
    change: Number
    """Correction of Δp by this turn."""


@always_inline
def excess(squared: Number, start: Number, may_flow: bool) -> Number:
    """Return by how much the trial is beyond the yield surface, σ_eq² - start² [MPa²].

    squared : σ_eq² of the trial.  start : (σ_0 + R) at the start of the step [MPa].  may_flow : if
    not, nothing yields, and it is -start².  The last step may have left the stress above the
    surface by some round-off, which is not taken for flow.
    """
    beyond = (1.0 - 64.0 * _ROUND_OFF) * squared - start * start
    return beyond if may_flow else zero_like(squared) - start * start


# ---------------------------------------------------------------- sums over two or three modes
#
# Written out, as kernels cannot loop over tuples; isotropic moduli with von Mises have two modes.


@always_inline
def _sums_of_two(q, mu):
    """Return Σ q_i, Σ q_i μ_i and the least μ_i."""
    return q[0] + q[1], q[0] * mu[0] + q[1] * mu[1], min(mu[0], mu[1])


@always_inline
def _turn_of_two(sigma, slope, q, mu, dp):
    """Return G of (5), 1/(σ_y + μ_i Δp) and their rates, and B of (6), by one division."""
    a0, a1 = sigma + mu[0] * dp, sigma + mu[1] * dp
    over = 1.0 / (a0 * a1)
    i0, i1 = over * a1, over * a0
    r0, r1 = (slope + mu[0]) * i0, (slope + mu[1]) * i1
    s0, s1 = q[0] * i0 * i0, q[1] * i1 * i1
    return s0 + s1, (i0, i1), (r0, r1), s0 * r0 + s1 * r1


@always_inline
def _flow_of_two(beyond, dp, found, none):
    """Return Δλ z_i/z_i^trial after the last change, to the first order."""
    inverse, rates, change = found.inverse, found.rates, found.change
    return (
        where_above(beyond, 0.0, dp * inverse[0] * (1.0 - rates[0] * change), none),
        where_above(beyond, 0.0, dp * inverse[1] * (1.0 - rates[1] * change), none),
    )


@always_inline
def _sums_of_three(q, mu):
    return (
        q[0] + q[1] + q[2],
        q[0] * mu[0] + q[1] * mu[1] + q[2] * mu[2],
        min(mu[0], min(mu[1], mu[2])),
    )


@always_inline
def _turn_of_three(sigma, slope, q, mu, dp):
    a0, a1, a2 = sigma + mu[0] * dp, sigma + mu[1] * dp, sigma + mu[2] * dp
    over = 1.0 / (a0 * a1 * a2)
    i0, i1, i2 = over * (a1 * a2), over * (a0 * a2), over * (a0 * a1)
    r0, r1, r2 = (slope + mu[0]) * i0, (slope + mu[1]) * i1, (slope + mu[2]) * i2
    s0, s1, s2 = q[0] * i0 * i0, q[1] * i1 * i1, q[2] * i2 * i2
    return s0 + s1 + s2, (i0, i1, i2), (r0, r1, r2), s0 * r0 + s1 * r1 + s2 * r2


@always_inline
def _flow_of_three(beyond, dp, found, none):
    inverse, rates, change = found.inverse, found.rates, found.change
    return (
        where_above(beyond, 0.0, dp * inverse[0] * (1.0 - rates[0] * change), none),
        where_above(beyond, 0.0, dp * inverse[1] * (1.0 - rates[1] * change), none),
        where_above(beyond, 0.0, dp * inverse[2] * (1.0 - rates[2] * change), none),
    )


_OF_MODES = {
    2: (_sums_of_two, _turn_of_two, _flow_of_two),
    3: (_sums_of_three, _turn_of_three, _flow_of_three),
}

# ---------------------------------------------------------------- Newton's method


@always_inline
def _first_flow(total, start, steep):
    """Return Δp of (7) by one division, and no root where Q is near σ_y².

    total, start, steep : Q, σ_y and the divisor.
    """
    squared = start * start
    over = 1.0 / (squared * steep)
    d = (total - squared) * (over * steep)
    if any_above(d, 0.1):
        excess_stress = square_root(total) - start
    else:
        d2 = d * d
        excess_stress = (d * start) * (
            (0.5 - 0.125 * d) + d2 * ((0.0625 - 0.0390625 * d) + d2 * 0.02734375)
        )
    return (total * excess_stress) * (over * squared)


@always_inline
def _straight(G, B, dp, stiff, beyond):
    """Return |G - 1| of the lanes that yield, and the change of Δp by (6)."""
    off = where_above(beyond, 0.0, larger(G - 1.0, 1.0 - G), zero_like(G))
    if any_above(off, 0.1):
        change = G * (square_root(G) - 1.0)
    else:
        d = G - 1.0
        change = d * ((0.5 + d * 0.375) - (d * d) * (0.0625 - 0.0234375 * d))
    # The division does not wait for the series.
    return off, change * (1.0 / B)


@always_inline
def _in_proportion(G, B, dp, stiff, beyond):
    """Return |x| of the lanes that yield, and the change of Δp by (8), for a rate factor.

    stiff : μ/(σ_y + μ Δp) of one mode, which says how Δp changes the stress.
    """
    none = zero_like(G)
    _, change = _straight(G, B, dp, stiff, beyond)
    x = change / dp
    x = where_above(x, _MOST, _MOST, x)
    off = where_above(stiff * dp, 0.25 * _ROUND_OFF, larger(x, -x), none)
    return where_above(beyond, 0.0, off, none), dp * (exponential(x) - 1.0)


@always_inline
def _straight_rise(p, part, plastic):
    """Return R and dR/dp by one straight part, wherever it ends."""
    slope = p[part + 1] + 0.0 * plastic
    return p[part + 2] + slope * plastic, slope


def make_flow(rate_factor: Any, has_rate: bool, n_mode: int) -> Any:
    """Return the function that finds the flow of a step, for a function of the rate.

    ``flow(p, at, q, mu, beyond, state, dt)`` takes the parameter row, with σ_0 at ``at``, followed
    by the row of the hardening; p[0] is the place of the numbers of the rate; the shares q_i of the
    two or three trial modes in σ_eq²; μ_i; :func:`excess`, above zero in at least one lane; the
    history (p, R); Δt [s]. It returns a :class:`Flow`.

    The four functions below are those of one law: what differs between laws, the factor and the
    number of modes, is fixed when they are compiled.
    """
    newton = _in_proportion if has_rate else _straight
    sums, turn_of_modes, flow_of_modes = _OF_MODES[n_mode]
    factor_by_rate = always_inline(rate_factor)
    name = f"{rate_factor.__module__}.{rate_factor.__qualname__} {n_mode} {has_rate}"

    @always_inline
    def turn(p, at, rise, q, mu, beyond, dp, dt):
        """Return how far Δp is off, and the turn; rise : R and dR/dp at p + Δp."""
        R, R_slope = rise
        sigma, slope = p[at] + R, R_slope
        if has_rate:  # σ_y = (σ_0 + R) f(Δp/Δt)
            factor, steeper = factor_by_rate(p, int(p[0]), dp / dt)
            sigma, slope = sigma * factor, slope * factor + sigma * steeper / dt
        G, inverse, rates, B = turn_of_modes(sigma, slope, q, mu, dp)
        off, change = newton(G, B, dp, mu[0] * inverse[0], beyond)
        return off, _Turn(sigma, slope, R, R_slope, inverse, rates, G, change)

    @always_inline
    def end(p, at, beyond, state, dp, found):
        """Return the flow after the last correction, to the first order."""
        eq, R_old = state
        none = zero_like(eq)
        start, change = p[at] + R_old, found.change
        dp = dp + change
        sigma, R = found.sigma + found.sigma_slope * change, found.R + found.R_slope * change
        mean = 0.5 * (start + sigma)  # without a rate factor the yield stress at rest is σ_y
        if has_rate:
            mean = 0.5 * sigma * (1.0 + start / (p[at] + R))
        return Flow(
            flow_of_modes(beyond, dp, found, none),
            where_above(beyond, 0.0, eq + dp, eq),
            where_above(beyond, 0.0, R, R_old),
            where_above(beyond, 0.0, mean * dp, none),
        )

    @apart_as(name)
    def further(p, at, q, mu, beyond, state, dp, dt):
        """Return the flow by as many turns as it takes, between bounds that close in on Δp.

        dp : of the first turn where no p is beyond the first straight part.
        """
        not_inlined()
        eq, R_old = state
        none = zero_like(eq)
        total, slopes, softest = sums(q, mu)
        part = at + 2
        if any_above(eq, p[part + 3]):
            # Lanes that do not yield say nothing about where to start.
            part = _part_of(p, at + 1, where_above(beyond, 0.0, eq, np.inf))
            _, steep = _rise(p, part, eq)
            dp = _first_flow(total, p[at] + R_old, total * steep + slopes)
            dp = where_above(beyond, 0.0, dp, none)
        low, high, closed = none, none, none
        count = 0
        while True:
            off, found = turn(p, at, _rise(p, part, eq + dp), q, mu, beyond, dp, dt)
            if not any_above(off, _ENOUGH):
                break
            if count == 0:
                # σ_eq <= σ_eq^trial/(1 + Δλ μ_min) has come down to the first yield by here.
                high = (square_root(total) - (p[at] + R_old)) / softest
                closed = 64.0 * _ROUND_OFF * high
            # G falls over Δp: the root lies above where G > 1, below elsewhere.
            low = where_above(found.G, 1.0, dp, low)
            high = where_above(found.G, 1.0, high, dp)
            off = where_above(high - low, closed, off, none)
            count += 1
            if count == _TURNS or not any_above(off, _ENOUGH):
                break
            new, middle = dp + found.change, 0.5 * (low + high)
            # A turn that would leave the bracket halves it.
            new = where_above(new, low, new, middle)
            new = where_above(high, new, new, middle)
            # Lanes that are done stay as they are: their last correction is still to be added.
            dp = where_above(beyond, 0.0, where_above(off, _ENOUGH, new, dp), none)
        # A lane that is not solved gets nan, which stops the run by name.
        dp = where_above(off, _ENOUGH, np.nan * dp, dp)
        return end(p, at, beyond, state, dp, found)

    @apart_as(name)
    def flow(p, at, q, mu, beyond, state, dt):
        # No loop: the compiler would first load all constants of its body, and then store them.
        not_inlined()
        eq, R_old = state
        part, limit = at + 2, p[at + 5]
        if any_above(eq, limit):
            # The last but one argument is of no use here: the first Δp is found anew there.
            return further(p, at, q, mu, beyond, state, eq, dt)
        total, slopes, _ = sums(q, mu)
        dp = _first_flow(total, p[at] + R_old, total * p[part + 1] + slopes)
        dp = where_above(beyond, 0.0, dp, zero_like(eq))
        # In most steps all lanes stay on the first straight part, and one turn is enough.
        off, found = turn(p, at, _straight_rise(p, part, eq + dp), q, mu, beyond, dp, dt)
        if seldom(any_above(off, _ENOUGH)) or seldom(any_above(eq + dp, limit)):
            return further(p, at, q, mu, beyond, state, dp, dt)
        return end(p, at, beyond, state, dp, found)

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
    size, axes = symmetric_eigen(moduli)
    factor = axes * np.sqrt(size)
    mu, turn = symmetric_eigen(product(factor.T, flow, factor))
    return np.asarray(product(factor, turn)), mu
