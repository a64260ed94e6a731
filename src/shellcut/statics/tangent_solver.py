"""Linear answers of a film: factors of its stiffness, corrected through its strains.

A thin film resists bending (h/R)² as much as stretching. Where that is near the last digit, an
assembled stiffness no longer knows what bending costs: its entries are sums that stretching
dominates, and their round-off is a stiffness of its own. What it says of a hemisphere of R/h = 1e6
on 64 x 64 quads is off by several per cent, whoever solves it.

The product of the tangent with a motion does know, for it goes through the strains
(:mod:`shellcut.mitc4.tangent`). So the factors only lead the way. With M for them, A for the
product and q for what they say, e = M⁻¹ (f - A q) is what q misses, as they see it; if it is not
small beside q, GMRES solves M⁻¹ A dq = e, and dq is added. M⁻¹ A differs from one in the few
softest motions only, and some ten products bring the hemisphere of R/h = 1e8 to seven digits. What
GMRES believes to have solved drifts from what it has: e is taken anew, and what is still missing is
solved for in the same way.

*Scale.* Freedoms are scaled so that the diagonal of the stiffness is one: displacements in mm and
turns in rad then compare, and so do the errors of both. Pivots are taken off the diagonal only
where it is zero, which keeps the factors as sparse as the order of the freedoms makes them.

*Condition* is the largest absolute row sum of the scaled stiffness over the energy, through the
strains again, of its softest motion, found by inverse iteration.

*Error.* In the softest motions M may be too stiff by eps times the condition, and sees so much less
of what is missing there. The error that is told is ``|e| / |q|`` times one plus a hundred times
that.
"""

from __future__ import annotations

from functools import cached_property

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .freedoms import Freedoms
from .rigid_motions import free_rigid_motions

_EPS = float(np.finfo(float).eps)

# What is wanted of an answer, and the most that is let through: any mesh errs more.
ACCURACY = 1e-9
LARGEST_ERROR = 1e-4

_MOST_PRODUCTS = 40
_MOST_CORRECTIONS = 3
_N_INVERSE = 3

# Share of its column that a diagonal must have to be a pivot, where factors without led nowhere.
_PIVOT = 0.1

_SINGULAR = "the stiffness is singular: "


class NoConvergence(RuntimeError):
    """No equilibrium or linear answer was found; the message says how far it came, and why."""


class TangentSolver:
    """Solve with the tangent stiffness about the present state.

    Parameters
    ----------
    state : State
        It must stay where it is while the solver is used.
    freedoms : Freedoms
        Of the state.
    shell : MITC4Shell
        The film.
    bent : ndarray, shape (n_quad, 16), optional
        As of :meth:`shellcut.mitc4.shell.MITC4Shell.tangents`.
    shift : ndarray, shape (n_free,), optional
        Added to the diagonal.

    Raises
    ------
    NoConvergence
        If the stiffness has no factors.
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
        """``|e| / |q|`` of the last answer."""

    def _factorise(self, pivot: float) -> None:
        self._pivot = pivot
        try:
            # The order is that of the free freedoms.
            self._factor = scipy.sparse.linalg.splu(
                self._matrix,
                permc_spec="NATURAL",
                diag_pivot_thresh=pivot,
                relax=20,
                options={"SymmetricMode": True},
            )
        except RuntimeError as error:
            rigid = free_rigid_motions(self._freedoms, self._state)
            raise NoConvergence(_SINGULAR + _said(rigid)) from error

    def solve(self, force: Floats, accuracy: float = ACCURACY) -> Floats:
        """Return the answer of the free freedoms to forces on them, shape (n_free,).

        Raises
        ------
        NoConvergence
            If what is seen to be missing is more than 1e-4 of it.
        """
        f = self._scale * force
        y = self._corrected(f, accuracy)
        if not self.missing <= LARGEST_ERROR and self._pivot < _PIVOT:
            self._factorise(_PIVOT)
            y = self._corrected(f, accuracy)
        self.check(self.missing)
        return np.asarray(self._scale * y)

    def rough(self, force: Floats) -> Floats:
        """Return what the factors say, unchecked."""
        return np.asarray(self._scale * self._factor.solve(self._scale * force))

    def check(self, error: float) -> None:
        """Raise NoConvergence, with the figures, if an error is above 1e-4."""
        if error <= LARGEST_ERROR:
            return
        rigid = free_rigid_motions(self._freedoms, self._state)
        if rigid:
            raise NoConvergence(_SINGULAR + _said(rigid))
        raise NoConvergence(
            f"the linear answer may be off by {100.0 * error:.2g} %: the condition of the "
            f"stiffness is {self.condition:.2g}, and its factors are no guide any more. The film "
            "is too thin for its size, or the path is at a bifurcation"
        )

    @cached_property
    def condition(self) -> float:
        """Largest over least stiffness, both of the scaled freedoms."""
        soft = np.random.default_rng(0).uniform(-1.0, 1.0, self._scale.size)
        for _ in range(_N_INVERSE):
            soft = self._factor.solve(soft)
            soft /= np.abs(soft).max(initial=0.0)
        least = abs(float(soft @ self._product(soft))) / float(soft @ soft)
        largest = float(self._row_sums(np.ones(self._scale.size)).max(initial=0.0))
        return largest / least if least > 0.0 else float("inf")

    @property
    def error(self) -> float:
        """Estimate of the relative error of the last answer, in scaled freedoms."""
        return self.missing * (1.0 + 100.0 * _EPS * self.condition)

    def largest_round_off(self, size: Floats) -> float:
        """Return the force that last digits of freedoms of these sizes make, at most."""
        forces = self._row_sums(size / self._scale) / self._scale
        return _EPS * float(forces.max(initial=0.0))

    def _corrected(self, f: Floats, accuracy: float) -> Floats:
        """Return the answer to scaled forces, and keep what it misses."""
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


def _said(rigid: list[str]) -> str:
    if not rigid:
        return "the path is at a bifurcation, or a motion is hardly supported"
    return f"a rigid motion is not supported ({', '.join(rigid)})"
