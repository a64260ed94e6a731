"""Free parameters of a fit, and its runs: residuals at sets of parameters, each computed once.

A parameter is a key with a range and a start in it. All are positive and vary by factors: the fit
works with log(value / start). If the fracture energy is kept, the last of them follows from the
others, so that the law's area stays that of the model.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import TypeAlias

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.model_file.overrides import path_of
from shellcut.model_file.reader import ModelVariants
from shellcut.results.comparison import Comparison

from .curve_misfit import FitCurve, compared, nothing_simulated, residuals, window_of
from .factors import Factor
from .one_run import Outcome

_N_TRIED = 65
"""Values of a key among which that with a given energy is sought."""

_NEIGHBOURS = (1.0, -1.0, 0.5, -0.5)
"""Of a set of parameters, in steps: the first that can be run gives the derivative."""

_DIGITS = 7
"""Of a value: a fit that is called again finds its runs by them."""


@dataclass(frozen=True)
class Free:
    """A free parameter."""

    key: str
    """Section and key."""
    start: float
    low: float
    high: float
    """Where the fit starts, and the ends of the range, in the unit of the key."""
    unit: str = ""
    """Of the key, for messages."""


class FreeParameters:
    """The free parameters of a fit: the factors of its settings, which must be ranges.

    With ``keep_energy`` the last of them follows from the law's fracture energy. Raises ValueError
    with all that is wrong with them.
    """

    def __init__(
        self, variants: ModelVariants, factors: Sequence[Factor], *, keep_energy: bool = False
    ) -> None:
        self._variants, self.keep_energy = variants, keep_energy
        self.all: list[Free] = []
        problems = []
        for factor in factors:
            try:
                self.all.append(_free(variants, factor))
            except ValueError as problem:
                problems.append(str(problem))
        keys = [one.key for one in self.all]
        problems += [
            f"{key} must have one range" for key in dict.fromkeys(keys) if keys.count(key) > 1
        ]
        if keep_energy and len(factors) < 2:
            problems.append("to keep the energy two or more keys must vary: the last follows")
        if keep_energy and keys and not keys[-1].startswith("cohesive."):
            problems.append(f"to keep the energy the last must be of [cohesive], not {keys[-1]}")
        if problems:
            raise ValueError("\n".join(problems))
        self.varied = self.all[:-1] if keep_energy else self.all
        """Those that the fit varies."""
        self._energy = _energy(variants, {}) if keep_energy else 0.0

    def bounds(self) -> tuple[Floats, Floats]:
        """Return the bounds of the logarithms."""
        low = np.log([free.low / free.start for free in self.varied])
        high = np.log([free.high / free.start for free in self.varied])
        return low, high

    def values(self, logs: Sequence[float]) -> dict[str, float]:
        """Return the values of all free keys.

        Raises ValueError if no value of the last key keeps the energy.
        """
        values = {
            free.key: _rounded(free.start * math.exp(log))
            for free, log in zip(self.varied, logs, strict=True)
        }
        if self.keep_energy:
            values[self.all[-1].key] = self._following(values)
        return values

    def _following(self, values: Mapping[str, float]) -> float:
        """Return the last key's value with which the law has the energy of the model."""
        last = self.all[-1]

        def excess(value: float) -> float:
            return _energy(self._variants, {**values, last.key: value}) - self._energy

        # Some values between the bounds may be no law: an opening beyond which the next one lies.
        tried = np.geomspace(last.low, last.high, _N_TRIED).tolist()
        for low, high in pairwise(one for one in tried if not np.isnan(excess(one))):
            if excess(low) * excess(high) <= 0.0:
                return _rounded(float(scipy.optimize.brentq(excess, low, high, rtol=1e-12)))
        raise ValueError(
            f"no {last.key} from {last.low:g} to {last.high:g} keeps the energy with {values}"
        )


def _free(variants: ModelVariants, factor: Factor) -> Free:
    """Return the free parameter of a range, whose ends the model reads as any other value."""
    if factor.ends is None:
        raise ValueError(
            f"{factor.name}: a fit takes one value, or a range low:high in which to fit it, "
            f"got {len(factor.values)} values"
        )
    several = ({}, *map(factor.settings, factor.probes()))
    models = [variants.read(values, try_out=False) for values in several]
    tables = [one.titled() for one in models]
    *parts, name = map(str, path_of(factor.name, models[0].head.model))
    title = ".".join(parts)
    keys = tables[1][title].of.keys
    name, key = next((n, key) for n, key in keys.items() if name in (n, key.also))
    low, high = (one[title].values[name] for one in tables[1:])
    if not low > 0.0:
        raise ValueError(f"{factor.name}: a range to fit must be above 0, got {low:g}:{high:g}")
    start = tables[0][title].values.get(name) if title in tables[0] else None
    if not isinstance(start, float) or not low <= start <= high:
        start = math.sqrt(low * high)
    return Free(f"{title}.{name}".removeprefix("."), start, low, high, key.option.unit)


def _energy(variants: ModelVariants, values: Mapping[str, object]) -> float:
    """Return the fracture energy of the law with some values [N/mm], nan if these are no law."""
    section = variants.read(values, try_out=False).sections["cohesive"]
    try:
        return float(section.made().fracture_energy)
    except ValueError:
        return float("nan")


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")


# --- runs -----------------------------------------------------------------------------------------

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
        """Return the derivatives of the residuals by differences, shape (n_point, n_varied).

        A set that could not be run has no residuals to take a difference with: then the next of the
        neighbours is run, within the bounds if any is. Without any the derivatives are nan.
        """
        here = self.residuals(logs)
        slopes = np.full((here.size, logs.size), np.nan)
        all_ = [share * step for share in _NEIGHBOURS]
        ways = [
            [away for away in all_ if low <= x + away <= high] or all_
            for x, low, high in zip(logs, *self.parameters.bounds(), strict=True)
        ]
        for turn in range(len(_NEIGHBOURS)):
            open_ = [k for k, way in enumerate(ways) if turn < len(way) and np.isnan(slopes[0, k])]
            points = [logs + ways[k][turn] * np.eye(logs.size)[k] for k in open_]
            there = self.several(points, beyond=beyond)
            for k, point, far in zip(open_, points, there, strict=True):
                if not self.at(point).failure:
                    slopes[:, k] = (far - here) / (point[k] - logs[k])
        return slopes

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
        """Return a misfit that the fit turns away from, of a set that cannot be run.

        It is twice that of the start or more, so that such a set is never better than one that ran.
        """
        start = next(iter(self.tried.values()))
        nothing = nothing_simulated(start.comparisons)
        larger = 2.0 * np.linalg.norm(start.residuals) / np.linalg.norm(nothing)
        return Tried(max(1.0, float(larger)) * nothing, start.comparisons, failure=reason)


def _key(logs: Floats) -> tuple[float, ...]:
    return tuple(float(f"{log:.9g}") for log in logs)
