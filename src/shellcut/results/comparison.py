"""Comparison of a run with a measured curve: its figures, defined in docs/howto/compare.md.

Both curves are piecewise linear, m(x) through the measured points and s(x) through the rows of the
history. A ``window`` replaces s(x) by its mean over [x - h, x + h], with h half the window or the
distance to the nearer end of the history if that is less: a straight line stays the same, and the
work is that of the unsmoothed curve.
"""

from __future__ import annotations

import json
import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.arrays import Floats
from shellcut.files.whole_file import write_text
from shellcut.numerics.broken_line import BrokenLine
from shellcut.unit import conversion, dimension
from shellcut.unit import with_unit as said
from shellcut.view import Curve, Diagram, draw_curves

from .comparison_table import table_of
from .measured_curve import MeasuredCurve, read_measured_curve
from .run_results import Results, read

_SAME_END = 0.01
"""Relative to the common range: ends of two curves that lie closer together need no note."""
_FEW_POINTS = 10


@dataclass(frozen=True, eq=False)
class Comparison:
    """A run and a measured curve on their common range; built by :func:`compare`.

    Relative figures are fractions; they are nan if their reference is zero.

    Examples
    --------
    >>> import shellcut
    >>> found = shellcut.compare("out", "measured.csv", window=3.0)  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    >>> found.to_json("comparison.json"), found.plot("comparison.png")  # doctest: +SKIP
    """

    name: str
    """Name of the run."""
    x_name: str
    x_unit: str
    y_name: str
    y_unit: str
    x: Floats
    """Points of the comparison, shape (n,), [x_unit]."""
    measured: Floats
    """Measured curve there, shape (n,), [y_unit]."""
    simulated: Floats
    """Simulated curve there, averaged over the window, shape (n,), [y_unit]."""
    measured_curve: tuple[Floats, Floats]
    """All measured points, also outside the common range [x_unit], [y_unit]."""
    simulated_curve: tuple[Floats, Floats]
    """The same for the simulated curve, averaged over the window."""
    window: float | None
    """Width of the mean over the simulated curve [x_unit]."""
    rms: float
    """Root-mean-square difference [y_unit]."""
    rms_relative: float
    """``rms`` over the measured peak [-]."""
    peak_measured: float
    """[y_unit]."""
    peak_simulated: float
    """[y_unit]."""
    peak_error: float
    """[-]."""
    peak_at_measured: float
    """[x_unit]."""
    peak_at_simulated: float
    """[x_unit]."""
    work_measured: float
    """[work_unit]."""
    work_simulated: float
    """[work_unit]."""
    work_error: float
    """[-]."""
    work_unit: str
    """N*mm for a torque over an angle or a force over a path, else the product of both units."""
    correlation: float
    """[-], from -1 to 1."""
    steady_range: tuple[float, float] | None
    """Part of the common range with steady cutting [x_unit], None if there is none."""
    mean_measured: float
    """Over that part, nan without it [y_unit]."""
    mean_simulated: float
    """[y_unit]."""
    mean_error: float
    """[-]."""
    pierced_at: float
    """Where a cutting edge first pierces whole film, nan outside the common range [x_unit]."""
    pierced_measured: float
    """[y_unit]."""
    pierced_simulated: float
    """[y_unit]."""
    notes: tuple[str, ...]
    """Notes for the reader, such as ranges that overlap only partly."""

    @property
    def range(self) -> tuple[float, float]:
        """Ends of the common range [x_unit]."""
        return float(self.x[0]), float(self.x[-1])

    def __str__(self) -> str:
        """Return a small table."""
        return table_of(self)

    def to_json(self, path: str | os.PathLike[str]) -> Path:
        """Write the figures, each as ``{"value", "unit"}``, and both curves; return the path.

        Values that are not finite are written as null.
        """
        x, y, work = self.x_unit, self.y_unit, self.work_unit
        figures = {
            "rms": (self.rms, y),
            "rms_relative": (self.rms_relative, "-"),
            "peak_measured": (self.peak_measured, y),
            "peak_simulated": (self.peak_simulated, y),
            "peak_error": (self.peak_error, "-"),
            "peak_at_measured": (self.peak_at_measured, x),
            "peak_at_simulated": (self.peak_at_simulated, x),
            "work_measured": (self.work_measured, work),
            "work_simulated": (self.work_simulated, work),
            "work_error": (self.work_error, "-"),
            "correlation": (self.correlation, "-"),
            "mean_measured": (self.mean_measured, y),
            "mean_simulated": (self.mean_simulated, y),
            "mean_error": (self.mean_error, "-"),
            "pierced_at": (self.pierced_at, x),
            "pierced_measured": (self.pierced_measured, y),
            "pierced_simulated": (self.pierced_simulated, y),
        }
        content: dict[str, Any] = {
            "run": self.name,
            "x": {"name": self.x_name, "unit": x},
            "y": {"name": self.y_name, "unit": y},
            "range": list(self.range),
            "measured_range": self.measured_curve[0][[0, -1]].tolist(),
            "simulated_range": self.simulated_curve[0][[0, -1]].tolist(),
            "window": self.window,
            "steady_range": self.steady_range,
            "n_point": len(self.x),
            "figures": {
                name: {"value": finite(value), "unit": unit}
                for name, (value, unit) in figures.items()
            },
            "notes": list(self.notes),
            "curves": {
                "x": self.x.tolist(),
                "measured": self.measured.tolist(),
                "simulated": self.simulated.tolist(),
            },
        }
        path = Path(path)
        write_text(path, json.dumps(content, indent=1) + "\n")
        return path

    def plot(self, path: str | os.PathLike[str]) -> Path:
        """Draw both curves with their difference below; return the path.

        Raises
        ------
        ImportError
            If Matplotlib is not installed.
        """
        path = Path(path)

        def peak(value: float, at: float) -> str:
            return f"peak {said(value, self.y_unit)} at {said(at, self.x_unit)}"

        (x, measured), (own, simulated) = self.measured_curve, self.simulated_curve
        peaks = (
            f"measured, {peak(self.peak_measured, self.peak_at_measured)}",
            f"simulated, {peak(self.peak_simulated, self.peak_at_simulated)}",
        )
        both = [Curve(peaks[0], measured, "measured", x=x), Curve(peaks[1], simulated, x=own)]
        gap = [Curve("difference", self.simulated - self.measured, "contact")]
        x_axis = self.x_name, self.x_unit
        upper = Diagram(
            self.x, both, *x_axis, self.y_name, self.y_unit, title=self.name, height=3.0
        )
        lower = Diagram(self.x, gap, *x_axis, "difference", self.y_unit)
        draw_curves(path, [upper, lower], size=(9.0, 6.0))
        return path


def finite(value: Any) -> Any:
    """Return what JSON can express: numbers that are not finite as None, in dicts and lists too."""
    if isinstance(value, float) and not np.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: finite(one) for key, one in value.items()}
    return [finite(one) for one in value] if isinstance(value, list) else value


def compare(
    run: str | os.PathLike[str] | Results,
    measured: str | os.PathLike[str] | MeasuredCurve,
    *,
    x: str | None = None,
    y: str | None = None,
    columns: tuple[str | int | None, str | int | None] | None = None,
    units: str | Sequence[str] | None = None,
    window: float | None = None,
) -> Comparison:
    """Compare a run with a measured curve on the range that both cover.

    Parameters
    ----------
    run : path or Results
        The folder of a run, or the result of :func:`shellcut.read`.
    measured : path or MeasuredCurve
        A table readable by :func:`read_measured_curve`, or the curve itself.
    x, y : str, optional
        Columns of the run's history; by default its coordinate (angle or path) and its resistance
        (torque or force).
    columns : (str or int, str or int), optional
        The file's columns for ``x`` and ``y``, by heading or by number from 1; by default those
        with the same names, or the only two columns.
    units : str or (str, str), optional
        Units of the file's columns, as ``"deg, N*mm"``; by default those in its headings.
    window : float, optional
        Width over which the simulated curve is averaged, in the unit of ``x``. Twice the node
        spacing along the cut removes the sawtooth.

    Raises
    ------
    ValueError
        Lists what is wrong with columns, units and ranges; a curve that shares no range with the
        run is refused.

    Examples
    --------
    >>> import shellcut
    >>> found = shellcut.compare("out", "measured.csv")  # doctest: +SKIP
    >>> found.peak_error, found.rms, found.y_unit  # doctest: +SKIP
    (0.042, 6.1, 'N*mm')
    """
    results = run if isinstance(run, Results) else read(run)
    if not results.history:
        raise ValueError(f"{results.folder} must contain the run's history.csv, but does not")
    x, y = _columns_in_history(results, x, y)
    if window is not None and not (np.isfinite(window) and window > 0.0):
        raise ValueError(f"window must be a width above 0 {results.units[x]}, got {window!r}")
    if not isinstance(measured, MeasuredCurve):
        x_column, y_column = columns or (None, None)
        measured = read_measured_curve(
            Path(measured), x_column, y_column, units=units, expected=(x, y)
        )
    x_unit, y_unit = results.units[x], results.units[y]
    m = in_units(measured, (x, x_unit), (y, y_unit))
    s = _increasing(x, results.history[x], results.history[y])
    a, b = _common_range(m, s, x, x_unit)
    if window is not None and window > b - a:
        raise ValueError(
            f"window must be less than the common range, {b - a:.4g} {x_unit}, got {window:g}"
        )
    found = _compared(results, m, s, x, y, (a, b), window)
    return replace(found, notes=(*measured.notes, *found.notes))


def _compared(
    results: Results,
    m: BrokenLine,
    s: BrokenLine,
    x: str,
    y: str,
    between: tuple[float, float],
    window: float | None,
) -> Comparison:
    """Return the comparison of a measured and a simulated curve on a range of x."""
    a, b = between
    x_unit, y_unit = results.units[x], results.units[y]
    # the curves on [a, b]: each at its own points, the smoothed one at the points of both
    points, corners = m.points_within(a, b), s.points_within(a, b)
    there, ours = m.at(points), s.mean_at(points, window or 0.0)
    fine = np.union1d(points, corners) if window else corners
    peak_at_m, peak_m = _peak(points, there)
    peak_at_s, peak_s = _peak(fine, s.mean_at(fine, window or 0.0))
    to_work, work_unit = _work_scale(x_unit, y_unit)
    work_m, work_s = (to_work * line.integral(a, b) for line in (m, s))
    weights = shares(points)
    rms = float(np.sqrt(weights @ (ours - there) ** 2))
    steady, why_not = _steady_range(results, x, a, b)
    means = [line.integral(*steady) / (steady[1] - steady[0]) for line in (m, s)] if steady else []
    mean_m, mean_s = means or (float("nan"), float("nan"))
    pierced = _first_piercing(results, x, a, b)
    pierced_m, pierced_s = (line.at(pierced).item() for line in (m, s))
    return Comparison(
        name=results.name,
        x_name=x,
        x_unit=x_unit,
        y_name=y,
        y_unit=y_unit,
        x=points,
        measured=there,
        simulated=ours,
        measured_curve=(m.x, m.y),
        simulated_curve=(s.x, s.mean_at(s.x, window or 0.0)),
        window=window,
        rms=rms,
        rms_relative=_over(rms, peak_m),
        peak_measured=peak_m,
        peak_simulated=peak_s,
        peak_error=_over(peak_s - peak_m, peak_m),
        peak_at_measured=peak_at_m,
        peak_at_simulated=peak_at_s,
        work_measured=work_m,
        work_simulated=work_s,
        work_error=_over(work_s - work_m, work_m),
        work_unit=work_unit,
        correlation=_correlation(weights, there, ours),
        steady_range=steady,
        mean_measured=mean_m,
        mean_simulated=mean_s,
        mean_error=_over(mean_s - mean_m, mean_m),
        pierced_at=pierced.item(),
        pierced_measured=pierced_m,
        pierced_simulated=pierced_s,
        notes=(*_notes(m, s, points, (x, x_unit), peak_m * peak_s < 0.0), *why_not),
    )


def _columns_in_history(results: Results, x: str | None, y: str | None) -> tuple[str, str]:
    """Return the columns of the run to compare, by default its coordinate and its resistance."""
    x = results.coordinate_name if x is None else x
    y = results.resistance_name if y is None else y
    wrong = [f"no {k!r} in the history" for k in (x, y) if k not in results.history]
    if wrong:
        raise ValueError(f"{'; '.join(wrong)}: there are {', '.join(results.history)}")
    return x, y


def _common_range(m: BrokenLine, s: BrokenLine, x: str, x_unit: str) -> tuple[float, float]:
    """Return the range of x that the measured and the simulated curve both cover."""
    a, b = max(m.x[0], s.x[0]), min(m.x[-1], s.x[-1])
    if not a < b:
        raise ValueError(
            f"the curves must share a range of {x}, measured is {m.x[0]:.4g} to {m.x[-1]:.4g} "
            f"{x_unit}, simulated {s.x[0]:.4g} to {s.x[-1]:.4g} {x_unit}: "
            "check the units and the zero point"
        )
    return a, b


def _steady_range(
    results: Results, x: str, a: float, b: float
) -> tuple[tuple[float, float] | None, list[str]]:
    """Return the steady part of [a, b], or a note with the reason why there is none."""
    if x != results.coordinate_name:
        return None, []
    window = results.steady_window
    if not window:
        return None, [f"no steady window, so no mean: {window.reason}"]
    low, high = max(window.low, a), min(window.high, b)
    if not low < high:
        steadily = window.text(results.units[x])
        return None, [f"no mean: the steady window, {steadily}, lies outside the common range"]
    return (low, high), []


def _first_piercing(results: Results, x: str, a: float, b: float) -> Floats:
    """Return where whole film was first pierced, nan if not from a to b, shape (1,)."""
    edge = results.splits.get("edge", np.zeros(0))
    if not edge.any():
        return np.array([np.nan])
    then = results.splits["time"][edge > 0][:1]
    at = np.interp(then, results.history["time"], results.history[x])
    return np.where((at >= a) & (at <= b), at, np.nan)


def in_units(curve: MeasuredCurve, x: tuple[str, str], y: tuple[str, str]) -> BrokenLine:
    """Return the measured curve in the units of the history; x and y are names and units."""
    values, problems = [], []
    for (name, unit), column, ours, own in (
        (x, curve.x_name, curve.x, curve.x_unit),
        (y, curve.y_name, curve.y, curve.y_unit),
    ):
        try:
            values.append(np.asarray(ours) * conversion(own, unit))
        except ValueError:
            problems.append(f"{column} is in {own}, but the run's {name} is in {unit}")
    if problems:
        raise ValueError(f"{'; '.join(problems)}: is this the right model?")
    return BrokenLine(*values)


def _increasing(name: str, x: Floats, y: Floats) -> BrokenLine:
    back = np.flatnonzero(np.diff(x) < 0.0)
    if len(back):
        raise ValueError(
            f"{name} must not decrease in the history, but does in row {back[0] + 2}: "
            "compare over another column"
        )
    _, first = np.unique(x, return_index=True)
    if len(first) < 2:
        raise ValueError(f"{name} must increase in the history, but has {len(first)} values")
    return BrokenLine(x[first], y[first])


def _peak(x: Floats, y: Floats) -> tuple[float, float]:
    k = int(np.argmax(np.abs(y)))
    return float(x[k]), float(y[k])


def shares(x: Floats) -> Floats:
    """Return w_i / (b - a), the shares of points in their range by the trapezoidal rule."""
    steps = np.diff(x) / (x[-1] - x[0])
    return np.asarray(0.5 * (np.append(steps, 0.0) + np.append(0.0, steps)))


def _over(value: float, reference: float) -> float:
    return value / abs(reference) if reference else float("nan")


def _correlation(weights: Floats, first: Floats, second: Floats) -> float:
    (a, both), (_, b) = np.cov(first, second, ddof=0, aweights=weights)
    return float(both / np.sqrt(a * b)) if a * b > 0.0 else float("nan")


def _work_scale(x_unit: str, y_unit: str) -> tuple[float, str]:
    """Return the factor from y_unit x_unit to the unit of work, and that unit."""
    kinds = dimension(x_unit), dimension(y_unit)
    if kinds == ("angle", "torque"):
        return conversion(x_unit, "rad") * conversion(y_unit, "N*mm"), "N*mm"
    if kinds == ("length", "force"):
        return conversion(x_unit, "mm") * conversion(y_unit, "N"), "N*mm"
    return 1.0, f"{y_unit}*{x_unit}"


def _notes(
    m: BrokenLine, s: BrokenLine, points: Floats, x: tuple[str, str], opposed: bool
) -> list[str]:
    name, unit = x
    notes = []
    ends = [(line.x[0], line.x[-1]) for line in (m, s)]
    (m0, m1), (s0, s1) = ends
    if max(abs(m0 - s0), abs(m1 - s1)) > _SAME_END * (points[-1] - points[0]):
        notes.append(
            f"the ranges overlap only partly: measured {said(m0, unit)} to {said(m1, unit)}, "
            f"simulated {said(s0, unit)} to {said(s1, unit)}"
        )
    if len(points) < _FEW_POINTS:
        notes.append(f"only {len(points) - 2} measured points lie inside the common range")
    if opposed:
        notes.append(f"the peaks have opposite signs: is {name} or the sign convention reversed?")
    return notes
