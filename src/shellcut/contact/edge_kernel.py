"""The kernels of the contact of the film's edges with the tool's; see :mod:`.edge_contact`."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import add_scaled, combine, cross, dot, load, norm, scale, store, sub
from shellcut.state import local_edge_length
from shellcut.tool.pose import Pose, to_body, turn

from .deepest_on_edge import (
    NOTHING,
    Deepest,
    Place,
    Press,
    closest_along,
    deepest_on,
    place_at,
    press_on,
)
from .edge_tables import EdgeNodes, EdgePairs, EdgeTables, ToolEdges
from .near_nodes import largest_speed, tool_way
from .settings import STEEPEST, PenaltyLaw, node_stiffness

STIFFNESS = 0.25
"""Stiffness of an edge of the film over that of the softer node at its ends."""

CAPTURE = 0.3
"""Distance from the round of the tool's edge beyond which the film does not touch it, over the
local edge length."""


# Way over the edge length after which an edge that presses is searched whole again: till then its
# place is followed from step to step.
_AGAIN = 0.02

# First step of the search uphill, over the edge's length: from a place of the step before, or anew.
_WARM, _COLD = 1e-3, 1e-2


class Look(NamedTuple):
    """Where an edge of the film is beside the tool, in the body frame."""

    a: Vec3
    """One end [mm]."""
    u: Vec3
    """Way to the other [mm]."""
    one_side: bool
    """Whether both may lie on one side of the blade."""
    side: int
    """That side."""
    end_a: Place
    end_b: Place
    deepest: Deepest
    """Beside its chord."""
    body: int
    """Tooth there."""
    free: float
    """Until it has gone so far together with the tool it touches no edge of that [mm]."""


@inline
def edge_stiffness(i: int, pairs: EdgePairs, nodes: EdgeNodes, law: PenaltyLaw) -> float:
    """Return k of an edge of the film [N/mm]."""
    a, b = pairs.node[i, 0], pairs.node[i, 1]
    of_a = nodes.contact_share[a] * node_stiffness(nodes.contact_area[a], law)
    of_b = nodes.contact_share[b] * node_stiffness(nodes.contact_area[b], law)
    return STIFFNESS * min(of_a, of_b)


@inline
def _side_of(i: int, pairs: EdgePairs, nodes: EdgeNodes) -> tuple[bool, int]:
    """Return whether both ends may lie on one side of the blade, and which."""
    a = int(nodes.contact_side[pairs.node[i, 0]])
    b = int(nodes.contact_side[pairs.node[i, 1]])
    return a * b >= 0, a if a != 0 else b


@inline
def _size_of(i: int, pairs: EdgePairs, nodes: EdgeNodes) -> float:
    """Return the local edge length of the film at an edge of it [mm]."""
    area = nodes.contact_area
    return local_edge_length(max(area[pairs.node[i, 0]], area[pairs.node[i, 1]]))


@inline
def _look_again(i: int, pose: Pose, tables: EdgeTables) -> Look:
    """Return the ends of the i-th edge of the film, and where it pressed last as its deepest."""
    node, x, memory = tables.pairs.node, tables.nodes.x, tables.memory
    a = to_body(load(x, node[i, 0]), pose)
    b = to_body(load(x, node[i, 1]), pose)
    u = sub(b, a)
    one_side, side = _side_of(i, tables.pairs, tables.nodes)
    end_a, end_b = Place(False, 0.0, a), Place(False, 0.0, b)
    deepest, s = Deepest(0.0, 0.0, end_a), memory.place[i]
    if one_side:
        end_a, end_b = place_at(a, side, tables), place_at(b, side, tables)
        if memory.stored[i] > 0.0:
            deepest = Deepest(np.inf, s, place_at(add_scaled(a, s, u), side, tables))
    return Look(a, u, one_side, side, end_a, end_b, deepest, int(memory.body[i]), 0.0)


@inline
def _look(i: int, ends: Look, tables: EdgeTables) -> Look:
    """Return where the i-th edge of the film is deepest beside its chord, and how far it may go."""
    pairs, edges = tables.pairs, tables.edges
    a, u, side = ends.a, ends.u, ends.side
    size = _size_of(i, pairs, tables.nodes)
    best, body, free = Deepest(0.0, 0.0, ends.end_a), 0, np.inf
    for j in range(pairs.first[i], pairs.first[i + 1]):
        e = pairs.edge[j]
        s, away = closest_along(a, u, load(edges.start, e), load(edges.way, e))
        off = away - edges.reach[e]
        if off >= CAPTURE * size:
            free = min(free, off - CAPTURE * size)
            continue
        if not ends.one_side or min(side * edges.flank[e, 0], side * edges.flank[e, 1]) < 0:
            free = 0.0
            continue
        found = deepest_on(a, u, s, best, ends.end_a, ends.end_b, side, tables)
        if found.depth > best.depth:
            best, body = found, edges.body[e]
        free = min(free, max(off, 0.0))
    if best.depth > 0.0:
        free = 0.0
    return Look(a, u, ends.one_side, side, ends.end_a, ends.end_b, best, body, free)


@inline
def _press(look: Look, offset: float, step: float, tables: EdgeTables) -> Press:
    """Return what an edge presses with."""
    if look.deepest.depth <= offset:
        return NOTHING
    ends = look.end_a, look.end_b
    return press_on(look.a, look.u, look.deepest, offset, step, *ends, look.side, tables)


@kernel
def add_edge_forces(
    pose: Pose, before: Pose, dt: float, walked: float, tables: EdgeTables, wrench: Floats
) -> tuple[float, float, float, int, float, float]:
    """Add the forces of the listed edges to those of their ends and to wrench : (n_body, 6).

    walked : way that film and tool may have come nearer since the list was made [mm].  Writes the
    memory, and what friction needs.  Returns the work on the nodes over the last step, the stored
    energy, that of springs that have let go, the number of edges that press, the largest depth and
    the way walked.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    pairs, memory, nodes, law = tables.pairs, tables.memory, tables.nodes, tables.law
    presses, deepest = tables.presses, 0.0
    of_tool = tool_way(pose, before, tables.radius)
    way = of_tool + dt * largest_speed(pairs.moving, pairs.moving.shape[0], nodes.velocity_half)
    walked += way
    work = stored = absorbed = 0.0
    n_touching = 0
    for i in range(pairs.node.shape[0]):
        pressed, held = memory.stored[i] > 0.0, memory.stored[i]
        if walked < memory.until[i] and not pressed:
            continue
        work += _half_work(i, dt, tables)
        look, found = _look_again(i, pose, tables), NOTHING
        if pressed and walked < memory.until[i] and memory.offset[i] == 0.0:
            found = _press(look, 0.0, _WARM, tables)
        if found.stored == 0.0:
            look = _look(i, look, tables)
            found = _press(look, memory.offset[i], _COLD, tables)
            again = _AGAIN * _size_of(i, pairs, nodes) if found.stored > 0.0 else 0.0
            memory.until[i] = walked + max(look.free, again)
        g = found.over_chord if found.stored > 0.0 else look.deepest.depth
        change = g - memory.depth[i]
        memory.depth[i] = g
        # The chord moves against the edge by as much again: up to twice the way of film and tool.
        if change > law.noticed + 2.0 * way:
            memory.offset[i] += change
            found = _press(look, memory.offset[i], _COLD, tables)
        memory.offset[i] = min(memory.offset[i], g)
        memory.stored[i] = found.stored * edge_stiffness(i, pairs, nodes, law)
        memory.force[i] = 0.0
        presses.pressure[i] = 0.0
        if found.stored > 0.0:
            _put_on_ends(i, look, found, pose, tables, wrench)
            n_touching += 1
            deepest = max(deepest, g - memory.offset[i])
            stored += memory.stored[i]
            work += _half_work(i, dt, tables)
        if -change > law.noticed + 2.0 * way:  # its side is another one now
            absorbed += held - memory.stored[i]
    return work, stored, absorbed, n_touching, deepest, walked


@inline
def _put_on_ends(
    i: int, look: Look, found: Press, pose: Pose, tables: EdgeTables, wrench: Floats
) -> None:
    """Add what the i-th edge presses with to its ends and minus it to its tooth; write it down."""
    memory, presses, body = tables.memory, tables.presses, look.body
    k = edge_stiffness(i, tables.pairs, tables.nodes, tables.law)
    s, by = found.s, found.pressure
    on_a = combine((1.0 - s) * by, found.out, -found.from_a, look.end_a.out)
    on_b = combine(s * by, found.out, -found.from_b, look.end_b.out)
    _put_on(i, 0, scale(k, turn(on_a, pose)), body, pose, tables, wrench)
    _put_on(i, 1, scale(k, turn(on_b, pose)), body, pose, tables, wrench)
    memory.body[i], memory.place[i] = body, s
    more = by * norm(found.out) - found.from_a - found.from_b
    presses.pressure[i] = k * max(more, 0.0)
    store(presses.out, i, found.out)


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
        size = _size_of(i, pairs, nodes)
        for j in range(pairs.first[i], pairs.first[i + 1]):
            e = pairs.edge[j]
            _, away = closest_along(a, u, load(edges.start, e), load(edges.way, e))
            if away - edges.reach[e] < max(reach, CAPTURE * size):
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
