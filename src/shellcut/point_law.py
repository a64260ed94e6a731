"""Plane stress at one thickness point: what a material does to a strain, with its history.

A law is a branch of :func:`point_stress`, chosen by the material's ``kind``. It takes the Cartesian
strain (E_11, E_22, 2E_12) at t_n and the history of the point at t_{n-1}, writes the history at
t_n, and returns the second Piola-Kirchhoff stress with the stored energy density. A new material
adds a kind, its parameters and how many history numbers a point keeps.
"""

from __future__ import annotations

from ._jit import Floats, Vec3, inline

ELASTIC = 0
"""St.Venant-Kirchhoff: parameters are the six moduli of the upper triangle of C; no history."""

N_PARAMETER = 6


@inline
def point_stress(
    kind: int,
    parameters: Floats,
    k: int,
    strain: Vec3,
    old: Floats,
    new: Floats,
) -> tuple[Vec3, float]:
    """Return stress [MPa] and stored energy density [N/mm²] at one point.

    parameters : (n_point, N_PARAMETER), row k is read.  old, new : (n_point, n_history), row k of
    ``old`` is read and of ``new`` written; both have no columns for a law without history.
    """
    e1, e2, e12 = strain
    # kind == ELASTIC is the only law so far; others branch here.
    s1 = parameters[k, 0] * e1 + parameters[k, 1] * e2 + parameters[k, 2] * e12
    s2 = parameters[k, 1] * e1 + parameters[k, 3] * e2 + parameters[k, 4] * e12
    s12 = parameters[k, 2] * e1 + parameters[k, 4] * e2 + parameters[k, 5] * e12
    return (s1, s2, s12), 0.5 * (s1 * e1 + s2 * e2 + s12 * e12)
