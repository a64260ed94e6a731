r"""Hardening: the yield stress as a function of the equivalent plastic strain.

It is a :class:`Table`: straight between points (p, σ), constant beyond the last. For the kernels,
:func:`part_of` finds the straight part that contains the least strain of a block, by halving, and
:func:`rise` continues from there to R = σ_y(p) - σ_y(0) and its slope dR/dp [MPa] of all lanes, as
:mod:`shellcut.material.point_law` says. The numbers stand in one row, from ``first`` on.

Three formulae make a table, of as many points as are needed to be within ``ACCURACY`` of them:

=============  ===============================================================================
`Linear`       σ_0 + H p
`Swift`        K (ε_0 + p)^n, with σ_0 = K ε_0^n
`Voce`         σ_0 + Q (1 - exp(-p/p_c)) + H p
=============  ===============================================================================

Between points at a distance d the curve is by d² \|σ''\|/8 above the straight line, so they lie
at equal steps of the integral of √(\|σ''\|/σ). Stresses are right to ``ACCURACY``, slopes to some
percent: a maximum of the nominal stress is found at one of the points.

Softening is refused: a film that softens localises in one row of quads, whatever its size, so that
its dissipation depends on the mesh. What a film loses in strength belongs to the cohesive law.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass, field
from typing import Annotated, Any, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Number
from shellcut.numerics.lane_functions import any_above, where_above

from .material import refuse

ACCURACY = 1e-4
"""Largest relative error of the formulae's yield stress."""
FARTHEST = 100.0
"""Plastic strain at which the tables of formulae end, which no film reaches: at a tenth of it a
strip is ten thousand times as long."""
_FINE = 4000  # places at which the curvature is summed
_MOST_PARTS = 20_000  # of a table: a law with a film's numbers has a hundred

MOST_POINTS = 24
"""Most points of a measured curve: more would follow its noise."""


def part_of(p: Floats, first: int, plastic: Number) -> int:
    """Return where in the row the straight part with the least of plastic strains begins.

    The row has the count of the parts, and of each its start, its slope and R continued to p = 0;
    then a start that no strain is above.
    """
    at, left = first + 1, int(p[first])
    while left > 1:
        half = left // 2
        ahead = at + 3 * half
        at = at if any_above(-plastic, -p[ahead]) else ahead
        left -= half
    return at


def rise(p: Floats, at: int, plastic: Number) -> tuple[Number, Number]:
    """Return R and dR/dp at plastic strains, none of which is below the part at ``at``."""
    slope, at_zero = p[at + 1] + 0.0 * plastic, p[at + 2] + 0.0 * plastic
    at += 3
    while any_above(plastic, p[at]):
        slope = where_above(plastic, p[at], p[at + 1], slope)
        at_zero = where_above(plastic, p[at], p[at + 2], at_zero)
        at += 3
    return at_zero + slope * plastic, slope


@checked
@dataclass(frozen=True)
class Table:
    """Yield stress: linear between given points, constant beyond the last.

    Examples
    --------
    >>> float(Table((0.0, 0.1, 1.0), (20.0, 30.0, 48.0)).stress(0.55))
    39.0
    """

    plastic_strain: tuple[float, ...]
    stress_at: tuple[float, ...]
    law: str = field(compare=False)

    def __init__(
        self,
        plastic_strain: Annotated[Any, Option("", "plastic strains, true, from 0", form="numbers")],
        stress: Annotated[Any, Option("MPa", "true yield stresses at these", form="numbers")],
        law: Annotated[str, Option("", "what cards say of it", unset="both ends")] = "",
    ) -> None:
        object.__setattr__(self, "plastic_strain", tuple(float(p) for p in plastic_strain))
        object.__setattr__(self, "stress_at", tuple(float(sigma) for sigma in stress))
        p, sigma = self.plastic_strain, self.stress_at
        problems = []
        if len(p) != len(sigma) or len(p) < 2:
            problems.append(
                "a table must have at least 2 points, as many strains as stresses, got "
                f"{len(p)} and {len(sigma)}"
            )
        elif not all(math.isfinite(value) for value in (*p, *sigma)):
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
        ends = (
            f"table, {sigma[0]:.4g} MPa to {sigma[-1]:.4g} MPa at a plastic strain of {p[-1]:.4g}"
        )
        object.__setattr__(self, "law", law or ends)

    @property
    def first_yield(self) -> float:
        """σ_y(0) [MPa]."""
        return self.stress_at[0]

    def stress(self, plastic: float | Floats) -> Floats:
        """Return σ_y [MPa] at equivalent plastic strains, of any shape."""
        return np.asarray(np.interp(plastic, self.plastic_strain, self.stress_at))

    def row(self) -> list[float]:
        """Return the numbers that :func:`part_of` and :func:`rise` read."""
        p, sigma = np.array(self.plastic_strain), np.array(self.stress_at)
        slope = np.append(np.diff(sigma) / np.diff(p), 0.0)
        parts = np.stack([p, slope, (sigma - sigma[0]) - slope * p], axis=1)
        return [float(len(p)), *parts.ravel().tolist(), math.inf]


def hardening_problems(hardening: object) -> list[str]:
    """Return in words why something is no hardening."""
    if isinstance(hardening, Table):
        return []
    return [f"hardening must be a Linear, Swift, Voce or Table, got {hardening!r}"]


SOFTENING = "a film that softens localises in one row of quads"
YieldStress: TypeAlias = Annotated[float, Option("MPa", "true stress at which it yields", above=0)]
Modulus: TypeAlias = Annotated[
    float,
    Option("MPa", "H, rise of the yield stress over plastic strain", least=0, why=SOFTENING),
]


@checked
def Linear(yield_stress: YieldStress, modulus: Modulus = 0.0) -> Table:
    """Return the table of σ_0 + H p, to a plastic strain of 100.

    Examples
    --------
    >>> float(Linear(20.0, 100.0).stress(0.1))
    30.0
    """
    said = f"linear, {yield_stress:g} MPa + {modulus:g} MPa p"
    return Table((0.0, FARTHEST), (yield_stress, yield_stress + modulus * FARTHEST), said)


@checked
def Swift(
    strength: Annotated[
        float, Option("MPa", "K of the yield stress K (start + p)^exponent", above=0)
    ],
    start: Annotated[
        float, Option("", "start of Swift's law; with 0 the film would yield at no stress", above=0)
    ],
    exponent: Annotated[float, Option("", "exponent of Swift's law", least=0, most=1)],
) -> Table:
    """Return the table of K (ε_0 + p)^n within 1e-4, to a plastic strain of 100.

    Examples
    --------
    >>> foil = Swift(strength=150.0, start=0.002, exponent=0.2)
    >>> round(foil.first_yield, 2)
    43.28
    """
    # σ''/σ is n (n - 1)/(ε_0 + p)²: points at equal ratios of ε_0 + p.
    whole = math.log1p(FARTHEST / start)
    least = whole * math.sqrt(exponent * (1.0 - exponent) / (8.0 * ACCURACY))
    count = _parts(max(least, 1.0))
    strains = [start * math.expm1(whole * k / count) for k in range(count + 1)]
    stress = [strength * math.pow(start + plastic, exponent) for plastic in strains]
    return Table(strains, stress, f"Swift, {strength:g} MPa ({start:g} + p)^{exponent:g}")


@checked
def Voce(
    yield_stress: YieldStress,
    gain: Annotated[
        float, Option("MPa", "Voce: further rise, which saturates", least=0, why=SOFTENING)
    ],
    strain: Annotated[float, Option("", "Voce: strain at 63 % of the gain", above=0)],
    modulus: Modulus = 0.0,
) -> Table:
    """Return the table of σ_0 + Q (1 - exp(-p/p_c)) + H p within 1e-4, to a plastic strain of 100.

    Examples
    --------
    >>> round(float(Voce(20.0, 10.0, 0.05).stress(1.0)), 2)
    30.0
    """

    def curve(plastic: float) -> float:
        return yield_stress - gain * math.expm1(-plastic / strain) + modulus * plastic

    # A hundredth of the strain in which the curvature, or the stress, changes much.
    least = 0.01 * min(strain, yield_stress / (gain / strain + modulus + yield_stress / FARTHEST))
    whole = math.log(FARTHEST / max(least, 1e-15))
    fine = [0.0, *(FARTHEST * math.exp(whole * (k / _FINE - 1.0)) for k in range(_FINE + 1))]
    # |σ''|/σ times p_c². Half the accuracy: of the last part only one end is where it is curved.
    bend = np.array([gain * math.exp(-plastic / strain) / curve(plastic) for plastic in fine])
    with np.errstate(all="ignore"):  # of numbers that are refused below
        density = np.sqrt(bend / (8.0 * 0.5 * ACCURACY)) / strain
        summed = np.cumsum(0.5 * (density[1:] + density[:-1]) * np.diff(fine))
    inner = np.arange(1, _parts(float(summed[-1])))
    strains = [0.0, *np.interp(inner, summed, fine[1:]).tolist(), FARTHEST]
    said = f"Voce, {yield_stress:g} MPa + {gain:g} MPa (1 - exp(-p/{strain:g})) + {modulus:g} MPa p"
    return Table(strains, [curve(plastic) for plastic in strains], said)


def _parts(count: float) -> int:
    """Return into how many parts a curve is divided; ValueError where they are too many."""
    if not count <= _MOST_PARTS:
        raise ValueError(
            f"a hardening law must follow its curve within {ACCURACY:g} in at most {_MOST_PARTS:,} "
            f"parts, needs {count:g}: take a larger yield_stress, start or strain"
        )
    return math.ceil(count)


def fewer_points(
    plastic_strain: Floats, stress: Floats, most: int = MOST_POINTS
) -> tuple[Floats, Floats]:
    """Return at most so many points of a curve, those that keep its shape.

    One after the other, the point is removed that lies nearest to the line between its neighbours,
    in stress; the first and the last stay ([Visvalingam1993] with heights instead of areas).

    Parameters
    ----------
    plastic_strain : ndarray, shape (n,)
        Increasing.
    stress : ndarray, shape (n,), [MPa]
    most : int

    Examples
    --------
    >>> strain, stress = fewer_points(np.arange(5.0), np.array([1.0, 2.0, 3.0, 3.0, 3.0]), 3)
    >>> strain.tolist()
    [0.0, 2.0, 4.0]
    """
    p, s = np.asarray(plastic_strain, float), np.asarray(stress, float)
    while len(p) > max(most, 2):
        share = (p[1:-1] - p[:-2]) / (p[2:] - p[:-2])
        off = np.abs(s[:-2] + share * (s[2:] - s[:-2]) - s[1:-1])
        nearest = 1 + int(np.argmin(off))
        p, s = np.delete(p, nearest), np.delete(s, nearest)
    return p, s
