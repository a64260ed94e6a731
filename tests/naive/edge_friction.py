"""Friction where an edge of the film presses on a convex tool, by the plain law."""

import numpy as np

from naive.edge_contact import depth_at, press_of_edge


def pressed(a, b, tool, radius, k, g_m):
    """Of an edge from a to b in the tool's frame: its place, way out there, and the pressure.

    The last is what it brings in beside what it takes from ends in the tool.
    """
    stored, s, (there, from_a, from_b) = press_of_edge(a, b, tool, radius, g_m)
    if stored <= 0.0:
        return s, np.zeros(3), 0.0
    _, out = depth_at((1.0 - s) * a + s * b, tool, radius)
    return s, out, k * max(there - from_a - from_b, 0.0)


def returned(u, d, out, pressure, mu, k_t):
    """The spring after a step in which the film has moved by d against the tool."""
    trial = u + d - out * (out @ (u + d))
    most = mu * pressure / k_t
    return trial * min(1.0, most / max(np.linalg.norm(trial), 1e-300))
