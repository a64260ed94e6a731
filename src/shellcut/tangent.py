"""Tangent stiffness of a quad: the element's own functions, differentiated exactly.

The strains are quadratic and the nodal forces f(u, r) bilinear in u = (positions, directors) and
the resultants r. For any motion d, of any size, with m the scalar products of the strains,

    ds = m(u + d) - m(u) - m(d),        df = f(u, H ds) + f(d, r),

exactly: no difference quotient with its error is formed, and the tangent cannot drift from the
forces. With d of the size of the quad round-off is that of the forces.

Each node has five freedoms: its translation and the turn of its director t along two unit tangents
b_1, b_2, t -> t cos + b sin. On that path the energy has the second derivative b·W_tt·b - t·W_t:
the second term, the *director's curvature*, keeps the tangent symmetric away from equilibrium too.
"""

from __future__ import annotations

import numpy as np

from ._jit import Bools, Floats, Ints, kernel
from ._vec3 import tangent_basis
from .mitc4 import covariant_metric, nodal_forces, resultants

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
    xe, te = np.empty((4, 3)), np.empty((4, 3))
    xd, td = np.empty((4, 3)), np.empty((4, 3))
    fx, ft = np.empty((4, 3)), np.empty((4, 3))
    gx, gt = np.empty((4, 3)), np.empty((4, 3))
    s, r = np.empty(20), np.empty(20)
    m, ds, dr = np.empty(20), np.empty(20), np.empty(20)
    basis = np.empty((4, 2, 3))
    # m(d) of the unit translations; that of a turn is zero: no product has two directors.
    alone = np.zeros((N_FREEDOM, 20))
    for column in range(12):
        for a in range(4):
            for c in range(3):
                xd[a, c] = 1.0 if 3 * a + c == column else 0.0
                td[a, c] = 0.0
        covariant_metric(xd, td, alone[column])
    for i in range(which.shape[0]):
        e = which[i]
        for a in range(4):
            tangent_basis(t, quads[e, a], basis[a])
            for c in range(3):
                # Seen from the first node: round-off is that of the quad's size.
                xe[a, c] = x[quads[e, a], c] - x[quads[e, 0], c]
                te[a, c] = t[quads[e, a], c]
        size = np.sqrt(xe[2, 0] ** 2 + xe[2, 1] ** 2 + xe[2, 2] ** 2)
        covariant_metric(xe, te, m)
        strained = False
        for k in range(20):
            s[k] = m[k] - metric[e, k]
            strained = strained or s[k] != 0.0
        resultants(s, flat[e], h_flat, h_full, row[e], r)
        nodal_forces(xe, te, r, fx, ft)
        for a in range(4):
            along = 0.0
            for c in range(3):
                along += ft[a, c] * te[a, c]
            for b in range(2):
                for column in range(N_FREEDOM):
                    tangent[i, 12 + 2 * a + b, column] = 0.0
                tangent[i, 12 + 2 * a + b, 12 + 2 * a + b] = -along
        for column in range(N_FREEDOM):
            step = size if column < 12 else 1.0
            for a in range(4):
                for c in range(3):
                    xd[a, c] = td[a, c] = 0.0
            if column < 12:
                xd[column // 3, column % 3] = step
            else:
                a, b = (column - 12) // 2, (column - 12) % 2
                for c in range(3):
                    td[a, c] = step * basis[a, b, c]
            for a in range(4):
                for c in range(3):
                    gx[a, c] = xe[a, c] + xd[a, c]
                    gt[a, c] = te[a, c] + td[a, c]
            covariant_metric(gx, gt, ds)
            for k in range(20):
                ds[k] -= m[k] + step * step * alone[column, k]
            resultants(ds, flat[e], h_flat, h_full, row[e], dr)
            nodal_forces(xe, te, dr, fx, ft)
            if strained:
                nodal_forces(xd, td, r, gx, gt)
                for a in range(4):
                    for c in range(3):
                        fx[a, c] += gx[a, c]
                        ft[a, c] += gt[a, c]
            for a in range(4):
                for c in range(3):
                    tangent[i, 3 * a + c, column] = fx[a, c] / step
                for b in range(2):
                    turned = 0.0
                    for c in range(3):
                        turned += ft[a, c] * basis[a, b, c]
                    tangent[i, 12 + 2 * a + b, column] += turned / step
