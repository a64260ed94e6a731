"""Pressure on quads: ∫ p N_a a_1 x a_2 over 2 x 2 Gauss points, for each corner a.

On a part of a quad (:mod:`.cut_quads`) the integral is exact by its moments.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3
from shellcut.numerics.jit import always_inline, inline, kernel
from shellcut.numerics.vec3 import add, add_scaled, combine, cross, load, scale, store, sub

_G = 1.0 / np.sqrt(3.0)


@kernel
def scatter_rows(quads: Ints, which: Ints, rows: Floats, force: Floats) -> None:
    """Add rows : (n, 4, 3) of the quads ``which`` to force : (n_node, 3)."""
    for i in range(which.shape[0]):
        for a in range(4):
            for c in range(3):
                force[quads[which[i], a], c] += rows[i, a, c]


@inline
def _weight(c: float, near: bool) -> float:
    return 0.5 * (1.0 - c) if near else 0.5 * (1.0 + c)


@always_inline
def _pressure_on_corners(x: Floats, quads: Ints, e: int, pressure: float) -> tuple[Vec3, ...]:
    """Return ∫ p N_a a_1 x a_2 of a quad over 2 x 2 Gauss points, for its four corners."""
    x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
    x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
    x01, x32, x03, x12 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
    f0 = f1 = f2 = f3 = (0.0, 0.0, 0.0)
    for q in range(4):
        xi = -_G if q in (0, 3) else _G
        eta = -_G if q < 2 else _G
        a1 = combine(0.5 * _weight(eta, True), x01, 0.5 * _weight(eta, False), x32)
        a2 = combine(0.5 * _weight(xi, True), x03, 0.5 * _weight(xi, False), x12)
        p = scale(pressure, cross(a1, a2))
        f0 = add(f0, scale(_weight(xi, True) * _weight(eta, True), p))
        f1 = add(f1, scale(_weight(xi, False) * _weight(eta, True), p))
        f2 = add(f2, scale(_weight(xi, False) * _weight(eta, False), p))
        f3 = add(f3, scale(_weight(xi, True) * _weight(eta, False), p))
    return f0, f1, f2, f3


@kernel
def pressure_rows(x: Floats, quads: Ints, which: Ints, pressure: float, rows: Floats) -> None:
    """Write the pressure on the corners of the quads ``which`` into rows : (n, 4, 3)."""
    for i in range(which.shape[0]):
        corners = _pressure_on_corners(x, quads, which[i], pressure)
        for a in range(4):
            store(rows[i], a, corners[a])


@kernel
def pressure_on_parts(
    x: Floats, quads: Ints, which: Ints, film: Floats, pressure: float, rows: Floats
) -> None:
    """Write the pressure on parts of the quads ``which`` into rows : (n, 4, 3).

    film : (n, 4, 3), ∫ N_a (1, xi, eta) over each part.
    """
    for i in range(which.shape[0]):
        e = which[i]
        x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
        x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
        x10, x23, x30, x21 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
        # a_1 = g_1 + h eta, a_2 = g_2 + h xi.
        g1, g2 = combine(0.25, x10, 0.25, x23), combine(0.25, x30, 0.25, x21)
        h = combine(0.25, x23, -0.25, x10)
        c0, c1, c2 = cross(g1, g2), cross(g1, h), cross(h, g2)
        for a in range(4):
            force = combine(film[i, a, 0], c0, film[i, a, 1], c1)
            store(rows[i], a, scale(pressure, add_scaled(force, film[i, a, 2], c2)))


@kernel
def pressure_on_nodes(
    nodes: Ints,
    quads_at: Ints,
    n_quad_at: Ints,
    quads: Ints,
    pressed: Bools,
    X: Floats,
    reference_quads: Ints,
    pressure: float,
    force: Floats,
) -> None:
    """Write the dead pressure on ``nodes`` from the pressed quads at each into force : (n, 3).

    quads_at, n_quad_at : adjacency of the state.  quads, reference_quads : (n_quad, 4), now and
    before all splits.
    """
    for i in range(nodes.shape[0]):
        for k in range(n_quad_at[nodes[i]]):
            e = quads_at[nodes[i], k]
            if pressed[e]:
                corners = _pressure_on_corners(X, reference_quads, e, pressure)
                for a in range(4):
                    if quads[e, a] == nodes[i]:
                        for c in range(3):
                            force[i, c] += corners[a][c]
