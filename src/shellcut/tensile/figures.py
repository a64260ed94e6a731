"""Figures of one specimen: :func:`figures_of`, defined in docs/howto/tensile.md."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import scipy

from shellcut.arrays import Floats

from .specimen import BROKEN, Specimen

ELASTIC = (0.0005, 0.0025)
"""Strains between which the modulus is measured, from the line's own zero (ISO 527-1)."""

_SLACK = 0.02  # of the strength: the first guess of the line's zero
_RISEN = 0.5  # of the strength: slack and foot end below this
_STEEPER = 1.03  # slope of a stretch over that before it, in a foot
_BENT = 0.9  # slope of the upper half of the elastic range over that of the lower half: said
_YIELDS = 0.5  # the same: the upper half is no elastic range
_TURNS = 50  # of the search for the line whose zero its range is counted from
_FEW = 5  # points of a trustworthy line
_LOOSE = 0.05  # relative error of the modulus that is worth a word
_FALLEN = 0.8  # of the strength: a record that ends above shows no fall
_TORN = 0.3  # of the strength: a break from above is worth a word
_DRAWN = 0.8  # stress half-way after the strength, over it: the film is drawn, it does not part
_NOISE = 2.5  # standard deviations
_MEAN_OF = 4  # points averaged into a row of the hardening curve
_MOST_ROWS = 40


@dataclass(frozen=True, eq=False)
class Figures:
    """What one curve says; NaN where it says nothing."""

    specimen: Specimen
    young: float
    """[MPa]"""
    young_error: float
    """Standard error of the slope [MPa]."""
    slack: float
    """Strain at which the elastic line starts [-]; subtracted from all strains below."""
    yield_stress: float
    """Nominal, at the offset [MPa]."""
    strength: float
    """Largest nominal stress [MPa]."""
    strain_at_strength: float
    strain_at_break: float
    """[-]; NaN if the record ends before the break."""
    plastic_strain: Floats
    """Logarithmic, from yield to strength, first 0; empty if there are too few points."""
    true_stress: Floats
    """[MPa], of each plastic strain."""
    opening_per_length: Floats
    """Opening over the gauge length [-] from the strength on, from 0; empty without a fall."""
    falling_stress: Floats
    """Nominal [MPa], of each opening."""
    sentences: list[str] = field(default_factory=list)
    """What to know before the figures are used."""

    @property
    def energy_per_length(self) -> float:
        """Area below the falling stress [N/mm over mm]; NaN without a fall."""
        if not len(self.opening_per_length):
            return float("nan")
        return float(scipy.integrate.trapezoid(self.falling_stress, self.opening_per_length))

    @property
    def drawn(self) -> bool:
        """Whether the stress stays up after the strength, as where a neck spreads."""
        half = 0.5 * self.opening_per_length[-1:]
        stress = (
            np.interp(half, self.opening_per_length, self.falling_stress) if len(half) else half
        )
        return bool((stress > _DRAWN * self.strength).any())


def figures_of(specimen: Specimen, offset: float = 0.002) -> Figures:
    """Return the figures of a curve; the film yields at a plastic strain of ``offset`` [-]."""
    said: list[str] = []
    strain, stress = specimen.strain, specimen.stress
    peak = _peak(stress)
    young, error, slack = _elastic_line(strain[: peak + 1], stress[: peak + 1], said)
    strain = strain - slack
    strength = float(stress.max())
    at_yield = _yield(strain, stress, young, offset)
    if at_yield is None:
        said.append(f"it parts before a plastic strain of {100 * offset:g} %: no yield stress")
    plastic, true = _hardening(strain[: peak + 1], stress[: peak + 1], young, at_yield, said)
    held = np.flatnonzero(stress >= BROKEN * strength)
    opening, falling = _fall(strain[peak:], stress[peak:], young, specimen.broken, said)
    if not specimen.broken:
        said.append(
            f"the record ends at {stress[-1]:.3g} MPa, {stress[-1] / strength:.0%} of the "
            "strength, before the break: strain at break unknown"
        )
    return Figures(
        specimen,
        young=young,
        young_error=error,
        slack=slack,
        yield_stress=np.nan if at_yield is None else at_yield[1],
        strength=strength,
        strain_at_strength=float(strain[peak]),
        strain_at_break=float(strain[held[-1]]) if specimen.broken else np.nan,
        plastic_strain=plastic,
        true_stress=true,
        opening_per_length=opening,
        falling_stress=falling,
        sentences=said,
    )


def _peak(stress: Floats) -> int:
    # The last point that differs from the largest by no more than noise: of a flat top the end,
    # because there the fall begins. Noise from second differences, which do not see the curve.
    noise = 1.4826 * float(np.median(np.abs(np.diff(stress, 2)))) / 6.0**0.5
    return int(np.flatnonzero(stress >= stress.max() - _NOISE * noise)[-1])


class _Line(NamedTuple):
    slope: float
    """[MPa]"""
    zero: float
    """Strain without stress [-]."""
    error: float
    """Standard error of the slope [MPa]; NaN for a secant."""
    low: float
    high: float
    """Range of strain [-]."""
    n: int
    """Points in it."""

    def steeper_than(self, other: _Line, by: float) -> bool:
        """Return whether the slope is that many times the other's, beyond noise."""
        noise = np.nan_to_num([self.error, other.error])
        apart = self.slope - other.slope > 3.0 * float(np.hypot(*noise))
        return apart and self.slope > by * other.slope


def _elastic_line(strain: Floats, stress: Floats, said: list[str]) -> tuple[float, float, float]:
    # slope, its standard error, strain at zero stress
    strength = stress[-1]
    risen = int(np.argmax(stress >= _RISEN * strength))
    below = np.flatnonzero(stress[: risen + 1] < _SLACK * strength)
    zero = float(strain[below[-1]]) if len(below) else float(strain[0])
    least = float(strain[0]) - ELASTIC[0]  # the range begins within the record
    line = None
    for turn in range(_TURNS):
        line = _within(strain, stress, zero)
        if line is None:
            break
        found = max(line.zero, least)
        if abs(found - zero) < 1e-12:
            break
        # halfway where a range gains and loses the same points in turn
        zero = found if turn < _TURNS // 2 else 0.5 * (zero + found)
    if line is None:
        line = _first_points(strain, stress, zero, said)
    else:
        _say_range(strain, stress, line, said)
    foot = line
    while above := _within(strain, stress, line.high - ELASTIC[0]):
        if above.high > strain[risen] or not above.steeper_than(line, _STEEPER):
            break
        line = above
    if line is not foot:
        said.append(
            f"the curve gets steeper up to a strain of {100 * line.low:.2g} %, a foot: modulus "
            f"from there to {100 * line.high:.2g} %"
        )
    if not line.slope > 0.0:
        raise ValueError(
            "the stress must rise with the strain in the elastic range, got a modulus of "
            f"{line.slope:.3g} MPa; does the record start before the test?"
        )
    if line.error > _LOOSE * line.slope:
        told = line.error / line.slope
        said.append(f"the modulus is uncertain by {told:.0%}: noise, or too few points")
    return line.slope, line.error, line.zero


def _within(strain: Floats, stress: Floats, zero: float) -> _Line | None:
    # the line of the elastic range counted from a zero; None where the record has no such range
    low, high = zero + ELASTIC[0], min(zero + ELASTIC[1], float(strain[-1]))
    if strain[0] > low + 1e-12 or not low < high:
        return None
    line = _regression(strain, stress, low, high)
    if line.n < _FEW and high < zero + ELASTIC[1] - 1e-12:
        return None
    while line.n >= 2 * _FEW:
        lower, upper = _halves(strain, stress, line)
        if not lower.steeper_than(upper, 1.0 / _YIELDS):
            break
        line = _regression(strain, stress, low, 0.5 * (line.low + line.high))
    return line


def _regression(strain: Floats, stress: Floats, low: float, high: float) -> _Line:
    # or the secant of a range with few points (ISO 527-1 allows both)
    inside = (strain >= low - 1e-12) & (strain <= high + 1e-12)
    n = int(inside.sum())
    if n >= _FEW:
        slope, level, _, _, error = scipy.stats.linregress(strain[inside], stress[inside])
    else:
        ends = np.array([low, high])
        slope, level, *_ = scipy.stats.linregress(ends, np.interp(ends, strain, stress))
        error = float("nan")
    zero = -level / slope if slope > 0.0 else low - ELASTIC[0]
    return _Line(slope, zero, error, low, high, n)


def _halves(strain: Floats, stress: Floats, line: _Line) -> tuple[_Line, _Line]:
    middle = 0.5 * (line.low + line.high)
    return (
        _regression(strain, stress, line.low, middle),
        _regression(strain, stress, middle, line.high),
    )


def _first_points(strain: Floats, stress: Floats, zero: float, said: list[str]) -> _Line:
    first = max(0, min(int(np.searchsorted(strain, zero)), len(strain) - _FEW))
    x, y = strain[first:][:_FEW], stress[first:][:_FEW]
    slope, level, _, _, error = scipy.stats.linregress(x, y)
    said.append(
        f"the record does not span strains of {100 * ELASTIC[0]:g} to {100 * ELASTIC[1]:g} %: "
        f"modulus from its first {len(x)} points, up to {100 * float(x[-1] - zero):.2g} %"
    )
    return _Line(slope, -level / slope if slope else zero, error, float(x[0]), float(x[-1]), len(x))


def _say_range(strain: Floats, stress: Floats, line: _Line, said: list[str]) -> None:
    span = f"strains of {100 * ELASTIC[0]:g} and {100 * ELASTIC[1]:g} %"
    if line.n < _FEW:
        said.append(
            f"only {line.n} points between {span} ({_FEW} are needed): modulus from the secant of "
            "interpolated stresses; it may be too low"
        )
    elif line.high - line.low < 0.99 * (ELASTIC[1] - ELASTIC[0]):
        why = "the film yields" if line.high < strain[-1] else "the curve ends"
        said.append(
            f"{why} between {span}: modulus from the part up to "
            f"{100 * (line.high - line.zero):.2g} %, not that of ISO 527"
        )
    elif line.n >= 2 * _FEW:
        lower, upper = _halves(strain, stress, line)
        if lower.steeper_than(upper, 1.0 / _BENT):
            said.append(
                f"the curve bends between {span}: {lower.slope:.4g} MPa in the lower half, "
                f"{upper.slope:.4g} MPa in the upper"
            )


def _yield(
    strain: Floats, stress: Floats, young: float, offset: float
) -> tuple[float, float] | None:
    # strain and stress where the curve comes below the moved line for two points or for good
    above = stress - young * (strain - offset)
    under = (above <= 0.0) & (strain > offset)
    under &= np.append(under[1:], True)
    if not under.any():
        return None
    k = int(np.argmax(under))
    if k == 0:
        return float(strain[0]), float(stress[0])
    share = above[k - 1] / (above[k - 1] - above[k])
    return tuple(float(c[k - 1] + share * (c[k] - c[k - 1])) for c in (strain, stress))  # type: ignore[return-value]


def _hardening(
    strain: Floats,
    stress: Floats,
    young: float,
    at_yield: tuple[float, float] | None,
    said: list[str],
) -> tuple[Floats, Floats]:
    # true stress over logarithmic plastic strain up to the strength, where necking may begin
    nothing = np.zeros(0)
    if at_yield is None:
        return nothing, nothing
    beyond = strain >= at_yield[0]
    true = stress[beyond] * (1.0 + strain[beyond])
    plastic = np.log1p(strain[beyond]) - true / young
    n_row = min(_MOST_ROWS, len(true) // _MEAN_OF)
    if n_row < 2:
        said.append(
            f"only {len(true)} points between yield and strength ({2 * _MEAN_OF} are needed): no "
            "hardening curve"
        )
        return nothing, nothing
    rows = np.array_split(np.arange(len(true)), n_row)
    x = np.array([plastic[row].mean() for row in rows])
    y = np.array([true[row].mean() for row in rows])
    # the first row is that of no plastic strain, by the line through the first quarter
    quarter = slice(0, max(len(true) // 4, _MEAN_OF))
    slope, level, *_ = scipy.stats.linregress(plastic[quarter], true[quarter])
    x, y = np.append(0.0, x), np.append(min(level, y[0]) if slope > 0.0 else y[0], y)
    kept = np.append(True, np.diff(np.maximum.accumulate(x)) > 0.0)
    return x[kept], np.maximum.accumulate(y[kept])


def _fall(
    strain: Floats, stress: Floats, young: float, broken: bool, said: list[str]
) -> tuple[Floats, Floats]:
    nothing = np.zeros(0)
    strength, last = float(stress[0]), float(stress[-1])
    if len(stress) < 3 or (last > _FALLEN * strength and not broken):
        bound = f", at most {strength**2 / 2.0 / young:.3g} N/mm² times the gauge length" * broken
        said.append(
            "no fall after the strength is recorded: this test says nothing about the fracture "
            f"energy{bound}"
        )
        return nothing, nothing
    opening = (strain - strain[0]) + (strength - stress) / young
    if broken:  # the last part is too fast for the machine: the film is let go
        opening = np.append(opening, strain[-1] - strain[0] + strength / young)
        stress = np.append(stress, 0.0)
        if last > _TORN * strength:
            said.append(
                f"it broke at once from {last / strength:.0%} of the strength: what the rest of "
                "the gauge length gave back then is counted as fracture energy, an upper bound"
            )
    # noise may make a rise of the stress faster than the strain
    return np.maximum.accumulate(opening), stress
