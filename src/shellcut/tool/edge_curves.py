"""Cutting edges as curves: which segments follow one another, and which of them are arcs.

A rigid edge that moves along itself cuts nothing: a straight one drawn along its line, or one round
about an axis that turns about it. What then counts is the motion of the curve, not of the tool.
With the centre c and the unit axis n of an arc, spin w and velocity v at p of the tool, those of
the curve are

    w - (w · n) n,    v - (w · n) n x (p - c).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, cross, norm, product, unit

# Gap between the segments of one chain over the length of one; far above round-off.
_JOINED = 1e-6

# Distance of the vertices from the arc over its height, that of a triangle of them: of files that
# have six digits, and far below that of a helix.
_ROUND = 1e-3

# Such a height over the base of the triangle, below which an edge is straight.
_STRAIGHT = 1e-4


class EdgeCurves(NamedTuple):
    """The curves of the segments of cutting edges, for kernels."""

    chain: Annotated[Ints, "(n_edge,)"]
    """Of each segment."""
    axis: Annotated[Floats, "(n_edge, 3)"]
    """n of its chain, if that is an arc; else zero."""
    centre: Annotated[Floats, "(n_edge, 3)"]
    """c of its chain, if that is an arc [mm]."""

    @classmethod
    def of(cls, start: Floats, vector: Floats) -> EdgeCurves:
        """Collect those of segments, chain after chain: starts and vectors, (n_edge, 3), [mm]."""
        end, n = start + vector, len(start)
        gap, length = norm(start[1:] - end[:-1]), norm(vector)
        first = np.flatnonzero(np.append(True, gap > _JOINED * length[1:])[:n])
        chain = np.cumsum(np.isin(np.arange(n), first)) - 1
        curves = cls(chain, np.zeros((n, 3)), np.zeros((n, 3)))
        for rows in np.split(np.arange(n), first[1:]):
            if len(rows) > 2:  # any two segments are on a circle
                closing = end[rows[-1:]]
                closed = norm(closing - start[rows[:1]]) <= _JOINED * length[rows[:1]]
                points = np.concatenate([start[rows], closing[~closed]])
                curves.axis[rows], curves.centre[rows] = _arc(points, bool(closed[0]))
        return curves


def _arc(points: Floats, closed: bool) -> tuple[Floats, Floats]:
    """Return axis and centre of the circle through points, zero if they are on none."""
    last = len(points) * 2 // 3 if closed else len(points) - 1
    a, u, v = points[0], points[last // 2] - points[0], points[last] - points[0]
    across = cross(u, v)
    base = float(norm(v))
    height = float(norm(across)) / base
    if height <= _STRAIGHT * base:
        return np.zeros(3), np.zeros(3)
    # To the centre: (u² v - v² u) x (u x v) / 2 (u x v)²
    arm = cross(product(u, u) * v - product(v, v) * u, across) / (2.0 * product(across, across))
    axis, radial = unit(across), points - a - arm
    aside = np.abs(product(radial, axis)) + np.abs(norm(radial) - norm(arm))
    if aside.max() > _ROUND * height:
        return np.zeros(3), np.zeros(3)
    return axis, a + arm
