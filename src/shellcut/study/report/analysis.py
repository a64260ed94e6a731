"""What follows from the runs for each figure: a surface, its error, sensitivities, or why not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.study.surrogate import (
    Indices,
    Surface,
    fewest_runs,
    is_constant,
    is_there,
    sobol_indices,
)

from .studied import FigureOfRuns, Studied, Study

_UNSEEN = 0.15
"""Part of a factor's range at its end that is too large to be left without runs."""

_NOTHING = 0.0
"""Explained share up to which a surface is no better than the mean."""


@dataclass(frozen=True)
class Analysed:
    """A figure of interest with what the runs say about it."""

    figure: FigureOfRuns
    rows: Bools
    """Runs that have the figure, shape (n_run,)."""
    factors: tuple[Studied, ...]
    """Those that vary over these runs, in the order of the surface's inputs."""
    surface: Surface | None
    """With its error."""
    indices: Indices | None
    """Its sensitivities."""
    why: str
    """Why there is no surface; "" if there is one."""

    @property
    def varies(self) -> bool:
        """Whether the figure and a factor differ from run to run."""
        figure = self.figure.values[self.rows]
        return len(figure) > 1 and bool(self.factors) and not is_constant(figure)

    @property
    def unseen(self) -> tuple[tuple[Studied, float, float], ...]:
        """Factors with a part of their range in which no run has the figure, and its ends."""
        found = []
        for one in self.factors:
            if one.names or not one.varies:
                continue
            low, high = one.ends
            seen = one.values[self.rows]
            for end, near in ((low, seen.min()), (high, seen.max())):
                if abs(end - near) > _UNSEEN * (high - low):
                    found.append((one, min(end, float(near)), max(end, float(near))))
        return tuple(found)

    @property
    def predicts(self) -> bool:
        """Whether there is a surface that is better than the mean."""
        return self.surface is not None and self.surface.explained > _NOTHING


def analysed(study: Study, figure: FigureOfRuns) -> Analysed:
    """Return what the runs say about a figure."""
    rows = study.done & np.isfinite(figure.values)
    factors = tuple(one for one in study.factors if rows.any() and np.ptp(one.values[rows]) > 0.0)
    if why := _why_no_surface(figure.values[rows], factors):
        return Analysed(figure, rows, factors, None, None, why)
    places = np.column_stack([one.values[rows] for one in factors])
    surface = Surface(factors, places, figure.values[rows])
    indices = None
    if surface.explained > _NOTHING and len(factors) > 1:
        indices = sobol_indices(surface)
    return Analysed(figure, rows, factors, surface, indices, "")


def _why_no_surface(figure: Floats, factors: Sequence[Studied]) -> str:
    n = len(figure)
    if n == 0:
        return "no run has this figure"
    if n == 1:
        return "one run has this figure, and a surface needs several"
    if not factors:
        return f"no factor varies over the {n} runs that have this figure"
    if is_constant(figure):
        return f"it is {figure[0]:.6g} in all {n} runs, so nothing influences it here"
    if n < (least := fewest_runs(factors)):
        over = f"{len(factors)} factor" + "s" * (len(factors) > 1)
        return f"a surface over {over} needs {least} runs or more, and {n} have this figure"
    values = np.unique(figure)
    if len(values) == 2:
        return (
            f"it takes two values only, {values[0]:.5g} and {values[1]:.5g}: it jumps, and no "
            "smooth surface describes that"
        )
    return "" if is_there() else "it needs scikit-learn, pip install 'shellcut[study]'"
