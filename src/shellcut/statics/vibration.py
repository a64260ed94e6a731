"""Free vibrations about a state: the lowest modes, and the largest frequency.

docs/theory/statics.md says how modes are found and counted. Lanczos' method finds the omega² next
to -shift as the extremes of nu = 1 / (omega² + shift), with solutions corrected through the strains
(:mod:`shellcut.statics.tangent_solver`): the frequencies of thin films are accurate even where the
assembled stiffness is not.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .freedoms import Freedoms
from .tangent_solver import ACCURACY, NoConvergence, TangentSolver, free_rigid_motions

# Modes are counted up to this far below the last mode, relative to it.
_GAP = 1e-5
_MOST_SEARCHES = 10
# Of rigid motions what is more than their round-off, relative to the largest omega².
_SMALL = 1e-12


def lowest_modes(
    state: State, freedoms: Freedoms, shell: MITC4Shell, mass: Floats, n: int
) -> tuple[Floats, Floats]:
    """Return the ``n`` lowest omega², ascending, and their vectors, shape (n_free, n)."""
    rigid = free_rigid_motions(state)
    if n > mass.size - 2:  # more than Lanczos' method can find
        K = freedoms.restrict(freedoms.stiffness(shell)).toarray()
        root = np.sqrt(mass)
        q2, q = np.linalg.eigh(K / np.outer(root, root))
        q2[np.abs(q2) <= (_SMALL * q2[-1] if rigid else 0.0)] = 0.0
        return q2[:n], q[:, :n] / root[:, None]
    q2, q, shift = np.empty(0), np.empty((mass.size, 0)), 0.0
    if rigid:
        # Factors show rigid motions only as round-off: shift all eigenvalues by about the lowest
        # elastic one, so that none is near zero.
        small = _SMALL * largest_eigenvalue(freedoms, shell, mass)
        rough = TangentSolver(state, freedoms, shell, shift=small * mass).rough
        some, _ = _lanczos(min(len(rigid) + 1, mass.size - 2), mass, rough, -small, "LM", q)
        shift = float(np.abs(some).max())
    solver = TangentSolver(state, freedoms, shell, shift=shift * mass)
    n_least = missing = solver.n_negative
    for _ in range(_MOST_SEARCHES):
        least = min(missing, n_least - int((q2 < -shift).sum()))
        next_ = min(max(n - q2.size, missing) - least, n)
        for k, which in ((least, "SA"), (next_, "LA")):
            if k > 0:
                more = _lanczos(k, mass, solver.solve, -shift, which, q)
                q2, q = np.append(q2, more[0]), np.append(q, more[1], axis=1)
        order = np.argsort(q2)[:n]
        end = q2[order[-1]] - _GAP * abs(q2[order[-1]] + shift)
        missing = TangentSolver(state, freedoms, shell, shift=-end * mass).n_negative
        missing -= int((q2 < end).sum())
        if missing <= 0:
            # A rigid motion has no more than the error of solutions.
            return np.where(np.abs(q2) <= 10.0 * ACCURACY * shift, 0.0, q2)[order], q[:, order]
    raise NoConvergence(f"{missing} of the {n} lowest modes were not found")


def largest_eigenvalue(freedoms: Freedoms, shell: MITC4Shell, mass: Floats) -> float:
    """Return the largest omega² [1/s²] of masses on the free freedoms, shape (n_free,)."""
    K = freedoms.restrict(freedoms.stiffness(shell))
    if mass.size == 1:  # Lanczos' method needs at least two
        return float(K.toarray()[0, 0] / mass[0])
    scale = scipy.sparse.diags_array(1.0 / np.sqrt(mass))
    largest = scipy.sparse.linalg.eigsh(
        scale @ K @ scale, k=1, which="LA", return_eigenvectors=False
    )
    return float(largest[0])


def _lanczos(
    n: int,
    mass: Floats,
    solve: Callable[[Floats], Floats],
    sigma: float,
    which: str,
    found: Floats,
) -> tuple[Floats, Floats]:
    """Return ``n`` omega² and their vectors by solutions with K - sigma M.

    Those of which 1 / (omega² - sigma) is least ("SA"), largest ("LA") or far from zero ("LM"),
    beside the modes ``found``, shape (n_free, n_found).
    """
    shape = (mass.size, mass.size)

    def beside(y: Floats) -> Floats:
        return np.asarray(y - found @ (found.T @ (mass * y)))

    q2, q = scipy.sparse.linalg.eigsh(
        scipy.sparse.csc_array(shape),  # K itself is not used
        k=n,
        M=scipy.sparse.csc_array(scipy.sparse.diags_array(mass)),
        sigma=sigma,
        which=which,
        OPinv=scipy.sparse.linalg.LinearOperator(
            shape, matvec=lambda f: beside(solve(f)), dtype=float
        ),
        v0=beside(np.random.default_rng(0).uniform(-1.0, 1.0, mass.size)),
    )
    return q2, q
