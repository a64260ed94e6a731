"""Plane stress at one thickness point: what a material does to a strain, with its history.

A law is a branch of :func:`point_stress`, chosen by the material's ``kind``. It takes the Cartesian
strain (E_11, E_22, 2E_12) at t_n and the history of the point at t_{n-1}, writes the history at
t_n, and returns the second Piola-Kirchhoff stress with the stored energy density. It is a function
of numbers, so it serves one quad or many (:mod:`shellcut.numerics.lanes`); history is read by
``pick`` and written by ``put``. A new material adds a kind, its parameters and how many history
numbers a point keeps.
"""

from __future__ import annotations

from shellcut.arrays import Floats, Number, Vector
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_instructions import Lane

ELASTIC = 0
"""St.Venant-Kirchhoff: parameters are the six moduli of the upper triangle of C; no history."""

N_PARAMETER = 6


@always_inline
def point_stress(
    kind: int,
    parameters: Floats,
    k: int,
    strain: Vector,
    old: Floats,
    new: Floats,
    b: int,
    b_new: int,
    first: int,
    lane: Lane,
) -> tuple[Vector, Number]:
    """Return stress [MPa] and stored energy density [N/mm²] at thickness point ``k``.

    parameters : (n_point, N_PARAMETER), row k is read.  old, new : (n_block, n, width), the numbers
    from ``first`` on of block ``b`` are read, those of block ``b_new`` written.
    """
    e1, e2, e12 = strain
    # kind == ELASTIC is the only law so far; others branch here.
    s1 = parameters[k, 0] * e1 + parameters[k, 1] * e2 + parameters[k, 2] * e12
    s2 = parameters[k, 1] * e1 + parameters[k, 3] * e2 + parameters[k, 4] * e12
    s12 = parameters[k, 2] * e1 + parameters[k, 4] * e2 + parameters[k, 5] * e12
    return (s1, s2, s12), 0.5 * (s1 * e1 + s2 * e2 + s12 * e12)
