"""Means of several runs over the one window in which all of them cut steadily."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Any

from shellcut.results.run_results import history_in
from shellcut.results.steady_window import Range, steady_figures

from .one_run import Outcome

_OF_THE_WINDOW = ("window_from_", "window_to_", "dWcoh_", "dW_", "stored_growth_")
"""Start of the names of figures of the window; those of a mean have _plateau_ in them."""


class CommonWindow:
    """Bring the means of runs to their common window; what was read of a run is kept.

    ``folder_of`` takes the number of a run.
    """

    def __init__(self, folder_of: Callable[[int], Path]) -> None:
        self._folder_of = folder_of
        self._found: dict[int, tuple[Range, dict[str, Any]]] = {}

    def __call__(self, outcomes: Mapping[int, Outcome]) -> dict[int, Outcome]:
        """Return the outcomes of some runs with their means over the window that all have.

        A run without a window of its own has no part in it. Where there is no common window, or a
        run is not steady in it, it has no mean, and ``no_window`` says why.
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
            for number, ends in own.items():
                figures = outcomes[number].figures
                kept = {name: value for name, value in figures.items() if not _of_window(name)}
                kept |= self._figures(number, ends, between, unit)
                common[number] = replace(outcomes[number], figures=kept)
        return common

    def _figures(self, number: int, own: Range, between: Range, unit: str) -> dict[str, Any]:
        low, high = between
        if low >= high:
            is_steady = f"this one is steady from {own[0]:.3g} to {own[1]:.3g} {unit}"
            return {"no_window": f"the runs have none in common; {is_steady}"}
        if number not in self._found or self._found[number][0] != between:
            self._found[number] = between, self._read(number, between, unit)
        return self._found[number][1]

    def _read(self, number: int, between: Range, unit: str) -> dict[str, Any]:
        folder = self._folder_of(number)
        history, units = history_in(folder)
        if not history:
            return {"no_window": f"{folder} has no history to read"}
        _, x, resistance, *_ = history
        columns = (x, units[x]), (resistance, units[resistance])
        found = steady_figures(history, *columns, between)
        if why := found.get("no_window"):
            steady = (
                f"all runs together are steady from {between[0]:.3g} to {between[1]:.3g} {unit}"
            )
            return {"no_window": f"{steady}, too little for this one: {why}"}
        return found


def _of_window(figure: str) -> bool:
    return figure.startswith(_OF_THE_WINDOW) or "_plateau_" in figure
