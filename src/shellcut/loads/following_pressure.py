"""Pressure that turns and stretches with the surface."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.state import KnownTopology, State

from .cut_quads import CutQuads
from .pressure import pressure_on_parts, pressure_rows, scatter_rows


class FollowingPressure:
    """Following pressure on some quads.

    Parameters
    ----------
    n_quad : int
        Quads of the mesh.
    quads : ndarray of int
        On which of them it acts.
    value : float
        [MPa]
    factor : callable
        Of time [s]; scales it.
    cut : CutQuads
        Parts of cut quads.
    """

    def __init__(
        self,
        n_quad: int,
        quads: Ints,
        value: float,
        factor: Callable[[float], float],
        cut: CutQuads,
    ) -> None:
        self._pressed = np.zeros(n_quad, np.bool_)
        self._pressed[quads] = True
        self._value, self._factor, self._cut = value, factor, cut
        self._known = KnownTopology()
        self._whole: Ints = np.zeros(0, np.int64)
        self._parts: Ints = np.zeros(0, np.int64)

    def at(self, time: float) -> float:
        """Return the pressure at a time [MPa]."""
        return self._value * self._factor(time)

    def acts_on(self, state: State, rows: Ints) -> Bools:
        """Return whether it acts on quads or copies, shape (n,)."""
        return np.asarray(self._pressed[state.quad.parent[rows]])

    def add_forces(self, state: State, pressure: float, force: Floats) -> None:
        """Add to force : (n_node, 3) [N], whole quads first."""
        if not self._known.is_of(state):
            parts = self._cut.parts.rows
            whole = self._pressed.copy()
            whole[parts[parts < whole.size]] = False
            self._whole = np.flatnonzero(whole)
            self._parts = parts[self.acts_on(state, parts)]
            self._known.take(state)
        for which in (self._whole, self._parts):
            if which.size:
                scatter_rows(state.quads, which, self.rows(state, which, pressure), force)

    def rows(self, state: State, which: Ints, pressure: float) -> Floats:
        """Return the forces at the corners of quads or copies on which it acts, (n, 4, 3) [N]."""
        rows = np.empty((which.size, 4, 3))
        cut, at = self._cut.among(which)
        x, quads = state.node.x, state.quads
        if not cut.any():
            pressure_rows(x, quads, which, pressure, rows)
        elif cut.all():
            pressure_on_parts(x, quads, which, self._cut.parts.film[at], pressure, rows)
        else:
            rows[~cut] = self.rows(state, which[~cut], pressure)
            rows[cut] = self.rows(state, which[cut], pressure)
        return rows

    def add_stiffness(self, state: State, pressure: float, stiffness: Floats) -> None:
        """Add -df/dx of whole quads to stiffness : (n_quad, 12, 12) [N/mm], its symmetric part.

        A pressure on a closed surface, or one whose rim is held, has a potential, and the rest of
        all quads cancels.
        """
        which = np.flatnonzero(self._pressed)
        corners = state.node.x[state.quads[which]].reshape(-1, 3)
        own = np.arange(corners.shape[0]).reshape(-1, 4)
        size = float(np.ptp(corners, axis=0).max())
        change = np.empty((which.size, 12, 12))
        for column in range(12):
            step = np.zeros((4, 3))
            step.flat[column] = size
            ahead, behind = np.empty((2, which.size, 4, 3))
            for sign, rows in ((1.0, ahead), (-1.0, behind)):
                moved = corners + np.tile(sign * step, (which.size, 1))
                pressure_rows(moved, own, np.arange(which.size), pressure, rows)
            # The forces are quadratic in x: this is their derivative.
            change[:, :, column] = (behind - ahead).reshape(-1, 12) / (2.0 * size)
        stiffness[which] += 0.5 * (change + change.transpose(0, 2, 1))
