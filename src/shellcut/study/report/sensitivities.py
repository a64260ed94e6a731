"""Which factor matters: Sobol' indices of the response surfaces, with their intervals."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape

import numpy as np

from shellcut.report.markup import missing, table
from shellcut.study.surrogate.sensitivity import Indices

from .analysis import Analysed
from .surfaces import with_unit

_CLEAR = 0.5
"""Explained share below which the indices are those of a poor surface."""


def sensitivities(analyses: Sequence[Analysed]) -> str:
    """Return the indices of each figure, or why there are none."""
    if not analyses:
        return ""
    parts = [_of_figure(one) for one in analyses]
    if any(one.indices for one in analyses):
        parts.insert(0, _meaning())
    return "".join(parts)


def _meaning() -> str:
    said = (
        "The first-order index of a factor is the share of the figure's variance that would go if "
        "the factor were known. The total index adds its share of what it does together with "
        "others; where both are the same, it acts by itself. Factors vary independently and evenly "
        "over their ranges, each name of a list as often. The intervals hold 95 % of the surfaces "
        "that the runs also allow, and the sampling of the indices. They hold only as far as the "
        "surface does: see its error. They take how fast it bends along each factor as known, so "
        "an interval from 0 to 0 only says that no influence was seen."
    )
    return f"<p>{escape(said)}</p>"


def _of_figure(one: Analysed) -> str:
    title = f"<h3>{escape(one.figure.name)}</h3>"
    if one.fitted is None:
        return title + missing(f"No sensitivities: {one.why}.")
    if len(one.factors) == 1:
        return title + missing(
            f"One factor only, {one.factors[0].name}: what the figure varies by is due to it, or "
            "is noise; see the main effect."
        )
    if one.indices is None:
        return title + missing(
            "No sensitivities: the surface predicts unseen runs no better than their mean."
        )
    indices, fitted = one.indices, one.fitted
    rows = [
        (
            factor.name,
            _interval(indices.first[k], indices.first_interval[k]),
            _interval(indices.total[k], indices.total_interval[k]),
        )
        for k, factor in enumerate(one.factors)
    ]
    rest = (
        f"From {fitted.surface.kind} through {fitted.n_run} runs, which predicts unseen runs to "
        f"{with_unit(fitted.error, one.figure.unit)} (rms; their mean does to "
        f"{with_unit(fitted.mean_error, one.figure.unit)}); {indices.n_draw} surfaces at "
        f"{indices.n_point} points."
    )
    if fitted.explained < _CLEAR:
        rest += " That is a poor surface: the indices are a hint, not a measure."
    head = ("factor", "first order", "total")
    return (
        f'{title}<div class="beside">{table(rows, head)}{_bars(one, indices)}</div>'
        f'<p class="caption">{escape(rest)}</p>'
    )


def _interval(value: float, ends: np.ndarray[tuple[int], np.dtype[np.float64]]) -> str:
    return f"{value:.2f} ({ends[0]:.2f} to {ends[1]:.2f})"


def _bars(one: Analysed, indices: Indices) -> str:
    """Return both indices of each factor as bars with their intervals."""
    left, right, row = 130.0, 340.0, 40.0
    height = row * len(one.factors) + 24.0
    parts = []
    for share in (0.0, 0.25, 0.5, 0.75, 1.0):
        x = left + share * (right - left)
        parts.append(f'<line class="grid" x1="{x:.1f}" x2="{x:.1f}" y1="4" y2="{height - 20:g}"/>')
        parts.append(f'<text class="tick x" x="{x:.1f}" y="{height - 4:g}">{share:g}</text>')
    for k, factor in enumerate(one.factors):
        top = 6.0 + row * k
        name = factor.name if len(factor.name) <= 17 else f"{factor.name[:16]}…"
        parts.append(
            f'<text class="tick y" x="{left - 8:g}" y="{top + 15:g}">{escape(name)}</text>'
        )
        both = ((indices.first, indices.first_interval), (indices.total, indices.total_interval))
        for n, (value, interval) in enumerate(both):
            y = top + 14.0 * n
            low, high = (left + min(end, 1.0) * (right - left) for end in interval[k])
            width = min(value[k], 1.0) * (right - left)
            style = ("first", "total")[n]
            place = f'x="{left:g}" y="{y:g}" width="{width:.1f}" height="12"'
            ends = f'x1="{low:.1f}" x2="{high:.1f}" y1="{y + 6:g}" y2="{y + 6:g}"'
            parts.append(f'<rect class="bar-{style}" {place}/><line class="reach" {ends}/>')
    described = f"Sobol' indices of {one.figure.name}"
    keys = (
        '<ul class="legend"><li><span class="spot bar-first"></span>first order</li>'
        '<li><span class="spot bar-total"></span>total</li></ul>'
    )
    return (
        f'<figure class="panel-plot">{keys}<svg viewBox="0 0 360 {height:g}" role="img" '
        f'aria-label="{escape(described)}">{"".join(parts)}</svg></figure>'
    )
