"""Boxes along the axes around runs of points, for kernels that leave out early what is far away."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3

from .jit import inline


def around_runs(ends: Floats, first: Ints) -> tuple[Floats, Floats]:
    """Return the low and high corners of the boxes around runs of segments, (n_run, 3) each.

    ends : (n, 2, 3), of the segments.  first : (n_run + 1,), first of each run, and the end.
    """
    low, high = ends.min(axis=1), ends.max(axis=1)
    return np.minimum.reduceat(low, first[:-1]), np.maximum.reduceat(high, first[:-1])


@inline
def in_box(p: Vec3, low: Floats, high: Floats, b: int) -> bool:
    """Return whether a point lies inside box b of low, high : (n_box, 3)."""
    # Branch-free: branches here would be mispredicted.
    return bool(
        (low[b, 0] < p[0])
        & (p[0] < high[b, 0])
        & (low[b, 1] < p[1])
        & (p[1] < high[b, 1])
        & (low[b, 2] < p[2])
        & (p[2] < high[b, 2])
    )


@inline
def box_around(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> tuple[Vec3, Vec3]:
    """Return the low and the high corner of the box around four points."""
    return (
        (
            min(min(a[0], b[0]), min(c[0], d[0])),
            min(min(a[1], b[1]), min(c[1], d[1])),
            min(min(a[2], b[2]), min(c[2], d[2])),
        ),
        (
            max(max(a[0], b[0]), max(c[0], d[0])),
            max(max(a[1], b[1]), max(c[1], d[1])),
            max(max(a[2], b[2]), max(c[2], d[2])),
        ),
    )


@inline
def are_near(low: Vec3, high: Vec3, other_low: Vec3, other_high: Vec3, reach: float) -> bool:
    """Return whether two boxes have a point in common if one is widened by a reach."""
    # Branch-free, as above.
    return bool(
        (low[0] - reach <= other_high[0])
        & (high[0] + reach >= other_low[0])
        & (low[1] - reach <= other_high[1])
        & (high[1] + reach >= other_low[1])
        & (low[2] - reach <= other_high[2])
        & (high[2] + reach >= other_low[2])
    )
