"""Which part of their quad the copies of cut quads carry, as loads on a surface need it.

A pressure p acts on a part P of a quad, a polygon of its parametric square. The forces of the same
virtual work are

    F_a = p ∫_P N_a a_1 x a_2 dxi deta,   a_1 x a_2 = c_0 + c_1 xi + c_2 eta,

so that they follow from the twelve numbers ∫_P N_a (1, xi, eta), which do not change. Because
x = sum N_a x_a, their sum is the force of the pressure on the part, their moment is its moment, and
their power is p times the volume that the part sweeps in a second: on flat and warped quads, for
dead and for following pressure. The parts of a quad add up to the quad, so that no cut changes
force, moment or power.

A load on a side acts on the piece of it from s_0 to s_1 that a part carries: N = s at the far end,
1 - s at the near end.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints

WHOLE = np.array([[1.0, xi / 3.0, eta / 3.0] for xi, eta in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
"""∫ N_a (1, xi, eta) over a whole quad, shape (4, 3)."""


class Parts(NamedTuple):
    """All rows that carry a part of their quad only."""

    rows: Ints
    """Rows of the state, ascending, shape (n,)."""
    film: Floats
    """∫ N_a (1, xi, eta) over the part, shape (n, 4, 3)."""
    sides: Floats
    """From where to where it lies on each side, as fractions of the side; two zeros if nowhere,
    shape (n, 4, 2)."""


class CutQuads:
    """Parts of cut quads; :mod:`shellcut.fracture` says what they are."""

    def __init__(self) -> None:
        self._of_row: dict[int, tuple[Floats, Floats]] = {}
        self._parts: Parts | None = None

    def take(self, row: int, film: Floats, sides: Floats) -> None:
        """Write down which part a row carries from now on; film and sides as in :class:`Parts`."""
        self._of_row[row] = film, sides
        self._parts = None

    @property
    def parts(self) -> Parts:
        """All parts."""
        if self._parts is None:
            rows = sorted(self._of_row)
            film, sides = (
                np.array([self._of_row[row][k] for row in rows]).reshape(len(rows), 4, n)
                for k, n in ((0, 3), (1, 2))
            )
            self._parts = Parts(np.array(rows, np.int64), film, sides)
        return self._parts

    def film_of(self, rows: Ints) -> Floats:
        """Return ∫ N_a (1, xi, eta) over the parts of quads of some rows, shape (n, 4, 3)."""
        film = np.repeat(WHOLE[None], rows.size, axis=0)
        cut, part = self.among(rows)
        film[cut] = self.parts.film[part]
        return film

    def among(self, rows: Ints) -> tuple[Bools, Ints]:
        """Return which of some rows carry a part only, shape (n,), and where these parts are."""
        known = self.parts.rows
        if not known.size:
            return np.zeros(rows.shape, np.bool_), known
        at = np.minimum(np.searchsorted(known, rows), known.size - 1)
        cut = known[at] == rows
        return cut, at[cut]
