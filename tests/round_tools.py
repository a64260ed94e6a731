"""Round cutting wheels."""

import numpy as np


def wheel(n=96, radius=5.0, depth=1.5):
    """Return points and triangles of a wheel about the y axis, its rim the first n of the points.

    Its faces end 0.25 mm beside the rim, ``depth`` within it, in flat hubs.
    """
    angle = 2.0 * np.pi * np.arange(n) / n
    rim = np.stack([np.cos(angle), 0.0 * angle, np.sin(angle)], axis=1)
    faces = [(radius - depth) * rim + [0.0, side, 0.0] for side in (0.25, -0.25)]
    points = np.concatenate([radius * rim, *faces, [[0.0, 0.25, 0.0], [0.0, -0.25, 0.0]]])
    triangles = []
    for k, j in zip(range(n), np.roll(np.arange(n), -1).tolist(), strict=True):
        triangles += [
            (k, n + k, n + j),
            (k, n + j, j),
            (k, j, 2 * n + j),
            (k, 2 * n + j, 2 * n + k),
        ]
        triangles += [(n + k, 3 * n, n + j), (2 * n + k, 2 * n + j, 3 * n + 1)]
    return points, triangles
