"""The MITC4 element: strains, resultants and nodal forces of a quad.

Total Lagrangian, in convective coordinates xi, eta in [-1, 1] ([Frangi2010] 2, eqs. 1-9), with the
transverse shear tied at the mid-edge points ([DvorkinBathe1984]). All functions here take numbers:
of one quad, or of a whole block (:mod:`shellcut.numerics.lanes`).

**Modes.** The bilinear mid-surface 4 x = m + xi p + eta q + xi eta h has the modes

    p = -x0 + x1 + x2 - x3,   q = -x0 - x1 + x2 + x3,   h = x0 - x1 + x2 - x3,   m = sum of x,

so that 4 a_1 = p + eta h and 4 a_2 = q + xi h ([Frangi2010] below (3)). The directors t have the
same modes, written tp, tq, th, tm, with 4 t_,1 = tp + eta th and 4 t_,2 = tq + xi th.

**Strains.** Because a_1 depends only on eta and a_2 only on xi, sixteen scalar products of modes
give all strains of the quad:

====== ====================================== ======================================
row    product                                gives ([Frangi2010] 5, 8, 9)
====== ====================================== ======================================
0-2    ½ p·p, ½ q·q, ½ h·h                    16 E_11 = s0 + eta s4 + eta² s2
3-5    p·q, p·h, q·h                          16 E_22 = s1 + xi s5 + xi² s2
..                                            16 2E_12 = s3 + xi s4 + eta s5 + 2 xi eta s2
6-8    p·tp, q·tq, h·th                       K_11, K_22, 2K_12: as E, from s6 to s11,
9-11   p·tq+q·tp, p·th+h·tp, q·th+h·tq        because K is the change of E along t
12-13  p·tm+h·tq, p·tq+h·tm                   16 2E_13 = s12 + eta s13
14-15  q·tm+h·tp, q·tp+h·tm                   16 2E_23 = s14 + xi s15
====== ====================================== ======================================

each minus its value on the reference surface. The last two rows are exactly the tied shear: a_1·t
at the tying points (0, -1), (0, +1) and a_2·t at (-1, 0), (+1, 0), interpolated linearly.

**Resultants and forces.** The energy of a linear material is W = ½ sᵀ H s, exact for 2 x 2 Gauss
points (:mod:`shellcut.mitc4.section`); r = dW/ds are the resultants, and the nodal forces are
r · ds/d(x, t): :func:`nodal_forces` is the exact derivative of the energy.

The strain terms in (xi³)² are dropped: of relative size (thickness / radius of curvature)².
"""

from __future__ import annotations

from math import sqrt
from typing import Any, NamedTuple, TypeAlias

from shellcut.arrays import Floats, Number, SmallIds, Vector
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import (
    corner_node,
    first_node,
    multiply_add,
    pick,
    pick_all,
    put,
    put_all,
    vector_at,
    zero,
)
from shellcut.numerics.vec3 import add, add_scaled, scale, sub

N_STRAIN = 16
"""Number of strains of a quad, and of resultants."""

N_FLAT_PRODUCT, N_FLAT = 6, 10
"""Non-zero products on the reference surface of a flat quad, and all its numbers."""

N_FULL = 136
"""Entries of the upper triangle of the 16 x 16 stiffness."""

G = 1.0 / sqrt(3.0)
GAUSS = ((-G, -G), (G, -G), (G, G), (-G, G))
"""The Gauss points (xi, eta), counter-clockwise."""

Modes: TypeAlias = tuple[Vector, Vector, Vector, Vector]
Sixteen: TypeAlias = tuple[Number, ...]
Six: TypeAlias = tuple[Number, Number, Number, Number, Number, Number]
Four: TypeAlias = tuple[Number, Number, Number, Number]
Three: TypeAlias = tuple[Number, Number, Number]
Pair: TypeAlias = tuple[Number, Number]


@always_inline
def modes(v0: Vector, v1: Vector, v2: Vector, v3: Vector) -> Modes:
    """Return p, q, h and m of four corner vectors."""
    # Eight additions of vectors in the place of twelve.
    a, b = sub(v2, v0), sub(v1, v3)
    c, d = add(v0, v2), add(v1, v3)
    return add(a, b), sub(a, b), sub(c, d), add(c, d)


@always_inline
def moved_modes(v: Modes, step: float, d: Modes) -> Modes:
    """Return v + step d."""
    return (
        add_scaled(v[0], step, d[0]),
        add_scaled(v[1], step, d[1]),
        add_scaled(v[2], step, d[2]),
        add_scaled(v[3], step, d[3]),
    )


@always_inline
def quad_modes(x: Floats, t: Floats, corner: SmallIds, b: int, lane: Lane) -> tuple[Modes, Modes]:
    """Return the modes of positions and of directors.

    x, t : (n_node, 3).  corner : (n_block, 4, width).
    """
    n0, n1 = corner_node(corner, b, 0, lane), corner_node(corner, b, 1, lane)
    n2, n3 = corner_node(corner, b, 2, lane), corner_node(corner, b, 3, lane)
    return _modes_at(x, n0, n1, n2, n3, lane), _modes_at(t, n0, n1, n2, n3, lane)


@always_inline
def chain_modes(x: Floats, t: Floats, corner: SmallIds, b: int, lane: Lane) -> tuple[Modes, Modes]:
    """Return :func:`quad_modes` of a block with consecutive node ids at every corner."""
    n0, n1 = first_node(corner, b, 0, lane), first_node(corner, b, 1, lane)
    n2, n3 = first_node(corner, b, 2, lane), first_node(corner, b, 3, lane)
    return _modes_at(x, n0, n1, n2, n3, lane), _modes_at(t, n0, n1, n2, n3, lane)


@always_inline
def _modes_at(v: Floats, n0: Any, n1: Any, n2: Any, n3: Any, lane: Lane) -> Modes:
    return modes(
        vector_at(v, n0, lane),
        vector_at(v, n1, lane),
        vector_at(v, n2, lane),
        vector_at(v, n3, lane),
    )


@always_inline
def _dot(a: Vector, b: Vector) -> Number:
    """Return a · b with fixed rounding, so that strains at rest are exactly zero."""
    return multiply_add(a[2], b[2], multiply_add(a[1], b[1], a[0] * b[0]))


@always_inline
def products(x: Modes, t: Modes) -> Sixteen:
    """Return the sixteen scalar products whose changes are the strains."""
    p, q, h, _ = x
    tp, tq, th, tm = t
    # The sums of two products share these; see the table at the head of this module.
    ptq, qtp, htp, htq, htm = _dot(p, tq), _dot(q, tp), _dot(h, tp), _dot(h, tq), _dot(h, tm)
    return (
        0.5 * _dot(p, p),
        0.5 * _dot(q, q),
        0.5 * _dot(h, h),
        _dot(p, q),
        _dot(p, h),
        _dot(q, h),
        _dot(p, tp),
        _dot(q, tq),
        _dot(h, th),
        ptq + qtp,
        _dot(p, th) + htp,
        _dot(q, th) + htq,
        _dot(p, tm) + htq,
        ptq + htm,
        _dot(q, tm) + htp,
        qtp + htm,
    )


@always_inline
def mode_forces(x: Modes, t: Modes, r: Sixteen) -> tuple[Vector, ...]:
    """Return r · ds/d(p, q, h) and r · ds/d(tp, tq, th, tm)."""
    p, q, h, _ = x
    tp, tq, th, tm = t
    # A product that stands in two strains, as p·tq in s9 and s13, pulls with both resultants.
    p_tq, q_tp, h_tm = r[9] + r[13], r[9] + r[15], r[13] + r[15]
    h_tp, h_tq = r[10] + r[14], r[11] + r[12]
    fp = add_scaled(add_scaled(scale(r[0], p), r[3], q), r[4], h)
    fp = add_scaled(add_scaled(fp, r[6], tp), p_tq, tq)
    fp = add_scaled(add_scaled(fp, r[10], th), r[12], tm)
    fq = add_scaled(add_scaled(scale(r[1], q), r[3], p), r[5], h)
    fq = add_scaled(add_scaled(fq, r[7], tq), q_tp, tp)
    fq = add_scaled(add_scaled(fq, r[11], th), r[14], tm)
    fh = add_scaled(add_scaled(scale(r[2], h), r[4], p), r[5], q)
    fh = add_scaled(add_scaled(fh, r[8], th), h_tp, tp)
    fh = add_scaled(add_scaled(fh, h_tq, tq), h_tm, tm)
    gp = add_scaled(add_scaled(scale(r[6], p), q_tp, q), h_tp, h)
    gq = add_scaled(add_scaled(scale(r[7], q), p_tq, p), h_tq, h)
    gh = add_scaled(add_scaled(scale(r[8], h), r[10], p), r[11], q)
    gm = add_scaled(add_scaled(scale(r[12], p), r[14], q), h_tm, h)
    return fp, fq, fh, gp, gq, gh, gm


@always_inline
def nodal_forces(x: Modes, t: Modes, r: Sixteen) -> tuple[tuple[Number, ...], ...]:
    """Return minus dW/dx [N] and minus dW/dt [N·mm] of the four corners, six numbers each.

    Parameters
    ----------
    x, t : Modes
        Of positions [mm] and of directors.
    r : sixteen numbers
        Resultants.
    """
    fp, fq, fh, gp, gq, gh, gm = mode_forces(x, t, r)
    # The chain rule of the modes: x0 is in p and q with -1 and in h with +1, and so on; no strain
    # depends on m of the positions.
    f_sum, f_difference = add(fp, fq), sub(fp, fq)
    g_sum, g_difference = add(gp, gq), sub(gp, gq)
    g_even, g_odd = add(gm, gh), sub(gm, gh)
    return (
        sub(f_sum, fh) + sub(g_sum, g_even),
        sub(fh, f_difference) + sub(scale(-1.0, g_odd), g_difference),
        sub(scale(-1.0, f_sum), fh) + sub(scale(-1.0, g_even), g_sum),
        add(f_difference, fh) + sub(g_difference, g_odd),
    )


# ---------------------------------------------------------------- linear material: r = H s


class FlatModuli(NamedTuple):
    """Constants shared by the stiffness of all flat quads, see :func:`flat_resultants`."""

    bending: float
    """Bending over membrane stiffness [mm²]."""
    lateral: float
    """Twice the in-plane shear modulus over C_11: 1 - nu if there is one nu."""
    shear: float
    """Transverse shear stiffness over 8 C_11."""


@always_inline
def _at_gauss_points(c: Six) -> tuple[Pair, Pair, Four]:
    """Return 16 E_11 at eta = -G, G, 16 E_22 at xi = -G, G and 16 2E_12 at the Gauss points."""
    # eta² = xi² = 1/3 at all Gauss points, xi eta = 1/3 at two and -1/3 at two.
    even = (1.0 / 3.0) * c[2]
    e11, e22 = c[0] + even, c[1] + even
    alike, apart = c[3] + 2.0 * even, c[3] - 2.0 * even
    by_eta, by_xi = G * c[4], G * c[5]
    on, off = by_eta + by_xi, by_eta - by_xi
    return (
        (e11 - by_eta, e11 + by_eta),
        (e22 - by_xi, e22 + by_xi),
        (alike - on, apart + off, alike + on, apart - off),
    )


@always_inline
def _from_gauss_points(n0: Three, n1: Three, n2: Three, n3: Three) -> Six:
    """Return the resultants of n11, n22, n12 at the Gauss points: the transpose."""
    low11, high11, low22, high22 = n0[0] + n1[0], n2[0] + n3[0], n0[1] + n3[1], n1[1] + n2[1]
    sum11, sum22 = low11 + high11, low22 + high22
    alike, apart = n0[2] + n2[2], n1[2] + n3[2]
    on, off = n2[2] - n0[2], n1[2] - n3[2]
    return (
        sum11,
        sum22,
        (1.0 / 3.0) * (sum11 + sum22) + (2.0 / 3.0) * (alike - apart),
        alike + apart,
        G * ((high11 - low11) + (on + off)),
        G * ((high22 - low22) + (on - off)),
    )


@always_inline
def _plane_stress(k: Number, by: Number, a: Three, e11: Number, e22: Number, e12: Number) -> Three:
    """Return k (a:e) a - ``by`` adj e, the stress at a Gauss point; e12 is 2 E_12."""
    # A:E, and its share along A; the rest of the law is the adjugate of E.
    trace = k * (a[0] * e11 + a[1] * e22 + a[2] * e12)
    return (
        trace * a[0] - by * e22,
        trace * a[1] - by * e11,
        trace * a[2] + 0.5 * by * e12,
    )


@always_inline
def _plane_resultants(k: Four, by: Four, metric: tuple[Three, ...], v: Six) -> Six:
    """Return the resultants of six strains, membrane or bending."""
    e11, e22, e12 = _at_gauss_points(v)
    return _from_gauss_points(
        _plane_stress(k[0], by[0], metric[0], e11[0], e22[0], e12[0]),
        _plane_stress(k[1], by[1], metric[1], e11[0], e22[1], e12[1]),
        _plane_stress(k[2], by[2], metric[2], e11[1], e22[1], e12[2]),
        _plane_stress(k[3], by[3], metric[3], e11[1], e22[0], e12[3]),
    )


@always_inline
def _shear_resultants(k: Four, metric: tuple[Three, ...], v: Four) -> Four:
    """Return the resultants of the four strains of transverse shear."""
    low1, high1 = v[0] - G * v[1], v[0] + G * v[1]
    low2, high2 = v[2] - G * v[3], v[2] + G * v[3]
    a0, a1, a2, a3 = metric
    q0 = k[0] * (a0[0] * low1 + a0[2] * low2), k[0] * (a0[2] * low1 + a0[1] * low2)
    q1 = k[1] * (a1[0] * low1 + a1[2] * high2), k[1] * (a1[2] * low1 + a1[1] * high2)
    q2 = k[2] * (a2[0] * high1 + a2[2] * high2), k[2] * (a2[2] * high1 + a2[1] * high2)
    q3 = k[3] * (a3[0] * high1 + a3[2] * low2), k[3] * (a3[2] * high1 + a3[1] * low2)
    down1, up1, down2, up2 = q0[0] + q1[0], q2[0] + q3[0], q0[1] + q3[1], q1[1] + q2[1]
    return down1 + up1, G * (up1 - down1), down2 + up2, G * (up2 - down2)


@always_inline
def flat_resultants(table: Floats, moduli: FlatModuli, b: int, lane: Lane, s: Sixteen) -> Sixteen:
    """Return r = H s of flat quads, from the metric at the Gauss points.

    With A = adj G_ab of the reference surface, J² = det A, and the isotropic law of plane stress,
    C_11 and mu integrated over the thickness, membrane and transverse shear have at a Gauss point

        n^ab = J (C_11 - 2 mu) G^ab G^cd E_cd + 2 mu J G^ac G^bd E_cd
             = C_11 J⁻³ (A:E) A - 2 mu J⁻¹ adj E,                        q = shear J⁻¹ A gamma

    because G^ab = A / J² and A E A = (A:E) A - det A adj E for symmetric 2 x 2 matrices (Cayley and
    Hamilton). Bending follows the membrane's law with the strains K. The products on the reference
    surface give the metric in the same manner as the strains give E.

    table : (n_block, 10, width), the first six products on the reference surface and, at the Gauss
    points, k = C_11 J⁻³ / 2¹⁴. The strains here are 16 E, the metric 8 A, and r = Bᵀ n / 16, hence
    2¹⁴ = 16² 8²; and k det(8 A) = C_11 J⁻¹ / 16², which the moduli turn into 2 mu and shear.
    """
    g11, g22, g12 = _at_gauss_points(pick_all(table, b, 0, 6, lane))
    # A = adj G_ab: the diagonal is exchanged, the shear changes its sign; ½, for g12 is 2 G_12.
    metric = (
        (g22[0], g11[0], -0.5 * g12[0]),
        (g22[1], g11[0], -0.5 * g12[1]),
        (g22[1], g11[1], -0.5 * g12[2]),
        (g22[0], g11[1], -0.5 * g12[3]),
    )
    k = pick_all(table, b, N_FLAT_PRODUCT, 4, lane)
    j = (
        k[0] * _determinant(metric[0]),
        k[1] * _determinant(metric[1]),
        k[2] * _determinant(metric[2]),
        k[3] * _determinant(metric[3]),
    )
    by = _scale4(moduli.lateral, j)
    n = _plane_resultants(k, by, metric, s[0:6])
    m = _plane_resultants(_scale4(moduli.bending, k), _scale4(moduli.bending, by), metric, s[6:12])
    return n + m + _shear_resultants(_scale4(moduli.shear, j), metric, s[12:16])


@always_inline
def _determinant(a: Three) -> Number:
    return a[0] * a[1] - a[2] * a[2]


@always_inline
def _scale4(factor: float, v: Four) -> Four:
    """Return factor v."""
    return factor * v[0], factor * v[1], factor * v[2], factor * v[3]


@always_inline
def full_resultants(h: Floats, b: int, lane: Lane, s: Sixteen, work: Floats) -> Sixteen:
    """Return r = H s with all strains coupled.

    h : (n_block, 136, width), the upper triangle of H, row by row.  work : (2, 16, width),
    overwritten.
    """
    # In memory, not in registers: 32 numbers of eight lanes would not fit, and loops need places.
    put_all(work, 0, 0, lane, s)
    for k in range(N_STRAIN):
        put(work, 1, k, lane, zero(lane))
    entry = 0
    for i in range(N_STRAIN):
        # Each entry of the upper triangle is read once: it serves row i and, transposed, row j.
        si = pick(work, 0, i, lane)
        ri = pick(work, 1, i, lane) + pick(h, b, entry, lane) * si
        for j in range(i + 1, N_STRAIN):
            entry += 1
            a = pick(h, b, entry, lane)
            ri = ri + a * pick(work, 0, j, lane)
            put(work, 1, j, lane, pick(work, 1, j, lane) + a * si)
        put(work, 1, i, lane, ri)
        entry += 1
    return pick_all(work, 1, 0, N_STRAIN, lane)
