"""Small pictures of runs as points, as inline SVG: one quantity over another, or over two."""

from __future__ import annotations

import base64
import struct
import zlib
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from shellcut.arrays import Floats
from shellcut.report.markup import in_unit
from shellcut.report.ticks import tick_text, ticks_of

N_COLOUR = 7
"""Colours of curves and points by a factor, the classes c0 to c6 of ``study.css``."""

MOST_POINTS = 500
"""Points of a picture; of more runs every second, third and so on is drawn."""

_WIDTH, _HEIGHT = 340.0, 250.0
_RIGHT, _TOP, _BOTTOM = 14.0, 10.0, 26.0
_MARGIN = 0.05  # of the range beyond the outermost points
_DIGIT = 7.8  # width of a digit at a tick
_LONGEST = 12  # letters of a name at a tick

# Viridis at even steps.
_RAMP = np.array(
    [
        [68, 1, 84], [71, 44, 122], [59, 81, 139], [44, 113, 142], [33, 144, 141],
        [39, 173, 129], [92, 200, 99], [170, 220, 50], [253, 231, 37],
    ],
    float,
)  # fmt: skip


@dataclass(frozen=True)
class Axis:
    """A quantity of the runs; ``names`` if its values are places in a list of names."""

    name: str
    unit: str
    values: Floats
    names: tuple[str, ...] = ()


@dataclass(frozen=True)
class Line:
    """A curve behind the points; its style is a class of the style sheets."""

    x: Floats
    y: Floats
    style: str


@dataclass(frozen=True)
class Ground:
    """Colours behind the points: values on an even lattice, rows from the largest y down."""

    values: Floats
    x_ends: tuple[float, float]
    y_ends: tuple[float, float]
    steps: tuple[float, ...]
    """Bounds of the bands of one colour."""


def panel(
    x: Axis,
    y: Axis,
    said: Sequence[str],
    *,
    fills: Sequence[str] | None = None,
    lines: Sequence[Line] = (),
    ground: Ground | None = None,
    crosses: tuple[Floats, Floats] | None = None,
) -> str:
    """Return a figure of points.

    Parameters
    ----------
    x, y : Axis
        Of n points.
    said : sequence of str
        What pointing at each says.
    fills : sequence of str, optional
        A class ``c0`` to ``c6`` or a colour ``#rrggbb`` for each point.
    lines : sequence of Line
    ground : Ground, optional
    crosses : tuple of ndarray, optional
        Places of runs without a figure.
    """
    box = _Box.around(x, y, lines, ground, crosses)
    parts = [] if ground is None else [_image(box, ground)]
    parts += box.frame(x, y, lined=ground is None)
    for line in lines:
        path = "L".join(
            f"{a:.1f},{b:.1f}" for a, b in zip(box.at_x(line.x), box.at_y(line.y), strict=True)
        )
        parts.append(f'<path class="line {line.style}" d="M{path}"/>')
    if crosses is not None:
        for a, b in zip(box.at_x(crosses[0]), box.at_y(crosses[1]), strict=True):
            parts.append(f'<path class="cross" d="M{a - 4:.1f},{b - 4:.1f}l8,8m0,-8l-8,8"/>')
    places = zip(box.at_x(x.values), box.at_y(y.values), said, strict=True)
    every = -(-len(said) // MOST_POINTS)
    for k, (a, b, text) in enumerate(places):
        if k % every:
            continue
        fill = fills[k] if fills else ""
        how = f'class="dot" style="fill:{fill}"' if fill[:1] == "#" else f'class="dot {fill}"'
        parts.append(
            f'<circle {how} cx="{a:.1f}" cy="{b:.1f}" r="4"><title>{escape(text)}</title></circle>'
        )
    described = f"{y.name} over {x.name}, {len(x.values)} runs"
    return (
        f'<figure class="panel-plot"><figcaption>{escape(in_unit(y.name, y.unit))}</figcaption>'
        f'<svg viewBox="0 0 {_WIDTH:g} {_HEIGHT:g}" role="img" aria-label="{escape(described)}">'
        f"{''.join(parts)}</svg>"
        f'<p class="x-name">{escape(in_unit(x.name, x.unit))}</p></figure>'
    )


@dataclass(frozen=True)
class _Box:
    """Maps values to places in the picture."""

    left: float
    x_ends: tuple[float, float]
    y_ends: tuple[float, float]

    @classmethod
    def around(
        cls,
        x: Axis,
        y: Axis,
        lines: Sequence[Line],
        ground: Ground | None,
        crosses: tuple[Floats, Floats] | None,
    ) -> _Box:
        others = [(line.x, line.y) for line in lines] + ([crosses] if crosses else [])
        x_ends = ground.x_ends if ground else _ends(x, [one[0] for one in others])
        y_ends = ground.y_ends if ground else _ends(y, [one[1] for one in others])
        words = [text for _, text in _marks(y, y_ends, 5)]
        return cls(12.0 + _DIGIT * max(map(len, words), default=1), x_ends, y_ends)

    def at_x(self, value: Floats) -> Floats:
        low, high = self.x_ends
        return self.left + (value - low) * ((_WIDTH - self.left - _RIGHT) / (high - low))

    def at_y(self, value: Floats) -> Floats:
        low, high = self.y_ends
        return _TOP + (high - value) * ((_HEIGHT - _TOP - _BOTTOM) / (high - low))

    def frame(self, x: Axis, y: Axis, *, lined: bool) -> Sequence[str]:
        right, bottom = _WIDTH - _RIGHT, _HEIGHT - _BOTTOM
        parts = []
        for value, text in _marks(y, self.y_ends, 5):
            at = f"{float(self.at_y(np.array(value))):.1f}"
            if lined:
                ends = f'x1="{self.left:g}" x2="{right:g}" y1="{at}" y2="{at}"'
                parts.append(f'<line class="grid" {ends}/>')
            parts.append(
                f'<text class="tick y" x="{self.left - 6:g}" y="{at}">{escape(text)}</text>'
            )
        for value, text in _marks(x, self.x_ends, 5):
            at = f"{float(self.at_x(np.array(value))):.1f}"
            parts.append(f'<text class="tick x" x="{at}" y="{_HEIGHT - 6:g}">{escape(text)}</text>')
        parts.append(
            f'<rect class="box" x="{self.left:g}" y="{_TOP:g}" width="{right - self.left:g}" '
            f'height="{bottom - _TOP:g}"/>'
        )
        return parts


def _ends(axis: Axis, others: Sequence[Floats]) -> tuple[float, float]:
    if axis.names:
        return -0.5, len(axis.names) - 0.5
    together = np.concatenate([axis.values, *others])
    low, high = float(together.min()), float(together.max())
    # a figure that is the same but for round-off is drawn as the same
    if high - low <= 1e-9 * max(abs(low), abs(high)):
        low, high = low - max(abs(low), 1.0) * 0.1, high + max(abs(high), 1.0) * 0.1
    return low - _MARGIN * (high - low), high + _MARGIN * (high - low)


def _marks(axis: Axis, ends: tuple[float, float], n: int) -> list[tuple[float, str]]:
    if axis.names:
        return [(float(k), _short(name)) for k, name in enumerate(axis.names)]
    inside = [tick for tick in ticks_of(*ends, n) if ends[0] <= tick <= ends[1]]
    return [(tick, tick_text(tick)) for tick in inside]


def _short(name: str) -> str:
    plain = name.replace("\\", "/").rpartition("/")[2]
    return plain if len(plain) <= _LONGEST else f"{plain[: _LONGEST - 1]}…"


def bands(low: float, high: float) -> tuple[float, ...]:
    """Return the bounds of bands of one colour between two values."""
    return tuple(ticks_of(low, high, 8))


def colours(values: Floats, steps: Sequence[float]) -> Floats:
    """Return the colour of the band of each value, shape (..., 3), from 0 to 255."""
    n = len(steps) - 1
    band = np.clip(np.searchsorted(steps, values, side="right") - 1, 0, n - 1)
    share = (band + 0.5) / n * (len(_RAMP) - 1)
    below = np.minimum(share.astype(int), len(_RAMP) - 2)
    part = (share - below)[..., None]
    return np.asarray((1.0 - part) * _RAMP[below] + part * _RAMP[below + 1])


def hex_of(colour: Floats) -> str:
    """Return a colour as ``#rrggbb``."""
    return "#" + "".join(f"{round(part):02x}" for part in colour.tolist())


def scale(steps: Sequence[float], name: str) -> str:
    """Return the legend of bands of colour."""
    middles = 0.5 * (np.array(steps[1:]) + np.array(steps[:-1]))
    shades = [hex_of(one) for one in colours(middles, steps)]
    n = len(shades)
    stops = ",".join(
        f"{shade} {100 * k / n:.4g}% {100 * (k + 1) / n:.4g}%" for k, shade in enumerate(shades)
    )
    marks = "".join(f"<span>{tick_text(step)}</span>" for step in steps)
    return (
        f'<div class="scale"><span>{escape(name)}</span>'
        f'<div class="ramp" style="background:linear-gradient(to right,{stops})"></div>'
        f'<div class="marks">{marks}</div></div>'
    )


def _image(box: _Box, ground: Ground) -> str:
    rgb = colours(ground.values, ground.steps).round().astype(np.uint8)
    data = base64.b64encode(_png(rgb)).decode()
    (left, right), (bottom, top) = (
        box.at_x(np.array(ground.x_ends)),
        box.at_y(np.array(ground.y_ends)),
    )
    return (
        f'<image x="{left:.1f}" y="{top:.1f}" width="{right - left:.1f}" '
        f'height="{bottom - top:.1f}" preserveAspectRatio="none" '
        f'href="data:image/png;base64,{data}"/>'
    )


def _png(rgb: np.ndarray[tuple[int, int, int], np.dtype[np.uint8]]) -> bytes:
    """Return a picture as PNG: three bytes a pixel, no filter."""
    height, width, _ = rgb.shape

    def chunk(kind: bytes, data: bytes) -> bytes:
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    rows = b"".join(b"\0" + row.tobytes() for row in rgb)
    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    return (
        b"\x89PNG\r\n\x1a\n"
        + chunk(b"IHDR", head)
        + chunk(b"IDAT", zlib.compress(rows, 9))
        + chunk(b"IEND", b"")
    )
