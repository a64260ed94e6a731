"""Where cracks end in the reference film, and what is in their way: the rim and other cracks."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, unit
from shellcut.fracture.quad_fans import arriving, fans_of
from shellcut.state import local_edge_length

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation


class CrackEnds(NamedTuple):
    """The ends of all cracks, and all places that a crack cannot pass."""

    place: Floats
    """Of the ends, shape (n_end, 3), [mm]."""
    director: Floats
    """There, shape (n_end, 3)."""
    at_rim: Bools
    """Whether an end lies on the film's boundary, shape (n_end,)."""
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
        if sim.cracks is not None and sim.cracks.free is not None:
            return cls._through_quads(sim, rim)
        n, edges = sim.state.node, sim.cracks.edges if sim.cracks is not None else None
        tips = np.array(edges.tips if edges is not None else [], np.int64)
        halves = np.flatnonzero(n.halved[: sim.state.n_node])
        nodes = np.unique(np.concatenate([rim, halves, tips]))
        own = np.full(nodes.size, -1)
        own[np.searchsorted(nodes, tips)] = np.arange(tips.size)

        def heading(i: int) -> Floats:
            crack = arriving(sim.state, fans_of(sim.state, int(tips[i])))
            return np.asarray(n.X[tips[i]] - n.X[crack[0][0]])

        return cls(
            n.X[tips],
            sim.mesh.directors[n.origin[tips]],
            np.isin(tips, rim),
            heading,
            n.X[nodes],
            local_edge_length(n.contact_area[nodes]),
            own,
        )

    @classmethod
    def _through_quads(cls, sim: Simulation, rim: Ints) -> CrackEnds:
        assert sim.cracks is not None
        assert sim.cracks.free is not None
        n, f, free = sim.state.node, sim.state.flank, sim.cracks.free
        place, t = free.at_tips(sim.mesh.nodes), free.at_tips(sim.mesh.directors)
        size = np.sqrt(sim.shell.area)
        n_tip, flanks = len(place), f.node[: f.count]
        # Nodes through which a crack goes: both flanks have film there.
        film = np.flatnonzero(n.real[: sim.state.n_node])
        film = film[~np.isin(film, flanks)]
        origin = n.origin[film]
        nodes = np.union1d(rim, film[np.bincount(origin)[origin] > 1])
        return cls(
            place,
            unit(t),
            np.zeros(n_tip, np.bool_),  # a crack that has reached the rim has no end there
            lambda i: free.tips[i].heading,
            np.concatenate([n.X[nodes], n.X[flanks], place]),
            np.concatenate(
                [
                    local_edge_length(n.contact_area[nodes]),
                    size[f.row[: f.count]],
                    np.full(n_tip, np.median(size)),
                ]
            ),
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
