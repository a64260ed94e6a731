"""Charts: numbers and looks as plotly.js takes them, which draws them on the page.

``chart`` is of curves over one coordinate, ``panel`` a small picture of runs as points.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.scene_page.packed_run import as_json

from .markup import in_unit

PALETTE = ("#3b6fd4", "#1592b4", "#2c9c62", "#8a9a1c", "#d08a10", "#dc5f2a", "#c22a4c")
"""Colours of groups, of about one lightness, which stand out on white and on black."""

INK = "#1b1f24"
"""Black; ``page.css`` makes it white in the dark."""

STYLES: dict[str, dict[str, Any]] = {
    "total": {"color": "#cf3a44", "width": 2.2},
    "joints": {"color": "#e08030", "width": 1.4},
    "contact": {"color": "#3d83c8", "width": 1.4},
    "tooth": {"color": "#99a1aa", "width": 0.9},
    "measured": {"color": INK, "width": 2.0, "dash": "dash"},
    "work": {"color": INK, "width": 1.8, "dash": "dash"},
    "effect": {"color": "#cf3a44", "width": 2.0},
    "same": {"color": "#99a1aa", "width": 1.4, "dash": "dash"},
    "reach": {"color": INK, "width": 1.6},
    **{f"c{k}": {"color": color, "width": 1.0} for k, color in enumerate(PALETTE)},
    # Okabe and Ito, whom colour-blind readers thank
    **{
        f"a{k}": {"color": color, "width": 1.4}
        for k, color in enumerate(("#e69f00", "#56b4e9", "#009e73", "#f0e442", "#0072b2"))
    },
}
"""How lines look, by name."""

MOST_POINTS = 500
"""Points of a picture; of more runs every second, third and so on is drawn."""

_N_POINT = 2000  # of a curve: longer ones are thinned out, keeping peaks
_LONGEST = 17  # letters of a name at an axis


@dataclass(frozen=True)
class Curve:
    """One line, or with ``area`` one layer of the stack; ``style`` is one of :data:`STYLES`."""

    name: str
    values: Floats
    style: str
    area: bool = False
    x: Floats | None = None
    """Its own abscissae, ascending; by default those of the chart."""


@dataclass(frozen=True)
class Axis:
    """A quantity of points; ``names`` if its values are places in a list of names."""

    name: str
    unit: str
    values: Floats
    names: tuple[str, ...] = ()
    ends: tuple[float, float] | None = None
    """Of the axis; by default around the points."""


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
    """Return a figure of curves that a reader switches, reads and looks at closely.

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
    height : float
        Of the figure [pixel].
    """
    common = [curve.values for curve in curves if curve.x is None]
    kept = np.unique(np.concatenate([outline(x, y, _N_POINT // 2) for y in common or [x]]))
    n_of = {curve.name: sum(other.name == curve.name for other in curves) for curve in curves}
    gap = "" if unit in ("", "°") else " "
    traces, named = [], set[str]()
    for curve in curves:
        places, rows = x, kept
        if curve.x is not None:
            places, rows = curve.x, outline(curve.x, curve.values, _N_POINT // 2)
        look = STYLES[curve.style]
        # One reads the others of a crowd, like the teeth; a chart of crowds alone names them.
        silent = n_of[curve.name] > 1 and min(n_of.values()) == 1
        layer = {"stackgroup": "areas", "fillcolor": look["color"]} if curve.area else {}
        traces.append(
            {
                "name": escape(curve.name),
                "legendgroup": curve.name,
                "showlegend": curve.name not in named,
                "mode": "lines",
                "line": {**look, "width": 0.0} if curve.area else look,
                "x": _rounded(places[rows], 8),
                "y": _rounded(curve.values[rows], 5),
                "hovertemplate": f"%{{y:.5~g}}{gap}{unit}",
                **({"hoverinfo": "skip", "hovertemplate": None} if silent else {}),
                **layer,
            }
        )
        named.add(curve.name)
    hover = f"{x_name} %{{x:.6~g}}{'' if x_unit == '°' else ' '}{x_unit}"
    layout = {
        "height": height,
        "hovermode": "closest" if min(n_of.values()) > 1 else "x unified",
        "showlegend": True,
        "xaxis": {"unifiedhovertitle": {"text": hover}},
        "yaxis": {"rangemode": "tozero"},
    }
    titles = in_unit(name, unit), in_unit(x_name, x_unit)
    return _figure("chart", titles, described, traces, layout)


def panel(
    x: Axis,
    y: Axis,
    said: Sequence[str],
    *,
    colors: Sequence[str] | Floats | None = None,
    lines: Sequence[tuple[Floats, Floats, str]] = (),
    ground: Mapping[str, Any] | None = None,
    crosses: tuple[Floats, Floats] | None = None,
) -> str:
    """Return a small figure of points.

    Parameters
    ----------
    x, y : Axis
        Of n points.
    said : sequence of str
        What pointing at each says.
    colors : sequence of str or ndarray, optional
        A colour for each point, or with a ground a value on its scale.
    lines : sequence of (ndarray, ndarray, str)
        Places and styles of curves behind the points.
    ground : mapping, optional
        A contour trace of plotly.js behind the points.
    crosses : tuple of ndarray, optional
        Places of runs without a figure.
    """
    every = slice(None, None, -(-len(said) // MOST_POINTS) or 1)
    marker: dict[str, Any] = {"size": 8, "line": {"width": 1, "color": "#ffffffb0"}}
    if colors is None:
        marker["color"] = STYLES["contact"]["color"]
    elif ground is None:
        marker["color"] = list(colors)[every]
    else:
        contours = ground["contours"]
        limits = {"cmin": contours["start"], "cmax": contours["end"]}
        marker |= {
            "color": _rounded(np.asarray(colors)[every], 5),
            "colorscale": "Viridis",
            **limits,
        }
    traces: list[dict[str, Any]] = [dict(ground)] if ground else []
    traces += [
        {
            "mode": "lines",
            "line": STYLES[style],
            "x": _rounded(a, 8),
            "y": _rounded(b, 5),
            "hoverinfo": "skip",
        }
        for a, b, style in lines
    ]
    if crosses is not None:
        cross = {"symbol": "x-thin", "size": 8}
        color = "#ffffff" if ground else STYLES["joints"]["color"]
        traces.append(
            {
                "mode": "markers",
                "marker": {**cross, "line": {"width": 1.6, "color": color}},
                "x": _rounded(crosses[0], 8),
                "y": _rounded(crosses[1], 8),
                "hoverinfo": "skip",
            }
        )
    traces.append(
        {
            "mode": "markers",
            "marker": marker,
            "x": _rounded(x.values[every], 8),
            "y": _rounded(y.values[every], 8),
            "text": [escape(text) for text in said[every]],
            "hovertemplate": "%{text}<extra></extra>",
        }
    )
    layout = {
        "height": 230.0,
        "hovermode": "closest",
        "xaxis": _axis(x),
        "yaxis": _axis(y),
    }
    titles = in_unit(y.name, y.unit), in_unit(x.name, x.unit)
    described = f"{y.name} over {x.name}, {len(x.values)} points"
    return _figure("chart small", titles, described, traces, layout)


def outline(x: Floats, y: Floats, n: int) -> Ints:
    """Return the rows of the lowest and highest value in each of n columns: no peak is lost.

    Examples
    --------
    >>> import numpy as np
    >>> outline(np.linspace(0.0, 1.0, 9), np.array([0, 1, 0, 0, 0, 7, 0, 0, 0.0]), 2).tolist()
    [0, 5, 7, 8]
    """
    if len(x) <= 2 * n:
        return np.arange(len(x))
    column = ((x - x[0]) / (x[-1] - x[0]) * (n - 1)).astype(int)
    order = np.lexsort((y, column))
    bounds = np.flatnonzero(np.diff(column[order])) + 1
    first, last = np.concatenate(([0], bounds)), np.concatenate((bounds, [len(x)])) - 1
    return np.unique(np.concatenate((order[first], order[last], [0, len(x) - 1])))


def _axis(axis: Axis) -> dict[str, Any]:
    if not axis.names:
        return {"range": axis.ends} if axis.ends else {}
    plain = [name.replace("\\", "/").rpartition("/")[2] for name in axis.names]
    short = [n if len(n) <= _LONGEST else f"{n[: _LONGEST - 1]}…" for n in plain]
    n = len(short)
    texts = [escape(name) for name in short]
    ends = [-0.5, n - 0.5]
    return {"tickvals": list(range(n)), "ticktext": texts, "range": ends, "zeroline": False}


def _figure(
    kind: str,
    titles: tuple[str, str],
    described: str,
    traces: Sequence[Any],
    layout: Mapping[str, Any],
) -> str:
    y_title, x_title = map(escape, titles)
    room = f"min-height:{layout['height']:g}px"
    return (
        f'<figure class="{kind}"><figcaption>{y_title}</figcaption>'
        f'<div role="img" aria-label="{escape(described)}" style="{room}"></div>'
        f'<p class="x-name">{x_title}</p>'
        f'<script type="application/json">{as_json([traces, layout])}</script></figure>'
    )


def _rounded(values: Floats, digits: int) -> list[float]:
    return [float(f"{v:.{digits}g}") for v in np.asarray(values, float).tolist()]
