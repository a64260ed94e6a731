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

from ._jit import Bools, Floats, Ints, kernel
from ._vec3 import tangent_basis
from .mitc4 import covariant_metric, nodal_forces, resultants

# Complex step relative to nothing: its square, 1e-60, is far below any real part.
_STEP = 1e-30

N_FREEDOM = 20
"""Freedoms of a quad: twelve translations, then two turns a node."""


@kernel
def quad_tangents(
    which: Ints,
    x: Floats,
    t: Floats,
    quads: Ints,
    metric: Floats,
    flat: Bools,
    row: Ints,
    h_flat: Floats,
    h_full: Floats,
    tangent: Floats,
) -> None:
    """Write the stiffness of the quads ``which`` into tangent : (n, 20, 20).

    Rows and columns: x, y, z of the four nodes, then the turns along b_1, b_2 of the four nodes.
    The other arguments as the force kernel's.
    """
    xe, te = np.empty((4, 3), np.complex128), np.empty((4, 3), np.complex128)
    fx, ft = np.empty((4, 3), np.complex128), np.empty((4, 3), np.complex128)
    s, r = np.empty(20, np.complex128), np.empty(20, np.complex128)
    basis = np.empty((4, 2, 3))
    for i in range(which.shape[0]):
        e = which[i]
        for a in range(4):
            tangent_basis(t, quads[e, a], basis[a])
        for column in range(N_FREEDOM):
            for a in range(4):
                for c in range(3):
                    xe[a, c] = x[quads[e, a], c]
                    te[a, c] = t[quads[e, a], c]
            if column < 12:
                xe[column // 3, column % 3] += _STEP * 1j
            else:
                a, b = (column - 12) // 2, (column - 12) % 2
                for c in range(3):
                    te[a, c] += _STEP * 1j * basis[a, b, c]
            covariant_metric(xe, te, s)
            for k in range(20):
                s[k] -= metric[e, k]
            resultants(s, flat[e], h_flat, h_full, row[e], r)
            nodal_forces(xe, te, r, fx, ft)
            for a in range(4):
                for c in range(3):
                    tangent[i, 3 * a + c, column] = fx[a, c].imag / _STEP
                for b in range(2):
                    turned = 0.0
                    for c in range(3):
                        turned += ft[a, c].imag * basis[a, b, c]
                    tangent[i, 12 + 2 * a + b, column] = turned / _STEP
        for a in range(4):
            along = 0.0
            for c in range(3):
                along += ft[a, c].real * t[quads[e, a], c]
            for b in range(2):
                tangent[i, 12 + 2 * a + b, 12 + 2 * a + b] -= along
