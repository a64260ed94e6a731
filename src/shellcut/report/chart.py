"""Curves as inline SVG: sharp on paper, dark in the dark, no library.

The SVG written here is the complete chart, for paper and for browsers without JavaScript. With
JavaScript, ``chart.js`` redraws it from the same numbers at screen resolution, with switchable
curves and zoom. Text that must be readable on a phone (legend, axis names) is HTML around the SVG;
the SVG itself contains only the tick numbers.
"""

from __future__ import annotations

import json
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from html import escape

import numpy as np
import numpy.typing as npt

from .ticks import tick_text, ticks_of

Floats = npt.NDArray[np.float64]

_WIDTH = 720.0
_RIGHT, _TOP, _BOTTOM = 20.0, 12.0, 30.0
_DIGIT = 13.0  # width of a digit at a tick, as shown on a phone without JavaScript
_COLUMNS = 500  # columns that a curve is drawn in: about the number of pixels
_ROUND_OFF = 0.01  # negative values up to this part of the maximum get no room of their own
_N_POINT = 4000  # points kept for zooming: longer curves are thinned out, keeping peaks


@dataclass(frozen=True)
class Curve:
    """One line, or with ``area`` one layer of the stack; ``style`` is a class in ``page.css``."""

    name: str
    values: Floats
    style: str
    area: bool = False
    x: Floats | None = None
    """Its own abscissae, ascending; by default those of the chart."""


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
    """Return a ``<figure>`` with legend, curves and the data for ``chart.js``.

    Parameters
    ----------
    x : ndarray, shape (n,)
        Ascending, n at least 2.
    curves : sequence of Curve
        Areas are stacked in order, lines are drawn over them. Curves with the same name share a
        legend entry and are switched together. Areas use the abscissae of the chart.
    x_name, x_unit, name, unit : str
        Names and units of the axes; units in common notation.
    described : str
        Text for screen readers.
    """
    axes = _Axes.around(x, curves, height)
    drawn = "".join([*axes.grid(), *_areas(axes, x, curves), *_lines(axes, x, curves)])
    data = {
        "xName": x_name,
        "xUnit": x_unit,
        "unit": unit,
        "height": height,
        **_numbers(x, curves),
    }
    return (
        f'<figure class="chart"><figcaption><span class="axis-name">{escape(name)} '
        f"[{escape(unit)}]</span>{_legend(curves)}</figcaption>"
        f'<svg viewBox="0 0 {_WIDTH:g} {height:g}" role="img" tabindex="0" '
        f'aria-label="{escape(described)}">{drawn}</svg>'
        f'<p class="x-name">{escape(x_name)} [{escape(x_unit)}]</p>'
        f'<script type="application/json">{_json(data)}</script></figure>'
    )


@dataclass(frozen=True)
class _Axes:
    """Map values to positions in the picture."""

    left: float
    height: float
    x_range: tuple[float, float]
    y_ticks: Sequence[float]

    @classmethod
    def around(cls, x: Floats, curves: Sequence[Curve], height: float) -> _Axes:
        stack = _stack(x, curves)
        lines = [curve.values for curve in curves if not curve.area]
        shown = np.concatenate([*stack, *lines])
        bottom, top = min(float(shown.min()), 0.0), max(float(shown.max()), 0.0)
        if bottom > -_ROUND_OFF * top:
            bottom = 0.0
        ticks = ticks_of(bottom, top, 6)
        places = [x, *(curve.x for curve in curves if curve.x is not None)]
        ends = min(float(p[0]) for p in places), max(float(p[-1]) for p in places)
        left = 10.0 + _DIGIT * max(len(tick_text(tick)) for tick in ticks)
        return cls(left, height, ends, ticks)

    def at_x(self, value: Floats) -> Floats:
        low, high = self.x_range
        return self.left + (value - low) * ((_WIDTH - self.left - _RIGHT) / (high - low))

    def at_y(self, value: Floats) -> Floats:
        low, high = self.y_ticks[0], self.y_ticks[-1]
        return _TOP + (high - value) * ((self.height - _TOP - _BOTTOM) / (high - low))

    def grid(self) -> Iterator[str]:
        for tick, y in zip(self.y_ticks, self.at_y(np.array(self.y_ticks)), strict=True):
            yield self._level("grid", float(y))
            yield f'<text class="tick y" x="{self.left - 6:g}" y="{y:.1f}">{tick_text(tick)}</text>'
        low, high = self.x_range
        ticks = [tick for tick in ticks_of(low, high, 8) if low <= tick <= high]
        for tick, x in zip(ticks, self.at_x(np.array(ticks)), strict=True):
            place = f'x="{x:.1f}" y="{self.height - 8:g}"'
            yield f'<text class="tick x" {place}>{tick_text(tick)}</text>'
        yield self._level("axis", float(self.at_y(np.zeros(1))[0]))

    def _level(self, style: str, y: float) -> str:
        ends = f'x1="{self.left:g}" x2="{_WIDTH - _RIGHT:g}" y1="{y:.1f}" y2="{y:.1f}"'
        return f'<line class="{style}" {ends}/>'


def _stack(x: Floats, curves: Sequence[Curve]) -> Floats:
    areas = [curve.values for curve in curves if curve.area]
    return np.cumsum([np.zeros_like(x), *areas], axis=0)


def _areas(axes: _Axes, x: Floats, curves: Sequence[Curve]) -> Iterator[str]:
    stack = _stack(x, curves)
    areas = [curve for curve in curves if curve.area]
    for below, above, curve in zip(stack[:-1], stack[1:], areas, strict=True):
        chosen = _columns(x, above, _COLUMNS)
        upper = _points(axes.at_x(x[chosen]), axes.at_y(above[chosen]))
        lower = _points(axes.at_x(x[chosen][::-1]), axes.at_y(below[chosen][::-1]))
        yield f'<path class="area {curve.style}" d="M{upper}L{lower}Z"/>'


def _lines(axes: _Axes, x: Floats, curves: Sequence[Curve]) -> Iterator[str]:
    for curve in curves:
        if curve.area:
            continue
        places = x if curve.x is None else curve.x
        chosen = _columns(places, curve.values, _COLUMNS)
        path = _points(axes.at_x(places[chosen]), axes.at_y(curve.values[chosen]))
        yield f'<path class="line {curve.style}" d="M{path}"/>'


def _legend(curves: Sequence[Curve]) -> str:
    # List the stack from top to bottom; lines come first because they are drawn over it.
    order = [c for c in curves if not c.area] + [c for c in reversed(curves) if c.area]
    styles = {curve.name: curve for curve in reversed(order)}
    names = dict.fromkeys(curve.name for curve in order)
    items = "".join(
        f'<li><svg class="key" viewBox="0 0 20 10" aria-hidden="true">{_swatch(styles[name])}</svg>'
        f"<span>{escape(name)}</span></li>"
        for name in names
    )
    return f'<ul class="legend">{items}</ul>'


def _swatch(curve: Curve) -> str:
    if curve.area:
        return f'<path class="area {curve.style}" d="M0,0H20V10H0Z"/>'
    return f'<path class="line {curve.style}" d="M0,5H20"/>'


def _numbers(x: Floats, curves: Sequence[Curve]) -> dict[str, object]:
    """Return the abscissae of the chart and its curves; some curves have their own."""
    kept = np.arange(len(x))
    if len(x) > _N_POINT:
        common = [curve.values for curve in curves if curve.x is None]
        kept = np.unique(np.concatenate([_columns(x, y, _N_POINT // 4) for y in common]))
    found: list[dict[str, object]] = []
    for curve in curves:
        rows = kept if curve.x is None else _columns(curve.x, curve.values, _N_POINT // 2)
        entry = {"name": curve.name, "style": curve.style, "area": curve.area}
        places = {} if curve.x is None else {"x": _rounded(curve.x[rows], 8)}
        found.append({**entry, **places, "y": _rounded(curve.values[rows], 5)})
    return {"x": _rounded(x[kept], 8), "curves": found}


def _columns(x: Floats, y: Floats, n: int) -> npt.NDArray[np.int64]:
    # Keep the lowest and highest row of each of n columns: no peak is lost.
    if len(x) <= 2 * n:
        return np.arange(len(x))
    column = ((x - x[0]) / (x[-1] - x[0]) * (n - 1)).astype(int)
    order = np.lexsort((y, column))
    bounds = np.flatnonzero(np.diff(column[order]))
    first = np.concatenate(([0], bounds + 1))
    last = np.concatenate((bounds, [len(x) - 1]))
    return np.unique(np.concatenate((order[first], order[last], [0, len(x) - 1])))


def _points(x: Floats, y: Floats) -> str:
    return "L".join(f"{a:.1f},{b:.1f}" for a, b in zip(x.tolist(), y.tolist(), strict=True))


def _rounded(values: Floats, digits: int) -> list[float]:
    return [float(f"{v:.{digits}g}") for v in values.tolist()]


def _json(data: Mapping[str, object]) -> str:
    # "</script" in a name would end the script element.
    return json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
