"""Kernels that add the forces of quads with thickness points, for any material.

Damping is that of :mod:`shellcut.mitc4.forces`, with the stiffness H of the elastic moduli: the
stress of the law and rho H a_n act together, and H a_n is computed separately. At the end: forces
of single quads on single nodes, of both kinds, without changing stored values.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, Number
from shellcut.material.law_dispatch import HistoryStep, dissipates
from shellcut.numerics.borrowed import borrowed, lent
from shellcut.numerics.jit import always_inline, kernel
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import pick_all, put_all, total, zero
from shellcut.numerics.processor import align_stack, flush_subnormals, set_rounding

from .element import N_STRAIN, Sixteen, nodal_forces
from .quad_strains import (
    PointQuads,
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
from .thickness_points import (
    PointPlace,
    PointTables,
    resultants_at,
)


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
    lane: Lane,
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
    xm, tm = modes_of(quads, b, lane)
    s = strain_of(quads.tables, flat, b, lane, (xm, tm))
    r, stored, lost = point_resultants(
        both, points, flat, s, HistoryStep(history, None, b, b, step.dt), lane
    )
    if not step.damped:
        add_to_nodes(rows, quads.corner, b, lane, (xm, tm), r)
        return stored, zero(lane), lost
    s_last, s_before = (
        pick_all(step.last, b, 0, N_STRAIN, lane),
        pick_all(step.before, b, 0, N_STRAIN, lane),
    )
    viscous = stiffness_product(quads.tables, flat, b, lane, minus(s, s_last), work)
    put_all(step.before, b, 0, lane, s)
    add_to_nodes(rows, quads.corner, b, lane, (xm, tm), plus_scaled(r, step.rho, viscous))
    return stored, dot16(minus(s, s_before), viscous), lost


def _make_point_kernel(flat: bool) -> Any:
    @kernel
    def add_point_quads(
        first: int,
        stride: int,
        parity: int,
        start: Ints,
        quads: PointQuads,
        step: QuadStep,
        rows: Floats,
        sums: Floats,
    ) -> None:
        """Add the forces of quads with thickness points; arguments as of the linear kernel.

        sums : (n_strip, 3), to which the stored energy, (a_n + a_{n-1})·H a_n and the energy
        dissipated by the material in the step are added.
        """
        align_stack()
        quads, step = borrowed(quads), borrowed(step)
        points, history = lent(quads.points), lent(step.history)
        work = np.empty((2, N_STRAIN, quads.quads.corner.shape[2]))
        rounding = flush_subnormals()
        for k in range(2 * first + parity, start.shape[0] - 1, 2 * stride):
            none = zero(None)
            p0, p1, p2 = none, none, none
            for b in range(start[k], start[k + 1]):
                q0, q1, q2 = _point_block(b, None, flat, quads, points, step, history, rows, work)
                p0, p1 = p0 + q0, p1 + q1
                if dissipates(quads.points.rule.laws):
                    p2 = p2 + q2
            sums[k, 0] += total(p0)
            sums[k, 1] += total(p1)
            sums[k, 2] += total(p2)
        set_rounding(rounding)

    return add_point_quads


add_flat_point_quads = _make_point_kernel(flat=True)
"""For flat quads."""
add_full_point_quads = _make_point_kernel(flat=False)
"""For curved, warped or unevenly layered quads."""


def _make_corner_kernel(by_points: bool) -> Any:
    @kernel
    def write_corner_forces(
        slot: Ints, nodes: Ints, quads: PointQuads, step: QuadStep, force: Floats
    ) -> None:
        """Write minus the force of the quad at slot[i] on its node nodes[i] to force : (n, 3)."""
        linear, last, history = quads.quads, step.last, step.history
        corner, tables = linear.corner, linear.tables
        width = corner.shape[2]
        work = np.empty((2, N_STRAIN, width))
        trial = np.empty((1, history.shape[1], width))
        for i in range(slot.shape[0]):
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
