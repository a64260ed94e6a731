"""Connected parts of things linked in pairs."""

from __future__ import annotations

import numpy as np
import scipy

from shellcut.arrays import Ints


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
