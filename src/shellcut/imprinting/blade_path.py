"""The path of a tool's cutting edges through a flat film, from the tool and its motion.

A point s of a chain of cutting segments stands at the time t at the height f(s, t) over the film.
The path is the line f = 0 in the (s, t) plane, mapped to the film: found cell by cell on the grid
of the chain's vertices and of equal times, each of its points computed to round-off. So an edge
that goes through the film at one place at a time, one that comes down flat, and one that enters or
leaves are all the same to it.

Where the points lie on a straight line or a circle to 0.005 edge lengths, the path is that line or
circle, and stretches of one circle (one line) that several teeth cut are joined. Otherwise it is
the spline through points half an edge length apart. A blade that goes through the film for a short
way only tells its circle badly, or seems to go straight; but an edge that stays in a cylinder
upright on the film, as teeth on a screw do, cuts the trace of that cylinder, and the whole edge in
its whole motion tells it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import scipy

from shellcut._jit import Bools, Floats
from shellcut.mesh import Mesh
from shellcut.motion import Motion
from shellcut.tool import Tool

from .film_plane import FilmPlane, ImprintError
from .path_curve import PathCurve

N_TIME = 400
"""Equal times at which the edges are looked at."""

AHEAD = 3.0
"""A path is led on beyond the blade's last place by so much [mm], because the crack runs ahead of
the blade: by 1.4 mm in the guillotine."""

FIT = 5e-3
"""Points this near to a line or circle (in edge lengths) lie on it."""

JOINED = 6.0
"""Stretches of one line or circle less than so many edge lengths apart are one path."""

_ENOUGH_VERTICES = 5  # crossings of vertices that fix a circle without those of chords between


def blade_path(
    tool: Tool,
    motion: Motion,
    mesh: Mesh,
    duration: float,
    *,
    ahead: float = AHEAD,
    n_time: int = N_TIME,
) -> list[PathCurve]:
    """Return where the cutting edges pass through the film's mid-surface, curves in space.

    Parameters
    ----------
    tool : Tool
    motion : Motion
    mesh : Mesh
        Flat; the film in its reference state.
    duration : float
        End of the motion that counts [s]; it starts at t = 0.
    ahead : float
        How far the path goes on beyond the blade's last place [mm].
    n_time : int
        Steps of the motion that are looked at.

    Raises
    ------
    ImprintError
        If the film is not flat or no edge passes through its plane.

    Examples
    --------
    >>> from shellcut import StraightMotion
    >>> from shellcut.meshing import rectangle
    >>> from shellcut.tool_shapes import straight_blade
    >>> blade = straight_blade(length=4.0, height=3.0)
    >>> motion = StraightMotion((1.0, 0.0, 0.0), speed=6000.0)
    >>> len(blade_path(blade, motion, rectangle(12.0, 8.0, size=0.8), duration=1e-3))
    1
    """
    film = FilmPlane(mesh)
    h = float(np.median(film.edge_length))
    times = np.linspace(0.0, duration, n_time + 1)
    poses = [motion.pose(t) for t in times.tolist()]
    found: list[_Line | _Arc | PathCurve] = []
    for k in range(tool.n_chain):
        segments = tool.edges[tool.edge_chain == k]
        vertices = tool.vertices[np.append(segments[:, 0], segments[-1, 1])]
        crossings = _Crossings(film, vertices, motion, times, poses)
        swept = crossings.swept()
        for x, is_vertex in crossings.stretches():
            if _extent(x) > h:
                found.append(_simplest(x, is_vertex, swept, h, ahead))
    if not found:
        raise ImprintError(
            f"a cutting edge must pass through the film's plane and move in it by an edge of the "
            f"mesh, here {h:.2g} mm, got none that does from t = 0 to {duration:g} s; check the "
            "tool's position, the motion and its duration"
        )
    lines = _joined_lines([c for c in found if isinstance(c, _Line)], h)
    arcs = _joined_arcs([c for c in found if isinstance(c, _Arc)], h)
    splines = [c for c in found if isinstance(c, PathCurve)]
    return [c.mapped(film.lift) for c in (*lines, *arcs, *splines)]


class _Crossings:
    # the line of zero height of one chain of cutting segments in the plane of vertices and times

    def __init__(
        self,
        film: FilmPlane,
        vertices: Floats,
        motion: Motion,
        times: Floats,
        poses: list[tuple[Floats, Floats]],
    ) -> None:
        self._film, self._vertices, self._motion, self._times = film, vertices, motion, times
        self._places = np.stack([vertices @ R.T + r for R, r in poses])
        self._height: Floats = film.off_plane(self._places)
        self._above = self._height >= 0.0

    def swept(self) -> Floats:
        """Return where the vertices stand over the plane at all times, shape (n, 2)."""
        return self._film.flatten(self._places.reshape(-1, 3))

    def stretches(self) -> list[tuple[Floats, Bools]]:
        """Return points in the plane, (n, 2), of each stretch, and which are those of vertices."""
        links: dict[tuple[int, int, int], list[tuple[int, int, int]]] = {}
        a = self._above
        mixed = (a[:-1, :-1] != a[1:, :-1]) | (a[:-1, :-1] != a[:-1, 1:])
        mixed |= a[1:, 1:] != a[:-1, :-1]
        for i, j in np.argwhere(mixed).tolist():
            for one, two in self._pairs(i, j):
                links.setdefault(one, []).append(two)
                links.setdefault(two, []).append(one)
        stretches = []
        while links:
            first = next((k for k in links if len(links[k]) == 1), next(iter(links)))
            way = [first]
            while links.get(way[-1]):
                after = links[way[-1]].pop()
                links[after].remove(way[-1])
                way.append(after)
            for key in way:
                if not links.get(key, True):
                    del links[key]
            if way[-1][1] < way[0][1]:  # towards later times
                way.reverse()
            points = np.array([self._point(*key) for key in way])
            stretches.append((points, np.array([key[0] == 1 for key in way])))
        return stretches

    def _pairs(self, i: int, j: int) -> list[tuple[tuple[int, int, int], tuple[int, int, int]]]:
        # sides of the cell between times i, i+1 and vertices j, j+1 that the line joins; a side is
        # (0, i, j): time i, between two vertices; (1, i, j): vertex j, between two times
        a = self._above
        sides = [
            ((0, i, j), a[i, j] != a[i, j + 1]),
            ((1, i, j + 1), a[i, j + 1] != a[i + 1, j + 1]),
            ((0, i + 1, j), a[i + 1, j + 1] != a[i + 1, j]),
            ((1, i, j), a[i + 1, j] != a[i, j]),
        ]
        cut = [side for side, crossed in sides if crossed]
        if len(cut) == 2:
            return [(cut[0], cut[1])]
        # a saddle: the corner (i, j) is cut off unless the middle is on its side
        together = (self._height[i : i + 2, j : j + 2].mean() >= 0.0) == a[i, j]
        if together:
            return [(cut[0], cut[1]), (cut[2], cut[3])]
        return [(cut[0], cut[3]), (cut[1], cut[2])]

    def _point(self, kind: int, i: int, j: int) -> Floats:
        if kind == 0:
            low, high = self._height[i, j], self._height[i, j + 1]
            share = low / (low - high)
            place = (1.0 - share) * self._places[i, j] + share * self._places[i, j + 1]
        else:
            place = self._at(self._crossing_time(i, j), j)
        return self._film.flatten(place)

    def _crossing_time(self, i: int, j: int) -> float:
        low, high = self._height[i, j], self._height[i + 1, j]
        if low == 0.0 or high == 0.0:
            return float(self._times[i if low == 0.0 else i + 1])
        start, end = self._times[i : i + 2].tolist()
        found: float = scipy.optimize.brentq(
            lambda t: float(self._film.off_plane(self._at(t, j))),
            start,
            end,
            xtol=1e-15 * max(end, 1e-300),
        )
        return found

    def _at(self, time: float, j: int) -> Floats:
        R, r = self._motion.pose(time)
        return np.asarray(R @ self._vertices[j] + r)


# --- what the points lie on ----------------------------------------------------------------------


@dataclass(frozen=True, eq=False)
class _Line:
    origin: Floats  # foot of the plane's origin
    way: Floats
    start: float
    end: float

    def off(self, x: Floats) -> float:
        across = np.array([-self.way[1], self.way[0]])
        return float(np.abs((x - self.origin) @ across).max())


@dataclass(frozen=True, eq=False)
class _Arc:
    centre: Floats
    radius: float
    start: float  # [rad]; end - start in (0, 2 pi]
    end: float
    backward: bool  # whether the blade came from ``end``

    def off(self, x: Floats) -> float:
        return float(np.abs(np.linalg.norm(x - self.centre, axis=1) - self.radius).max())

    def led_on(self, ahead: float) -> _Arc:
        angle = min(ahead / self.radius, 2.0 * np.pi - (self.end - self.start))
        if self.backward:
            return replace(self, start=self.start - angle)
        return replace(self, end=self.end + angle)


def _extent(x: Floats) -> float:
    return float(np.linalg.norm(np.ptp(x, axis=0)))


def _simplest(
    x: Floats, is_vertex: Bools, swept: Floats, h: float, ahead: float
) -> _Line | _Arc | PathCurve:
    enough = is_vertex.sum() >= _ENOUGH_VERTICES
    if not enough and _on_cylinder(swept, h):
        arc = _arc(x, swept)
        if arc.off(x) <= FIT * h:
            return arc.led_on(ahead)
    line = _line(x)
    if line.off(x) <= FIT * h:
        return replace(line, end=line.end + ahead)
    # vertices of a polygon lie on the true edge, points between them on its chords
    arc = _arc(x, x[is_vertex] if enough else x)
    if arc.off(x) <= FIT * h:
        return arc.led_on(ahead)
    return _spline(x, h, ahead)


def _on_cylinder(swept: Floats, h: float) -> bool:
    # whether an edge stays in a circle, seen from above, and not in a line
    return _line(swept).off(swept) > FIT * h and _arc(swept, swept).off(swept) <= FIT * h


def _line(x: Floats) -> _Line:
    middle = x.mean(axis=0)
    way = np.linalg.svd(x - middle, full_matrices=False)[2][0]
    # towards later times
    way = way if way @ (x[-1] - x[0]) >= 0.0 else -way
    origin = middle - (middle @ way) * way
    along = x @ way
    return _Line(origin, way, float(along.min()), float(along.max()))


def _arc(x: Floats, on_it: Floats) -> _Arc:
    # least squares of |x|² = 2 c.x + (r² - c²), about the mean for round-off
    middle = on_it.mean(axis=0)
    y = on_it - middle
    A = np.column_stack([2.0 * y, np.ones(len(y))])
    solution = np.linalg.lstsq(A, (y * y).sum(axis=1), rcond=None)[0]
    centre = middle + solution[:2]
    radius = float(np.sqrt(max(solution[2] + solution[:2] @ solution[:2], 0.0)))
    angle = np.unwrap(np.arctan2(*(x - centre).T[::-1]))
    start, end = float(angle.min()), float(angle.max())
    backward = bool(angle[-1] < angle[0])
    return _Arc(centre, radius, start, min(end, start + 2.0 * np.pi), backward)


def _spline(x: Floats, h: float, ahead: float) -> PathCurve:
    kept = [0]
    for k in range(1, len(x)):
        if np.linalg.norm(x[k] - x[kept[-1]]) >= 0.5 * h:
            kept.append(k)
    points = x[kept]
    if len(points) > 8:
        # back at its start, on its own way: closed
        away = np.linalg.norm(points - points[0], axis=1)
        left = int(np.argmax(away > 2.0 * h))
        back = np.flatnonzero(away[left:] < 0.6 * h)
        if len(back):
            end = left + int(back[0])
            way = points[1] - points[0]
            off = (points[end] - points[0]) @ np.array([-way[1], way[0]]) / np.linalg.norm(way)
            if abs(off) < 0.05 * h:
                return PathCurve.through(points[:end], closed=True)
    curve = PathCurve.through(points)
    beyond = curve.point(curve.length + np.arange(0.0, ahead, 0.5 * h)[1:])
    return PathCurve.through(np.concatenate([points, beyond]))


def _joined_lines(lines: list[_Line], h: float) -> list[PathCurve]:
    joined = []
    left = list(lines)
    while left:
        first = left.pop(0)
        across = np.array([-first.way[1], first.way[0]])
        spans = [(first.start, first.end)]
        for line in list(left):
            ends = line.origin + np.outer([line.start, line.end], line.way)
            if np.abs((ends - first.origin) @ across).max() <= 2.0 * FIT * h:
                left.remove(line)
                along = ends @ first.way
                spans.append((float(along.min()), float(along.max())))
        for start, end in _union(spans, JOINED * h):
            a, b = (first.origin + s * first.way for s in (start, end))
            joined.append(PathCurve.line(a.tolist(), b.tolist()))
    return joined


def _joined_arcs(arcs: list[_Arc], h: float) -> list[PathCurve]:
    joined = []
    left = list(arcs)
    full = 2.0 * np.pi
    while left:
        group = [left.pop(0)]
        for arc in list(left):
            near = np.linalg.norm(arc.centre - group[0].centre) <= 2.0 * FIT * h
            if near and abs(arc.radius - group[0].radius) <= 2.0 * FIT * h:
                left.remove(arc)
                group.append(arc)
        # the longest stretch tells the circle best
        best = max(group, key=lambda a: a.end - a.start)
        gap = JOINED * h / best.radius
        spans = [(a.start - full * np.floor(a.start / full), a.end - a.start) for a in group]
        # once more a turn later, so that stretches over angle 0 meet
        turns = [(s + k * full, s + k * full + length) for s, length in spans for k in (0, 1)]
        whole = _union(turns, gap)
        if any(end - start >= full - gap for start, end in whole):
            joined.append(_circle(best, 0.0, full))
            continue
        seen: list[float] = []
        for start, end in whole:
            # of the two copies of a stretch the one that holds all of it
            if all(abs((start - s + np.pi) % full - np.pi) > gap for s in seen) and start < full:
                seen.append(start)
                joined.append(_circle(best, start, end))
    return joined


def _circle(arc: _Arc, start: float, end: float) -> PathCurve:
    space = PathCurve.circle(
        (*arc.centre.tolist(), 0.0),
        arc.radius,
        start_deg=float(np.degrees(start)),
        end_deg=float(np.degrees(end)),
    )
    return space.mapped(lambda points: points[:, :2])


def _union(spans: list[tuple[float, float]], gap: float) -> list[tuple[float, float]]:
    joined: list[tuple[float, float]] = []
    for start, end in sorted(spans):
        if joined and start - joined[-1][1] <= gap:
            joined[-1] = joined[-1][0], max(joined[-1][1], end)
        else:
            joined.append((start, end))
    return joined
