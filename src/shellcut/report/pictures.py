"""Sections with pictures: crack map, film strip.

The pictures of frames contain no text: captions, scale and legend are HTML, equally readable on a
phone and on a desktop.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from html import escape
from pathlib import Path

import numpy as np

from shellcut.card import image
from shellcut.frame import Frame
from shellcut.view import (
    Look,
    Panel,
    Panels,
    caption_of,
    draw_crack_map,
    legend_of,
)

from .gathered import Gathered
from .markup import missing

_N_MAP = 100  # frames read for the crack map
_N_FRAME = 6  # frames in the film strip
_STRIP = (340, 480)  # height and width of a picture in the film strip [pixel]
_N_COLOR = 12  # colours of the stress scale; CSS interpolates between them
_MISSING = "Not drawn: pictures need Matplotlib (pip install shellcut[plot])."


def crack_map(run: Gathered) -> str:
    """Return the crack on the uncut film."""
    frames = run.frames(_N_MAP)
    if not frames:
        return missing("No crack map: there are no frames.")
    places = {}
    if run.splits:
        where = np.stack([run.splits[axis] for axis in "XYZ"], axis=1)
        kinds = run.splits["kind"]
        places = {str(kind): where[kinds == kind] for kind in np.unique(kinds)}

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "map.png"
            draw_crack_map(path, frames, splits=places, width=6.5, dpi=130.0)
            png = path.read_bytes()
    except ImportError:
        return missing(_MISSING)
    name = frames[-1].coordinate_name
    alt = f"Plan of the film with the crack edges coloured by the {name} they opened at"
    caption = (
        f"The crack on the uncut film. Each edge is dated by the first frame in which it is "
        f"open; {len(frames)} of {run.results.n_frame if run.results else 0} frames were read."
    )
    return (
        f'<figure>{image(png, alt)}<figcaption class="caption">{escape(caption)}</figcaption>'
        "</figure>"
    )


def film_strip(run: Gathered) -> str:
    """Return a few frames side by side."""
    frames = run.frames(_N_FRAME)
    if not frames:
        return missing("No film strip: there are no frames.")
    try:
        panels = Panels(frames, shape=_STRIP, look=Look())
        views = "".join(
            f"<figure>{_panel(panels.whole(frame), f'The film at {caption_of(frame)[0]}')}"
            f"<figcaption>{escape(' · '.join(caption_of(frame)))}</figcaption></figure>"
            for frame in frames
        )
        words = _stress(panels, frames)
    except ImportError:
        return missing(_MISSING)
    return (
        f'<div class="strip">{views}</div>{words}<p class="caption">All with the same camera, and '
        "with one stress scale.</p>"
    )


def _panel(panel: Panel, alt: str) -> str:
    length, share = panel.bar
    bar = f'<span class="bar" style="width:{100.0 * share:.2f}%">{length:g} mm</span>'
    return f'<div class="panel">{image(panel.png(), alt)}{bar}</div>'


def _stress(panels: Panels, frames: Sequence[Frame]) -> str:
    """Return the stress scale and the legend."""
    low, high = panels.limits
    ramp = ", ".join(_css(color) for color in panels.look.colors(_N_COLOR))
    largest = max(float(frame.quad_principal[:, 0].max()) for frame in frames)
    beyond = f"; the largest is {largest:.3g} MPa" if largest > high else ""
    marks = "".join(f"<span>{mark}</span>" for mark in _marks(low, high))
    items = "".join(
        f'<li><span class="swatch{" area" * shown.is_area}" style="background:{_css(shown.color)}">'
        f"</span>{escape(shown.name)}</li>"
        for shown in legend_of(frames)
    )
    return (
        f'<div class="stress"><div class="scale"><div class="ramp" style="background:'
        f'linear-gradient(to right, {ramp})"></div><div class="marks">{marks}</div>'
        f'largest principal stress [MPa]{beyond}</div><ul class="legend">{items}</ul></div>'
    )


def _marks(low: float, high: float) -> Iterator[str]:
    """Yield evenly spaced numbers including the ends, with as few digits as possible."""
    ways = [[f"{value:.4g}" for value in np.linspace(low, high, n + 1)] for n in (4, 5, 3, 6)]
    yield from min(ways, key=lambda way: max(map(len, way)))


def _css(color: Sequence[float]) -> str:
    return "#" + "".join(f"{round(255.0 * part):02x}" for part in color[:3])
