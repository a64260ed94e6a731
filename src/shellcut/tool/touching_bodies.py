"""Bodies of a tool that touch or overlap.

Two of them do where two triangles are no farther apart than a tolerance, or where one body lies
within the other.
"""

from __future__ import annotations

from collections.abc import Iterator
from math import tau

import numpy as np

from shellcut.arrays import Floats, Ints, cross, norm, product, unit

_MOST_PAIRS = 2_000
"""Most pairs of triangles compared at once: 500 or 8,000 take as long."""


def touching_bodies(
    corners: Floats, body: Ints, tolerance: float
) -> Iterator[tuple[int, int, Floats]]:
    """Yield the bodies that touch or overlap in pairs, and a place of each pair, (3,), [mm].

    Parameters
    ----------
    corners : ndarray, shape (n_triangle, 3, 3)
        Of closed bodies [mm].
    body : ndarray of int, shape (n_triangle,)
        Body of each triangle.
    tolerance : float
        Largest distance of triangles that touch [mm].
    """
    known = np.unique(body).tolist()
    parts = [corners[body == k] for k in known]
    low, high = (np.array([ends(x, axis=(0, 1)) for x in parts]) for ends in (np.min, np.max))
    for i, a in enumerate(parts):
        near = (low[i + 1 :] <= high[i] + tolerance) & (high[i + 1 :] >= low[i] - tolerance)
        for j in (i + 1 + np.flatnonzero(near.all(axis=1))).tolist():
            b = parts[j]
            met = _meeting(a, b, tolerance)
            places = [*0.5 * (met.min(axis=2).max(axis=1) + met.max(axis=2).min(axis=1))]
            # surfaces that do not meet are within each other with all of their points or with none
            places += [x[0, 0] for x, other in ((a, b), (b, a)) if _is_inside(x[0, 0], other)]
            if places:
                yield known[i], known[j], places[0]


def _meeting(a: Floats, b: Floats, tolerance: float) -> Floats:
    """Return a triangle of a, (n, 3, 3), and one of b that meet, (1, 2, 3, 3), or none of both.

    Boxes along the principal axes of a are flat on a flat part of its surface, however it lies.
    """
    _, frame = np.linalg.eigh(np.cov(a.reshape(-1, 3).T))
    turned = product(a, frame), product(b, frame)
    low = np.maximum(*(x.min(axis=(0, 1)) for x in turned)) - tolerance
    high = np.minimum(*(x.max(axis=(0, 1)) for x in turned)) + tolerance
    a, b = (
        x[((y.max(axis=1) >= low) & (y.min(axis=1) <= high)).all(axis=1)]
        for x, y in zip((a, b), turned, strict=True)
    )
    if len(a) * len(b) <= _MOST_PAIRS:
        i, j = np.indices((len(a), len(b))).reshape(2, -1)
        first = _touching(a[i], b[j], tolerance)[:1]
        return np.stack([a[i[first]], b[j[first]]], axis=1)
    some, others = (a, b) if len(a) > len(b) else (b, a)
    order = np.argsort(product(some.mean(axis=1), frame[:, 2]), kind="stable")
    pair = _meeting(some[order[: len(order) // 2]], others, tolerance)
    return pair if len(pair) else _meeting(some[order[len(order) // 2 :]], others, tolerance)


def _touching(a: Floats, b: Floats, tolerance: float) -> Ints:
    """Return the rows of triangles, (n, 3, 3), that are within the tolerance of each other.

    The shortest line between two triangles that have no point in common connects corners, edges or
    a corner and a face: it has one of the directions tried here, along which the triangles are as
    far apart as they are. Along no direction are they farther apart.
    """
    sides_a, sides_b = np.roll(a, -1, axis=1) - a, np.roll(b, -1, axis=1) - b
    of_faces = np.stack([cross(s[:, 0], s[:, 1]) for s in (sides_a, sides_b)], axis=1)
    near = np.flatnonzero(_apart(a, b, of_faces) <= tolerance)  # settles most
    a, b, sides_a, sides_b = a[near], b[near], sides_a[near][:, :, None], sides_b[near][:, None]
    between = a[:, :, None] - b[:, None]
    square = [
        between - (between * along).sum(axis=3, keepdims=True) * along
        for along in (unit(sides_a), unit(sides_b))
    ]
    directions = np.concatenate([cross(sides_a, sides_b), between, *square], axis=1)
    return near[_apart(a, b, directions.reshape(-1, 36, 3)) <= tolerance]


def _apart(a: Floats, b: Floats, directions: Floats) -> Floats:
    """Return how far triangles are apart along the best of some directions, (n, k, 3), [mm]."""
    at_a, at_b = (product(unit(directions), x.swapaxes(1, 2)) for x in (a, b))
    gaps = np.maximum(at_a.min(2) - at_b.max(2), at_b.min(2) - at_a.max(2))
    return np.asarray(gaps.max(axis=1))


def _is_inside(point: Floats, corners: Floats) -> bool:
    """Return whether a closed surface winds around a point: its solid angle is not zero."""
    a, b, c = (corners - point).swapaxes(0, 1)
    la, lb, lc = norm(a), norm(b), norm(c)
    volume = (a * cross(b, c)).sum(axis=1)
    rest = la * lb * lc + (a * b).sum(1) * lc + (b * c).sum(1) * la + (c * a).sum(1) * lb
    return abs(float(np.arctan2(volume, rest).sum())) > 0.5 * tau
