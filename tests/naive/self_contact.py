"""Contact of a point with a sheet, by brute force: how deep, and where it is pushed."""

import numpy as np

from .shell import shape as shape_and_slopes


def shape(xi, eta):
    return shape_and_slopes(xi, eta)[0]


def closest_in(p, corners, polygon, n=101):
    """Distance of p from a polygon (points xi, eta) of a quad, by search on ever finer grids."""
    polygon = np.asarray(polygon, float)
    around = np.roll(polygon, -1, axis=0)
    s = np.linspace(0.0, 1.0, 20 * n)[:, None, None]
    border = (polygon + s * (around - polygon)).reshape(-1, 2)
    least, centre, size = np.inf, polygon.mean(axis=0), 2.0
    for _ in range(6):
        steps = np.linspace(-size, size, n)
        tried = centre + np.stack(np.meshgrid(steps, steps), axis=-1).reshape(-1, 2)
        tried = np.concatenate([tried[contains(polygon, tried)], border])
        xi, eta = tried.T
        distance = np.linalg.norm(shape(xi, eta).T @ corners - p, axis=1)
        least = min(least, distance.min())
        centre, size = tried[np.argmin(distance)], 4.0 * size / n
    return least


def contains(polygon, places):
    inside = np.ones(len(places), bool)
    for a, b in zip(polygon, np.roll(polygon, -1, axis=0), strict=True):
        (dx, dy), (x, y) = b - a, (places - a).T
        inside &= dx * y - dy * x >= 0.0
    return inside


def depth_in_plate(p, low, high, thickness, side=0):
    """Depth of p in a flat rectangle in z = 0 with open edges, and the unit vector out of it.

    side : of the plate that p is known to be on, 0 if it is not known.
    """
    to_edge = np.array([p[0] - low[0], high[0] - p[0], p[1] - low[1], high[1] - p[1]])
    directions = np.array([[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0]], float)
    if to_edge.min() <= 0.0:
        return 0.0, np.zeros(3)
    known = side or (1.0 if p[2] > 0.0 else -1.0)
    through_face = thickness - known * p[2]
    if through_face <= 0.0:
        return 0.0, np.zeros(3)
    k = int(np.argmin(to_edge))
    if to_edge[k] < through_face:
        return to_edge[k], directions[k]
    return through_face, np.array([0.0, 0.0, known])
