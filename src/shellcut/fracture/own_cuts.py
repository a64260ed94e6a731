"""Where each blade has cut, beside which it begins no other cut.

A blade that cuts runs between the flanks of its cut. Its edges may also lie on the film there, or
in it, because quads and flanks are coarser than film is: near a tip that the blade drives, and in
whole quads at its flanks. That begins no cut. Flanks that no blade has cut, of tears and notches,
count as its own. The cuts of other blades do not: each blade pierces or enters the film itself,
however close to the others.

A *blade* is all edges that the film feels as one: with a point in common, or of which one ends
nearer to the other than the length L over which the film bends (:mod:`.puncture`).
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product
from shellcut.numerics.connected_parts import connected_parts
from shellcut.state import State
from shellcut.tool.tool import Tool

from .cut_film import CutFilm
from .tip import DrivenTips

NEAR_A_TIP = 2.0
"""A place is left alone that is nearer to a tip of its own blade than this, in local edge lengths:
the edge drives that tip."""

_NOBODY = -1


class OwnCuts:
    """Knows which blade has cut the quads of a mesh.

    Parameters
    ----------
    state : State
        Before the first cut; notches of the mesh may be in it.
    tool : Tool
        Whose edges cut.
    bending_length : float
        L of the film [mm].
    film : CutFilm
        How it is cut.
    mesh_quads : ndarray, shape (n_quad, 4)
        Of the film.
    """

    def __init__(
        self, state: State, tool: Tool, bending_length: float, film: CutFilm, mesh_quads: Ints
    ) -> None:
        self.of_chain = blades(tool, bending_length)
        """Blade of each cutting edge, shape (n_chain,)."""
        self.of_segment = self.of_chain[tool.edge_chain]
        """Blade of each segment of them, shape (n_edge,)."""
        self._film, self._mesh_quads = film, mesh_quads
        self._n_known = 0
        # Of the film without cuts: nodes, middles [mm] and directors of its quads.
        self._whole = state.node.origin[mesh_quads]
        self._middle = state.node.X[mesh_quads].mean(axis=1)
        self._director = state.node.t[mesh_quads].sum(axis=1)
        self._near: dict[int, Ints] = {}
        # Of the quads that each blade, or no blade, has cut.
        notched = state.node.origin[state.node.halved].tolist()
        self._corners: dict[int, set[int]] = {_NOBODY: set(notched)}

    def at_own_flank(self, state: State, row: int, segment: int) -> bool:
        """Return whether a row has a node at a flank that its own blade, or no blade, has cut.

        segment : of the blade.
        """
        nodes = state.quads[row]
        halved = state.node.origin[nodes[state.node.halved[nodes]]].tolist()
        if not halved:
            return False
        self._follow(state)
        own = self._corners.get(int(self.of_segment[segment]), set())
        return not (own.isdisjoint(halved) and self._corners[_NOBODY].isdisjoint(halved))

    def at_own_tip(
        self, state: State, row: int, place: Floats, segment: int, tips: DrivenTips
    ) -> bool:
        """Return whether a place of a row is near a tip that its own blade drives.

        In space, and in the film without its cuts: a tip in another layer leaves it alone.

        place : (3,) [mm].  segment : of the blade.  tips : all that edges drive.
        """
        own = self.of_segment[tips.edge] == self.of_segment[segment]
        reach = NEAR_A_TIP * self._film.size(row)
        near = np.flatnonzero(own & (norm(tips.x - place) < reach)).tolist()
        at_tips = [at for i in near for at, _ in self._film.rows_at_tip(tips.tips[i])]
        if not at_tips:
            return False
        parent = state.quad.parent
        # As far as the rows at a tip, whose middles are farther away than the tip itself.
        near_row = self._near_in_whole(int(parent[row]), reach + 2.0 * self._film.size(row))
        return bool(np.isin(parent[at_tips], near_row).any())

    def _near_in_whole(self, quad: int, radius: float) -> Ints:
        """Return the quads within a radius [mm] that are connected with one where nothing is cut.

        Their directors agree with its own.
        """
        if quad not in self._near:
            gap = norm(self._middle - self._middle[quad])
            alike = product(self._director, self._director[quad]) > 0.0
            near = np.flatnonzero((gap < radius) & alike)
            # A quad is linked with its nodes.
            nodes, at = np.unique(self._whole[near], return_inverse=True)
            n = len(near)
            part = connected_parts(np.repeat(np.arange(n), 4), n + at.ravel(), n + len(nodes))[:n]
            self._near[quad] = near[part == part[near == quad]]
        return self._near[quad]

    def _follow(self, state: State) -> None:
        """Note the corners of the quads that have been cut since the last call."""
        for record in state.split_log[self._n_known :]:
            rows = [row for row in record.rows if row >= 0]
            blade = int(self.of_chain[record.edge]) if record.edge >= 0 else _NOBODY
            corners = state.node.origin[self._mesh_quads[state.quad.parent[rows]]]
            self._corners.setdefault(blade, set()).update(corners.ravel().tolist())
        self._n_known = len(state.split_log)


def blades(tool: Tool, length: float) -> Ints:
    """Return the blade of each cutting edge, shape (n_chain,), numbered from 0.

    length : below which the film feels two edges as one [mm].
    """
    chain, ends = tool.edge_chain, tool.vertices[tool.edges]
    first, last = (np.unique(part, return_index=True)[1] for part in (chain, chain[::-1]))
    tips = np.concatenate([ends[first, 0], ends[len(chain) - 1 - last, 1]])
    of_tip = np.tile(np.arange(tool.n_chain), 2)
    at_vertex = np.repeat(chain, 2), tool.n_chain + tool.edges.ravel()
    close = [np.flatnonzero(_gaps(tip, ends) < length) for tip in tips]
    near = (
        np.repeat(of_tip, [len(found) for found in close]),
        chain[np.concatenate(close)],
    )
    a, b = (np.concatenate(pair) for pair in zip(at_vertex, near, strict=True))
    parts = connected_parts(a, b, tool.n_chain + tool.n_vertex)
    return np.asarray(parts[: tool.n_chain], np.int64)


def _gaps(point: Floats, segments: Floats) -> Floats:
    """Return the distances of a point from segments : (n, 2, 3)."""
    start, along = segments[:, 0], segments[:, 1] - segments[:, 0]
    from_start = point - start
    share = (from_start * along).sum(axis=1) / (along * along).sum(axis=1)
    return np.asarray(norm(from_start - np.clip(share, 0.0, 1.0)[:, None] * along))
