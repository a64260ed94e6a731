"""Fans: the quads around a node in order, and where cracks arrive between them.

Going around a node counter-clockwise (seen from the director's side), quads that share an edge
follow each other; a fan is a run of them. An interior node has one closed fan, a node on a free
edge or on a crack flank one open fan. Where a crack arrives at a node that is still whole, two
neighbouring quads share the node but no longer the edge: the far ends of that edge are two nodes of
one ``origin``. So

* one open fan whose two outer edges have far ends of one origin is a crack *tip*;
* two or more fans are a *bridge*: cracks from several sides have met there and the node alone still
  holds;
* anything else open is a node of the boundary or of a flank.

Everything here follows from ``State.quads`` and ``origin``; nothing else records the crack.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Ints, product
from shellcut.state import State


@dataclass(frozen=True)
class Fan:
    """Quads around a node, counter-clockwise.

    Attributes
    ----------
    quads : tuple of int
        q_1 .. q_k.
    far : tuple of int
        Far ends of the edges between and outside them: k + 1 of an open fan, k of a closed one,
        where ``far[i]`` and ``far[i + 1]`` bound ``quads[i]``.
    closed : bool
        Whether the last quad joins the first.
    """

    quads: tuple[int, ...]
    far: tuple[int, ...]
    closed: bool


def fans_of(state: State, node: int) -> list[Fan]:
    """Return the fans of a node, the one with the lowest quad id first."""
    ahead: dict[int, int] = {}  # far end of a quad's first edge -> quad
    sector: dict[int, tuple[int, int]] = {}
    for e in state.node.quads[node, : state.node.n_quad_at[node]].tolist():
        ring = state.quads[e].tolist()
        a = ring.index(node)
        sector[e] = (ring[(a + 1) % 4], ring[a - 1])
        ahead[ring[(a + 1) % 4]] = e
    behind = {last: e for e, (_, last) in sector.items()}
    fans = []
    left = dict.fromkeys(sorted(sector))
    while left:
        start = first = next(iter(left))
        closed = False
        while sector[first][0] in behind:  # walk clockwise to the fan's first quad
            first = behind[sector[first][0]]
            if first == start:
                closed = True
                break
        quads, far, e = [], [sector[first][0]], first
        while True:
            quads.append(e)
            del left[e]
            last = sector[e][1]
            if closed and ahead[last] == first:
                break
            far.append(last)
            if last not in ahead:
                break
            e = ahead[last]
        fans.append(Fan(tuple(quads), tuple(far), closed))
    return fans


def arriving(state: State, fans: list[Fan]) -> list[tuple[int, int]]:
    """Return the cracks that arrive at a node: pairs of far ends, before and after the gap.

    The first of a pair ends one fan, the second begins the next one counter-clockwise.
    """
    origin = state.node.origin
    begins = {int(origin[fan.far[0]]): fan.far[0] for fan in fans if not fan.closed}
    return [
        (fan.far[-1], begins[int(origin[fan.far[-1]])])
        for fan in fans
        if not fan.closed and int(origin[fan.far[-1]]) in begins
    ]


def is_tip(state: State, node: int) -> bool:
    """Whether a crack ends at the node."""
    return bool(arriving(state, fans_of(state, node)))


def boundary_edges(state: State) -> Ints:
    """Return the edges with one quad, shape (n, 2), each in the direction of its quad."""
    return _with_one_quad(_edges_of(state.quads), state.n_node)


def _edges_of(quads: Ints) -> Ints:
    return np.asarray(np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2))


def _with_one_quad(pair: Ints, n_node: int) -> Ints:
    key = product(np.sort(pair, axis=1), np.array([n_node, 1]))
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    return np.asarray(pair[count[inverse] == 1])


def open_edge_copies(state: State) -> Ints:
    """Return the crack and notch edges as their two flank copies, shape (n, 2, 2).

    The node order of both copies is that of the reference edge.
    """
    # One end of an open edge has been split: only there is anything to look at.
    halved, origin = state.node.halved, state.node.origin
    edges = _edges_of(state.quads[halved[state.quads].any(axis=1)])
    pair = _with_one_quad(edges[halved[edges].any(axis=1)], state.n_node)
    return _flank_pairs(pair, origin, state.n_node)


def flanks_among(polygons: Ints, origin: Ints) -> Ints:
    """Return the crack edges of a film of polygons as their two flank copies, shape (n, 2, 2).

    Parameters
    ----------
    polygons : ndarray of int, shape (n, n_corner)
        Point ids; one with fewer corners repeats its last point.
    origin : ndarray of int, shape (n_point,)
        The same for points that were one before the film was cut.
    """
    edges = _edges_of(polygons)
    edges = edges[edges[:, 0] != edges[:, 1]]
    return _flank_pairs(_with_one_quad(edges, origin.size), origin, int(origin.max()) + 1)


def _flank_pairs(pair: Ints, origin: Ints, n_origin: int) -> Ints:
    """Return which edges with one quad were one edge before, shape (n, 2, 2)."""
    backwards = origin[pair[:, 0]] > origin[pair[:, 1]]
    pair[backwards] = pair[backwards, ::-1]
    key = product(origin[pair], np.array([n_origin, 1]))
    order = np.argsort(key, kind="stable")
    key, pair = key[order], pair[order]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    first = first[count == 2]
    return np.asarray(np.stack([pair[first], pair[first + 1]], axis=1))


def crack_tips(state: State) -> list[int]:
    """Return all nodes at which a crack or notch ends, ascending."""
    return [n for n in np.unique(boundary_edges(state)).tolist() if is_tip(state, n)]
