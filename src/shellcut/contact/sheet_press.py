"""The penalty of points on sheets of film: one kernel for nodes and for points of the tool.

A point inside a sheet by the depth D (:mod:`.quad_distance`) is pushed out with k f(D); the nodes
of the quad take the opposite by their shape functions, and the tool what its points get. See
:mod:`.sheet_contact`.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Vec3
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline, kernel
from shellcut.numerics.vec3 import add_scaled, add_to, combine, dot, load, scale, store, sub
from shellcut.state import KernelNodes
from shellcut.tool.pose import Pose, to_space, turn, turn_back
from shellcut.tool.touch import Touch, react

from .contact_tables import Presses, SheetTables
from .near_nodes import approach
from .press_kernel import is_fast, press
from .quad_distance import (
    Exit,
    closest_place,
    corners_of,
    exit_from,
    nearest_on,
    normal_at,
    off_box,
    place_in,
    slopes_along,
)

# Steps of the fastest node by which a point is evaluated before it can touch.
_AHEAD = 4.0


@kernel
def add_sheet_forces(pose: Pose, before: Pose, dt: float, tables: SheetTables, touch: Touch) -> int:
    """Add the forces of all points on the sheets that they touch, and minus these, to the nodes.

    Writes memory, clock, waits, contact points, presses and touch, see
    :class:`.press_term.PressForces`.  Returns the number of points evaluated.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    law, pairs, memory, waits = tables.law, tables.pairs, tables.memory, tables.waits
    nodes, presses, points, rigid = (
        tables.nodes,
        tables.presses,
        tables.contact_points,
        tables.of_tool,
    )
    by_film, by_other = approach(tables.clock, rigid, nodes.velocity_half, dt, pose, before)
    step = by_film + by_other
    tables.clock.walked[0] += step
    walked, ahead = tables.clock.walked[0], _AHEAD * step
    # Half the work of the last forces, before the new ones are written in their place.
    work, g_m = half_work_of(presses, nodes, dt), law.smoothing_depth
    stored = deepest = 0.0
    count = n_looked = 0
    for i in range(pairs.point.shape[0]):
        if walked < waits.point[i]:
            continue
        n_looked += 1
        point = pairs.point[i]
        p, moved, outward = _point_at(point, dt, pose, before, tables)
        free = 1e300
        for sheet in range(pairs.first_sheet[i], pairs.first_sheet[i + 1]):
            band = ahead + (law.capture if rigid else law.thickness)
            near = nearest_on(p, sheet, band, walked, tables)
            free = min(free, near.free + ahead)  # beyond that one of them may be in the band
            first_sight = not tables.met[sheet]
            tables.met[sheet] = True
            if near.pair < 0:
                _forget(sheet, 0, tables)
                continue
            exit_point, off = exit_from(p, outward, sheet, near, tables)
            free = min(free, off)
            if off > 0.0 or exit_point.depth <= 0.0:
                _forget(sheet, exit_point.side, tables)
                continue
            memory.side[sheet] = exit_point.side
            if first_sight:  # film that starts inside does not press
                memory.offset[sheet] = exit_point.depth
            if first_sight or dt == 0.0:  # before the run film may be put anywhere: that is no jump
                memory.depth[sheet] = exit_point.depth
            back, pushed, mass, k = (0.0, 0.0, 0.0), 0.0, 0.0, tables.stiffness[near.pair]
            if is_fast(sheet, exit_point.depth, g_m, memory):
                back, pushed, mass = _approach(point, moved, exit_point, dt, tables)
            out = exit_point.direction
            force, energy = press(
                sheet, exit_point.depth, k, back, out, pushed, mass, dt, g_m, memory
            )
            store(memory.force, sheet, scale(force, out))
            stored += energy
            deepest = max(deepest, exit_point.depth - memory.offset[sheet])
            _press(count, point, force, exit_point, tables)
            weights, row = shape_functions(near.place.xi, near.place.eta), pairs.row[near.pair]
            for a in range(4):
                points.node[sheet, a] = tables.quads[row, a]
                points.weight[sheet, a] = weights[a]
            points.stiffness[sheet], points.pressure[sheet] = k, force
            normal = scale(-1.0, out)
            if rigid:
                q = corners_of(nodes.x, tables.quads, exit_point.row)
                points.tooth[sheet] = tables.points.tooth[point]
                s = place_in(q, exit_point.xi, exit_point.eta)
                react(scale(force, normal), s, points.tooth[sheet], pose, wrench)
                normal = turn_back(normal, pose)
            store(points.normal, sheet, normal)
            count += 1
        # It is evaluated again some steps before it can touch.
        waits.point[i] = walked + max(free - ahead, 0.0)
    presses.n[0] = count
    work += half_work_of(presses, nodes, dt)
    sums[0], sums[1], sums[2], sums[3] = work, stored, count, deepest
    return n_looked


@always_inline
def _point_at(
    point: int, dt: float, pose: Pose, before: Pose, tables: SheetTables
) -> tuple[Vec3, Vec3, Vec3]:
    """Return where a point is, its motion over the last step [mm], and the tool's normal there."""
    if tables.of_tool:
        at = load(tables.points.place, point)
        p = to_space(at, pose)
        return p, sub(p, to_space(at, before)), turn(load(tables.points.outward, point), pose)
    p, v = load(tables.nodes.x, point), load(tables.nodes.velocity_half, point)
    return p, scale(dt, v), (0.0, 0.0, 0.0)


@inline
def _approach(
    point: int, moved: Vec3, exit_point: Exit, dt: float, tables: SheetTables
) -> tuple[Vec3, float, float]:
    """Return the motion of a point out of a quad over the last step [mm].

    And all other force that pushes them together [N], and the mass that moves between them [t].
    """
    tables = borrowed(tables)
    quads, nodes = tables.quads, tables.nodes
    back, towards, give = scale(-1.0, moved), (0.0, 0.0, 0.0), 0.0
    if not tables.of_tool and not nodes.supported[point]:
        give = 1.0 / nodes.contact_mass[point]
        towards = scale(-give, load(nodes.force, point))
    weights = shape_functions(exit_point.xi, exit_point.eta)
    # 1 / m_P + sum N_a²/m_a: what moves between point and quad; a point of the tool has no 1 / m_P.
    for a in range(4):
        n, weight = quads[exit_point.row, a], weights[a]
        back = add_scaled(back, dt * weight, load(nodes.velocity_half, n))
        give += weight * weight * nodes.push[n, 0]
        towards = add_scaled(towards, weight * nodes.push[n, 0], load(nodes.force, n))
    if give == 0.0:
        return back, 0.0, 0.0
    return back, dot(towards, exit_point.direction) / give, 1.0 / give


@always_inline
def _forget(sheet: int, side: int, tables: SheetTables) -> None:
    """Take a point out of contact, on a side of the sheet or on none."""
    memory = tables.memory
    memory.side[sheet] = side
    memory.offset[sheet] = memory.depth[sheet] = memory.work[sheet] = 0.0
    tables.contact_points.pressure[sheet] = 0.0


@inline
def half_work_of(presses: Presses, nodes: KernelNodes, dt: float) -> float:
    """Return half the work of forces over the last step [N·mm]."""
    work = 0.0
    for i in range(presses.n[0]):
        for a in range(5):
            v = load(nodes.velocity_half, presses.node[i, a])
            f = presses.force[i, a, 0], presses.force[i, a, 1], presses.force[i, a, 2]
            work += 0.5 * dt * dot(f, v)
    return work


@inline
def _press(at: int, point: int, force: float, exit_point: Exit, tables: SheetTables) -> None:
    """Add a force [N] on a node, and minus it on the quad; write both to row ``at`` of presses."""
    tables = borrowed(tables)
    quads, nodes, presses = tables.quads, tables.nodes, tables.presses
    q = corners_of(nodes.x, quads, exit_point.row)
    n = normal_at(q, exit_point.xi, exit_point.eta)
    weights, turns = shape_functions(exit_point.xi, exit_point.eta), (0.0, 0.0, 0.0, 0.0)
    if exit_point.lifted != 0.0:
        turns = slopes_along(exit_point.direction, exit_point.xi, exit_point.eta, q)
    if tables.of_tool:  # what it gets is on the tool
        put_on(at, 0, 0, (0.0, 0.0, 0.0), nodes, presses)
    else:
        put_on(at, 0, point, scale(force, exit_point.direction), nodes, presses)
    for a in range(4):
        back = combine(
            -force * weights[a], exit_point.direction, force * exit_point.lifted * turns[a], n
        )
        put_on(at, a + 1, quads[exit_point.row, a], back, nodes, presses)


@always_inline
def put_on(at: int, which: int, node: int, f: Vec3, nodes: KernelNodes, presses: Presses) -> None:
    """Add a force [N] to a node; write it to a place of row ``at`` of presses."""
    presses.node[at, which] = node
    store(presses.force[at], which, f)
    add_to(nodes.force, node, f)


@kernel
def closest_of_pairs(pose: Pose, tables: SheetTables, within: float, found: Floats) -> None:
    """Write distance [mm] and weights of the closest place of every pair to found : (n_pair, 5).

    Of a pair that is farther apart than ``within`` by the box of the quad only that distance.
    """
    pose, tables = borrowed(pose), borrowed(tables)
    pairs = tables.pairs
    for i in range(pairs.point.shape[0]):
        p, _, _ = _point_at(pairs.point[i], 0.0, pose, pose, tables)
        first, end = pairs.first_sheet[i], pairs.first_sheet[i + 1]
        for j in range(pairs.first_pair[first], pairs.first_pair[end]):
            row = pairs.row[j]
            q = corners_of(tables.nodes.x, tables.quads, row)
            found[j, 0] = off_box(p, q)
            if found[j, 0] > within:
                continue
            place = closest_place(p, q, row, tables.outline)
            found[j, 0], weights = np.sqrt(place.square), shape_functions(place.xi, place.eta)
            for a in range(4):
                found[j, 1 + a] = weights[a]
