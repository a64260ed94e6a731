"""Pressure on quads and parts of quads: ∫ p N_a a_1 x a_2, by the moments of :mod:`.cut_quads`.

Here, too, is the pressure that turns and stretches with the surface.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.jit import kernel
from shellcut.numerics.vec3 import add_scaled, combine, cross, load, scale, store, sub
from shellcut.state import KnownTopology, State

from .cut_quads import WHOLE, CutQuads


@kernel
def scatter_rows(corners: Ints, rows: Floats, force: Floats) -> None:
    """Add rows : (n, 4, 3) at the nodes corners : (n, 4) to force : (n_node, 3)."""
    for i in range(corners.shape[0]):
        for a in range(4):
            for c in range(3):
                force[corners[i, a], c] += rows[i, a, c]


@kernel
def pressure_rows(x: Floats, corners: Ints, film: Floats, pressure: float, rows: Floats) -> None:
    """Write the pressure on quads, or parts of them, into rows : (n, 4, 3).

    corners : (n, 4), rows of x.  film : (n, 4, 3), ∫ N_a (1, xi, eta) over the film of each.
    """
    for i in range(corners.shape[0]):
        x0, x1 = load(x, corners[i, 0]), load(x, corners[i, 1])
        x2, x3 = load(x, corners[i, 2]), load(x, corners[i, 3])
        x10, x23, x30, x21 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
        # a_1 = g_1 + h eta, a_2 = g_2 + h xi.
        g1, g2 = combine(0.25, x10, 0.25, x23), combine(0.25, x30, 0.25, x21)
        h = combine(0.25, x23, -0.25, x10)
        c0, c1, c2 = cross(g1, g2), cross(g1, h), cross(h, g2)
        for a in range(4):
            # ∫ p N_a (c_0 + c_1 xi + c_2 eta): the moments do not change while the film moves.
            force = combine(film[i, a, 0], c0, film[i, a, 1], c1)
            store(rows[i], a, scale(pressure, add_scaled(force, film[i, a, 2], c2)))


class PressedQuads:
    """Quads of a mesh that a pressure acts on, with their copies."""

    def __init__(self, mesh: Mesh, quads: Ints, cut: CutQuads) -> None:
        self._cut = cut
        self._pressed = np.zeros(mesh.n_quad, np.bool_)
        self._pressed[quads] = True

    def among(self, state: State, rows: Ints) -> Bools:
        """Return whether it acts on quads or copies, shape (n,)."""
        return np.asarray(self._pressed[state.quad.parent[rows]])

    def whole_first(self, rows: Ints) -> Ints:
        """Return quads and copies with the whole ones before the parts."""
        cut, _ = self._cut.among(rows)
        return np.concatenate([rows[~cut], rows[cut]])

    def film_of(self, state: State, rows: Ints) -> Floats:
        """Return ∫ N_a (1, xi, eta) over the film of quads or copies that is pressed, (n, 4, 3)."""
        return self._cut.film_of(rows) * self.among(state, rows)[:, None, None]


class FollowingPressure:
    """Following pressure on some quads, a value [MPa] that a factor of time [s] scales."""

    def __init__(
        self,
        mesh: Mesh,
        quads: Ints,
        value: float,
        factor: Callable[[float], float],
        cut: CutQuads,
    ) -> None:
        self._pressed = PressedQuads(mesh, quads, cut)
        self._value, self._factor = value, factor
        self._known = KnownTopology()
        self._corners: Ints = np.zeros((0, 4), np.int32)
        self._film = np.zeros((0, 4, 3))

    def add_forces(self, state: State, force: Floats) -> None:
        """Add the forces at t_n to force : (n_node, 3) [N], whole quads first."""
        if not self._known.is_of(state):
            every = np.arange(state.n_quad)
            rows = self._pressed.whole_first(every[self._pressed.among(state, every)])
            self._corners, self._film = state.quads[rows], self._pressed.film_of(state, rows)
            self._known.take(state)
        scatter_rows(self._corners, self._rows(state, self._corners, self._film), force)

    def on_rows(self, state: State, which: Ints) -> Floats:
        """Return the forces at t_n at the corners of quads or copies, (n, 4, 3) [N]."""
        return self._rows(state, state.quads[which], self._pressed.film_of(state, which))

    def _rows(self, state: State, corners: Ints, film: Floats) -> Floats:
        rows = np.empty((len(corners), 4, 3))
        pressure = self._value * self._factor(state.time)
        pressure_rows(state.node.x, corners, film, pressure, rows)
        return rows

    def add_stiffness(self, state: State, stiffness: Floats) -> None:
        """Add -df/dx of whole quads to stiffness : (n_quad, 12, 12) [N/mm], its symmetric part.

        A pressure on a closed surface, or a surface whose border is fixed, has a potential, and the
        rest of all quads cancels.
        """
        every = np.arange(state.n_quad)
        which = every[self._pressed.among(state, every)]
        x = np.asfortranarray(state.node.x[state.quads[which]].reshape(-1, 3))
        own = np.arange(len(x), dtype=np.int32).reshape(-1, 4)
        film = np.repeat(WHOLE[None], which.size, axis=0)
        size = float(np.ptp(x, axis=0).max())
        pressure = self._value * self._factor(state.time)
        change = np.empty((which.size, 12, 12))
        for column in range(12):
            ahead, behind = np.empty((2, which.size, 4, 3))
            for step, rows in ((size, ahead), (-size, behind)):
                moved = x.copy(order="F")
                moved[column // 3 :: 4, column % 3] += step
                pressure_rows(moved, own, film, pressure, rows)
            # The forces are quadratic in x: this is their derivative.
            change[:, :, column] = (behind - ahead).reshape(-1, 12) / (2.0 * size)
        stiffness[which] += 0.5 * (change + change.transpose(0, 2, 1))
