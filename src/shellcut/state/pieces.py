"""The pieces of a film: connected parts, and which of them have no support.

Quads that share a node belong to the same piece; cables do not count. A piece is *supported* if a
support or glue fixes one of its nodes, and *loose* if none does. In a film without any support the
heaviest piece is the film itself, and the others are loose. So a film made of several pieces has
none that is loose as long as each of them is supported.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.numerics.connected_parts import by_first_appearance, connected_parts

from .film import State


@dataclass(frozen=True)
class Pieces:
    """The pieces of a film at some moment, numbered by their first quad.

    Examples
    --------
    >>> quads = np.array([[0, 1, 2, 3], [4, 5, 6, 7], [5, 8, 9, 6]])
    >>> _piece_of_rows(quads, 10).tolist()
    [0, 1, 1]
    """

    of_row: Ints
    """Piece of every quad and copy, shape (n_quad,)."""
    loose: Bools
    """Whether a piece is loose, shape (n_piece,)."""
    mass: Floats
    """Of every piece [t], shape (n_piece,)."""

    @classmethod
    def of(cls, state: State, fixed: Ints | None = None) -> Pieces:
        """Return the pieces of the film as it is now; ``fixed`` nodes count as supported, too."""
        n, quads = state.node, state.quads
        of_row = _piece_of_rows(quads, n.count)
        count = int(of_row.max(initial=-1)) + 1
        of_node = np.full(n.count, -1)
        of_node[quads] = of_row[:, None]
        there = np.flatnonzero(of_node >= 0)
        mass = np.asarray(np.bincount(of_node[there], n.mass[there], count), float)
        supported = np.zeros(count, np.bool_)
        supported[of_node[there[n.supported[there]]]] = True
        if fixed is not None:
            supported[of_node[fixed]] = True
        loose = ~supported
        if loose.all():
            loose[np.argmax(mass)] = False
        return cls(of_row, loose, mass)

    @property
    def n_loose(self) -> int:
        """Number of loose pieces."""
        return int(self.loose.sum())

    def nodes_that_meet_others(self, state: State) -> Bools:
        """Return which nodes belong to a loose piece, or to any but the heaviest, (n_node,).

        Flank points included. Of two pieces that meet, one at least has its nodes among them.
        """
        of_piece = self.loose.copy()
        of_piece |= np.arange(len(self.mass)) != np.argmax(self.mass)
        found, f = np.zeros(state.n_node, np.bool_), state.flank
        found[state.quads[of_piece[self.of_row]]] = True
        found[f.node[: f.count]] = of_piece[self.of_row[f.row[: f.count]]]
        return found


def _piece_of_rows(quads: Ints, n_node: int) -> Ints:
    """Return the piece of every row of quads : (n_quad, 4), numbered by first appearance."""
    n = len(quads)
    # Rows and nodes are linked alike, a row with its four nodes.
    part = connected_parts(np.repeat(np.arange(n), 4), n + quads.ravel(), n + n_node)
    return by_first_appearance(part[:n])
