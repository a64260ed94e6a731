"""A smooth curve in the plane or in space, with a parameter close to its arc length.

Every curve is one cubic spline through points; its parameter u is the sum of chord lengths [mm].
The chords of a sampled analytic curve are short enough for the spline to represent it: a circle of
720 points is accurate to (2 pi / 720)⁴ / 384 = 1.5e-11 of its radius. An open curve continues
straight beyond its ends, so that all nearby points have a nearest point on it.
"""

from __future__ import annotations

import copy
from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
import scipy

from shellcut.arrays import Floats

_CIRCLE_POINTS = 720
_FUNCTION_POINTS = 1000
_SAMPLES_A_CHORD = 4
_NEWTON_STEPS = 12  # for the nearest point; the start is within an eighth of a chord


class PathCurve:
    """An open or closed curve; build it with one of the class methods.

    Attributes
    ----------
    length : float
        Largest parameter u [mm].
    closed : bool
        Whether u = ``length`` is the start again.
    leads : (float, float)
        Lengths of the optional leads at start and end [mm]: an imprint shortens them where the
        mesh has no room.

    Examples
    --------
    >>> circle = PathCurve.circle((0, 0, 0), 9.4)
    >>> round(circle.length, 3), circle.closed
    (59.062, True)
    >>> line = PathCurve.line((0, 0), (10, 0))
    >>> u = line.nearest([[4.0, 3.0], [-1.0, 0.0]])
    >>> u.tolist(), line.point(u).tolist()
    ([4.0, -1.0], [[4.0, 0.0], [-1.0, 0.0]])
    """

    def __init__(self, points: Floats, *, closed: bool) -> None:
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        self._knots = np.concatenate([[0.0], np.cumsum(steps)])
        self._knots.flags.writeable = False
        self.length = float(self._knots[-1])
        self.closed = closed
        self.leads = (0.0, 0.0)
        if len(points) == 2:
            slope = np.diff(points, axis=0) / self.length
            self._spline = scipy.interpolate.CubicSpline(
                self._knots, points, bc_type=((1, slope[0]), (1, slope[0]))
            )
        else:
            ends = "periodic" if closed else "not-a-knot"
            self._spline = scipy.interpolate.CubicSpline(self._knots, points, bc_type=ends)
        n = _SAMPLES_A_CHORD * (len(points) - 1)
        at = np.arange(len(points) - 1) + np.arange(_SAMPLES_A_CHORD)[:, None] / _SAMPLES_A_CHORD
        self._sample_u = np.interp(
            np.append(np.sort(at.ravel()), len(points) - 1.0), np.arange(len(points)), self._knots
        )
        self._samples: Floats = self._spline(self._sample_u)
        self._tree = scipy.spatial.cKDTree(self._samples[:n] if closed else self._samples)

    def __repr__(self) -> str:
        kind = "closed" if self.closed else "open"
        return f"PathCurve({kind}, {self.length:.6g} mm, {len(self._knots)} points)"

    @classmethod
    def through(cls, points: npt.ArrayLike, *, closed: bool = False) -> PathCurve:
        """Return the spline through points.

        Parameters
        ----------
        points : array_like, shape (n_point, 2) or (n_point, 3), [mm]
            In order; at least two, three for a closed curve, which may or may not repeat its
            first point at the end.
        closed : bool

        Raises
        ------
        ValueError
            If points have the wrong shape, are not finite, too few, or two neighbours coincide.
        """
        p = np.array(points, dtype=np.float64)
        if p.ndim != 2 or p.shape[1] not in (2, 3):
            raise ValueError(f"points must have shape (n_point, 2) or (n_point, 3), got {p.shape}")
        if not np.isfinite(p).all():
            bad = int(np.argwhere(~np.isfinite(p))[0][0])
            raise ValueError(f"points must be finite, point {bad} is not; remove it")
        if closed and len(p) > 1 and not np.array_equal(p[0], p[-1]):
            p = np.concatenate([p, p[:1]])
        least = 4 if closed else 2
        if len(p) < least:
            raise ValueError(
                f"a {'closed' if closed else 'open'} curve needs {3 if closed else 2} different "
                f"points at least, got {len(p) - closed}"
            )
        steps = np.linalg.norm(np.diff(p, axis=0), axis=1)
        same = np.flatnonzero(steps <= 1e-12 * np.ptp(p, axis=0).max())
        if len(same):
            raise ValueError(
                f"neighbouring points must differ, point {same[0] + 1} repeats {same[0]}; remove it"
            )
        return cls(p, closed=closed)

    @classmethod
    def circle(
        cls,
        centre: Sequence[float],
        radius: float,
        *,
        normal: Sequence[float] = (0.0, 0.0, 1.0),
        start_deg: float = 0.0,
        end_deg: float = 360.0,
    ) -> PathCurve:
        """Return a circle, or its arc from ``start_deg`` to ``end_deg``, about ``normal``.

        Angles count from the x axis projected on the plane of the circle, or from the y axis if
        the normal is along x. ``centre`` has three coordinates.

        Raises
        ------
        ValueError
            If the radius is not positive or the arc does not run forward.
        """
        if not (np.isfinite(radius) and radius > 0.0):
            raise ValueError(f"radius must be positive in mm, got {radius}")
        if not 0.0 < end_deg - start_deg <= 360.0:
            raise ValueError(
                f"end_deg must exceed start_deg by 360 at most, got {start_deg} to {end_deg}"
            )
        n = np.asarray(normal, dtype=np.float64)
        n = n / np.linalg.norm(n)
        reference = np.eye(3)[1 if abs(n[0]) > 0.9 else 0]
        a = reference - (reference @ n) * n
        a /= np.linalg.norm(a)
        b = np.cross(n, a)
        closed = end_deg - start_deg == 360.0
        count = max(8, int(np.ceil(_CIRCLE_POINTS * (end_deg - start_deg) / 360.0)))
        angle = np.radians(np.linspace(start_deg, end_deg, count + 1))[:, None]
        points = np.asarray(centre) + radius * (np.cos(angle) * a + np.sin(angle) * b)
        if closed:
            points[-1] = points[0]
        return cls(points, closed=closed)

    @classmethod
    def line(cls, start: Sequence[float], end: Sequence[float]) -> PathCurve:
        """Return the straight line from ``start`` to ``end``, exact."""
        return cls.through([start, end])

    @classmethod
    def of_function(
        cls,
        function: Callable[[float], Sequence[float]],
        start: float,
        end: float,
        *,
        closed: bool = False,
        n_point: int = _FUNCTION_POINTS,
    ) -> PathCurve:
        """Return the curve of an analytic function of one parameter.

        Parameters
        ----------
        function : callable
            Maps the parameter to a point [mm].
        start, end : float
            Range of the parameter.
        closed : bool
            Whether the function returns to its start at ``end``.
        n_point : int
            Number of evaluations; the error decreases as 1 / n_point⁴.
        """
        at = np.linspace(start, end, n_point + 1)
        points = np.array([function(t) for t in at.tolist()], dtype=np.float64)
        return cls.through(points[:-1] if closed else points, closed=closed)

    @property
    def knots(self) -> Floats:
        """Parameters of the points the curve was built through, shape (n_knot,), [mm]."""
        return self._knots

    @property
    def dimension(self) -> int:
        """2 in the plane, 3 in space."""
        return int(self._samples.shape[1])

    def point(self, u: npt.ArrayLike) -> Floats:
        """Return the points at u [mm], shape (n, dimension)."""
        inside, beyond = self._split(u)
        result: Floats = self._spline(inside)
        if beyond is not None:
            result += beyond[:, None] * self._spline(inside, 1)
        return result

    def derivative(self, u: npt.ArrayLike) -> Floats:
        """Return dc/du, shape (n, dimension), of length near 1."""
        inside, _ = self._split(u)
        result: Floats = self._spline(inside, 1)
        return result

    def tangent(self, u: npt.ArrayLike) -> Floats:
        """Return the unit tangents, shape (n, dimension)."""
        d = self.derivative(u)
        result: Floats = d / np.linalg.norm(d, axis=1, keepdims=True)
        return result

    def curvature(self, u: npt.ArrayLike) -> Floats:
        """Return the curvature [1/mm], shape (n,); 0 beyond the ends."""
        inside, beyond = self._split(u)
        d1, d2 = self._spline(inside, 1), self._spline(inside, 2)
        speed2 = (d1 * d1).sum(axis=1)
        across = d2 - ((d1 * d2).sum(axis=1) / speed2)[:, None] * d1
        result: Floats = np.linalg.norm(across, axis=1) / speed2
        if beyond is not None:
            result[beyond != 0.0] = 0.0
        return result

    def nearest(self, points: npt.ArrayLike) -> Floats:
        """Return the parameters u of the nearest points of the curve, shape (n,), [mm].

        Beyond an end of an open curve u is below 0 or above ``length``.
        """
        p = np.asarray(points, dtype=np.float64)
        near = self._tree.query(p)[1]
        u: Floats = self._sample_u[near].copy()
        reach = np.diff(self._sample_u).max()
        low, high = u - reach, u + reach
        if not self.closed:
            low, high = (
                np.where(near == 0, -np.inf, low),
                np.where(near == len(self._sample_u) - 1, np.inf, high),
            )
        for _ in range(_NEWTON_STEPS):
            inside, beyond = self._split(u)
            d1, d2 = self._spline(inside, 1), self._spline(inside, 2)
            off = self._spline(inside) - p
            if beyond is not None:
                off += beyond[:, None] * d1
                d2 = np.where((beyond != 0.0)[:, None], 0.0, d2)
            slope = (d1 * d1).sum(axis=1)
            # beyond the radius of curvature the distance is not convex: damp there
            slope = np.maximum(slope + (off * d2).sum(axis=1), 0.25 * slope)
            step = (off * d1).sum(axis=1) / slope
            u = np.clip(u - step, low, high)
            if np.abs(step).max(initial=0.0) < 1e-14 * self.length:
                break
        return np.mod(u, self.length) if self.closed else u

    def samples(self, spacing: float) -> tuple[Floats, Floats]:
        """Return parameters (n,) and points (n, dimension) at most ``spacing`` apart [mm].

        The start of a closed curve is not repeated.
        """
        n = max(8, int(np.ceil(self.length / spacing)))
        u = np.linspace(0.0, self.length, n + 1)
        u = u[:-1] if self.closed else u
        return u, self.point(u)

    def mapped(self, function: Callable[[Floats], Floats]) -> PathCurve:
        """Return the curve through the images of this curve's points.

        ``function`` takes and returns (n, dimension) arrays; it must preserve lengths (a rigid
        motion, the map between space and a plane), because the parameter is kept.
        """
        points = function(self._spline(self._knots))
        if self.closed:
            points[-1] = points[0]
        return PathCurve(points, closed=self.closed).with_leads(*self.leads)

    def with_leads(self, before: float, after: float) -> PathCurve:
        """Return the curve with leads of these lengths at its start and end [mm]."""
        curve = copy.copy(self)
        curve.leads = (before, after)
        return curve

    def part(self, start: float, end: float) -> PathCurve:
        """Return the open piece from u = ``start`` to ``end`` [mm].

        For a closed curve ``end`` may exceed ``length``.
        """
        knots = self._knots
        if self.closed:
            knots = np.concatenate([knots[:-1], knots[:-1] + self.length, [2.0 * self.length]])
        margin = 1e-6 * (end - start)
        inner = knots[(knots > start + margin) & (knots < end - margin)]
        return PathCurve(self.point(np.concatenate([[start], inner, [end]])), closed=False)

    def _split(self, u: npt.ArrayLike) -> tuple[Floats, Floats | None]:
        # positions on the spline, and distances beyond the end of an open curve
        at = np.atleast_1d(np.asarray(u, dtype=np.float64))
        if self.closed:
            return np.mod(at, self.length), None
        inside = np.clip(at, 0.0, self.length)
        return inside, at - inside
