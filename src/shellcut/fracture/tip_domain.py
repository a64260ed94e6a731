"""The film that slides with the tip of a crack, and how far: the domain of the force on the tip.

The domain is the film that hangs together around the tip: quads and copies that share nodes, so
that none lies beyond a flank. In it q is 1 around the tip and falls to 0 at what does not go along
when this tip advances: the film farther off, every edge of the film but the flanks of the crack
itself, the tips of other cracks, and held nodes. With d the distance from the tip, b that from the
nearest of these, and r and R the radii within which all film goes along and beyond which all stays,

    q = min(1, 2 b / (b + d), (R - d) / (R - r)).

 The crack's own flanks slide as the film on
both sides of them does: b counts through them, so q has no jump there, which would stretch the
cables. The flanks of a crack are its own as far back as no other edge of the film touches them: not
the rim at which it began, nor the other branch, nor its own way where it has come across that.

Of a copy the corners beyond an edge that stays lie outside the film: there b counts as negative, so
that q vanishes on that edge.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, norm, product
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .cut_topology import CutTopology
from .quad_polygon import FLANK, beyond, on_side, shape_functions

AROUND = 1.6
"""Radius within which film is looked for, over R."""

# Of the reach: ends of edges that are nearer are one place, far above round-off.
_SAME = 1e-5


class TipDomain(NamedTuple):
    """The film around a tip, as long as topology and tips stay the same."""

    rows: Ints
    """Quads and copies that hang together within ``AROUND`` R, shape (n,)."""
    q: Floats
    """How far their corners go along, shape (n, 4)."""
    room: float
    """From the tip to the nearest place that stays [mm], R at most."""

    @classmethod
    def of(
        cls,
        state: State,
        shell: MITC4Shell,
        topology: CutTopology,
        place: Floats,
        base: Floats,
        radii: tuple[float, float],
        ahead: Sequence[int],
        tips: Floats,
    ) -> TipDomain:
        """Find the domain.

        Parameters
        ----------
        state, shell, topology : State, MITC4Shell, CutTopology
            The film as it is cut.
        place : ndarray, shape (3,)
            Of the tip in the reference film [mm].
        base : ndarray, shape (2, 3)
            Unit vectors of the sheet at the tip.
        radii : (float, float)
            r and R [mm].
        ahead : sequence of int
            Rows at the tip.
        tips : ndarray, shape (n_tip, 3)
            Where other cracks end in the reference film [mm].
        """
        whole, reach = radii
        rows = _film_around(state, shell, place, np.cross(*base), AROUND * reach, ahead)
        X = shell.reference.x[shell.reference.quads[rows]]
        edges = _edges(state, topology, rows, X)
        ends = np.array([edge.ends for edge in edges]).reshape(-1, 2, 3)
        stays = ~_own(ends, place, reach)
        nodes = state.quads[rows]
        in_sheet = np.abs(base).max(axis=0) > _SAME
        held = (state.node.support[nodes, :3] & in_sheet).any(axis=2)
        points = np.concatenate([tips, X[held]])
        still = np.concatenate([ends[stays], np.repeat(points[:, None], 2, axis=1)])
        d = np.linalg.norm(X - place, axis=2)
        b = np.full_like(d, reach)
        b[d < reach] = _distance(X[d < reach], still, reach)
        for edge, stay in zip(edges, stays.tolist(), strict=True):
            if stay and edge.beyond:
                b[edge.i, edge.beyond] = -b[edge.i, edge.beyond]
        far = np.clip((reach - d) / (reach - whole), 0.0, 1.0)
        q = np.minimum(far, 2.0 * b / np.maximum(d + np.maximum(b, 0.0), _SAME * reach))
        q[far == 0.0] = 0.0
        return cls(rows, q, float(_distance(place, still, reach)))


class _Edge(NamedTuple):
    """An edge of the film."""

    ends: Floats
    """In the reference [mm], shape (2, 3)."""
    i: int
    """Which of the rows has it."""
    beyond: list[int]
    """Corners of that row outside the film because of it."""


def _film_around(
    state: State, shell: MITC4Shell, place: Floats, T: Floats, radius: float, ahead: Sequence[int]
) -> Ints:
    """Return the rows within a radius of a place that hang together with some, shape (n,)."""
    film = shell.reference
    gap = np.linalg.norm(film.x[film.quads].mean(axis=1) - place, axis=1)
    # The far wall of a tube is not around the tip.
    near = (gap < radius) & (product(film.t[film.quads].sum(axis=1), T) > 0.0)
    near &= ~state.quad.dropped[: len(near)]
    near[list(ahead)] = True
    rows = np.flatnonzero(near)
    nodes, at = np.unique(state.quads[rows], return_inverse=True)
    at, found, n = at.reshape(-1, 4), np.isin(rows, ahead), 0
    while found.sum() > n:
        n, reached = int(found.sum()), np.zeros(len(nodes), np.bool_)
        reached[at[found]] = True
        found = np.asarray(reached[at].any(axis=1))
    return rows[found]


def _edges(state: State, topology: CutTopology, rows: Ints, X: Floats) -> list[_Edge]:
    """Return the edges of the film in some rows: flanks, rims and sides that are broken or torn.

    A side within the film has its two nodes in common with a row beyond it.
    """
    nodes = state.quads[rows]
    pairs = np.sort(np.stack([nodes, np.roll(nodes, -1, axis=1)], axis=2), axis=2).reshape(-1, 2)
    _, at, count = np.unique(pairs, axis=0, return_inverse=True, return_counts=True)
    alone = (count[at.reshape(-1)] == 1).reshape(-1, 4)
    found = []
    for i, row in enumerate(rows.tolist()):
        polygon = topology.polygon(row)
        points = polygon.points
        for a, b, side in zip(points, (*points[1:], points[0]), polygon.sides, strict=True):
            if side == FLANK:
                parts, outside = [(a, b)], beyond(a, b)
            elif alone[i, side]:
                parts, outside = [(a, b)], []
            else:
                parts = [
                    (on_side(side, start), on_side(side, stop))
                    for start, stop in topology.open_parts(row, side)
                ]
                outside = []
            for part in parts:
                ends = product(np.array([shape_functions(point) for point in part]), X[i])
                found.append(_Edge(ends, i, outside))
    return found


def _own(ends: Floats, place: Floats, reach: float) -> Bools:
    """Return which edges are flanks of the crack that ends at a place, shape (n,).

    ends : (n, 2, 3). From the tip on back along the only way there is, as far as the reach.
    """
    own, way = np.zeros(len(ends), np.bool_), 0.0
    while way < reach:
        at = np.linalg.norm(ends - place, axis=2) < _SAME * reach
        here = np.flatnonzero(at.any(axis=1) & ~own)
        others = ends[here, np.where(at[here, 0], 1, 0)]
        if not here.size or (np.linalg.norm(others - others[0], axis=1) > _SAME * reach).any():
            break
        own[here], way = True, way + float(norm(others[0] - place))
        place = others[0]
    return own


def _distance(X: Floats, ends: Floats, most: float) -> Floats:
    """Return how far points X : (..., 3) are from the nearest of some edges, at most ``most``.

    ends : (n, 2, 3).
    """
    way = ends[:, 1] - ends[:, 0]
    gap = X[..., None, :] - ends[:, 0]
    along = (gap * way).sum(axis=-1) / np.maximum((way * way).sum(axis=-1), np.finfo(float).tiny)
    gap = gap - np.clip(along, 0.0, 1.0)[..., None] * way
    return np.asarray(np.linalg.norm(gap, axis=-1).min(axis=-1, initial=most))
