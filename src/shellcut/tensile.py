"""What a tensile test says of a film: modulus, yield stress, strength and hardening table.

*Modulus* (ISO 527-1): slope of the regression line between strains of 0.05 and 0.25 %, counted from
the line's own zero, so that slack and preload do not count. *Yield*: where the curve meets this
line moved by an offset of strain. *Hardening*: true stress s (1 + e) over the plastic part of the
logarithmic strain, ln(1 + e) - s (1 + e) / E, from yield up to the largest stress, at constant
volume. Beyond the largest stress the strain is not uniform, and a tensile curve says nothing.
"""

from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import scipy

from .arrays import ArrayLike, Floats
from .material.hardening import fewer_points
from .view.curves import Curve, Diagram, draw_curves

ELASTIC = (0.0005, 0.0025)
"""Strains between which the modulus is measured, from the line's own zero (ISO 527-1)."""

_FEW = 5  # points of a line; with fewer, the secant of interpolated stresses
_MOST_TURNS = 60  # of the search for the line whose zero its own range is counted from
_BENT = 1.1  # slope of one half of the range over that of the other: said
_MEAN_OF, _MOST_ROWS = 4, 40  # points averaged into a row of the hardening curve, and rows


@dataclass(frozen=True, eq=False)
class TensileTest:
    """Values of one curve; NaN and empty arrays where the film parts before it yields.

    Examples
    --------
    >>> strain = np.linspace(0.0, 0.005, 11)
    >>> print(evaluate_tensile(strain, 2000.0 * strain).section().splitlines()[-1])
    young = 2000
    """

    young: float
    """[MPa]"""
    slack: float
    """Strain at which the elastic line starts [-]; ``strain`` and what follows leave it out."""
    yield_stress: float
    """Nominal, at the offset [MPa]."""
    strength: float
    """Largest nominal stress [MPa]."""
    strain_at_strength: float
    plastic_strain: Floats
    """Logarithmic, from yield up to the strength, the first 0, shape (n,)."""
    true_stress: Floats
    """At each plastic strain [MPa], shape (n,)."""
    strain: Floats
    """The curve, without slack, shape (m,)."""
    stress: Floats
    """Nominal [MPa], shape (m,)."""
    notes: tuple[str, ...]
    """What to know before the values are used."""

    def __str__(self) -> str:
        """Return the values as lines, and the notes."""
        lines = [
            f"Young's modulus     {self.young:.4g} MPa",
            f"yield stress        {self.yield_stress:.4g} MPa",
            f"strength            {self.strength:.4g} MPa",
            f"strain at strength  {100.0 * self.strain_at_strength:.4g} %",
        ]
        return "\n".join([*lines, *(f"- {note}" for note in self.notes)])

    def section(self) -> str:
        """Return ``[material]`` of a model file: modulus, and a hardening table if it yields."""
        lines = [
            "# poisson, density and thickness do not follow from a tensile test: give them.",
            "[material]",
            f"young = {self.young:.6g}",
        ]
        if len(self.plastic_strain):
            strain, stress = fewer_points(self.plastic_strain, self.true_stress)
            lines += [
                "# Beyond the last strain the yield stress stays constant.",
                "",
                "[material.hardening]",
                'kind = "table"',
                f"plastic_strain = [{', '.join(f'{x:.6g}' for x in strain)}]",
                f"stress = [{', '.join(f'{x:.6g}' for x in stress)}]",
            ]
        return "\n".join([*lines, ""])

    def plot(self, path: str | os.PathLike[str], across: TensileTest | None = None) -> Path:
        """Draw the curve, its elastic line and the hardening table; ImportError if no Matplotlib.

        path : of a .png, .svg or .pdf file. across : the test in the other direction of the film.
        """
        tests = {"test": self} if across is None else {"along": self, "across": across}
        curves, tables = list[Curve](), list[Curve]()
        for k, (name, one) in enumerate(tests.items()):
            line = np.array([0.0, 1.2 * one.strength / one.young])
            said = f"{name}, E = {one.young:.4g} MPa"
            curves.append(Curve(said, one.stress, f"law{5 * k}", x=100.0 * one.strain))
            curves.append(Curve(said, one.young * line, f"c{5 * k}", x=100.0 * line))
            if len(one.plastic_strain):
                x = 100.0 * one.plastic_strain
                tables.append(Curve(name, one.true_stress, f"law{5 * k}", x=x))
        diagrams = [
            Diagram([], curves, "strain", "%", "nominal stress", "MPa"),
            Diagram(
                [], tables, "logarithmic plastic strain", "%", "true stress", "MPa", "hardening"
            ),
        ]
        drawn = diagrams if tables else diagrams[:1]
        draw_curves(path, drawn, columns=len(drawn), size=(5.5 * len(drawn), 4.5))
        return Path(path)


def evaluate_tensile(
    strain: ArrayLike,
    stress: ArrayLike,
    *,
    gauge_length: float | None = None,
    section: float | None = None,
    offset: float = 0.002,
) -> TensileTest:
    """Evaluate the curve of a tensile test.

    Parameters
    ----------
    strain : array_like, shape (n,)
        Nominal [-]; or the extension [mm], with ``gauge_length``. It increases.
    stress : array_like, shape (n,)
        Nominal, force over undeformed section [MPa]; or the force [N], with ``section``.
    gauge_length : float, optional
        Length over which the extension was measured [mm].
    section : float, optional
        Width times thickness of the undeformed specimen [mm²].
    offset : float
        Plastic strain at which the film counts as yielding [-].

    Returns
    -------
    TensileTest

    Raises
    ------
    ValueError
        For arrays of other shapes, fewer than five points up to the largest stress, numbers that
        are not finite, strains that do not increase, stresses that are not above 0, and a record
        without elastic range.

    Examples
    --------
    >>> strain = np.linspace(0.0, 0.4, 801)
    >>> stress = np.minimum(2000.0 * strain, 16.0 + 20.0 * (strain - 0.008))
    >>> test = evaluate_tensile(strain, stress)
    >>> round(test.young), round(test.yield_stress, 2), round(test.strength, 2)
    (2000, 16.04, 23.84)
    """
    x, y = _curve(strain, stress, gauge_length, section, offset)
    peak = int(np.argmax(y))
    notes: list[str] = []
    young, slack = _elastic_line(x[: peak + 1], y[: peak + 1], notes)
    x = x - slack
    rising, loaded = x[: peak + 1], y[: peak + 1]
    start = _yield(rising, loaded, young, offset)
    yield_stress, plastic, true = float("nan"), np.zeros(0), np.zeros(0)
    if start is None and _yield(x, y, young, offset) is None:
        notes.append(f"the film tears before a plastic strain of {100.0 * offset:g} %: no yield")
    elif start is None:
        notes.append(
            "the stress falls from the yield point on, as where a film necks: the hardening that "
            "follows is not known, so the yield stress stays constant"
        )
        yield_stress = float(y[peak])
        plastic, true = np.array([0.0, offset]), y[[peak, peak]] * (1.0 + x[peak])
    else:
        yield_stress = float(start[1])
        plastic, true = _hardening(rising, loaded, young, float(start[0]))
    return TensileTest(
        young=young,
        slack=slack,
        yield_stress=yield_stress,
        strength=float(y[peak]),
        strain_at_strength=float(x[peak]),
        plastic_strain=plastic,
        true_stress=true,
        strain=x,
        stress=y,
        notes=tuple(notes),
    )


def _curve(
    strain: ArrayLike,
    stress: ArrayLike,
    gauge_length: float | None,
    section: float | None,
    offset: float,
) -> tuple[Floats, Floats]:
    """Return strain [-] and nominal stress [MPa]; ValueError names all that is wrong."""
    x, y = np.array(strain, np.float64), np.array(stress, np.float64)
    if x.ndim != 1 or x.shape != y.shape:
        raise ValueError(f"strain and stress must be equally long, got {x.shape} and {y.shape}")
    problems = [
        f"{name} must be above 0, got {value!r}"
        for name, value in (("gauge_length", gauge_length), ("section", section))
        if value is not None and not 0.0 < value < np.inf
    ]
    if not 0.0 < offset < 1.0:
        problems.append(f"offset must be a strain between 0 and 1, got {offset!r}")
    problems += [
        f"{name} must be numbers, got {values[k]} in row {k + 1}"
        for name, values in (("strains", x), ("stresses", y))
        for k in np.flatnonzero(~np.isfinite(values))[:1].tolist()
    ]
    problems += [
        f"strains must not fall, got {x[k]:g} and {x[k + 1]:g} in row {k + 2}"
        for k in np.flatnonzero(np.diff(x) < 0.0)[:1].tolist()
    ]
    if not problems and (len(y) < _FEW or np.argmax(y) + 1 < _FEW or y.max() <= 0.0):
        problems.append(f"stresses must rise above 0 over at least {_FEW} rows")
    if problems:
        raise ValueError("; ".join(problems))
    return x / (gauge_length or 1.0), y / (section or 1.0)


def _elastic_line(strain: Floats, stress: Floats, notes: list[str]) -> tuple[float, float]:
    """Return slope [MPa] and zero [-] of the line of ISO 527-1."""
    # The first guess of the zero: where a fiftieth of the strength is reached.
    zero = float(np.interp(0.02 * stress[-1], np.maximum.accumulate(stress), strain))
    for _ in range(_MOST_TURNS):
        low, high = zero + ELASTIC[0], zero + ELASTIC[1]
        if strain[-1] < low + 0.5 * (high - low):
            raise ValueError(
                f"the record must span strains from 0.05 to 0.25 % above {100 * zero:.3g} %, where "
                f"the line begins, got the largest stress at {100 * strain[-1]:.3g} %"
            )
        slope, level, error, n = _line(strain, stress, low, high)
        if not slope > 0.0:
            raise ValueError(f"the stress must rise with the strain, got a slope of {slope:g} MPa")
        # The range of a record that begins under load begins with it.
        found = max(-level / slope, float(strain[0]) - ELASTIC[0])
        if abs(found - zero) < 1e-12:
            break
        zero = 0.5 * (zero + found)  # half-way: a range may gain and lose the same points in turn
    middle = 0.5 * (low + high)
    lower, upper = (_line(strain, stress, *part)[0] for part in ((low, middle), (middle, high)))
    noise = 3.0 * 8.0**0.5 * error  # of a line over half of the points and half of the range
    if n < _FEW:
        notes.append(
            f"{n} points in the elastic range, {_FEW} make a line: the modulus is a secant"
        )
    elif not upper < _BENT * lower < _BENT**2 * upper and abs(lower - upper) > noise:
        notes.append(
            f"the curve bends in the elastic range: {lower:.4g} MPa in its lower half, "
            f"{upper:.4g} MPa in its upper half"
        )
    return slope, -level / slope


def _line(
    strain: Floats, stress: Floats, low: float, high: float
) -> tuple[float, float, float, int]:
    """Return slope, level, standard error of the slope, and number of points of a range."""
    inside = (strain >= low - 1e-12) & (strain <= high + 1e-12)
    n = int(inside.sum())
    if n >= _FEW:
        line = scipy.stats.linregress(strain[inside], stress[inside])
        return float(line.slope), float(line.intercept), float(line.stderr), n
    first, last = np.interp([low, high], strain, stress)
    slope = float(last - first) / (high - low)
    return slope, float(first) - slope * low, float("nan"), n


def _yield(strain: Floats, stress: Floats, young: float, offset: float) -> Floats | None:
    """Return strain and stress where the curve falls below the moved line, for two points."""
    above = stress - young * (strain - offset)
    under = (above <= 0.0) & (strain > offset)
    under &= np.append(under[1:], True)
    if not under.any():
        return None
    k = int(np.argmax(under))
    share = above[k - 1] / (above[k - 1] - above[k]) if k else 1.0
    before, at = np.array([strain, stress])[:, [max(k - 1, 0), k]].T
    return np.asarray(before + share * (at - before))


def _hardening(strain: Floats, stress: Floats, young: float, first: float) -> tuple[Floats, Floats]:
    """Return plastic strain and true stress [MPa] from a strain on; empty with too few points."""
    beyond = strain >= first
    true = stress[beyond] * (1.0 + strain[beyond])
    plastic = np.log1p(strain[beyond]) - true / young
    n_row = min(_MOST_ROWS, len(true) // _MEAN_OF)
    if n_row < 2:
        return np.zeros(0), np.zeros(0)
    rows = np.array_split(np.arange(len(true)), n_row)
    x = np.array([plastic[row].mean() for row in rows])
    y = np.array([true[row].mean() for row in rows])
    # The table begins at no plastic strain: the line through the first quarter is used there.
    quarter = slice(0, max(len(true) // 4, _MEAN_OF))
    line = scipy.stats.linregress(plastic[quarter], true[quarter])
    start = min(line.intercept, y[0]) if line.slope > 0.0 else y[0]
    x, y = np.append(0.0, x), np.append(start, y)
    kept = np.append(True, np.diff(np.maximum.accumulate(x)) > 0.0)
    return x[kept], np.maximum.accumulate(y[kept])
