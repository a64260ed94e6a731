"""The runs of a fit: residuals at sets of parameters, each computed once."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TypeAlias

import numpy as np

from shellcut.arrays import Floats
from shellcut.results.comparison import Comparison

from .curve_misfit import FitCurve, compared, nothing_simulated, residuals, window_of
from .free_parameters import FreeParameters
from .one_run import Outcome

Done: TypeAlias = Sequence[tuple[Outcome, Path]]
"""How runs ended, and their folders."""


class OutOfRuns(Exception):
    """The runs that a fit may take are used up."""


@dataclass(frozen=True, eq=False)
class Tried:
    """What the runs of a set of parameters gave."""

    residuals: Floats
    comparisons: list[Comparison]
    """Those of the start, for a set that could not be run."""
    doubts: tuple[str, ...] = ()
    """What the verdicts of its runs distrust."""
    failure: str = ""
    """Why it could not be run."""


class FitRuns:
    """Residuals of the measured curves at sets of parameters, from ``most`` runs.

    ``run`` carries out runs with these values by key.
    """

    def __init__(
        self,
        parameters: FreeParameters,
        curves: tuple[FitCurve, ...],
        run: Callable[[Sequence[Mapping[str, object]]], Done],
        most: int,
    ) -> None:
        self.parameters, self.curves = parameters, curves
        self._carry_out, self._most = run, most
        # Curves of the same settings share a run.
        texts = [repr(sorted(curve.settings.items())) for curve in curves]
        several = {text: dict(curve.settings) for text, curve in zip(texts, curves, strict=True)}
        self._settings = list(several.values())
        self._run_of = [list(several).index(text) for text in texts]
        # Of each curve; every run is compared at the points of the first one.
        self._windows: list[float] = []
        self._points: list[Floats] = []
        self.tried: dict[tuple[float, ...], Tried] = {}
        """By the set of parameters, the start first."""
        self.n_run = 0
        """Runs so far, those found done included."""

    @property
    def left(self) -> int:
        """Sets of parameters that the runs left are good for."""
        return (self._most - self.n_run) // len(self._settings)

    def begin(self) -> None:
        """Run at the start, which sets the windows of the curves."""
        start = np.zeros(len(self.parameters.varied))
        (done,) = self._run([self.parameters.values(start.tolist())])
        for outcome, _ in done:
            if outcome.status != "done":
                raise RuntimeError(f"the run at the start has {outcome.status}: {outcome.reason}")
        problems = []
        for curve, which in zip(self.curves, self._run_of, strict=True):
            outcome, folder = done[which]
            window = window_of(folder, outcome.figures, curve)
            self._windows.append(window)
            try:
                self._points.append(compared(folder, curve, window).x)
            except (ValueError, OSError) as problem:
                problems.append(str(problem))
        if problems:
            raise ValueError("\n".join(problems))
        self.tried[_key(start)] = self._compared(done)

    def residuals(self, logs: Floats) -> Floats:
        """Return the residuals at one set of parameters."""
        return self.several([logs])[0]

    def several(self, points: Sequence[Floats], *, beyond: bool = False) -> list[Floats]:
        """Return the residuals at several sets, whose runs go to the engine together.

        Raises OutOfRuns if there are not as many runs left, unless ``beyond`` says not to mind.
        """
        keys = [_key(point) for point in points]
        new = {key: p for key, p in zip(keys, points, strict=True) if key not in self.tried}
        if new and not beyond and self.left < len(new):
            raise OutOfRuns
        valued = {}
        for key, point in new.items():
            try:
                valued[key] = self.parameters.values(point.tolist())
            except ValueError as problem:
                self.tried[key] = self._failed(str(problem))
        for key, done in zip(valued, self._run(list(valued.values())), strict=True):
            self.tried[key] = self._compared(done)
        return [self.tried[key].residuals for key in keys]

    def slopes(self, logs: Floats, step: float, *, beyond: bool = False) -> Floats:
        """Return the derivatives of the residuals by differences, shape (n_point, n_varied)."""
        low, high = self.parameters.bounds()
        points = []
        for k in range(logs.size):
            away = step if logs[k] + step <= high[k] or logs[k] - step < low[k] else -step
            points.append(logs + away * np.eye(logs.size)[k])
        here, *there = self.several([logs, *points], beyond=beyond)
        each = enumerate(zip(there, points, strict=True))
        return np.column_stack([(far - here) / (p[k] - logs[k]) for k, (far, p) in each])

    def best(self) -> Floats:
        """Return the set with the least misfit."""
        squares = {key: float((one.residuals**2).sum()) for key, one in self.tried.items()}
        return np.array(min(squares, key=lambda key: squares[key]))

    def at(self, logs: Floats) -> Tried:
        """Return what a set that has been run gave."""
        return self.tried[_key(logs)]

    def _run(self, values: Sequence[Mapping[str, float]]) -> list[Done]:
        """Run sets of values with all settings; return outcome and folder by set and setting."""
        combined = [{**settings, **one} for one in values for settings in self._settings]
        done = self._carry_out(combined) if combined else ()
        self.n_run += len(done)
        n = len(self._settings)
        return [done[k : k + n] for k in range(0, len(done), n)]

    def _compared(self, done: Done) -> Tried:
        """Return what the runs of a set gave."""
        for one, _ in done:
            if one.status != "done":
                return self._failed(one.reason or one.status)
        each = zip(self.curves, self._run_of, self._windows, self._points, strict=True)
        try:
            found = [
                compared(done[which][1], curve, window, points)
                for curve, which, window, points in each
            ]
        except ValueError as problem:  # a run that ended early
            return self._failed(str(problem))
        doubts = tuple(doubt for one, _ in done for doubt in one.doubts)
        return Tried(residuals(found), found, doubts)

    def _failed(self, reason: str) -> Tried:
        """Return a misfit that the fit turns away from, of a set that cannot be run."""
        comparisons = next(iter(self.tried.values())).comparisons
        return Tried(nothing_simulated(comparisons), comparisons, failure=reason)


def _key(logs: Floats) -> tuple[float, ...]:
    return tuple(float(f"{log:.9g}") for log in logs)
