"""The force on a place of a film, with the domain that its edges, flanks and tips leave."""

import numpy as np

from shellcut.fracture.crack_path import CrackPath
from shellcut.fracture.cut_topology import CutTopology
from shellcut.fracture.film_edges import FilmEdges
from shellcut.fracture.tip_domain import TipDomain
from shellcut.fracture.tip_force import TipForce

BASE = np.eye(3)[:2]


def domain_in(state, shell, place, reach, topology=None, base=BASE):
    """The domain of a place of a film, whole unless a topology says otherwise."""
    if topology is None:
        topology = CutTopology(shell.mesh_quads, state.node.quads, state.node.n_quad_at)
    corners = shell.reference.x[shell.reference.quads]
    at = [int(np.linalg.norm(corners - place, axis=2).min(axis=1).argmin())]
    no_tips = np.zeros((0, 3))
    return TipDomain.of(
        state,
        shell,
        FilmEdges(shell, topology),
        np.array(place),
        base,
        (0.5 * reach, reach),
        at,
        no_tips,
    )


def force_on(sim, place, reach, base=BASE):
    topology = None if sim.cracks is None else sim.cracks.cuts.topology
    domain = domain_in(sim.state, sim.shell, place, reach, topology, base)
    return TipForce(sim.state, sim.shell, domain, base, sim.loads)


def at_tip(sim):
    """Where the only tip lies in the reference film, and what the base has become ahead of it."""
    path, (tip,) = CrackPath(sim.cracks.cuts.topology, sim.shell), sim.cracks.tips
    row, entry = path.rows_ahead(tip)[0]
    x = sim.state.node.x[sim.state.quads[row]]
    (place,) = sim.cracks.at_tips(sim.state.node.X)
    return place, np.array([path.carried_on(row, entry, way) @ x for way in BASE])
