"""Penalty contact of the nodes with the rigid tool ([Frangi2010] 5.2).

A node inside the tool by the depth g gets the force +k f(g) n, n the outward normal of the tool
there, and the tool minus that (the paper prints the minus, the force on the cutter); k and f are in
:mod:`shellcut.contact.settings`. The faces are frictionless: adhesion is in the joints of the
cables.

*Search.* Global: the nodes near a tooth are listed now and then
(:mod:`shellcut.contact.near_nodes`). Local: a listed node looks up the closest triangles of its
cell in a grid fixed to the tool. What it finds lasts until it has moved by a certain way from
there, seen from the tool. Outside, that is the distance from the surface: before, it cannot have
touched it and is passed over. Inside, it is half of what the other triangles are farther than the
closest: before, that stays the closest.

*Which face.* A blade's two flanks are a few hundredths of a millimetre apart near the edge, and a
node born inside the wedge by a split would take whichever is nearer, with a loaded spring. So a
node keeps a side, +1 or -1 by the flank labels of the tool, found at its first contact: on the
mid-plane or close to it (``_UNDECIDED``), from where its own quads lie, if they clearly lie beside
the blade; else from the nearest face. It is forgotten when the node has left the tool. A blade that
runs well beside the mesh line thus leaves both flanks on one side of it: to push one of them across
would put energy into the film that no tool has paid for.

*Jumps.* When the depth grows by more than node and tool have moved in the step, which a split does
that sets a node to the other flank, the excess is not loaded: it goes into an offset, which decays.
As it does the spring is loaded without anyone moving, and gives the film what it takes to push the
node out, work that no tool has done. It is an entry of the ledger, by its own increments. Growth
by motion is no jump: a node that flies into a face is stopped by it however far it goes in a step,
and rebounds with no more energy than it came with.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.jit import bound_once, inline, kernel
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, store, sub
from shellcut.state import State
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.cutting_edge import (
    CUT_DEPTH,
    NORMAL,
    CuttingEdges,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.signed_distance import signed_distance, signed_distance_to
from shellcut.tool.tool import Tool

from .near_nodes import NearNodes
from .settings import (
    Contact,
    PenaltyLaw,
    largest_rebound,
    node_stiffness,
    smoothed,
    smoothed_integral,
)

# Of the list of near nodes, over the median edge length sqrt(quad area): it lasts for hundreds of
# steps, as these follow the edges too. Half of it is also how near a node must be for its contact
# stiffness to count in the time step until that is looked at again.
_MARGIN = 2.2

# The quads of a node lie clearly beside the blade when their mean centre is farther from the
# mid-plane than this fraction of the local edge length.
_CLEARLY_BESIDE = 0.15

# Taken off a distance from the surface, far above its round-off: of the tool's farthest coordinate.
_ROUND_OFF = 1e-10

# How far off the mid-plane a node may lie, in local edge lengths, for its quads to decide its side.
_UNDECIDED = 0.1


class ContactForces(NamedTuple):
    """What the contact did in one evaluation."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
    node_work: float
    """Work of the contact on the nodes since t_{n-1} [N·mm]."""
    stored: float
    """Penalty energy k ∫ f dg at t_n [N·mm]."""
    absorbed: float
    """Energy that absorbed jumps took up since t_{n-1}; negative: gave to the film [N·mm]."""
    n_inside: int
    """Nodes inside the tool."""
    deepest: float
    """Largest depth [mm]."""


class _Lookups(NamedTuple):
    """Of each listed node, what its last look-up in the tool found."""

    place: Floats
    """Where it was then, in the body frame [mm], shape (n_near, 3)."""
    lasts: Floats
    """How far from there this lasts [mm], shape (n_near,)."""
    within: Bools
    """Whether it was inside, shape (n_near,)."""
    closest: Ints
    """The closest triangles of all and of its side if it was, shape (n_near, 2)."""


_NO_LOOKUPS = _Lookups(
    np.zeros((0, 3)), np.zeros(0), np.zeros(0, np.bool_), np.zeros((0, 2), np.int64)
)


class PenaltyContact:
    """Contact forces of all nodes.

    Parameters
    ----------
    tool : Tool
        The rigid body.
    contact : Contact
        Parameters.
    film : ShellMaterial
        Which they follow.
    edge_length : float
        Of a typical quad [mm].
    """

    def __init__(
        self, tool: Tool, contact: Contact, film: ShellMaterial, edge_length: float
    ) -> None:
        self.tool = tool
        self.law = PenaltyLaw.of(contact, film, tool)
        self._n_body = tool.n_body
        self.grid = ClosestTriangleGrid.of(tool)
        """Finds the surface near a point."""
        self._edges = CuttingEdges.of(tool)
        self._round_off = _ROUND_OFF * float(np.abs(tool.vertices).max())
        corners = [
            tool.vertices[tool.triangles[tool.triangle_body == b]] for b in range(tool.n_body)
        ]
        self.near = NearNodes(
            np.array([c.min(axis=(0, 1)) for c in corners]),
            np.array([c.max(axis=(0, 1)) for c in corners]),
            _MARGIN * edge_length,
        )
        """The nodes of the last global search."""
        self._listed: Ints = self.near.ids
        self._lookups = _NO_LOOKUPS
        self._pose: Pose | None = None
        self._arguments: tuple[Any, ...] = ()
        self._call = bound_once(_add_contact_forces)

    def add_forces(self, state: State, pose: Pose) -> ContactForces:
        """Add the contact forces at t_n to the nodal forces, tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        if self.near.renew(state, pose):
            self._take_list(state)
        wrench = np.zeros((self._n_body, 6))
        found = self._call(pose, before, state.dt, wrench, *self._arguments)
        return ContactForces(wrench, *found)

    def near_nodes(self, state: State) -> Ints:
        """Return the nodes that may come into contact soon.

        It depends on the places of the last evaluation alone, not on when the list was made; before
        the first there are none.
        """
        return self.near.within(state, self._pose) if self._pose else self.near.ids

    def saved(self) -> dict[str, Any]:
        """Return the list of near nodes and what each of them found last."""
        return {"near": self.near.saved(), "lookups": self._lookups._asdict()}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, for the nodes of ``state`` and the tool at its present pose."""
        self._pose = pose
        self.near.restore(state, saved["near"])
        self._listed = self.near.ids
        self._lookups = _Lookups(**{name: rows.copy() for name, rows in saved["lookups"].items()})
        self._collect(state)

    def _take_list(self, state: State) -> None:
        """Go over to the new list; what has left it is outside, what stays keeps its look-up."""
        n, before, near = state.node, self._listed, self.near.ids
        place = np.searchsorted(near, before)
        stays = near.take(place, mode="clip") == before if near.size else before < 0
        left = before[~stays]
        n.contact_side[left] = 0
        n.contact_depth[left] = n.contact_offset[left] = n.contact_work[left] = 0.0
        n.contact_force[left] = 0.0
        lookups = _Lookups(
            np.zeros((near.size, 3)),
            np.zeros(near.size),
            np.zeros(near.size, np.bool_),
            np.zeros((near.size, 2), np.int64),
        )
        for new, old in zip(lookups, self._lookups, strict=True):
            new[place[stays]] = old[stays]
        # A split leaves its node without a side: what was found of that side is void.
        lookups.lasts[lookups.within & (n.contact_side[near] == 0)] = 0.0
        self._listed, self._lookups = near, lookups
        self._collect(state)

    def _collect(self, state: State) -> None:
        """Collect the kernel's arguments in its order, good until a split renews the list."""
        n, near = state.node, self.near.ids
        self._arguments = (
            near,
            n.x,
            n.velocity_half,
            self.grid.arrays,
            self.grid.reach,
            self._round_off,
            self.tool.triangle_body,
            self._edges.segments,
            state.quads,
            n.quads,
            n.n_quad_at,
            n.contact_area,
            self.law.penalty,
            self.law.softest,
            self.law.stiffest,
            self.law.smoothing_depth,
            self.law.noticed,
            self.law.absorb_slowness,
            *self._lookups,
            n.contact_side,
            n.contact_depth,
            n.contact_offset,
            n.contact_work,
            n.contact_force,
            n.mass,
            n.supported,
            n.force,
        )


@inline
def _side_of_quads(
    n: int,
    x: Floats,
    pose: Pose,
    segments: Floats,
    quads: Ints,
    quads_at: Ints,
    n_quad_at: Ints,
    contact_area: Floats,
) -> int:
    """Return the side of the blade on which the node's quads clearly lie, or 0."""
    here = to_body(load(x, n), pose)
    size = np.sqrt(4.0 * contact_area[n])
    k_best = -1
    shallowest = np.inf
    for k in range(segments.shape[0]):
        _, lateral, depth, owns = strip_coordinates(here, k, segments, CUT_DEPTH * size)
        # Near the mid-plane only; the strip of the tooth across the ring reaches here too.
        if owns and depth < shallowest and abs(lateral) < _UNDECIDED * size:
            shallowest = depth
            k_best = k
    if k_best < 0:
        return 0
    cx = cy = cz = 0.0
    weight = 0.25 / n_quad_at[n]
    for i in range(n_quad_at[n]):
        for a in range(4):
            other = quads[quads_at[n, i], a]
            cx += weight * x[other, 0]
            cy += weight * x[other, 1]
            cz += weight * x[other, 2]
    centre = to_body((cx, cy, cz), pose)
    beside = dot(sub(centre, here), segment_part(segments, k_best, NORMAL))
    if abs(beside) < _CLEARLY_BESIDE * size:
        return 0
    return 1 if beside > 0.0 else -1


@kernel
def _add_contact_forces(
    pose: Pose,
    pose_before: Pose,
    dt: float,
    wrench: Floats,
    near: Ints,
    x: Floats,
    velocity: Floats,
    grid: tuple,  # type: ignore[type-arg]
    reach: float,
    round_off: float,
    triangle_body: Ints,
    segments: Floats,
    quads: Ints,
    quads_at: Ints,
    n_quad_at: Ints,
    contact_area: Floats,
    penalty: float,
    softest: float,
    stiffest: float,
    g_m: float,
    noticed: float,
    absorb_slowness: float,
    place: Floats,
    lasts: Floats,
    within: Bools,
    closest: Ints,
    side: SmallInts,
    depth: Floats,
    offset: Floats,
    contact_work: Floats,
    contact_force: Floats,
    mass: Floats,
    supported: Bools,
    force: Floats,
) -> tuple[float, float, float, int, float]:
    """Add contact forces of the nodes ``near`` to force : (n_node, 3) and wrench : (n_body, 6).

    place : (n_near, 3), lasts, within : (n_near,), closest : (n_near, 2): what the last look-up of
    each node found, good as long as it is closer to its place in the body frame than ``lasts``.
    Writes them, and side, depth, offset, contact_work and contact_force of these nodes. Returns the
    work on the nodes over the last step, the stored energy, the absorbed energy, how many are
    inside and the largest depth.
    """
    corners, flank, pseudo_normals = grid[6], grid[7], grid[8]
    work = 0.0
    stored = 0.0
    absorbed = 0.0
    n_inside = 0
    deepest = 0.0
    for i in range(near.shape[0]):
        n = near[i]
        p = to_body(load(x, n), pose)
        if norm(sub(p, load(place, i))) < lasts[i]:
            if not within[i]:
                continue
            triangle = closest[i, 1]
            within[i], q = signed_distance_to(p, closest[i, 0], triangle, corners, pseudo_normals)
        else:
            found, inside, triangle, q, whole, steady = signed_distance(p, side[n], *grid)
            store(place, i, p)
            within[i] = found and inside
            closest[i, 0], closest[i, 1] = whole, triangle
            # A node without a side may get one below, and one that keeps a side outside knows the
            # closest point of that side only: both look again next time.
            lasts[i] = 0.0
            if within[i] and side[n] != 0:
                lasts[i] = steady - round_off
            elif not within[i] and side[n] == 0:
                lasts[i] = (norm(sub(p, q)) if found else reach) - round_off
        if not within[i]:
            if side[n] != 0:
                lasts[i] = 0.0
            if (
                contact_force[n, 0] != 0.0
                or contact_force[n, 1] != 0.0
                or contact_force[n, 2] != 0.0
            ):
                work += 0.5 * dt * dot(load(contact_force, n), load(velocity, n))
                store(contact_force, n, (0.0, 0.0, 0.0))
            side[n] = 0
            depth[n] = 0.0
            offset[n] = 0.0
            contact_work[n] = 0.0
            continue
        if side[n] == 0:
            lies = _side_of_quads(
                n,
                x,
                pose,
                segments,
                quads,
                quads_at,
                n_quad_at,
                contact_area,
            )
            if lies == 0:
                lies = flank[triangle]
            side[n] = lies
            if lies * flank[triangle] < 0:
                _, _, triangle, q, _, _ = signed_distance(p, lies, *grid)
        outward = (
            pseudo_normals[triangle, 0, 0],
            pseudo_normals[triangle, 0, 1],
            pseudo_normals[triangle, 0, 2],
        )
        g = dot(sub(q, p), outward)
        moved = load(velocity, n)
        way = 0.0
        change = g - depth[n]
        impact = abs(change) > noticed
        if impact:
            was = to_body(combine(1.0, load(x, n), -dt, moved), pose_before)
            way = dot(sub(was, p), outward)
            if change > noticed + norm(sub(p, was)):  # more than node and tool have moved
                offset[n] += change
                impact = False
        depth[n] = g
        n_inside += 1
        deepest = max(deepest, g)
        stiffness = node_stiffness(contact_area[n], penalty, softest, stiffest)
        loaded = max(g, 0.0)
        if offset[n] > 0.0:
            loaded = max(g - offset[n], 0.0)
            absorbed += stiffness * smoothed_integral(loaded, g_m)
            offset[n] *= np.exp(-dt / (absorb_slowness * np.sqrt(4.0 * contact_area[n])))
            # A node that has come out may come in again: that is felt at once.
            offset[n] = min(offset[n], max(g, 0.0))
            loaded = max(g, 0.0) - offset[n]
            absorbed -= stiffness * smoothed_integral(loaded, g_m)
        magnitude = stiffness * smoothed(loaded, g_m)
        energy = stiffness * smoothed_integral(loaded, g_m)
        direction = turn(outward, pose)
        old = load(contact_force, n)
        if impact and dt > 0.0 and not supported[n]:
            before = dot(old, direction)
            pushed = -dot(load(force, n), direction)
            most = largest_rebound(contact_work[n], before, way, pushed, mass[n], dt)
            magnitude = min(magnitude, most)
            contact_work[n] += 0.5 * (before + magnitude) * way
        else:
            contact_work[n] = energy
        stored += energy
        f = (magnitude * direction[0], magnitude * direction[1], magnitude * direction[2])
        work += (
            0.5
            * dt
            * ((old[0] + f[0]) * moved[0] + (old[1] + f[1]) * moved[1] + (old[2] + f[2]) * moved[2])
        )
        store(contact_force, n, f)
        here = load(x, n)
        origin = pose.translation
        arm = (here[0] - origin[0], here[1] - origin[1], here[2] - origin[2])
        moment = cross(arm, f)
        body = triangle_body[triangle]
        for c in range(3):
            force[n, c] += f[c]
            wrench[body, c] -= f[c]
            wrench[body, 3 + c] -= moment[c]
    return work, stored, absorbed, n_inside, deepest
