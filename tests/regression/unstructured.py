"""An unstructured quad mesh of a disc that knows nothing of the blade's path."""

import numpy as np
from scipy.spatial import Delaunay

from shellcut import Mesh


def unstructured_disc(radius: float = 10.2, spacing: float = 0.93, seed: int = 0) -> Mesh:
    """Return a disc of some 2,600 quads: jittered triangles, each cut into three quads."""
    rng = np.random.default_rng(seed)
    n_rim = round(2.0 * np.pi * radius / spacing)
    angle = 2.0 * np.pi * np.arange(n_rim) / n_rim
    rim = radius * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    i, j = np.meshgrid(np.arange(-14, 15), np.arange(-14, 15))
    lattice = spacing * np.stack([i + 0.5 * j, np.sqrt(0.75) * j], axis=-1).reshape(-1, 2)
    lattice += rng.uniform(-0.12, 0.12, lattice.shape) * spacing
    inner = lattice[np.hypot(*lattice.T) < radius - 0.6 * spacing]
    points = np.concatenate([rim, inner])
    triangles = Delaunay(points).simplices
    a, b, c = (points[triangles[:, k]] for k in range(3))
    ccw = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) > (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    triangles[~ccw] = triangles[~ccw][:, ::-1]

    sides = np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, side_of = np.unique(sides, axis=0, return_inverse=True)
    side_of = side_of.reshape(-1, 3) + len(points)
    middle = points[unique].mean(axis=1)
    on_rim = (unique < n_rim).all(axis=1) & (np.abs(unique[:, 0] - unique[:, 1]) % (n_rim - 2) == 1)
    middle[on_rim] *= radius / np.hypot(*middle[on_rim].T)[:, None]
    centre = np.arange(len(triangles)) + len(points) + len(unique)
    nodes = np.concatenate([points, middle, points[triangles].mean(axis=1)])
    quads = np.concatenate(
        [
            np.stack([triangles[:, k], side_of[:, k], centre, side_of[:, k - 1]], axis=1)
            for k in range(3)
        ]
    )
    rim_nodes = np.flatnonzero(np.hypot(*nodes.T) > radius - 1e-6)
    return Mesh.from_arrays(nodes, quads, node_sets={"rim": rim_nodes})
