"""Which factor matters: Sobol' indices of the response surfaces, with their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from shellcut.report.chart import Axis, panel
from shellcut.report.markup import legend, missing, table
from shellcut.study.surrogate import Indices
from shellcut.unit import after
from shellcut.view.curves import PALETTE

from .analysis import Analysed

_CLEAR = 0.5
"""Explained share below which the indices are those of a poor surface."""

_MEANING = (
    "How much of a figure's scatter comes from which factor. The first-order index is the share of "
    "the variance that would go if this factor did not vary. The total index adds what the factor "
    "does together with others; where both are the same, it acts alone. All factors are taken to "
    "vary independently and evenly over their ranges. The interval holds 95 % of the surfaces that "
    "fit the runs as well. The indices are only as good as the surface: see its error. An interval "
    "from 0 to 0 says that no influence was seen."
)


def sensitivities(analyses: Sequence[Analysed]) -> str:
    """Return the indices of each figure, or why there are none."""
    if not analyses:
        return ""
    parts = [_of_figure(one) for one in analyses]
    if any(one.indices for one in analyses):
        parts.insert(0, f"<p>{escape(_MEANING)}</p>")
    return "".join(parts)


def _of_figure(one: Analysed) -> str:
    title = f"<h3>{escape(one.figure.name)}</h3>"
    if one.surface is None:
        return title + missing(f"No sensitivities: {one.why}.")
    if len(one.factors) == 1:
        return title + missing(
            f"One factor only, {one.factors[0].name}: it makes all of the scatter that is no "
            "noise; see the main effect."
        )
    if one.indices is None:
        return title + missing(
            "No sensitivities: the surface predicts unseen runs no better than their mean."
        )
    indices, surface, unit = one.indices, one.surface, after(one.figure.unit)
    rows = []
    for k, factor in enumerate(one.factors):
        first = _interval(indices.first[k], indices.first_interval[k])
        rows.append((factor.name, first, _interval(indices.total[k], indices.total_interval[k])))
    rest = (
        f"From a surface through {surface.n_run} runs, which predicts unseen runs to "
        f"{surface.error:.3g}{unit} (rms; their mean does to {surface.mean_error:.3g}{unit}); "
        f"{indices.n_draw} surfaces at "
        f"{indices.n_point} points."
    )
    if surface.explained < _CLEAR:
        rest += " That is a poor surface: the indices are a hint, not a measure."
    head = ("factor", "first order", "total")
    return (
        f'{title}<div class="beside">{table(rows, head)}{_indices(one, indices)}</div>'
        f'<p class="caption">{escape(rest)}</p>'
    )


def _interval(value: float, ends: np.ndarray[tuple[int], np.dtype[np.float64]]) -> str:
    return f"{value:.2f} ({ends[0]:.2f} to {ends[1]:.2f})"


def _indices(one: Analysed, indices: Indices) -> str:
    """Return both indices of each factor with their intervals."""
    names = tuple(factor.name for factor in one.factors)
    places = np.arange(len(names))[::-1]
    both = (
        (0.12, indices.first, indices.first_interval),
        (-0.12, indices.total, indices.total_interval),
    )
    values = np.concatenate([value for _, value, _ in both])
    rows = np.concatenate([places + off for off, _, _ in both])
    lines = [
        (np.minimum(ends, 1.0), np.full(2, place + off), "mean")
        for off, _, intervals in both
        for place, ends in zip(places, intervals, strict=True)
    ]
    n = len(names)
    colors = [PALETTE[0]] * n + [PALETTE[5]] * n
    keys = legend([("first order", PALETTE[0]), ("total", PALETTE[5])])
    said = [f"{names[k % n]}: {value:.2f}" for k, value in enumerate(values.tolist())]
    picture = panel(
        Axis("share of the variance", "", values, ends=(0.0, 1.0)),
        Axis("", "", rows, names[::-1]),
        said,
        colors=colors,
        lines=lines,
    )
    return f"<div>{keys}{picture}</div>"
