"""The MITC4 element: strains, resultants and nodal forces of a quad.

Total Lagrangian, in convective coordinates xi, eta in [-1, 1] ([Frangi2010] 2, eqs. 1-9), with the
transverse shear tied at the mid-edge points ([DvorkinBathe1984]). Everything here is a function of
numbers: of one quad, or of eight at once (:mod:`shellcut.lanes`).

**Modes.** The bilinear mid-surface 4 x = m + xi p + eta q + xi eta h has the modes

    p = -x0 + x1 + x2 - x3,   q = -x0 - x1 + x2 + x3,   h = x0 - x1 + x2 - x3,   m = sum of x,

so that 4 a_1 = p + eta h and 4 a_2 = q + xi h ([Frangi2010] below (3)). The directors t have modes
alike, written tp, tq, th, tm, with 4 t_,1 = tp + eta th and 4 t_,2 = tq + xi th.

**Strains.** Because a_1 depends on eta alone and a_2 on xi alone, sixteen scalar products of modes
hold all strains of the quad:

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

each minus its value on the reference surface. The last two rows are the tied shear: a_1·t at the
tying points (0, -1), (0, +1) and a_2·t at (-1, 0), (+1, 0), joined linearly, is exactly that.

**Resultants and forces.** The energy of a linear material is W = ½ sᵀ H s, exact for 2 x 2 Gauss
points (:mod:`shellcut.section`); r = dW/ds are the resultants, and the nodal forces are
r · ds/d(x, t): :func:`nodal_forces` is the exact derivative of the energy.

The strain terms in (xi³)² are dropped: of relative size (thickness / radius of curvature)².
"""

from __future__ import annotations

from math import sqrt
from typing import TypeAlias

from ._jit import Floats, Number, Numbers, SmallIds, Vector, always_inline
from ._vec3 import add, add_scaled, dot, scale, sub
from .lanes import corner_node, gather, pick, put

N_STRAIN = 16
"""Strains of a quad, and resultants."""

N_MEMBRANE, N_SHEAR, N_FULL = 21, 10, 136
"""Numbers in the upper triangles of the 6 x 6 membrane, 4 x 4 shear and 16 x 16 stiffness."""

G = 1.0 / sqrt(3.0)
GAUSS = ((-G, -G), (G, -G), (G, G), (-G, G))
"""The Gauss points (xi, eta), counter-clockwise."""

Modes: TypeAlias = tuple[Vector, Vector, Vector, Vector]
Sixteen: TypeAlias = tuple[Number, ...]
Six: TypeAlias = tuple[Number, Number, Number, Number, Number, Number]
Four: TypeAlias = tuple[Number, Number, Number, Number]


@always_inline
def node_vector(values: Floats, ids: Number) -> Vector:
    """Return the vectors of values : (n, 3) at some nodes."""
    return gather(values, 0, ids), gather(values, 1, ids), gather(values, 2, ids)


@always_inline
def modes(v0: Vector, v1: Vector, v2: Vector, v3: Vector) -> Modes:
    """Return p, q, h and m of four corner vectors."""
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
def quad_modes(
    x: Floats, t: Floats, corner: SmallIds, b: int, lane: int | None
) -> tuple[Modes, Modes]:
    """Return the modes of positions and of directors.

    x, t : (n_node, 3).  corner : (n_block, 4, 8).
    """
    n0, n1 = corner_node(corner, b, 0, lane), corner_node(corner, b, 1, lane)
    n2, n3 = corner_node(corner, b, 2, lane), corner_node(corner, b, 3, lane)
    return (
        modes(node_vector(x, n0), node_vector(x, n1), node_vector(x, n2), node_vector(x, n3)),
        modes(node_vector(t, n0), node_vector(t, n1), node_vector(t, n2), node_vector(t, n3)),
    )


@always_inline
def products(x: Modes, t: Modes) -> Sixteen:
    """Return the sixteen scalar products whose change is the strain."""
    p, q, h, _ = x
    tp, tq, th, tm = t
    ptq, qtp, htp, htq, htm = dot(p, tq), dot(q, tp), dot(h, tp), dot(h, tq), dot(h, tm)
    return (
        0.5 * dot(p, p),
        0.5 * dot(q, q),
        0.5 * dot(h, h),
        dot(p, q),
        dot(p, h),
        dot(q, h),
        dot(p, tp),
        dot(q, tq),
        dot(h, th),
        ptq + qtp,
        dot(p, th) + htp,
        dot(q, th) + htq,
        dot(p, tm) + htq,
        ptq + htm,
        dot(q, tm) + htp,
        qtp + htm,
    )


@always_inline
def mode_forces(x: Modes, t: Modes, r: Sixteen) -> tuple[Vector, ...]:
    """Return r · ds/d(p, q, h) and r · ds/d(tp, tq, th, tm)."""
    p, q, h, _ = x
    tp, tq, th, tm = t
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


@always_inline
def pick6(table: Numbers, b: int, first: int, lane: int | None) -> Six:
    """Return six numbers of a block from the number ``first`` on."""
    return (
        pick(table, b, first, lane),
        pick(table, b, first + 1, lane),
        pick(table, b, first + 2, lane),
        pick(table, b, first + 3, lane),
        pick(table, b, first + 4, lane),
        pick(table, b, first + 5, lane),
    )


@always_inline
def pick4(table: Numbers, b: int, first: int, lane: int | None) -> Four:
    """Return four numbers of a block from the number ``first`` on."""
    return (
        pick(table, b, first, lane),
        pick(table, b, first + 1, lane),
        pick(table, b, first + 2, lane),
        pick(table, b, first + 3, lane),
    )


@always_inline
def pick16(table: Numbers, b: int, lane: int | None) -> Sixteen:
    """Return the first sixteen numbers of a block."""
    return pick6(table, b, 0, lane) + pick6(table, b, 6, lane) + pick4(table, b, 12, lane)


@always_inline
def symmetric6(h: Floats, b: int, lane: int | None, v: Six) -> Six:
    """Return A v of a symmetric 6 x 6 matrix, the first 21 numbers of a block, row by row."""
    a00, a01, a02, a03, a04, a05 = pick6(h, b, 0, lane)
    a11, a12, a13, a14, a15, a22 = pick6(h, b, 6, lane)
    a23, a24, a25, a33, a34, a35 = pick6(h, b, 12, lane)
    a44, a45, a55 = pick(h, b, 18, lane), pick(h, b, 19, lane), pick(h, b, 20, lane)
    v0, v1, v2, v3, v4, v5 = v
    return (
        a00 * v0 + a01 * v1 + a02 * v2 + a03 * v3 + a04 * v4 + a05 * v5,
        a01 * v0 + a11 * v1 + a12 * v2 + a13 * v3 + a14 * v4 + a15 * v5,
        a02 * v0 + a12 * v1 + a22 * v2 + a23 * v3 + a24 * v4 + a25 * v5,
        a03 * v0 + a13 * v1 + a23 * v2 + a33 * v3 + a34 * v4 + a35 * v5,
        a04 * v0 + a14 * v1 + a24 * v2 + a34 * v3 + a44 * v4 + a45 * v5,
        a05 * v0 + a15 * v1 + a25 * v2 + a35 * v3 + a45 * v4 + a55 * v5,
    )


@always_inline
def symmetric4(h: Floats, b: int, lane: int | None, v: Four) -> Four:
    """Return A v of a symmetric 4 x 4 matrix, the ten numbers after those 21, row by row."""
    a00, a01, a02, a03 = pick4(h, b, N_MEMBRANE, lane)
    a11, a12, a13, a22 = pick4(h, b, N_MEMBRANE + 4, lane)
    a23, a33 = pick(h, b, N_MEMBRANE + 8, lane), pick(h, b, N_MEMBRANE + 9, lane)
    v0, v1, v2, v3 = v
    return (
        a00 * v0 + a01 * v1 + a02 * v2 + a03 * v3,
        a01 * v0 + a11 * v1 + a12 * v2 + a13 * v3,
        a02 * v0 + a12 * v1 + a22 * v2 + a23 * v3,
        a03 * v0 + a13 * v1 + a23 * v2 + a33 * v3,
    )


@always_inline
def flat_resultants(h: Floats, bending: float, b: int, lane: int | None, s: Sixteen) -> Sixteen:
    """Return r = H s of flat quads: membrane, bending and shear stand apart.

    h : (n_block, 31, 8), the upper triangles of the membrane and of the shear stiffness.
    bending : bending over membrane stiffness [mm²], the same matrix in other strains.
    """
    n = symmetric6(h, b, lane, s[0:6])
    m = symmetric6(
        h,
        b,
        lane,
        (
            bending * s[6],
            bending * s[7],
            bending * s[8],
            bending * s[9],
            bending * s[10],
            bending * s[11],
        ),
    )
    return n + m + symmetric4(h, b, lane, s[12:16])


@always_inline
def full_resultants(h: Floats, b: int, lane: int | None, s: Sixteen, work: Numbers) -> Sixteen:
    """Return r = H s with every strain coupled to every other.

    h : (n_block, 136, 8), the upper triangle of H, row by row.  work : (2, 16, 8), overwritten.
    """
    for k in range(N_STRAIN):
        put(work, 0, k, lane, s[k])
        put(work, 1, k, lane, 0.0 * s[k])
    entry = 0
    for i in range(N_STRAIN):
        si = pick(work, 0, i, lane)
        ri = pick(work, 1, i, lane) + pick(h, b, entry, lane) * si
        for j in range(i + 1, N_STRAIN):
            entry += 1
            a = pick(h, b, entry, lane)
            ri = ri + a * pick(work, 0, j, lane)
            put(work, 1, j, lane, pick(work, 1, j, lane) + a * si)
        put(work, 1, i, lane, ri)
        entry += 1
    return pick16(work, 1, lane)
