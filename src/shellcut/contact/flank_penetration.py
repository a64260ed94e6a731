"""How deep edges of the film go into the tool between their nodes, where nothing presses.

A rim or a flank whose nodes lie beside a tooth may cross it between them. Contact of the nodes does
not feel that, :mod:`.edge_contact` does if it is switched on. It is measured during a run, with or
without, as what an edge is deeper than the chord of its ends ; of an edge
that presses, the part of it that does not.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.vec3 import load
from shellcut.state import State
from shellcut.tool.pose import Pose, to_body
from shellcut.tool.rounded_depth import ConvexNeighbours, rounded_depth
from shellcut.tool.signed_distance import TriangleGrid, signed_distance

from .edge_contact import EdgeContact
from .film_edges import FilmEdges
from .film_outline import Part
from .penalty_contact import PenaltyContact

_PARTS = 8
"""Of an edge; its depth is looked up where these meet."""


class FlankPenetration:
    """Measures how deep edges of the film go into the tool unfelt.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes.
    edges : EdgeContact or None
        Of the film's edges, if that is switched on.
    part_of : Callable
        Returns the polygon of a row that is cut.
    """

    def __init__(
        self, contact: PenaltyContact, edges: EdgeContact | None, part_of: Callable[[int], Part]
    ) -> None:
        self._contact, self._edges = contact, edges
        self._film = contact.film_edges or FilmEdges(contact.law, part_of)
        self._around = ConvexNeighbours.of(contact.tool)
        self._deepest = BoundOnce(_deepest_beside_chords)

    def largest(self, state: State, pose: Pose) -> float:
        """Return the largest depth of an edge beyond the chord of its ends that is unfelt [mm].

        Edges that the blade goes through are left out: those with ends on both sides of it, or
        deeper below their own side than half of the tool's thickness.
        """
        contact, unfelt = self._contact, 0.0
        edges = self._film.of(state)
        ends = edges.node[edges.near(contact.near.ids)]
        if self._edges is not None:
            pressing, offset = self._edges.pressing()
            unfelt = float(offset.max(initial=0.0))
            count = state.node.count
            ends = ends[~np.isin(product(ends, (count, 1)), product(pressing, (count, 1)))]
        sides, depths = state.node.contact_side[ends], state.node.contact_depth[ends]
        one_side = sides[:, 0] * sides[:, 1] >= 0
        side = np.where(sides[:, 0] != 0, sides[:, 0], sides[:, 1]).astype(np.int64)
        found = float(
            self._deepest(
                ends[one_side],
                side[one_side],
                np.maximum(depths[one_side], 0.0),
                state.node.x,
                pose,
                contact.grid.arrays,
                self._around,
                contact.law.rounding,
                contact.law.tool_half_thickness,
            )
        )
        return max(unfelt, found)


@kernel
def _deepest_beside_chords(
    ends: Ints,
    side: Ints,
    depth: Floats,
    x: Floats,
    pose: Pose,
    grid: TriangleGrid,
    around: ConvexNeighbours,
    radius: float,
    half_thickness: float,
) -> float:
    """Return how much deeper than its chord the deepest of some edges goes into the tool [mm].

    ends : (n, 2), nodes of all in x : (n_node, 3).  side : (n,), of the blade.  depth : (n, 2), of
    the ends [mm].  radius : of the tool's convex edges, rounded.
    """
    pose, grid, around = borrowed(pose), borrowed(grid), borrowed(around)
    deepest = 0.0
    for i in range(ends.shape[0]):
        a, b = to_body(load(x, ends[i, 0]), pose), to_body(load(x, ends[i, 1]), pose)
        g, at = 0.0, 0.0
        for k in range(1, _PARTS):
            s = k / _PARTS
            p = (
                (1.0 - s) * a[0] + s * b[0],
                (1.0 - s) * a[1] + s * b[1],
                (1.0 - s) * a[2] + s * b[2],
            )
            found, inside, triangle, q, _, _ = signed_distance(p, side[i], grid)
            if not (found and inside):
                continue
            D, _, _ = rounded_depth(p, q, triangle, side[i], radius, grid, around)
            beside = D - (1.0 - s) * depth[i, 0] - s * depth[i, 1]
            if beside > g:
                g, at = beside, D
        if side[i] == 0 or at <= half_thickness:
            deepest = max(deepest, g)
    return deepest
