"""The runs of a fit: residuals at sets of parameters, each computed once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats
from shellcut.model_file.reader import ModelVariants
from shellcut.results.comparison import Comparison

from .curve_misfit import FitCurve, compared, nothing_simulated, residuals, window_of
from .engines import Engine, Say
from .free_parameters import FreeParameters
from .one_run import Outcome
from .study import run_values


class OutOfRuns(Exception):
    """The runs that a fit may take are used up."""


class FitRuns:
    """Residuals of the measured curves at sets of parameters, from ``most`` runs in a folder."""

    def __init__(
        self,
        variants: ModelVariants,
        parameters: FreeParameters,
        curves: tuple[FitCurve, ...],
        folder: Path,
        engine: Engine,
        most: int,
        say: Say,
    ) -> None:
        self.parameters, self.curves = parameters, curves
        self._variants, self._folder, self._engine = variants, folder, engine
        self._most, self._say = most, say
        # Curves of the same settings share a run.
        texts = [repr(sorted(curve.settings.items())) for curve in curves]
        several = {text: dict(curve.settings) for text, curve in zip(texts, curves, strict=True)}
        self._settings = list(several.values())
        self._run_of = [list(several).index(text) for text in texts]
        # Of each curve; every run is compared at the points of the first one.
        self._windows: list[float] = []
        self._points: list[Floats] = []
        self._known: dict[tuple[float, ...], tuple[Floats, list[Comparison]]] = {}
        self.n_run = 0
        """Runs so far, those found done included."""
        self.failures: list[str] = []
        """Why runs failed."""
        self._doubts: dict[tuple[float, ...], list[str]] = {}

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
        self._take(start, done)

    def residuals(self, logs: Floats) -> Floats:
        """Return the residuals at one set of parameters."""
        return self.several([logs])[0]

    def several(self, points: Sequence[Floats], *, beyond: bool = False) -> list[Floats]:
        """Return the residuals at several sets, whose runs go to the engine together.

        Raises OutOfRuns if there are not as many runs left, unless ``beyond`` says not to mind.
        """
        new = [p for p in {_key(p): p for p in points}.values() if _key(p) not in self._known]
        if new and not beyond and self.left < len(new):
            raise OutOfRuns
        valued = []
        for point in new:
            try:
                valued.append((point, self.parameters.values(point.tolist())))
            except ValueError as problem:
                self._fail(point, str(problem))
        if valued:
            runs = self._run([values for _, values in valued])
            for (point, _), done in zip(valued, runs, strict=True):
                self._take(point, done)
        return [self._known[_key(point)][0] for point in points]

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

    def tried(self) -> tuple[Floats, Floats]:
        """Return all sets of parameters tried, and their residuals, a row each."""
        return np.array(list(self._known)), np.array([r for r, _ in self._known.values()])

    def best(self) -> Floats:
        """Return the set with the least misfit."""
        points, missed = self.tried()
        return np.asarray(points[np.argmin((missed**2).sum(axis=1))])

    def at(self, logs: Floats) -> tuple[Floats, list[Comparison]]:
        """Return residuals and comparisons of a set that has been run."""
        return self._known[_key(logs)]

    def doubts(self, logs: Floats) -> tuple[list[str], int]:
        """Return what verdicts distrust at a set that has been run, and at how many sets any do."""
        return self._doubts.get(_key(logs), []), len(self._doubts)

    def _run(self, values: Sequence[dict[str, float]]) -> list[list[tuple[Outcome, Path]]]:
        """Run sets of values with all settings; return outcome and folder by set and setting."""
        combined = [{**settings, **one} for one in values for settings in self._settings]
        done = run_values(self._variants, combined, self._folder, self._engine, self._say)
        self.n_run += len(done)
        each = [(outcome, run.folder(self._folder)) for run, outcome in done]
        n = len(self._settings)
        return [each[k : k + n] for k in range(0, len(each), n)]

    def _take(self, point: Floats, done: Sequence[tuple[Outcome, Path]]) -> None:
        """Keep the residuals of a set of runs."""
        failed = [one.reason or one.status for one, _ in done if one.status != "done"]
        if failed:
            self._fail(point, failed[0])
            return
        each = zip(self.curves, self._run_of, self._windows, self._points, strict=True)
        try:
            comparisons = [
                compared(done[which][1], curve, window, points)
                for curve, which, window, points in each
            ]
        except ValueError as problem:  # a run that ended early
            self._fail(point, str(problem))
            return
        self._known[_key(point)] = residuals(comparisons), comparisons
        if doubts := [doubt for one, _ in done for doubt in one.doubts]:
            self._doubts[_key(point)] = doubts

    def _fail(self, point: Floats, reason: str) -> None:
        """Give a set that cannot be run a misfit that the fit turns away from."""
        self.failures.append(reason)
        _, comparisons = next(iter(self._known.values()))
        self._known[_key(point)] = nothing_simulated(comparisons), comparisons


def _key(logs: Floats) -> tuple[float, ...]:
    return tuple(float(f"{log:.9g}") for log in logs)
