"""The force on a place of a film, with the domain that its edges, flanks and tips leave."""

import numpy as np

from shellcut.fracture.cut_topology import CutTopology
from shellcut.fracture.film_border import FilmBorder
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
        FilmBorder(shell, topology),
        np.array(place),
        base,
        (0.5 * reach, reach),
        at,
        no_tips,
    )


def force_on(sim, place, reach, base=BASE):
    topology = None if sim.cracks is None else sim.cracks.cuts.topology
    domain = domain_in(sim.state, sim.shell, place, reach, topology, base)
    return TipForce(sim.state, sim.shell, domain, base)


def at_tip(sim):
    """Where the only tip lies in the reference film."""
    (place,) = sim.cracks.at_tips(sim.state.node.X)
    return place
