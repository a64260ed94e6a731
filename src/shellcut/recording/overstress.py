"""How far film is loaded beyond its strength where no crack can begin.

A crack begins at a notch, at the tip of another crack, or where an edge pierces or enters the film.
Elsewhere film holds together whatever its stress. Film near cracks, supports and tool is left out:
there the stress of a quad depends on its size, and other rules decide. What counts is the mean of
the stress over the thickness, as it does for the cables.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from shellcut.arrays import Bools, Ints
from shellcut.contact.sheet_contact import felt_nodes

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_RINGS = 3
"""Quads around cracks, supports and tool that are left out."""


class Overstress:
    """Measures the film of a run; without a law of its cables it has no strength."""

    def __init__(self, sim: Simulation) -> None:
        self._sim = sim

    def now(self) -> float:
        """Return the largest principal stress at t_n over the strength."""
        sim, state = self._sim, self._sim.state
        if sim.law is None:
            return 0.0
        away = ~self._around(self._left_out())
        rows = np.flatnonzero(away[state.quad.parent[: state.n_quad]])
        if not rows.size:
            return 0.0
        stress = sim.shell.stress(state, rows, place="nominal")
        # Of a plane stress, by its two invariants.
        mean = 0.5 * np.trace(stress, axis1=1, axis2=2)
        radius = np.sqrt(np.maximum(0.5 * (stress**2).sum(axis=(1, 2)) - mean**2, 0.0))
        return float((mean + radius).max()) / sim.law.strength

    def _left_out(self) -> Ints:
        """Return the nodes of the mesh at cracks, supports and tool."""
        sim, state = self._sim, self._sim.state
        n = state.node
        at = n.halved | n.supported | (n.contact_depth > 0.0)
        at[felt_nodes(sim.terms)] = at[sim.terms.fixed_nodes(state)] = True
        if sim.cracks is not None:
            at[sim.cracks.nodes_at_tips(state)] = True
        nodes = np.unique(n.origin[: n.count][at[: n.count]])
        return np.asarray(nodes[nodes < sim.mesh.n_node])  # a point on a flank is none of the mesh

    def _around(self, nodes: Ints) -> Bools:
        """Return which quads of the mesh are around some of its nodes, shape (n_quad,)."""
        quads, marked = self._sim.mesh.quads, np.zeros(self._sim.mesh.n_node, np.bool_)
        marked[nodes] = True
        for _ in range(_RINGS - 1):
            marked[quads[marked[quads].any(axis=1)]] = True
        return np.asarray(marked[quads].any(axis=1))
