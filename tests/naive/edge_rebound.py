"""What an edge of the film that presses on a convex tool may return, by the plain condition."""

import numpy as np

from naive.edge_contact import depth_at, press_of_edge


def pressing(ends, tool, radius, k, g_m):
    """Forces on both ends, all in the tool's frame, (2, 3), with ends outside the tool."""
    stored, s, (slope, *_) = press_of_edge(*ends, tool, radius, g_m)
    if stored <= 0.0:
        return np.zeros((2, 3))
    _, out = depth_at((1.0 - s) * ends[0] + s * ends[1], tool, radius)
    return k * slope * np.outer([1.0 - s, s], out)


class Rebound:
    """The work that has been put into an edge's contact from step to step, and its forces."""

    def __init__(self):
        self.got, self.force, self.part = 0.0, np.zeros((2, 3)), 1.0

    def step(self, whole, way, known, mass, dt):
        """Return the forces that act.

        whole : of the potential, (2, 3).  way : of the ends against the tool, (2, 3).  known : all
        other force on the ends, (2, 3).  mass : of the ends, inf where they are held, (2,).
        """
        self.got -= 0.5 * (self.force * way).sum()
        self.part = 1.0
        if not whole.any():
            self.got, self.force = 0.0, whole
            return whole
        # Work got one step later, as a polynomial in the part p: of p f over way and next way.
        moved = dt**2 / mass[:, None]
        square = 0.5 * (moved * whole**2).sum()
        linear = (whole * way).sum() + 0.5 * (whole * moved * known).sum()
        roots = np.roots([-square, -linear, self.got]) if square > 0.0 else np.array([np.inf])
        most = max(roots.real.max(), 0.0) if abs(roots.imag).max() == 0.0 else 0.0
        self.part = min(1.0, most)
        self.force = self.part * whole
        self.got -= 0.5 * (self.force * way).sum()
        return self.force
