"""Connected parts of things linked in pairs."""

from __future__ import annotations

import numpy as np
import scipy

from shellcut.arrays import Floats, Ints

_MOST_PAIRS = 20_000_000  # of different places: 320 MB


def connected_parts(a: Ints, b: Ints, n: int) -> Ints:
    """Return the connected part of each of n things, shape (n,), numbered from 0.

    Parameters
    ----------
    a, b : ndarray of int, shape (n_pair,)
        Links: ``a[k]`` with ``b[k]``.
    n : int
        Number of things.

    Examples
    --------
    >>> connected_parts(np.array([0, 3]), np.array([2, 1]), 5).tolist()
    [0, 1, 0, 1, 2]
    """
    links = scipy.sparse.coo_array((np.ones(len(a), np.int8), (a, b)), shape=(n, n))
    _, label = scipy.sparse.csgraph.connected_components(links, directed=False)
    return np.asarray(label)


def close_parts(points: Floats, reach: float) -> Ints:
    """Return the connected part of each point, those within ``reach`` of each other linked.

    Parameters
    ----------
    points : ndarray, shape (n, k)
    reach : float
        In the unit of the points.

    Returns
    -------
    ndarray of int, shape (n,)
        Numbered from 0, in the order of first appearance.

    Raises
    ------
    ValueError
        If so many different places are within reach that their pairs do not fit into memory.

    Examples
    --------
    >>> close_parts(np.array([[0.0], [2.0], [0.1], [2.0]]), 0.5).tolist()
    [0, 1, 0, 1]
    """
    # Points at one place have as many pairs as the square of their number: they count as a single
    # point.
    order = np.lexsort(points.T)
    differs = (points[order[1:]] != points[order[:-1]]).any(axis=1)
    place = np.zeros(len(points), np.int64)
    place[order[1:]] = np.cumsum(differs)
    places = points[order[np.concatenate([[True], differs])[: len(order)]]]
    tree = scipy.spatial.cKDTree(places)
    n_pair = (tree.count_neighbors(tree, reach) - len(places)) // 2
    if n_pair > _MOST_PAIRS:
        raise ValueError(
            f"different points closer than {reach:.3g} mm to each other must make "
            f"{_MOST_PAIRS:,} pairs at most, got {n_pair:,} of {len(places):,} points: lower the "
            "distance within which points are merged"
        )
    a, b = tree.query_pairs(reach, output_type="ndarray").T
    return by_first_appearance(connected_parts(a, b, len(places))[place])


def by_first_appearance(labels: Ints) -> Ints:
    """Return labels renumbered from 0, in the order of first appearance.

    Examples
    --------
    >>> by_first_appearance(np.array([7, 2, 7, 5])).tolist()
    [0, 1, 0, 2]
    """
    _, first, inverse = np.unique(labels, return_index=True, return_inverse=True)
    rank = np.empty(first.size, dtype=np.int64)
    rank[np.argsort(first, kind="stable")] = np.arange(first.size)
    return np.asarray(rank[inverse])
