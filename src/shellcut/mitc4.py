"""The MITC4 element: strains, resultants and nodal forces of one quad.

Total Lagrangian, in convective coordinates xi^1, xi^2 in [-1, 1] ([Frangi2010] 2, eqs. 1-9), with
the transverse shear tied at the mid-edge points ([DvorkinBathe1984]).

=================  ==========================================  =======  =====================
symbol             here                                        unit     source
=================  ==========================================  =======  =====================
a_alpha            ``a1`` at eta = -g, +g; ``a2`` at xi = -g, +g   mm   [Frangi2010] below (3)
t, t_,alpha        director and ``b1``, ``b2``, its derivatives    1    [Frangi2010] (8), (9)
E_alphabeta        strain of the mid-surface                   mm²      [Frangi2010] (5)
K_alphabeta        its slope in xi^3                           mm       [Frangi2010] (5), (8)
2 E_alpha3         transverse shear                            mm       [Frangi2010] (5), (9)
=================  ==========================================  =======  =====================

With x(xi, eta) bilinear, a_1 depends on eta alone and a_2 on xi alone, so that at the 2 x 2 Gauss
points (+-g, +-g), g = 1/sqrt(3), the covariant strains of a quad are twenty numbers, not 32:

====== ============================ ===========================================
rows   strain                       taken at
====== ============================ ===========================================
0-1    E_11                         eta = -g, +g
2-3    E_22                         xi = -g, +g
4-7    2 E_12                       the four Gauss points, counter-clockwise
8-15   K_11, K_22, 2 K_12           the same places
16-17  2 E_13                       tying points (0, -1), (0, +1)
18-19  2 E_23                       tying points (-1, 0), (+1, 0)
====== ============================ ===========================================

Each is half a difference of scalar products, s = m(x, t) - m(X, T): :func:`covariant_metric`
computes m. The energy is W = sum over Gauss points of ½ sᵀ H s with a section stiffness H in
covariant components (:mod:`shellcut.section`), r = dW/ds are the resultants, and the nodal forces
are r · ds/d(x, t): :func:`nodal_forces` is the exact derivative of the energy.

The strain terms in (xi^3)² are dropped: of relative size (thickness / radius of curvature)².
"""

from __future__ import annotations

from math import sqrt

from ._jit import Floats, Numbers, inline
from ._vec3 import add, combine, dot, load, scale, sub

N_STRAIN = 20

_G = 1.0 / sqrt(3.0)
# a_1(eta) = ¼ (1 - eta) (x1 - x0) + ¼ (1 + eta) (x2 - x3): weight of the near and of the far side.
NEAR = 0.25 * (1.0 + _G)
FAR = 0.25 * (1.0 - _G)

# Which of the two values of E_11 (by eta) and of E_22 (by xi) a Gauss point sees.
ETA_SIDE = (0, 0, 1, 1)
XI_SIDE = (0, 1, 1, 0)


@inline
def covariant_metric(x: Numbers, t: Numbers, m: Numbers) -> None:
    """Write the twenty scalar products whose change is the strain.

    Parameters
    ----------
    x, t : ndarray, shape (4, 3)
        Nodal positions [mm] and directors of one quad, counter-clockwise.
    m : ndarray, shape (20,)
        Written: ½ a_1·a_1, ½ a_2·a_2, a_1·a_2, a_1·t_,1, a_2·t_,2, a_1·t_,2 + a_2·t_,1, a_alpha·t.
    """
    x0, x1, x2, x3 = load(x, 0), load(x, 1), load(x, 2), load(x, 3)
    t0, t1, t2, t3 = load(t, 0), load(t, 1), load(t, 2), load(t, 3)
    x01, x32, x03, x12 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
    t01, t32, t03, t12 = sub(t1, t0), sub(t2, t3), sub(t3, t0), sub(t2, t1)
    a1m, a1p = combine(NEAR, x01, FAR, x32), combine(FAR, x01, NEAR, x32)
    a2m, a2p = combine(NEAR, x03, FAR, x12), combine(FAR, x03, NEAR, x12)
    b1m, b1p = combine(NEAR, t01, FAR, t32), combine(FAR, t01, NEAR, t32)
    b2m, b2p = combine(NEAR, t03, FAR, t12), combine(FAR, t03, NEAR, t12)

    m[0] = 0.5 * dot(a1m, a1m)
    m[1] = 0.5 * dot(a1p, a1p)
    m[2] = 0.5 * dot(a2m, a2m)
    m[3] = 0.5 * dot(a2p, a2p)
    m[4] = dot(a1m, a2m)
    m[5] = dot(a1m, a2p)
    m[6] = dot(a1p, a2p)
    m[7] = dot(a1p, a2m)

    m[8] = dot(a1m, b1m)
    m[9] = dot(a1p, b1p)
    m[10] = dot(a2m, b2m)
    m[11] = dot(a2p, b2p)
    m[12] = dot(a1m, b2m) + dot(a2m, b1m)
    m[13] = dot(a1m, b2p) + dot(a2p, b1m)
    m[14] = dot(a1p, b2p) + dot(a2p, b1p)
    m[15] = dot(a1p, b2m) + dot(a2m, b1p)

    # At a mid-edge point a_alpha = ½ (edge) and t = ½ (sum of the edge's directors).
    m[16] = 0.25 * dot(x01, add(t0, t1))
    m[17] = 0.25 * dot(x32, add(t3, t2))
    m[18] = 0.25 * dot(x03, add(t0, t3))
    m[19] = 0.25 * dot(x12, add(t1, t2))


@inline
def resultants(s: Numbers, flat: bool, h_flat: Floats, h_full: Floats, e: int, r: Numbers) -> None:
    """Write r = H s, the derivative of ½ sᵀ H s by the twenty strains.

    Parameters
    ----------
    s : ndarray, shape (20,)
        Covariant strains.
    flat : bool
        Take the compact section stiffness, exact where the reference quad is flat.
    h_flat : ndarray, shape (n_flat, 4, 15)
        Rows of compact stiffness, see :mod:`shellcut.section`; row ``e`` is read if ``flat``.
    h_full : ndarray, shape (n_curved, 4, 8, 8)
        Rows of full stiffness; row ``e`` is read otherwise.
    r : ndarray, shape (20,)
        Written.
    """
    near, far = 2.0 * NEAR, 2.0 * FAR  # ½ (1 ± g): the tied shear at a Gauss point
    for k in range(4):
        r[k] = 0.0
        r[8 + k] = 0.0
        r[16 + k] = 0.0
    for q in range(4):
        i, j = ETA_SIDE[q], XI_SIDE[q]
        e1, e2, e12 = s[i], s[2 + j], s[4 + q]
        k1, k2, k12 = s[8 + i], s[10 + j], s[12 + q]
        w1m, w1p = (near, far) if i == 0 else (far, near)
        w2m, w2p = (near, far) if j == 0 else (far, near)
        g1 = w1m * s[16] + w1p * s[17]
        g2 = w2m * s[18] + w2p * s[19]
        if flat:
            n1 = h_flat[e, q, 0] * e1 + h_flat[e, q, 1] * e2 + h_flat[e, q, 2] * e12
            n2 = h_flat[e, q, 1] * e1 + h_flat[e, q, 3] * e2 + h_flat[e, q, 4] * e12
            n12 = h_flat[e, q, 2] * e1 + h_flat[e, q, 4] * e2 + h_flat[e, q, 5] * e12
            m1 = h_flat[e, q, 6] * k1 + h_flat[e, q, 7] * k2 + h_flat[e, q, 8] * k12
            m2 = h_flat[e, q, 7] * k1 + h_flat[e, q, 9] * k2 + h_flat[e, q, 10] * k12
            m12 = h_flat[e, q, 8] * k1 + h_flat[e, q, 10] * k2 + h_flat[e, q, 11] * k12
            q1 = h_flat[e, q, 12] * g1 + h_flat[e, q, 13] * g2
            q2 = h_flat[e, q, 13] * g1 + h_flat[e, q, 14] * g2
        else:
            v = (e1, e2, e12, k1, k2, k12, g1, g2)
            n1 = n2 = n12 = m1 = m2 = m12 = q1 = q2 = 0.0
            for c in range(8):
                n1 += h_full[e, q, 0, c] * v[c]
                n2 += h_full[e, q, 1, c] * v[c]
                n12 += h_full[e, q, 2, c] * v[c]
                m1 += h_full[e, q, 3, c] * v[c]
                m2 += h_full[e, q, 4, c] * v[c]
                m12 += h_full[e, q, 5, c] * v[c]
                q1 += h_full[e, q, 6, c] * v[c]
                q2 += h_full[e, q, 7, c] * v[c]
        r[i] += n1
        r[2 + j] += n2
        r[4 + q] = n12
        r[8 + i] += m1
        r[10 + j] += m2
        r[12 + q] = m12
        r[16] += w1m * q1
        r[17] += w1p * q1
        r[18] += w2m * q2
        r[19] += w2p * q2


@inline
def nodal_forces(x: Numbers, t: Numbers, r: Numbers, fx: Numbers, ft: Numbers) -> None:
    """Write dW/dx and dW/dt of one quad from its resultants r = dW/ds.

    Parameters
    ----------
    x, t : ndarray, shape (4, 3)
        Nodal positions [mm] and directors.
    r : ndarray, shape (20,)
        Resultants.
    fx, ft : ndarray, shape (4, 3)
        Written: derivative of the energy by position [N] and by director [N·mm].
    """
    x0, x1, x2, x3 = load(x, 0), load(x, 1), load(x, 2), load(x, 3)
    t0, t1, t2, t3 = load(t, 0), load(t, 1), load(t, 2), load(t, 3)
    x01, x32, x03, x12 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
    t01, t32, t03, t12 = sub(t1, t0), sub(t2, t3), sub(t3, t0), sub(t2, t1)
    a1m, a1p = combine(NEAR, x01, FAR, x32), combine(FAR, x01, NEAR, x32)
    a2m, a2p = combine(NEAR, x03, FAR, x12), combine(FAR, x03, NEAR, x12)
    b1m, b1p = combine(NEAR, t01, FAR, t32), combine(FAR, t01, NEAR, t32)
    b2m, b2p = combine(NEAR, t03, FAR, t12), combine(FAR, t03, NEAR, t12)

    # dW/da: N^{alpha beta} a_beta + M^{alpha beta} t_,beta; dW/dt_,alpha: M^{alpha beta} a_beta.
    f1m = combine(r[4], a2m, r[5], a2p)
    f1m = add(f1m, combine(r[0], a1m, r[8], b1m))
    f1m = add(f1m, combine(r[12], b2m, r[13], b2p))
    f1p = combine(r[7], a2m, r[6], a2p)
    f1p = add(f1p, combine(r[1], a1p, r[9], b1p))
    f1p = add(f1p, combine(r[15], b2m, r[14], b2p))
    f2m = combine(r[4], a1m, r[7], a1p)
    f2m = add(f2m, combine(r[2], a2m, r[10], b2m))
    f2m = add(f2m, combine(r[12], b1m, r[15], b1p))
    f2p = combine(r[5], a1m, r[6], a1p)
    f2p = add(f2p, combine(r[3], a2p, r[11], b2p))
    f2p = add(f2p, combine(r[13], b1m, r[14], b1p))
    g1m = add(scale(r[8], a1m), combine(r[12], a2m, r[13], a2p))
    g1p = add(scale(r[9], a1p), combine(r[15], a2m, r[14], a2p))
    g2m = add(scale(r[10], a2m), combine(r[12], a1m, r[15], a1p))
    g2p = add(scale(r[11], a2p), combine(r[13], a1m, r[14], a1p))

    # To the edge vectors, with the tied shear, then to the nodes.
    q01, q32, q03, q12 = 0.25 * r[16], 0.25 * r[17], 0.25 * r[18], 0.25 * r[19]
    f01 = add(combine(NEAR, f1m, FAR, f1p), scale(q01, add(t0, t1)))
    f32 = add(combine(FAR, f1m, NEAR, f1p), scale(q32, add(t3, t2)))
    f03 = add(combine(NEAR, f2m, FAR, f2p), scale(q03, add(t0, t3)))
    f12 = add(combine(FAR, f2m, NEAR, f2p), scale(q12, add(t1, t2)))
    g01, g32 = combine(NEAR, g1m, FAR, g1p), combine(FAR, g1m, NEAR, g1p)
    g03, g12 = combine(NEAR, g2m, FAR, g2p), combine(FAR, g2m, NEAR, g2p)
    for c in range(3):
        fx[0, c] = -f01[c] - f03[c]
        fx[1, c] = f01[c] - f12[c]
        fx[2, c] = f32[c] + f12[c]
        fx[3, c] = f03[c] - f32[c]
        ft[0, c] = -g01[c] - g03[c] + q01 * x01[c] + q03 * x03[c]
        ft[1, c] = g01[c] - g12[c] + q01 * x01[c] + q12 * x12[c]
        ft[2, c] = g32[c] + g12[c] + q32 * x32[c] + q12 * x12[c]
        ft[3, c] = g03[c] - g32[c] + q32 * x32[c] + q03 * x03[c]
