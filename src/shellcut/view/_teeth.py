"""Group cutting segments into teeth, and find where teeth pass through the film."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.frame import Frame
from shellcut.numerics.connected_parts import by_first_appearance, connected_parts

# A film is flat if its extent across is smaller than this part of its largest extent.
_FLAT = 1e-3


def teeth_of(edge_points: Floats) -> Ints:
    """Return the tooth of every cutting segment, in the order of their first segments.

    edge_points : (n_edge, 2, 3), [mm]; segments that share an end belong together.
    """
    if not len(edge_points):
        return np.zeros(0, dtype=np.int64)
    _, ids = np.unique(edge_points.reshape(-1, 3).round(6), axis=0, return_inverse=True)
    ids = ids.reshape(-1, 2)
    part = connected_parts(ids[:, 0], ids[:, 1], 2 * len(ids))
    return np.asarray(by_first_appearance(part[ids[:, 0]]), dtype=np.int64)


def plane_axes(reference: Floats) -> tuple[int, int, int]:
    """Return the two coordinate axes in which a film is drawn, in order, and the one across it."""
    wide = np.argsort(-np.ptp(reference, axis=0), kind="stable")
    i, j = sorted(wide[:2].tolist())
    return i, j, int(wide[2])


def tooth_paths(frames: Sequence[Frame]) -> list[Floats]:
    """Return where each tooth's edge passes through the plane of a flat film, shape (n_frame, 3).

    Positions are nan where it does not meet the plane [mm]. There is none for a curved film, or if
    the teeth of the frames differ.
    """
    reference = frames[0].reference
    across = plane_axes(reference)[2]
    if np.ptp(reference[:, across]) > _FLAT * np.ptp(reference, axis=0).max():
        return []
    if len({len(f.edge_points) for f in frames}) != 1:
        return []
    tooth = teeth_of(frames[0].edge_points)
    level = reference[:, across].mean()
    paths = np.full((tooth.max(initial=-1) + 1, len(frames), 3), np.nan)
    for k, frame in enumerate(frames):
        a, b = frame.edge_points[:, 0], frame.edge_points[:, 1]
        height_a, height_b = a[:, across] - level, b[:, across] - level
        for e in np.flatnonzero((height_a <= 0.0) != (height_b <= 0.0))[::-1]:
            s = height_a[e] / (height_a[e] - height_b[e])
            paths[tooth[e], k] = a[e] + s * (b[e] - a[e])
    return list(paths)
