"""Comparison of a run with a measured curve: its values, defined in docs/howto/compare.md.

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
from typing import Annotated, Any, TypeAlias, get_type_hints

import numpy as np

from shellcut.arrays import Floats
from shellcut.files.whole_file import write_text
from shellcut.numerics.broken_line import BrokenLine
from shellcut.state import PUNCTURE
from shellcut.unit import after, conversion, dimension, shown
from shellcut.unit import with_unit as said
from shellcut.view import Curve, Diagram, draw_curves

from .measured_curve import MeasuredCurve, read_measured_curve
from .run_results import Results, read
from .steady_mean import LEAST, Mean, change_in, mean_of, n_cosine
from .steady_window import steady_window

_SAME_END = 0.01
"""Relative to the common range: ends of two curves that lie closer together need no note."""
_FEW_POINTS = 10


_InX: TypeAlias = Annotated[float, "x_unit"]
_InY: TypeAlias = Annotated[float, "y_unit"]
_Work: TypeAlias = Annotated[float, "work_unit"]
_Ratio: TypeAlias = Annotated[float, "-"]
"""Figures, with the field of :class:`Comparison` that is their unit."""


Row: TypeAlias = tuple[str, str, str, str, str]
"""A value as text: its name, the unit of the next two, measured, simulated and difference.

A cell is empty if a curve has no such value. A difference in per cent has its own unit.
"""


@dataclass(frozen=True, eq=False)
class Comparison:
    """A run and a measured curve on their common range; built by :func:`compare`.

    The annotation of a value says in which of its units it is. Ratios are fractions; they are nan
    if their reference is zero.

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
    rms: _InY
    """Root-mean-square difference."""
    rms_relative: _Ratio
    """``rms`` over the measured peak."""
    peak_measured: _InY
    peak_simulated: _InY
    peak_error: _Ratio
    peak_at_measured: _InX
    peak_at_simulated: _InX
    work_measured: _Work
    work_simulated: _Work
    work_error: _Ratio
    correlation: _Ratio
    """From -1 to 1."""
    mean_measured: _InY
    """Over the steady part of the common range; nan without it, and if the curve changes in it."""
    mean_measured_half_width: _InY
    """Half-width of its 95 % interval, as :mod:`.steady_mean` has it; nan for too few points."""
    mean_simulated: _InY
    mean_simulated_half_width: _InY
    mean_error: _Ratio
    pierced_at: _InX
    """Where a cutting edge first pierces whole film, nan outside the common range."""
    pierced_measured: _InY
    pierced_simulated: _InY
    work_unit: str
    """N*mm for a torque over an angle or a force over a path, else the product of both units."""
    steady_range: tuple[float, float] | None
    """Part of the common range with steady cutting [x_unit], None if there is none."""
    notes: tuple[str, ...]
    """Notes for the reader, such as ranges that overlap only partly."""

    @property
    def range(self) -> tuple[float, float]:
        """Ends of the common range [x_unit]."""
        return float(self.x[0]), float(self.x[-1])

    def __str__(self) -> str:
        """Return a small table with its scope above it and the notes below."""
        table = [("", "measured", "simulated", "difference")]
        for name, unit, measured, simulated, difference in self.rows():
            both = [f"{cell}{after(unit)}" if cell else "" for cell in (measured, simulated)]
            own = "" if not difference or difference.endswith(("%", "-")) else after(unit)
            table.append((name, both[0], both[1], f"{difference}{own}"))
        width = [max(len(cells[k]) for cells in table) for k in range(4)]
        lines = [
            cells[0].ljust(width[0])
            + "".join(f"  {cell.rjust(w)}" for cell, w in zip(cells[1:], width[1:], strict=True))
            for cells in table
        ]
        notes = [f"note: {note}" for note in self.notes]
        return "\n".join([f"{self.name}: {self.scope()}", *lines, *notes])

    def scope(self) -> str:
        """Return common range, number of points and smoothing in words."""
        unit, factor = shown(self.x_unit)
        a, b, width = (factor * along for along in (*self.range, self.window or 0.0))
        x = after(unit)
        smoothed = f", simulated mean over {width:.4g}{x}" if width else ""
        return f"{self.x_name} {a:.4g} to {b:.4g}{x}, {len(self.x)} points{smoothed}"

    def rows(self) -> list[Row]:
        """Return the values as texts."""
        c, x, y = self, self.x_unit, self.y_unit
        shift = c.peak_at_simulated - c.peak_at_measured
        both: list[tuple[str, str, float, float, str | float]] = [
            (f"peak {c.y_name}", y, c.peak_measured, c.peak_simulated, _percent(c.peak_error)),
            (f"{c.x_name} of the peak", x, c.peak_at_measured, c.peak_at_simulated, shift),
            ("work", c.work_unit, c.work_measured, c.work_simulated, _percent(c.work_error)),
        ]
        if c.steady_range is not None:
            unit, factor = shown(x)
            low, high = (factor * end for end in c.steady_range)
            name = f"mean over {low:.3g}-{high:.3g}{after(unit)}"
            both.insert(2, (name, y, c.mean_measured, c.mean_simulated, _percent(c.mean_error)))
            spread = "± of the mean, 95 %"
            measured, simulated = c.mean_measured_half_width, c.mean_simulated_half_width
            both.insert(3, (spread, y, measured, simulated, ""))
        if np.isfinite(c.pierced_at):
            unit, factor = shown(x)
            name = f"at first piercing, {factor * c.pierced_at:.3g}{after(unit)}"
            change = c.pierced_simulated - c.pierced_measured
            both.append((name, y, c.pierced_measured, c.pierced_simulated, change))
        correlation = f"{c.correlation:.4f}" if np.isfinite(c.correlation) else "-"
        return [
            *(_row(*cells) for cells in both),
            _row("RMS difference", y, None, None, c.rms, sign=""),
            ("RMS difference over the peak", "-", "", "", _percent(c.rms_relative, sign="")),
            ("correlation", "-", "", "", correlation),
        ]

    def to_json(self, path: str | os.PathLike[str]) -> Path:
        """Write the values, each as ``{"value", "unit"}``, and both curves; return the path.

        Values that are not finite are written as null.
        """
        content: dict[str, Any] = {
            "run": self.name,
            "x": {"name": self.x_name, "unit": self.x_unit},
            "y": {"name": self.y_name, "unit": self.y_unit},
            "range": list(self.range),
            "measured_range": self.measured_curve[0][[0, -1]].tolist(),
            "simulated_range": self.simulated_curve[0][[0, -1]].tolist(),
            "window": self.window,
            "steady_range": self.steady_range,
            "n_point": len(self.x),
            "figures": {
                name: {"value": finite(getattr(self, name)), "unit": getattr(self, unit, unit)}
                for name, unit in _FIGURES.items()
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
        draw_curves(path, self.diagrams(), size=(9.0, 6.0))
        return path

    def diagrams(self) -> tuple[Diagram, Diagram]:
        """Return both curves with their peaks, and their difference."""

        def peak(value: float, at: float) -> str:
            return f"peak {said(value, self.y_unit)} at {said(at, self.x_unit)}"

        (x, measured), (own, simulated) = self.measured_curve, self.simulated_curve
        peaks = (
            f"measured, {peak(self.peak_measured, self.peak_at_measured)}",
            f"simulated, {peak(self.peak_simulated, self.peak_at_simulated)}",
        )
        both = [Curve(peaks[0], measured, "measured", x=x), Curve(peaks[1], simulated, x=own)]
        gap = [Curve("difference", self.simulated - self.measured, "contact")]
        upper = Diagram(
            self.x,
            both,
            self.x_name,
            self.x_unit,
            self.y_name,
            self.y_unit,
            title=self.name,
            height=3.0,
        )
        lower = replace(upper, curves=gap, name="difference", title="", height=1.0)
        return upper, lower


_FIGURES: dict[str, str] = {
    name: hint.__metadata__[0]
    for name, hint in get_type_hints(Comparison, include_extras=True).items()
    if hasattr(hint, "__metadata__")
}


def _row(
    name: str, unit: str, m: float | None, s: float | None, off: str | float, sign: str = "+"
) -> Row:
    """Return numbers as text in the unit in which they are shown; ``off`` may be text already."""
    unit, factor = shown(unit)
    both = (float("nan") if value is None else factor * value for value in (m, s))
    measured, simulated = (f"{value:.4g}" if np.isfinite(value) else "" for value in both)
    difference = off if isinstance(off, str) else f"{factor * off:{sign}.4g}"
    return name, unit, measured, simulated, difference


def _percent(fraction: float, sign: str = "+") -> str:
    return f"{100.0 * fraction:{sign}.1f} %" if np.isfinite(fraction) else "-"


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
    columns, units : (str or int, str or int), str or (str, str), optional
        The file's columns for ``x`` and ``y``, and their units, as of :func:`read_measured_curve`;
        by default the columns with the same names.
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
    x = results.coordinate_name if x is None else x
    y = results.resistance_name if y is None else y
    if wrong := [f"no {k!r} in the history" for k in (x, y) if k not in results.history]:
        raise ValueError(f"{'; '.join(wrong)}: there are {', '.join(results.history)}")
    x_unit, y_unit = results.units[x], results.units[y]
    if window is not None and not (np.isfinite(window) and window > 0.0):
        raise ValueError(f"window must be a width above 0 {x_unit}, got {window!r}")
    if not isinstance(measured, MeasuredCurve):
        x_column, y_column = columns or (None, None)
        measured = read_measured_curve(
            Path(measured), x_column, y_column, units=units, expected=(x, y)
        )
    m = in_units(measured, (x, x_unit), (y, y_unit))
    s = _increasing(x, results.history[x], results.history[y])
    a, b = max(m.x[0], s.x[0]), min(m.x[-1], s.x[-1])
    if not a < b:
        raise ValueError(
            f"the curves must share a range of {x}, measured is {m.x[0]:.4g} to {m.x[-1]:.4g} "
            f"{x_unit}, simulated {s.x[0]:.4g} to {s.x[-1]:.4g} {x_unit}: "
            "check the units and the zero point"
        )
    if window is not None and window > b - a:
        raise ValueError(
            f"window must be less than the common range, {b - a:.4g} {x_unit}, got {window:g}"
        )
    return _compared(results, (x, y), (m, s), (a, b), window, measured.notes)


def _compared(
    results: Results,
    columns: tuple[str, str],
    lines: tuple[BrokenLine, BrokenLine],
    between: tuple[float, float],
    window: float | None,
    notes: tuple[str, ...],
) -> Comparison:
    """Return the comparison of a measured and a simulated curve, their columns, on a range of x."""
    (x, y), (m, s), (a, b), width = columns, lines, between, window or 0.0
    x_unit, y_unit = results.units[x], results.units[y]
    # the curves on [a, b]: each at its own points, the smoothed one at the points of both
    points, corners = m.points_within(a, b), s.points_within(a, b)
    there, ours = m.at(points), s.mean_at(points, width)
    fine = np.union1d(points, corners) if window else corners
    peak_at_m, peak_m = _peak(points, there)
    peak_at_s, peak_s = _peak(fine, s.mean_at(fine, width))
    to_work, work_unit = _work_over(x_unit, y_unit)
    work_m, work_s = (to_work * line.integral(a, b) for line in (m, s))
    weights = shares(points)
    rms = float(np.sqrt(weights @ (ours - there) ** 2))
    (square_m, both), (_, square_s) = np.cov(there, ours, ddof=0, aweights=weights)
    squares = square_m * square_s
    steady, pieces, why_not = _steady_range(results, x, a, b)
    mean_m = mean_s = Mean(float("nan"), float("nan"))
    if steady:
        mean_m, no_m = _steady_mean(m, steady, pieces, (f"measured {y}", y_unit), x_unit)
        mean_s, no_s = _steady_mean(s, steady, pieces, (f"simulated {y}", y_unit), x_unit)
        why_not = [*no_m, *no_s]
    pierced = _pierced_at(results, x, a, b)
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
        simulated_curve=(s.x, s.mean_at(s.x, width)),
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
        correlation=float(both / np.sqrt(squares)) if squares > 0.0 else float("nan"),
        steady_range=steady,
        mean_measured=mean_m.value,
        mean_measured_half_width=mean_m.half_width,
        mean_simulated=mean_s.value,
        mean_simulated_half_width=mean_s.half_width,
        mean_error=_over(mean_s.value - mean_m.value, mean_m.value),
        pierced_at=pierced.item(),
        pierced_measured=m.at(pierced).item(),
        pierced_simulated=s.at(pierced).item(),
        notes=(
            *notes,
            *_notes(m, s, points, (x, x_unit), peak_m * peak_s < 0.0),
            *why_not,
        ),
    )


def _work_over(x_unit: str, y_unit: str) -> tuple[float, str]:
    """Return the factor from the integral of y over x to a work, and the unit of that."""
    kinds = dimension(x_unit), dimension(y_unit)
    if kinds == ("angle", "torque"):
        return conversion(x_unit, "rad") * conversion(y_unit, "N*mm"), "N*mm"
    if kinds == ("length", "force"):
        return conversion(x_unit, "mm") * conversion(y_unit, "N"), "N*mm"
    return 1.0, f"{y_unit}*{x_unit}"


def _pierced_at(results: Results, x: str, a: float, b: float) -> Floats:
    """Return where an edge first pierces the film, shape (1,); nan if it does not in [a, b]."""
    pierces = results.splits.get("kind", np.zeros(0, str)) == PUNCTURE
    then = results.splits["time"][pierces][:1] if pierces.any() else np.array([np.nan])
    at = np.interp(then, results.history["time"], results.history[x])
    return np.where((at >= a) & (at <= b), at, np.nan)


def _steady_range(
    results: Results, x: str, a: float, b: float
) -> tuple[tuple[float, float] | None, float, list[str]]:
    """Return the steady part of [a, b] and how many process zones are cut in it.

    Or None, 0 and a note with the reason why there is none.
    """
    if x != results.coordinate_name:
        return None, 0.0, []
    unit, window = results.units[x], results.steady_window
    if not window:
        return None, 0.0, [f"no steady window, so no mean: {window.reason}"]
    low, high = max(window.low, a), min(window.high, b)
    if not low < high:
        steadily = window.text(unit)
        return None, 0.0, [f"no mean: the steady window, {steadily}, lies outside the common range"]
    if (low, high) != (window.low, window.high):
        window = steady_window(results.history, (x, unit), (low, high))
    if not window:
        return None, 0.0, [f"no mean over the measured part of the steady window: {window.reason}"]
    return (low, high), window.pieces, []


def _steady_mean(
    line: BrokenLine, between: tuple[float, float], pieces: float, y: tuple[str, str], x_unit: str
) -> tuple[Mean, list[str]]:
    """Return the mean of a curve over the window, and why it, or its ±, is missing: nan then.

    Of a value that changes between two points as it likes, the mean over the window has the error
    of the sum of the values by their shares, and so have the cosines of that sum. They are as large
    as it only if two points or more lie on each half wave. So for a curve whose points are up to d
    apart, waves count from 4 d on: no more of them than for a memory of 4 d.
    """
    points, (low, high) = line.points_within(*between), between
    first, last = line.x.searchsorted(low, "right") - 1, line.x.searchsorted(high, "left")
    apart = float(np.diff(line.x[first : last + 1]).max())
    pieces = min(pieces, 0.25 * (high - low) / apart)
    way = np.concatenate(([low], 0.5 * (points[1:] + points[:-1]), [high]))
    integral = np.append(0.0, np.cumsum(line.at(points) * np.diff(way)))
    if n_cosine(pieces) < LEAST:
        mean = Mean(float(integral[-1]) / (high - low), float("nan"))
        far, near = (said(x, x_unit) for x in (apart, 0.5 * (high - low) / LEAST))
        few = f"its points in the steady window are up to {far} apart; a ± takes {near} or less"
        return mean, [f"no ± for the mean of the {y[0]}, nor a test that it is steady: {few}"]
    if change := change_in(way, integral, pieces):
        nothing = Mean(float("nan"), float("nan"))
        return nothing, [f"no mean: {change.text(*y, between, x_unit)}"]
    return mean_of(way, integral, pieces), []


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
