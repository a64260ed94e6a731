"""Linear solutions of a film: stiffness factors, corrected through the strains.

docs/theory/statics.md says why the assembled stiffness of a very thin film is a preconditioner for
its product through the strains (:mod:`shellcut.mitc4.tangent`), why freedoms are scaled, and how
negative pivots count unstable motions. With M for the factors, A for the product and q for their
solution, e = M⁻¹ (f - A q) is their estimate of the error of q; if it is not small relative to q,
GMRES solves M⁻¹ A dq = e, and dq is added. M⁻¹ A differs from one only in a few of the softest
motions, and about ten products solve the hemisphere of R/h = 1e8 to seven digits. The residual in
GMRES drifts from the true one, so e is recomputed and the remainder solved in the same manner.

Pivots off the diagonal are used only where the diagonal is zero, so the factors stay as sparse as
the order of the freedoms allows. They count the negative eigenvalues of A, too, if the spectral
radius of I - M⁻¹ A is below one: M - t (M - A) is then regular from t = 0 to 1, so that none
changes its sign before the end.

*Condition* is the largest absolute row sum of the scaled stiffness over the energy, through the
strains again, of its softest motion, found by inverse iteration. *Error*: in the softest motions M
may be too stiff by eps times the condition, and underestimates the error there by the same factor.
The reported error is ``|e| / |q|`` times one plus a hundred times that.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cached_property
from typing import Any

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.checks.hold import pieces_of
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .freedoms import Freedoms

_EPS = float(np.finfo(float).eps)

# Arm of a supported node over the size of its part below which it prevents no rotation.
_LEVER = 1e-10

# Wanted accuracy of a solution, and the worst one accepted: the error of any mesh is larger.
ACCURACY = 1e-9
LARGEST_ERROR = 1e-4

_MOST_PRODUCTS = 40
_MOST_CORRECTIONS = 3
_N_INVERSE = 3

# Largest spectral radius of I - M⁻¹ A at which pivots count eigenvalues, and its power iterations.
_ALIKE = 0.1
_N_POWER = 4

# Smallest ratio of a diagonal to its column for a pivot, if factors without this rule fail.
_PIVOT = 0.1

_SINGULAR = "the stiffness is singular: "


class NoConvergence(RuntimeError):
    """No equilibrium or linear solution was found; the message says how far it got, and why."""


class TangentSolver:
    """Solve with the tangent stiffness about the present state, which must not change meanwhile.

    ``bent`` is as in :meth:`shellcut.mitc4.shell.MITC4Shell.tangents`, ``shift``, shape (n_free,),
    is added to the diagonal. NoConvergence is raised if the stiffness cannot be factorised.
    """

    def __init__(
        self,
        state: State,
        freedoms: Freedoms,
        shell: MITC4Shell,
        bent: Floats | None = None,
        *,
        shift: Floats | None = None,
    ) -> None:
        self._state, self._freedoms, self._shell = state, freedoms, shell
        self._bent, self._shift = bent, shift
        K = freedoms.restrict(freedoms.stiffness(shell, bent))
        if shift is not None:
            K = scipy.sparse.csc_array(K + scipy.sparse.diags_array(shift))
            K.sort_indices()
        diagonal = np.abs(K.diagonal())
        self._scale = 1.0 / np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))
        columns = np.repeat(self._scale, np.diff(K.indptr))
        data = K.data * self._scale[K.indices] * columns
        self._matrix = scipy.sparse.csc_array((data, K.indices, K.indptr), shape=K.shape)
        self._factorise(0.0)
        self.missing = 0.0
        """``|e| / |q|`` of the last solution."""

    def _factorise(self, pivot: float) -> None:
        self._pivot = pivot
        try:
            self._factor = _factors(self._matrix, pivot)
        except RuntimeError as error:
            rigid = free_rigid_motions(self._state)
            raise NoConvergence(_SINGULAR + _said(rigid)) from error

    def solve(self, force: Floats, accuracy: float = ACCURACY) -> Floats:
        """Return the solution in the free freedoms for forces on them, shape (n_free,).

        NoConvergence is raised if its estimated error is above 1e-4.
        """
        f = self._scale * force
        y = self._corrected(f, accuracy)
        if not self.missing <= LARGEST_ERROR and self._pivot < _PIVOT:
            self._factorise(_PIVOT)
            y = self._corrected(f, accuracy)
        self.check(self.missing)
        return np.asarray(self._scale * y)

    def rough(self, force: Floats) -> Floats:
        """Return the solution by the factors alone, unchecked."""
        return np.asarray(self._scale * self._factor.solve(self._scale * force))

    def check(self, error: float) -> None:
        """Raise NoConvergence, with the values, if an error is above 1e-4."""
        if error <= LARGEST_ERROR:
            return
        rigid = free_rigid_motions(self._state)
        if rigid:
            raise NoConvergence(_SINGULAR + _said(rigid))
        raise NoConvergence(
            f"the linear solution may be off by {100.0 * error:.2g} %: the condition of the "
            f"stiffness is {self.condition:.2g}, too large for its factors. The film is too thin "
            "for its size, or the path is at a bifurcation"
        )

    @cached_property
    def condition(self) -> float:
        """Largest over smallest stiffness of the scaled freedoms."""
        soft = np.random.default_rng(0).uniform(-1.0, 1.0, self._scale.size)
        for _ in range(_N_INVERSE):
            soft = self._factor.solve(soft)
            soft /= np.abs(soft).max(initial=0.0)
        least = abs(float(soft @ self._product(soft))) / float(soft @ soft)
        largest = float(self._row_sums(np.ones(self._scale.size)).max(initial=0.0))
        return largest / least if least > 0.0 else float("inf")

    @cached_property
    def n_negative(self) -> int:
        """Number of negative eigenvalues of the stiffness, shift included."""
        product, factor, pivots = self._product, self._factor, _pivots(self._factor)
        shift = 100.0 * _EPS * float(self._row_sums(np.ones(self._scale.size)).max())
        while pivots is None or not _departure(factor, product, self._scale.size) <= _ALIKE:
            S = self._matrix + shift * scipy.sparse.eye_array(self._scale.size, format="csc")
            factor = _factors(S, 0.0)
            product, pivots, shift = S.__matmul__, _pivots(factor), 10.0 * shift
        return int((pivots < 0.0).sum())

    @property
    def error(self) -> float:
        """Estimate of the relative error of the last solution, in scaled freedoms."""
        return self.missing * (1.0 + 100.0 * _EPS * self.condition)

    def largest_round_off(self, size: Floats) -> float:
        """Return the largest force caused by round-off of freedoms of these sizes."""
        forces = self._row_sums(size / self._scale) / self._scale
        return _EPS * float(forces.max(initial=0.0))

    def _corrected(self, f: Floats, accuracy: float) -> Floats:
        """Return the solution for scaled forces, and store its remaining error."""
        solve = self._factor.solve
        led = scipy.sparse.linalg.LinearOperator(
            self._matrix.shape, matvec=lambda y: solve(self._product(y)), dtype=float
        )
        y = solve(f)
        for correction in range(_MOST_CORRECTIONS + 1):
            e = np.asarray(solve(f - self._product(y)))
            size = float(np.linalg.norm(y))
            missing = float(np.linalg.norm(e))
            self.missing = missing / size if size > 0.0 else missing
            done = self.missing <= accuracy or not np.isfinite(self.missing)
            if done or correction == _MOST_CORRECTIONS:
                break
            more, _ = scipy.sparse.linalg.gmres(
                led, e, rtol=0.0, atol=accuracy * size, restart=_MOST_PRODUCTS, maxiter=1
            )
            y = y + more
        return np.asarray(y)

    def _product(self, y: Floats) -> Floats:
        q = self._scale * y
        freedoms = self._freedoms
        force = freedoms.product(self._shell, freedoms.fill(q), self._bent)[freedoms.free]
        if self._shift is not None:
            force += self._shift * q
        return np.asarray(self._scale * force)

    def _row_sums(self, size: Floats) -> Floats:
        return np.asarray(abs(self._matrix) @ size)


def _factors(matrix: scipy.sparse.csc_array, pivot: float) -> Any:
    """Return the factors of a symmetric matrix whose rows are already in a good order."""
    return scipy.sparse.linalg.splu(
        matrix,
        permc_spec="NATURAL",
        diag_pivot_thresh=pivot,
        relax=20,
        options={"SymmetricMode": True},
    )


def _pivots(factor: Any) -> Floats | None:
    """Return the pivots D of L D Lᵀ, or None if one lies off the diagonal."""
    on_diagonal = np.array_equal(factor.perm_r, factor.perm_c)
    return np.asarray(factor.U.diagonal()) if on_diagonal else None


def _departure(factor: Any, product: Callable[[Floats], Floats], size: int) -> float:
    """Return about the spectral radius of I - M⁻¹ A for factors of M and the product with A."""
    y = factor.solve(np.random.default_rng(0).uniform(-1.0, 1.0, size))
    largest = 0.0
    for _ in range(_N_POWER):
        y = y / max(float(np.linalg.norm(y)), np.finfo(float).tiny)
        y = y - factor.solve(product(y))
        largest = max(largest, float(np.linalg.norm(y)))
    return largest


def free_rigid_motions(state: State) -> list[str]:
    """Return in words the rigid motions of the present state that its supports leave free."""
    n, node = state.n_node, state.node
    pieces = pieces_of(state.quads, node.x[:n], node.t[:n], node.support[:n], _LEVER)
    where = [
        f" of part {k + 1} of {len(pieces)}" if len(pieces) > 1 else "" for k in range(len(pieces))
    ]
    return [motion + said for (_, free), said in zip(pieces, where, strict=True) for motion in free]


def _said(rigid: list[str]) -> str:
    if not rigid:
        return "the path is at a bifurcation, or a motion is hardly supported"
    return f"a rigid motion is not supported ({', '.join(rigid)})"
