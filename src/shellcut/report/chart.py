"""Curves as inline SVG: sharp on paper, dark in the dark, no library.

Words that must be readable on a phone (legend, axis names) are HTML around the SVG; of its own it
has the numbers at the ticks only.
"""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
import numpy.typing as npt

Floats = npt.NDArray[np.float64]

_WIDTH = 720.0
_LEFT, _RIGHT, _TOP, _BOTTOM = 62.0, 14.0, 12.0, 30.0
_COLUMNS = 500  # steps that a curve is drawn in: about the pixels there are
_ROUND_OFF = 0.01  # below zero by this part of the top gets no room of its own
_N_READ = 400  # points that can be read off


@dataclass(frozen=True)
class Curve:
    """One line, or with ``area`` one layer of the stack; ``style`` is a class in ``page.css``."""

    name: str
    values: Floats
    style: str
    area: bool = False


def chart(
    x: Floats,
    curves: Sequence[Curve],
    *,
    x_name: str,
    x_unit: str,
    name: str,
    unit: str,
    described: str,
    height: float = 300.0,
) -> str:
    """Return a ``<figure>`` with legend, curves and what is needed to read values off.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Ascending, n of two at least.
    curves : sequence of Curve
        Areas are stacked in their order, lines drawn over them. Curves of one name share a place
        in the legend.
    x_name, x_unit, name, unit : str
        Of the axes; units as people write them.
    described : str
        What those hear or read who do not see the picture.
    """
    areas = [curve for curve in curves if curve.area]
    stack = np.cumsum([np.zeros_like(x), *(curve.values for curve in areas)], axis=0)
    lines = [curve for curve in curves if not curve.area]
    shown = np.concatenate([*stack, *(curve.values for curve in lines)])
    bottom, top = min(float(shown.min()), 0.0), max(float(shown.max()), 0.0)
    if bottom > -_ROUND_OFF * top:
        bottom = 0.0
    ticks = _ticks(bottom, top, 6)
    low, high = ticks[0], ticks[-1]
    x_ticks = [t for t in _ticks(float(x[0]), float(x[-1]), 8) if x[0] <= t <= x[-1]]
    plot_w, plot_h = _WIDTH - _LEFT - _RIGHT, height - _TOP - _BOTTOM
    x_scale = plot_w / float(x[-1] - x[0])
    y_scale = plot_h / (high - low)

    def at_x(value: float | Floats) -> float | Floats:
        return _LEFT + (value - float(x[0])) * x_scale

    def at_y(value: float | Floats) -> float | Floats:
        return _TOP + (high - value) * y_scale

    parts = []
    for tick in ticks:
        y = at_y(tick)
        parts.append(
            f'<line class="grid" x1="{_LEFT:g}" x2="{_WIDTH - _RIGHT:g}" {_both("y", y)}/>'
        )
        parts.append(f'<text class="tick y" x="{_LEFT - 6:g}" y="{y:.1f}">{_number(tick)}</text>')
    for tick in x_ticks:
        place = f'x="{at_x(tick):.1f}" y="{height - 8:g}"'
        parts.append(f'<text class="tick x" {place}>{_number(tick)}</text>')
    for below, above, curve in zip(stack[:-1], stack[1:], areas, strict=True):
        chosen = _columns(x, above)
        upper = _points(at_x(x[chosen]), at_y(above[chosen]))
        lower = _points(at_x(x[chosen][::-1]), at_y(below[chosen][::-1]))
        parts.append(f'<path class="area {curve.style}" d="M{upper}L{lower}Z"/>')
    for curve in lines:
        chosen = _columns(x, curve.values)
        path = _points(at_x(x[chosen]), at_y(curve.values[chosen]))
        parts.append(f'<path class="line {curve.style}" d="M{path}"/>')
    parts.append(
        f'<line class="axis" x1="{_LEFT:g}" x2="{_WIDTH - _RIGHT:g}" {_both("y", at_y(0))}/>'
    )
    parts.append(f'<line class="cursor" {_both("x", -9)} y1="{_TOP:g}" y2="{height - _BOTTOM:g}"/>')

    read = np.unique(np.linspace(0, len(x) - 1, min(_N_READ, len(x))).astype(int))
    data = {
        "left": _LEFT,
        "width": plot_w,
        "xName": x_name,
        "xUnit": x_unit,
        "unit": unit,
        "x": _rounded(x[read]),
        "curves": _readable(curves, read),
    }
    return (
        f'<figure class="chart"><figcaption><span class="axis-name">{escape(name)} '
        f"[{escape(unit)}]</span>{_legend(curves)}</figcaption>"
        f'<svg viewBox="0 0 {_WIDTH:g} {height:g}" role="img" tabindex="0" '
        f'aria-label="{escape(described)}">{"".join(parts)}</svg>'
        f'<p class="x-name">{escape(x_name)} [{escape(x_unit)}]</p>'
        f'<output class="read" aria-live="polite"></output>'
        f'<script type="application/json">{_json(data)}</script></figure>'
    )


def _legend(curves: Sequence[Curve]) -> str:
    # The stack reads from above, as it lies; the lines come first, as they are drawn over it.
    order = [c for c in curves if not c.area] + [c for c in reversed(curves) if c.area]
    styles = {curve.name: curve for curve in reversed(order)}
    names = dict.fromkeys(curve.name for curve in order)
    items = "".join(
        f'<li><svg class="key" viewBox="0 0 20 10" aria-hidden="true">{_swatch(styles[name])}</svg>'
        f"{escape(name)}</li>"
        for name in names
    )
    return f'<ul class="legend">{items}</ul>'


def _swatch(curve: Curve) -> str:
    if curve.area:
        return f'<path class="area {curve.style}" d="M0,0H20V10H0Z"/>'
    return f'<path class="line {curve.style}" d="M0,5H20"/>'


def _readable(curves: Sequence[Curve], rows: npt.NDArray[np.int64]) -> list[dict[str, object]]:
    named: dict[str, list[Curve]] = {}
    for curve in curves:
        named.setdefault(curve.name, []).append(curve)
    # Curves that share a name (the teeth) are a crowd: one reads the others.
    return [
        {"name": name, "values": _rounded(group[0].values[rows])}
        for name, group in named.items()
        if len(group) == 1
    ]


def _columns(x: Floats, y: Floats) -> npt.NDArray[np.int64]:
    # Lowest and highest row of every column of the picture: no peak is lost, no point is wasted.
    if len(x) <= 2 * _COLUMNS:
        return np.arange(len(x))
    column = ((x - x[0]) / (x[-1] - x[0]) * (_COLUMNS - 1)).astype(int)
    order = np.lexsort((y, column))
    bounds = np.flatnonzero(np.diff(column[order]))
    first = np.concatenate(([0], bounds + 1))
    last = np.concatenate((bounds, [len(x) - 1]))
    return np.unique(np.concatenate((order[first], order[last], [0, len(x) - 1])))


def _ticks(low: float, high: float, n: int) -> list[float]:
    if not high > low:
        high = low + 1.0
    raw = (high - low) / n
    unit = 10.0 ** math.floor(math.log10(raw))
    step = next(m * unit for m in (1.0, 2.0, 2.5, 5.0, 10.0) if m * unit >= raw)
    first, last = math.floor(low / step + 1e-9), math.ceil(high / step - 1e-9)
    return [k * step for k in range(first, last + 1)]


def _number(value: float) -> str:
    return f"{value + 0.0:.6g}".replace("-", "−")


def _points(x: float | Floats, y: float | Floats) -> str:
    pairs = zip(np.atleast_1d(x).tolist(), np.atleast_1d(y).tolist(), strict=True)
    return "L".join(f"{a:.1f},{b:.1f}" for a, b in pairs)


def _both(axis: str, value: float | Floats) -> str:
    return f'{axis}1="{value:.1f}" {axis}2="{value:.1f}"'


def _rounded(values: Floats) -> list[float]:
    return [float(f"{v:.5g}") for v in values.tolist()]


def _json(data: Mapping[str, object]) -> str:
    # "</script" in a name would end the script element.
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
