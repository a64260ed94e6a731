"""Where cracks end in the reference film, and what is in their way: the rim and other cracks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, unit
from shellcut.state import local_edge_length

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation


class CrackEnds(NamedTuple):
    """The ends of all cracks, and all places that a crack cannot pass."""

    place: Floats
    """Of the ends, shape (n_end, 3), [mm]."""
    director: Floats
    """There, shape (n_end, 3)."""
    heading: Callable[[int], Floats]
    """Takes the number of an end; returns the direction of its last edge, shape (3,)."""
    obstacle: Floats
    """Shape (n_obstacle, 3), [mm]."""
    size: Floats
    """Local edge lengths there, shape (n_obstacle,), [mm]."""
    own: Ints
    """End that is at an obstacle, -1 if none is, shape (n_obstacle,)."""

    @classmethod
    def of(cls, sim: Simulation, rim: Ints) -> CrackEnds:
        """Return them for the present cracks; rim : nodes of the film's boundary."""
        n, f = sim.state.node, sim.state.flank
        tips, place, t = [], np.zeros((0, 3)), np.zeros((0, 3))
        if sim.cracks is not None:
            tips, at_tips = sim.cracks.tips, sim.cracks.at_tips
            place, t = at_tips(sim.mesh.nodes), at_tips(sim.mesh.directors)
        size = np.sqrt(sim.shell.area)
        # Those at the tips have not parted.
        n_tip, parted = len(place), np.flatnonzero(n.real[f.node[: f.count]])
        flanks = f.node[parted]
        # Nodes through which a crack goes: both flanks have film there.
        film = np.flatnonzero(n.real[: sim.state.n_node])
        film = film[~np.isin(film, f.node[: f.count])]
        origin = n.origin[film]
        nodes = np.union1d(rim, film[np.bincount(origin)[origin] > 1])
        of_nodes = local_edge_length(n.contact_area[nodes])
        return cls(
            place,
            unit(t),
            lambda i: tips[i].heading,
            np.concatenate([n.X[nodes], n.X[flanks], place]),
            np.concatenate([of_nodes, size[f.row[parted]], np.full(n_tip, np.median(size))]),
            np.concatenate([np.full(nodes.size + flanks.size, -1), np.arange(n_tip)]),
        )


def directors_at(sim: Simulation, nodes: Ints) -> Floats:
    """Return the reference directors at some nodes, flank points included, shape (n, 3)."""
    directors, s = sim.mesh.directors, sim.state
    f = s.flank
    point = np.full(s.n_node, -1)
    point[f.node[: f.count]] = np.arange(f.count)
    tied = point[nodes] >= 0
    t = directors[np.where(tied, 0, s.node.origin[nodes])]
    if tied.any():
        k = point[nodes[tied]]
        own = np.einsum("ka,kac->kc", f.weight[k], directors[sim.shell.mesh_quads[f.row[k]]])
        t[tied] = unit(own)
    return np.asarray(t)
