"""Places on the film's border against a convex tool, one by one, by the plain law."""

import numpy as np

from .contact import rounded_depth, smoothed, smoothed_integral


def depth_at(p, tool, radius):
    """Depth of p in a convex tool whose edges are rounded, and the outward direction."""
    points, normals = tool.vertices[tool.triangles[:, 0]], tool.triangle_normals
    if ((points - p) * normals).sum(axis=1).min() <= 0.0:
        return 0.0, np.zeros(3)
    depth, out = rounded_depth(p, (points, normals), radius)
    return max(depth, 0.0), out


def places_on(a, b, length, spacing):
    """Evenly spaced places on an edge from a to b, and their weights on b."""
    m = max(int(np.ceil(length / spacing)), 1)
    s = (np.arange(m) + 0.5) / m
    return (1.0 - s[:, None]) * a + s[:, None] * b, s


def forces_on_ends(a, b, length, spacing, tool, radius, k, g_m):
    """Forces of all places of an edge on its ends, (2, 3), and their energy.

    k : of the whole edge.
    """
    force, energy = np.zeros((2, 3)), 0.0
    places, shares = places_on(a, b, length, spacing)
    for p, s in zip(places, shares, strict=True):
        depth, out = depth_at(p, tool, radius)
        f = k / len(shares) * smoothed(depth, g_m) * out
        force += np.outer([1.0 - s, s], f)
        energy += k / len(shares) * smoothed_integral(depth, g_m)
    return force, energy
