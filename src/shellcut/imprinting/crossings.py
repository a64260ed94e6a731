"""Crossings of a tool's cutting edges with the plane of a film, over the motion.

A point s of a chain of cutting segments is at time t at the height f(s, t) above the film. The line
f = 0 in the (s, t) plane is found cell by cell on the grid of the chain's vertices and of equal
time intervals, and each of its points is computed to round-off: by bisection in t at a vertex, by
linear interpolation in s between two.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool

from .film_plane import FilmPlane


@dataclass(frozen=True, eq=False)
class Stretch:
    """A stretch of the film's plane passed by a chain of cutting segments, in order of time."""

    chain: int
    points: Floats
    """In the plane, shape (n, 2)."""
    is_vertex: Bools
    """Whether a vertex of the chain is there, shape (n,)."""
    time: Ints
    """Time at which, or just after which, the edge is there, shape (n,)."""


class Crossings:
    """The positions of a tool at equal time intervals, relative to the plane of a film.

    Parameters
    ----------
    film : FilmPlane
    tool : Tool
    motion : Motion
    times : ndarray, shape (n_time,)
        [s]
    """

    def __init__(self, film: FilmPlane, tool: Tool, motion: Motion, times: Floats) -> None:
        self._film, self._tool, self._motion, self._times = film, tool, motion, times
        self._poses: list[tuple[Floats, Floats]] = [pose_at(motion, t) for t in times.tolist()]

    def of_chain(self, chain: int) -> tuple[list[Stretch], Floats]:
        """Return the stretches that a chain passes, and all positions of its vertices.

        The latter are seen from above, at all times, shape (n, 2) [mm].
        """
        segments = self._tool.edges[self._tool.edge_chain == chain]
        vertices = self._tool.vertices[np.append(segments[:, 0], segments[-1, 1])]
        line = _ZeroLine(self._film, vertices, self._motion, self._times, self._poses)
        return line.stretches(chain), line.swept()

    def body_behind(self, stretch: Stretch) -> float:
        """Return how far the tooth of a stretch extends in the plane behind its start [mm].

        A tooth that comes down more steeply than its relief angle presses its bottom into the film
        behind the point where its edge has entered.
        """
        tool = self._tool
        tooth = int(tool.edge_body[tool.edge_chain == stretch.chain][0])
        triangles = tool.triangles[tool.triangle_body == tooth]
        sides = np.unique(np.sort(triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)), axis=0)
        ids, sides = np.unique(sides, return_inverse=True)
        vertices, sides = tool.vertices[ids], sides.reshape(-1, 2)
        size = float(np.linalg.norm(np.ptp(vertices, axis=0)))
        steps = np.diff(stretch.points, axis=0)
        length = np.linalg.norm(steps, axis=1)
        way = np.concatenate([[0.0], np.cumsum(length)])
        # where the edge rests, use the direction of the next step that moves
        moves = np.flatnonzero(length)
        after = np.searchsorted(moves, np.arange(len(way)))
        moves = moves[np.minimum(after, len(moves) - 1)]
        ahead = steps[moves] / length[moves, None]
        behind = 0.0
        for k in np.flatnonzero(way < size).tolist():
            R, r = self._poses[stretch.time[k]]
            places = vertices @ R.T + r
            height = self._film.off_plane(places)
            low, high = sides[(height[sides[:, 0]] < 0.0) != (height[sides[:, 1]] < 0.0)].T
            if len(low):
                share = height[low] / (height[low] - height[high])
                cut = places[low] + share[:, None] * (places[high] - places[low])
                back = (stretch.points[k] - self._film.flatten(cut)) @ ahead[k]
                behind = max(behind, float(back.max()) - float(way[k]))
        return behind


class _ZeroLine:
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
        return self._film.flatten(self._places.reshape(-1, 3))

    def stretches(self, chain: int) -> list[Stretch]:
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
            kind, time, _ = np.array(way).T
            stretches.append(Stretch(chain, points, kind == 1, time + kind))
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
        R, r = pose_at(self._motion, time)
        return np.asarray(R @ self._vertices[j] + r)
