"""The kernels of the contact of the film's edges with the tool's; see :mod:`.edge_contact`."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import cross, dot, load, norm, scale, store, sub
from shellcut.state import local_edge_length
from shellcut.tool.pose import Pose, to_body, turn

from .deepest_on_edge import (
    Deepest,
    Place,
    closest_along,
    deepest_on,
    place_at,
    pressing_nowhere,
)
from .edge_tables import EdgeNodes, EdgePairs, EdgeTables, ToolEdges
from .near_nodes import largest_speed, tool_way
from .settings import STEEPEST, PenaltyLaw, node_stiffness, smoothed, smoothed_integral

STIFFNESS = 0.25
"""Stiffness of an edge of the film over the mean of the nodes at its ends."""

CAPTURE = 0.3
"""Distance from the round of the tool's edge beyond which the film does not touch it, over the
local edge length."""


@inline
def edge_stiffness(i: int, pairs: EdgePairs, nodes: EdgeNodes, law: PenaltyLaw) -> float:
    """Return k of an edge of the film [N/mm]."""
    k = 0.0
    for c in range(2):
        n = pairs.node[i, c]
        k += nodes.contact_share[n] * node_stiffness(nodes.contact_area[n], law)
    return 0.5 * STIFFNESS * k


@inline
def _side_of(i: int, pairs: EdgePairs, nodes: EdgeNodes) -> tuple[bool, int]:
    """Return whether both ends may lie on one side of the blade, and which."""
    a = int(nodes.contact_side[pairs.node[i, 0]])
    b = int(nodes.contact_side[pairs.node[i, 1]])
    return a * b >= 0, a if a != 0 else b


@inline
def _look(i: int, pose: Pose, tables: EdgeTables) -> tuple[Deepest, int, float]:
    """Return where the i-th edge of the film is deepest, the tooth, and how far it may go [mm].

    Until it has gone so far together with the tool it touches no edge of that.
    """
    pairs, edges, nodes = tables.pairs, tables.edges, tables.nodes
    ia, ib = pairs.node[i, 0], pairs.node[i, 1]
    a, b = to_body(load(nodes.x, ia), pose), to_body(load(nodes.x, ib), pose)
    u = sub(b, a)
    size = local_edge_length(max(nodes.contact_area[ia], nodes.contact_area[ib]))
    one_side, side = _side_of(i, pairs, nodes)
    best = pressing_nowhere(0.0)
    end_a, end_b = Place(False, 0.0, a), Place(False, 0.0, b)
    body, free, known = 0, np.inf, False
    for j in range(pairs.first[i], pairs.first[i + 1]):
        e = pairs.edge[j]
        s, away = closest_along(a, u, load(edges.start, e), load(edges.way, e))
        off = away - edges.reach[e]
        if off >= CAPTURE * size:
            free = min(free, off - CAPTURE * size)
            continue
        if not one_side or min(side * edges.flank[e, 0], side * edges.flank[e, 1]) < 0:
            free = 0.0
            continue
        if not known:
            end_a, end_b, known = place_at(a, side, tables), place_at(b, side, tables), True
        found = deepest_on(a, u, s, end_a, end_b, side, tables)
        if found.depth > best.depth:
            best, body = found, edges.body[e]
        free = min(free, max(off, 0.0) if found.depth == 0.0 else 0.0)
    return best, body, free


@kernel
def add_edge_forces(
    pose: Pose, before: Pose, dt: float, walked: float, tables: EdgeTables, wrench: Floats
) -> tuple[float, float, float, int, float, float]:
    """Add the forces of the listed edges to those of their ends and to wrench : (n_body, 6).

    walked : way that film and tool may have come nearer since the list was made [mm].  Writes the
    memory, and what friction needs.  Returns the work on the nodes over the last step, the stored
    energy, that of springs that have let go, the number of edges that press, the largest depth and the way walked.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    pairs, memory, nodes, law = tables.pairs, tables.memory, tables.nodes, tables.law
    presses = tables.presses
    of_tool = tool_way(pose, before, tables.radius)
    way = of_tool + dt * largest_speed(pairs.moving, pairs.moving.shape[0], nodes.velocity_half)
    walked += way
    work = stored = absorbed = deepest = 0.0
    n_touching = 0
    for i in range(pairs.node.shape[0]):
        if walked < memory.until[i]:
            continue
        work += _half_work(i, dt, tables)
        found, body, free = _look(i, pose, tables)
        memory.until[i] = walked + free
        g, k = found.depth, edge_stiffness(i, pairs, nodes, law)
        change = g - memory.depth[i]
        # The chord moves against the edge by as much again: up to twice the way of film and tool.
        if change > law.noticed + 2.0 * way:
            memory.offset[i] += change
        held = memory.stored[i]
        memory.offset[i] = min(memory.offset[i], g)
        loaded = g - memory.offset[i]
        energy = k * smoothed_integral(loaded, law.smoothing_depth)
        if -change > law.noticed + 2.0 * way:  # its side is another one now
            absorbed += held - energy
        memory.depth[i], memory.stored[i] = g, energy
        memory.force[i] = 0.0
        presses.pressure[i] = 0.0
        if loaded <= 0.0:
            continue
        n_touching += 1
        deepest = max(deepest, loaded)
        stored += energy
        magnitude = k * smoothed(loaded, law.smoothing_depth)
        _put_on(i, 0, scale(magnitude, turn(found.on_a, pose)), body, pose, tables, wrench)
        _put_on(i, 1, scale(magnitude, turn(found.on_b, pose)), body, pose, tables, wrench)
        work += _half_work(i, dt, tables)
        presses.body[i], presses.place[i] = body, found.s
        presses.pressure[i] = max(magnitude * found.more, 0.0)
        store(presses.out, i, found.out)
    return work, stored, absorbed, n_touching, deepest, walked


@inline
def _half_work(i: int, dt: float, tables: EdgeTables) -> float:
    """Return half the work of the last forces on an edge's ends over the last step [N·mm]."""
    work = 0.0
    for c in range(2):
        force = load(tables.memory.force[i], c)
        work += 0.5 * dt * dot(force, load(tables.nodes.velocity_half, tables.pairs.node[i, c]))
    return work


@inline
def _put_on(
    i: int, end: int, f: Vec3, body: int, pose: Pose, tables: EdgeTables, wrench: Floats
) -> None:
    """Add a force [N] to an end of the i-th edge and minus it to a tooth."""
    nodes, origin = tables.nodes, pose.translation
    n = tables.pairs.node[i, end]
    x = load(nodes.x, n)
    moment = cross((x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]), f)
    for c in range(3):
        tables.memory.force[i, end, c] = f[c]
        nodes.force[n, c] += f[c]
        wrench[body, c] -= f[c]
        wrench[body, 3 + c] -= moment[c]


@kernel
def edge_springs(pose: Pose, reach: float, tables: EdgeTables, node: Ints, k: Floats) -> int:
    """Write the ends of edges that may press soon, and a bound on their stiffness [N/mm].

    Those closer to the round of an edge of the tool than ``reach`` [mm].  node, k : (2 n_film,).
    Returns how many were written.
    """
    pose, tables = borrowed(pose), borrowed(tables)
    pairs, edges, nodes = tables.pairs, tables.edges, tables.nodes
    count = 0
    for i in range(pairs.node.shape[0]):
        a = to_body(load(nodes.x, pairs.node[i, 0]), pose)
        u = sub(to_body(load(nodes.x, pairs.node[i, 1]), pose), a)
        ia, ib = pairs.node[i, 0], pairs.node[i, 1]
        size = local_edge_length(max(nodes.contact_area[ia], nodes.contact_area[ib]))
        turn_squared = 0.0
        for j in range(pairs.first[i], pairs.first[i + 1]):
            e = pairs.edge[j]
            _, away = closest_along(a, u, load(edges.start, e), load(edges.way, e))
            if away - edges.reach[e] < max(reach, CAPTURE * size):
                turn_squared = max(turn_squared, edges.turn_squared[e])
        if turn_squared > 0.0:
            stiffness = turn_squared * STEEPEST * edge_stiffness(i, pairs, nodes, tables.law)
            for c in range(2):
                node[count], k[count] = pairs.node[i, c], stiffness
                count += 1
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
