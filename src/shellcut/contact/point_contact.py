"""Contact of corners and edges of the tool with the quads of the film.

Nodes feel the tool's faces; a corner of the tool that comes down between nodes feels the film here.
A point k of the tool (:mod:`shellcut.contact.contact_points`) has the foot s on the closest quad of
the film, d = x_k - s its way there. The side of the film on which it first comes near, facing it,
is its own; when it has passed the film by g = |d| it presses with k_p f(g) along d/|d|,

    force on node a of the quad:  N_a k_p f(g) d/|d|,        minus the sum, at s, on the tool,

with the shape functions N_a at the foot. As g is the distance from the surface that the quads span,
this is the gradient of the potential k_p ∫f, in the nodes as in the tool: the foot is where the
distance is stationary. f is that of the nodes (:mod:`shellcut.contact.settings`), k_p the stiffness
of a node there over the number of points that may press on its quads together: a single tip is as
stiff as a node, and so are all points of a ball that are on one node's quads.

*Whom it leaves alone.* Film at a crack: quads with a node on a flank, and cut ones. There the blade
is between the flanks; a corner of it that laps a little over a quad did not come through its face,
and what holds the flanks apart are the nodes on the blade's faces. A point that slips off the rim,
or whose film is cut, lets go; what its spring held is booked as absorbed. A point more than
``CAPTURE`` of an edge away has passed the film elsewhere (through a cut).

*Stiffness.* A spring k_p on the foot is no stiffer than springs k_p N_a at the nodes (the N_a weigh
a mean). Between two searches a point moves by half of the slack at most from where it was listed,
so by the whole of it from where it is at a look at the step. So only points count that press or are
no farther from a quad, and N_a of its nodes is taken as 1 + ``_SLACK`` - distance over edge length,
from 0 to 1.

*Search.* Pairs of points and quads closer than the capture and ``_SLACK`` edges are listed, among
the quads at the nodes near the tool, until points and nodes have moved by half of the slack; the
other half is for nodes that are not listed.

*Waiting.* A step adds to the way *walked* what points and listed film may have come nearer to each
other: the motion of the tool, and the largest nodal speed times the step. A point that is at the
distance d from the film cannot touch it before d has been walked, and is not looked at until then;
one that is out of reach of the film, not before it may be in reach. One that is close to the film
but beside its rim, or edgeways to it, is looked at again after ``_UNDECIDED`` of an edge.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.vec3 import add_to, dot, load, norm, scale, store, sub
from shellcut.state import KnownTopology, State, local_edge_length
from shellcut.tool.pose import Pose, to_space, turn, turn_back
from shellcut.tool.touch import Touch, react

from .contact_points import contact_points
from .contact_tables import Carriers, ContactNodes
from .foot_on_quad import (
    QuadSurface,
    corner_weights,
    foot_on_quad,
    point_of,
    quad_surface,
    unit_normal,
)
from .near_nodes import largest_speed, tool_way
from .penalty_contact import PenaltyContact
from .point_search import list_pairs, whole_quads_near
from .point_tables import PointPairs, PointSprings, PointTables
from .press_forces import PressTerm
from .settings import STEEPEST, node_stiffness, smoothed, smoothed_integral

CAPTURE = 0.5
"""Distance from the film beyond which a point does not touch it, over the local edge length."""

# Cosine of the angle between the outward normal of a point and the film's, at least: a corner that
# passes the film edgeways does not push it.
_FACING = 0.3

# Of the list of pairs, over the edge length: what points and film may move until it is made anew;
# and the number of pairs that it has room for at first.
_SLACK, _ROOM = 0.6, 512

# Way over the edge length after which a point is looked at again that film is close to, but not
# before it.
_UNDECIDED = 0.02

# Of the slack: a list with less than that left of it is made anew.
_LEAST_LEFT = 0.05

# Of the edge length, far above the round-off of a place.
_ROUND_OFF = 1e-10


class PointContact(PressTerm):
    """Contact of the tool's points.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes, evaluated before this in every step.
    edge_length : float
        Of the film's smaller quads [mm].
    """

    def __init__(self, contact: PenaltyContact, edge_length: float) -> None:
        self.points = contact_points(contact.tool, edge_length)
        """Those of the tool, in its body frame."""
        n = len(self.points.place)
        nowhere = Carriers.of(np.zeros((n, 4), np.int64))._replace(body=self.points.body)
        super().__init__("points", contact.tool.n_body, nowhere, np.arange(n))
        self._contact, self._slack = contact, _SLACK * edge_length
        self._radius = float(np.linalg.norm(self.points.place, axis=1).max(initial=0.0))
        self._springs = PointSprings.at_rest(n)
        self._pairs = PointPairs.none(n, _ROOM)
        self._pose = self._listed_pose = Pose.at_origin()
        self._x_listed: Floats = np.zeros((0, 3))
        # Way walked since the list was made, and at which it is looked at whether it is old.
        self._walked, self._look_at = 0.0, 0.0
        self._known = KnownTopology()
        self.tables: PointTables | None = None
        self._hold = Holder()
        self._call, self._way = BoundOnce(_add_point_forces), BoundOnce(_farthest)
        self._stiffness = BoundOnce(_stiffness_soon)
        self._quads, self._pair = BoundOnce(whole_quads_near), BoundOnce(list_pairs)

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the forces at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose, pose
        if not self._known.is_of(state) or self._walked > self._look_at or state.step == 0:
            self._renew(state, pose)
        self._walked = self._call.code(
            pose, before, state.dt, self._walked, self.tables, self._touch
        )

    def felt_nodes(self) -> Ints:
        """Return the nodes of the quads that a point presses on."""
        return np.unique(self.carriers.node[self._springs.depth > 0.0])

    def stiffness(self, _state: State, _counted: HeldBy) -> Held:
        """Return the nodes that points may press soon and their steepest penalty [N/mm]."""
        if self.tables is None:
            return np.zeros(0, np.int64), np.zeros(0)
        room = 4 * int(self._pairs.first[self._pairs.used[0]])
        node, stiffness = np.empty(room, np.int64), np.empty(room)
        count = self._stiffness(self._pose, self._slack, self.tables, node, stiffness)
        return node[:count], stiffness[:count]

    def saved(self) -> dict[str, Any]:
        """Return the springs, the list with the pose and places of its search, the last forces."""
        return {
            "springs": self._springs._asdict(),
            "carriers": self.carriers._asdict(),
            "pairs": self._pairs._asdict(),
            "n_search": self.n_search,
            "x_listed": self._x_listed,
            "walked": self._walked,
            "look_at": self._look_at,
            "pose": self._listed_pose._asdict(),
            "revision": self._known.revision,
            "touch": self.touch._asdict(),
        }

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose."""
        self._springs = PointSprings(**{k: v.copy() for k, v in saved["springs"].items()})
        self._take_carriers(saved["carriers"])
        self._pairs = PointPairs(**{k: v.copy() for k, v in saved["pairs"].items()})
        self._x_listed = saved["x_listed"].copy()
        self._walked, self._look_at = saved["walked"], saved["look_at"]
        self._listed_pose, self._pose = Pose(**saved["pose"]).copied(), pose
        self.n_search = saved["n_search"]
        self._known.restore(saved["revision"], state)
        self.touch.take(saved["touch"])
        self._collect(state)

    def _renew(self, state: State, pose: Pose) -> None:
        """Make the list anew if it may miss a pair by now.

        The way walked counts motion back and forth, too; the list is old only if tool and film are
        as far from where they were.
        """
        if self._known.is_of(state) and state.step > 0:
            before, x, nodes = self._listed_pose, state.node.x, self._pairs.nodes()
            moved = self._way(pose, before, self._radius, nodes, x, self._x_listed)
            left = 0.5 * self._slack - moved
            if left > _LEAST_LEFT * self._slack:
                self._look_at = self._walked + left
                return
        self._list(state, pose)

    def _list(self, state: State, pose: Pose) -> None:
        """List the points near whole quads, and the quads near each."""
        self.n_search += 1
        n = state.node
        ids, low, high = np.empty(state.n_quad, np.int64), *np.empty((2, state.n_quad, 3))
        count = self._quads(
            self._contact.near.ids,
            n.halved,
            state.quad.share,
            state.quads,
            ContactNodes.of(state),
            (CAPTURE, self._slack),
            ids,
            low,
            high,
        )
        boxes = ids[:count], low[:count], high[:count]
        place, force, kept = pose.to_space(self.points.place), self._springs.force, self._pairs
        while True:
            n_pair = self._pair(place, force, *boxes, state.quads, self._pairs)
            if n_pair <= self._pairs.quad.size:
                break
            self._pairs = PointPairs.none(len(place), 2 * n_pair)
        self._x_listed, self._listed_pose = n.x[self._pairs.nodes()].copy(), pose
        self._walked, self._look_at = 0.0, 0.5 * self._slack
        left = np.ones(len(place), np.bool_)
        left[self._pairs.points()] = False
        self._springs.side[left] = 0
        self._springs.until[:] = 0.0
        if self._pairs is not kept or not self._known.is_of(state):
            self._collect(state)
        self._known.take(state)

    def _collect(self, state: State) -> None:
        """Build the kernel's tables, valid until the list is made anew."""
        tables = PointTables(
            points=self.points,
            radius=self._radius,
            pairs=self._pairs,
            springs=self._springs,
            carriers=self.carriers,
            quads=state.quads,
            nodes=ContactNodes.of(state),
            law=self._contact.law,
        )
        self.tables = self._hold(tables)


@inline
def _quad_of(q: int, tables: PointTables) -> QuadSurface:
    quads, x = tables.quads, tables.nodes.x
    return quad_surface(
        load(x, quads[q, 0]), load(x, quads[q, 1]), load(x, quads[q, 2]), load(x, quads[q, 3])
    )


@always_inline
def _closest_quad(i: int, p: Vec3, tables: PointTables) -> tuple[int, float, float, float]:
    """Return the quad closest to p among those listed for the i-th point, xi and eta; -1 for none.

    Quads that are farther than a point can touch are passed over; the last number is the way after
    which one of them may no longer be [mm].
    """
    pairs, nodes = tables.pairs, tables.nodes
    best, best_xi, best_eta, least, free = -1, 0.0, 0.0, np.inf, np.inf
    for j in range(pairs.first[i], pairs.first[i + 1]):
        q = pairs.quad[j]
        quad = _quad_of(q, tables)
        away = sub(p, quad.c)
        reach = norm(quad.a) + norm(quad.b) + norm(quad.d)
        area = 0.0
        for c in range(4):
            area = max(area, nodes.contact_area[tables.quads[q, c]])
        out_of_reach = norm(away) - reach - CAPTURE * local_edge_length(area)
        if out_of_reach > 0.0:
            free = min(free, out_of_reach)
            continue
        xi, eta = foot_on_quad(p, quad)
        away = sub(p, point_of(quad, xi, eta))
        squared = dot(away, away)
        if squared < least:
            best, best_xi, best_eta, least = q, xi, eta, squared
    return best, best_xi, best_eta, free


@kernel
def _add_point_forces(
    pose: Pose, before: Pose, dt: float, walked: float, tables: PointTables, touch: Touch
) -> float:
    """Add the forces of the listed points to those of the nodes; return the way walked.

    walked : way that points and film may have come nearer since the list was made [mm].  Writes the
    springs and touch, see :class:`.press_forces.PressForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    points, springs, nodes, law = tables.points, tables.springs, tables.nodes, tables.law
    pairs, side, depth, until = tables.pairs, springs.side, springs.depth, springs.until
    carriers = tables.carriers
    walked += tool_way(pose, before, tables.radius)
    walked += dt * largest_speed(pairs.node, pairs.used[1], nodes.velocity_half)
    work = stored = absorbed = deepest = 0.0
    n_touching = 0
    for i in range(pairs.used[0]):
        k = pairs.point[i]
        if walked < until[k]:
            continue
        old = load(springs.force, k)
        if old[0] != 0.0 or old[1] != 0.0 or old[2] != 0.0:
            work += 0.5 * dt * _power(k, old, carriers, nodes)
            store(springs.force, k, (0.0, 0.0, 0.0))
            carriers.pressure[k] = 0.0
        p = to_space(load(points.place, k), pose)
        q, xi, eta, free = _closest_quad(i, p, tables)
        kept, little = False, 0.0
        if q >= 0:
            quad = _quad_of(q, tables)
            s, normal = point_of(quad, xi, eta), unit_normal(quad, xi, eta)
            way = sub(p, s)
            far, height = norm(way), dot(way, normal)
            area = 0.0
            for c in range(4):
                area += 0.25 * nodes.contact_area[tables.quads[q, c]]
            # Beyond the rim a point is more beside the film than above it.
            size = local_edge_length(area)
            kept = far <= CAPTURE * size and far <= 1.5 * abs(height) + _ROUND_OFF * size
            little = _UNDECIDED * size
        if not kept:
            absorbed += springs.stored[k]
            side[k] = 0
            depth[k] = springs.stored[k] = 0.0
            until[k] = walked + free
            if q >= 0:
                until[k] = walked + max(min(far - CAPTURE * size, free), little)
            continue
        if side[k] == 0:
            facing = dot(turn(load(points.outward, k), pose), normal)
            # A point as good as in the film's plane comes from where it does not face.
            above = 1 if height > law.noticed or (facing < 0.0 and height > -law.noticed) else -1
            if above * facing < -_FACING:
                side[k] = above
        g = far if side[k] * height < 0.0 else 0.0
        depth[k] = g
        springs.stored[k] = 0.0
        if g == 0.0:
            until[k] = walked + (min(far, max(free, little)) if side[k] != 0 else little)
            continue
        until[k] = 0.0
        n_touching += 1
        deepest = max(deepest, g)
        stiffness = points.share[k] * node_stiffness(area, law)
        springs.stored[k] = stiffness * smoothed_integral(g, law.smoothing_depth)
        stored += springs.stored[k]
        carriers.stiffness[k] = stiffness
        carriers.pressure[k] = stiffness * smoothed(g, law.smoothing_depth)
        f = scale(carriers.pressure[k] / far, way)
        store(carriers.normal, k, turn_back(scale(1.0 / far, way), pose))
        store(springs.force, k, f)
        weights = corner_weights(xi, eta)
        for c in range(4):
            carriers.node[k, c], carriers.weight[k, c] = tables.quads[q, c], weights[c]
            add_to(nodes.force, carriers.node[k, c], scale(weights[c], f))
        work += 0.5 * dt * _power(k, f, carriers, nodes)
        react(f, s, points.body[k], pose, wrench)
    sums[0], sums[1], sums[2], sums[3], sums[4] = work, absorbed, stored, n_touching, deepest
    return walked


@inline
def _power(k: int, f: Vec3, carriers: Carriers, nodes: ContactNodes) -> float:
    """Return the power of force f of point k on its nodes [N·mm/s]."""
    power = 0.0
    for c in range(4):
        moves = load(nodes.velocity_half, carriers.node[k, c])
        power += carriers.weight[k, c] * dot(f, moves)
    return power


@kernel
def _stiffness_soon(
    pose: Pose, soon: float, tables: PointTables, node: Ints, stiffness: Floats
) -> int:
    """Write the nodes that points may press soon, with the steepest penalty : (n,) [N/mm].

    soon : what a point may move until it is asked again [mm].  Node by node for every point,
    ascending; return their number.
    """
    pose, tables = borrowed(pose), borrowed(tables)
    points, pairs, nodes, law = tables.points, tables.pairs, tables.nodes, tables.law
    count = 0
    for i in range(pairs.used[0]):
        k, begin = pairs.point[i], count
        p = to_space(load(points.place, k), pose)
        for j in range(pairs.first[i], pairs.first[i + 1]):
            quad = _quad_of(pairs.quad[j], tables)
            xi, eta = foot_on_quad(p, quad)
            if norm(sub(p, point_of(quad, xi, eta))) > soon + tables.springs.depth[k]:
                continue
            for c in range(4):
                n, at = tables.quads[pairs.quad[j], c], count
                while at > begin and node[at - 1] > n:
                    at -= 1
                if at > begin and node[at - 1] == n:
                    continue
                for later in range(count, at, -1):
                    node[later] = node[later - 1]
                node[at] = n
                count += 1
        for j in range(begin, count):
            area = nodes.contact_area[node[j]]
            away = norm(sub(load(nodes.x, node[j]), p)) / local_edge_length(area)
            weight = min(max(1.0 + _SLACK - away, 0.0), 1.0)
            stiffness[j] = points.share[k] * weight * STEEPEST * node_stiffness(area, law)
    return count


@kernel
def _farthest(
    pose: Pose, then: Pose, radius: float, nodes: Ints, x: Floats, before: Floats
) -> float:
    """Return by how much the tool within a radius, and the nodes, may have moved [mm]."""
    far = 0.0
    for i in range(nodes.shape[0]):
        way = sub(load(x, nodes[i]), load(before, i))
        far = max(far, dot(way, way))
    return tool_way(pose, then, radius) + sqrt(far)


def felt_nodes(terms: Iterable[object]) -> Ints:
    """Return the nodes of the quads that a point of the tool presses on, ascending."""
    felt = [term.felt_nodes() for term in terms if isinstance(term, PointContact)]
    return np.unique(np.concatenate(felt)) if felt else np.zeros(0, np.int64)
