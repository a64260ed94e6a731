"""Error bars of a model: its companion runs as a study, and what follows from them."""

from __future__ import annotations

import importlib.util
import os
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from typing import TYPE_CHECKING

from shellcut.files.file_list import claim, folder_named
from shellcut.model_file import read_model
from shellcut.results.error_bars import ERROR_BARS, PICTURE, ErrorBars, error_bar
from shellcut.view import draw_curves

from .companions import companions_of
from .engines import engine_of
from .plan import Definition
from .report.studied import of_interest
from .study import FEW_FILES, run_study

if TYPE_CHECKING:
    from distributed import Client


def converge(
    model: str | os.PathLike[str],
    out: str | os.PathLike[str],
    *,
    figures: Sequence[str] = (),
    settings: Mapping[str, object] | None = None,
    executor: int | Executor | Client | None = None,
    say: Callable[[str], None] | None = None,
) -> ErrorBars:
    """Run a model with its companions, and return its figures with error bars.

    The companions have a coarser and a finer mesh, nodes elsewhere under the path, half the speed,
    and two other small shapes of the film: together they take ten times the time of the model. They
    are a study in ``out``: what is done is found again, what was interrupted goes on.

    Parameters
    ----------
    model : str or path
        Model file, or name of a shipped model.
    out : str or path
        Folder for the runs, ``error_bars.json`` and, with Matplotlib, ``error_bars.png``.
    figures : sequence of str, optional
        Names in ``summary.json``; by default means and peaks of torque or force, crack length and
        work.
    settings : mapping, optional
        Keys with another value than in the model.
    executor, say
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
        If it has none of the figures.

    Examples
    --------
    >>> found = converge("guillotine", "bars", figures=["force_plateau_N"])  # doctest: +SKIP
    >>> print(found)  # doctest: +SKIP
    """
    folder = folder_named(out)
    given = {**FEW_FILES, **(settings or {})}
    companions, missing = companions_of(read_model(model, given))
    names = list(companions[0].settings)
    rows = [[one.settings[name] for name in names] for one in companions]
    linked = {", ".join(names): rows if len(names) > 1 else [value for (value,) in rows]}
    plan = Definition(str(model), linked, given, figures=tuple(figures)).plan()
    found = run_study(plan, folder, engine_of(executor), say)
    first, *others = (found.outcomes.get(run.number) for run in plan.runs)
    if first is None or first.status != "done":
        raise RuntimeError(f"the run as given must be done, got: {first and first.reason}")
    each = [one.figures if one is not None else {} for one in (first, *others)]
    runs = tuple(one.run for one in companions)
    for run, outcome in zip(runs[1:], others, strict=True):
        if outcome is None or outcome.status != "done":
            why = f"the run {run.name} is not done: {outcome.reason if outcome else ''}"
            missing[run.part] = "; ".join(filter(None, (missing.get(run.part), why)))
    chosen, _ = of_interest(figures, first.figures)
    if not chosen:
        known = ", ".join(n for n, v in first.figures.items() if isinstance(v, float))
        raise ValueError(f"the run must have one of the figures, got those of {known}")
    bars = tuple(error_bar(n, runs, [one.get(n) for one in each]) for n in chosen)
    bars_found = ErrorBars(plan.runs[0].key, runs, bars, missing)
    claim(folder, [ERROR_BARS, PICTURE])
    bars_found.write(folder / ERROR_BARS)
    if importlib.util.find_spec("matplotlib") is not None:
        diagrams = [bars_found.diagram(bar) for bar in bars]
        draw_curves(folder / PICTURE, diagrams, size=(7.0, 0.6 + 2.6 * len(bars)))
    return bars_found
