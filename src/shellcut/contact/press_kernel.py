"""The penalty of film on tool, point by point: one kernel for nodes and places on the border.

A contact point inside the tool by the depth g gets the force k f(g) along the outward normal,
shared among its nodes by its weights; the tool gets the opposite. k is ``stiffness`` of the contact
points, written where these are listed (:mod:`.penalty_contact`, :mod:`.film_outline`). See
:mod:`.penalty_contact` for depth, side, jumps and impacts, :mod:`.border_contact` for what is
special to places on the border. :mod:`.tool_distance` tells where a point is in the tool.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, kernel
from shellcut.numerics.vec3 import add, add_to, combine, dot, load, norm, scale, store, sub
from shellcut.state import local_edge_length
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.touch import Touch, react

from .contact_tables import ContactTables, Memory
from .near_nodes import approach
from .settings import FADES_OVER, NOTICED, largest_rebound, smoothed, smoothed_integral
from .tool_distance import depth_in_tool

# A place that is deeper by e than the middle of the blade is evaluated again after a motion of this
# times e: long before it can have come back by e, and not in every step.
_AGAIN = 0.25


@always_inline
def _mean_of(rows: Floats, i: int, tables: ContactTables) -> Vec3:
    """Return what rows : (n_node, 3) are where a contact point is."""
    points = tables.contact_points
    at = load(rows, points.node[i, 0])
    if not tables.on_border:
        return at
    return combine(points.weight[i, 0], at, points.weight[i, 1], load(rows, points.node[i, 1]))


@always_inline
def _let_go(i: int, dt: float, tables: ContactTables) -> float:
    """Take a contact point out of contact; return half the work of its last force [N·mm]."""
    memory, row, work = tables.memory, tables.memory.row[i], 0.0
    old = load(memory.force, row)
    if old[0] != 0.0 or old[1] != 0.0 or old[2] != 0.0:
        work = 0.5 * dt * dot(old, _mean_of(tables.nodes.velocity_half, i, tables))
        store(memory.force, row, (0.0, 0.0, 0.0))
    memory.side[row] = 0
    memory.depth[row] = memory.offset[row] = memory.work[row] = 0.0
    tables.contact_points.pressure[i] = 0.0
    return work


@always_inline
def _side_of_ends(i: int, tables: ContactTables) -> tuple[bool, int]:
    """Return whether the ends of a border segment may lie on one side of the blade, and which.

    While a place on it is inside it keeps its side, or none, unless an end has got the other side.
    """
    node, side, memory = tables.contact_points.node, tables.nodes.contact_side, tables.memory
    a, b, row = int(side[node[i, 0]]), int(side[node[i, 1]]), memory.row[i]
    side_now = a if a != 0 else b
    old_side = int(memory.side[row])
    if memory.depth[row] > 0.0 and old_side * side_now >= 0:
        side_now = old_side
    return a * b >= 0, side_now


@always_inline
def press(
    row: int,
    g: float,
    k: float,
    back: Vec3,
    outward: Vec3,
    pushed: float,
    mass: float,
    dt: float,
    g_m: float,
    memory: Memory,
) -> tuple[float, float]:
    """Return the force of a contact in its outward direction [N] and its energy [N·mm].

    Writes depth, offset and work of the row; :func:`is_fast` compares with the old depth, so a
    caller asks it before.

    g, k : depth [mm] and stiffness [N/mm].  back, outward : motion back over the last step [mm] and
    outward direction.  pushed, mass : all other force into the face [N], and the mass that moves
    [t], 0 where nothing does.  ``back``, ``pushed`` and ``mass`` are used only if the depth has
    changed fast (:func:`is_fast`).
    """
    impact, offset = is_fast(row, g, g_m, memory), memory.offset
    change = g - memory.depth[row]
    if impact and change > NOTICED * g_m + norm(back):  # more than film and tool have moved
        offset[row] += change  # a jump is not loaded
        impact = False
    memory.depth[row] = g
    # A point that has come out may enter again: that depth presses at once.
    offset[row] = min(offset[row], max(g, 0.0))
    loaded = max(g, 0.0) - offset[row]
    magnitude, energy = k * smoothed(loaded, g_m), k * smoothed_integral(loaded, g_m)
    spent = energy
    # A spring in contact for a step or two could return more energy than was put in.
    if impact and mass > 0.0 and dt > 0.0:
        into = dot(back, outward)
        spent = memory.work[row] + 0.5 * dot(load(memory.force, row), back)
        magnitude = min(magnitude, largest_rebound(spent, into, pushed, mass, dt))
        spent += 0.5 * magnitude * into
    memory.work[row] = spent
    return magnitude, energy


@always_inline
def is_fast(row: int, g: float, g_m: float, memory: Memory) -> bool:
    """Return whether a depth has changed by so much in a step that it is a jump or an impact."""
    return bool(abs(g - memory.depth[row]) > NOTICED * g_m)


@always_inline
def _pushed(i: int, direction: Vec3, tables: ContactTables) -> tuple[float, float]:
    """Return the force on a contact point into the face so far [N], and the mass that it moves [t].

    It is that of loads and shells, as contact is the first of the force terms. A supported node
    moves by itself: with no other the mass is 0.
    """
    points, nodes = tables.contact_points, tables.nodes
    if not tables.on_border:
        n = points.node[i, 0]
        mass = 0.0 if nodes.supported[n] else nodes.contact_mass[n]
        return -dot(load(nodes.force, n), direction), mass
    inverse_mass = acceleration = 0.0
    for c in range(2):
        n, weight = points.node[i, c], points.weight[i, c]
        if not nodes.supported[n]:
            part = weight / nodes.contact_mass[n]
            inverse_mass += weight * part
            acceleration -= part * dot(load(nodes.force, n), direction)
    if inverse_mass == 0.0:
        return 0.0, 0.0
    return acceleration / inverse_mass, 1.0 / inverse_mass


@always_inline
def _pressure(
    i: int,
    x: Vec3,
    p: Vec3,
    g: float,
    out: Vec3,
    dt: float,
    before: Pose,
    pose: Pose,
    tables: ContactTables,
) -> tuple[float, Vec3, float]:
    """Return the outward force of a contact point [N], all its force, and its energy [N·mm].

    x, p : where it is in space and in the body frame [mm].  g, out : its depth and, in space, its
    outward direction.  With o = o_0 exp(-|p - p_0|² / 2 l²) the energy is k ∫_0^{g - o} f, and the
    force minus its gradient, k f (out + grad o), where grad o = o (p_0 - p) / l².
    """
    memory, place, g_m = tables.memory, tables.memory.place, tables.law.smoothing_depth
    row, back, was, pushed, mass, l2 = memory.row[i], (0.0, 0.0, 0.0), p, 0.0, 0.0, 1.0
    fast, faded = is_fast(row, g, g_m, memory), memory.offset[row]
    # Only these two need the motion of the film against the tool over the last step.
    if fast or faded > 0.0:
        was = to_body(combine(1.0, x, -dt, _mean_of(tables.nodes.velocity_half, i, tables)), before)
        back = turn(sub(was, p), pose)
    if fast:
        pushed, mass = _pushed(i, out, tables)
    if faded > 0.0:
        edge_length = local_edge_length(tables.nodes.contact_area[tables.contact_points.node[i, 0]])
        l2 = (FADES_OVER * edge_length) ** 2
        # The ratio of o of the formula above to that of the last step: o_0 need not be stored.
        now_at, had = sub(p, load(place, row)), sub(was, load(place, row))
        faded *= np.exp(0.5 * (dot(had, had) - dot(now_at, now_at)) / l2)
        memory.offset[row] = faded
    k = tables.contact_points.stiffness[i]
    magnitude, energy = press(row, g, k, back, out, pushed, mass, dt, g_m, memory)
    f = scale(magnitude, out)
    # The depth has jumped again: from now on the offset fades from here.
    if memory.offset[row] > faded:
        store(place, row, p)
    elif faded > 0.0:  # the part of the gradient from grad o
        pull = turn(sub(load(place, row), p), pose)
        f = combine(1.0, f, magnitude * memory.offset[row] / l2, pull)
    return magnitude, f, energy


@kernel
def add_press_forces(
    pose: Pose, before: Pose, dt: float, tables: ContactTables, touch: Touch
) -> None:
    """Add the forces of the listed contact points to their nodes.

    Writes the queries, the memory, and touch, see :class:`.press_term.PressForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    queries, points, memory, tool = (
        tables.queries,
        tables.contact_points,
        tables.memory,
        tables.tool,
    )
    side, on_border, clock = memory.side, tables.on_border, tables.clock
    by_film, by_tool = approach(clock, True, tables.nodes.velocity_half, dt, pose, before)
    clock.walked[0] += by_tool
    clock.walked[0] += by_film
    walked = clock.walked[0]
    work = stored = deepest = 0.0
    n_touching = 0
    for i in range(memory.row.shape[0]):
        # A point outside waits; one inside has a depth in every step.
        if walked < queries.until[i] and queries.face[i, 0] < 0:
            continue
        row, one_side, its_side = memory.row[i], True, int(side[memory.row[i]])
        if on_border:
            one_side, its_side = _side_of_ends(i, tables)
        x = _mean_of(tables.nodes.x, i, tables)
        p = to_body(x, pose)
        inside, whole, triangle, g, outward = False, 0, 0, 0.0, p
        if one_side:
            inside, whole, triangle, g, outward, its_side = depth_in_tool(
                i, p, its_side, walked, pose, tables
            )
        # Ends on both sides of the blade: it cuts through the segment, which is no contact.
        through = not one_side
        if on_border and inside and its_side * tool.grid.surface.flank[whole] < 0:
            # The other side is nearer: pushed past the middle of the blade, or beyond it.
            too_deep = g - tables.law.tool_half_thickness
            through = too_deep > 0.0
            queries.until[i] = walked + _AGAIN * max(too_deep, 0.0)
        if through or not inside:  # half a step of the last force is still to be booked
            work += _let_go(i, dt, tables)
            continue
        side[row] = its_side
        old, moved = load(memory.force, row), _mean_of(tables.nodes.velocity_half, i, tables)
        out = turn(outward, pose)
        magnitude, f, energy = _pressure(i, x, p, g, out, dt, before, pose, tables)
        n_touching, stored = n_touching + 1, stored + energy
        deepest = max(deepest, g - memory.offset[row] if on_border else g)
        # ½ (f_{n-1} + f_n) · Δx, as the energy balance counts all works.
        work += 0.5 * dt * dot(add(old, f), moved)
        store(points.normal, i, outward)
        points.tooth[i], points.pressure[i] = tool.triangle_tooth[triangle], magnitude
        store(memory.force, row, f)
        if not on_border:
            add_to(tables.nodes.force, points.node[i, 0], f)
        else:
            for c in range(2):
                add_to(tables.nodes.force, points.node[i, c], scale(points.weight[i, c], f))
        react(f, x, points.tooth[i], pose, wrench)
    sums[0], sums[1], sums[2], sums[3] = work, stored, n_touching, deepest
