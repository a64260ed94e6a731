r"""Films that yield: von Mises or Hill plasticity between logarithmic strain and its stress.

T = C (ε - ε_p) with the strain of :mod:`.logarithmic_strain`, so T is the Kirchhoff stress turned
back and ε_p a true strain, up to any stretch; the flow is that of :mod:`.return_mapping`, the yield
stress that of :mod:`.hardening`.

**von Mises** in plane stress, with the mean t = ½ (T_11 + T_22) and the deviator (u, v):

    σ_eq² = t² + 3 (u² + v²),    modes t, u, v with μ = ½ E/(1 - ν) and 3 G,
    Δε_p: mean ½ Δλ t, deviator 3/2 Δλ u, v.

**Hill's criterion of 1948** by r-values, the ratios of plastic strain in width and thickness of
strips cut at 0, 45 and 90° to MD. With σ_y that of a strip along MD, σ_eq² = T · P T,

    P = [[G + H, -H, 0], [-H, F + H, 0], [0, 0, 2 N]],
    G = 1/(1 + r0),  H = r0/(1 + r0),  F = r0/[r90 (1 + r0)],
    N = (r0 + r90)(1 + 2 r45)/[2 r90 (1 + r0)].

(Other codes give F, G, H other places.) Three equal r-values of 1 are von Mises. The surface is
closed, P positive definite, where all r are positive: G + H = 1, det = FG + GH + HF > 0.
"""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import Annotated, Any

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Number, Vector, product
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_exponentials import exponential
from shellcut.numerics.lane_functions import any_above, zero_like
from shellcut.numerics.processor import seldom
from shellcut.numerics.small_matrices import inverse

from .elastic import Elastic
from .hardening import Table, hardening_problems
from .logarithmic_strain import (
    is_small,
    logarithmic_strain,
    piola_of_mean,
    second_piola_kirchhoff,
    small_isotropic,
    sum_and_difference,
)
from .material import refuse
from .orthotropic import Orthotropic, WithElasticPart, strain_turn
from .point_law import History, PointLaw, register
from .rate_factor import RateFactor, rate_problems
from .return_mapping import excess, make_flow, modes_of

HISTORY = (
    "equivalent plastic strain [-]",
    "hardening [MPa]",
    "plastic strain 11 [-]",
    "plastic strain 22 [-]",
    "plastic strain 12, twice [-]",
)
"""History of each thickness point, in the axes of the point; true strains."""

_TURNING = (2,)

# Places in the rows of parameters.
_LATERAL = 1  # isotropic: ν/(1 - ν); with axes: three numbers
_MEAN, _SHEAR, _YIELD = 2, 3, 4
_V, _PLASTIC, _MU, _YIELD_AXES = 4, 13, 22, 25


def _isotropic_law(flow: Any, frozen: bool, has_rate: bool) -> tuple[Any, Any]:
    """Return the functions of von Mises with isotropic moduli.

    A frozen law does not flow, one with a rate factor only in time.
    """

    def stress(
        p: Floats, strain: Vector, history: History, dt: float
    ) -> tuple[Vector, Number, Number, History, bool]:
        eq, R, p1, p2, p12 = history
        may_flow = not frozen and (dt > 0.0 or not has_rate)
        if is_small(strain) and not any_above(eq, 0.0):
            # Most of a film at most times: no logarithm, no division.
            S, of_mean, of_shear, stored = small_isotropic(strain, p[_MEAN], p[_SHEAR])
            # Nothing has hardened.
            beyond = excess(of_mean + 3.0 * of_shear, p[_YIELD], may_flow)
            if not seldom(any_above(beyond, 0.0)):
                return S, stored, zero_like(R), history, False
        (both, unlike, slip), transform = sum_and_difference(strain)
        if any_above(eq, 0.0):  # else there is no plastic strain to subtract
            both, unlike, slip = both - (p1 + p2), unlike - (p1 - p2), slip - p12
        z = (p[_MEAN] * both, p[_SHEAR] * unlike, p[_SHEAR] * slip)
        of_mean, of_shear = z[0] * z[0], 3.0 * (z[1] * z[1] + z[2] * z[2])
        beyond = excess(of_mean + of_shear, p[_YIELD] + R, may_flow)
        lost = zero_like(R)
        flows = any_above(beyond, 0.0)
        if seldom(flows):
            mu = (p[_MEAN], 3.0 * p[_SHEAR])
            done = flow(p, _YIELD, (of_mean, of_shear), mu, beyond, (eq, R), dt)
            eq, R, lost = done.plastic, done.hardening, done.lost
            # Δε_p of (1): P is ½ for the mean, 3/2 for the deviator, both are sums of two here.
            d_both = done.by_mode[0] * z[0]
            by_shear = 3.0 * done.by_mode[1]
            d_unlike, d_slip = by_shear * z[1], by_shear * z[2]
            both, unlike, slip = both - d_both, unlike - d_unlike, slip - d_slip
            p1, p2 = p1 + 0.5 * (d_both + d_unlike), p2 + 0.5 * (d_both - d_unlike)
            p12 = p12 + d_slip
        t, Tu, Tv = p[_MEAN] * both, p[_SHEAR] * unlike, p[_SHEAR] * slip
        stored = 0.5 * (t * both + Tu * unlike + Tv * slip)
        S = piola_of_mean(t, Tu, Tv, transform)
        return S, stored, lost, (eq, R, p1, p2, p12), flows

    def thickness_stretch(p: Floats, strain: Vector, history: History) -> Number:
        e, _ = logarithmic_strain(strain)
        plastic = history[2] + history[3]
        return exponential(-p[_LATERAL] * (e[0] + e[1] - plastic) - plastic)

    return stress, thickness_stretch


@always_inline
def _times(p: Floats, first: int, v: Vector) -> Vector:
    """Return the product of a matrix, whose rows begin at ``first``, and a vector."""
    return (
        p[first] * v[0] + p[first + 1] * v[1] + p[first + 2] * v[2],
        p[first + 3] * v[0] + p[first + 4] * v[1] + p[first + 5] * v[2],
        p[first + 6] * v[0] + p[first + 7] * v[1] + p[first + 8] * v[2],
    )


def _law_with_axes(flow: Any, frozen: bool, has_rate: bool) -> tuple[Any, Any]:
    """Return the functions of Hill's criterion, or of orthotropic moduli."""

    def stress(
        p: Floats, strain: Vector, history: History, dt: float
    ) -> tuple[Vector, Number, Number, History, bool]:
        e, transform = logarithmic_strain(strain)
        eq, R, p1, p2, p12 = history
        may_flow = not frozen and (dt > 0.0 or not has_rate)
        e1, e2, e12 = e[0] - p1, e[1] - p2, e[2] - p12
        # The trial modes z = Vᵀ(ε - ε_p) and their shares in σ_eq², (4) there.
        y0 = p[_V] * e1 + p[_V + 3] * e2 + p[_V + 6] * e12
        y1 = p[_V + 1] * e1 + p[_V + 4] * e2 + p[_V + 7] * e12
        y2 = p[_V + 2] * e1 + p[_V + 5] * e2 + p[_V + 8] * e12
        m0, m1, m2 = p[_MU], p[_MU + 1], p[_MU + 2]
        q = (m0 * y0 * y0, m1 * y1 * y1, m2 * y2 * y2)
        beyond = excess(q[0] + q[1] + q[2], p[_YIELD_AXES] + R, may_flow)
        lost = zero_like(R)
        flows = any_above(beyond, 0.0)
        if seldom(flows):
            done = flow(p, _YIELD_AXES, q, (m0, m1, m2), beyond, (eq, R), dt)
            eq, R, lost = done.plastic, done.hardening, done.lost
            # The parameters have P V, which turns Δλ z into Δε_p.
            z0 = done.by_mode[0] * y0
            z1 = done.by_mode[1] * y1
            z2 = done.by_mode[2] * y2
            d1, d2, d12 = _times(p, _PLASTIC, (z0, z1, z2))
            p1, p2, p12 = p1 + d1, p2 + d2, p12 + d12
            y0, y1, y2 = y0 - m0 * z0, y1 - m1 * z1, y2 - m2 * z2
        stored = 0.5 * (y0 * y0 + y1 * y1 + y2 * y2)
        S = second_piola_kirchhoff(_times(p, _V, (y0, y1, y2)), transform)
        return S, stored, lost, (eq, R, p1, p2, p12), flows

    def thickness_stretch(p: Floats, strain: Vector, history: History) -> Number:
        e, _ = logarithmic_strain(strain)
        p1, p2, p12 = history[2], history[3], history[4]
        elastic = (
            p[_LATERAL] * (e[0] - p1)
            + p[_LATERAL + 1] * (e[1] - p2)
            + p[_LATERAL + 2] * (e[2] - p12)
        )
        return exponential(-elastic - (p1 + p2))

    return stress, thickness_stretch


@functools.cache
def _law(rate: Any, axes: bool) -> PointLaw:
    """Return the law for a class of rate."""
    has_rate = rate is not RateFactor
    name = f"{'Hill' if axes else 'von Mises'} {rate.kind}".rstrip()
    functions, n_mode = (_law_with_axes, 3) if axes else (_isotropic_law, 2)
    flow = make_flow(rate.function, has_rate, n_mode)
    common: Any = {"oriented": axes, "turning": _TURNING, "first_leads": True}
    frozen = PointLaw(f"{name}, frozen", *functions(flow, True, has_rate), HISTORY, **common)
    law = PointLaw(
        name,
        *functions(flow, False, has_rate),
        HISTORY,
        timed=has_rate,
        frozen=register(frozen),
        **common,
    )
    return register(law)


def hill_matrix(r_values: tuple[float, float, float]) -> Floats:
    """Return P of σ_eq² = T · P T for (T_11, T_22, T_12), shape (3, 3).

    Parameters
    ----------
    r_values : tuple of three floats
        r0, r45 and r90.
    """
    r0, r45, r90 = r_values
    G, H, F = 1.0 / (1.0 + r0), r0 / (1.0 + r0), r0 / (r90 * (1.0 + r0))
    N = (r0 + r90) * (1.0 + 2.0 * r45) / (2.0 * r90 * (1.0 + r0))
    return np.array([[G + H, -H, 0.0], [-H, F + H, 0.0], [0.0, 0.0, 2.0 * N]])


@checked
@dataclass(frozen=True)
class Plastic(WithElasticPart):
    """A film that yields, up to any strain; an Orthotropic is turned by its own angle.

    Parameters
    ----------
    elastic : Elastic or Orthotropic
        Moduli and density.
    hardening : Table
        Yield stress in tension, along MD if ``r_values`` are given, by the equivalent plastic
        strain: :class:`~.hardening.Table`, or of the formulae of :func:`~.hardening.Linear`,
        :func:`~.hardening.Swift` and :func:`~.hardening.Voce`. True stress by true strain.
    rate : RateFactor, optional
        :class:`~.rate_factor.CowperSymonds` or :class:`~.rate_factor.JohnsonCook`.

    Raises
    ------
    ValueError
        If r-values are not positive.

    Notes
    -----
    Hardening is isotropic and stores nothing: all plastic work is heat.

    Examples
    --------
    >>> from shellcut.material.hardening import Voce
    >>> foil = Plastic(Elastic(70_000.0, 0.33, 2.7e-9), Voce(40.0, 60.0, 0.05))
    >>> foil.law.name
    'von Mises'
    """

    elastic: Elastic | Orthotropic
    hardening: Table
    r_values: Annotated[
        tuple[float, float, float] | None,
        Option("", "Hill's r at 0, 45 and 90 deg", form="3 numbers", unset="von Mises"),
    ] = None
    rate: RateFactor | None = None
    angle_deg: Annotated[
        float, Option("deg", "angle from the film's direction to the axes of r_values")
    ] = 0.0

    def __post_init__(self) -> None:
        problems = hardening_problems(self.hardening) + rate_problems(self.rate)
        if self.r_values is not None:
            object.__setattr__(self, "r_values", tuple(self.r_values))
            r = self.r_values
            if len(r) != 3 or not all(math.isfinite(value) and value > 0.0 for value in r):
                problems.append(
                    "r_values must be three positive numbers (r0, r45, r90), or the yield surface "
                    f"is not closed and convex, got {r!r}"
                )
        refuse(problems)

    @property
    def has_axes(self) -> bool:
        """Whether the film's direction matters."""
        return self.r_values is not None or isinstance(self.elastic, Orthotropic)

    @property
    def law(self) -> PointLaw:  # type: ignore[override]
        """The law for this kind of rate and axes."""
        return _law(RateFactor if self.rate is None else type(self.rate), self.has_axes)

    def flow_matrix(self) -> Floats:
        """Return P of σ_eq² = T · P T in the film's axes, shape (3, 3)."""
        P = hill_matrix(self.r_values or (1.0, 1.0, 1.0))
        # Stresses turn by the transposed inverse of the strains' matrix.
        R = inverse(strain_turn(self.angle_deg)).T
        return np.asarray(product(R.T, P, R))

    def parameters(self) -> Floats:
        """Return the parameters of :attr:`law`; the first is where those of the rate begin."""
        if self.has_axes:
            C, P = self.elastic.plane_stress(), self.flow_matrix()
            V, mu = modes_of(C, P)
            rows = [
                *self.elastic.thickness_slope(),
                *V.ravel(),
                *(inverse(V).T * mu).ravel(),
                *mu,
            ]
        else:
            e, nu = self.elastic.stretching_modulus, self._poisson
            rows = [nu / (1.0 - nu), 0.5 * e / (1.0 - nu), 0.5 * e / (1.0 + nu)]
        rows += [self.hardening.first_yield, *self.hardening.row()]
        rate = [] if self.rate is None else self.rate.row()
        return np.array([1.0 + len(rows), *rows, *rate])

    @property
    def _poisson(self) -> float:
        assert isinstance(self.elastic, Elastic)
        return self.elastic.poisson
