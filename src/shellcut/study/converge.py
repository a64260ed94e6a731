"""Error bars of a model: its companion runs as a study, and what follows from them."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence

from shellcut.files.file_list import claim, folder_named
from shellcut.model_file import read_model
from shellcut.results.error_bars import ERROR_BARS, PICTURE, ErrorBars, error_bar
from shellcut.results.steady_window import half_width_of
from shellcut.results.summary_figures import known_figure
from shellcut.view import can_draw, draw_curves

from .common_window import NOT_COMMON
from .companions import companions_of
from .engines import AnyExecutor, Say, engine_of
from .one_run import Outcome
from .plan import FEW_FILES, Definition
from .report.studied import of_interest
from .study import run_study


def converge(
    model: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    figures: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    executor: AnyExecutor = None,
    say: Say = None,
) -> ErrorBars:
    """Run a model with its companions, and return its figures with error bars.

    The companions have a coarser and a finer mesh, nodes elsewhere under the path, half the speed,
    and two other small shapes of the film: together they take ten times the time of the model. They
    are a study in ``out``: what is done is found again, what was interrupted goes on.

    Parameters
    ----------
    out : str or path
        Folder for the runs, ``error_bars.json`` and, with Matplotlib, ``error_bars.png``.
    figures : sequence of str, optional
        Names in ``summary.json``; by default means and peaks of torque or force, crack length and
        work.
    model, settings, executor, say
        As of :func:`shellcut.sweep`.

    Returns
    -------
    ErrorBars

    Raises
    ------
    ModelFileError, FolderInUse, FileExistsError, ConnectionError, KeyboardInterrupt
        As of :func:`shellcut.sweep`.
    RuntimeError
        If the run as given fails.
    ValueError
        If it has not the figures.

    Examples
    --------
    >>> found = converge("guillotine", "bars", figures=["force_plateau_N"])  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    """
    figures = [known_figure(name) for name in figures]
    folder = folder_named(out)
    given = {**FEW_FILES, **(settings or {})}
    companions, missing = companions_of(read_model(model, given))
    runs, rows = tuple(companions), [list(keys.values()) for keys in companions.values()]
    names = ", ".join(companions[runs[0]])
    linked = {names: rows if len(rows[0]) > 1 else [value for (value,) in rows]}
    plan = Definition(str(model), linked, given, figures=tuple(figures)).plan()
    claim(folder, [ERROR_BARS, PICTURE])
    outcomes = run_study(plan, folder, engine_of(executor), say).outcomes
    each = [outcomes.get(run.number, Outcome("stopped")) for run in plan.runs]
    if each[0].status != "done":
        raise RuntimeError(f"the run as given must be done: {each[0].reason or each[0].status}")
    for run, one in zip(runs, each, strict=True):
        reasons = [f"{run.name} is distrusted: {doubt}" for doubt in one.doubts]
        if one.status != "done":
            reasons = [f"{run.name} is not done: {one.reason or one.status}"]
        if why := one.figures.get("no_window"):
            reasons.append(f"{run.name} has no mean: {why}")
        if why := one.figures.get(NOT_COMMON):
            reasons.append(f"{run.name}: {why}")
        if reasons:
            missing.setdefault(run.part or "doubts", []).extend(reasons)
    there = {name: v for name, v in each[0].figures.items() if isinstance(v, int | float)}
    chosen, lacking = of_interest(figures, there)
    if lacking or not chosen:
        raise ValueError(f"the run has no {', '.join(lacking)}, but {', '.join(there)}")
    edge = float(there.get("edge_length_mm", 0.0))
    bars = tuple(
        error_bar(n, runs, [one.figures.get(n) for one in each], edge, there.get(half_width_of(n)))
        for n in chosen
    )
    found = ErrorBars(plan.runs[0].key, runs, bars, missing)
    found.write(folder / ERROR_BARS)
    if can_draw():
        size = 7.0, 0.6 + 2.6 * len(bars)
        draw_curves(folder / PICTURE, [found.diagram(bar) for bar in bars], size=size)
    return found
