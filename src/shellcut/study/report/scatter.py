"""Each figure over each factor, a point for every run."""

from __future__ import annotations

from html import escape

import numpy as np

from shellcut.arrays import Bools
from shellcut.report.chart import MOST_POINTS, Axis, panel
from shellcut.report.markup import missing
from shellcut.unit import after

from .studied import Study


def scatter(study: Study) -> str:
    """Return a row of pictures for each figure."""
    parts, most = [], 0
    for figure in study.figures:
        rows = study.done & np.isfinite(figure.values)
        factors = [one for one in study.factors if rows.any() and np.ptp(one.values[rows]) > 0.0]
        if not factors:
            parts.append(missing(f"{figure.name}: no factor varies over the runs that have it."))
            continue
        most, said = max(most, int(rows.sum())), said_of(study, rows)
        y = Axis(figure.name, figure.unit, figure.values[rows])
        pictures = [
            panel(
                Axis(one.name, one.unit, one.values[rows], one.names),
                y,
                said,
                hollow=study.doubted[rows],
            )
            for one in factors
        ]
        parts.append(f'<div class="panels">{"".join(pictures)}</div>')
    if not most:
        return "".join(parts)
    told = "Each point is a run; point at it to read its number and inputs."
    if most > MOST_POINTS:
        told += f" Of so many runs, up to {MOST_POINTS} are drawn, evenly chosen."
    return "".join(parts) + f'<p class="caption">{escape(told)}</p>'


def said_of(study: Study, rows: Bools) -> list[str]:
    """Return what pointing at each of some runs says: its number and inputs."""
    said = []
    for row in np.flatnonzero(rows).tolist():
        inputs = []
        for f in study.inputs:
            text = f.texts[row] if f.names else f"{f.values[row]:.5g}{after(f.unit)}"
            inputs.append(f"{f.name} {text}")
        doubted = ", distrusted" if study.doubted[row] else ""
        said.append(f"run {study.numbers[row]}{doubted}: {', '.join(inputs)}")
    return said
