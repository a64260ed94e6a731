"""The film around a place: what is connected with it there, however close other film lies.

Two sheets, the walls of a tube or the layers of a fold may be closer together than quads are long.
What is near a place in space is near it in the film only if film leads there: rows that share
nodes, one after the other, all of them within a radius of the place in the reference film and with
directors that agree with the one there.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State


def film_around(
    state: State, shell: MITC4Shell, place: Floats, T: Floats, radius: float, rows: Sequence[int]
) -> Ints:
    """Return the rows around a place that are connected with some, those included.

    Parameters
    ----------
    state, shell : State, MITC4Shell
        The film as it is cut.
    place, T : ndarray, shape (3,)
        In the reference film [mm], and the director there, of any length.
    radius : float
        From the place to the middle of a row at most [mm].
    rows : sequence of int
        At the place.

    Returns
    -------
    ndarray of int, shape (n,)
        Ascending.
    """
    film, found = shell.reference, np.unique(rows)
    ring = found
    while ring.size:
        beside = np.setdiff1d(with_neighbours(state, ring), found)
        quads = film.quads[beside]
        gap = norm(film.x[quads].mean(axis=1) - place)
        ring = beside[(gap < radius) & (product(film.t[quads].sum(axis=1), T) > 0.0)]
        found = np.union1d(found, ring)
    return found


def with_neighbours(state: State, rows: Ints) -> Ints:
    """Return some rows and those that share a node with them, ascending."""
    n, nodes = state.node, np.unique(state.quads[rows])
    at = np.arange(n.quads.shape[1]) < n.n_quad_at[nodes, None]
    return np.unique(n.quads[nodes][at])
