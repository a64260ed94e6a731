"""Means of several runs over the one window in which all of them cut steadily."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

from shellcut.results.run_results import history_in
from shellcut.results.steady_window import Range, SteadyWindow, steady_figures

from .one_run import Outcome

NOT_COMMON = "no_common_window"
"""Figure that says why a mean is over the run's own window."""


class CommonWindow:
    """Bring the means of runs to their common window; what was read of a run is kept.

    ``folder_of`` takes the number of a run.
    """

    def __init__(self, folder_of: Callable[[int], Path]) -> None:
        self._folder_of = folder_of
        self._figures = cache(self._read)

    def __call__(self, outcomes: Mapping[int, Outcome]) -> dict[int, Outcome]:
        """Return the outcomes of some runs with their means over the window that all have.

        A run without a window of its own has no part in it. Where they have none in common, or some
        are not steady in it, each keeps the means over its own, and :data:`NOT_COMMON` says why.
        """
        common = dict(outcomes)
        for unit in ("deg", "mm"):
            first, last = f"window_from_{unit}", f"window_to_{unit}"
            own = {
                number: (one.figures[first], one.figures[last])
                for number, one in outcomes.items()
                if {first, last} <= one.figures.keys()
            }
            if len(set(own.values())) < 2:
                continue
            between = max(low for low, _ in own.values()), min(high for _, high in own.values())
            found, why = self._means(list(own), between, unit)
            for number, ends in own.items():
                figures = found.get(number)
                if figures is None:
                    own_window = SteadyWindow(*ends).text(unit)
                    said = f"the mean is over its own window, {own_window}: {why}"
                    figures = {NOT_COMMON: said}
                figures = {**outcomes[number].figures, **figures}
                common[number] = replace(outcomes[number], figures=figures)
        return common

    def _means(
        self, runs: list[int], between: Range, unit: str
    ) -> tuple[dict[int, dict[str, Any]], str]:
        """Return the values of all runs in their common window, or none of them and why."""
        if between[0] >= between[1]:
            return {}, "the runs have none in common"
        found = {}
        for number in runs:
            found[number] = self._figures(number, between)
            if why := found[number].get("no_window"):
                common = SteadyWindow(*between).text(unit)
                return {}, f"in that of all runs, {common}, run {number} has none, {why}"
        return found, ""

    def _read(self, number: int, between: Range) -> dict[str, Any]:
        history, units = history_in(self._folder_of(number))
        if not history:
            return {"no_window": "its history is missing"}
        _, x, resistance, *_ = history
        return steady_figures(history, (x, units[x]), (resistance, units[resistance]), between)
