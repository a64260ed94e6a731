"""The kernels of the contact of the film's edges with the tool's; see :mod:`.edge_contact`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import add_to, combine, dot, load, norm, scale, store, sub
from shellcut.state import local_edge_length
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.touch import Touch, react

from .captured_edges import closest_along, place_at
from .contact_tables import ContactNodes
from .edge_hills import Hills, hills_of, no_hills
from .edge_rebound import put_in_by_last, returned, way_back
from .edge_tables import EdgePairs, EdgeTables, ToolEdges
from .followed_edge import NO_HILL, follow, followed_hill, is_followed, is_idle, way_since
from .near_nodes import largest_speed, tool_way
from .settings import STEEPEST, PenaltyLaw, node_stiffness
from .tool_wedge import Beside, Place

STIFFNESS = 0.25
"""Stiffness of an edge of the film over that of the softer node at its ends."""

CAPTURE = 0.3
"""Distance from the round of the tool's edge beyond which the film does not touch it, over the
local edge length."""

NO_SIDE = 2
"""Stands for the side of an edge of the film whose ends are on both sides of the blade."""


class Look(NamedTuple):
    """What is seen of an edge of the film."""

    beside: Beside
    hills: Hills
    free: float
    """Until it has gone so far together with the tool it touches no edge of that [mm]."""


@inline
def edge_stiffness(i: int, pairs: EdgePairs, nodes: ContactNodes, law: PenaltyLaw) -> float:
    """Return k of an edge of the film [N/mm]."""
    a, b = pairs.node[i, 0], pairs.node[i, 1]
    of_a = nodes.contact_share[a] * node_stiffness(nodes.contact_area[a], law)
    of_b = nodes.contact_share[b] * node_stiffness(nodes.contact_area[b], law)
    k: float = STIFFNESS * min(of_a, of_b)
    return k


@inline
def _side_of(i: int, held: EdgeTables) -> tuple[bool, int]:
    """Return whether both ends may lie on one side of the blade, and which; write that down.

    While it is deeper than its chord an edge keeps its side, as a node in the tool does, unless an
    end has got the other one.
    """
    tables = borrowed(held)
    pairs, nodes, memory = tables.pairs, tables.nodes, tables.memory
    a = int(nodes.contact_side[pairs.node[i, 0]])
    b = int(nodes.contact_side[pairs.node[i, 1]])
    side = a if a != 0 else b
    if memory.depth[i] > 0.0 and memory.side[i] * side >= 0:
        side = int(memory.side[i])
    memory.side[i] = side
    return a * b >= 0, side


@inline
def _size_of(i: int, pairs: EdgePairs, nodes: ContactNodes) -> float:
    """Return the local edge length of the film at an edge of it [mm]."""
    area = nodes.contact_area
    size: float = local_edge_length(max(area[pairs.node[i, 0]], area[pairs.node[i, 1]]))
    return size


@inline
def _ends(i: int, pose: Pose, held: EdgeTables) -> tuple[Vec3, Vec3]:
    """Return both ends of the i-th edge of the film in the body frame."""
    tables = borrowed(held)
    node, x = tables.pairs.node, tables.nodes.x
    return to_body(load(x, node[i, 0]), pose), to_body(load(x, node[i, 1]), pose)


@inline
def _look(
    i: int, a: Vec3, b: Vec3, way: float, walked: float, jump: float, held: EdgeTables
) -> Look:
    """Return where and how the i-th edge of the film presses, and how far it may go.

    a, b : its ends, in the body frame [mm].  way : of :func:`.way_since`.  jump : change of its
    depth that needs a look at the whole tool [mm].
    """
    tables = borrowed(held)
    memory = tables.memory
    u, before = sub(b, a), memory.side[i]
    one_side, side = _side_of(i, held)
    if one_side and side == before and is_followed(i, way, held):
        beside = Beside(a, u, side, _end(i, 0, a, side, held), _end(i, 1, b, side, held), 0)
        hills = followed_hill(i, beside, held)
        steady = abs(hills.deepest.depth - memory.depth[i]) <= jump
        through = side != 0 and hills.deepest.here.depth > tables.law.tool_half_thickness
        if hills.press.stored > 0.0 and steady and not through:
            return Look(beside, hills, 0.0)
    nowhere, size = Place(False, 0.0, a), _size_of(i, tables.pairs, tables.nodes)
    n, free = _capture(i, a, u, side if one_side else NO_SIDE, size, walked, held)
    if n == 0:
        beside = Beside(a, u, side, nowhere, nowhere, 0)
        follow(i, no_hills(beside), beside, held)
        return Look(beside, no_hills(beside), free)
    end_a, end_b = _end(i, 0, a, side, held), _end(i, 1, b, side, held)
    beside = Beside(a, u, side, end_a, end_b, n)
    # Where it was deepest before it may be again, between edges that turn too little to be listed.
    last = memory.place[i] if memory.depth[i] > 0.0 else -1.0
    hills = hills_of(last, memory.offset[i], beside, held)
    if hills.deepest.depth > 0.0:
        free = 0.0
    # Closer to the other side than to its own the blade goes through it.
    if side != 0 and hills.deepest.here.depth > tables.law.tool_half_thickness:
        hills = no_hills(beside)
    follow(i, hills, beside, held)
    return Look(beside, hills, free)


@inline
def _end(i: int, k: int, p: Vec3, side: int, held: EdgeTables) -> Place:
    """Return how deep an end of the i-th edge of the film is, at p in the body frame.

    The contact of the nodes has found that, of the node's own side.
    """
    tables = borrowed(held)
    near, row = tables.near, tables.pairs.listed[i, k]
    if row < 0 or not near.within[row]:
        return Place(False, 0.0, p)
    if tables.nodes.contact_side[near.node[row]] != side:
        return place_at(p, side, held)
    depth = near.depth[row]
    return Place(depth > 0.0, max(depth, 0.0), load(near.out, row))


@inline
def _capture(
    i: int, a: Vec3, u: Vec3, side: int, size: float, walked: float, held: EdgeTables
) -> tuple[int, float]:
    """Write the edges of the tool that the i-th edge of the film may touch to tables.captured.

    side : of the blade, or NO_SIDE.  size : local edge length of the film [mm].  Returns how many
    they are, and the way until it may touch others [mm].
    """
    tables = borrowed(held)
    pairs, edges = tables.pairs, tables.edges
    n, free = 0, np.inf
    for j in range(pairs.first[i], pairs.first[i + 1]):
        if walked < pairs.until[j]:
            free = min(free, pairs.until[j] - walked)
            continue
        e = pairs.edge[j]
        _, away = closest_along(a, u, load(edges.start, e), load(edges.way, e))
        off = away - edges.reach[e]
        if off >= CAPTURE * size:
            pairs.until[j] = walked + off - CAPTURE * size
            free = min(free, off - CAPTURE * size)
        elif side == NO_SIDE or min(side * edges.flank[e, 0], side * edges.flank[e, 1]) < 0:
            free = 0.0
        else:
            tables.captured[n] = e
            n += 1
            free = min(free, max(off, 0.0))
    return n, free


@kernel
def add_edge_forces(
    pose: Pose, before: Pose, dt: float, walked: float, held: EdgeTables, touch: Touch
) -> float:
    """Add the forces of the listed edges to those of their ends; return the way walked.

    walked : way that film and tool may have come nearer since the list was made [mm].  Writes the
    memory, the carriers, and touch, see :class:`.press_forces.PressForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(held)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    pairs, memory, nodes, law = tables.pairs, tables.memory, tables.nodes, tables.law
    carriers, deepest = tables.carriers, 0.0
    of_tool = tool_way(pose, before, tables.radius)
    speed = largest_speed(pairs.moving, pairs.moving.shape[0], nodes.velocity_half)
    walked += of_tool + dt * speed
    work = stored = absorbed = 0.0
    n_touching = 0
    for i in range(pairs.node.shape[0]):
        if walked < memory.until[i]:
            continue
        a, b = _ends(i, pose, held)
        way = way_since(i, a, b, held)
        if is_idle(i, way, held):
            continue
        work += _half_work(i, dt, held)
        # The chord moves against the edge by as much again: up to twice the way in the tool.
        step = of_tool + dt * largest_speed(pairs.node[i], 2, nodes.velocity_half)
        jump = law.noticed + 2.0 * (way if memory.follows[i] == NO_HILL else step)
        tables.across[0] = memory.across[i]
        look = _look(i, a, b, way, walked, jump, held)
        g = look.hills.deepest.depth
        memory.until[i] = walked + look.free
        change, had = g - memory.depth[i], memory.stored[i]
        if change > jump:
            memory.offset[i] += change
            look = _look(i, a, b, 0.0, walked, jump, held)
        memory.across[i] = tables.across[0]
        memory.offset[i] = min(memory.offset[i], g)
        memory.depth[i], memory.place[i], memory.stored[i] = g, look.hills.deepest.s, 0.0
        carriers.pressure[i] = 0.0
        if had > 0.0 or look.hills.press.stored > 0.0:
            back_a = way_back(i, 0, dt, pose, before, held)
            back_b = way_back(i, 1, dt, pose, before, held)
            put_in_by_last(i, back_a, back_b, held)
            memory.force[i] = 0.0
            if g > memory.offset[i]:
                _put_on_ends(i, look, back_a, back_b, dt, pose, held, wrench)
        if memory.stored[i] > 0.0:
            n_touching += 1
            deepest = max(deepest, g - memory.offset[i])
            stored += memory.stored[i]
            work += _half_work(i, dt, held)
        if -change > jump:  # its side is another one now
            lost = min(had - memory.stored[i], max(memory.put_in[i], 0.0))
            memory.put_in[i] -= lost
            absorbed += lost
        if memory.stored[i] == 0.0:
            memory.put_in[i] = 0.0
    tables.captured[:], tables.across[:] = 0, -1  # tables are compared after a restart
    sums[0], sums[1], sums[2], sums[3], sums[4] = work, absorbed, stored, n_touching, deepest
    return walked


@inline
def _put_on_ends(
    i: int,
    look: Look,
    back_a: Vec3,
    back_b: Vec3,
    dt: float,
    pose: Pose,
    held: EdgeTables,
    wrench: Floats,
) -> None:
    """Add what the i-th edge presses with to its ends and minus it to its tooth; write it down.

    back_a, back_b : of :func:`.way_back` [mm].
    """
    tables = borrowed(held)
    memory, carriers, beside = tables.memory, tables.carriers, look.beside
    found = look.hills.press
    if found.stored == 0.0:
        return
    body = memory.body[i]
    k = edge_stiffness(i, tables.pairs, tables.nodes, tables.law)
    memory.stored[i] = k * found.stored
    s, by = found.s, found.pressure
    on_a = combine((1.0 - s) * by, found.out, -found.from_a, beside.end_a.out)
    on_b = combine(s * by, found.out, -found.from_b, beside.end_b.out)
    f_a, f_b = scale(k, turn(on_a, pose)), scale(k, turn(on_b, pose))
    part = returned(i, f_a, f_b, back_a, back_b, dt, held)
    _put_on(i, 0, scale(part, f_a), body, pose, held, wrench)
    _put_on(i, 1, scale(part, f_b), body, pose, held, wrench)
    memory.drift[i], memory.press_place[i] = s - memory.press_place[i], s
    along = norm(found.out)
    carriers.stiffness[i] = k
    carriers.weight[i, 0], carriers.weight[i, 1] = 1.0 - s, s
    carriers.pressure[i] = part * k * max(by * along - found.from_a - found.from_b, 0.0)
    store(carriers.normal, i, scale(1.0 / along, found.out))


@inline
def _half_work(i: int, dt: float, held: EdgeTables) -> float:
    """Return half the work of the last forces on an edge's ends over the last step [N·mm]."""
    tables = borrowed(held)
    work = 0.0
    for c in range(2):
        force = load(tables.memory.force[i], c)
        work += 0.5 * dt * dot(force, load(tables.nodes.velocity_half, tables.pairs.node[i, c]))
    return work


@inline
def _put_on(
    i: int, end: int, f: Vec3, body: int, pose: Pose, held: EdgeTables, wrench: Floats
) -> None:
    """Add a force [N] to an end of the i-th edge and minus it to a tooth."""
    tables = borrowed(held)
    nodes, n = tables.nodes, tables.pairs.node[i, end]
    store(tables.memory.force[i], end, f)
    add_to(nodes.force, n, f)
    react(f, load(nodes.x, n), body, pose, wrench)


@kernel
def edge_springs(pose: Pose, reach: float, held: EdgeTables, node: Ints, k: Floats) -> int:
    """Write the ends of edges that may press soon, and a bound on their stiffness [N/mm].

    Those that an edge of the tool may touch before they have walked ``reach`` together [mm].
    node, k : (2 n_film,).  Returns how many were written.
    """
    pose, tables = borrowed(pose), borrowed(held)
    pairs, edges, nodes = tables.pairs, tables.edges, tables.nodes
    count = 0
    for i in range(pairs.node.shape[0]):
        a, b = _ends(i, pose, held)
        u, size = sub(b, a), _size_of(i, pairs, nodes)
        for j in range(pairs.first[i], pairs.first[i + 1]):
            e = pairs.edge[j]
            _, away = closest_along(a, u, load(edges.start, e), load(edges.way, e))
            if away - edges.reach[e] < reach + CAPTURE * size:
                stiffness = STEEPEST * edge_stiffness(i, pairs, nodes, tables.law)
                for c in range(2):
                    node[count], k[count] = pairs.node[i, c], stiffness
                    count += 1
                break
    return count


@kernel
def list_edge_pairs(
    ends: Ints, x: Floats, pose: Pose, edges: ToolEdges, reach: float, first: Ints, edge: Ints
) -> int:
    """Write the edges of the tool closer than ``reach`` to each edge of the film.

    ends, x : of the film's edges (n_film, 2), and of all nodes.  first : (n_film + 1,), written.
    edge : (n_room,), written as far as there is room.  Returns how many pairs there are.
    """
    pose, count = borrowed(pose), 0
    edges = borrowed(edges)
    for i in range(ends.shape[0]):
        first[i] = count
        a = to_body(load(x, ends[i, 0]), pose)
        u = sub(to_body(load(x, ends[i, 1]), pose), a)
        half = 0.5 * norm(u) + reach
        middle = (a[0] + 0.5 * u[0], a[1] + 0.5 * u[1], a[2] + 0.5 * u[2])
        for e in range(edges.start.shape[0]):
            c, w = load(edges.start, e), load(edges.way, e)
            apart = False
            for k in range(3):
                low, high = min(c[k], c[k] + w[k]), max(c[k], c[k] + w[k])
                apart |= (middle[k] < low - half) | (middle[k] > high + half)
            if apart:
                continue
            _, away = closest_along(a, u, c, w)
            if away < reach:
                if count < edge.shape[0]:
                    edge[count] = e
                count += 1
    first[ends.shape[0]] = count
    return count
