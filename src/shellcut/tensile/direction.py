"""Means and scatter over the specimens of one direction, hardening curve and law."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import nan
from statistics import fmean, stdev

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.material.hardening_points import fewer_points

from .figures import Figures

MEASURES = {
    "young": ("Young's modulus", "MPa"),
    "yield_stress": ("yield stress", "MPa"),
    "strength": ("tensile strength", "MPa"),
    "strain_at_strength": ("strain at strength", "-"),
    "strain_at_break": ("strain at break", "-"),
}
"""Name and unit of each figure."""

_ENOUGH = 5  # specimens in each direction (ISO 527-1)
_N_ROW = 25  # of the hardening curve
_PER_LINE = 8  # numbers in a list of the model file
_N_POINT = 101  # of the mean curve
_BOUNDS = [(0.02, 1.0), (1e-3, 1.0), (1e-3, 1.0)]  # of plateau, l_A and length of the plateau
_ONSET = 1.0 / 800.0  # over opening_u, as in the paper's law
_WIDE = 0.15  # scatter over the mean that is worth a word


@dataclass(frozen=True)
class Spread:
    """Mean and standard deviation of a figure over specimens."""

    mean: float
    deviation: float
    """NaN for one specimen."""
    n: int
    """Number of specimens that have the figure."""

    @classmethod
    def of(cls, values: Sequence[float]) -> Spread:
        """Return the spread of the values that are numbers."""
        known = [value for value in values if value == value]
        if not known:
            return cls(nan, nan, 0)
        return cls(fmean(known), stdev(known) if len(known) > 1 else nan, len(known))

    def text(self, unit: str = "") -> str:
        """Return "mean ± deviation unit", per cent for ratios."""
        if not self.n:
            return "-"
        factor, shown = (100.0, " %") if unit == "-" else (1.0, f" {unit}")
        around = f" ± {factor * self.deviation:.2g}" if self.n > 1 else ""
        return f"{factor * self.mean:.4g}{around}{shown}"


@dataclass(frozen=True, eq=False)
class Direction:
    """All specimens cut in one direction."""

    name: str
    figures: list[Figures]
    gauge_length: float | None
    """[mm]"""

    def spread(self, measure: str) -> Spread:
        """Return mean and scatter of one of :data:`MEASURES`."""
        return Spread.of([getattr(one, measure) for one in self.figures])

    @property
    def fracture_energy(self) -> Spread:
        """Gauge length times the area below the falling stress [N/mm = kJ/m²]."""
        length = nan if self.gauge_length is None else self.gauge_length
        return Spread.of([length * one.energy_per_length for one in self.figures])

    @property
    def falling(self) -> list[Figures]:
        """Specimens whose fall after the strength is recorded."""
        return [one for one in self.figures if len(one.opening_per_length)]

    def law(self) -> CohesiveLaw | None:
        """Return the proposed law, None where the tests say nothing about the fall.

        It is that of the mean fall: shapes, ends and strengths are averaged apart, so that one
        early break does not make a step.
        """
        if self.gauge_length is None or not self.falling:
            return None
        share = np.linspace(0.0, 1.0, _N_POINT)
        shapes, ends = [], []
        for one in self.falling:
            ends.append(self.gauge_length * one.opening_per_length[-1])
            of_end = one.opening_per_length / one.opening_per_length[-1]
            shapes.append(np.interp(share, of_end, one.falling_stress / one.falling_stress[0]))
        strength = np.mean([one.strength for one in self.falling])
        opening, stress = share * np.mean(ends), strength * np.mean(shapes, axis=0)
        return proposed_law(opening, stress, self.fracture_energy.mean)

    def hardening(self) -> tuple[Floats, Floats, Floats, int]:
        """Return plastic strain, mean true stress and its deviation [MPa], number of specimens.

        Up to the smallest strain of the specimens at strength; empty arrays without yield.
        """
        known = [one for one in self.figures if len(one.plastic_strain)]
        if not known:
            nothing = np.zeros(0)
            return nothing, nothing, nothing, 0
        end = min(float(one.plastic_strain[-1]) for one in known)
        strain = end * np.linspace(0.0, 1.0, _N_ROW) ** 2  # closer where the curve bends
        each = np.array([np.interp(strain, one.plastic_strain, one.true_stress) for one in known])
        scatter = each.std(axis=0, ddof=1) if len(known) > 1 else np.full(_N_ROW, nan)
        return strain, each.mean(axis=0), scatter, len(known)

    def material(self) -> str | None:
        """Return ``[material]`` of a film that yields, None without a hardening curve."""
        strain, stress, _, n = self.hardening()
        return _material_section(self.spread("young").mean, strain, stress, n) if n else None

    def sentences(self) -> list[str]:
        """Return what to know before the figures are used."""
        said = [
            f"{one.specimen.name}: {text}"
            for one in self.figures
            for text in (*one.specimen.notes, *one.sentences)
        ]
        n = len(self.figures)
        if n == 1:
            said.append("one specimen: the scatter is unknown")
        elif n < _ENOUGH:
            said.append(f"{n} specimens: the scatter is rough, ISO 527 asks for {_ENOUGH}")
        for measure, (name, _) in MEASURES.items():
            spread = self.spread(measure)
            if spread.deviation > _WIDE * spread.mean:
                said.append(f"{name} scatters by {spread.deviation / spread.mean:.0%} of its mean")
        return said + self._about_energy()

    def _about_energy(self) -> list[str]:
        if not self.falling:
            return [
                "no law: no specimen shows a fall; a tear test, or the force of a cut, gives the "
                "fracture energy"
            ]
        if self.gauge_length is None:
            return ["no law: give the gauge_length, openings and fracture energy follow from it"]
        length, energy = self.gauge_length, self.fracture_energy
        per_length = Spread.of([one.energy_per_length for one in self.falling])
        said = [
            f"fracture energy {energy.text('kJ/m²')} = gauge length {length:g} mm x "
            f"{per_length.text('N/mm²')} below the fall, from {energy.n} of {len(self.figures)} "
            "specimens. All elongation after the strength is taken as the opening of one crack: "
            "if the film also stretched elsewhere, openings and energy are upper bounds. A second "
            "gauge length tells: if the energy grows with it, they are"
        ]
        if drawn := [one for one in self.falling if one.drawn]:
            said.append(
                f"{len(drawn)} of {len(self.falling)} specimens hold over 80 % of the strength "
                "half-way to the break: a neck spreads along the gauge length. The energy then "
                "grows with the gauge length and is an upper bound, not a property of the film"
            )
        return said


def proposed_law(opening: Floats, stress: Floats, fracture_energy: float) -> CohesiveLaw:
    """Return the law nearest to a falling curve, with the given area [N/mm].

    The openings [mm] begin at 0, the stresses [MPa] with the strength. The area is kept: opening_u
    follows from it and the other three numbers, which are fitted.
    """
    strength, end = float(stress[0]), float(opening[-1])
    area, x, y = fracture_energy / strength / end, opening / end, stress / strength

    def miss(shape: Floats) -> float:
        plateau, a, p, u = _openings(shape, area)
        if u <= 1.001 * p:
            return float("inf")
        drop, tail = 1.0 - (1.0 - plateau) * x / a, plateau * np.clip((u - x) / (u - p), 0.0, 1.0)
        law = np.where(x < a, drop, np.where(x < p, plateau, tail))
        return float(np.mean((law - y) ** 2))

    found = scipy.optimize.differential_evolution(miss, _BOUNDS, seed=0, tol=1e-6, polish=False)
    plateau, a, p, u = map(float, _openings(found.x, area))
    return CohesiveLaw(
        strength=strength,
        plateau=plateau * strength,
        opening_a=a * end,
        opening_p=p * end,
        opening_u=u * end,
        onset=u * end * _ONSET,
    )


def _openings(shape: Floats, area: float) -> tuple[float, float, float, float]:
    """Return plateau and l_A, l_P, l_U of a law of this area, over strength and end of the curve.

    ``shape`` is the plateau, l_A, and the share of the plateau in what is left to the end.
    """
    plateau, a, flat = shape.tolist()
    p = a + flat * (1.0 - a)
    return plateau, a, p, (2.0 * area - (1.0 - plateau) * a) / plateau - p


def _material_section(young: float, plastic_strain: Floats, true_stress: Floats, n: int) -> str:
    """Return ``[material]`` with modulus and hardening table; what is not measured is a comment.

    The curve is true, in MPa, from a plastic strain of 0, increasing; n specimens are behind it.
    """
    strain, stress = fewer_points(plastic_strain, true_stress)
    return "\n".join(
        [
            f"# From {n} specimens, up to the strength; the yield stress stays constant beyond.",
            "# poisson, density and thickness are not measured in a tensile test: give them.",
            "[material]",
            f"young = {young:.6g}",
            "# poisson = 0.4",
            '# density = "0.92 g/cm3"',
            '# thickness = "50 um"',
            *_array("hardening_strain", strain),
            *_array("hardening_stress", stress),
            "",
        ]
    )


def _array(name: str, values: Floats) -> list[str]:
    words = [f"{value:.6g}" for value in values]
    lines = [words[at : at + _PER_LINE] for at in range(0, len(words), _PER_LINE)]
    return [f"{name} = [", *(f"    {', '.join(line)}," for line in lines), "]"]
