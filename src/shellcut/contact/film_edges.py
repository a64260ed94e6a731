"""The edges at which the film ends, as pairs of nodes: its rim, notches, and the flanks of cracks.

An edge of the film's outline (:mod:`.film_outline`) runs between two points of a row's polygon. A
corner is a node; another point is a flank point of that row, tied to its nodes. Where a crack
crosses a side, the copies on both sides of that have a point of their own at one place: the first
stands for all.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds
from shellcut.numerics.jit import inline, kernel
from shellcut.state import State

from .film_outline import Outline

# Of xi and eta: places that agree so far are one, as are weights on a side.
_SAME = 1e-9
_DIGITS = 9


def open_edges(state: State, outline: Outline, rows: Ints) -> Ints:
    """Return the nodes at both ends of the edges at which the film of some rows ends, (n, 2).

    Parameters
    ----------
    state : State
    outline : Outline
        Of its film.
    rows : ndarray of int, shape (n_row,)
        Quads and copies, ascending.
    """
    f, n_row = state.flank, state.n_quad
    by_row = np.argsort(f.row[: f.count], kind="stable")
    first = np.searchsorted(f.row[: f.count][by_row], np.arange(n_row + 1))
    found = np.empty((rows.size * outline.point.shape[1], 2), np.int64)
    count = _ends_of_open_edges(
        rows, outline, state.quad.nodes, first, f.node[by_row], f.place[by_row], found
    )
    found = found[:count]
    if f.count:
        found = _one_of_each_place(state)[found]
    return np.asarray(found[found[:, 0] != found[:, 1]])


def rows_at(state: State, nodes: Ints) -> Ints:
    """Return the quads and copies at some nodes and flank points, ascending."""
    at = np.zeros(state.node.count, np.bool_)
    at[nodes] = True
    f = state.flank
    at[f.nodes[: f.count][at[f.node[: f.count]]]] = True
    return np.flatnonzero(at[state.quads].any(axis=1))


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
    rows: Ints,
    outline: Outline,
    quads: SmallIds,
    first: Ints,
    node: Ints,
    place: Floats,
    found: Ints,
) -> int:
    """Write the ends of the open edges of some rows to found : (n, 2); return their number.

    first : (n_row + 1,), of each row's flank points.  node, place : (n_flank,), (n_flank, 2), of
    these points row by row.
    """
    count = 0
    for row in rows:
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
