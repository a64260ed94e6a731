"""The difference between measured curves and runs, as a vector for least squares.

For each curve, with m_i measured, s_i simulated and averaged over whole node periods, and w_i the
weights of the trapezoidal rule on the common range [a, b],

    r_i = sqrt(w_i / (b - a)) (s_i - m_i) / max |m|,

so that r·r is the mean square difference relative to the peak, whatever the number of points, and
every curve counts alike. The torque of a cut is a sawtooth with the spacing of the nodes, which no
measured curve has: both are averaged over two spacings, where a straight line stays as it is.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.arrays import Floats
from shellcut.formats.errors import naming
from shellcut.numerics.broken_line import BrokenLine
from shellcut.recording.resistance import AnyResistance
from shellcut.results.comparison import Comparison, compare, in_units, shares
from shellcut.results.measured_curve import MeasuredCurve, read_measured_curve
from shellcut.results.run_results import read

_PERIODS = 2.0
"""Node spacings over which the simulated curve is averaged."""

_FEWEST = 5
"""Points at which curves must be compared."""

_MARGIN = 0.01
"""Of the compared range, left out at both ends: more than the way of a row of the history."""

_LARGEST_WINDOW = 0.2
"""Of the measured range: wider, little would be left of the curve."""


@dataclass(frozen=True)
class FitCurve:
    """A measured curve, and the run that it belongs to.

    Examples
    --------
    >>> fast = FitCurve("fast.csv", settings={"motion.duration": 3e-3})
    >>> fast.y is None  # the torque or force of the run
    True
    """

    measured: str | Path | MeasuredCurve
    """Table of numbers, or the curve."""
    x: str | None = None
    """Column of the run's history; by default its coordinate."""
    y: str | None = None
    """The same for the value; by default its torque or force."""
    columns: tuple[str | int | None, str | int | None] | None = None
    """Columns of the file by heading or number, if they have other names."""
    units: str | None = None
    """Of the file's columns, as ``"deg, N*mm"``; by default those of its headings."""
    settings: Mapping[str, object] = field(default_factory=dict)
    """Keys that this experiment had otherwise, such as another speed."""


def read_curves(curves: Sequence[FitCurve], of_run: AnyResistance) -> tuple[FitCurve, ...]:
    """Return the curves with their files read, in units that fit a run with this resistance."""
    x, y = (of_run.coordinate_name, of_run.coordinate_unit), of_run.columns[0]
    found, problems = [], []
    for curve in curves:
        measured, columns = curve.measured, curve.columns or (None, None)
        names = curve.x or x[0], curve.y or y[0]
        try:
            if not isinstance(measured, MeasuredCurve):
                measured = read_measured_curve(
                    measured, *columns, units=curve.units, expected=names
                )
            if names == (x[0], y[0]):  # others are columns of the history
                with naming(str("the curve" if measured is curve.measured else curve.measured)):
                    in_units(measured, x, y)
            found.append(replace(curve, measured=measured))
        except (ValueError, OSError) as problem:
            problems.append(str(problem))
    if problems:
        raise ValueError("\n".join(dict.fromkeys(problems)))
    return tuple(found)


def window_of(folder: Path, figures: Mapping[str, Any], curve: FitCurve) -> float:
    """Return the width over which to average a run's curve, in the unit of its coordinate.

    Two node spacings: a side of a quad along the cut, as the coordinate of the motion.
    """
    results = read(folder)
    x = results.history[curve.x or results.coordinate_name]
    n_tooth = sum("_tooth_" in column for column in results.history)
    per_tooth = figures.get("crack_length_mm", 0.0) / max(n_tooth, 1)
    edge = figures.get("edge_length_mm", 0.0)
    across = float(x.max() - x.min())
    if not per_tooth > 0.0 or not edge > 0.0:
        return 0.0
    return float(min(_PERIODS * edge * across / per_tooth, _LARGEST_WINDOW * across))


def compared(
    folder: Path, curve: FitCurve, window: float, points: Floats | None = None
) -> Comparison:
    """Compare the run in a folder with its measured curve, both averaged over windows of a width.

    The coordinates are ``points`` of an earlier comparison, which the run must reach; by default
    those at which both windows lie within their curves, a hundredth of the range away from the
    ends: where a run ends depends on the length of its steps. Raises ValueError if columns, units
    or ranges do not fit.
    """
    found = compare(folder, curve.measured, x=curve.x, y=curve.y, window=window or None)
    (m, _), (s, _) = found.measured_curve, found.simulated_curve
    low, high = max(m[0], s[0]) + 0.5 * window, min(m[-1], s[-1]) - 0.5 * window
    inside = (found.x >= low) & (found.x <= high)
    if points is not None:
        inside &= np.isin(found.x, points)
        if inside.sum() < len(points):
            raise ValueError(
                f"the run must reach from {points[0]:.4g} to {points[-1]:.4g} {found.x_unit} to be "
                f"compared, with half a window of {window:.3g} at both ends, but its curve "
                f"reaches from {s[0]:.4g} to {s[-1]:.4g}"
            )
    else:
        margin = _MARGIN * (high - low)
        inside &= (found.x >= low + margin) & (found.x <= high - margin)
    if inside.sum() < _FEWEST:
        raise ValueError(
            f"the measured curve must have {_FEWEST} points or more where it is compared, from "
            f"{low:.4g} to {high:.4g} {found.x_unit}, got {inside.sum()}"
        )
    averaged = BrokenLine(*found.measured_curve).mean_at(found.x, window)
    return replace(
        found,
        x=found.x[inside],
        measured=averaged[inside],
        simulated=found.simulated[inside],
    )


def residuals(comparisons: Sequence[Comparison]) -> Floats:
    """Return r of all curves, one after the other, shape (n_point,)."""
    return np.concatenate([_weights(one) * (one.simulated - one.measured) for one in comparisons])


def nothing_simulated(comparisons: Sequence[Comparison]) -> Floats:
    """Return r of runs that failed: as if they had no force at all, and twice that."""
    return np.concatenate([-2.0 * _weights(one) * one.measured for one in comparisons])


def _weights(one: Comparison) -> Floats:
    return np.asarray(np.sqrt(shares(one.x)) / np.abs(one.measured).max())


def correlations(one: Comparison) -> Floats:
    """Return how alike the misses of two points of a curve are that lie k apart, shape (n_point,).

    They fall linearly with k. Averages over windows that overlap are alike by their common part,
    whatever the noise. Where the miss is the model's it is alike farther: over 1 + 2 sum c_k
    points, c_k the correlations found, in the sum pairs of neighbouring k as long as they are
    positive ([Geyer1992]).
    """
    miss = one.simulated - one.measured
    miss = miss - miss.mean()
    n = len(miss)
    spectrum = np.abs(np.fft.rfft(miss, 2 * n)) ** 2  # padded: its end is not its beginning
    c = np.fft.irfft(spectrum)[:n]
    pairs = c[: n - n % 2].reshape(-1, 2).sum(axis=1)
    stop = int(np.argmin(np.append(pairs, -1.0) > 0.0))
    found = 2.0 * pairs[:stop].sum() / c[0] - 1.0 if c[0] > 0.0 else 1.0
    spacing = (one.x[-1] - one.x[0]) / (n - 1)
    over = max(1.0, found, (one.window or 0.0) / spacing)
    return np.asarray(np.maximum(1.0 - np.arange(n) / over, 0.0))
