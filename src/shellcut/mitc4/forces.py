"""Kernels that add the forces of quads to the nodes: a block at a time, or one by one.

Damping is proportional to the stiffness, on the strain rate: the stress acts on
u = s + rho (s_n - s_{n-1}), rho = beta / dt, the rate of the half step before t_n (so the step
stays explicit; [Frangi2010] 5.2). Of a linear material the resultants are thus r = H u, one
product. The ledger wants the stored energy ½ s·H s and, for the central difference's own work of
the damping stress, ½ rho (a_{n-1} + a_n)·H a_n with the strain steps a_n = s_n - s_{n-1}. Summed
over all quads, A = s_n·H s_n, B = s_n·H a_n, C = a_n·H a_n and D = a_{n-1}·H a_n follow from three
products with r alone and last step's A and B, because H is symmetric:

    s_n·r = A + rho B,   a_n·r = B + rho C,   A' = (s_n - a_n)·H (s_n - a_n) = A - 2 B + C
    a_{n-1}·r = a_{n-1}·H s_n + rho D,        B' = (s_n - a_n)·H a_{n-1} = a_{n-1}·H s_n - D

so C = (A' + (2 + rho) a_n·r - s_n·r) / (1 + rho)² and D = (a_{n-1}·r - B') / (1 + rho). Errors of
A' fade by (rho / (1 + rho))² a step. The kernels sum s_n·r, s_{n-1}·r and s_{n-2}·r.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Number, Numbers, SmallIds
from shellcut.material.law_dispatch import dissipates
from shellcut.numerics.jit import always_inline, kernel
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import (
    nth,
    pick,
    put,
    scatter_add,
    total,
    turns,
    widen,
    zero,
)
from shellcut.numerics.processor import (
    align_stack,
    flush_subnormals,
    make_prefetch,
    set_rounding,
)

from .element import (
    N_FLAT,
    N_STRAIN,
    FlatModuli,
    Modes,
    Sixteen,
    chain_modes,
    flat_resultants,
    full_resultants,
    nodal_forces,
    pick16,
    products,
    quad_modes,
)
from .thickness_points import PointRule, flat_point_resultants, full_point_resultants

_prefetch_flat = make_prefetch(N_FLAT)
_prefetch_strain = make_prefetch(N_STRAIN)

# Blocks from which on the tables lie in memory, beyond any cache: there asking ahead saves a fifth,
# below it costs a tenth.
_FAR = 30_000


class LinearTables(NamedTuple):
    """What does not change of the quads, in blocks: the flat ones first."""

    n_flat: int
    """Number of blocks of flat quads."""
    flat: Floats
    """The first six products on the reference surface, the others vanish, and four stiffnesses,
    (n_flat, 10, width), see :func:`shellcut.mitc4.element.flat_resultants`."""
    flat_moduli: FlatModuli
    """What flat quads have in common."""
    full_reference: Floats
    """The products on the reference surface, (n_block - n_flat, 16, width)."""
    full_stiffness: Floats
    """(n_block - n_flat, 136, width)."""


class PointTables(NamedTuple):
    """Frames of the general path."""

    flat_frame: Floats
    """(n_flat, 16, width)."""
    full_frame: Floats
    """(n_block - n_flat, 4 n_point 7, width)."""
    rule: PointRule


@always_inline
def flat_strain(tables: LinearTables, b: int, lane: Lane, x: Modes, t: Modes) -> Sixteen:
    """Return the strains of flat quads."""
    m = products(x, t)
    ref = tables.flat
    membrane = (
        m[0] - pick(ref, b, 0, lane),
        m[1] - pick(ref, b, 1, lane),
        m[2] - pick(ref, b, 2, lane),
        m[3] - pick(ref, b, 3, lane),
        m[4] - pick(ref, b, 4, lane),
        m[5] - pick(ref, b, 5, lane),
    )
    return membrane + m[6:16]


@always_inline
def full_strain(tables: LinearTables, b: int, lane: Lane, x: Modes, t: Modes) -> Sixteen:
    """Return the strains of any quads."""
    return _minus(products(x, t), pick16(tables.full_reference, b - tables.n_flat, lane))


@always_inline
def stiffness_product(
    tables: LinearTables, flat: bool, b: int, lane: Lane, u: Sixteen, work: Numbers
) -> Sixteen:
    """Return H u; work : (2, 16, width) is overwritten."""
    if flat:
        return flat_resultants(tables.flat, tables.flat_moduli, b, lane, u)
    return full_resultants(tables.full_stiffness, b - tables.n_flat, lane, u, work)


@always_inline
def _minus(a: Sixteen, b: Sixteen) -> Sixteen:
    return (
        a[0] - b[0],
        a[1] - b[1],
        a[2] - b[2],
        a[3] - b[3],
        a[4] - b[4],
        a[5] - b[5],
        a[6] - b[6],
        a[7] - b[7],
        a[8] - b[8],
        a[9] - b[9],
        a[10] - b[10],
        a[11] - b[11],
        a[12] - b[12],
        a[13] - b[13],
        a[14] - b[14],
        a[15] - b[15],
    )


@always_inline
def plus_scaled(a: Sixteen, k: float, b: Sixteen) -> Sixteen:
    """Return a + k b."""
    return (
        a[0] + k * b[0],
        a[1] + k * b[1],
        a[2] + k * b[2],
        a[3] + k * b[3],
        a[4] + k * b[4],
        a[5] + k * b[5],
        a[6] + k * b[6],
        a[7] + k * b[7],
        a[8] + k * b[8],
        a[9] + k * b[9],
        a[10] + k * b[10],
        a[11] + k * b[11],
        a[12] + k * b[12],
        a[13] + k * b[13],
        a[14] + k * b[14],
        a[15] + k * b[15],
    )


@always_inline
def _dot(a: Sixteen, b: Sixteen) -> Number:
    """Return a · b in four short sums: one long one would wait for itself."""
    return (
        (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3])
        + (a[4] * b[4] + a[5] * b[5] + a[6] * b[6] + a[7] * b[7])
    ) + (
        (a[8] * b[8] + a[9] * b[9] + a[10] * b[10] + a[11] * b[11])
        + (a[12] * b[12] + a[13] * b[13] + a[14] * b[14] + a[15] * b[15])
    )


@always_inline
def store_strain(table: Numbers, b: int, lane: Lane, s: Sixteen) -> None:
    """Write sixteen numbers of a block."""
    put(table, b, 0, lane, s[0])
    put(table, b, 1, lane, s[1])
    put(table, b, 2, lane, s[2])
    put(table, b, 3, lane, s[3])
    put(table, b, 4, lane, s[4])
    put(table, b, 5, lane, s[5])
    put(table, b, 6, lane, s[6])
    put(table, b, 7, lane, s[7])
    put(table, b, 8, lane, s[8])
    put(table, b, 9, lane, s[9])
    put(table, b, 10, lane, s[10])
    put(table, b, 11, lane, s[11])
    put(table, b, 12, lane, s[12])
    put(table, b, 13, lane, s[13])
    put(table, b, 14, lane, s[14])
    put(table, b, 15, lane, s[15])


@always_inline
def _scatter(
    rows: Floats, corner: SmallIds, b: int, lane: Lane, x: Modes, t: Modes, r: Sixteen
) -> None:
    f0, f1, f2, f3 = nodal_forces(x, t, r)
    scatter_add(rows, corner, b, 0, lane, f0)
    scatter_add(rows, corner, b, 1, lane, f1)
    scatter_add(rows, corner, b, 2, lane, f2)
    scatter_add(rows, corner, b, 3, lane, f3)


@kernel
def write_products(
    first: int, n: int, X: Floats, T: Floats, corner: SmallIds, table: Numbers, lane: Lane
) -> None:
    """Write the first n products on the reference surface of the blocks from ``first`` on.

    By the functions that make strains of them, in the same precision, so that what is subtracted
    at rest is the same to the last bit.  X, T : (n_node, 3).  table : (n_block - first, n or more,
    width).
    """
    for b in range(table.shape[0]):
        xm, tm = quad_modes(X, T, corner, first + b, lane)
        m = products(xm, tm)
        if n == N_STRAIN:
            store_strain(table, b, lane, m)
        else:
            for k in range(n):
                put(table, b, k, lane, m[k])


# ---------------------------------------------------------------- linear material


@always_inline
def _ask_for_block(
    b: int, flat: bool, tables: LinearTables, damped: bool, last: Floats, before: Floats
) -> None:
    """Fetch what block ``b`` will need, while the block before it is worked on."""
    if flat:
        _prefetch_flat(tables.flat, b)
    if damped:
        _prefetch_strain(last, b)
        _prefetch_strain(before, b)


@always_inline
def _linear_block(
    b: int,
    lane: Lane,
    flat: bool,
    x: Floats,
    t: Floats,
    corner: SmallIds,
    chain: Bools,
    tables: LinearTables,
    damped: bool,
    rho: float,
    last: Floats,
    before: Floats,
    rows: Floats,
    work: Numbers,
) -> tuple[Number, Number, Number]:
    """Add the forces of block ``b``; return s_n·r, s_{n-1}·r and s_{n-2}·r."""
    if chain[b]:
        xm, tm = chain_modes(x, t, corner, b, lane)
    else:
        xm, tm = quad_modes(x, t, corner, b, lane)
    s = flat_strain(tables, b, lane, xm, tm) if flat else full_strain(tables, b, lane, xm, tm)
    if not damped:
        r = stiffness_product(tables, flat, b, lane, s, work)
        _scatter(rows, corner, b, lane, xm, tm, r)
        return _dot(s, r), zero(lane), zero(lane)
    s_last, s_before = pick16(last, b, lane), pick16(before, b, lane)
    r = stiffness_product(tables, flat, b, lane, plus_scaled(s, rho, _minus(s, s_last)), work)
    store_strain(before, b, lane, s)
    _scatter(rows, corner, b, lane, xm, tm, r)
    return _dot(s, r), _dot(s_last, r), _dot(s_before, r)


def _make_linear_kernel(flat: bool) -> Any:
    @kernel
    def add_linear_quads(
        first: int,
        stride: int,
        start: Ints,
        x: Floats,
        t: Floats,
        corner: SmallIds,
        chain: Bools,
        tables: LinearTables,
        damped: bool,
        rho: float,
        last: Floats,
        before: Floats,
        rows: Floats,
        sums: Floats,
        lane: Lane,
    ) -> None:
        """Add minus dW/dx and dW/dt of quads, with stiffness damping, to the force rows.

        Strips ``first``, ``first`` + ``stride``, ... are taken.  start : (n_strip + 1,), blocks.
        x, t : (n_node, 3).  corner : (n_block, 4, width).  chain : (n_block,), of
        :class:`shellcut.mitc4.blocks.QuadBlocks`.  last : (n_block, 16, width), s_{n-1}.
        before : likewise, s_{n-2}, replaced by s_n.  rows : (n_node, 8).  sums : (n_strip, 3), to
        which s_n·r, s_{n-1}·r and s_{n-2}·r are added.  lane : None or SIXTEEN for a block at a
        time, any number for one by one.
        """
        align_stack()
        work = np.empty((2, N_STRAIN, corner.shape[2]), last.dtype)
        rounding = flush_subnormals()
        far = last.shape[0] > _FAR
        for k in range(first, start.shape[0] - 1, stride):
            none = widen(zero(lane), lane)
            p0, p1, p2 = none, none, none
            for b in range(start[k], start[k + 1]):
                if far:
                    _ask_for_block(b + 1, flat, tables, damped, last, before)
                for turn in range(turns(corner, lane)):
                    q0, q1, q2 = _linear_block(
                        b,
                        nth(lane, turn),
                        flat,
                        x,
                        t,
                        corner,
                        chain,
                        tables,
                        damped,
                        rho,
                        last,
                        before,
                        rows,
                        work,
                    )
                    p0, p1, p2 = p0 + widen(q0, lane), p1 + widen(q1, lane), p2 + widen(q2, lane)
            sums[k, 0] += total(p0)
            sums[k, 1] += total(p1)
            sums[k, 2] += total(p2)
        set_rounding(rounding)

    return add_linear_quads


add_flat_quads = _make_linear_kernel(flat=True)
"""Of flat quads."""
add_full_quads = _make_linear_kernel(flat=False)
"""Of quads that are curved, warped or unevenly layered."""


# ---------------------------------------------------------------- any material


@always_inline
def point_resultants(
    flat: bool,
    s: Sixteen,
    tables: LinearTables,
    points: PointTables,
    old: Floats,
    new: Floats,
    b: int,
    b_new: int,
    lane: Lane,
    dt: float,
) -> tuple[Sixteen, Number, Number]:
    """Return the resultants of the general path, the stored and the just dissipated energy."""
    rule = points.rule
    if flat:
        return flat_point_resultants(s, points.flat_frame, rule, old, new, b, b_new, lane, dt)
    block = b - tables.n_flat
    return full_point_resultants(s, points.full_frame, rule, old, new, b, b_new, block, lane, dt)


@always_inline
def _point_block(
    b: int,
    lane: Lane,
    flat: bool,
    x: Floats,
    t: Floats,
    corner: SmallIds,
    chain: Bools,
    tables: LinearTables,
    points: PointTables,
    damped: bool,
    rho: float,
    last: Floats,
    before: Floats,
    history: Floats,
    dt: float,
    rows: Floats,
    work: Numbers,
) -> tuple[Number, Number, Number]:
    """Add the forces of block ``b``; return its stored energy, (a_n + a_{n-1})·H a_n, dissipated.

    The last is what the material has dissipated since t_{n-1}.
    """
    if chain[b]:
        xm, tm = chain_modes(x, t, corner, b, lane)
    else:
        xm, tm = quad_modes(x, t, corner, b, lane)
    s = flat_strain(tables, b, lane, xm, tm) if flat else full_strain(tables, b, lane, xm, tm)
    r, stored, lost = point_resultants(flat, s, tables, points, history, history, b, b, lane, dt)
    if not damped:
        _scatter(rows, corner, b, lane, xm, tm, r)
        return stored, zero(lane), lost
    s_last, s_before = pick16(last, b, lane), pick16(before, b, lane)
    viscous = stiffness_product(tables, flat, b, lane, _minus(s, s_last), work)
    store_strain(before, b, lane, s)
    _scatter(rows, corner, b, lane, xm, tm, plus_scaled(r, rho, viscous))
    return stored, _dot(_minus(s, s_before), viscous), lost


def _make_point_kernel(flat: bool) -> Any:
    @kernel
    def add_point_quads(
        first: int,
        stride: int,
        start: Ints,
        x: Floats,
        t: Floats,
        corner: SmallIds,
        chain: Bools,
        tables: LinearTables,
        points: PointTables,
        damped: bool,
        rho: float,
        last: Floats,
        before: Floats,
        history: Floats,
        dt: float,
        rows: Floats,
        sums: Floats,
        lane: Lane,
    ) -> None:
        """Add the forces of quads with thickness points; arguments as of the linear kernel.

        history : (n_block, 4 n_point n_history, width), taken from t_{n-1} to t_n.  dt :
        length of the step between [s].  sums : (n_strip, 3), to which the stored energy,
        (a_n + a_{n-1})·H a_n and what the material dissipated in the step are added.
        """
        align_stack()
        work = np.empty((2, N_STRAIN, corner.shape[2]), last.dtype)
        rounding = flush_subnormals()
        for k in range(first, start.shape[0] - 1, stride):
            none = widen(zero(lane), lane)
            p0, p1, p2 = none, none, none
            for b in range(start[k], start[k + 1]):
                for turn in range(turns(corner, lane)):
                    q0, q1, q2 = _point_block(
                        b,
                        nth(lane, turn),
                        flat,
                        x,
                        t,
                        corner,
                        chain,
                        tables,
                        points,
                        damped,
                        rho,
                        last,
                        before,
                        history,
                        dt,
                        rows,
                        work,
                    )
                    p0, p1 = p0 + widen(q0, lane), p1 + widen(q1, lane)
                    if dissipates(points.rule.laws):
                        p2 = p2 + widen(q2, lane)
            sums[k, 0] += total(p0)
            sums[k, 1] += total(p1)
            sums[k, 2] += total(p2)
        set_rounding(rounding)

    return add_point_quads


add_flat_point_quads = _make_point_kernel(flat=True)
"""Of flat quads."""
add_full_point_quads = _make_point_kernel(flat=False)
"""Of quads that are curved, warped or unevenly layered."""


# ---------------------------------------------------------------- single quads


def _make_corner_kernel(by_points: bool) -> Any:
    @kernel
    def write_corner_forces(
        slot: Ints,
        nodes: Ints,
        x: Floats,
        t: Floats,
        corner: SmallIds,
        tables: LinearTables,
        points: PointTables,
        damped: bool,
        rho: float,
        last: Floats,
        history: Floats,
        dt: float,
        force: Floats,
    ) -> None:
        """Write minus the force of the quad at slot[i] on its node nodes[i] to force : (n, 3)."""
        width = corner.shape[2]
        work = np.empty((2, N_STRAIN, width))
        trial = np.empty((1, history.shape[1], width))
        for i in range(slot.shape[0]):
            b, lane = slot[i] // width, slot[i] % width
            flat = b < tables.n_flat
            xm, tm = quad_modes(x, t, corner, b, lane)
            if flat:
                s = flat_strain(tables, b, lane, xm, tm)
            else:
                s = full_strain(tables, b, lane, xm, tm)
            if by_points:
                r, _, _ = point_resultants(flat, s, tables, points, history, trial, b, 0, lane, dt)
            else:
                r = stiffness_product(tables, flat, b, lane, s, work)
            if damped:
                step = _minus(s, pick16(last, b, lane))
                r = plus_scaled(r, rho, stiffness_product(tables, flat, b, lane, step, work))
            forces = nodal_forces(xm, tm, r)
            for a in range(4):
                if corner[b, a, lane] == nodes[i]:
                    for c in range(3):
                        force[i, c] = forces[a][c]

    return write_corner_forces


write_corner_forces = _make_corner_kernel(by_points=False)
"""Of linear material."""
write_point_corner_forces = _make_corner_kernel(by_points=True)
"""Of any material."""
