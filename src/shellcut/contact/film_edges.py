"""The edges at which the film ends, as pairs of nodes: its rim, notches, and the flanks of cracks.

An edge of the film's outline (:mod:`.film_outline`) runs between two points of a row's polygon. A
corner is a node; another point is a flank point of that row, tied to its nodes. Where a crack
crosses a side, the copies on both sides of that have a point of their own at one place: the first
stands for all.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds, norm
from shellcut.numerics.jit import inline, kernel
from shellcut.state import KnownTopology, State

from .film_outline import FilmOutline, Outline, Part
from .settings import PenaltyLaw

# Edges of a polygon, at most: a key is that of its row times this, and its place there.
_MOST_EDGES = 64

# Of xi and eta: places that agree so far are one, as are weights on a side.
_SAME = 1e-9
_DIGITS = 9


class OpenEdges(NamedTuple):
    """The edges at which the film ends, and what of the nodes' stiffness they take."""

    node: Annotated[Ints, "(n_edge, 2)"]
    """Nodes at both ends."""
    key: Annotated[Ints, "(n_edge,)"]
    """Of row and edge of its polygon, ascending."""
    length: Annotated[Floats, "(n_edge,)"]
    """In the reference configuration [mm]."""
    stiffness: Annotated[Floats, "(n_edge,)"]
    """K of each, half of which either end gives up [N/mm]."""
    left: Annotated[Floats, "(n_node,)"]
    """What is left at each node [N/mm]."""

    def near(self, nodes: Ints) -> Ints:
        """Return the rows of the edges that end at one of some nodes."""
        at = np.zeros(self.left.size, np.bool_)
        at[nodes] = True
        return np.flatnonzero(at[self.node].any(axis=1))

    def with_ends_at(self, nodes: Ints) -> Ints:
        """Return some nodes and the other ends of the edges that end there, ascending."""
        return np.union1d(nodes, self.node[self.near(nodes)])


class FilmEdges:
    """Keeps the open edges of a film up to date from cut to cut.

    Parameters
    ----------
    law : PenaltyLaw
    part_of : Callable
        Returns the polygon of a row that is cut.
    """

    def __init__(self, law: PenaltyLaw, part_of: Callable[[int], Part]) -> None:
        self._law, self._outline, self._known = law, FilmOutline(part_of), KnownTopology()
        self._edges: OpenEdges | None = None

    def of(self, state: State) -> OpenEdges:
        """Return the edges of the film as it is now."""
        if self._edges is None or not self._known.is_of(state):
            self._edges = open_edges(state, self._outline.of(state), self._law)
            self._known.take(state)
        return self._edges


def open_edges(state: State, outline: Outline, law: PenaltyLaw) -> OpenEdges:
    """Return the edges at which the film ends.

    Let k_a be the stiffness of a node and d_a the number of edges that end there: an edge takes
    K = 2 min(k_a / d_a, k_b / d_b), half of it from either end.

    Parameters
    ----------
    state : State
    outline : Outline
        Of its film.
    law : PenaltyLaw
    """
    f, n, n_row = state.flank, state.node, state.n_quad
    by_row = np.argsort(f.row[: f.count], kind="stable")
    first = np.searchsorted(f.row[: f.count][by_row], np.arange(n_row + 1))
    room = n_row * outline.point.shape[1]
    found, key = np.empty((room, 2), np.int64), np.empty(room, np.int64)
    count = _ends_of_open_edges(
        n_row, outline, state.quad.nodes, first, f.node[by_row], f.place[by_row], found, key
    )
    node, key = found[:count], key[:count]
    if f.count:
        node = _one_of_each_place(state)[node]
        differ = node[:, 0] != node[:, 1]
        node, key = node[differ], key[differ]
    own = n.contact_share[: n.count] * law.of_nodes(n.contact_area[: n.count])
    ending = np.bincount(node.ravel(), minlength=n.count)
    stiffness = 2.0 * (own[node] / ending[node]).min(axis=1)
    taken = np.bincount(node.ravel(), np.repeat(0.5 * stiffness, 2), minlength=n.count)
    return OpenEdges(
        node=np.ascontiguousarray(node),
        key=key.copy(),
        length=norm(n.X[node[:, 1]] - n.X[node[:, 0]]),
        stiffness=stiffness,
        left=np.maximum(own - taken, 0.0),
    )


def _one_of_each_place(state: State) -> Ints:
    """Return for each node the first of those at its place that are tied to the same two nodes."""
    f, first = state.flank, np.arange(state.node.count)
    node, weight, tied = f.node[: f.count], f.weight[: f.count], f.nodes[: f.count]
    used = weight > _SAME
    on_side = np.flatnonzero(used.sum(axis=1) == 2)
    ends = tied[on_side][used[on_side]].reshape(-1, 2)
    at = weight[on_side][used[on_side]].reshape(-1, 2)
    low = np.argmin(ends, axis=1)
    every = np.arange(on_side.size)
    s = np.round(at[every, low], _DIGITS)
    order = np.lexsort((on_side, s, ends[every, 1 - low], ends[every, low]))
    a, b, s = ends[every, low][order], ends[every, 1 - low][order], s[order]
    new = np.ones(order.size, np.bool_)
    new[1:] = (a[1:] != a[:-1]) | (b[1:] != b[:-1]) | (s[1:] != s[:-1])
    head = order[np.flatnonzero(new)][np.cumsum(new) - 1]
    first[node[on_side[order]]] = node[on_side[head]]
    return first


@kernel
def _ends_of_open_edges(
    n_row: int,
    outline: Outline,
    quads: SmallIds,
    first: Ints,
    node: Ints,
    place: Floats,
    found: Ints,
    key: Ints,
) -> int:
    """Write the ends of the open edges of all rows to found : (n, 2); return their number.

    key : (n,), written, ascending.  first : (n_row + 1,), of each row's flank points.  node,
    place : (n_flank,), (n_flank, 2), of these points row by row.
    """
    count = 0
    for row in range(n_row):
        if outline.absent[row]:
            continue
        n = outline.n_edge[row]
        for k in range(n):
            if not outline.open[row, k]:
                continue
            a = _node_at(row, k, outline, quads, first, node, place)
            b = _node_at(row, (k + 1) % n, outline, quads, first, node, place)
            if a >= 0 and b >= 0:
                found[count, 0], found[count, 1] = a, b
                key[count] = _MOST_EDGES * row + k
                count += 1
    return count


@inline
def _node_at(
    row: int,
    k: int,
    outline: Outline,
    quads: SmallIds,
    first: Ints,
    node: Ints,
    place: Floats,
) -> int:
    """Return the node or flank point at a point of a row's polygon, -1 if there is none."""
    xi, eta = outline.point[row, k, 0], outline.point[row, k, 1]
    if abs(xi) > 1.0 - _SAME and abs(eta) > 1.0 - _SAME:
        if eta < 0.0:
            return int(quads[row, 0 if xi < 0.0 else 1])
        return int(quads[row, 3 if xi < 0.0 else 2])
    for i in range(first[row], first[row + 1]):
        if abs(place[i, 0] - xi) < _SAME and abs(place[i, 1] - eta) < _SAME:
            return int(node[i])
    return -1
