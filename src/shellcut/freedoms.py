"""Freedoms of the whole film: numbering, supports, assembled stiffness and mass.

Five freedoms a node: x, y, z and the turns of the director along its unit tangents b_1, b_2 (see
:mod:`shellcut.tangent`). A turn (a_1, a_2) is the spin vector a_1 b_2 - a_2 b_1. Supports hold
translations along axes, which drop out, and spins about axes, which leave those turns whose spin
vector has no part along a held axis: both of them, one direction, or none. The columns of the
sparse matrix Z span what is left, u = Z q.
"""

from __future__ import annotations

import numpy as np
from scipy import sparse

from ._jit import Floats, Ints, kernel
from ._vec3 import load, rotate_director, store
from .shell import MITC4Shell
from .state import State
from .tangent import tangent_basis

# A turn counts as held when its spin about a held axis exceeds this: the sine of an angle between
# a director and an axis that is zero but for round-off.
_HELD = 1e-9


class Freedoms:
    """Freedoms of a state and the ones its supports leave free.

    Attributes
    ----------
    basis : ndarray, shape (n_node, 2, 3)
        Unit tangents b_1, b_2 of every director.
    free : sparse array, shape (5 n_node, n_free)
        Z, from free to all freedoms.
    """

    def __init__(self, state: State) -> None:
        self._state = state
        self.n_node = state.n_node
        self.basis = np.empty((self.n_node, 2, 3))
        _write_bases(t=state.node.t, basis=self.basis)
        self.free = self._free_columns()

    def _free_columns(self) -> sparse.csr_array:
        support = self._state.node.support[: self.n_node]
        row, value, column, n_free = [], [], [], 0
        loose = np.flatnonzero(~support[:, :3].ravel())
        row.append(5 * (loose // 3) + loose % 3)
        column.append(np.arange(loose.size))
        value.append(np.ones(loose.size))
        n_free = loose.size
        held = np.asarray(support[:, 3:].any(axis=1))
        for n in range(self.n_node):
            turns = np.eye(2)
            if held[n]:
                b1, b2 = self.basis[n]
                spin = np.stack([b2, -b1], axis=1)[support[n, 3:]]
                _, size, directions = np.linalg.svd(spin)
                rank = int((size > _HELD).sum())
                turns = directions[rank:].T
            for k in range(turns.shape[1]):
                row.append(5 * n + np.array([3, 4]))
                column.append(np.full(2, n_free))
                value.append(turns[:, k])
                n_free += 1
        parts = (np.concatenate(value), (np.concatenate(row), np.concatenate(column)))
        return sparse.csr_array(sparse.coo_array(parts, shape=(5 * self.n_node, n_free)))

    def stiffness(self, shell: MITC4Shell) -> sparse.csr_array:
        """Assemble the tangent stiffness, shape (5 n_node, 5 n_node)."""
        quads = self._state.quads
        tangent = shell.tangents(self._state, np.arange(quads.shape[0]))
        ids = self._ids(quads)
        row = np.repeat(ids, 20, axis=1).ravel()
        column = np.tile(ids, (1, 20)).ravel()
        size = (5 * self.n_node,) * 2
        return sparse.csr_array(sparse.coo_array((tangent.ravel(), (row, column)), shape=size))

    def _ids(self, quads: Ints) -> Ints:
        translations = 5 * quads[:, :, None] + np.arange(3)
        turns = 5 * quads[:, :, None] + np.arange(3, 5)
        n = quads.shape[0]
        return np.concatenate([translations.reshape(n, 12), turns.reshape(n, 8)], axis=1)

    def diagonal(self, translation: Floats, turn: Floats) -> Floats:
        """Return a vector over all freedoms from values per node, shapes (n_node,)."""
        return np.repeat(np.stack([translation, turn], axis=1), [3, 2], axis=1).ravel()

    def gather(self, force: Floats, director_force: Floats) -> Floats:
        """Return generalised forces from nodal ones, shapes (n_node, 3), over all freedoms."""
        turns = np.einsum("nbi,ni->nb", self.basis, director_force)
        return np.concatenate([force, turns], axis=1).ravel()

    def split(self, u: Floats) -> tuple[Floats, Floats]:
        """Return displacement [mm] and spin vector [rad], shapes (n_node, 3), of a vector u."""
        rows = u.reshape(self.n_node, 5)
        spin = rows[:, 3:4] * self.basis[:, 1] - rows[:, 4:5] * self.basis[:, 0]
        return rows[:, :3], spin

    def move(self, u: Floats) -> None:
        """Move the state by a finite step u: positions and, by rotation, directors."""
        displacement, spin = self.split(u)
        node = self._state.node
        node.x[: self.n_node] += displacement
        _turn_directors(t=node.t, spin=np.ascontiguousarray(spin))


@kernel
def _write_bases(t: Floats, basis: Floats) -> None:
    """Write the tangents of every director into basis : (n_node, 2, 3)."""
    for n in range(basis.shape[0]):
        tangent_basis(t, n, basis[n])


@kernel
def _turn_directors(t: Floats, spin: Floats) -> None:
    """Rotate t : (n_node, 3) by the spin vectors : (n, 3), n <= n_node."""
    for n in range(spin.shape[0]):
        store(t, n, rotate_director(load(t, n), load(spin, n)))
