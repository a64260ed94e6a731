"""Few points of a measured hardening curve."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats

MOST_POINTS = 24
"""Most points of a measured curve: more would follow its noise."""


def fewer_points(
    plastic_strain: Floats, stress: Floats, most: int = MOST_POINTS
) -> tuple[Floats, Floats]:
    """Return at most so many points of a curve, those that keep its shape.

    One after the other, the point is removed that lies nearest to the line between its neighbours,
    in stress; the first and the last stay ([Visvalingam1993] with heights instead of areas).

    Parameters
    ----------
    plastic_strain : ndarray, shape (n,)
        Increasing.
    stress : ndarray, shape (n,), [MPa]
    most : int

    Examples
    --------
    >>> strain, stress = fewer_points(np.array([0.0, 1.0, 2.0, 3.0]), np.array([1.0, 2, 3, 3]), 3)
    >>> strain.tolist()
    [0.0, 2.0, 3.0]
    """
    p, s = np.asarray(plastic_strain, float), np.asarray(stress, float)
    while len(p) > max(most, 2):
        share = (p[1:-1] - p[:-2]) / (p[2:] - p[:-2])
        off = np.abs(s[:-2] + share * (s[2:] - s[:-2]) - s[1:-1])
        nearest = 1 + int(np.argmin(off))
        p, s = np.delete(p, nearest), np.delete(s, nearest)
    return p, s
