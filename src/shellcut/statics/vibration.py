"""Free vibrations about a state: the lowest modes, and the largest frequency.

Lanczos' method on K⁻¹ M finds the lowest modes, with solutions corrected through the strains
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
from .rigid_motions import free_rigid_motions
from .tangent_solver import ACCURACY, NoConvergence, TangentSolver

_GAP = 1e-5


def lowest_modes(
    state: State, freedoms: Freedoms, shell: MITC4Shell, mass: Floats, n: int
) -> tuple[Floats, Floats]:
    """Return the ``n`` lowest omega², ascending, and their vectors, shape (n_free, n)."""
    if n > mass.size - 2:  # more than Lanczos' method can find
        K = freedoms.restrict(freedoms.stiffness(shell)).toarray()
        root = np.sqrt(mass)
        q2, q = np.linalg.eigh(K / np.outer(root, root))
        return q2[:n], q[:, :n] / root[:, None]
    solver, shift = TangentSolver(state, freedoms, shell), 0.0
    rigid = free_rigid_motions(freedoms, state)
    if rigid:
        # Factors show rigid motions only as round-off: shift all eigenvalues by about the lowest
        # elastic one, so that none is near zero.
        n_rough = min(max(n, len(rigid) + 1), mass.size - 2)
        rough, _ = _lanczos(n_rough, mass, solver.rough, 0.0, "LM")
        shift = float(np.abs(rough).max())
        solver = TangentSolver(state, freedoms, shell, shift=shift * mass)
    # Of 1 / (omega² + shift) the least are those of all omega² below -shift, the largest the next.
    below = solver.n_negative
    some = [
        _lanczos(k, mass, solver.solve, -shift, which)
        for k, which in ((below, "SA"), (n - below, "LA"))
        if k > 0
    ]
    q2, q = np.concatenate([s[0] for s in some]), np.concatenate([s[1] for s in some], axis=1)
    order = np.argsort(q2)[:n]
    q2, q = q2[order], q[:, order]
    # Sturm's count: as many are below the last one.
    end = q2[-1] - _GAP * abs(q2[-1] + shift)
    n_below = TangentSolver(state, freedoms, shell, shift=-end * mass).n_negative
    if n_below != (q2 < end).sum():
        raise NoConvergence(f"{n_below} below, found {q2}")
    q2[np.abs(q2) <= ACCURACY * shift] = 0.0
    return q2, q


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
    n: int, mass: Floats, solve: Callable[[Floats], Floats], sigma: float, which: str
) -> tuple[Floats, Floats]:
    """Return the ``n`` omega² next to ``sigma``, ascending, and their vectors, by K - sigma M."""
    shape = (mass.size, mass.size)
    q2, q = scipy.sparse.linalg.eigsh(
        scipy.sparse.csc_array(shape),  # K itself is not used
        k=n,
        M=scipy.sparse.csc_array(scipy.sparse.diags_array(mass)),
        sigma=sigma,
        which=which,
        OPinv=scipy.sparse.linalg.LinearOperator(shape, matvec=solve, dtype=float),
        v0=np.random.default_rng(0).uniform(-1.0, 1.0, mass.size),
    )
    return q2, q
