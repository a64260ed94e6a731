"""A blunt tool: a round bar that leans, without cutting edges."""

from __future__ import annotations

from math import cos, radians, sin
from typing import Annotated, TypeAlias

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, each, product

from .tool import Tool

Diameter: TypeAlias = Annotated[float, Option("mm", "of the bar", above=0)]
Tilt: TypeAlias = Annotated[
    float,
    Option("deg", "of its axis from the vertical; its top leans forward", above=-60, below=60),
]


@checked
def round_bar(
    *,
    diameter: Diameter = 6.0,
    height: Annotated[float, Option("mm", "along the axis; the sheet is halfway", above=0)] = 48.0,
    tilt_deg: Tilt = 10.0,
    n_around: Annotated[int, Option("", "facets around it", least=12)] = 72,
) -> Tool:
    """Return a round bar that moves along +x through the sheet z = 0; it cuts nothing.

    Its foremost point in the sheet is the origin. Its axis leans forward with its top, so that it
    presses the film beside its crack down.

    Returns
    -------
    Tool
        With one body and no cutting edge.

    Examples
    --------
    >>> round_bar(diameter=4.0).n_edge
    0
    """
    corners, triangles = _upright(0.5 * diameter, height, n_around)
    c, s = cos(radians(tilt_deg)), sin(radians(tilt_deg))
    leaning = product(corners, np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]]).T)
    return Tool.from_triangles(
        leaning - [0.5 * diameter / c, 0.0, 0.0],
        triangles,
        edges=np.zeros((0, 2), np.int64),
        name="round bar",
    )


def _upright(radius: float, height: float, n: int) -> tuple[Floats, Ints]:
    """Return corners (n_vertex, 3) and triangles (n_triangle, 3) of a bar along z."""
    angle = 2.0 * np.pi * np.arange(n) / n
    ring = radius * np.stack([each(cos, angle), each(sin, angle)], axis=1)
    levels = np.linspace(-0.5 * height, 0.5 * height, max(2, round(3.0 * height / radius)) + 1)
    rows = [np.column_stack([ring, np.full(n, z)]) for z in levels]
    ends = np.array([[0.0, 0.0, levels[0]], [0.0, 0.0, levels[-1]]])
    here, there = np.arange(n), np.roll(np.arange(n), -1)
    faces = []
    for k in range(len(levels) - 1):
        a, b = k * n + here, k * n + there
        faces += [np.stack([a, b, b + n], axis=1), np.stack([a, b + n, a + n], axis=1)]
    bottom = np.full(n, len(levels) * n)
    top = (len(levels) - 1) * n
    faces.append(np.stack([bottom, there, here], axis=1))
    faces.append(np.stack([bottom + 1, top + here, top + there], axis=1))
    return np.concatenate([*rows, ends]), np.concatenate(faces)
