"""Hardening: the yield stress as a function of the equivalent plastic strain.

Each kind is a class for the user, with its checks, and a function of numbers for the kernels, which
returns R = σ_y(p) - σ_y(0) and its slope dR/dp [MPa] (:mod:`shellcut.material.point_law` says what
such functions may use). Parameters for a kernel come in one row, from the index ``first`` on.

=============  ===============================================================================
`Linear`       σ_0 + H p
`Swift`        K (ε_0 + p)^n, with σ_0 = K ε_0^n
`Voce`         σ_0 + Q (1 - exp(-p/p_c)) + H p
`Table`        straight between given points (p, σ), constant beyond the last
=============  ===============================================================================

Softening is refused: a film that softens localises in one row of quads, whatever its size, so that
its dissipation depends on the mesh. What a film loses in strength belongs to the cohesive law.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Number
from shellcut.numerics.lane_exponentials import exponential, power
from shellcut.numerics.lane_functions import any_above, larger, where_above

from .material import refuse

MOST_POINTS = 24
"""Points of a table: each that a film has passed costs a few operations a step and point."""


def _linear(p: Floats, first: int, plastic: Number) -> tuple[Number, Number]:
    """H."""
    return p[first] * plastic, p[first] + 0.0 * plastic


def _linear_slope(p: Floats, first: int, plastic: Number, reached: Number) -> Number:
    return p[first] + 0.0 * plastic


def _swift(p: Floats, first: int, plastic: Number) -> tuple[Number, Number]:
    """K, ε_0, n, σ_0."""
    reached = plastic + p[first + 1]
    whole = p[first] * power(reached, p[first + 2])
    return whole - p[first + 3], p[first + 2] * whole / reached


def _swift_slope(p: Floats, first: int, plastic: Number, reached: Number) -> Number:
    return p[first + 2] * (reached + p[first + 3]) / (plastic + p[first + 1])


def _voce(p: Floats, first: int, plastic: Number) -> tuple[Number, Number]:
    """Q, 1/p_c, H."""
    left = p[first] * exponential(-p[first + 1] * plastic)
    return (
        (p[first] - left) + p[first + 2] * plastic,
        p[first + 1] * left + p[first + 2],
    )


def _voce_slope(p: Floats, first: int, plastic: Number, reached: Number) -> Number:
    left = (p[first] - reached) + p[first + 2] * plastic
    return p[first + 1] * left + p[first + 2]


def _table(p: Floats, first: int, plastic: Number) -> tuple[Number, Number]:
    """Count, then the start, length and slope of each straight part."""
    stress, slope = 0.0 * plastic, 0.0 * plastic
    for k in range(int(p[first])):
        at = first + 1 + 3 * k
        into = plastic - p[at]
        if not any_above(into, -p[at + 1]):
            break  # far from this part and from all that follow
        within = larger(where_above(into, p[at + 1], p[at + 1], into), 0.0)
        stress = stress + p[at + 2] * within
        # On a corner the slope of the part that follows.
        part = where_above(p[at + 1], into, p[at + 2], 0.0)
        slope = slope + where_above(0.0, into, 0.0, part)
    return stress, slope


def _table_slope(p: Floats, first: int, plastic: Number, reached: Number) -> Number:
    slope = 0.0 * plastic
    for k in range(int(p[first])):
        at = first + 1 + 3 * k
        into = plastic - p[at]
        if not any_above(into, -p[at + 1]):
            break
        slope = slope + where_above(0.0, into, 0.0, where_above(p[at + 1], into, p[at + 2], 0.0))
    return slope


@dataclass(frozen=True)
class Hardening:
    """How a yield stress grows; use one of the subclasses."""

    function: ClassVar[Callable[..., Any]]
    slope: ClassVar[Callable[..., Any]]
    """dR/dp at p and R, by fewer operations."""
    kind: ClassVar[str]

    @property
    def first_yield(self) -> float:
        """σ_y(0) [MPa]."""
        raise NotImplementedError

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        raise NotImplementedError

    def stress(self, plastic: float | Floats) -> Floats:
        """Return σ_y [MPa] at equivalent plastic strains, of any shape."""
        p = np.asarray(plastic, float)
        row = np.array(self.row())
        above = [self.function(row, 0, float(one))[0] for one in p.ravel()]
        return self.first_yield + np.array(above).reshape(p.shape)


# What the kernels ask a class for, and what it is.
_ASKED = {
    "function": "a static function (p, first, plastic) that returns R and dR/dp",
    "slope": "a static function (p, first, plastic, reached) that returns dR/dp at p and R",
    "kind": "a word for the law's name",
}


def hardening_problems(hardening: object) -> list[str]:
    """Return in words why something is no hardening."""
    kind = type(hardening)
    if not isinstance(hardening, Hardening) or kind is Hardening:
        return [f"hardening must be a Linear, Swift, Voce or Table, got {hardening!r}"]
    missing = [
        f"{name}, {what}"
        for name, what in _ASKED.items()
        if not (isinstance(getattr(kind, name, None), str) or callable(getattr(kind, name, None)))
    ]
    if not missing:
        return []
    return [f"the hardening {kind.__name__} lacks {'; '.join(missing)}"]


SOFTENING = "a film that softens localises in one row of quads"
YieldStress: TypeAlias = Annotated[float, Option("MPa", "at which it yields, true", above=0)]
Modulus: TypeAlias = Annotated[
    float,
    Option("MPa", "H, rise of the yield stress over plastic strain", least=0, why=SOFTENING),
]


@checked
@dataclass(frozen=True)
class Linear(Hardening):
    """σ_0 + H p.

    Examples
    --------
    >>> float(Linear(20.0, 100.0).stress(0.1))
    30.0
    """

    function = staticmethod(_linear)
    slope = staticmethod(_linear_slope)
    kind = "linear"

    yield_stress: YieldStress
    modulus: Modulus = 0.0

    @property
    def first_yield(self) -> float:
        """σ_y(0) [MPa]."""
        return self.yield_stress

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        return [self.modulus]


@checked
@dataclass(frozen=True)
class Swift(Hardening):
    """K (ε_0 + p)^n.

    Examples
    --------
    >>> foil = Swift(strength=150.0, start=0.002, exponent=0.2)
    >>> round(foil.first_yield, 2)
    43.28
    """

    function = staticmethod(_swift)
    slope = staticmethod(_swift_slope)
    kind = "Swift"

    strength: Annotated[
        float, Option("MPa", "K of the yield stress K (start + p)^exponent", above=0)
    ]
    start: Annotated[
        float, Option("", "of Swift's law; with 0 the film would yield at no stress", above=0)
    ]
    exponent: Annotated[float, Option("", "of Swift's law", least=0, most=1)]

    @property
    def first_yield(self) -> float:
        """σ_y(0) [MPa]."""
        return self.strength * math.pow(self.start, self.exponent)

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        return [self.strength, self.start, self.exponent, self.first_yield]


@checked
@dataclass(frozen=True)
class Voce(Hardening):
    """σ_0 + Q (1 - exp(-p/p_c)) + H p.

    Examples
    --------
    >>> Voce(20.0, 10.0, 0.05).row()
    [10.0, 20.0, 0.0]
    """

    function = staticmethod(_voce)
    slope = staticmethod(_voce_slope)
    kind = "Voce"

    yield_stress: YieldStress
    gain: Annotated[
        float, Option("MPa", "Voce: further rise, which saturates", least=0, why=SOFTENING)
    ]
    strain: Annotated[float, Option("", "Voce: strain at 63 % of the gain", above=0)]
    modulus: Modulus = 0.0

    @property
    def first_yield(self) -> float:
        """σ_y(0) [MPa]."""
        return self.yield_stress

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        return [self.gain, 1.0 / self.strain, self.modulus]


@checked
@dataclass(frozen=True)
class Table(Hardening):
    """Straight between given points, constant beyond the last.

    Examples
    --------
    >>> float(Table((0.0, 0.1, 1.0), (20.0, 30.0, 48.0)).stress(0.55))
    39.0
    """

    function = staticmethod(_table)
    slope = staticmethod(_table_slope)
    kind = "table"

    plastic_strain: tuple[float, ...]
    stress_at: tuple[float, ...]

    def __init__(
        self,
        plastic_strain: Annotated[
            Any, Option("", "plastic strains, true, from 0; up to 24", form="numbers")
        ],
        stress: Annotated[Any, Option("MPa", "true yield stresses at these", form="numbers")],
    ) -> None:
        object.__setattr__(self, "plastic_strain", tuple(float(one) for one in plastic_strain))
        object.__setattr__(self, "stress_at", tuple(float(one) for one in stress))
        p, sigma = self.plastic_strain, self.stress_at
        problems = []
        if len(p) != len(sigma) or not 2 <= len(p) <= MOST_POINTS:
            problems.append(
                f"a table must have 2 to {MOST_POINTS} points, as many strains as stresses, got "
                f"{len(p)} and {len(sigma)}"
            )
        elif not all(math.isfinite(one) for one in (*p, *sigma)):
            problems.append("a table must hold finite numbers")
        else:
            if p[0] != 0.0 or any(b <= a for a, b in itertools.pairwise(p)):
                problems.append(f"plastic_strain must start at 0 and increase, got {p}")
            if sigma[0] <= 0.0:
                problems.append(f"the first stress must be positive, got {sigma[0]!r}")
            for k, (a, b) in enumerate(itertools.pairwise(sigma)):
                if b < a:
                    problems.append(
                        "stress must not decrease (a film that softens localises in one row of "
                        f"quads): {b:g} MPa after {a:g} at entry {k + 1}; give its loss of "
                        "strength to the cohesive law"
                    )
        refuse(problems)

    @property
    def first_yield(self) -> float:
        """σ_y(0) [MPa]."""
        return self.stress_at[0]

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        p, sigma = np.array(self.plastic_strain), np.array(self.stress_at)
        length = np.diff(p)
        parts = np.stack([p[:-1], length, np.diff(sigma) / length], axis=1)
        return [float(len(length)), *parts.ravel().tolist()]
