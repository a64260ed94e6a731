"""The best values of some keys: those of the least or largest result, within limits on others.

Optuna's tree-structured Parzen estimator proposes values, four sets at a time, and receives what
their runs gave; the first set is that of the model. It starts from one seed and the number of sets
does not depend on the number of processes. So a search that is called again proposes the same runs,
finds those done by the hashes of their inputs, and continues where it was ended.
"""

from __future__ import annotations

import json
import math
import os
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from shellcut.files.distribution import optional
from shellcut.files.file_list import folder_named
from shellcut.files.whole_file import write_text
from shellcut.results.cut_quality import UNITS, cut_quality
from shellcut.results.run_results import read
from shellcut.results.steady_window import half_width_of, no_mean_of
from shellcut.results.summary_figures import (
    PEAK,
    figure_name,
    known_figure,
    label_of,
    said_of,
    unit_of,
    with_unit,
)
from shellcut.view import Curve, Diagram, can_draw, draw_curves

from .converge import NoFinerFilm, finer_film
from .engines import AnyExecutor, Say, engine_of
from .factors import Factor
from .one_run import Outcome, outcome_in
from .plan import PlannedRun, sought
from .study import run_values, taken
from .table import NOT_COMMON, CommonWindow

OPTIMUM, PICTURE = "optimum.json", "optimum.png"

_AT_A_TIME = 4  # sets proposed before their results are told: keeps four processes busy
_DIGITS = 4  # of a value: nobody makes a tooth more precisely
_NEAR = 0.05  # part of a range to which 60 proposals come near to the best of it
_LIMIT = re.compile(r"\s*(\w[^<>=]*?)\s*(<=|>=|==)\s*([-+.\deE]+)\s*")

_FAILED, _BEYOND, _DISTRUSTED = "failed", "beyond the limits", "distrusted"
"""Why a trial cannot be the best, in the order in which it is asked."""


@dataclass(frozen=True)
class Trial:
    """A set of values and what its run gave."""

    values: Mapping[str, object]
    """By key; those of the model are empty."""
    folder: str
    """Of the run."""
    figure: float | None = None
    """What is sought, of a peak its size; None if the run failed."""
    missed: float = 0.0
    """How far it is beyond the limits, in their units, together; 0 within all."""
    reason: str = ""
    """Why it failed."""
    limited: Mapping[str, float] = field(default_factory=dict)
    """The values that have limits."""
    doubts: tuple[str, ...] = ()
    """What the verdict of its run distrusts."""
    half_width: float | None = None
    """Of the 95 % interval, if the value is a mean."""


@dataclass(frozen=True)
class Optimum:
    """What a search has found.

    Examples
    --------
    >>> trials = Trial({}, "a", 202.3), Trial({"tool.half_thickness": 0.2}, "b", 180.0)
    >>> print(Optimum("torque_peak_Nmm", 1, (), trials))
    tool.half_thickness = 0.2
    torque, peak: 202.3 N·mm as given, 180 N·mm at best (-11.0 %)
    2 runs
    """

    figure: str
    """Its name in ``summary.json``, with the unit."""
    sign: int
    """1 if the least is sought, -1 for the largest."""
    limits: tuple[str, ...]
    trials: tuple[Trial, ...]
    """In the order in which they were proposed, the model as given first."""
    confirmed: tuple[Trial, ...] = field(default=())
    """The first, the best and the second best again, on a finer film or with other settings."""
    where: str = ""
    """On what these ran."""
    unconfirmed: str = ""
    """Why none was run again."""
    allow_doubts: bool = False
    """Whether a run that its verdict distrusts may be the best."""
    compared: tuple[Trial, ...] = field(default=())
    """If the value is a mean: the first and the best over their common steady window, if any."""
    factors: tuple[Factor, ...] = field(default=())
    """What was sought, with its bounds."""

    @property
    def second(self) -> Trial | None:
        """The best of those with other values than :attr:`best`; None if there is none."""
        best = self.best
        others = [one for one in self.trials if best and one.values != best.values]
        return min((one for one in others if not self.state(one)), key=self._rank, default=None)

    @property
    def best(self) -> Trial | None:
        """The best within all limits of those that can be trusted; None if there is none.

        It is the model as given if that is as good but for the ± of the means.
        """
        first = self.trials[0]
        can_be = (one for one in self.trials if not self.state(one))
        best = min(can_be, key=self._rank, default=None)
        return first if best and not self.state(first) and self._alike(first, best) else best

    def _rank(self, one: Trial) -> float:
        return self.sign * (one.figure or 0.0)

    def _alike(self, one: Trial, other: Trial) -> bool:
        """Whether two means differ by less than their ± together."""
        if None in (one.figure, other.figure, one.half_width, other.half_width):
            return False
        spread = math.hypot(one.half_width or 0.0, other.half_width or 0.0)
        return abs((one.figure or 0.0) - (other.figure or 0.0)) <= spread

    def state(self, one: Trial) -> str:
        """Return why a trial cannot be the best; "" if it can."""
        if one.figure is None:
            return _FAILED
        if one.missed > 0.0:
            return _BEYOND
        return _DISTRUSTED if one.doubts and not self.allow_doubts else ""

    def __str__(self) -> str:
        """Return the best values, and how much better than the model they are."""
        best, states = self.best, [self.state(one) for one in self.trials]
        counts = ((states.count(why), why) for why in (_FAILED, _BEYOND, _DISTRUSTED))
        n_run = ", ".join([f"{len(states)} runs", *(f"{n} {why}" for n, why in counts if n)])
        if best is None:
            return "\n".join([f"no run is the best: {n_run}", *self._why_none(states)])
        lines = [f"{key} = {value}" for key, value in best.values.items()]
        lines = lines or ["the model as given is the best"]
        first, found = self.compared or (self.trials[0], best)
        lines += self._against(first, found)
        if self.confirmed:
            first, again, *second = self.confirmed
            names = ["as given", *("second best" for _ in second)]
            for name, other in zip(names, (first, *second), strict=True):
                if other.folder == again.folder:
                    continue
                lines += [f"{self.where}: {line}" for line in self._against(other, again, name)]
        elif self.unconfirmed:
            lines.append(f"not run on a finer film: {self.unconfirmed}")
        near = (said for one in self.factors for said in one.bounds_met(best.values, _NEAR))
        lines += [f"{said}: if values beyond are possible, widen it" for said in near]
        return "\n".join([*lines, n_run])

    def _why_none(self, states: Sequence[str]) -> Iterator[str]:
        """Yield how near the nearest run came to the limits, and what makes others distrusted."""
        if _BEYOND in states:
            beyond = [one for one in self.trials if one.missed > 0.0]
            near = min(beyond, key=lambda one: one.missed)
            said = ((label_of(n), with_unit(n, v)) for n, v in near.limited.items())
            figures = ", ".join(f"{name} {value}" for name, value in said)
            yield (
                f"the nearest to {', '.join(self.limits)} is run {self.trials.index(near) + 1} "
                f"with {figures}: loosen a limit, widen a range or take more runs"
            )
        if _DISTRUSTED in states:
            first = self.trials[states.index(_DISTRUSTED)]
            yield from (f"distrust: {doubt}" for doubt in first.doubts)
            yield "to let a distrusted run be the best: allow_doubts, or --allow-doubts"

    def _against(self, start: Trial, best: Trial, who: str = "as given") -> Iterator[str]:
        name = label_of(self.figure)
        if start.figure is None or best.figure is None:
            yield f"{name}: {start.reason or best.reason}"
            return
        beyond = "" if best.missed == 0.0 else f", beyond the limits by {best.missed:.3g}"
        given, found = self._said(start), self._said(best)
        alike = best.folder != start.folder and self._alike(start, best)
        notes = ["less than the ± of both"] * alike
        if start.figure and best.figure * start.figure >= 0.0:  # a change of sign has no ratio
            change = 100.0 * (best.figure - start.figure) / abs(start.figure)
            notes = [f"{change:+.1f} %", *notes]
        less = f" ({', '.join(notes)})" if notes else ""
        yield f"{name}: {given} {who}, {found} at best{less}{beyond}"
        if best.values != start.values and (alike or self._rank(best) >= self._rank(start)):
            yield f"its difference from the one {who} is within the scatter"
        for which, one in {who: start, "at best": best}.items():
            yield from (f"distrust {which}: {doubt}" for doubt in one.doubts)

    def _said(self, one: Trial) -> str:
        return said_of(
            self.figure, {self.figure: one.figure, half_width_of(self.figure): one.half_width}
        )

    def write(self, folder: Path) -> None:
        """Write ``optimum.json`` and, with Matplotlib, ``optimum.png``."""
        write_text(
            folder / OPTIMUM,
            json.dumps({"said": str(self), **asdict(self)}, indent=1, default=str) + "\n",
        )
        if can_draw():
            draw_curves(folder / PICTURE, [self.diagram()], size=(8.0, 4.5))

    def diagram(self) -> Diagram:
        """Return the value of each run over its number, and the best so far."""
        n = np.arange(1.0, len(self.trials) + 1.0)
        values = np.array([np.nan if t.figure is None else t.figure for t in self.trials])
        states = np.array([self.state(one) for one in self.trials])
        least = np.minimum.accumulate(np.where(states == "", self.sign * values, np.inf))
        looks = {
            _DISTRUSTED: ("doubt", "doubtful runs"),
            _BEYOND: ("p4", "runs beyond the limits"),
            "": ("p0", "runs within the limits" if self.limits else "runs"),
        }
        curves = [
            Curve(name, np.where(states == state, values, np.nan), style)
            for state, (style, name) in looks.items()
            if state in states
        ]
        curves.append(Curve("best so far", np.where(np.isinf(least), np.nan, self.sign * least)))
        name, unit = label_of(self.figure), unit_of(self.figure)
        return Diagram(n, curves, "number of the run", "", name, unit, zero=False, whole=True)


def optimise(
    model: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    minimise: str = "",
    maximise: str = "",
    subject_to: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    confirm: Mapping[str, object] | None = None,
    max_runs: int = 60,
    allow_doubts: bool = False,
    executor: AnyExecutor = None,
    say: Say = None,
) -> Optimum:
    """Seek the values of some keys that make a result least, or largest.

    Parameters
    ----------
    out : str or path
        Folder for the runs, ``optimum.json`` and, with Matplotlib, ``optimum.png``.
    minimise, maximise : str
        One of them: a value of ``summary.json`` or of :class:`shellcut.CutQuality` at the end, as
        ``torque_peak_Nmm``; its unit may be left out, and the words of the reports are names, too.
        Of a peak the size counts, whatever its sign.
    subject_to : sequence of str
        Limits on such values: ``"n_loose == 1"``, ``"crack_length >= 58"``.
    settings : mapping
        By key: one value for all runs; or what is sought, a range, as ``"40:80"``, or values to
        choose from, as the factors of :func:`shellcut.sweep`. At least one key must be sought.
    confirm : mapping, optional
        Keys with another value in further runs of the model as given, of the best values and of the
        second best: by default those of a finer film (:func:`shellcut.converge`), as a coarse one
        may rank them otherwise. If it is empty, there are no further runs.
    max_runs : int
        Runs to take at most.
    allow_doubts : bool
        Whether a run that its verdict distrusts may be the best; by default it counts as beyond the
        limits.
    model, executor, say
        As of :func:`shellcut.sweep`.

    Returns
    -------
    Optimum

    Raises
    ------
    ModelFileError, FolderInUse, FileExistsError, ConnectionError, KeyboardInterrupt
        As of :func:`shellcut.sweep`.
    ValueError
        If keys, values or limits do not fit.
    RuntimeError
        If the run of the model as given fails, or has not the values.
    ImportError
        If Optuna is not installed.

    Examples
    --------
    >>> found = optimise(  # doctest: +SKIP
    ...     "opening",
    ...     "teeth",
    ...     settings={"mesh": "quick", "tool.half_thickness": "0.2:0.5"},
    ...     minimise="torque_peak",
    ... )
    >>> found.best.values  # doctest: +SKIP
    {'tool.half_thickness': 0.2213}
    """
    optuna = optional("optuna", "a search for the best values needs Optuna", "optimise")
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    if bool(minimise) == bool(maximise):
        raise ValueError("give either minimise or maximise, the name of a result")
    if max_runs < 2:
        raise ValueError(f"max_runs must be 2 or more, got {max_runs}")
    sign, wanted = (1 if minimise else -1), known_figure(minimise or maximise, UNITS)
    limits = [_limit(text) for text in subject_to]
    factors, variants = sought(model, settings)
    variants.read(confirm or {}, try_out=False)  # what is wrong with it shows before the search
    engine, folder = engine_of(executor), folder_named(out)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=0))
    trials = list[Trial]()

    def run(several: Sequence[Mapping[str, object]]) -> list[Trial]:
        done = run_values(variants, several, folder, engine, say)
        return [_trial(one, outcome, folder, wanted, limits) for one, outcome in done]

    with taken(folder, [OPTIMUM, PICTURE]):
        trials += run([{}])
        if trials[0].figure is None:
            raise RuntimeError(
                f"the model as given must run and have all these values: {trials[0].reason}"
            )
        while len(trials) < max_runs:
            asked = [study.ask() for _ in range(min(_AT_A_TIME, max_runs - len(trials)))]
            done = run([_proposed(one, factors) for one in asked])
            for one, trial in zip(asked, done, strict=True):
                one.set_constraint("limits", trial.missed)
                one.set_constraint("doubts", 0.0 if allow_doubts else len(trial.doubts))
                value = None if trial.figure is None else sign * trial.figure
                study.tell(one, value, optuna.trial.TrialState.FAIL if value is None else None)
            trials += done
        kept = tuple(subject_to)
        found = Optimum(wanted, sign, kept, tuple(trials), factors=tuple(factors))
        found = replace(found, allow_doubts=allow_doubts)
        if found.best and found.best.half_width is not None and not found.state(trials[0]):
            found = replace(found, compared=_in_common([trials[0], found.best], wanted))
        if found.best and confirm != {}:
            several = [trials[0].values, found.best.values]
            if found.second and found.second.folder != trials[0].folder:
                several.append(found.second.values)
            try:
                again: Sequence[Trial] = run(
                    [
                        {**v, **(finer_film(variants.read(v)) if confirm is None else confirm)}
                        for v in several
                    ]
                )
                again = _in_common(again, wanted) or again
                keys = ", ".join(f"{key} = {value}" for key, value in (confirm or {}).items())
                where = f"with {keys}" if keys else "on a finer film"
                found = replace(found, confirmed=tuple(again), where=where)
            except NoFinerFilm as why:
                found = replace(found, unconfirmed=str(why))
        found.write(folder)
    return found


def _proposed(trial: Any, factors: Sequence[Factor]) -> dict[str, object]:
    """Return the values that a trial of Optuna proposes, by key."""
    values: dict[str, object] = {}
    for factor in factors:
        if factor.ends is None:
            which = trial.suggest_categorical(factor.name, list(range(len(factor.values))))
            values |= factor.settings(factor.values[which])
        else:
            number = trial.suggest_float(factor.name, *factor.ends)
            values |= factor.settings(factor.of_number(float(f"{number:.{_DIGITS}g}")))
    return values


def _limit(text: str) -> tuple[str, str, float]:
    """Return full name, sign and bound of a limit."""
    try:
        name, sign, bound = _LIMIT.fullmatch(text).groups()  # type: ignore[union-attr]
        limit = float(bound)
    except (AttributeError, ValueError):
        raise ValueError(
            f'a limit must be NAME <= NUMBER, or with >= or ==, as "n_loose == 1", got {text!r}'
        ) from None
    return known_figure(name, UNITS), sign, limit


def _trial(
    run: PlannedRun,
    outcome: Outcome,
    study: Path,
    wanted: str,
    limits: Sequence[tuple[str, str, float]],
) -> Trial:
    folder = str(run.folder(study))
    if outcome.status != "done":
        return Trial(run.values, folder, reason=outcome.reason or outcome.status)
    names, figures = [wanted, *(name for name, _, _ in limits)], outcome.figures
    if not figures.keys() >= {*names}:  # some are of the quality of the cut at the end
        results = read(Path(folder))
        quality = cut_quality(results.frame(-1)).figures() if results.n_frame else {}
        figures = {**quality, **figures}
    try:
        sought, *keys = (figure_name(name, figures) for name in names)
    except ValueError as problem:
        why = f"; no steady window: {figures['no_window']}" if "no_window" in figures else ""
        lacks = (figures.get(no_mean_of(name)) for name in names)
        why += "".join(f"; {one}" for one in lacks if one)
        return Trial(run.values, folder, reason=f"{problem}{why}")
    limited = {key: float(figures[key]) for key in keys}
    missed = 0.0
    for key, (_, sign, bound) in zip(keys, limits, strict=True):
        beyond = limited[key] - bound
        missed += {"<=": max(beyond, 0.0), ">=": max(-beyond, 0.0), "==": abs(beyond)}[sign]
    figure, spread = _size(sought, float(figures[sought])), figures.get(half_width_of(sought))
    return Trial(run.values, folder, figure, missed, "", limited, outcome.doubts, spread)


def _size(name: str, value: Any) -> Any:
    """Return what is sought of a value: a least peak is one near zero, not the most negative."""
    return abs(value) if PEAK in name else value


def _in_common(trials: Sequence[Trial], figure: str) -> tuple[Trial, ...]:
    """Return trials with their means over the steady window that they have in common, if any."""
    folders = [Path(one.folder) for one in trials]
    outcomes = {k: outcome_in(one) or Outcome("stopped") for k, one in enumerate(folders)}
    found = CommonWindow(folders.__getitem__)(outcomes)
    if any(NOT_COMMON in one.figures or figure not in one.figures for one in found.values()):
        return ()
    means = [_size(figure, float(one.figures[figure])) for one in found.values()]
    spreads = [one.figures.get(half_width_of(figure)) for one in found.values()]
    return tuple(
        replace(one, figure=mean, half_width=spread)
        for one, mean, spread in zip(trials, means, spreads, strict=True)
    )
