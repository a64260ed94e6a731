"""Kernels that add the forces of quads to the nodes, by blocks.

Damping is proportional to the stiffness, on the strain rate: the stress acts on
u = s + rho (s_n - s_{n-1}), rho = beta / dt, the rate of the half step before t_n (so the step
stays explicit; [Frangi2010] 5.2). So for a linear material the resultants are r = H u, one product.
The ledger needs the stored energy ½ s·H s and, for the work of the damping stress that is
consistent with the central difference, ½ rho (a_{n-1} + a_n)·H a_n with the strain steps
a_n = s_n - s_{n-1}. Summed over all quads, A = s_n·H s_n, B = s_n·H a_n, C = a_n·H a_n and
D = a_{n-1}·H a_n follow from three products with r and last step's A and B, because H is symmetric:

    s_n·r = A + rho B,   a_n·r = B + rho C,   A' = (s_n - a_n)·H (s_n - a_n) = A - 2 B + C
    a_{n-1}·r = a_{n-1}·H s_n + rho D,        B' = (s_n - a_n)·H a_{n-1} = a_{n-1}·H s_n - D

so C = (A' + (2 + rho) a_n·r - s_n·r) / (1 + rho)² and D = (a_{n-1}·r - B') / (1 + rho). Errors of
A' fade by (rho / (1 + rho))² per step. The kernels sum s_n·r, s_{n-1}·r and s_{n-2}·r.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, Number
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, kernel
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import pick_all, put_all, total, zero
from shellcut.numerics.processor import align_stack, flush_subnormals, set_rounding

from .element import N_STRAIN
from .quad_strains import (
    Quads,
    QuadStep,
    add_to_nodes,
    dot16,
    minus,
    modes_of,
    plus_scaled,
    stiffness_product,
    strain_of,
)


@always_inline
def _linear_block(
    b: int,
    lane: Lane,
    flat: bool,
    quads: Quads,
    step: QuadStep,
    rows: Floats,
    work: Floats,
) -> tuple[Number, Number, Number]:
    """Add the forces of block ``b``; return s_n·r, s_{n-1}·r and s_{n-2}·r."""
    corner, tables = quads.corner, quads.tables
    xm, tm = modes_of(quads, b, lane)
    s = strain_of(tables, flat, b, lane, (xm, tm))
    if not step.damped:
        r = stiffness_product(tables, flat, b, lane, s, work)
        add_to_nodes(rows, corner, b, lane, (xm, tm), r)
        return dot16(s, r), zero(lane), zero(lane)
    s_last, s_before = (
        pick_all(step.last, b, 0, N_STRAIN, lane),
        pick_all(step.before, b, 0, N_STRAIN, lane),
    )
    u = plus_scaled(s, step.rho, minus(s, s_last))
    r = stiffness_product(tables, flat, b, lane, u, work)
    put_all(step.before, b, 0, lane, s)
    add_to_nodes(rows, corner, b, lane, (xm, tm), r)
    return dot16(s, r), dot16(s_last, r), dot16(s_before, r)


def _make_linear_kernel(flat: bool) -> Any:
    @kernel
    def add_linear_quads(
        first: int,
        stride: int,
        parity: int,
        start: Ints,
        quads: Quads,
        step: QuadStep,
        rows: Floats,
        sums: Floats,
    ) -> None:
        """Add minus dW/dx and dW/dt of quads, with stiffness damping, to the force rows.

        Treats every ``stride``-th strip of a parity, which is 0 or 1, from the ``first``-th on.
        start : (n_strip + 1,), blocks.
        rows : (n_node, 8).  sums : (n_strip, 3), to which s_n·r, s_{n-1}·r and s_{n-2}·r are
        added.
        """
        align_stack()
        quads, step = borrowed(quads), borrowed(step)
        work = np.empty((2, N_STRAIN, quads.corner.shape[2]))
        rounding = flush_subnormals()
        for k in range(2 * first + parity, start.shape[0] - 1, 2 * stride):
            none = zero(None)
            p0, p1, p2 = none, none, none
            for b in range(start[k], start[k + 1]):
                q0, q1, q2 = _linear_block(b, None, flat, quads, step, rows, work)
                p0, p1, p2 = p0 + q0, p1 + q1, p2 + q2
            sums[k, 0] += total(p0)
            sums[k, 1] += total(p1)
            sums[k, 2] += total(p2)
        set_rounding(rounding)

    return add_linear_quads


add_flat_quads = _make_linear_kernel(flat=True)
"""For flat quads."""
add_full_quads = _make_linear_kernel(flat=False)
"""For curved, warped or unevenly layered quads."""
