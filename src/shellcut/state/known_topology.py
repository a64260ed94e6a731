"""The topology for which a part has built its tables: the one rule after a split."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Ints

from .film import SplitRecord, State


class KnownTopology:
    """The topology for which a part has built its tables: the one rule after a split.

    A part asks :meth:`is_of` before it uses tables that a split would change. If the answer is no,
    it builds them again and calls :meth:`take`; :meth:`new_splits` are the splits in between.
    """

    def __init__(self) -> None:
        self._state: State | None = None
        self.revision = -1
        """Of the state, when it was taken last; goes into checkpoints."""

    def is_of(self, state: State) -> bool:
        """Return whether nothing has split since, and it is the same state."""
        if self._state is state:  # of every part in every step
            return self.revision == state.revision
        return self._state is None and self.revision == state.revision

    def take(self, state: State) -> None:
        """Remember the present topology."""
        self._state, self.revision = state, state.revision

    def new_splits(self, state: State) -> list[SplitRecord]:
        """Return the splits since it was taken last; a revision counts the splits before it."""
        return state.split_log[max(self.revision, 0) :]

    def changed_quads(self, state: State) -> Ints:
        """Return the quads that may have got other nodes since it was taken last, ascending."""
        if self.revision > state.revision or (self._state is not None and self._state is not state):
            return np.arange(len(state.quads))
        # A cut changes the nodes of the copies on both its sides, and of those that share them.
        node, new = state.node, self.new_splits(state)
        cut = np.array([row for s in new for row in s.rows if row >= 0], np.int64)
        twins = np.array([s.twin for s in new if s.twin >= 0], np.int64)
        twins = np.union1d(twins, state.quads[cut])
        at = np.arange(node.quads.shape[1]) < node.n_quad_at[twins, None]
        return np.unique(node.quads[twins][at])

    def restore(self, revision: int, state: State | None = None) -> None:
        """Take over ``revision`` from a checkpoint.

        Without ``state`` the next state asked about is the one meant.
        """
        self._state, self.revision = state, revision
