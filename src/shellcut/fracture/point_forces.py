"""The work of forces at points of the film as it slides: their part in the force on a crack's tip.

A tool presses on nodes and flank points of the film and pulls by the cables that its edge bends,
and nodes may be loaded. Such a force F acts on the film that is there. When the reference slides by
q(X) e below the film in space and that moves by q(X) c (:mod:`.tip_force`), film comes to a place
that was q e behind, so that it moves by q (c - dx/de) in all, dx/de being what e has become at the
point. The forces then do

    work = sum F · q (c - dx/de)

per mm of the slide, so that it does not matter how much of what is pressed lies in the domain. The
difference is about the angle by which the flank has turned against the film at the tip; but the
forces of a wedge between the flanks are a hundred times J, and without their work J points back or
aside. Friction acts along the flank, where the difference is that angle squared: it is left out.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.numerics.small_matrices import inverse
from shellcut.state import State

from .quad_polygon import CORNERS, shape_slopes

_AT_CORNERS = np.array([shape_slopes(corner) for corner in CORNERS])


class PointForces:
    """Nodes and flank points that slide, as long as the topology stays.

    Parameters
    ----------
    state : State
        Of the topology.
    rows : ndarray of int, shape (n,)
        Quads and copies of which something slides, ascending.
    X : ndarray, shape (n, 4, 3)
        Their corners in the reference film [mm].
    q : ndarray, shape (n, 4)
        Share of each corner in a slide.
    base : ndarray, shape (n_slide, 3)
        Directions of the slides.
    """

    def __init__(self, state: State, rows: Ints, X: Floats, q: Floats, base: Floats) -> None:
        flank, corners = state.flank, state.quads[rows]
        at = np.flatnonzero(np.isin(flank.row[: flank.count], rows))
        tied = np.searchsorted(rows, flank.row[at])
        of = np.concatenate([np.repeat(np.arange(len(rows)), 4), tied])
        self._node: Ints = np.concatenate([corners.ravel(), flank.node[at]])
        self._nodes: Ints = corners[of]
        # What a node has become is the mean of what its quads make of it.
        _, shared, n = np.unique(self._node, return_inverse=True, return_counts=True)
        own = np.concatenate([q.ravel(), (flank.weight[at] * q[tied]).sum(axis=1)])
        self._q = own / n[shared]
        places = np.array([shape_slopes(place) for place in flank.place[at].tolist()])
        slopes = np.concatenate([np.tile(_AT_CORNERS, (len(rows), 1, 1)), places.reshape(-1, 2, 4)])
        along = product(slopes, X[of])
        back = along.transpose(0, 2, 1)
        self._carry = product(base, back, inverse(product(along, back)), slopes)
        """Weights that give, of the nodes' positions, what the base has become there."""

    def works(self, state: State, force: Floats, moved: Floats) -> Floats:
        """Return what forces do per mm of each slide [N], shape (n_slide,).

        Parameters
        ----------
        state : State
            Present positions.
        force : ndarray, shape (n_node, 3)
            On nodes and flank points [N].
        moved : ndarray, shape (n_slide, 3)
            How far the film in space moves with each slide where q is 1, per mm.
        """
        on = np.flatnonzero(force[self._node].any(axis=1) & (self._q != 0.0))
        F = self._q[on, None] * force[self._node[on]]
        become = product(self._carry[on], state.node.x[self._nodes[on]])
        return np.asarray(np.einsum("nki,ni->k", moved - become, F))
