"""The film that slides with the tip of a crack, and how far: the domain of the force on the tip.

The domain is the connected film around the tip (:mod:`.film_around`), so that none lies beyond a
flank. In it q is 1 around the tip and falls to 0 at what does not move along when
this tip advances: the film farther off, all of the film's border but the flanks of the crack
itself, the tips of other cracks, and supported nodes. With d the distance from the tip, b that from
the nearest of these, and r and R the radii within which all film moves along and beyond which all
stays,

    q = min(1, 2 b / (b + d), (R - d) / (R - r)).

The crack's own flanks (:meth:`.FilmBorder.path_back`) slide as the film on both sides of them does:
b counts through them, so q has no jump there, which would stretch the cables.

Of a copy the corners beyond an edge that stays lie outside the film: there b counts as negative, so
that q vanishes on that edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, norm, off_segments
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .film_around import film_around
from .film_border import SAME, FilmBorder

AROUND = 1.6
"""Radius within which film is searched, over R."""


class TipDomain(NamedTuple):
    """The film around a tip, as long as topology and tips stay the same."""

    rows: Ints
    """Quads and copies connected within ``AROUND`` R, shape (n,)."""
    q: Floats
    """How far their corners move along, shape (n, 4)."""
    room: float
    """From the tip to the nearest place that stays [mm], R at most."""

    @classmethod
    def of(
        cls,
        state: State,
        shell: MITC4Shell,
        film: FilmBorder,
        place: Floats,
        base: Floats,
        radii: tuple[float, float],
        ahead: Sequence[int],
        tips: Sequence[tuple[Floats, Sequence[int]]],
    ) -> TipDomain:
        """Find the domain.

        Parameters
        ----------
        state, shell, film : State, MITC4Shell, FilmBorder
            The film as it is cut.
        place : ndarray, shape (3,)
            Of the tip in the reference film [mm].
        base : ndarray, shape (2, 3)
            Unit vectors of the sheet at the tip.
        radii : (float, float)
            r and R [mm].
        ahead : sequence of int
            Rows at the tip.
        tips : sequence of (ndarray, sequence of int)
            Where each other crack ends in the reference film [mm], shape (3,), and the rows there:
            in film that is not connected a tip ends nothing.
        """
        whole, reach = radii
        rows = film_around(state, shell, place, np.cross(*base), AROUND * reach, ahead)
        X = shell.reference.x[shell.reference.quads[rows]]
        own = np.zeros(len(film.row), np.bool_)
        for flanks, _, stop in film.path_back(place):
            own[flanks] = True
            if stop >= reach:
                break
        here = np.isin(film.row, rows) & ~own
        nodes = state.quads[rows]
        in_sheet = np.abs(base).max(axis=0) > SAME
        supported = (state.node.support[nodes, :3] & in_sheet).any(axis=2)
        ends = [at for at, beside in tips if np.isin(beside, rows).any()]
        points = np.concatenate([np.reshape(ends, (-1, 3)), X[supported]])
        still = np.concatenate([film.ends[here], np.repeat(points[:, None], 2, axis=1)])
        d = np.linalg.norm(X - place, axis=2)
        b = np.full_like(d, reach)
        b[d < reach] = _distance(X[d < reach], still, reach)
        outside = np.zeros(b.shape, np.bool_)
        np.logical_or.at(outside, np.searchsorted(rows, film.row[here]), film.beyond[here])
        b[outside] *= -1.0
        far = np.clip((reach - d) / (reach - whole), 0.0, 1.0)
        q = np.minimum(far, 2.0 * b / np.maximum(d + np.maximum(b, 0.0), SAME * reach))
        q[far == 0.0] = 0.0
        return cls(rows, q, float(_distance(place, still, reach)))


def _distance(X: Floats, ends: Floats, most: float) -> Floats:
    """Return how far points X : (..., 3) are from the nearest of some edges, at most ``most``.

    ends : (n, 2, 3).
    """
    gap, _ = off_segments(X[..., None, :], ends[:, 0], ends[:, 1] - ends[:, 0])
    return np.asarray(norm(gap).min(axis=-1, initial=most))
