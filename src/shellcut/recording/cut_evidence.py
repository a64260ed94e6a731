"""Evidence from the run about its cut: cracks off the path, overshoot.

======================  ==========================================================================
off_path_mm             largest distance of a split from the path of the cutting edges, in the
                        reference film; the path goes on beyond its ends, where cracks lead
n_split_off_path        splits farther from the path than a fifth of a film edge
path_edge_mm            median edge of the film along that path
bending_length_mm       over which the film bends where its tension is the strength
crack_lead_mm           largest distance of another split ahead of an end of the path
overshoot_rel           mean distance the edge had passed the cables when their joints were made,
                        over half of ``opening_u`` there, by which the edge then drags them: the
                        share of work the joints missed (0.28 mm of 2 mm cost 15-17 %)
======================  ==========================================================================
"""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from shellcut.checks import Sweep
from shellcut.state import SplitRecord

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

OFF_PATH = 0.2
"""In edge lengths: a row of nodes under the path lies within 0.03, including chord error."""


def cut_evidence(sim: Simulation, sweep: Sweep | None) -> dict[str, float]:
    """Return the figures that are finite, by name, up to the present step.

    Parameters
    ----------
    sim : Simulation
        At its end.
    sweep : Sweep or None
        Path of the cutting edges.
    """
    s = sim.state
    sides = sim.mesh.edge_lengths()
    figures: dict[str, float] = {"edge_length_mm": float(np.median(sides))}
    if sim.law is None:
        return figures
    splits = s.splits
    if sweep is not None and len(sweep.place) and splits:
        places = np.array([record.reference for record in splits])
        off = sweep.distance(places)
        size = np.sqrt(sim.mesh.quad_areas())
        around = np.array([_quad_at(sim, record) for record in splits])
        on_it = off <= OFF_PATH * size[around]
        figures |= {
            "n_split": len(places),
            "n_split_off_path": int((~on_it).sum()),
            "off_path_mm": float(off.max()),
            "path_edge_mm": float(np.median(sweep.edge_length)),
            "bending_length_mm": np.nan if sim.cracks is None else sim.cracks.bending_length,
            "crack_lead_mm": float(sweep.lead(places[on_it]).max(initial=0.0)),
        }
    if sim.cables.n_joint_made:
        missed = float(s.cable.overshoot[: s.n_cable].sum()) / sim.cables.n_joint_made
        figures["overshoot_rel"] = missed / (0.5 * sim.cables.at_edge.opening_u)
    return {name: value for name, value in figures.items() if isfinite(value)}


def _quad_at(sim: Simulation, record: SplitRecord) -> int:
    s = sim.state
    row = max(record.rows) if record.node < 0 else s.node.quads[record.node, 0]
    return int(s.quad.parent[row])
