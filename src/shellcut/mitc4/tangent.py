"""Tangent stiffness of a quad, by exact differentiation of the element's functions.

The strains are quadratic and the nodal forces f(u, r) bilinear in u = (positions, directors) and
the resultants r. For any motion d, of any size,

    ds = ½ [s(u + d) - s(u - d)],       df = f(u, H ds) + f(d, r),

exactly: this is no difference quotient with an error, and the tangent always agrees with the
forces. With d of the size of the quad, round-off is that of the forces.

The product of the tangent with a motion also uses these strains, which makes it more accurate than
the assembled stiffness if the film is thin. A stiffness with entries K (1 + eps) gives an error eps
|K| in the energy of a motion that does not stretch the film, next to a bending energy of about
(h/R)² |K|. In ds the round-off is in the strains, and its energy is of the order eps² |K|.

Each node has five freedoms: its translation and the turn of its director t along two unit tangents
b_1, b_2, t -> t cos + b sin. On that path the energy has the second derivative b·W_tt·b - t·W_t:
the second term, the *director's curvature*, keeps the tangent symmetric also away from equilibrium.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.lanes import pick_all, put_all
from shellcut.numerics.vec3 import dot, load, norm, store, sub, tangent_basis

from .element import (
    N_STRAIN,
    Modes,
    Sixteen,
    modes,
    moved_modes,
    nodal_forces,
    products,
    quad_modes,
)
from .quad_strains import LinearTables, Quads, stiffness_product, strain_of

N_FREEDOM = 20
"""Freedoms of a quad: twelve translations, then two turns per node."""


@kernel
def _write_products(x: Floats, t: Floats, m: Floats) -> None:
    """Write the products of quads to m : (n, 16); x, t : (n, 4, 3)."""
    for e in range(x.shape[0]):
        row = products(_modes_in(x, e), _modes_in(t, e))
        for k in range(N_STRAIN):
            m[e, k] = row[k]


@kernel
def _write_products_change(x: Floats, t: Floats, dx: Floats, dt: Floats, m: Floats) -> None:
    """Write the linear change of the products of quads to m : (n, 16)."""
    for e in range(x.shape[0]):
        row = _products_change(_modes_in(x, e), _modes_in(t, e), _modes_in(dx, e), _modes_in(dt, e))
        for k in range(N_STRAIN):
            m[e, k] = row[k]


@inline
def _modes_in(v: Floats, e: int) -> Modes:
    return modes(load(v[e], 0), load(v[e], 1), load(v[e], 2), load(v[e], 3))


def quad_products(x: Floats, t: Floats) -> Floats:
    """Return the sixteen products of quads, shape (n, 16), whose changes are the strains.

    x, t : (n, 4, 3), positions [mm] and directors.
    """
    m = np.empty((len(x), N_STRAIN))
    _write_products(np.ascontiguousarray(x), np.ascontiguousarray(t), m)
    return m


def quad_products_change(x: Floats, t: Floats, dx: Floats, dt: Floats) -> Floats:
    """Return the linear change of the products of quads by a motion, shape (n, 16)."""
    m = np.empty((len(x), N_STRAIN))
    x, t, dx, dt = (np.ascontiguousarray(rows) for rows in (x, t, dx, dt))
    _write_products_change(x, t, dx, dt, m)
    return m


@inline
def _product_with(
    moduli: Floats, i: int, tables: LinearTables, b: int, lane: int, s: Sixteen, work: Floats
) -> Sixteen:
    """Return the product of H and s: H of row i of moduli : (n, 16, 16), or of the linear film."""
    if not moduli.size:
        return stiffness_product(tables, b < tables.n_flat, b, lane, s, work)
    for k in range(N_STRAIN):
        work[1, k, 0] = s[k]
    for k in range(N_STRAIN):
        total = 0.0
        for m in range(N_STRAIN):
            total += moduli[i, k, m] * work[1, m, 0]
        work[0, k, 0] = total
    return pick_all(work, 0, 0, N_STRAIN, 0)


@inline
def _resultants(
    quads: Quads,
    b: int,
    lane: int,
    modes_now: tuple[Modes, Modes],
    bent: Floats,
    given: bool,
    row: Floats,
    work: Floats,
) -> Sixteen:
    """Return the given ones, bent : (16,), or those of the linear film without the strains bent."""
    if given:
        for k in range(N_STRAIN):
            row[0, k, 0] = bent[k]
        return pick_all(row, 0, 0, N_STRAIN, 0)
    flat = b < quads.tables.n_flat
    put_all(row, 0, 0, 0, strain_of(quads.tables, flat, b, lane, modes_now))
    for k in range(N_STRAIN):
        row[0, k, 0] -= bent[k]
    return stiffness_product(quads.tables, flat, b, lane, pick_all(row, 0, 0, N_STRAIN, 0), work)


@kernel
def quad_tangents(
    slot: Ints,
    quads: Quads,
    tangents: Floats,
    bent: Floats,
    given: bool,
    moduli: Floats,
    tangent: Floats,
) -> None:
    """Write the stiffness of the quads at the places ``slot`` into tangent : (n, 20, 20).

    Rows and columns: x, y, z of the four nodes, then the turns along b_1, b_2 of the four nodes.
    tangents : (n_node, 2, 3), b_1 and b_2 of every node, or (0, 2, 3) for any.
    bent : (n, 16), subtracted from the strains, or if ``given`` the resultants themselves.
    moduli : (n, 16, 16), dr/ds of the quads, or (0, 16, 16) for those of the linear film.  The
    other arguments as the force kernel's.
    """
    t, corner, tables = quads.t, quads.corner, quads.tables
    basis = np.empty((4, 2, 3))
    along = np.empty((2, 4, 3))
    width = corner.shape[2]
    row = np.empty((1, N_STRAIN, width))
    work = np.empty((2, N_STRAIN, width))
    for i in range(slot.shape[0]):
        b, lane = slot[i] // width, slot[i] % width
        for a in range(4):
            n = corner[b, a, lane]
            tangent_basis(t, n, basis[a])
            if tangents.shape[0]:
                for d in range(2):
                    store(basis[a], d, load(tangents[n], d))
        xm, tm = quad_modes(quads.x, t, corner, b, lane)
        r = _resultants(quads, b, lane, (xm, tm), bent[i], given, row, work)
        forces = nodal_forces(xm, tm, r)
        for a in range(4):
            # The director's curvature, - t·W_t, on the diagonal of both turns.
            pull = 0.0
            for c in range(3):
                pull -= forces[a][3 + c] * t[corner[b, a, lane], c]
            for d in range(2):
                for column in range(N_FREEDOM):
                    tangent[i, 12 + 2 * a + d, column] = 0.0
                tangent[i, 12 + 2 * a + d, 12 + 2 * a + d] = -pull
        # A step of the quad's size: round-off is that of the strains.
        size = norm(sub(xm[0], xm[1]))
        for column in range(N_FREEDOM):
            step = size if column < 12 else 1.0
            along[:] = 0.0
            if column < 12:
                along[0, column // 3, column % 3] = step
            else:
                a, d = (column - 12) // 2, (column - 12) % 2
                for c in range(3):
                    along[1, a, c] = basis[a, d, c]
            xd, td = _modes_in(along, 0), _modes_in(along, 1)
            # ds, exactly: the products are quadratic.
            ahead = products(moved_modes(xm, 1.0, xd), moved_modes(tm, 1.0, td))
            behind = products(moved_modes(xm, -1.0, xd), moved_modes(tm, -1.0, td))
            put_all(row, 0, 0, 0, ahead)
            for k in range(N_STRAIN):
                row[0, k, 0] = 0.5 * (row[0, k, 0] - behind[k])
            dr = _product_with(moduli, i, tables, b, lane, pick_all(row, 0, 0, N_STRAIN, 0), work)
            # df = f(u, H ds) + f(d, r).
            moved, turned = nodal_forces(xm, tm, dr), nodal_forces(xd, td, r)
            for a in range(4):
                for c in range(3):
                    tangent[i, 3 * a + c, column] = -(moved[a][c] + turned[a][c]) / step
                for d in range(2):
                    # Only the part of a director's force along its two turns counts.
                    for c in range(3):
                        force = moved[a][3 + c] + turned[a][3 + c]
                        tangent[i, 12 + 2 * a + d, column] -= force * basis[a, d, c] / step


@kernel
def add_tangent_products(
    slot: Ints,
    quads: Quads,
    bent: Floats,
    given: bool,
    moduli: Floats,
    dx: Floats,
    dt: Floats,
    rows: Floats,
) -> None:
    """Add the stiffness of quads times a motion to rows : (n_node, 6).

    Of forces and director forces.  dx, dt : (n_node, 3), of nodes and directors, dt normal to t.
    The other arguments as those of :func:`quad_tangents`, in the same order.
    """
    t, corner, tables = quads.t, quads.corner, quads.tables
    width = corner.shape[2]
    row = np.empty((1, N_STRAIN, width))
    work = np.empty((2, N_STRAIN, width))
    for i in range(slot.shape[0]):
        b, lane = slot[i] // width, slot[i] % width
        xm, tm = quad_modes(quads.x, t, corner, b, lane)
        xd, td = quad_modes(dx, dt, corner, b, lane)
        r = _resultants(quads, b, lane, (xm, tm), bent[i], given, row, work)
        at_rest = nodal_forces(xm, tm, r)
        change = _products_change(xm, tm, xd, td)
        dr = _product_with(moduli, i, tables, b, lane, change, work)
        moved, turned = nodal_forces(xm, tm, dr), nodal_forces(xd, td, r)
        for a in range(4):
            n = corner[b, a, lane]
            pull = 0.0
            for c in range(3):
                pull -= at_rest[a][3 + c] * t[n, c]
            for c in range(3):
                rows[n, c] -= moved[a][c] + turned[a][c]
                rows[n, 3 + c] -= moved[a][3 + c] + turned[a][3 + c] + pull * dt[n, c]


@inline
def _both(a: Vec3, da: Vec3, b: Vec3, db: Vec3) -> float:
    """Return the change of a · b."""
    return dot(a, db) + dot(da, b)


@inline
def _products_change(x: Modes, t: Modes, dx: Modes, dt: Modes) -> Sixteen:
    """Return the linear change of :func:`products`, each term to full relative accuracy."""
    p, q, h, _ = x
    tp, tq, th, tm = t
    dp, dq, dh, _ = dx
    dtp, dtq, dth, dtm = dt
    ptq, qtp = _both(p, dp, tq, dtq), _both(q, dq, tp, dtp)
    htp, htq, htm = _both(h, dh, tp, dtp), _both(h, dh, tq, dtq), _both(h, dh, tm, dtm)
    return (
        dot(p, dp),
        dot(q, dq),
        dot(h, dh),
        _both(p, dp, q, dq),
        _both(p, dp, h, dh),
        _both(q, dq, h, dh),
        _both(p, dp, tp, dtp),
        _both(q, dq, tq, dtq),
        _both(h, dh, th, dth),
        ptq + qtp,
        _both(p, dp, th, dth) + htp,
        _both(q, dq, th, dth) + htq,
        _both(p, dp, tm, dtm) + htq,
        ptq + htm,
        _both(q, dq, tm, dtm) + htp,
        qtp + htm,
    )
