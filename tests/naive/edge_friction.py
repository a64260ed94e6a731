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


class RubbedEdge:
    """An edge of the film, its spring, and what friction does there from step to step."""

    def __init__(self, mu, k, k_t):
        self.mu, self.k, self.k_t = mu, k, k_t
        self.u, self.f, self.place = np.zeros(3), np.zeros(3), 0.0
        self.slips = False

    def step(self, ends, last, poses, tool, law):
        """Move it; return the forces on its ends, and its stored, dissipated energy and work.

        ends, last : of the edge now and a step before, (2, 3).  poses : of the tool, likewise.
        tool : convex, in its own frame.  law : radius of its edges, and g_M.
        """

        def way(s):
            share = np.array([1.0 - s, s])
            here, there = share @ ends, share @ last
            return poses[0].to_body(here[None])[0] - poses[1].to_body(there[None])[0], here - there

        d, moves = way(self.place)
        work = 0.5 * self.f @ moves
        spent = 0.5 * self.k_t * self.u @ self.u - 0.5 * (poses[1].rotation.T @ self.f) @ d
        s, out, pressure = pressed(*poses[0].to_body(ends), tool, law[0], self.k, law[1])
        d, moves = way(s)
        new, pulled = np.zeros(3), self.u + d - out * (out @ (self.u + d))
        if pressure > 0.0:
            new = returned(self.u, d, out, pressure, self.mu, self.k_t)
        self.slips = pressure > 0.0 and np.linalg.norm(new) < 0.999 * np.linalg.norm(pulled)
        self.u, self.place = new, s
        self.f = -self.k_t * (poses[0].rotation @ new)
        stored = 0.5 * self.k_t * new @ new
        spent -= 0.5 * (poses[0].rotation.T @ self.f) @ d + stored
        return np.outer([1.0 - s, s], self.f), stored, spent, work + 0.5 * self.f @ moves
