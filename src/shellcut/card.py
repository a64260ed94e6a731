"""Cards: what notebooks show of an object, a small picture, values with units and a verdict."""

from __future__ import annotations

import base64
from collections.abc import Iterable, Sequence
from dataclasses import is_dataclass
from html import escape
from typing import Any, TypeAlias

import numpy as np

from .arguments import declared
from .arrays import Floats, Numbers
from .unit import after, shown, with_unit

Figures: TypeAlias = list[tuple[str, float | str, str]]
"""Name, value and unit of each entry."""

FILM, TOOL = "#7fb5c9", "#c3c7cf"
"""Colours of film and tool in a drawing."""

_WIDTH, _HEIGHT = 260.0, 170.0  # of a picture [pixel]
_LINE = 16.0  # of names [pixel]
_MOST = 3000  # faces in a picture; of more the border, of a closed surface what is seen best
_TOWARD = np.array([0.371, -0.643, 0.669])  # to the viewer, as in the pictures of a run
_RIGHT = np.array([0.866, 0.5, 0.0])
_COLORS = {"good": "#1a7f37", "doubt": "#b3261e", "note": "#2f5d8a"}


def card(
    title: str, figures: Figures, said: Iterable[tuple[str, str]] = (), picture: str = ""
) -> str:
    """Return a card as HTML, which the picture is too.

    What is ``said`` are the kind, ``good``, ``doubt`` or ``note``, and the text of each sentence of
    a verdict.

    Examples
    --------
    >>> card("Blade", [("edge", 4.0, "mm")]).count("4 mm</td>")
    1
    """
    rows = "".join(
        f'<tr><th style="text-align:left;font-weight:500;padding-right:1em">{escape(name)}</th>'
        f'<td style="text-align:left">{escape(_text(value, unit))}</td></tr>'
        for name, value, unit in figures
    )
    lines = "".join(
        f'<p style="margin:2px 0;padding-left:8px;border-left:4px solid {_COLORS[kind]}">'
        f"{escape(text)}</p>"
        for kind, text in said
    )
    return (
        '<div style="display:flex;flex-wrap:wrap;gap:16px;align-items:center">'
        f'{picture}<div style="flex:1 1 16em;max-width:36em"><b>{escape(title)}</b>'
        f'<table style="margin:0">{rows}</table>{lines}'
        "</div></div>"
    )


def image(png: bytes, alt: str) -> str:
    """Return a picture that is part of the page."""
    data = base64.b64encode(png).decode("ascii")
    return f'<img alt="{escape(alt)}" src="data:image/png;base64,{data}">'


def figures_of(thing: Any) -> Figures:
    """Return the values declared as options of a dataclass, and of the dataclasses in it.

    Numbers and texts that are as they are by default are left out.
    """
    found: Figures = []
    kind: Any = type(thing)
    for name, value in vars(thing).items():
        known = declared(kind).get(name)
        if known and isinstance(value, int | float | str) and value != known.default:
            found.append((name.replace("_", " "), value, known.option.unit))
        elif is_dataclass(value):
            found += figures_of(value)
    return found


def extent(points: Floats) -> tuple[str, str, str]:
    """Return name, sizes along x, y and z, and unit of the extent of points."""
    unit, factor = shown("mm")
    return "extent", " × ".join(f"{factor * size:.4g}" for size in np.ptp(points, axis=0)), unit


def drawing(
    parts: Sequence[tuple[Floats, Numbers, str]],
    lines: Sequence[Floats] | Floats = (),
    stroke: str = "#e6001a",
) -> str:
    """Return faces as an SVG, the near ones before the far ones, and lines over them.

    parts : points, (n, 3) [mm], their ids in each face, and colour of each.  lines : (m, 3) [mm].
    """
    axes = np.stack((_RIGHT, -np.cross(_TOWARD, _RIGHT), _TOWARD))  # rows of a picture go down
    places = [points @ axes.T for points, _, _ in parts if len(points)]
    if not places:
        return ""
    low = np.min([p.min(axis=0) for p in places], axis=0)
    size = np.max([p.max(axis=0) for p in places], axis=0) - low
    scale = min(_WIDTH / max(size[0], 1e-12), _HEIGHT / max(size[1], 1e-12))

    def text(points: Floats) -> str:
        at = ((points @ axes.T - low)[:, :2] * scale).tolist()
        return " ".join(f"{x:.1f} {y:.1f}" for x, y in at)

    drawn = []
    for points, faces, color in parts:
        if len(faces) > _MOST:
            sides = np.sort(np.stack((faces, np.roll(faces, -1, 1)), 2).reshape(-1, 2), 1)
            ends, count = np.unique(sides, axis=0, return_counts=True)
            a, b, c = np.moveaxis(points[faces[:, :3]], 1, 0)
            seen = np.cross(b - a, c - a) @ _TOWARD
            faces = ends[count == 1] if (count == 1).any() else faces[np.argsort(seen)[-_MOST:]]
        corners = points[faces]
        depth = corners.mean(axis=1) @ axes[2]
        drawn += [(z, text(face), color) for z, face in zip(depth, corners, strict=True)]
    shapes = [f'<polygon points="{at}" fill="{color}"/>' for _, at, color in sorted(drawn)]
    shapes += [
        f'<polyline points="{text(line)}" stroke="{stroke}" stroke-width="1.5"/>' for line in lines
    ]
    width, height = (size[:2] * scale + 2.0).round().astype(int)
    line = 0.4 if len(drawn) < 0.5 * _MOST else 0.1
    return (
        f'<svg width="{width}" height="{height}" viewBox="-1 -1 {width} {height}" '
        f'stroke="#3a3f46" stroke-width="{line}">{"".join(shapes)}</svg>'
    )


def section(layers: Sequence[tuple[str, float]]) -> str:
    """Return a cut through layers, the first at the bottom, to scale, with their names, as an SVG.

    layers : name and thickness of each.
    """
    whole, drawn, top = sum(thickness for _, thickness in layers), [], _HEIGHT
    name_at = _HEIGHT + _LINE
    for k, (name, thickness) in enumerate(layers):
        high = _HEIGHT * thickness / whole
        top -= high
        name_at = min(top + 0.5 * high + 5.0, name_at - _LINE)  # of thin layers, too, a line each
        drawn.append(
            f'<polygon points="0 {top:.1f} 80 {top:.1f} 80 {top + high:.1f} 0 {top + high:.1f}" '
            f'fill="{(FILM, TOOL)[k % 2]}" stroke="#3a3f46" stroke-width="0.4"/>'
            f'<text x="88" y="{name_at:.1f}" font-size="13" fill="currentColor">{escape(name)}'
            "</text>"
        )
    first = min(0.0, name_at - _LINE)
    return (
        f'<svg width="{_WIDTH:g}" height="{_HEIGHT + 2.0 - first:g}" '
        f'viewBox="-1 {first - 1.0:g} {_WIDTH:g} {_HEIGHT + 2.0 - first:g}">{"".join(drawn)}</svg>'
    )


def _text(value: float | str, unit: str) -> str:
    if isinstance(value, float):
        return with_unit(value, unit)
    return (value if isinstance(value, str) else f"{value:,}") + after(unit)
