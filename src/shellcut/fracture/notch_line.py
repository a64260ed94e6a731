"""The line along which a film is notched before a run, straight or through points."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.state import State

from .quad_polygon import Point, shape_functions, shape_slopes
from .tip import Place

_ON_SIDE = 1e-9
"""Of a segment's length: a notch that ends closer than this before a side or node ends there."""

_NEAREST = 16
"""Quads, by their middle, in which a point is looked for."""

_OFF = 0.25
"""Of an edge: a point that lies higher above the film is not in it."""

_FAR = 10.0
"""|xi| or |eta| of a point that is not in the quad whatever comes of further steps."""

_INSIDE = 1.0 + 1e-6
"""Largest |xi|, |eta| of a point in a quad."""


class NotchLine:
    """Where a notch goes on from its tip, and whether it has come to its end.

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
        self._way = np.append(0.0, np.cumsum(self._lengths))
        self._across: Floats | None = None

    def direction(self, here: Floats, at: Place) -> tuple[Floats, Floats | None]:
        """Return in which direction a notch goes on, and how its plane leans from the director.

        A straight line keeps its plane. Through more points it aims at the line an edge ahead.

        Parameters
        ----------
        here : ndarray, shape (3,)
            Its tip in the reference film [mm].
        at : Place
            Of that tip.
        """
        if len(self._units) > 1:
            k, along = self._nearest(here)
            if (gap := self._way[k] + along + at.size - self._way[-1]) > 0.0:
                target = self._corners[-1] + gap * self._units[-1]
            else:
                target = self._at(self._way[k] + along + at.size)
            return (target - here) / np.linalg.norm(target - here), None
        across = self._across = (
            np.cross(at.t, self._units[0]) if self._across is None else (self._across)
        )
        return np.cross(across, at.t), (at.t @ across) / (across @ across) * across

    def ends(self, here: Floats, length: float) -> bool:
        """Return whether a tip has come to the end, after a segment of some length [mm]."""
        if len(self._units) > 1:
            k, along = self._nearest(here)
            short = self._way[-1] - self._way[k] - along
        else:
            short = (self._corners[-1] - here) @ self._units[0]
        return bool(short < _ON_SIDE * length)

    def _nearest(self, here: Floats) -> tuple[int, float]:
        """Return the leg that is nearest to a point, and how far along it that is [mm].

        On the last leg it may lie beyond the end.
        """
        along = ((here - self._corners[:-1]) * self._units).sum(axis=1)
        on = np.clip(along, 0.0, self._lengths)
        gaps = np.linalg.norm(self._corners[:-1] + on[:, None] * self._units - here, axis=1)
        k = int(gaps.argmin())
        last = k == len(gaps) - 1
        return k, float(max(along[k], 0.0) if last else on[k])

    def _at(self, way: float) -> Floats:
        """Return the point of the line at some way from its start, shape (3,)."""
        return np.array([np.interp(way, self._way, axis) for axis in self._corners.T])


def row_at(state: State, point: Floats) -> tuple[int, Point] | None:
    """Return the quad of an uncut film at a point, and where in it; None outside the film.

    point : (3,) [mm].
    """
    corners = state.node.X[state.quads]
    near = np.argsort(np.linalg.norm(corners.mean(axis=1) - point, axis=1))[:_NEAREST]
    for row in near.tolist():
        place, height = _place_in(corners[row], point)
        size = float(np.linalg.norm(corners[row][2] - corners[row][0]))
        if max(abs(place[0]), abs(place[1])) < _INSIDE and height < _OFF * size:
            return row, place
    return None


def _place_in(corners: Floats, point: Floats) -> tuple[Point, float]:
    """Return the parameters of the point of a quad next to another, and their distance [mm]."""
    xi, eta = 0.0, 0.0
    for _ in range(20):  # Newton's method; a convex quad takes four or five
        miss = point - np.array(shape_functions((xi, eta))) @ corners
        slopes = shape_slopes((xi, eta))
        (d_xi, d_eta), *_ = np.linalg.lstsq((slopes @ corners).T, miss, rcond=None)
        xi, eta = xi + float(d_xi), eta + float(d_eta)
        if abs(d_xi) + abs(d_eta) < 1e-12 or max(abs(xi), abs(eta)) > _FAR:
            break
    miss = point - np.array(shape_functions((xi, eta))) @ corners
    return (xi, eta), float(np.linalg.norm(miss))
