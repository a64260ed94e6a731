"""What a run reports of the tool in the film where no contact feels it."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shellcut.contact.border_contact import BorderContact
from shellcut.contact.sheet_contact import felt_nodes
from shellcut.contact.unfelt_depth import FlankPenetration, ToolWires, missed_penetration

if TYPE_CHECKING:
    from shellcut.contact.film_outline import Part
    from shellcut.simulation.simulation import Simulation


class Unfelt(NamedTuple):
    """Depths that no contact feels [mm]."""

    quads: float = 0.0
    """Of the tool's edges in quads, between nodes."""
    film_edges: float = 0.0
    """Of edges of the film in the tool, beyond the chord of their nodes."""


class UnfeltPenetration:
    """Measures what is unfelt in a run; without a tool nothing is."""

    def __init__(self, sim: Simulation) -> None:
        self._sim = sim
        if sim.contact is not None:
            edges = next((t for t in sim.terms if isinstance(t, BorderContact)), None)
            self._wires = ToolWires(sim.contact.tool)
            self._flanks = FlankPenetration(sim.contact, edges, self._polygon)

    def now(self) -> Unfelt:
        """Return the largest depths at t_n."""
        sim, contact = self._sim, self._sim.contact
        if contact is None:
            return Unfelt()
        felt = felt_nodes(sim.terms)
        if contact.tool.n_edge and sim.cracks is not None and sim.fracture.path == "edges":
            # A cutting edge is in the quad ahead of a tip along sides: it has come there before the
            # tip splits, and splits are looked for every few steps.
            felt = np.append(felt, sim.cracks.tip_nodes(sim.state))
        rows = contact.near.within(0.0, sim.state.quads, sim.state, sim.pose)
        _, quads = missed_penetration(self._wires, sim.state, sim.pose, felt, rows)
        return Unfelt(quads, self._flanks.largest(sim.state, sim.pose))

    def _polygon(self, row: int) -> Part:
        cracks = self._sim.cracks
        assert cracks is not None  # without cracks no row is cut
        return cracks.cuts.topology.polygon(row)
