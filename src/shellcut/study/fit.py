"""Fit parameters of a model to measured curves, in as few runs as it takes.

docs/howto/fit.md describes both methods; the misfit is that of :mod:`.curve_misfit`. All runs of a
derivative go to the engine together. A global fit adds the least of its surface as a point, until
that lies within a step of a run.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
import scipy

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.files.file_list import folder_named
from shellcut.recording.resistance import resistance_of

from .curve_misfit import FitCurve, read_curves
from .engines import AnyExecutor, Say, engine_of
from .fit_result import FIT, PICTURE, FitResult, result_of
from .fit_runs import Done, FitRuns, FreeParameters, OutOfRuns
from .plan import sought
from .study import run_values, taken

Method = Literal["local", "global"]

_STEP = 0.08
"""Of the differences, in the logarithm of a parameter."""

_CLOSE = 2e-3
"""Relative change of the parameters at which the fit has arrived: a tenth of what data can tell."""

_SPREAD = 0.4
"""Of the runs, that a global fit spreads over the box."""


@checked
@dataclass(frozen=True)
class Search:
    """How a fit looks for the best values.

    Examples
    --------
    >>> Search(method="global").max_runs
    40
    """

    keep_energy: Annotated[
        bool,
        Option("", "keep the fracture energy of the law: the last key with a range follows"),
    ] = False
    max_runs: Annotated[int, Option("", "runs to take at most", least=1)] = 40
    method: Annotated[
        Method,
        Option("", "least squares from the model's values, or a search of all within the ranges"),
    ] = "local"


def fit(
    model: str | os.PathLike[str],
    curves: Sequence[FitCurve],
    out: str | os.PathLike[str],
    *,
    settings: Mapping[str, object] | None = None,
    search: Search | None = None,
    executor: AnyExecutor = None,
    say: Say = None,
) -> FitResult:
    """Fit keys of a model to measured curves.

    Parameters
    ----------
    curves : sequence of FitCurve
        What was measured; each may have settings of its own, then it takes a run of its own.
    out : str or path
        Folder for the runs and the result.
    settings : mapping
        By key: one value for all runs; or a range above zero, as ``"8:16"`` or ``"1 mm : 2 mm"``,
        in which the key is fitted. It starts at the value of the model, or in the geometric middle
        of the range if the model has none in it. At least one key must be fitted.
    search : Search, optional
        Method, and how many runs it may take.
    model, executor, say
        As of :func:`shellcut.sweep`.

    Returns
    -------
    FitResult
        Values with 95 % confidence intervals, and in words how far the data tell them.

    Raises
    ------
    ModelFileError, ValueError
        With what is wrong with model, settings or curves, before anything runs.
    FileExistsError
        If a file of the fit in the folder is somebody else's.
    RuntimeError
        If the run at the start fails.

    Examples
    --------
    >>> found = fit(
    ...     "opening", [FitCurve("cap.csv")], "fitted", settings={"cohesive.plateau": "8:16"}
    ... )  # doctest: +SKIP
    >>> found.values[0].value, found.values[0].low, found.values[0].high  # doctest: +SKIP
    (12.02, 11.9, 12.13)
    """
    search = search or Search()
    factors, variants = sought(model, settings)
    parameters = FreeParameters(variants, factors, keep_energy=search.keep_energy)
    free = [one.key for one in parameters.all]
    names = {name: key for key in free for name in (key, key.rpartition(".")[2])}
    if problems := [
        f"{names[key]} is fitted, so a curve must not set it, got {key} = {value}"
        for curve in curves
        for key, value in curve.settings.items()
        if key in names
    ]:
        raise ValueError("\n".join(dict.fromkeys(problems)))
    least = len(parameters.varied) + 2
    if search.max_runs < least:
        raise ValueError(f"max_runs must be {least} or more with these keys, got {search.max_runs}")
    case = variants.read({}).build()
    measured = read_curves(curves, resistance_of(case.simulation, case.duration))
    engine, folder = engine_of(executor), folder_named(out)

    def run(several: Sequence[Mapping[str, object]]) -> Done:
        done = run_values(variants, several, folder, engine, say)
        return [(outcome, one.folder(folder)) for one, outcome in done]

    with taken(folder, [FIT, PICTURE]):
        runs = FitRuns(parameters, measured, run, search.max_runs)
        runs.begin()
        try:
            (_locally if search.method == "local" else _globally)(runs)
            ended = "the parameters no longer change"
        except OutOfRuns:
            ended = f"max_runs, {search.max_runs}, are used up"
        # For the intervals, whatever runs that takes.
        slopes = runs.slopes(runs.best(), _STEP, beyond=True)
        found = result_of(runs, slopes, ended)
        found.write(folder)
    return found


def _locally(runs: FitRuns, start: Floats | None = None) -> None:
    """Take SciPy's least squares from a start."""
    low, high = runs.parameters.bounds()
    scipy.optimize.least_squares(
        runs.residuals,
        np.zeros(low.size) if start is None else start,
        # A key whose effect no run shows stays where it is in this step.
        jac=lambda logs: np.nan_to_num(runs.slopes(logs, _STEP)),
        bounds=(low, high),
        xtol=_CLOSE,
        ftol=1e-4,
        gtol=1e-8,
        x_scale=1.0,
    )


def _globally(runs: FitRuns) -> None:
    """Search the box on a surface through the residuals of the runs."""
    low, high = runs.parameters.bounds()
    n_spread = max(2 * low.size + 1, int(_SPREAD * runs.left))
    cube = scipy.stats.qmc.LatinHypercube(low.size, seed=0).random(n_spread)
    points = [np.zeros(low.size), *(low + cube * (high - low))]
    runs.several(points)
    while True:
        tried = np.array(list(runs.tried))
        missed = np.array([one.residuals for one in runs.tried.values()])
        surface = scipy.interpolate.RBFInterpolator(tried, missed, kernel="thin_plate_spline")
        found = scipy.optimize.differential_evolution(
            lambda logs, s=surface: float(np.sum(s(logs[None])[0] ** 2)),
            list(zip(low, high, strict=True)),
            seed=0,
        )
        nearest = float(np.abs(tried - found.x).max(axis=1).min())
        runs.residuals(found.x)
        if nearest < _STEP:  # the basin is found; a surface would creep to its bottom
            _locally(runs, runs.best())
            return
