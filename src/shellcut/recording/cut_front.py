r"""Position of the cuts: cut length, process zone, uncut film ahead and edge to spare.

======================  ==========================================================================
cut length              reference length of cut that the edge has passed: that of the cables that
                        were bent around it
process zone            the part of the cut length whose cables the edge still drags
uncut film ahead        distance from the edge to the crack tip that it drives, and on to the first
                        boundary node or node of any crack, along the circle (or line) that the
                        tool's motion traces in the film: exact for screws and straight motions
edge to spare           length of the edge from a joint to its nearer end, the smallest in the
                        process zone: 0 where the edge is just entering or leaving the film
======================  ==========================================================================

All lengths are measured in the reference film: the film ahead has hardly moved, the film at the tip
is bent aside. A cutting edge is a chain of :meth:`.Tool.chains`. Its tip is the one nearest to its
process zone among the tips ahead in the direction of the tool's motion. A tool that moves through
the film without moving along it has no such path; the last edge of the crack then gives the
direction.

These values tell whether a cut is steady (:mod:`shellcut.results.steady_window`).
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, cross, each, norm, product, unit
from shellcut.state import JOINTED, NOT_MET, local_edge_length
from shellcut.tool.edge_curves import EdgeCurves
from shellcut.tool.motion import rotation_rows
from shellcut.tool.pose import Pose, small_turn
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

# Distance of a node beside the path, in local edge lengths: where a boundary crosses the path
# between two of its nodes, one of them lies within half of that.
_BESIDE = 0.75
# Time over which the path ahead is sampled, relative to the run.
_LOOK_AHEAD = 5e-3
# Relative to the speed: below this, the tool does not move along the film.
_ALONG = 1e-3
# Sine of its angle to the film up to which an edge lies on it, and goes through it nowhere.
_FLAT = 0.1
# Relative to curvature times the film's extent: below this, the path is straight.
_STRAIGHT = 1e-9


class CrackEnds(NamedTuple):
    """The ends of all cracks, and all places that a crack cannot pass."""

    place: Floats
    """Of the ends, shape (n_end, 3), [mm]."""
    director: Floats
    """There, shape (n_end, 3)."""
    heading: Callable[[int], Floats]
    """Takes the number of an end; returns the direction of its last edge, shape (3,)."""
    obstacle: Floats
    """Shape (n_obstacle, 3), [mm]."""
    size: Floats
    """Local edge lengths there, shape (n_obstacle,), [mm]."""
    own: Ints
    """End that is at an obstacle, -1 if none is, shape (n_obstacle,)."""

    @classmethod
    def of(cls, sim: Simulation, rim: Ints) -> CrackEnds:
        """Return them for the present cracks; ``rim`` : nodes on the film's border."""
        n, f = sim.state.node, sim.state.flank
        tips, place, t = [], np.zeros((0, 3)), np.zeros((0, 3))
        if sim.cracks is not None:
            tips, at_tips = sim.cracks.tips, sim.cracks.at_tips
            place, t = at_tips(sim.mesh.nodes), at_tips(sim.mesh.directors)
        size = np.sqrt(sim.shell.area)
        # Those at the tips have not parted.
        n_tip, parted = len(place), np.flatnonzero(n.real[f.node[: f.count]])
        flanks = f.node[parted]
        # Nodes through which a crack goes: both flanks have film there.
        film = np.flatnonzero(n.real[: sim.state.n_node])
        film = film[~np.isin(film, f.node[: f.count])]
        origin = n.origin[film]
        nodes = np.union1d(rim, film[np.bincount(origin)[origin] > 1])
        of_nodes = local_edge_length(n.contact_area[nodes])
        return cls(
            place,
            unit(t),
            lambda i: tips[i].heading,
            np.concatenate([n.X[nodes], n.X[flanks], place]),
            np.concatenate([of_nodes, size[f.row[parted]], np.full(n_tip, np.median(size))]),
            np.concatenate([np.full(nodes.size + flanks.size, -1), np.arange(n_tip)]),
        )


class _Edges:
    """Arc lengths along the cutting edges of a tool, and their curves."""

    def __init__(self, tool: Tool) -> None:
        ends = tool.vertices[tool.edges]
        self._start, vector = ends[:, 0], ends[:, 1] - ends[:, 0]
        length = np.linalg.norm(vector, axis=1)
        self.unit = vector / length[:, None]
        self.curves = EdgeCurves.of(self._start, vector)
        self._length = np.bincount(tool.edge_chain, length, tool.n_chain)[tool.edge_chain]
        first = np.flatnonzero(np.diff(tool.edge_chain, prepend=-1))
        passed = np.cumsum(length) - length
        self._before = passed - passed[first][tool.edge_chain]
        self._closed = np.array([chain.closed for chain in tool.chains()])[tool.edge_chain]

    def to_spare(self, segment: Ints, point: Floats) -> Floats:
        """Return the distances from points on segments to the nearer end of the edge [mm].

        A closed edge has no end: half its length is returned.
        """
        on = np.einsum("ic,ic->i", point - self._start[segment], self.unit[segment])
        before, length = self._before[segment] + on, self._length[segment]
        spare = np.minimum(before, length - before)
        spare[self._closed[segment]] = 0.5 * length[self._closed[segment]]
        return np.asarray(np.maximum(spare, 0.0))


class CutFront:
    """Measure the cuts of a tool's edges, if any; results are kept until a cable changes."""

    def __init__(self, sim: Simulation, until: float) -> None:
        tool = sim.tool if sim.tool is not None and sim.tool.n_edge else None
        self._chain = np.zeros(0, np.int64) if tool is None else tool.edge_chain
        self._rim = sim.mesh.boundary_nodes()
        self._extent = float(norm(np.ptp(sim.mesh.nodes, axis=0)))
        self._look = _LOOK_AHEAD * until
        self._motion = sim.motion_in_film
        self._seen = (-1, -1, -1)
        self._ends: tuple[int, CrackEnds] | None = None
        self._rows = np.zeros((0 if tool is None else tool.n_chain, 4))
        self._edges = None if tool is None else _Edges(tool)

    def rows(self, sim: Simulation) -> Floats:
        """Return cut length, process zone, uncut film ahead, edge to spare, (n_chain, 4), [mm].

        The last two are 0 for an edge without process zone.
        """
        seen = (sim.state.revision, sim.cables.n_joint_made, sim.cables.n_broken)
        if len(self._rows) and seen != self._seen:
            self._seen, self._rows = seen, self._read(sim)
        return self._rows

    def saved(self) -> dict[str, Any]:
        """Return the last result and its step: evaluated later, its last digits would differ."""
        return {"seen": np.array(self._seen), "rows": self._rows}

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Load :meth:`saved`."""
        self._seen, self._rows = tuple(saved["seen"].tolist()), saved["rows"]

    def _read(self, sim: Simulation) -> Floats:
        cable, n = sim.state.cable, sim.state.cable.count
        met = np.flatnonzero(cable.edge[:n] != NOT_MET)
        chain = self._chain[cable.edge[met]]
        length = cable.length[met]
        holds = cable.status[met] == JOINTED
        rows = np.zeros_like(self._rows)
        rows[:, 0] = np.bincount(chain, length, len(rows))
        rows[:, 1] = np.bincount(chain[holds], length[holds], len(rows))
        zone, of, ends = met[holds], chain[holds], self._ends_of(sim)
        if not zone.size:
            return rows
        assert self._edges is not None
        spare = self._edges.to_spare(cable.edge[zone], cable.joint_body[zone])
        velocity, at = self._velocity(sim, self._edges, zone), cable.at_ends(sim.state.node.X)[zone]
        poses = self._poses(sim.state.time)
        for k in np.unique(of).tolist():
            mine = np.flatnonzero(of == k)
            rows[k, 3] = spare[mine].min()
            nth, tip, lead = _driven(at[mine, :1], ends.place, velocity[mine])
            if np.isfinite(lead):
                one = mine[nth]
                segment = int(cable.edge[zone[one]])
                course = self._course(poses, tip, ends, self._edges.curves, segment, velocity[one])
                rows[k, 2] = lead + self._ahead(tip, ends, *course)
        return rows

    def _ends_of(self, sim: Simulation) -> CrackEnds:
        if self._ends is None or self._ends[0] != sim.state.revision:
            self._ends = sim.state.revision, CrackEnds.of(sim, self._rim)
        return self._ends[1]

    def _velocity(self, sim: Simulation, edges: _Edges, zone: Ints) -> Floats:
        """Return the velocities along the film at which an edge passes through it, at cables.

        That of the edge's own point, but for what it moves along the edge; 0 if it moves through
        the film only.
        """
        assert self._motion is not None
        cable, now = sim.state.cable, sim.state.time
        spin, velocity = (np.asarray(part, float) for part in self._motion.twist(now))
        R = pose_at(self._motion, now).rotation
        whole = velocity + cross(spin, product(cable.joint_body[zone], R.T))
        e, t = product(edges.unit[cable.edge[zone]], R.T), _directors_at(sim, cable.ends[zone, 0])
        through, sine = (np.einsum("ic,ic->i", part, t)[:, None] for part in (whole, e))
        steep = np.abs(sine) > _FLAT
        along = whole - np.where(steep, through / np.where(steep, sine, 1.0) * e, through * t)
        along[np.linalg.norm(along, axis=1) <= _ALONG * np.linalg.norm(whole, axis=1)] = 0.0
        return np.asarray(along)

    def _ahead(
        self, tip: int, ends: CrackEnds, first: Floats, second: Floats, curvature: float
    ) -> float:
        gap = ends.obstacle - ends.place[tip]
        a, b = product(gap, first), product(gap, second)
        straight = abs(curvature) * self._extent <= _STRAIGHT
        # Else from the centre of the circle, which lies on the side of the turn.
        radius = np.inf if straight else 1.0 / abs(curvature)
        b = np.copysign(1.0, curvature) * b
        beside = np.abs(b) if straight else np.abs(np.hypot(a, radius - b) - radius)
        near = np.flatnonzero((beside <= _BESIDE * ends.size) & (ends.own != tip))
        a, b, size = a[near], b[near], ends.size[near]
        way = a if straight else radius * np.mod(each(math.atan2, a, radius - b), 2.0 * np.pi)
        # the far side of a tube is no obstacle
        through = np.abs(product(gap[near], cross(first, second)))
        met = (way > 0.0) & (through <= np.maximum(way, size))
        return float(way[met].min(initial=self._extent))

    def _poses(self, time: float) -> list[Pose]:
        """Return the pose of the tool at a time [s], and two a little later."""
        assert self._motion is not None
        return [pose_at(self._motion, time + k * self._look) for k in range(3)]

    def _course(
        self,
        poses: Sequence[Pose],
        tip: int,
        ends: CrackEnds,
        curves: EdgeCurves,
        segment: int,
        velocity: Floats,
    ) -> tuple[Floats, Floats, float]:
        """Return in-film unit vectors ahead and to the left, and the curvature to the left.

        The place of the tip moves on with the tool, or with the arc in which it turns: with that
        which moves more like the place at which the edge passes through the film.

        poses : of :meth:`_poses`.  velocity : of that place, (3,), [mm/s].
        """
        director, here = ends.director[tip], ends.place[tip]
        now, *then = poses
        axis, centre = curves.axis[segment], curves.centre[segment]
        frames = [then]
        if axis.any():
            frames.append([_turned_back(now, pose, axis, centre) for pose in then])
        local, ways = product(now.rotation.T, here - now.translation), []
        for frame in frames:
            places = [product(pose.rotation, local) + pose.translation - here for pose in frame]
            ways.append((places, [p - product(p, director) * director for p in places]))
        places, (first, second) = min(
            ways, key=lambda way: float(norm(way[1][0] - self._look * velocity))
        )
        length = float(norm(first))
        if length <= _ALONG * norm(places[0]) or length == 0.0:
            along = ends.heading(tip)
            along = unit(along - product(along, director) * director)
            return along, cross(director, along), 0.0
        chord = first / length
        left = cross(director, chord)
        onward = second - first
        if norm(onward) <= _ALONG * length:  # the tool comes to rest
            return chord, left, 0.0
        # Circle through three points: curvature = 4 area / product of the sides; the tangent at
        # the first point is the chord turned back by half the arc.
        sides = length * float(norm(second) * norm(onward))
        curvature = 2.0 * length * float(product(second, left)) / sides
        sine = 0.5 * curvature * length
        ahead = math.sqrt(max(1.0 - sine * sine, 0.0)) * chord - sine * left
        return ahead, cross(director, ahead), curvature


def _driven(cables: Floats, tips: Floats, velocity: Floats) -> tuple[int, int, float]:
    """Return which tip an edge drives at which of its cables, and its lead [mm], inf if none.

    cables : where they are, (n_zone, 1, 3), [mm].  tips : (n, 3), [mm].  velocity : at the cables,
    (n_zone, 3), [mm/s].
    """
    if not len(tips):
        return -1, -1, np.inf
    gap = tips - cables
    distance = np.linalg.norm(gap, axis=2)
    ahead = np.einsum("ztc,zc->zt", gap, velocity)
    moving = np.linalg.norm(velocity, axis=1) > 0.0
    distance[moving[:, None] & (ahead <= 0.0)] = np.inf
    nth, tip = divmod(int(distance.argmin()), len(tips))
    return nth, tip, float(distance[nth, tip])


def _turned_back(now: Pose, then: Pose, axis: Floats, centre: Floats) -> Pose:
    """Return a later pose without its turn about an axis of the body.

    With the unit quaternion (q_0, q) of the turn since now, that about the axis is
    2 atan2(n · q, q_0).
    """
    before, after = now.rotation.T, then.rotation.T  # of space, as seen from the body
    # 4 q_0 q and 4 q_0²
    sine, cosine = 2.0 * small_turn(after, before), 1.0 + float((before * after).sum())
    angle = -2.0 * math.atan2(float(product(axis, sine)), cosine)
    n, c = (float(axis[0]), float(axis[1]), float(axis[2])), math.cos(angle)
    back = np.array(rotation_rows(n, math.sin(angle), 1.0 - c, c))
    shift = product(then.rotation, centre - product(back, centre))
    return Pose(product(then.rotation, back), then.translation + shift)


def _directors_at(sim: Simulation, nodes: Ints) -> Floats:
    """Return the reference directors at some nodes, flank points included, shape (n, 3)."""
    directors, s = sim.mesh.directors, sim.state
    f = s.flank
    point = np.full(s.n_node, -1)
    point[f.node[: f.count]] = np.arange(f.count)
    tied = point[nodes] >= 0
    t = directors[np.where(tied, 0, s.node.origin[nodes])]
    if tied.any():
        k = point[nodes[tied]]
        own = np.einsum("ka,kac->kc", f.weight[k], directors[sim.shell.mesh_quads[f.row[k]]])
        t[tied] = unit(own)
    return np.asarray(t)
