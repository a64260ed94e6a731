"""The kernels of the film's contact with itself: forces, and springs for the time step.

See :mod:`shellcut.contact.self_contact`.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline, kernel
from shellcut.numerics.vec3 import add_scaled, combine, dot, load, scale, store

from .quad_distance import corners_of, normal_at, weights_at
from .self_contact_tables import Memory, Presses, SelfContactTables, SelfNodes, Ties
from .settings import NOTICED, largest_rebound, smoothed, smoothed_integral
from .sheet_contact import Way, nearest_on, slopes_along, way_out

# Steps of the fastest node by which a point is looked at before it can touch.
_AHEAD = 4.0


@kernel
def add_self_contact(
    dt: float, walked: float, tables: SelfContactTables
) -> tuple[float, float, int, float, int, float]:
    """Add the forces of all points on the sheets that they touch, and minus these, to the nodes.

    walked : way that two things may have gone towards each other since the search [mm].  Writes
    memory, waits and presses.  Returns the work on the nodes over the last step, the stored energy,
    the number of points that touch, the largest depth, the number of points looked at, and the way
    walked.
    """
    tables = borrowed(tables)
    law, pairs, memory, waits = tables.law, tables.pairs, tables.memory, tables.waits
    nodes, outline, quads, presses = tables.nodes, tables.outline, tables.quads, tables.presses
    x, g_m, touches = nodes.x, law.smoothing_depth, tables.touches
    fastest = 0.0
    for i in range(tables.moving.shape[0]):
        v = load(nodes.velocity_half, tables.moving[i])
        fastest = max(fastest, dot(v, v))
    step = 2.0 * dt * sqrt(fastest)
    walked += step
    ahead = _AHEAD * step
    work = half_work_of(presses, nodes, dt)
    stored = deepest = 0.0
    count = n_looked = 0
    for i in range(pairs.node.shape[0]):
        if walked < waits.point[i]:
            continue
        n_looked += 1
        p = load(x, pairs.node[i])
        free = 1e300
        for sheet in range(pairs.first_sheet[i], pairs.first_sheet[i + 1]):
            band = law.thickness + ahead
            near = nearest_on(p, sheet, band, walked, waits.pair, x, quads, pairs, outline)
            free = min(free, near.free + ahead)  # then one of them is in the band
            first_sight = not memory.met[sheet]
            memory.met[sheet] = True
            if near.row < 0:
                _forget(sheet, memory)
                memory.side[sheet] = 0
                continue
            way, off = way_out(
                p,
                sheet,
                int(memory.side[sheet]) + 0,
                law.thickness,
                near,
                x,
                quads,
                pairs,
                outline,
            )
            free = min(free, off)
            memory.side[sheet] = way.side
            if off > 0.0 or way.depth <= 0.0:
                _forget(sheet, memory)
                continue
            if first_sight:
                memory.offset[sheet] = way.depth
            memory.offset[sheet] = min(memory.offset[sheet], way.depth)
            loaded = way.depth - memory.offset[sheet]
            k = tables.stiffness[i]
            force = k * smoothed(loaded, g_m)
            energy = k * smoothed_integral(loaded, g_m)
            memory.work[sheet], force = _after_impact(force, energy, i, sheet, way, dt, tables)
            memory.depth[sheet], memory.force[sheet] = way.depth, force
            stored += energy
            deepest = max(deepest, loaded)
            _press(count, pairs.node[i], force, way, quads, nodes, presses)
            touches.point[count], touches.sheet[count] = i, sheet
            touches.row[count] = near.row
            touches.place[count, 0], touches.place[count, 1] = near.place.xi, near.place.eta
            count += 1
        waits.point[i] = walked + max(free - ahead, 0.0)
    presses.n[0] = count
    work += half_work_of(presses, nodes, dt)
    return work, stored, count, deepest, n_looked, walked


@inline
def _after_impact(
    force: float,
    energy: float,
    i: int,
    sheet: int,
    way: Way,
    dt: float,
    tables: SelfContactTables,
) -> tuple[float, float]:
    """Return the work in the spring of point i [N·mm], and the force that it may exert [N]."""
    tables = borrowed(tables)
    memory, quads, nodes = tables.memory, tables.quads, tables.nodes
    change = way.depth - memory.depth[sheet]
    if abs(change) <= NOTICED * tables.law.smoothing_depth or dt == 0.0:
        return energy, force
    node = tables.pairs.node[i]
    moved = load(nodes.velocity_half, node)
    weights = weights_at(way.xi, way.eta)
    for a in range(4):
        moved = add_scaled(moved, -weights[a], load(nodes.velocity_half, quads[way.row, a]))
    went = -dt * dot(moved, way.direction)
    spent, before = memory.work[sheet], memory.force[sheet]
    pushed, mass = _pushed_in(node, way, quads, nodes, tables.ties)
    if mass > 0.0:
        put_in = spent + 0.5 * before * went
        force = min(force, largest_rebound(put_in, went, pushed, mass, dt))
    return spent + 0.5 * (before + force) * went, force


@always_inline
def _forget(sheet: int, memory: Memory) -> None:
    memory.offset[sheet] = memory.depth[sheet] = memory.force[sheet] = memory.work[sheet] = 0.0
    store(memory.drag, sheet, (0.0, 0.0, 0.0))


@inline
def half_work_of(presses: Presses, nodes: SelfNodes, dt: float) -> float:
    """Return half the work of forces over the last step [N·mm]."""
    work = 0.0
    for i in range(presses.n[0]):
        for a in range(5):
            v = load(nodes.velocity_half, presses.node[i, a])
            f = presses.force[i, a, 0], presses.force[i, a, 1], presses.force[i, a, 2]
            work += 0.5 * dt * dot(f, v)
    return work


@inline
def _press(
    at: int,
    node: int,
    force: float,
    way: Way,
    quads: Ints,
    nodes: SelfNodes,
    presses: Presses,
) -> None:
    """Add a force [N] on a point, and minus it on the quad; write both to row ``at`` of presses."""
    q = corners_of(nodes.x, quads, way.row)
    n = normal_at(q, way.xi, way.eta)
    weights = weights_at(way.xi, way.eta)
    turns = (0.0, 0.0, 0.0, 0.0)
    if way.lifted != 0.0:
        turns = slopes_along(way.direction, way.xi, way.eta, q)
    put_on(at, 0, node, scale(force, way.direction), nodes, presses)
    for a in range(4):
        back = combine(-force * weights[a], way.direction, force * way.lifted * turns[a], n)
        put_on(at, a + 1, quads[way.row, a], back, nodes, presses)


@always_inline
def put_on(at: int, which: int, node: int, f: Vec3, nodes: SelfNodes, presses: Presses) -> None:
    """Add a force [N] to a node; write it to a place of row ``at`` of presses."""
    presses.node[at, which] = node
    store(presses.force[at], which, f)
    for c in range(3):
        nodes.force[node, c] += f[c]


@inline
def _pushed_in(
    node: int, way: Way, quads: Ints, nodes: SelfNodes, ties: Ties
) -> tuple[float, float]:
    """Return what pushes a point in [N], and the mass that moves between it and the quad [t].

    The mass is zero if nothing there can move.
    """
    give = 0.0
    towards = (0.0, 0.0, 0.0)
    if ties.flank[node] >= 0:
        k = ties.flank[node]
        for a in range(4):
            m, weight = ties.nodes[k, a], ties.weight[k, a]
            give += weight * weight * nodes.push[m, 0]
            towards = add_scaled(towards, -weight * nodes.push[m, 0], load(nodes.force, m))
    else:
        give += nodes.push[node, 0]
        towards = add_scaled(towards, -nodes.push[node, 0], load(nodes.force, node))
    weights = weights_at(way.xi, way.eta)
    for a in range(4):
        m = quads[way.row, a]
        give += weights[a] * weights[a] * nodes.push[m, 0]
        towards = add_scaled(towards, weights[a] * nodes.push[m, 0], load(nodes.force, m))
    if give <= 0.0:
        return 0.0, 0.0
    return dot(towards, way.direction) / give, 1.0 / give


@kernel
def near_springs(
    reach: float,
    tables: SelfContactTables,
    node: Ints,
    stiffness: Floats,
) -> int:
    """Write the springs that may press soon: node, stiffness : (n_sheet, 5); return their number.

    Those of the points closer to a sheet than the thickness and ``reach`` [mm], at the places that
    are closest now.
    """
    tables = borrowed(tables)
    pairs, x, quads = tables.pairs, tables.nodes.x, tables.quads
    band = tables.law.thickness + reach
    untold = np.zeros(pairs.row.shape[0])
    count = 0
    for i in range(pairs.node.shape[0]):
        p = load(x, pairs.node[i])
        for sheet in range(pairs.first_sheet[i], pairs.first_sheet[i + 1]):
            near = nearest_on(p, sheet, band, 0.0, untold, x, quads, pairs, tables.outline)
            if near.row < 0 or near.place.square > band * band:
                continue
            weights = weights_at(near.place.xi, near.place.eta)
            node[count, 0], stiffness[count, 0] = pairs.node[i], tables.stiffness[i]
            for a in range(4):
                node[count, a + 1] = quads[near.row, a]
                stiffness[count, a + 1] = weights[a] * tables.stiffness[i]
            count += 1
    return count
