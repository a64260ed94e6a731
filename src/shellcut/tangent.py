"""Tangent stiffness of a quad: the element kernel itself, differentiated.

The nodal forces are polynomials in positions and directors, so the kernel runs on complex numbers
as it stands, and f(x + i s) has the imaginary part s df/dx exact to round-off for any tiny s: no
difference is formed. The tangent thus cannot drift from the forces.

Each node has five freedoms: its translation and the turn of its director t along two unit tangents
b_1, b_2, t -> t cos + b sin. On that path the energy has the second derivative b·W_tt·b - t·W_t:
the second term, the *director's curvature*, keeps the tangent symmetric away from equilibrium too.
"""

from __future__ import annotations

import numpy as np

from ._jit import Floats, Ints, SmallIds, kernel
from ._vec3 import load, tangent_basis
from .lanes import WIDTH
from .mitc4 import N_STRAIN, modes, nodal_forces, pick16, products
from .quad_forces import (
    LinearTables,
    flat_strain,
    full_strain,
    stiffness_product,
    store_strain,
)

# Complex step relative to nothing: its square, 1e-60, is far below any real part.
_STEP = 1e-30

N_FREEDOM = 20
"""Freedoms of a quad: twelve translations, then two turns a node."""


@kernel
def reference_products(X: Floats, T: Floats) -> Floats:
    """Return the sixteen products of quads, shape (n_quad, 16).

    X, T : (n_quad, 4, 3), positions [mm] and directors.
    """
    m = np.empty((X.shape[0], N_STRAIN))
    for e in range(X.shape[0]):
        row = products(
            modes(load(X[e], 0), load(X[e], 1), load(X[e], 2), load(X[e], 3)),
            modes(load(T[e], 0), load(T[e], 1), load(T[e], 2), load(T[e], 3)),
        )
        for k in range(N_STRAIN):
            m[e, k] = row[k]
    return m


@kernel
def quad_tangents(
    slot: Ints,
    x: Floats,
    t: Floats,
    corner: SmallIds,
    tables: LinearTables,
    bent: Floats,
    tangent: Floats,
) -> None:
    """Write the stiffness of the quads at the places ``slot`` into tangent : (n, 20, 20).

    Rows and columns: x, y, z of the four nodes, then the turns along b_1, b_2 of the four nodes.
    bent : (n, 16), taken off the strains.  The other arguments as the force kernel's.
    """
    basis = np.empty((4, 2, 3))
    strain = np.empty((1, N_STRAIN, WIDTH), np.complex128)
    work = np.empty((2, N_STRAIN, WIDTH), np.complex128)
    xe, te = np.empty((4, 3), np.complex128), np.empty((4, 3), np.complex128)
    curvature = np.empty(4)
    for i in range(slot.shape[0]):
        b, lane = slot[i] // WIDTH, slot[i] % WIDTH
        for a in range(4):
            tangent_basis(t, corner[b, a, lane], basis[a])
        for column in range(N_FREEDOM):
            for a in range(4):
                for c in range(3):
                    xe[a, c] = x[corner[b, a, lane], c]
                    te[a, c] = t[corner[b, a, lane], c]
            if column < 12:
                xe[column // 3, column % 3] += _STEP * 1j
            else:
                a, d = (column - 12) // 2, (column - 12) % 2
                for c in range(3):
                    te[a, c] += _STEP * 1j * basis[a, d, c]
            xm = modes(load(xe, 0), load(xe, 1), load(xe, 2), load(xe, 3))
            tm = modes(load(te, 0), load(te, 1), load(te, 2), load(te, 3))
            if b < tables.n_flat:
                s = flat_strain(tables, b, lane, xm, tm)
            else:
                s = full_strain(tables, b, lane, xm, tm)
            store_strain(strain, 0, 0, s)
            for k in range(N_STRAIN):
                strain[0, k, 0] -= bent[i, k]
            s = pick16(strain, 0, 0)
            r = stiffness_product(tables, b < tables.n_flat, b, lane, s, work)
            forces = nodal_forces(xm, tm, r)
            for a in range(4):
                for c in range(3):
                    tangent[i, 3 * a + c, column] = -forces[a][c].imag / _STEP
                for d in range(2):
                    turned = 0.0
                    for c in range(3):
                        turned -= forces[a][3 + c].imag * basis[a, d, c]
                    tangent[i, 12 + 2 * a + d, column] = turned / _STEP
            if column == 0:
                for a in range(4):
                    along = 0.0
                    for c in range(3):
                        along -= forces[a][3 + c].real * te[a, c].real
                    curvature[a] = along
        for a in range(4):
            for d in range(2):
                tangent[i, 12 + 2 * a + d, 12 + 2 * a + d] -= curvature[a]


@kernel
def largest_eigenvalues(tangent: Floats, mass: Floats, inertia: Floats, squared: Floats) -> None:
    """Write the largest eigenvalue of M⁻¹ K of single quads [1/s²] into squared : (n,).

    tangent : (n, 20, 20).  mass, inertia : (n, 4), each quad's own share at its nodes.
    """
    scale = np.empty(N_FREEDOM)
    for i in range(tangent.shape[0]):
        for a in range(4):
            for c in range(3):
                scale[3 * a + c] = 1.0 / np.sqrt(mass[i, a])
            for b in range(2):
                scale[12 + 2 * a + b] = 1.0 / np.sqrt(inertia[i, a])
        for k in range(N_FREEDOM):
            for j in range(N_FREEDOM):
                tangent[i, k, j] *= scale[k] * scale[j]
        squared[i] = np.linalg.eigvalsh(tangent[i])[-1]
