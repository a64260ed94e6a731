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
a mean). Until the next look at the step a point moves by a quarter of an edge at most, so N_a is
taken as 1.25 - distance over edge length there, from 0 to 1.

*Search.* Pairs of points and quads closer than the capture and ``_SLACK`` edges are listed, among
the quads at the nodes near the tool, until points and nodes may have moved by half of the slack;
the other half is for nodes that are not listed. A listed point that is h above the film is looked
at again when it may have come down, at ``_PER_STEP`` of an edge a step (film that springs back at
100 m/s moves by that), and every ``_REST`` steps in any case.
"""

from __future__ import annotations

from collections.abc import Iterable
from math import sqrt
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import cross, dot, load, norm, scale, store, sub
from shellcut.state import KnownTopology, State, local_edge_length
from shellcut.tool.pose import Pose, to_space, turn

from .contact_points import contact_points
from .foot_on_quad import (
    QuadSurface,
    corner_weights,
    foot_on_quad,
    point_of,
    quad_surface,
    unit_normal,
)
from .penalty_contact import PenaltyContact
from .point_tables import PointFilm, PointPairs, PointSprings, PointTables, pairs_near
from .settings import node_stiffness, smoothed, smoothed_integral

CAPTURE = 0.5
"""Distance from the film beyond which a point does not touch it, over the local edge length."""

# Cosine of the angle between the outward normal of a point and the film's, at least: a corner that
# passes the film edgeways does not push it.
_FACING = 0.3

# Of the list of pairs, over the edge length: what points and film may move until it is made anew;
# and the number of pairs that it has room for at first.
_SLACK, _ROOM = 0.6, 512

# Steps between two checks of how far points and nodes have moved.
_LOOK_EVERY = 5

# Steps for which a point that does not press is not looked at, at most; and how far points and film
# come together in a step at most, over the edge length.
_REST, _PER_STEP = 8, 0.03

# Of the edge length, far above the round-off of a place.
_ROUND_OFF = 1e-10

# Reach of a point in the bound on the step beyond its own shape functions, over the edge length.
_SOON = 0.25


class PointForces(NamedTuple):
    """Results of one evaluation."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
    node_work: float
    """Work of the contact on the nodes since t_{n-1} [N·mm]."""
    stored: float
    """Penalty energy at t_n [N·mm]."""
    absorbed: float
    """Energy of springs that have let go since t_{n-1} [N·mm]."""
    n_touching: int
    """Number of points that press."""
    deepest: float
    """Largest depth [mm]."""

    def add_works(self, entries: dict[str, float], on_tool: float) -> None:
        """Add to the ledger's entries, ``on_tool`` being the work of the wrench."""
        entries["contact_work"] -= self.node_work + on_tool
        entries["contact_absorbed"] += self.absorbed


class PointContact:
    """Contact of the tool's points, a :class:`shellcut.simulation.tool_terms.ToolTerm`.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes, evaluated before this in every step.
    edge_length : float
        Of the film's smaller quads [mm].
    """

    def __init__(self, contact: PenaltyContact, edge_length: float) -> None:
        self.name = "points"
        self._contact, self._slack = contact, _SLACK * edge_length
        self.points = contact_points(contact.tool, edge_length)
        """Those of the tool, in its body frame."""
        self._radius = float(np.linalg.norm(self.points.place, axis=1).max(initial=0.0))
        self._springs = PointSprings.at_rest(len(self.points.place))
        self._pairs = PointPairs.none(len(self.points.place), _ROOM)
        self._pose = self._listed_pose = Pose.at_origin()
        self.n_search = 0
        """Searches for quads near the points so far."""
        self._listed: Ints = np.zeros(0, np.int64)
        self._x_listed: Floats = np.zeros((0, 3))
        self._known = KnownTopology()
        self._tables: PointTables | None = None
        self._hold = Holder()
        self._call, self._way = BoundOnce(_add_point_forces), BoundOnce(_farthest)
        self.forces = PointForces(np.zeros((contact.tool.n_body, 6)), 0.0, 0.0, 0.0, 0, 0.0)
        """Results of the last evaluation."""

    def add_forces(self, state: State, pose: Pose) -> PointForces:
        """Add the forces at t_n to the nodal forces, with the tool at the given pose."""
        self._pose = pose
        if self._is_old(state, pose):
            self._list(state, pose)
        wrench = np.zeros_like(self.forces.wrench)
        found = self._call.code(pose, state.dt, state.step, self._tables, wrench)
        self.forces = PointForces(wrench, *found)
        return self.forces

    def felt_nodes(self) -> Ints:
        """Return the nodes of the quads that a point presses on."""
        pressing = self._springs.depth > 0.0
        return np.unique(self._springs.node[pressing])

    def stiffness(self, state: State) -> tuple[Ints, Floats]:
        """Return the nodes that points may press soon and their steepest penalty [N/mm]."""
        n = state.node
        of, quad = self._pairs.listed()
        both = np.unique(of[:, None] * n.count + state.quads[quad])
        point, node = np.divmod(both, n.count)
        area = n.contact_area[node]
        place = self._pose.to_space(self.points.place[point])
        away = np.linalg.norm(n.x[node] - place, axis=1) / local_edge_length(area)
        weight = np.clip(1.0 + _SOON - away, 0.0, 1.0)
        return node, self.points.share[point] * weight * self._contact.law.steepest(area)

    def stored(self, _state: State) -> dict[str, float]:
        """Return the penalty energy at the last evaluation, by its name in the ledger [N·mm]."""
        return {"contact_stored": self.forces.stored}

    def saved(self) -> dict[str, Any]:
        """Return the springs, the list with the pose and places of its search, the last forces."""
        return {
            "springs": self._springs._asdict(),
            "pairs": self._pairs._asdict(),
            "listed": self._listed,
            "n_search": self.n_search,
            "x_listed": self._x_listed,
            "pose": self._listed_pose._asdict(),
            "revision": self._known.revision,
            "forces": self.forces._asdict(),
        }

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose."""
        self._springs = PointSprings(**{k: v.copy() for k, v in saved["springs"].items()})
        self._pairs = PointPairs(**{k: v.copy() for k, v in saved["pairs"].items()})
        self._listed, self._x_listed = saved["listed"].copy(), saved["x_listed"].copy()
        self._listed_pose, self._pose = Pose(**saved["pose"]).copied(), pose
        self.n_search = saved["n_search"]
        self._known.restore(saved["revision"], state)
        self.forces = PointForces(**saved["forces"])
        self._collect(state)

    def _is_old(self, state: State, pose: Pose) -> bool:
        """Return whether the list may miss a pair by now."""
        if not self._known.is_of(state):
            return True
        if state.step % _LOOK_EVERY:
            return False
        before, x, radius = self._listed_pose, state.node.x, self._radius
        moved = self._way(pose, before, radius, self._listed, x, self._x_listed)
        return bool(moved > 0.5 * self._slack)

    def _list(self, state: State, pose: Pose) -> None:
        """List the points near whole quads, and the quads near each."""
        n, quads = state.node, state.quads
        self.n_search += 1
        near = np.zeros(n.count, np.bool_)
        near[self._contact.near.ids] = True
        cut = (state.quad.share[: state.n_quad] < 1.0) | n.halved[quads].any(axis=1)
        whole = np.flatnonzero(near[quads].any(axis=1) & ~cut)
        pressing = np.flatnonzero(self._springs.force.any(axis=1))
        margin = CAPTURE * local_edge_length(n.contact_area[quads[whole]].max(axis=1)) + self._slack
        place, corners = pose.to_space(self.points.place), n.x[quads[whole]]
        found = pairs_near(place, corners, whole, margin, pressing)
        kept, self._pairs = self._pairs, self._pairs.fill(*found)
        self._listed = np.unique(quads[found[2]]).astype(np.int64)
        self._x_listed, self._listed_pose = n.x[self._listed].copy(), pose
        left = np.ones(len(place), np.bool_)
        left[found[0]] = False
        self._springs.side[left] = 0
        self._springs.due[:] = state.step
        if self._pairs is not kept or not self._known.is_of(state):
            self._collect(state)
        self._known.take(state)

    def _collect(self, state: State) -> None:
        """Build the kernel's tables, valid until the list is made anew."""
        n = state.node
        tables = PointTables(
            points=self.points,
            pairs=self._pairs,
            springs=self._springs,
            film=PointFilm(
                quads=state.quads,
                **{name: getattr(n, name) for name in PointFilm._fields if name != "quads"},
            ),
            law=self._contact.law,
        )
        self._tables = self._hold(tables)


@inline
def _quad_of(q: int, film: PointFilm) -> QuadSurface:
    quads, x = film.quads, film.x
    return quad_surface(
        load(x, quads[q, 0]), load(x, quads[q, 1]), load(x, quads[q, 2]), load(x, quads[q, 3])
    )


@inline
def _closest_quad(
    i: int, p: tuple[float, float, float], tables: PointTables
) -> tuple[int, float, float]:
    """Return the quad closest to p among those listed for the i-th point, xi and eta; -1 for none.

    Quads that are farther than a point can touch are passed over.
    """
    pairs, film = tables.pairs, tables.film
    best, best_xi, best_eta, least = -1, 0.0, 0.0, np.inf
    for j in range(pairs.first[i], pairs.first[i + 1]):
        q = pairs.quad[j]
        quad = _quad_of(q, film)
        away = sub(p, quad.c)
        reach = norm(quad.a) + norm(quad.b) + norm(quad.d)
        area = 0.0
        for c in range(4):
            area = max(area, film.contact_area[film.quads[q, c]])
        if norm(away) > reach + CAPTURE * local_edge_length(area):
            continue
        xi, eta = foot_on_quad(p, quad)
        away = sub(p, point_of(quad, xi, eta))
        squared = dot(away, away)
        if squared < least:
            best, best_xi, best_eta, least = q, xi, eta, squared
    return best, best_xi, best_eta


@kernel
def _add_point_forces(
    pose: Pose, dt: float, step: int, tables: PointTables, wrench: Floats
) -> tuple[float, float, float, int, float]:
    """Add the forces of the listed points to those of the nodes and to wrench : (n_body, 6).

    Writes the springs.  Returns the work on the nodes over the last step, the stored energy, that
    of springs that have let go, the number of points that press and the largest depth.
    """
    pose, tables = borrowed(pose), borrowed(tables)
    points, springs, film, law = tables.points, tables.springs, tables.film, tables.law
    side, depth = springs.side, springs.depth
    origin = pose.translation
    work = stored = absorbed = deepest = 0.0
    n_touching = 0
    for i in range(tables.pairs.used[0]):
        k = tables.pairs.point[i]
        if step < springs.due[k]:
            continue
        old = load(springs.force, k)
        if old[0] != 0.0 or old[1] != 0.0 or old[2] != 0.0:
            work += 0.5 * dt * _power(k, old, springs, film)
            store(springs.force, k, (0.0, 0.0, 0.0))
        p = to_space(load(points.place, k), pose)
        q, xi, eta = _closest_quad(i, p, tables)
        kept = False
        if q >= 0:
            quad = _quad_of(q, film)
            s, normal = point_of(quad, xi, eta), unit_normal(quad, xi, eta)
            way = sub(p, s)
            far, height = norm(way), dot(way, normal)
            area = 0.0
            for c in range(4):
                area += 0.25 * film.contact_area[film.quads[q, c]]
            # Beyond the rim a point is more beside the film than above it.
            size = local_edge_length(area)
            kept = far <= CAPTURE * size and far <= 1.5 * abs(height) + _ROUND_OFF * size
        if not kept:
            absorbed += springs.stored[k]
            side[k] = 0
            depth[k] = springs.stored[k] = 0.0
            springs.due[k] = step + _REST
            continue
        if side[k] == 0:
            facing = dot(turn(load(points.outward, k), pose), normal)
            above = 1 if height > 0.0 or (height == 0.0 and facing < 0.0) else -1
            if above * facing < -_FACING:
                side[k] = above
        g = far if side[k] * height < 0.0 else 0.0
        depth[k] = g
        springs.stored[k] = 0.0
        if g == 0.0:
            rest = int(abs(height) / (_PER_STEP * local_edge_length(area)))
            springs.due[k] = step + min(max(rest, 1), _REST)
            continue
        n_touching += 1
        deepest = max(deepest, g)
        stiffness = points.share[k] * node_stiffness(area, law)
        springs.stored[k] = stiffness * smoothed_integral(g, law.smoothing_depth)
        stored += springs.stored[k]
        f = scale(stiffness * smoothed(g, law.smoothing_depth) / far, way)
        weights = corner_weights(xi, eta)
        for c in range(4):
            springs.node[k, c] = film.quads[q, c]
            springs.weight[k, c] = weights[c]
        store(springs.force, k, f)
        work += 0.5 * dt * _power(k, f, springs, film)
        body = points.body[k]
        moment = cross((s[0] - origin[0], s[1] - origin[1], s[2] - origin[2]), f)
        for c in range(3):
            for corner in range(4):
                film.force[springs.node[k, corner], c] += springs.weight[k, corner] * f[c]
            wrench[body, c] -= f[c]
            wrench[body, 3 + c] -= moment[c]
    return work, stored, absorbed, n_touching, deepest


@inline
def _power(k: int, f: Vec3, springs: PointSprings, film: PointFilm) -> float:
    """Return the power of force f of point k on its nodes [N·mm/s]."""
    power = 0.0
    for c in range(4):
        moves = load(film.velocity_half, springs.node[k, c])
        power += springs.weight[k, c] * dot(f, moves)
    return power


@kernel
def _farthest(
    pose: Pose, then: Pose, radius: float, nodes: Ints, x: Floats, before: Floats
) -> float:
    """Return by how much the tool within a radius, and the nodes, may have moved [mm]."""
    turned = shift = far = 0.0
    for i in range(3):
        shift += (pose.translation[i] - then.translation[i]) ** 2
        for j in range(3):
            turned += (pose.rotation[i, j] - then.rotation[i, j]) ** 2
    for i in range(nodes.shape[0]):
        way = sub(load(x, nodes[i]), load(before, i))
        far = max(far, dot(way, way))
    return sqrt(shift) + radius * sqrt(turned) + sqrt(far)


def felt_nodes(terms: Iterable[object]) -> Ints:
    """Return the nodes of the quads that a point of the tool presses on, ascending."""
    felt = [term.felt_nodes() for term in terms if isinstance(term, PointContact)]
    return np.unique(np.concatenate(felt)) if felt else np.zeros(0, np.int64)
