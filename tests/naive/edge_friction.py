"""Friction where an edge of the film presses on a convex tool, by the plain law."""

import numpy as np

from naive.contact import smoothed
from naive.edge_contact import deepest_on_edge, depth_at


def pressed(a, b, tool, radius, k, g_m):
    """Of an edge from a to b in the tool's frame: its place, way out there, and the pressure.

    The last is what it brings in beside what it takes from ends in the tool.
    """
    g, s = deepest_on_edge(a, b, tool, radius)
    if g <= 0.0:
        return s, np.zeros(3), 0.0
    taken = (1.0 - s) * (depth_at(a, tool, radius)[0] > 0.0) + s * (
        depth_at(b, tool, radius)[0] > 0.0
    )
    _, out = depth_at((1.0 - s) * a + s * b, tool, radius)
    return s, out, k * smoothed(g, g_m) * (1.0 - taken)


def returned(u, d, out, pressure, mu, k_t):
    """The spring after a step in which the film has moved by d against the tool."""
    trial = u + d - out * (out @ (u + d))
    most = mu * pressure / k_t
    return trial * min(1.0, most / max(np.linalg.norm(trial), 1e-300))
