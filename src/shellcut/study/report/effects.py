"""Main effects: each figure over each factor. And pairs: each figure over each other one."""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from html import escape

import numpy as np

from shellcut.arrays import Bools
from shellcut.report.chart import MOST_POINTS, Axis, panel
from shellcut.report.markup import legend, missing
from shellcut.unit import after

from .analysis import Analysed
from .colouring import coloured_by
from .studied import Study

_N_PLACE = 25  # along a factor
_N_OTHER = 128  # points of the other factors over which a surface is averaged


def main_effects(study: Study, analyses: Sequence[Analysed]) -> str:
    """Return a row of pictures for each figure: the runs, and what the factor does by itself."""
    parts = []
    for one in analyses:
        if not one.varies:
            parts.append(missing(f"{one.figure.name}: {one.why}."))
            continue
        pictures = "".join(_effect(study, one, k) for k in range(len(one.factors)))
        parts.append(f'<div class="panels">{pictures}</div>')
    if not parts:
        return ""
    drawn = [one for one in analyses if one.predicts]
    said = "Each point is a run; point at it to read its number and inputs."
    if any(one.rows.sum() > MOST_POINTS for one in analyses):
        said += f" Of so many runs, up to {MOST_POINTS} are drawn, evenly chosen."
    if drawn:
        said += " The line is the mean of the response surface over all other factors."
    if weak := [one.figure.name for one in analyses if one.varies and not one.predicts]:
        said += f" No line where no surface predicts the figure: {'; '.join(weak)}."
    return "".join(parts) + f'<p class="caption">{escape(said)}</p>'


def _effect(study: Study, one: Analysed, k: int) -> str:
    factor = one.factors[k]
    x = Axis(factor.name, factor.unit, factor.values[one.rows], factor.names)
    y = Axis(one.figure.name, one.figure.unit, one.figure.values[one.rows])
    lines = []
    if one.predicts and one.surface is not None:  # what the factor does by itself
        places = np.linspace(*factor.ends, len(factor.names) or _N_PLACE)
        lines = [(places, one.surface.mean_over_others({k: places}, _N_OTHER), "effect")]
    return panel(x, y, said_of(study, one.rows), lines=lines, hollow=study.doubted[one.rows])


def said_of(study: Study, rows: Bools) -> list[str]:
    """Return what pointing at each of some runs says: its number and inputs."""
    said = []
    for row in np.flatnonzero(rows).tolist():
        inputs = []
        for f in study.inputs:
            text = f.texts[row] if f.names else f"{f.values[row]:.5g}{after(f.unit)}"
            inputs.append(f"{f.name} {text}")
        doubted = ", distrusted" * bool(study.doubted[row])
        said.append(f"run {study.numbers[row]}{doubted}: {', '.join(inputs)}")
    return said


def pairs(study: Study, analyses: Sequence[Analysed]) -> str:
    """Return each figure over each other one: what is gained in one and lost in another."""
    varying = [one for one in analyses if one.varies]
    pictures = []
    for a, b in itertools.combinations(varying, 2):
        both = a.rows & b.rows
        if both.sum() < 2:
            continue
        by = coloured_by(a.factors[0], both)
        pictures.append(
            panel(
                Axis(a.figure.name, a.figure.unit, a.figure.values[both]),
                Axis(b.figure.name, b.figure.unit, b.figure.values[both]),
                said_of(study, both),
                colors=[by.color(int(group)) for group in by.group],
                hollow=study.doubted[both],
            )
        )
    if not pictures:
        return missing("No pairs: two figures of two runs are needed.") if analyses else ""
    by = coloured_by(varying[0].factors[0], varying[0].rows)
    keys = legend((name, by.color(k)) for k, name in enumerate(by.names))
    return f'{keys}<div class="panels">{"".join(pictures)}</div>'
