"""The path of a cable around a round cutting edge, by search."""

import numpy as np
import scipy.optimize


def rho_and_turn(y, z, radius):
    """Length seen along the edge from the nose (0, 0) to (y, z), y > 0, and the turn.

    The round is the circle of this radius about (0, radius).
    """
    if radius == 0.0:
        return np.hypot(y, z), np.arctan2(z, y)
    end = np.array([y, z])
    if np.hypot(y, radius - z) < radius:  # as if on the surface over it
        turn = np.arctan2(y, radius - z)
        return radius * turn, turn

    def before_tangent(beta):  # the end, over the tangent plane at beta
        normal = np.array([np.sin(beta), -np.cos(beta)])
        return end @ normal + radius * np.cos(beta) - radius

    if before_tangent(0.0) >= 0.0:
        return np.hypot(y, z), np.arctan2(z, y)
    grid = np.linspace(0.0, 1.5 * np.pi, 2001)
    first = next(k for k in range(1, 2001) if before_tangent(grid[k]) >= 0.0)
    beta = scipy.optimize.brentq(before_tangent, grid[first - 1], grid[first], xtol=1e-15)
    tangent = radius * np.array([np.sin(beta), 1.0 - np.cos(beta)])
    return radius * beta + np.linalg.norm(end - tangent), beta


def length(end, side, place, tool_frame, radius):
    """Length of a branch from the joint at ``place`` along the edge to an end."""
    start, along, normal, back = tool_frame
    d = end - start
    rho, turn = rho_and_turn(side * (d @ normal), d @ back, radius)
    return np.hypot(rho, d @ along - place), turn
