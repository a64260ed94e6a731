"""Pressure that turns and stretches with the surface."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.state import KnownTopology, State

from .cut_quads import WHOLE, CutQuads
from .pressure import PressedQuads, pressure_rows, scatter_rows


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

        A pressure on a closed surface, or one whose rim is held, has a potential, and the rest of
        all quads cancels.
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
