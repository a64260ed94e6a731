"""Find where and when the cutting edges of a tool pass through a film in its reference state.

A point of a cutting edge is at a height f above the film. The edge passes through the film where f
changes sign: along the edge at a given time, and at a given point in time, which finds an edge that
comes down flat. Over a flat film f is the height over its plane, over a curved one that over the
plane of the nearest quad. A place counts only if it lies in a quad; so holes do not count.

Only the reference film is used. A film that deforms is met later and elsewhere, depending on how
much it deforms.

A crack leads the edge, in a stiff film by many of the tool's thicknesses. So at every end of the
path - where the motion ends or turns back, where the edge enters the film or leaves it - the
path is continued through the whole film: straight, and along the circle through its last places.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from typing import Any, TypeAlias

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints, each, norm, product, unit
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.quad_geometry import corner_normals, plane_normal
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool

_FEWEST_TIMES, _MOST_TIMES = 200, 2000
_FINEST = 0.1  # edge lengths: of cutting-edge vertices closer together only some are sampled
_MOST_HEIGHTS = 2_000_000  # points of edges times number of times: fractions of a second
_NEAREST_QUADS = 16  # quads, by centre, in which a place is searched
_FINE = 0.05  # edge lengths between points of the path
_AT_REST = 1e-6  # of that: an edge that moves by less stands still
_STRAIGHT = 1e-6  # sine of the turn below which a path is straight
_BORDER = 1e-3  # edge lengths by which a place may miss its quad: chords of the rim
_PASSED = 0.25  # edge lengths: an end of the path is none if the path goes on so near to it
_SAME_WAY = 0.2  # edge lengths by which ways that lead over one place may part there
_BEND = 2.0  # edge lengths between the places that the circle goes through
_BETWEEN_SHEETS = 0.1  # edge lengths: spacing of the points on an edge that may meet several sheets
_OFF_QUAD = 0.25  # edge lengths; a change of sign farther off is between two sheets


@dataclass(frozen=True)
class Fate:
    """Contact of one cutting edge, a chain of segments, with the film over the motion."""

    chain: int
    first: float | None
    last: float | None
    """Times at which it first and last passes through the film [s]; None if it never does."""
    stays: bool
    """Whether it is in the film when the motion ends."""
    passed_out: bool
    """Whether its end passed through the film to the other side while the tool moves on along the
    film by more than an edge length: there is no edge for that part."""

    @property
    def meets(self) -> bool:
        """Whether it ever passes through the film."""
        return self.first is not None


@dataclass(frozen=True, eq=False)
class Sweep:
    """Places where cutting edges pass through the film, in the order of chains and times.

    Examples
    --------
    >>> from shellcut import opening_test
    >>> case = opening_test("quick")
    >>> sim = case.simulation
    >>> sweep = Sweep.of(sim.mesh, sim.tool, sim.motion, case.duration)
    >>> [fate.stays for fate in sweep.fates]
    [True, True, True, True]
    """

    mesh: Mesh
    duration: float
    """End of the motion [s]."""
    tick: float
    """Time between two that are sampled [s]."""
    chain: Ints
    """Chain of each place, shape (n,)."""
    time: Floats
    """[s], shape (n,)."""
    place: Floats
    """[mm], shape (n, 3)."""
    quad: Ints
    """Quad of each place, shape (n,)."""
    velocity: Floats
    """Velocity of the edge's own point [mm/s], shape (n, 3)."""
    back: Floats
    """Unit vector of the mid-plane from the edge into the solid, shape (n, 3)."""
    normal: Floats
    """Unit normal of the mid-plane, shape (n, 3)."""
    along_edge: Bools
    """Whether it was found along the edge at one of the sampled times, shape (n,)."""
    fates: tuple[Fate, ...]
    """One per chain of the tool."""
    top_speed: float
    """Largest speed of any point of the cutting edges during the motion [mm/s]."""
    flat: bool
    """Whether the film lies in a plane."""

    @classmethod
    def of(cls, mesh: Mesh, tool: Tool, motion: Motion, duration: float) -> Sweep:
        """Find the places up to ``duration`` [s]."""
        return _Search(mesh, tool, motion, duration).sweep()

    @cached_property
    def edge_length(self) -> Floats:
        """Local edge length (root of the quad's area) at each place, shape (n,), [mm]."""
        return np.asarray(np.sqrt(self.mesh.quad_areas())[self.quad])

    def distance(self, points: Floats) -> Floats:
        """Return the distance of points of the reference film from the path, shape (n,), [mm].

        The path is straight between two sampled times, and continues beyond its ends. Infinite if
        no edge passes through the film.
        """
        tree, *_ = self._path
        return np.asarray(tree.query(points)[0])

    def lead(self, points: Floats, crack: Ints | None = None) -> Floats:
        """Return how far points lie ahead of an end of the path, 0 beside it, shape (n,), [mm].

        Where the paths ahead of several ends pass a point, it is the end of an edge that has been
        in its crack, of these the nearest along its path: the gap between two teeth on one circle
        is ahead of the one and behind the other.

        crack : (n,), of each point, by number; by default nothing is known of them.
        """
        tree, ahead, end, chain, owner = self._path
        gap, nearest = tree.query(points)
        lead = np.asarray(ahead[nearest])
        off, way = np.full((2, len(owner), len(points)), np.inf)
        for k in range(len(owner)):
            mine = np.flatnonzero(end == k)
            if len(mine):
                off[k], at = scipy.spatial.cKDTree(tree.data[mine]).query(points)
                way[k] = ahead[mine[at]]
        cracks = np.zeros(len(points), np.int64) if crack is None else crack
        for one in np.unique(cracks) if len(owner) else ():
            within = np.flatnonzero(cracks == one)
            on_path = nearest[within][end[nearest[within]] < 0]
            theirs = np.isin(owner, chain[on_path])
            among = within[end[nearest[within]] >= 0]
            passed = off[:, among] <= gap[among] + _SAME_WAY * float(np.median(self.edge_length))
            own = passed & theirs[:, None]
            passed = np.where(own.any(axis=0), own, passed)
            lead[among] = np.where(passed, way[:, among], np.inf).min(axis=0)
        return lead

    def path_points(self, ahead: float) -> Floats:
        """Return points on the path and on its continuation beyond each end, shape (n, 3), [mm].

        It continues by ``ahead`` [mm], on the circle through the last places, or straight.
        """
        found = [self.place]
        for k in range(len(self.fates)):
            for line, fine in self._lines(k):
                found.append(_filled(line, fine))
                for end in _ends(line):
                    *_, (_, beyond) = _continued(end, fine / _FINE, np.arange(fine, ahead, fine))
                    found.append(beyond)
        return np.concatenate(found)

    @cached_property
    def _path(self) -> tuple[scipy.spatial.cKDTree, Floats, Ints, Ints, Ints]:
        """Closely spaced points of the path and of the ways ahead of its ends.

        A tree of the points; how far ahead of its end each lies [mm] and whose way ahead it lies
        on, 0 and -1 on the path itself; the chain of those on the path itself; that of each end.
        """
        lines = [(k, *line) for k in range(len(self.fates)) for line in self._lines(k)]
        filled = [(k, _filled(line, fine)) for k, line, fine in lines]
        chains = [self.chain, *(np.full(len(way), k) for k, way in filled)]
        swept = scipy.spatial.cKDTree(np.concatenate([self.place, *(way for _, way in filled)]))
        parts, owner = [(swept.data, np.zeros(swept.n), np.full(swept.n, -1))], list[int]()
        reach = float(norm(np.ptp(self.mesh.nodes, axis=0)))
        for k, line, fine in lines:
            edge = fine / _FINE
            for end in _ends(line):
                for s, way in _continued(end, edge, np.arange(fine, reach, fine)):
                    at, gap = int(np.searchsorted(s, edge)), swept.query(way)[0]
                    if at < len(s) and gap[at] > _PASSED * edge:
                        # As far as another edge has come, or this one on its way round.
                        met = np.flatnonzero(gap[at:] <= fine)
                        stop = at + int(met[0]) if len(met) else len(s)
                        parts.append((way[:stop], s[:stop], np.full(stop, len(owner))))
                owner.append(k)
        found, ahead, ends = (np.concatenate(part) for part in zip(*parts, strict=True))
        tree = scipy.spatial.cKDTree(found)
        return tree, ahead, ends, np.concatenate(chains), np.array(owner, np.int64)

    def _lines(self, k: int) -> Iterator[tuple[Floats, float]]:
        """Yield the lines that one edge draws, shape (n, 3), and the spacing of points on them."""
        mine = np.flatnonzero((self.chain == k) & self.along_edge)
        if not len(mine):
            return
        fine = _FINE * float(self.edge_length[mine].min())
        moments = np.split(mine, np.flatnonzero(np.diff(self.time[mine]) > 0.0) + 1)
        # Same number of places at the next time: an edge that passes through the film at two
        # places does so again, in the same order along the edge.
        breaks = [
            n + 1
            for n, (one, two) in enumerate(pairwise(moments))
            if len(one) != len(two) or self.time[two[0]] - self.time[one[0]] > 1.5 * self.tick
        ]
        for first, last in pairwise([0, *breaks, len(moments)]):
            for line in self.place[np.array(moments[first:last])].transpose(1, 0, 2):
                moved = np.linalg.norm(np.diff(line, axis=0), axis=1) > _AT_REST * fine
                yield line[np.append(True, moved)], fine


def _filled(line: Floats, fine: float) -> Floats:
    """Return points on a line, no farther apart than ``fine``."""
    way = np.append(0.0, np.linalg.norm(np.diff(line, axis=0), axis=1).cumsum())
    return np.column_stack([np.interp(np.arange(0.0, way[-1], fine), way, x) for x in line.T])


def _ends(line: Floats) -> Iterator[Floats]:
    """Yield a line up to each of its ends: the last point, where it turns back, the first."""
    if len(line) < 2:
        return
    step = np.diff(line, axis=0)
    back = np.flatnonzero((step[1:] * step[:-1]).sum(axis=1) < 0.0) + 1
    starts = np.append(0, back)
    for first, last in zip(starts, np.append(back, len(line) - 1), strict=True):
        yield line[first : last + 1]
    yield line[: starts[1] + 1 if len(back) else len(line)][::-1]


def _continued(line: Floats, edge: float, s: Floats) -> Iterator[tuple[Floats, Floats]]:
    """Yield lengths of way beyond the last point of a line and points there: straight, and round.

    The circle goes through the last point and two before it, ``_BEND`` edges apart where the line
    is long enough.
    """
    c = line[-1]
    straight = (c - line[-2]) / norm(c - line[-2])
    yield s, c + s[:, None] * straight
    way = np.append(0.0, np.linalg.norm(np.diff(line[::-1], axis=0), axis=1).cumsum())
    apart = min(_BEND * edge, 0.5 * float(way[-1]))
    a, b = (np.array([np.interp(k * apart, way, x[::-1]) for x in line.T]) for k in (2, 1))
    ab, ac = b - a, c - a
    normal = np.cross(ab, ac)
    size = float(product(normal, normal))
    if size <= (_STRAIGHT * float(product(ac, ac))) ** 2:
        return
    arm = (
        c
        - a
        - (
            float(product(ac, ac)) * np.cross(normal, ab)
            + float(product(ab, ab)) * np.cross(ac, normal)
        )
        / (2.0 * size)
    )
    radius = float(norm(arm))
    s = s[s < 2.0 * np.pi * radius]
    across = np.cross(normal, arm) / np.sqrt(size)
    turn = (s / radius)[:, None]
    yield s, c - arm + each(math.cos, turn) * arm + each(math.sin, turn) * across


_Places: TypeAlias = dict[str, Any]
"""Of one chain, by the names of the fields of :class:`Sweep`."""


class _Search:
    # search for the places, chain by chain

    def __init__(self, mesh: Mesh, tool: Tool, motion: Motion, duration: float) -> None:
        self._mesh, self._tool, self._motion = mesh, tool, motion
        self._duration = duration
        self._centres = mesh.nodes[mesh.quads].mean(axis=1)
        self._normals = corner_normals(mesh.nodes[mesh.quads])
        self._size = np.sqrt(mesh.quad_areas())
        self._tree = scipy.spatial.cKDTree(self._centres)
        self._edge_length = float(np.median(self._size))
        normal = plane_normal(mesh.nodes, mesh.quads)
        self._plane = None
        if normal is not None:
            self._plane = normal, float(product(mesh.nodes, normal).mean())
        self._body_of_chain = tool.edge_body[np.unique(tool.edge_chain, return_index=True)[1]]
        # Two sheets may be nearer to each other than the quads are long.
        spacing = self._edge_length * (_BETWEEN_SHEETS if self._plane is None else 1.0)
        self._chains = [_refined(tool, k, spacing) for k in range(tool.n_chain)]
        self._times = self._moments()
        poses = [pose_at(motion, t) for t in self._times.tolist()]
        self._rotation = np.array([pose.rotation for pose in poses])
        self._translation = np.array([pose.translation for pose in poses])
        twists = np.array([motion.twist(t) for t in self._times.tolist()])
        self._spin, self._velocity = twists[:, 0], twists[:, 1]

    def sweep(self) -> Sweep:
        found = [self._chain(k, *chain) for k, chain in enumerate(self._chains)]
        parts = [part for part, _, _ in found]
        fates = [self._taken_over(fate, parts) for _, fate, _ in found]
        places = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
        return Sweep(
            self._mesh,
            self._duration,
            float(self._times[1]),
            fates=tuple(fates),
            top_speed=max(speed for _, _, speed in found),
            flat=self._plane is not None,
            **places,
        )

    def _moments(self) -> Floats:
        """Return the times to sample: the tool moves by half an edge length between two."""
        points = np.concatenate([points for points, _ in self._chains])
        corners = points[np.unique([points.argmin(axis=0), points.argmax(axis=0)])]
        rough = np.linspace(0.0, self._duration, _FEWEST_TIMES + 1).tolist()
        x = np.array([pose_at(self._motion, t).to_space(corners) for t in rough])
        way = float(np.linalg.norm(np.diff(x, axis=0), axis=2).sum(axis=0).max())
        most = int(np.clip(_MOST_HEIGHTS // len(points), 20, _MOST_TIMES))
        least = min(_FEWEST_TIMES, most)
        n = int(np.clip(np.ceil(way / (0.5 * self._edge_length)), least, most))
        return np.asarray(self._duration / n * np.arange(n + 1.0))

    def _heights(self, x: Floats) -> Floats:
        if self._plane is not None:
            normal, level = self._plane
            return np.asarray(product(x, normal) - level)
        _, nearest = self._tree.query(x)
        return np.asarray(((x - self._centres[nearest]) * self._normals[nearest]).sum(axis=-1))

    def _chain(self, k: int, points: Floats, segment: Ints) -> tuple[_Places, Fate, float]:
        """Return the places of one chain, its fate and its top speed."""
        x = product(points, self._rotation.transpose(0, 2, 1)) + self._translation[:, None]
        height = self._heights(x)
        above = height >= 0.0
        i, j = np.nonzero(above[:, :-1] != above[:, 1:])  # along the edge
        share = height[i, j] / (height[i, j] - height[i, j + 1])
        place = [(1.0 - share)[:, None] * x[i, j] + share[:, None] * x[i, j + 1]]
        moment, where = [i.astype(float)], [j]
        along = np.ones(len(i), np.bool_)
        i, j = np.nonzero(above[:-1] != above[1:])  # in time
        share = height[i, j] / (height[i, j] - height[i + 1, j])
        place.append((1.0 - share)[:, None] * x[i, j] + share[:, None] * x[i + 1, j])
        moment.append(i + share)
        where.append(np.minimum(j, len(segment) - 1))
        ends = np.append(~along, (j == 0) | (j == len(segment)))
        along = np.append(along, np.zeros(len(j), np.bool_))
        p, at, on = np.concatenate(place), np.concatenate(moment), np.concatenate(where)
        quad = self._quad_under(p)
        order = np.flatnonzero(quad >= 0)
        order = order[np.argsort(at[order], kind="stable")]
        p, at, on, quad, ends = p[order], at[order], on[order], quad[order], ends[order]
        tick = np.minimum(at.astype(np.int64), len(self._times) - 1)
        R, arm = self._rotation[tick], p - self._translation[tick]
        part = {
            "chain": np.full(len(p), k),
            "time": at * self._times[1],
            "place": p,
            "quad": quad,
            "velocity": self._velocity[tick] + np.cross(self._spin[tick], arm),
            "back": np.einsum("nij,nj->ni", R, self._tool.edge_back[segment[on]]),
            "normal": np.einsum("nij,nj->ni", R, self._tool.edge_normal[segment[on]]),
            "along_edge": along[order],
        }
        # include mean speeds between samples: a table may jump between two
        mean = np.linalg.norm(np.diff(x, axis=0), axis=2).max() / self._times[1]
        arms = x - self._translation[:, None]
        velocity = self._velocity[:, None] + np.cross(self._spin[:, None], arms)
        top = max(float(mean), float(np.linalg.norm(velocity, axis=2).max()))
        return part, self._fate(k, at, ends, above, p, x), top

    def _fate(
        self, k: int, at: Floats, ends: Bools, above: Bools, place: Floats, x: Floats
    ) -> Fate:
        if not len(at):
            return Fate(k, None, None, stays=False, passed_out=False)
        first, last = float(at[0]), float(at[-1])
        tick = float(self._times[1])
        if last > len(self._times) - 2.0:
            return Fate(k, first * tick, last * tick, stays=True, passed_out=False)
        after = int(np.floor(last)) + 1
        side, before = above[after], above[int(np.floor(first))]
        through = bool(ends[-1]) and (side == side[0]).all()
        withdrawn = (before == side).all()
        # distance that the tool moves along the film after the edge has left it
        normal = self._normals[int(self._tree.query(place[-1])[1])]
        way = np.diff(x[after:, 0], axis=0)
        way -= product(way, normal)[:, None] * normal
        went_on = float(np.linalg.norm(way, axis=1).sum()) > self._edge_length
        out = through and not withdrawn and went_on
        return Fate(k, first * tick, last * tick, stays=False, passed_out=out)

    def _taken_over(self, fate: Fate, parts: list[_Places]) -> Fate:
        """Return the fate of an edge that passed out, unless another of its tooth continues."""
        if not fate.passed_out or fate.last is None:
            return fate
        body = self._body_of_chain
        for k in np.flatnonzero(body == body[fate.chain]).tolist():
            time = parts[k]["time"]
            late = (time > fate.last) & (time <= fate.last + 3.0 * self._times[1])
            if k != fate.chain and late.any():
                return replace(fate, passed_out=False)
        return fate

    def _quad_under(self, p: Floats) -> Ints:
        """Return the quad of each place, -1 outside, shape (n,)."""
        mesh = self._mesh
        n = min(_NEAREST_QUADS, mesh.n_quad)
        near = np.asarray(self._tree.query(p, k=n)[1]).reshape(len(p), n)
        # A place so far away that its distances are infinite is under none, so any will do.
        near = np.minimum(near, mesh.n_quad - 1)
        corner = mesh.nodes[mesh.quads[near]]  # (n, near, 4, 3)
        normal = self._normals[near][:, :, None]
        side = np.roll(corner, -1, axis=2) - corner
        inward = unit(np.cross(normal, side))
        off = ((p[:, None, None] - corner) * inward).sum(axis=-1).min(axis=-1)
        height = ((p[:, None] - self._centres[near]) * normal[:, :, 0]).sum(axis=-1)
        size = self._size[near]
        inside = (off >= -_BORDER * size) & (np.abs(height) <= _OFF_QUAD * size)
        best = inside.argmax(axis=1)
        rows = np.arange(len(p))
        return np.where(inside[rows, best], near[rows, best], -1)


def _refined(tool: Tool, k: int, spacing: float) -> tuple[Floats, Ints]:
    """Return points along a chain, and the segment after each.

    Neighbours are at most ``spacing`` apart; of vertices much closer than that only some are used.
    """
    segments = np.flatnonzero(tool.edge_chain == k)
    ends = tool.vertices[tool.edges[segments]]
    way = np.linalg.norm(ends[:, 1] - ends[:, 0], axis=1).cumsum()
    mark = np.floor(way / (_FINEST * spacing))
    last = np.flatnonzero(np.append(mark[1:] > mark[:-1], True))
    points, owner = [], []
    for first, e in zip([0, *(last[:-1] + 1).tolist()], last.tolist(), strict=True):
        a, b = ends[first, 0], ends[e, 1]
        n = int(np.clip(np.ceil(norm(b - a) / spacing), 1, 1000))
        points.append(a + np.arange(n)[:, None] / n * (b - a))
        owner += [int(segments[first])] * n
    points.append(ends[-1, 1][None])
    return np.concatenate(points), np.array(owner, dtype=np.int64)
