"""Penalty contact of the nodes with the rigid tool ([Frangi2010] 5.2).

A node inside the tool by the depth g gets the force +k f(g) n, n the outward normal of the tool
there, and the tool gets the opposite (the minus in the paper: it prints the force on the cutter); k
and f are in :mod:`shellcut.contact.settings`. Friction on the faces is a term of its own
(:mod:`shellcut.contact.coulomb_friction`); adhesion acts in the joints of the cables.

*Search.* Global: the nodes near a tooth are listed now and then
(:mod:`shellcut.contact.near_nodes`). Local: a listed node looks up the closest triangles of its
cell in a grid fixed to the tool. The result is valid until the node has moved a certain distance
relative to the tool: outside, the distance from the surface, until which it cannot touch and is
skipped; inside, half of the amount by which other triangles are farther than the closest.

*Depth and normal* are those of the tool with its convex edges rounded, so that the force is
continuous, the gradient of a potential (:mod:`shellcut.tool.rounded_depth`).

*Which face.* A blade's two flanks are a few hundredths of a millimetre apart near the edge, and a
node created inside the wedge by a split would take the nearer one, with a loaded spring. So a node
keeps a side, +1 or -1 by the flank labels of the tool, chosen at its first contact: near the
mid-plane (``_UNDECIDED``) from its own quads, if they clearly lie beside the blade; else from the
nearest face. It is forgotten when the node has left the tool. So a blade well beside the mesh line
leaves both flanks of the cut on one side of it: pushing one across would give the film energy.

*Jumps.* When the depth grows by more than node and tool have moved in the step, as after a split
that assigns a node to the other flank, the excess is not loaded: it goes into an offset, which
decays. The decay loads the spring without motion and gives the film the energy to push the node
out, which is not work of the tool; it has an entry in the ledger, summed by increments. Growth by
motion is no jump: a node that flies into a face is stopped however deep it goes in a step, and
rebounds with no more energy than it came with.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy, Ints, Vec3
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.vec3 import add, add_to, combine, dot, load, norm, scale, store, sub
from shellcut.state import QuadsAtNodes, State, local_edge_length
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.cutting_edge import (
    CUT_DEPTH,
    NORMAL,
    CuttingEdges,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.rounded_depth import ConvexNeighbours, rounded_depth
from shellcut.tool.signed_distance import signed_distance, signed_distance_to
from shellcut.tool.tool import Tool
from shellcut.tool.touch import Touch, react

from .contact_tables import Carriers, ContactNodes, ContactTables, ContactTool, Lookups
from .near_nodes import NearNodes
from .press_forces import PressTerm
from .settings import (
    Contact,
    PenaltyLaw,
    largest_rebound,
    node_stiffness,
    smoothed,
    smoothed_integral,
)

# Margin of the list of near nodes, over the median edge length. Nodes within half of it count with
# their stiffness in the time step; the list lasts until that is used up.
_MARGIN = 2.2

# Of the local edge length: quads whose mean centre is farther from the mid-plane lie beside it.
_CLEARLY_BESIDE = 0.15

# Subtracted from distances, far above their round-off: fraction of the tool's farthest coordinate.
_ROUND_OFF = 1e-10

# Of the local edge length: up to there from the crack's plane quads decide a node's side.
_UNDECIDED = 0.1


class PenaltyContact(PressTerm):
    """Contact forces of all nodes.

    Parameters
    ----------
    tool : Tool
        The rigid body.
    contact : Contact
        Parameters.
    film : ShellMaterial
        The film, which sets the parameters' defaults.
    edge_length : float
        Of a typical quad [mm].
    crack_aside : float
        How far a crack may lie from the mid-plane of its blade, in local edge lengths.
    """

    def __init__(
        self,
        tool: Tool,
        contact: Contact,
        film: ShellMaterial,
        edge_length: float,
        crack_aside: float = 0.0,
    ) -> None:
        super().__init__("contact", tool.n_body, Carriers.of(np.zeros((0, 4), np.int64)), None)
        self.tool = tool
        self.law = PenaltyLaw.of(contact, film, tool)
        self.grid = ClosestTriangleGrid.of(tool)
        """Finds the surface near a point."""
        self._edges = CuttingEdges.of(tool)
        self._around = ConvexNeighbours.of(tool)
        self._undecided = _UNDECIDED + crack_aside
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
        self.lookups = Lookups.none_yet(self.near.ids)
        """What is known of these nodes."""
        self._pose: Pose | None = None
        self.tables: ContactTables | None = None
        self._hold = Holder()
        self._call = BoundOnce(_add_contact_forces)
        self.deepest = 0.0
        """Largest depth of a node in the tool so far [mm]."""

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the contact forces at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        if self.near.renew(state, pose):
            self._take_list(state)
            self.n_search = self.near.n_search
        deepest = self._call.code(pose, before, state.dt, self.tables, self._touch)
        self.deepest = max(self.deepest, deepest)

    def stiffness(self, state: State, _counted: HeldBy) -> Held:
        """Return the nodes that may come into contact soon and their steepest penalty [N/mm]."""
        near, n = self.near_nodes(state), state.node
        return near, n.contact_share[near] * self.law.steepest(n.contact_area[near])

    def near_nodes(self, state: State) -> Ints:
        """Return the nodes that may come into contact soon; before the first evaluation none.

        They depend only on the positions at the last one, not on when the list was made.
        """
        return self.near.within(state, self._pose) if self._pose else self.near.ids

    def saved(self) -> dict[str, Any]:
        """Return the list of near nodes, what is known of them, and the last forces."""
        return {
            "near": self.near.saved(),
            "lookups": self.lookups._asdict(),
            "carriers": self.carriers._asdict(),
            "touch": self.touch._asdict(),
            "deepest": self.deepest,
        }

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, for the nodes of ``state`` and the tool at its present pose."""
        self._pose = pose
        self.near.restore(state, saved["near"])
        self.n_search = self.near.n_search
        self.lookups = Lookups(**{name: rows.copy() for name, rows in saved["lookups"].items()})
        self.touch.take(saved["touch"])
        self.deepest = saved["deepest"]
        self._collect(state)
        self._take_carriers(saved["carriers"])

    def _take_list(self, state: State) -> None:
        """Switch to the new list: nodes that left it are outside, the others keep their look-up."""
        n, before, near = state.node, self.lookups.node, self.near.ids
        place = np.searchsorted(near, before)
        stays = near.take(place, mode="clip") == before if near.size else before < 0
        left = before[~stays]
        n.contact_side[left] = 0
        n.contact_depth[left] = n.contact_offset[left] = n.contact_work[left] = 0.0
        n.contact_force[left] = 0.0
        lookups = Lookups.none_yet(near)
        for new, old in zip(lookups[1:], self.lookups[1:], strict=True):
            new[place[stays]] = old[stays]
        # A split leaves its node without a side: its look-up is void.
        lookups.lasts[lookups.within & (n.contact_side[near] == 0)] = 0.0
        self.lookups = lookups
        self._collect(state)

    def _collect(self, state: State) -> None:
        """Build the kernel's tables, valid until a split renews the list."""
        carriers = Carriers.of(np.repeat(self.near.ids[:, None], 4, axis=1))
        self.carriers = carriers._replace(normal=self.lookups.out)
        tables = ContactTables(
            tool=ContactTool(
                grid=self.grid.arrays,
                reach=self.grid.reach,
                round_off=self._round_off,
                triangle_body=self.tool.triangle_body,
                segments=self._edges.segments,
                around=self._around,
                undecided=self._undecided,
            ),
            law=self.law,
            near=self.lookups,
            carriers=self.carriers,
            nodes=ContactNodes.of(state),
            around=state.quads_at_nodes(),
        )
        self.tables = self._hold(tables)


@inline
def _side_of_quads(
    n: int, pose: Pose, tool: ContactTool, nodes: ContactNodes, around: QuadsAtNodes
) -> int:
    """Return the side of the blade on which the node's quads clearly lie, or 0."""
    x, segments = nodes.x, tool.segments
    here = to_body(load(x, n), pose)
    size = local_edge_length(nodes.contact_area[n])
    k_best = -1
    shallowest = np.inf
    for k in range(segments.shape[0]):
        _, lateral, depth, owns = strip_coordinates(here, k, segments, CUT_DEPTH * size)
        # Only near the mid-plane: the strip of the tooth across the ring reaches here too.
        if owns and depth < shallowest and abs(lateral) < tool.undecided * size:
            shallowest = depth
            k_best = k
    if k_best < 0 or around.n_at[n] == 0:
        return 0
    cx = cy = cz = film = 0.0
    for i in range(around.n_at[n]):
        film += around.share[around.at[n, i]]
    for i in range(around.n_at[n]):
        row = around.at[n, i]
        share = around.share[row] / film
        for a in range(4):
            other, weight = around.quads[row, a], share * around.centre[row, a]
            cx += weight * x[other, 0]
            cy += weight * x[other, 1]
            cz += weight * x[other, 2]
    centre = to_body((cx, cy, cz), pose)
    beside = dot(sub(centre, here), segment_part(segments, k_best, NORMAL))
    if abs(beside) < _CLEARLY_BESIDE * size:
        return 0
    return 1 if beside > 0.0 else -1


@always_inline
def _look_up(
    i: int, p: Vec3, known: bool, side: int, tool: ContactTool, near: Lookups
) -> tuple[int, Vec3]:
    """Return the closest triangle of the side of listed node i, and its closest point.

    p : the node in the body frame, [mm].  known : whether its last look-up still holds.  Writes
    row i of near.
    """
    if known:
        triangle = near.closest[i, 1]
        near.within[i], q = signed_distance_to(p, near.closest[i, 0], triangle, tool.grid.surface)
    else:
        found, inside, triangle, q, whole, steady = signed_distance(p, side, tool.grid)
        store(near.place, i, p)
        near.within[i] = found and inside
        near.closest[i, 0], near.closest[i, 1] = whole, triangle
        # A node without a side may get one below, and a node outside that keeps its side knows only
        # the closest point of that side: both are looked up again next time.
        near.lasts[i] = 0.0
        if near.within[i] and side != 0:
            near.lasts[i] = steady - tool.round_off
        elif not near.within[i] and side == 0:
            near.lasts[i] = (norm(sub(p, q)) if found else tool.reach) - tool.round_off
    if not near.within[i] and side != 0:
        near.lasts[i] = 0.0
    return triangle, q


@always_inline
def _released(n: int, dt: float, work: float, nodes: ContactNodes) -> float:
    """Take a node out of contact; return ``work`` with that of its last force added [N·mm]."""
    old = load(nodes.contact_force, n)
    if old[0] != 0.0 or old[1] != 0.0 or old[2] != 0.0:
        work += 0.5 * dt * dot(old, load(nodes.velocity_half, n))
        store(nodes.contact_force, n, (0.0, 0.0, 0.0))
    nodes.contact_side[n] = 0
    nodes.contact_depth[n] = nodes.contact_offset[n] = nodes.contact_work[n] = 0.0
    return work


@always_inline
def _take_side(
    n: int, p: Vec3, triangle: int, q: Vec3, pose: Pose, tables: ContactTables
) -> tuple[int, Vec3]:
    """Choose the side of a node that has come in; return its closest triangle and point there."""
    tool = tables.tool
    flank = tool.grid.surface.flank
    lies = _side_of_quads(n, pose, tool, tables.nodes, tables.around)
    if lies == 0:
        lies = flank[triangle]
    tables.nodes.contact_side[n] = lies
    if lies * flank[triangle] < 0:
        _, _, triangle, q, _, _ = signed_distance(p, lies, tool.grid)
    return triangle, q


@always_inline
def _impact(
    n: int, p: Vec3, g: float, dt: float, pose_before: Pose, tables: ContactTables
) -> tuple[bool, Vec3]:
    """Write the depth g of node n; return whether it has hit the surface, and its way back [mm]."""
    nodes, noticed = tables.nodes, tables.law.noticed
    way = (0.0, 0.0, 0.0)
    change = g - nodes.contact_depth[n]
    impact = abs(change) > noticed
    if impact:
        moved = load(nodes.velocity_half, n)
        was = to_body(combine(1.0, load(nodes.x, n), -dt, moved), pose_before)
        way = sub(was, p)
        if change > noticed + norm(way):  # more than node and tool have moved
            nodes.contact_offset[n] += change
            impact = False
    nodes.contact_depth[n] = g
    return impact, way


@always_inline
def _loaded_depth(
    n: int, g: float, stiffness: float, dt: float, absorbed: float, tables: ContactTables
) -> tuple[float, float]:
    """Absorb part of a jump; return the depth that presses [mm] and the absorbed energy [N·mm]."""
    nodes, law = tables.nodes, tables.law
    offset, g_m = nodes.contact_offset, law.smoothing_depth
    loaded = max(g, 0.0)
    if offset[n] > 0.0:
        loaded = max(g - offset[n], 0.0)
        absorbed += stiffness * smoothed_integral(loaded, g_m)
        edge_length = local_edge_length(nodes.contact_area[n])
        offset[n] *= np.exp(-dt / (law.absorb_slowness * edge_length))
        # A node that has come out may come in again: that is felt at once.
        offset[n] = min(offset[n], max(g, 0.0))
        loaded = max(g, 0.0) - offset[n]
        absorbed -= stiffness * smoothed_integral(loaded, g_m)
    return loaded, absorbed


@always_inline
def _put_on(n: int, f: Vec3, body: int, pose: Pose, nodes: ContactNodes, wrench: Floats) -> None:
    """Add the contact force f [N] to a node and minus it to its tooth."""
    store(nodes.contact_force, n, f)
    add_to(nodes.force, n, f)
    react(f, load(nodes.x, n), body, pose, wrench)


@kernel
def _add_contact_forces(
    pose: Pose, pose_before: Pose, dt: float, tables: ContactTables, touch: Touch
) -> float:
    """Add contact forces of the near nodes to their force; return the largest depth [mm].

    Writes the look-ups, these nodes' contact fields, and touch, see
    :class:`.press_forces.PressForces`.
    """
    pose, pose_before, tables = borrowed(pose), borrowed(pose_before), borrowed(tables)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    tool, law, near, nodes = tables.tool, tables.law, tables.near, tables.nodes
    carriers = tables.carriers
    g_m = law.smoothing_depth
    ids, place, lasts, within = near.node, near.place, near.lasts, near.within
    x, side = nodes.x, nodes.contact_side
    work = stored = absorbed = deepest = 0.0
    n_touching = 0
    for i in range(ids.shape[0]):
        n = ids[i]
        p = to_body(load(x, n), pose)
        walked = sub(p, load(place, i))
        known = dot(walked, walked) < lasts[i] * abs(lasts[i])
        if known and not within[i]:  # has not come to the surface since
            continue
        triangle, q = _look_up(i, p, known, side[n], tool, near)
        if not within[i]:
            work = _released(n, dt, work, nodes)
            carriers.pressure[i] = 0.0
            continue
        old, moved = load(nodes.contact_force, n), load(nodes.velocity_half, n)
        if side[n] == 0:
            triangle, q = _take_side(n, p, triangle, q, pose, tables)
        g, outward, near.across[i] = rounded_depth(
            p, q, triangle, side[n], law.rounding, tool.grid, tool.around, near.across[i]
        )
        near.depth[i] = g
        store(near.out, i, outward)
        impact, back = _impact(n, p, g, dt, pose_before, tables)
        n_touching, deepest = n_touching + 1, max(deepest, g)
        stiffness = nodes.contact_share[n] * node_stiffness(nodes.contact_area[n], law)
        loaded, absorbed = _loaded_depth(n, g, stiffness, dt, absorbed, tables)
        magnitude = stiffness * smoothed(loaded, g_m)
        energy = stiffness * smoothed_integral(loaded, g_m)
        direction = turn(outward, pose)
        if impact and dt > 0.0 and not nodes.supported[n]:
            way = dot(back, outward)
            pushed = -dot(load(nodes.force, n), direction)
            spent = nodes.contact_work[n] + 0.5 * dot(old, turn(back, pose))
            most = largest_rebound(spent, way, pushed, nodes.contact_mass[n], dt)
            magnitude = min(magnitude, most)
            nodes.contact_work[n] = spent + 0.5 * magnitude * way
        else:
            nodes.contact_work[n] = energy
        stored += energy
        f = scale(magnitude, direction)
        work += 0.5 * dt * dot(add(old, f), moved)
        carriers.body[i] = tool.triangle_body[triangle]
        carriers.stiffness[i], carriers.pressure[i] = stiffness, magnitude
        _put_on(n, f, carriers.body[i], pose, nodes, wrench)
    sums[0], sums[1], sums[2], sums[3], sums[4] = work, absorbed, stored, n_touching, deepest
    return deepest
