"""Charts: numbers and looks as plotly.js takes them, which draws them on the page.

``chart`` is of curves over one coordinate, ``panel`` a small picture of runs as points.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from typing import Any

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.scene_page.packed_run import as_json
from shellcut.unit import after, in_unit
from shellcut.view.curves import STYLES, Diagram, outline

MOST_POINTS = 500
"""Points of a picture; of more runs every second, third and so on is drawn."""

_N_POINT = 2000  # of a curve: longer ones are thinned out, keeping peaks
_LONGEST = 17  # letters of a name at an axis


@dataclass(frozen=True)
class Axis:
    """A quantity of points; ``names`` if its values are places in a list of names."""

    name: str
    unit: str
    values: Floats
    names: tuple[str, ...] = ()
    ends: tuple[float, float] | None = None
    """Of the axis; by default around the points."""


def chart(diagram: Diagram, described: str, height: float = 300.0) -> str:
    """Return a picture of curves that a reader switches, reads and looks at closely.

    The diagram's abscissae ascend, two or more. The text is for screen readers, the height in
    pixels.
    """
    diagram = diagram.shown()
    x, curves = np.asarray(diagram.x, float), diagram.curves
    values = [np.asarray(curve.values, float) for curve in curves]
    common = [y for curve, y in zip(curves, values, strict=True) if curve.x is None]
    kept = np.unique(np.concatenate([outline(x, y, _N_POINT // 2) for y in common or [x]]))
    n_of = Counter(curve.name for curve in curves)
    traces: list[dict[str, Any]] = []
    for curve, y in zip(curves, values, strict=True):
        places, rows = x, kept
        if curve.x is not None:
            places = np.asarray(curve.x, float)
            rows = outline(places, y, _N_POINT // 2)
        look, name = STYLES[curve.style], escape(curve.name)
        # One reads the others of a crowd, like the teeth; a chart of crowds alone names them.
        silent = n_of[curve.name] > 1 and min(n_of.values()) == 1
        said = {"hovertemplate": f"%{{y:.5~g}}{after(diagram.unit)}"}
        layer = {"stackgroup": "areas", "fillcolor": look["color"]} if curve.area else {}
        line = {**look, "width": 0.0} if curve.area else look
        traces.append(
            {
                "name": name,
                "legendgroup": curve.group or name,
                "showlegend": all(name != trace["name"] for trace in traces),
                **_trace("lines", places[rows], y[rows], 5, line=line),
                **({"hoverinfo": "skip"} if silent else said),
                **layer,
            }
        )
    hover = f"{diagram.x_name} %{{x:.6~g}}{after(diagram.x_unit)}"
    layout = {
        "height": height,
        "hovermode": "closest" if min(n_of.values()) > 1 else "x unified",
        "showlegend": len(curves) > 1,
        "xaxis": {"unifiedhovertitle": {"text": hover}},
        "yaxis": {"rangemode": "tozero"},
    }
    titles = in_unit(diagram.name, diagram.unit), in_unit(diagram.x_name, diagram.x_unit)
    return _figure("chart", titles, described, traces, layout)


def panel(
    x: Axis,
    y: Axis,
    said: Sequence[str],
    *,
    colors: Sequence[str] | None = None,
    lines: Sequence[tuple[Floats, Floats, str]] = (),
    hollow: Bools | None = None,
) -> str:
    """Return a small picture of points that say something when pointed at.

    There may be a colour for each point, and lines behind the points, by their places and style.
    ``hollow`` says which points are so.
    """
    every = slice(None, None, -(-len(said) // MOST_POINTS) or 1)
    marker: dict[str, Any] = {
        "size": 8,
        "line": {"width": 1, "color": "#ffffffb0"},
        "color": STYLES["contact"]["color"] if colors is None else list(colors)[every],
    }
    if hollow is not None:
        marker["symbol"] = ["circle-open" if one else "circle" for one in hollow[every]]
    traces = [
        _trace("lines", a, b, 5, line=STYLES[style], hoverinfo="skip") for a, b, style in lines
    ]
    points = _trace("markers", x.values[every], y.values[every], marker=marker, cliponaxis=False)
    told = [escape(text) for text in said[every]]
    traces.append({**points, "text": told, "hovertemplate": "%{text}<extra></extra>"})
    layout = {
        "height": 230.0,
        "hovermode": "closest",
        "xaxis": _axis(x),
        "yaxis": _axis(y),
    }
    titles = in_unit(y.name, y.unit), in_unit(x.name, x.unit)
    described = f"{y.name} over {x.name}, {len(x.values)} points"
    return _figure("chart small", titles, described, traces, layout)


def ahead(x: Floats) -> Bools:
    """Return which points of a coordinate lie beyond all before them, as a curve needs them.

    A motion may rest, or reverse.
    """
    return np.asarray(x > np.maximum.accumulate(np.append(-np.inf, x[:-1])))


def _trace(mode: str, x: Floats, y: Floats, digits: int = 8, **look: Any) -> dict[str, Any]:
    return {"mode": mode, "x": _rounded(x, 8), "y": _rounded(y, digits), **look}


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
