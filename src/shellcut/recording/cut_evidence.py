"""What a run itself shows of its cut: whether cracks kept to the way of the edge, and what it cost.

======================  ==========================================================================
off_path_mm             how far from the way of the cutting edges a split lay at most, in the
                        reference film; cracks may run ahead of it by ``Sweep``'s AHEAD
n_split_off_path        splits farther from it than a fifth of an edge of the film
overshoot_rel           how far the edge had passed the cables when it met them, in the mean, over
                        the half of ``opening_u`` by which it then drags them: what the joints
                        missed of their work (0.28 mm of 2 mm cost 15-17 %)
cables_rel              work of the cables over all work that is spent and not stored: the rest
                        went into damping and contact
======================  ==========================================================================
"""

from __future__ import annotations

from math import isfinite

import numpy as np

from shellcut.checks import Sweep
from shellcut.simulation.simulation import Simulation

OFF_PATH = 0.2
"""In edge lengths: a row of nodes under the path is within 0.03, chords included."""


def cut_evidence(sim: Simulation, sweep: Sweep | None) -> dict[str, float]:
    """Return the finite ones of the figures by name, as far as the run has come.

    Parameters
    ----------
    sim : Simulation
        At its end.
    sweep : Sweep or None
        The way of its cutting edges.
    """
    s, book = sim.state, sim.ledger
    sides = sim.mesh.edge_lengths()
    figures: dict[str, float] = {"edge_length_mm": float(np.median(sides))}
    if sim.law is None:
        return figures
    if sweep is not None and sweep.within.any() and s.split_log:
        places = np.array([record.reference for record in s.split_log])
        off = sweep.distance(places)
        size = np.sqrt(sim.mesh.quad_areas())
        around = np.array([_quad_at(sim, record.node) for record in s.split_log])
        figures |= {
            "n_split": len(places),
            "n_split_off_path": int((off > OFF_PATH * size[around]).sum()),
            "off_path_mm": float(off.max()),
        }
    if sim.cables.n_joint_made:
        missed = float(s.cable.overshoot[: s.n_cable].sum()) / sim.cables.n_joint_made
        figures["overshoot_rel"] = missed / (0.5 * sim.law.opening_u)
    if sim.cables.n_broken:
        cables = book.cohesive_work + book.cohesive_start_work
        spent = cables + book.damping + abs(book.contact_work)
        if spent > 0.0:
            figures["cables_rel"] = cables / spent
    return {name: value for name, value in figures.items() if isfinite(value)}


def _quad_at(sim: Simulation, node: int) -> int:
    return int(sim.state.node.quads[node, 0])
