"""Edges with one quad: the border of a film, and the flanks of cracks along sides of the mesh.

Where a crack has parted a side the film has two edges with one quad each, whose ends have the same
``origin``. Everything here follows from the quads and ``origin``; nothing else records the crack.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Bools, Ints, product
from shellcut.state import State


def boundary_edges(state: State) -> Ints:
    """Return the edges with one quad, shape (n, 2), each in the direction of its quad."""
    edges, alone = of_one_polygon(state.quads, state.n_node)
    return np.asarray(edges[alone])


def crack_edges(polygons: Ints, origin: Ints) -> Ints:
    """Return the sides along cracks, as their copies on the two flanks, shape (n, 2, 2).

    The point order of both copies is that of the reference edge.

    Parameters
    ----------
    polygons : ndarray of int, shape (n, n_corner)
        Point ids; one with fewer corners repeats its last point.
    origin : ndarray of int, shape (n_point,)
        The same for points that were one before the film was cut.
    """
    edges, alone = of_one_polygon(polygons, origin.size)
    pair = edges[alone]
    backwards = origin[pair[:, 0]] > origin[pair[:, 1]]
    pair[backwards] = pair[backwards, ::-1]
    key = product(origin[pair], np.array([int(origin.max()) + 1, 1]))
    order = np.argsort(key, kind="stable")
    key, pair = key[order], pair[order]
    _, first, count = np.unique(key, return_index=True, return_counts=True)
    first = first[count == 2]
    return np.asarray(np.stack([pair[first], pair[first + 1]], axis=1))


def crack_tips(state: State) -> dict[int, int]:
    """Return all nodes at which a crack or notch ends, ascending, and the node before it.

    There the two flanks of its last edge meet; for several cracks at a node it is one of them.
    """
    flanks = crack_edges(state.quads, state.node.origin[: state.n_node])
    edge, end = np.nonzero(flanks[:, 0] == flanks[:, 1])
    far = flanks[edge, 0, 1 - end]
    return dict(sorted(zip(flanks[edge, 0, end].tolist(), far.tolist(), strict=True)))


def of_one_polygon(polygons: Ints, n_point: int) -> tuple[Ints, Bools]:
    """Return the edges from each point to the next, and which belong to one polygon only.

    polygons : (n, n_corner), whose shape the results have; a repeated point has no edge.
    """
    edges = np.stack([polygons, np.roll(polygons, -1, axis=1)], axis=2)
    key = product(np.sort(edges, axis=2), np.array([n_point, 1]))
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    alone = count[inverse.reshape(key.shape)] == 1
    return edges, alone & (edges[..., 0] != edges[..., 1])
