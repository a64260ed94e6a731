"""The load that whole film carries under each point of a tool, and along its cutting edges."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, norm
from shellcut.contact.contact_tables import ToolPoints
from shellcut.tool.tool import Tool

from .puncture import Puncture, edge_bluntness


class PlaceLimits(NamedTuple):
    """The load that the film carries under each point of the tool."""

    force: Floats
    """F_p, inf where the edge is straight, shape (n_of_tool,) [N]."""
    lies: Bools
    """Whether the edge lies on the film over more than L there, shape (n_of_tool,)."""
    width: Floats
    """Of the contact of an arc at F_p, 0 at a tip, shape (n_of_tool,) [mm]."""


class PierceLimits(NamedTuple):
    """The load that whole film carries."""

    puncture: Puncture
    """Under a tip."""
    strength: float
    """Along an edge [MPa]."""
    own: float | None = None
    """The user's own force of a tip, in place of F_p [N]."""

    def at_points(self, points: ToolPoints, tool: Tool) -> PlaceLimits:
        """Return the load that it carries under the points of a tool."""
        film, edge_radius = self.puncture, tool.edge_radius
        length = norm(tool.vertices[tool.edges[:, 1]] - tool.vertices[tool.edges[:, 0]])
        longest = np.bincount(tool.edge_chain, length)[tool.edge_chain[points.segment]]
        with np.errstate(invalid="ignore"):
            width = 2.0 * film.slope * points.radius
        tip = (points.segment >= 0) & (width < longest)
        force = np.full(len(width), np.inf)
        lies = ~tip
        for k in np.flatnonzero(tip).tolist():
            rho = edge_bluntness(float(points.radius[k]), edge_radius)
            force[k] = film.force(rho) if self.own is None else self.own
            lies[k] = self.own is None and points.radius[k] > 0.0 and film.blunt * rho > film.sharp
        return PlaceLimits(force, lies, np.where(tip, width, 0.0))
