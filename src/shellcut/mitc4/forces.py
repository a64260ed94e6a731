"""Kernels that add the forces of quads to the nodes, by blocks.

Damping is proportional to the stiffness, on the strain rate: the stress acts on
u = s + rho (s_n - s_{n-1}), rho = beta / dt, the rate of the half step before t_n (so the step
stays explicit; [Frangi2010] 5.2). So for a linear material the resultants are r = H u, one product.
The energy balance needs the stored energy ½ s·H s and, for the work of the damping stress that is
consistent with the central difference, ½ rho (a_{n-1} + a_n)·H a_n with the strain steps
a_n = s_n - s_{n-1}. Summed over all quads, A = s_n·H s_n, B = s_n·H a_n, C = a_n·H a_n and
D = a_{n-1}·H a_n follow from three products with r and last step's A and B, because H is symmetric:

    s_n·r = A + rho B,   a_n·r = B + rho C,   A' = (s_n - a_n)·H (s_n - a_n) = A - 2 B + C
    a_{n-1}·r = a_{n-1}·H s_n + rho D,        B' = (s_n - a_n)·H a_{n-1} = a_{n-1}·H s_n - D

so C = (A' + (2 + rho) a_n·r - s_n·r) / (1 + rho)² and D = (a_{n-1}·r - B') / (1 + rho). Errors of
A' fade by (rho / (1 + rho))² per step. The kernels sum s_n·r, s_{n-1}·r and s_{n-2}·r.

Of quads with thickness points, whatever their law, the stress of the law and rho H a_n act
together, with the stiffness H of the elastic moduli, and H a_n is computed separately. At the end:
forces of single quads on single nodes, of both kinds, without changing stored values.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Number
from shellcut.material.law_dispatch import HistoryStep
from shellcut.numerics.borrowed import borrowed, lent
from shellcut.numerics.jit import always_inline, kernel
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import pick_all, put_all, total, zero
from shellcut.numerics.processor import align_stack, flush_subnormals, set_rounding
from shellcut.state import State

from .element import N_STRAIN, Sixteen, nodal_forces
from .quad_strains import (
    PointQuads,
    Quads,
    QuadStep,
    add_to_nodes,
    dot16,
    minus,
    modes_of,
    one_quad,
    plus_scaled,
    stiffness_product,
    strain_of,
)
from .thickness_points import PointPlace, PointTables, resultants_at


class Work(NamedTuple):
    """Energies of one evaluation of the shell's forces, for the energy balance."""

    strain_energy: float
    """Stored energy at t_n [N·mm]."""
    damping: float
    """Work of the damping stress since t_{n-1} [N·mm]."""
    dissipated: float
    """Energy dissipated by the material since t_{n-1} [N·mm]."""


def linear_work(state: State, p0: float, p1: float, p2: float, rho: float) -> Work:
    """Return the shell's work from s_n·r, s_{n-1}·r and s_{n-2}·r, see the head of this module."""
    a_last, b_last = state.strain_forms
    step, step_before = p0 - p1, p1 - p2
    c = (a_last + (2.0 + rho) * step - p0) / (1.0 + rho) ** 2
    d = (step_before - b_last) / (1.0 + rho)
    b = step - rho * c
    a = p0 - rho * b
    state.strain_forms = a, b
    return Work(0.5 * a, 0.5 * rho * (c + d), 0.0)


@always_inline
def _linear_block(
    b: int, flat: bool, quads: Quads, step: QuadStep, rows: Floats, work: Floats
) -> tuple[Number, Number, Number]:
    """Add the forces of block ``b``; return s_n·r, s_{n-1}·r and s_{n-2}·r."""
    corner, tables = quads.corner, quads.tables
    xm, tm = modes_of(quads, b, None)
    s = strain_of(tables, flat, b, None, (xm, tm))
    if not step.damped:
        r = stiffness_product(tables, flat, b, None, s, work)
        add_to_nodes(rows, corner, b, None, (xm, tm), r)
        return dot16(s, r), zero(None), zero(None)
    s_last, s_before = (
        pick_all(step.last, b, 0, N_STRAIN, None),
        pick_all(step.before, b, 0, N_STRAIN, None),
    )
    # Elastic and damping stress in one product: r = H (s + rho (s_n - s_{n-1})).
    u = plus_scaled(s, step.rho, minus(s, s_last))
    r = stiffness_product(tables, flat, b, None, u, work)
    # s_n takes the place of s_{n-2}, which is read: the shell exchanges both arrays after the step.
    put_all(step.before, b, 0, None, s)
    add_to_nodes(rows, corner, b, None, (xm, tm), r)
    return dot16(s, r), dot16(s_last, r), dot16(s_before, r)


@always_inline
def point_resultants(
    quads: PointQuads,
    points: PointTables,
    flat: bool,
    s: Sixteen,
    history: HistoryStep,
    lane: Lane,
) -> tuple[Sixteen, Number, Number]:
    """Return the resultants of a block, its stored energy and the energy dissipated in the step.

    points : ``quads.points``, which may be :func:`~shellcut.numerics.borrowed.lent`.
    """
    b = history.block
    at = b if flat else b - quads.quads.tables.n_flat
    return resultants_at(flat, s, PointPlace(quads.points, points, at, b), history, lane)


@always_inline
def _point_block(
    b: int,
    flat: bool,
    both: PointQuads,
    points: PointTables,
    step: QuadStep,
    history: Floats,
    rows: Floats,
    work: Floats,
) -> tuple[Number, Number, Number]:
    """Add the forces of block ``b``; return its stored energy, (a_n + a_{n-1})·H a_n, dissipated.

    The last is the energy dissipated by the material since t_{n-1}.
    """
    quads = both.quads
    xm, tm = modes_of(quads, b, None)
    s = strain_of(quads.tables, flat, b, None, (xm, tm))
    at = HistoryStep(history, None, b, b, step.dt)
    r, stored, lost = point_resultants(both, points, flat, s, at, None)
    if not step.damped:
        add_to_nodes(rows, quads.corner, b, None, (xm, tm), r)
        return stored, zero(None), lost
    s_last, s_before = (
        pick_all(step.last, b, 0, N_STRAIN, None),
        pick_all(step.before, b, 0, N_STRAIN, None),
    )
    # The law has no stiffness H of its own: damping uses that of the elastic moduli.
    viscous = stiffness_product(quads.tables, flat, b, None, minus(s, s_last), work)
    put_all(step.before, b, 0, None, s)
    add_to_nodes(rows, quads.corner, b, None, (xm, tm), plus_scaled(r, step.rho, viscous))
    return stored, dot16(minus(s, s_before), viscous), lost


def _make_kernel(*, flat: bool, by_points: bool) -> Any:
    @kernel
    def add_quads(
        first: int,
        stride: int,
        parity: int,
        start: Ints,
        quads: PointQuads,
        step: QuadStep,
        rows: Floats,
        sums: Floats,
    ) -> None:
        """Add minus dW/dx and dW/dt of quads, with stiffness damping, to the force rows.

        Treats every ``stride``-th strip of a parity, which is 0 or 1, from the ``first``-th on.
        start : (n_strip + 1,), blocks.  rows : (n_node, 8).  sums : (n_strip, 3), to which is added
        what a block returns.
        """
        align_stack()  # a tenth of the time, by lanes spilled within one cache line
        quads, step = borrowed(quads), borrowed(step)
        points, history = lent(quads.points), lent(step.history)
        work = np.empty((2, N_STRAIN, quads.quads.corner.shape[2]))
        # Far ahead of a wave the film moves by 1e-160 mm: a hundred times as slow where kept.
        rounding = flush_subnormals()
        # Strips of one parity share no node, so threads add to the nodes without waiting.
        for k in range(2 * first + parity, start.shape[0] - 1, 2 * stride):
            none = zero(None)
            p0, p1, p2 = none, none, none
            for b in range(start[k], start[k + 1]):
                if by_points:
                    q = _point_block(b, flat, quads, points, step, history, rows, work)
                else:
                    q = _linear_block(b, flat, quads.quads, step, rows, work)
                p0, p1, p2 = p0 + q[0], p1 + q[1], p2 + q[2]
            sums[k, 0] += total(p0)
            sums[k, 1] += total(p1)
            sums[k, 2] += total(p2)
        set_rounding(rounding)

    return add_quads


add_flat_quads = _make_kernel(flat=True, by_points=False)
"""For flat quads of a linear film."""
add_full_quads = _make_kernel(flat=False, by_points=False)
"""For curved, warped or unevenly layered ones."""
add_flat_point_quads = _make_kernel(flat=True, by_points=True)
"""For quads with thickness points, likewise."""
add_full_point_quads = _make_kernel(flat=False, by_points=True)
"""Likewise."""


def _make_corner_kernel(by_points: bool) -> Any:
    @kernel
    def write_corner_forces(
        slot: Ints, nodes: Ints, quads: PointQuads, step: QuadStep, force: Floats
    ) -> None:
        """Write minus the force of the quad at slot[i] on its node nodes[i] to force : (n, 3)."""
        quads = borrowed(quads)
        linear, last, history = quads.quads, step.last, step.history
        corner, tables = linear.corner, linear.tables
        width = corner.shape[2]
        work = np.empty((2, N_STRAIN, width))
        # A law with history writes here: this evaluation must not change that of the state.
        trial = np.empty((1, history.shape[1], width))
        for i in range(slot.shape[0]):
            # One quad as a lane of its block, by the functions of the force kernels.
            b, lane, flat, (xm, tm), s = one_quad(linear, slot[i])
            if by_points:
                at = HistoryStep(history, trial, b, 0, step.dt)
                r, _, _ = point_resultants(quads, quads.points, flat, s, at, lane)
            else:
                r = stiffness_product(tables, flat, b, lane, s, work)
            if step.damped:
                change = minus(s, pick_all(last, b, 0, N_STRAIN, lane))
                viscous = stiffness_product(tables, flat, b, lane, change, work)
                r = plus_scaled(r, step.rho, viscous)
            forces = nodal_forces(xm, tm, r)
            for a in range(4):
                if corner[b, a, lane] == nodes[i]:
                    for c in range(3):
                        force[i, c] = forces[a][c]

    return write_corner_forces


write_corner_forces = _make_corner_kernel(by_points=False)
"""For linear materials."""
write_point_corner_forces = _make_corner_kernel(by_points=True)
"""For any material."""
