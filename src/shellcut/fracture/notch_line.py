"""The line along which a film is notched before a run, straight or through points."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, norm, product
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.small_matrices import least_squares
from shellcut.state import State

from .quad_polygon import AWAY, Point, shape_slopes
from .tip import Place

_ON_SIDE = 1e-9
"""Of a segment's length: a notch that ends closer than this before a side or node ends there."""

_OFF = 0.25
"""Of an edge: a point that lies higher above the film is not in it."""

_FAR = 10.0
"""|xi| or |eta| of a point that is not in the quad whatever further steps give."""

_INSIDE = 1.0 + 1e-6
"""Largest |xi|, |eta| of a point in a quad."""

_REACH = 3.0
"""Of an edge: how far ahead of a tip a line is followed."""

_STEPS = _REACH * np.arange(1, 61) / 60.0
"""Of an edge: distances ahead of a tip at which it is tested where a line leaves a quad."""

_GRAZES = 4
"""Of the places at ``_STEPS``: a line that is outside a quad for fewer has not left it."""

_MORE = 1.5
"""Of an edge: a line of which less is left has been followed to its end."""


class NotchLine:
    """Where a notch continues from its tip, and whether it has reached its end.

    Parameters
    ----------
    points : ndarray, shape (n, 3)
        Through which it leads [mm].
    """

    def __init__(self, points: Floats) -> None:
        legs = np.diff(points, axis=0)
        self.start: Floats = points[0]
        """[mm], shape (3,)."""
        self._corners, self._lengths = points, np.linalg.norm(legs, axis=1)
        self._units = legs / self._lengths[:, None]
        self._distances = np.append(0.0, np.cumsum(self._lengths))
        self._across: Floats | None = None
        self._followed = 0.0

    def direction(self, here: Floats, at: Place, quads: Floats) -> tuple[Floats, Floats | None]:
        """Return in which direction a notch continues, and how its plane leans from the director.

        A straight line keeps its plane. Through more points it aims at where the line leaves the
        quad ahead in which it stays longest, or else at the line an edge ahead.

        Parameters
        ----------
        here : ndarray, shape (3,)
            Its tip in the reference film [mm].
        at : Place
            Of that tip.
        quads : ndarray, shape (n, 4, 3)
            Corners of the quads ahead in the reference film [mm].
        """
        if len(self._units) > 1:
            self._follow(here, at.size)
            places = [self._at(self._followed + part * at.size) for part in _STEPS]
            stays = max((_stay(places, corners) for corners in quads), default=0)
            target = places[stays - 1] if stays else self._at(self._followed + at.size)
            return (target - here) / norm(target - here), None
        across = self._across = (
            np.cross(at.t, self._units[0]) if self._across is None else self._across
        )
        return np.cross(across, at.t), product(at.t, across) / product(across, across) * across

    def ends(self, here: Floats, length: float, *, at_cut: bool) -> bool:
        """Return whether a tip has reached the end, after a segment of some length [mm].

        A line that ends where it began continues by as much if it is not yet at an earlier cut, its
        own first segment.
        """
        if len(self._units) > 1:
            self._follow(here, length)
            short = self._distances[-1] - self._followed
            if not at_cut and (self._corners[0] == self._corners[-1]).all():
                short += length
        else:
            short = product(self._corners[-1] - here, self._units[0])
        return bool(short < _ON_SIDE * length)

    def point_ahead(self, size: float) -> Floats | None:
        """Return the point a little more than an edge ahead, None if the line ends before.

        None of a straight line, too: it may leave the film.
        """
        ahead = self._followed + _MORE * size
        return self._at(ahead) if len(self._units) > 1 and ahead < self._distances[-1] else None

    def _follow(self, here: Floats, size: float) -> None:
        """Move on along the line to the point that is nearest to a tip, a few edges at most.

        So a line that returns to where it began is not followed from there again. The first tip
        may be on any leg: a line may begin outside the film.
        """
        followed = min(self._followed, float(self._distances[-1]))
        reach = _REACH * size if self._followed else np.inf
        near = (self._distances[1:] >= followed) & (self._distances[:-1] <= followed + reach)
        legs = np.flatnonzero(near)
        along = ((here - self._corners[legs]) * self._units[legs]).sum(axis=1)
        least, most = np.maximum(self._followed - self._distances[legs], 0.0), self._lengths[legs]
        most = np.where(legs == len(self._lengths) - 1, np.inf, most)
        on = np.clip(along, least, most)
        k = int(norm(self._corners[legs] + on[:, None] * self._units[legs] - here).argmin())
        self._followed = float(self._distances[legs[k]] + on[k])

    def _at(self, distance: float) -> Floats:
        """Return the point of the line at a distance from its start, shape (3,).

        Along its legs, and beyond the end straight on.
        """
        k = min(int(np.searchsorted(self._distances, distance, side="right")), len(self._units)) - 1
        return np.asarray(self._corners[k] + (distance - self._distances[k]) * self._units[k])


def _stay(places: Sequence[Floats], corners: Floats) -> int:
    """Return at which of some places of a line it leaves a quad into which it leads."""
    inside = [max(map(abs, _place_in(corners, place)[0])) < _INSIDE for place in places]
    first = inside.index(True) if any(inside) else len(inside)
    return next((i for i in range(first, len(inside)) if not any(inside[i : i + _GRAZES])), 0)


def row_at(state: State, point: Floats) -> tuple[int, Point] | None:
    """Return the quad of an uncut film at a point, and where in it; None outside the film.

    point : (3,) [mm].
    """
    corners = state.node.X[state.quads]
    gap, size = norm(corners.mean(axis=1) - point), norm(corners[:, 2] - corners[:, 0])
    near = np.flatnonzero(gap < np.maximum(size, norm(corners[:, 3] - corners[:, 1])))
    found = []
    for row in near[np.argsort(gap[near], kind="stable")].tolist():
        place, height = _place_in(corners[row], point)
        if max(abs(place[0]), abs(place[1])) < _INSIDE and height < _OFF * size[row]:
            found.append((height, row, place))
    if not found:
        return None
    # Of several sheets that in which it lies; of quads at one side the nearer.
    least = min(height for height, *_ in found)
    near_least = ((k, at) for height, k, at in found if height <= least + AWAY * size[k])
    return next(near_least)


def _place_in(corners: Floats, point: Floats) -> tuple[Point, float]:
    """Return the parameters of the point of a quad next to another, and their distance [mm]."""
    xi, eta = 0.0, 0.0
    for _ in range(20):  # Newton's method; a convex quad takes four or five
        miss = point - product(shape_functions(xi, eta), corners)
        d_xi, d_eta = least_squares(product(shape_slopes((xi, eta)), corners).T, miss)
        xi, eta = xi + float(d_xi), eta + float(d_eta)
        if abs(d_xi) + abs(d_eta) < 1e-12 or max(abs(xi), abs(eta)) > _FAR:
            break
    miss = point - product(shape_functions(xi, eta), corners)
    return (xi, eta), float(norm(miss))
