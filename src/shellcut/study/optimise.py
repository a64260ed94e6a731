"""The best values of some keys: the least or the largest of a figure, within limits on others.

Optuna's tree-structured Parzen estimator proposes values, four sets at a time, and is told what
their runs gave; the first set is that of the model. It starts from one seed and the number of sets
does not depend on the number of processes. So a search that is called again proposes the same runs,
finds those done by the hashes of their inputs, and goes on where it was ended.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from shellcut.files.file_list import folder_named
from shellcut.files.whole_file import write_text
from shellcut.model_file.reader import ModelVariants
from shellcut.results.cut_quality import UNITS, cut_quality
from shellcut.results.run_results import read
from shellcut.results.summary_figures import (
    figure_name,
    known_figure,
    label_of,
    unit_of,
    with_unit,
)
from shellcut.view import Curve, Diagram, can_draw, draw_curves

from .engines import engine_of
from .factors import Factor, factors_of
from .one_run import Outcome
from .plan import PlannedRun
from .study import FEW_FILES, run_values, taken

if TYPE_CHECKING:
    from distributed import Client

OPTIMUM, PICTURE = "optimum.json", "optimum.png"

_AT_A_TIME = 4  # sets proposed before their results are told: keeps four processes busy
_DIGITS = 4  # of a value: nobody makes a tooth more precisely
_LIMIT = re.compile(r"\s*(\w+)\s*(<=|>=|==)\s*([-+.\deE]+)\s*")


@dataclass(frozen=True)
class Trial:
    """A set of values and what its run gave."""

    values: Mapping[str, object]
    """By key; those of the model are empty."""
    folder: str
    """Of the run."""
    figure: float | None = None
    """What is sought; None if the run failed."""
    missed: float = 0.0
    """How far it is beyond the limits, in their units, together; 0 within all."""
    reason: str = ""
    """Why it failed."""


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
    """The first and the best again, with the settings that confirm them."""

    @property
    def best(self) -> Trial | None:
        """The best within all limits; None if there is none."""
        return min(
            (one for one in self.trials if one.figure is not None and one.missed == 0.0),
            key=lambda one: self.sign * (one.figure or 0.0),
            default=None,
        )

    def __str__(self) -> str:
        """Return the best values, and how much better than the model they are."""
        best, n_failed = self.best, sum(one.figure is None for one in self.trials)
        if best is None:
            each = ((k, one) for k, one in enumerate(self.trials, 1) if one.figure is not None)
            k, near = min(each, key=lambda one: one[1].missed)
            return (
                f"none of {len(self.trials)} runs keeps to {', '.join(self.limits)}; the nearest, "
                f"run {k}, misses by {near.missed:.4g}: loosen the limit, widen the ranges, or "
                "take more runs"
            )
        lines = [f"{key} = {value}" for key, value in best.values.items()]
        lines = lines or ["the model as given is the best"]
        lines.append(self._against(self.trials[0], best))
        if len(self.confirmed) == 2:
            lines.append(f"confirmed: {self._against(*self.confirmed)}")
        failed = f", {n_failed} of them failed" if n_failed else ""
        return "\n".join([*lines, f"{len(self.trials)} runs{failed}"])

    def _against(self, start: Trial, best: Trial) -> str:
        name = label_of(self.figure, "the steady window")
        if start.figure is None or best.figure is None:
            return f"{name}: {start.reason or best.reason}"
        change = 100.0 * (best.figure / start.figure - 1.0) if start.figure else float("nan")
        beyond = "" if best.missed == 0.0 else f", beyond the limits by {best.missed:.3g}"
        return (
            f"{name}: {with_unit(self.figure, start.figure)} as given, "
            f"{with_unit(self.figure, best.figure)} at best ({change:+.1f} %){beyond}"
        )

    def write(self, folder: Path) -> None:
        """Write ``optimum.json`` and, with Matplotlib, ``optimum.png``."""
        write_text(folder / OPTIMUM, json.dumps(asdict(self), indent=1, default=str) + "\n")
        if can_draw():
            draw_curves(folder / PICTURE, [self.diagram()], size=(8.0, 4.5))

    def diagram(self) -> Diagram:
        """Return the figure of each run over its number, and the best so far."""
        n = np.arange(1.0, len(self.trials) + 1.0)
        values = np.array([np.nan if t.figure is None else t.figure for t in self.trials])
        within = np.array([t.missed == 0.0 for t in self.trials]) & ~np.isnan(values)
        least = np.minimum.accumulate(np.where(within, self.sign * values, np.inf))
        curves = [
            Curve("beyond the limits", np.where(within, np.nan, values), "p4"),
            Curve("within", np.where(within, values, np.nan), "p0"),
            Curve("best so far", np.where(np.isinf(least), np.nan, self.sign * least)),
        ]
        name = label_of(self.figure, "the steady window")
        unit = unit_of(self.figure)
        return Diagram(n, curves, "run", "", name, unit, zero=False)


def optimise(
    model: str | os.PathLike[str],
    keys: Mapping[str, object],
    out: str | os.PathLike[str],
    *,
    minimise: str = "",
    maximise: str = "",
    subject_to: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    confirm: Mapping[str, object] | None = None,
    max_runs: int = 60,
    executor: int | Executor | Client | None = None,
    say: Callable[[str], None] | None = None,
) -> Optimum:
    """Seek the values of some keys that make a figure least, or largest.

    Parameters
    ----------
    model : str or path
        Model file, or name of a shipped model.
    keys : mapping
        Keys with a range, as ``"40:80"``, or values to choose from, as of :func:`shellcut.sweep`.
    out : str or path
        Folder for the runs, ``optimum.json`` and, with Matplotlib, ``optimum.png``.
    minimise, maximise : str
        One of them: a figure of ``summary.json`` or of :class:`shellcut.CutQuality` at the end, as
        ``torque_peak_Nmm``; its unit may be left out.
    subject_to : sequence of str
        Limits on such figures: ``"n_loose == 1"``, ``"crack_length >= 58"``.
    settings, confirm : mapping, optional
        Keys with another value than in the model; in all runs, and in two further runs of the model
        as given and of the best values, as on a finer mesh.
    max_runs : int
        Runs to take at most.
    executor, say
        As of :func:`shellcut.sweep`.

    Returns
    -------
    Optimum

    Raises
    ------
    ModelFileError, FolderInUse, FileExistsError, ConnectionError, KeyboardInterrupt
        As of :func:`shellcut.sweep`.
    ValueError
        If keys, figures or limits do not fit.
    RuntimeError
        If the run of the model as given fails.
    ImportError
        If Optuna is not installed.

    Examples
    --------
    >>> found = optimise(  # doctest: +SKIP
    ...     "opening", {"tool.half_thickness": "0.2:0.5"}, "teeth", minimise="torque_peak"
    ... )
    >>> found.best.values  # doctest: +SKIP
    {'tool.half_thickness': 0.2213}
    """
    optuna = _optuna()
    if bool(minimise) == bool(maximise):
        raise ValueError("give either minimise or maximise, the name of a figure")
    if max_runs < 2:
        raise ValueError(f"max_runs must be 2 or more, got {max_runs}")
    limits = [_limit(text) for text in subject_to]
    for name in (minimise or maximise, *(name for name, _, _ in limits)):
        known_figure(name, UNITS)
    factors, single = factors_of(keys)
    if not factors:
        raise ValueError("give at least one key a range low:high, or several values")
    given = {**FEW_FILES, **(settings or {}), **single}
    variants = ModelVariants(model, given)
    for factor in factors:
        for value in factor.probes():
            variants.read(factor.settings(value), try_out=False)
    engine, folder = engine_of(executor), folder_named(out)
    study = optuna.create_study(sampler=optuna.samplers.TPESampler(seed=0))
    sign, wanted, trials = (1 if minimise else -1), minimise or maximise, list[Trial]()

    def run(several: Sequence[Mapping[str, object]], more: Mapping[str, object]) -> list[Trial]:
        these = ModelVariants(model, {**given, **more})
        done = run_values(these, several, folder, engine, say)
        return [_trial(one, outcome, folder, wanted, limits) for one, outcome in done]

    with taken(folder, [OPTIMUM, PICTURE]):
        trials += run([{}], {})
        if trials[0].figure is None:
            raise RuntimeError(f"the model as given must run: {trials[0].reason}")
        while len(trials) < max_runs:
            asked = [study.ask() for _ in range(min(_AT_A_TIME, max_runs - len(trials)))]
            done = run([_proposed(one, factors) for one in asked], {})
            for one, trial in zip(asked, done, strict=True):
                one.set_constraint("limits", trial.missed)
                failed = trial.figure is None
                value = None if trial.figure is None else sign * trial.figure
                study.tell(one, value, optuna.trial.TrialState.FAIL if failed else None)
            trials += done
        figure = figure_name(wanted, _figures(trials[0].folder, [wanted]))
        found = Optimum(figure, sign, tuple(subject_to), tuple(trials))
        if confirm and found.best:
            again = run([{}, found.best.values], confirm)
            found = Optimum(figure, sign, tuple(subject_to), tuple(trials), tuple(again))
        found.write(folder)
    return found


def _optuna() -> Any:
    try:
        import optuna
    except ImportError:
        raise ImportError(
            "a search for the best values needs Optuna: pip install 'shellcut[optimise]'"
        ) from None
    optuna.logging.set_verbosity(optuna.logging.WARNING)
    return optuna


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
    """Return name, sign and bound of a limit."""
    try:
        name, sign, bound = _LIMIT.fullmatch(text).groups()  # type: ignore[union-attr]
        return name, sign, float(bound)
    except (AttributeError, ValueError):
        raise ValueError(
            f'a limit must be FIGURE <= NUMBER, or with >= or ==, as "n_loose == 1", got {text!r}'
        ) from None


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
    names = wanted, *(name for name, _, _ in limits)
    figures = {**_figures(folder, names), **outcome.figures}
    missed = 0.0
    for name, sign, bound in limits:
        beyond = float(figures[figure_name(name, figures)]) - bound
        missed += {"<=": max(beyond, 0.0), ">=": max(-beyond, 0.0), "==": abs(beyond)}[sign]
    return Trial(run.values, folder, float(figures[figure_name(wanted, figures)]), missed)


def _figures(folder: str, names: Iterable[str]) -> dict[str, Any]:
    """Return the summary of a run, and the quality of its cut at the end if a name is of that."""
    results = read(Path(folder))
    figures = dict(results.summary)
    try:
        for name in names:
            figure_name(name, figures)
    except ValueError:
        figures |= cut_quality(results.frame(-1)).figures() if results.n_frame else {}
    return figures
