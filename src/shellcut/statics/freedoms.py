"""Degrees of freedom of the whole film: numbering, supports, assembled stiffness.

Each node has five freedoms: x, y, z and rotations of the director along two unit tangents b_1, b_2,
with b_1 x b_2 = t. A rotation (a_1, a_2) is the spin vector a_1 b_2 - a_2 b_1. Supports fix
translations along axes, which are removed, and spins about axes, which leave two rotations, one or
none (:mod:`shellcut.loads.supports`). If one is left, b_1 is its direction, so the remaining
motions are always a selection of freedoms and never a combination: ``free``.

The spins of a rotation about the supported axes e_k are e_k · (a_1 b_2 - a_2 b_1), a matrix of two
columns per node. The free rotation is its right singular vector of smallest singular value: for a
single supported axis that value is zero; for two, with f the free axis, it is |t·f|, and the
rotation turns t about f. It then moves t along a cone, not along a great circle, by the spin vector

    a_1 (b_2 + c t),    c = (t·f) / (b_2·f),

which is parallel to f; and since t'' = -t + c b_2 on the cone, the second derivative of the energy
W has the additional term c W_t·b_2.

The free freedoms are in the order of a *nested dissection* (George 1973): the nodes of a strip that
divides the film in two are last, and each of the two parts is ordered in the same manner. Factors
of a stiffness in this order stay sparse, without a search at every factorisation.
"""

from __future__ import annotations

import numpy as np
import scipy

from shellcut.arrays import Floats, Ints
from shellcut.mitc4.shell import MITC4Shell
from shellcut.mitc4.tangent import N_FREEDOM, quad_products, quad_products_change
from shellcut.numerics.jit import kernel
from shellcut.numerics.vec3 import load, rotate_director, store, tangent_basis
from shellcut.state import State

# Sine of the angle between a director and an axis below which it is round-off.
_PARALLEL = 1e-9

# Largest part that is not dissected further; between 8 and 32 nodes it makes no difference.
_SMALL_PART = 16


class Freedoms:
    """Freedoms of a state, and those that its supports leave free."""

    def __init__(self, state: State) -> None:
        self._state = state
        self.n_node = state.n_node
        self.basis = np.empty((self.n_node, 2, 3))
        """Unit tangents b_1, b_2 of every director."""
        self.free = np.empty(0, np.int64)
        """The free ones among the 5 n_node freedoms, in the order of the dissection, (n_free,)."""
        self._cone = np.zeros(self.n_node)
        self._cone_diagonal: Floats | None = None
        order = _dissection(state.node.X[: self.n_node], state.quads)
        self._order = (5 * order[:, None] + np.arange(5)).ravel()
        self._ids = _ids(state.quads)
        self._pattern = _Pattern(self._ids, 5 * self.n_node)
        self.load_stiffness: Floats | None = None
        """Of loads that follow the film, by the translations of quads, (n_quad, 12, 12), [N/mm]."""
        self.update()

    def update(self) -> None:
        """Recompute tangents and free freedoms for the state's present directors."""
        support = self._state.node.support[: self.n_node]
        _write_bases(t=self._state.node.t, basis=self.basis)
        free = np.ones((self.n_node, 5), np.bool_)
        free[:, :3] = ~support[:, :3]
        supported = np.flatnonzero(support[:, 3:].any(axis=1))
        axes = support[supported, 3:]
        b1, b2 = self.basis[supported, 0], self.basis[supported, 1]
        spin = np.where(axes[:, :, None], np.stack([b2, -b1], axis=2), 0.0)
        _, size, direction = np.linalg.svd(spin, full_matrices=False)
        n_axis = axes.sum(axis=1)
        # Of two axes the larger size is 1, the smaller is below 1 unless t is along the third.
        lost = (n_axis == 3) | ((n_axis == 2) & (size[:, 1] > np.sqrt(1.0 - _PARALLEL**2)))
        single = ~lost & (size[:, 0] > _PARALLEL)
        cos, sin = np.where(single, direction[:, 1].T, [[1.0], [0.0]])
        self.basis[supported, 0] = cos[:, None] * b1 + sin[:, None] * b2
        self.basis[supported, 1] = cos[:, None] * b2 - sin[:, None] * b1
        free[supported, 3], free[supported, 4] = ~lost, ~lost & ~single
        self._cone[:] = 0.0
        on_cone = supported[single & (n_axis == 2)]
        axis = ~support[on_cone, 3:]
        t = self._state.node.t[on_cone]
        self._cone[on_cone] = t[axis] / self.basis[on_cone, 1][axis]
        self.free = self._order[free.ravel()[self._order]]

    def stiffness(self, shell: MITC4Shell, bent: Floats | None = None) -> scipy.sparse.csc_array:
        """Assemble the tangent stiffness, shape (5 n_node, 5 n_node), of loads that follow, too.

        ``bent`` is the part of the strains, from :meth:`move`, to leave out of its stresses.
        """
        quads = self._state.quads
        tangent = shell.tangents(self._state, np.arange(quads.shape[0]), bent, self.basis)
        if self.load_stiffness is not None:
            tangent[:, :12, :12] += self.load_stiffness
        self._cone_diagonal = self._cone_stiffness(shell)
        return self._pattern.assemble(tangent, self._cone_diagonal)

    def product(self, shell: MITC4Shell, u: Floats, bent: Floats | None = None) -> Floats:
        """Return the stiffness times a vector over all freedoms, through the strains.

        This equals the product with the last assembled matrix except for round-off, which is much
        smaller for thin films (:mod:`shellcut.mitc4.tangent`).
        """
        displacement, spin = self.split(u)
        turn = np.cross(spin, self._state.node.t[: self.n_node])
        force = self.gather(*shell.tangent_product(self._state, displacement, turn, bent))
        if self.load_stiffness is not None:
            ids = self._ids[:, :12]
            rows = np.einsum("eij,ej->ei", self.load_stiffness, u[ids])
            force += np.bincount(ids.ravel(), rows.ravel(), force.size)
        return force if self._cone_diagonal is None else force + self._cone_diagonal * u

    def _cone_stiffness(self, shell: MITC4Shell) -> Floats | None:
        """Return the contribution of rotations along cones to the diagonal; overwrites forces."""
        if not self._cone.any():
            return None
        node, n = self._state.node, self.n_node
        node.force_rows[:n] = 0.0
        history = self._state.history.copy()
        shell.add_forces(self._state)
        self._state.history[:] = history
        diagonal = np.zeros((n, 5))
        pull = np.einsum("ni,ni->n", self.basis[:, 1], node.director_force[:n])
        diagonal[:, 3] = -self._cone * pull
        return diagonal.ravel()

    def restrict(self, stiffness: scipy.sparse.csc_array) -> scipy.sparse.csc_array:
        """Return the free rows and columns of an assembled stiffness."""
        return self._pattern.restrict(stiffness, self.free)

    def fill(self, q: Floats) -> Floats:
        """Return a vector over all freedoms from one over the free ones, zero elsewhere."""
        u = np.zeros(5 * self.n_node)
        u[self.free] = q
        return u

    def diagonal(self, translation: Floats, turn: Floats) -> Floats:
        """Return a vector over all freedoms from values per node, shapes (n_node,)."""
        return np.repeat(np.stack([translation, turn], axis=1), [3, 2], axis=1).ravel()

    def gather(self, force: Floats, director_force: Floats) -> Floats:
        """Return generalised forces over all freedoms from nodal ones, shapes (n_node, 3)."""
        turns = np.einsum("nbi,ni->nb", self.basis, director_force)
        return np.concatenate([force, turns], axis=1).ravel()

    def split(self, u: Floats) -> tuple[Floats, Floats]:
        """Return displacement [mm] and spin vector [rad], shapes (n_node, 3), of a vector u."""
        rows = u.reshape(self.n_node, 5)
        spin = rows[:, 3:4] * self.basis[:, 1] - rows[:, 4:5] * self.basis[:, 0]
        return rows[:, :3], spin

    def move(self, u: Floats) -> Floats:
        """Move the state by a finite step u: positions and, by rotation, directors.

        Returns the part of the change of strain that is nonlinear in u, shape (n_quad, 16).
        """
        displacement, spin = self.split(u)
        node, quads = self._state.node, self._state.quads
        along = self._cone * u.reshape(self.n_node, 5)[:, 3]
        turn = np.cross(spin, node.t[: self.n_node])
        spin += along[:, None] * node.t[: self.n_node]
        before = node.x[quads], node.t[quads]
        linear = quad_products_change(*before, displacement[quads], turn[quads])
        node.x[: self.n_node] += displacement
        turn_directors(t=node.t, spin=spin)
        self.update()
        return quad_products(node.x[quads], node.t[quads]) - quad_products(*before) - linear


class _Pattern:
    """Positions of the quads' stiffness in the assembled matrix, computed once."""

    def __init__(self, ids: Ints, n: int) -> None:
        row, column = np.repeat(ids, N_FREEDOM, axis=1), np.tile(ids, (1, N_FREEDOM))
        key, slot = np.unique(column.ravel() * n + row.ravel(), return_inverse=True)
        self._n, self._slot, self._row = n, slot, key % n
        self._diagonal = np.searchsorted(key, np.arange(n) * (n + 1))
        self._start = np.searchsorted(key // n, np.arange(n + 1))
        self._free: Ints = np.empty(0, np.int64)
        self._part: scipy.sparse.csc_array = scipy.sparse.csc_array((0, 0))

    def assemble(self, tangent: Floats, diagonal: Floats | None) -> scipy.sparse.csc_array:
        weights, n_entry = tangent.ravel(), self._row.size
        data: Floats = np.bincount(self._slot, weights, n_entry).astype(float, copy=False)
        if diagonal is not None:
            data[self._diagonal] += diagonal
        return self._matrix(data)

    def restrict(self, stiffness: scipy.sparse.csc_array, free: Ints) -> scipy.sparse.csc_array:
        if not np.array_equal(free, self._free):
            self._part = self._matrix(np.arange(self._row.size))[:, free][free, :]
            self._part.sort_indices()  # otherwise a solver would do it, in place
            self._free = free
        p = self._part  # its data are indices of the entries in the full matrix
        return scipy.sparse.csc_array((stiffness.data[p.data], p.indices, p.indptr), shape=p.shape)

    def _matrix(self, data: Floats | Ints) -> scipy.sparse.csc_array:
        return scipy.sparse.csc_array((data, self._row, self._start), shape=(self._n, self._n))


def _dissection(nodes: Floats, quads: Ints) -> Ints:
    """Return the nodes in the order of a nested dissection by their coordinates."""
    n = nodes.shape[0]
    row, column = np.repeat(quads, 4, axis=1).ravel(), np.tile(quads, (1, 4)).ravel()
    touch = scipy.sparse.csr_array((np.ones(row.size), (row, column)), shape=(n, n))
    below = np.zeros(n)

    def dissect(part: Ints) -> list[Ints]:
        if part.size <= _SMALL_PART:
            return [part]
        place = nodes[part]
        along = place[:, np.argmax(np.ptp(place, axis=0))]
        low = along < np.median(along) - 1e-9 * np.ptp(along)
        if not low.any():
            return [part]
        below[part[low]] = 1.0
        strip = ~low & (touch[part] @ below > 0.0)
        below[part[low]] = 0.0
        return [*dissect(part[low]), *dissect(part[~low & ~strip]), part[strip]]

    return np.concatenate(dissect(np.arange(n)))


def _ids(quads: Ints) -> Ints:
    """Return the freedoms of every quad in the order of its stiffness, shape (n_quad, 20)."""
    quads = quads.astype(np.int64)
    translations = 5 * quads[:, :, None] + np.arange(3)
    turns = 5 * quads[:, :, None] + np.arange(3, 5)
    n = quads.shape[0]
    return np.concatenate([translations.reshape(n, 12), turns.reshape(n, 8)], axis=1)


@kernel
def _write_bases(t: Floats, basis: Floats) -> None:
    """Write the tangents of every director into basis : (n_node, 2, 3)."""
    for n in range(basis.shape[0]):
        tangent_basis(t, n, basis[n])


@kernel
def turn_directors(t: Floats, spin: Floats) -> None:
    """Rotate t : (n_node, 3) by the spin vectors : (n, 3), n <= n_node."""
    for n in range(spin.shape[0]):
        store(t, n, rotate_director(load(t, n), load(spin, n)))
