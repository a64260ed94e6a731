"""The penalty of film on tool, point by point: one kernel for nodes and for places on edges.

A carrier inside the tool by the depth g gets the force k f(g) along the outward normal, shared
among its nodes by its weights; the tool gets the opposite. See :mod:`.penalty_contact` for depth,
side, jumps and impacts, :mod:`.edge_contact` for what is special to places on edges.

*Waiting.* One clock adds up how far tool and film may have come nearer to each other: the motion of
the tool, and the largest speed of a listed node times the step. A carrier that is at a distance d
from the tool is not looked at before d has been walked. One that is looked at has moved by less,
mostly: its last look-up holds while it is within a range of where it was.

*On a plane.* Most of what is inside lies on a face, far from its edges. Until it has slid so far
that another face, an edge of the triangle or the round of a convex edge may count, its depth is
that under the plane: with the depth g, the normals n and n_t of the closest face and of one that
meets it convexly, and r the radius of rounding, the ball that is pushed straight in from the
surface lies g_t + (r - g) n · n_t deep under the other plane, and that changes by the sine of the
angle between the faces times what the point slides.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from shellcut.arrays import Floats, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline, kernel
from shellcut.numerics.vec3 import (
    add,
    add_scaled,
    add_to,
    combine,
    dot,
    load,
    norm,
    scale,
    store,
    sub,
)
from shellcut.state import QuadsAtNodes, local_edge_length
from shellcut.tool.cutting_edge import CUT_DEPTH, NORMAL, segment_part, strip_coordinates
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.rounded_depth import rounded_depth
from shellcut.tool.signed_distance import (
    at_least,
    clear_for,
    closest_of_side,
    over_only_for,
    signed_distance_to,
    within_edges,
)
from shellcut.tool.touch import Touch, react

from .contact_tables import ContactNodes, ContactTables, ContactTool, Looks
from .near_nodes import largest_speed, tool_way
from .settings import largest_rebound, smoothed, smoothed_integral

# Of the local edge length: quads whose mean centre is farther from the mid-plane lie beside it.
_CLEARLY_BESIDE = 0.15

# Cosine of an angle between normals that is none.
_SAME = 1.0 - 1e-12

# Of the radius: depths that agree so far are one.
_AGREES = 1e-9

# Of what a place the blade goes through is too deep by: way after which it is looked at again.
_AGAIN = 0.25


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
def _place_of(i: int, tables: ContactTables) -> Vec3:
    """Return where a carrier is in space [mm]."""
    carriers, x = tables.carriers, tables.nodes.x
    at = load(x, carriers.node[i, 0])
    if tables.per_carrier == 1:
        return at
    other = load(x, carriers.node[i, 1])
    return combine(carriers.weight[i, 0], at, carriers.weight[i, 1], other)


@always_inline
def _velocity_of(i: int, tables: ContactTables) -> Vec3:
    """Return the velocity of a carrier [mm/s]."""
    carriers, v = tables.carriers, tables.nodes.velocity_half
    at = load(v, carriers.node[i, 0])
    if tables.per_carrier == 1:
        return at
    other = load(v, carriers.node[i, 1])
    return combine(carriers.weight[i, 0], at, carriers.weight[i, 1], other)


@always_inline
def _let_go(i: int, dt: float, tables: ContactTables) -> float:
    """Take a carrier out of contact; return half the work of its last force [N·mm]."""
    memory, row, work = tables.memory, tables.memory.row[i], 0.0
    old = load(memory.force, row)
    if old[0] != 0.0 or old[1] != 0.0 or old[2] != 0.0:
        work = 0.5 * dt * dot(old, _velocity_of(i, tables))
        store(memory.force, row, (0.0, 0.0, 0.0))
    memory.side[row] = 0
    memory.depth[row] = memory.offset[row] = memory.work[row] = 0.0
    tables.carriers.pressure[i] = 0.0
    return work


@always_inline
def _side_of_ends(i: int, tables: ContactTables) -> tuple[bool, int]:
    """Return whether the ends of an edge may lie on one side of the blade, and which.

    While a place on it is inside it keeps its side, unless an end has got the other one.
    """
    node, side, memory = tables.carriers.node, tables.nodes.contact_side, tables.memory
    a, b, row = int(side[node[i, 0]]), int(side[node[i, 1]]), memory.row[i]
    lies = a if a != 0 else b
    had = int(memory.side[row])
    if memory.depth[row] > 0.0 and had * lies >= 0:
        lies = had
    return a * b >= 0, lies


@always_inline
def _look_up(
    i: int, p: Vec3, side: int, pose: Pose, tables: ContactTables
) -> tuple[int, Vec3, int]:
    """Return the closest triangle of the side of a carrier, its closest point, and that side.

    p : the carrier in the body frame, [mm].  A node without a side gets one if it is inside.
    Writes row i of the looks.
    """
    tool, looks = tables.tool, tables.looks
    grid = tool.grid
    found, triangle, feature, q, ahead = closest_of_side(p, 0, grid)
    store(looks.place, i, p)
    way = sub(p, q)
    normals = grid.surface.pseudo_normals
    normal = (
        normals[triangle, feature, 0],
        normals[triangle, feature, 1],
        normals[triangle, feature, 2],
    )
    looks.within[i] = found and dot(way, normal) < 0.0
    looks.flat[i] = 0.0
    if not looks.within[i]:
        away = norm(way)
        if not found:
            away = at_least(p, tool.reach, grid.cells, tool.empty_around)
        looks.lasts[i] = away - tool.round_off
        if found and feature == 0 and away < tables.rounding:
            _keep_plane(i, p, triangle, tool, looks)
        return triangle, q, side
    whole, flank = triangle, grid.surface.flank
    if side == 0 and tables.per_carrier == 1:
        side = _side_of_quads(tables.carriers.node[i, 0], pose, tool, tables.nodes, tables.around)
        side = int(flank[triangle]) if side == 0 else side
    if side * flank[triangle] < 0:
        _, triangle, feature, q, of_side = closest_of_side(p, side, grid)
        ahead = min(ahead, of_side)
    looks.lasts[i] = 0.5 * ahead - tool.round_off
    looks.closest[i, 0], looks.closest[i, 1] = whole, triangle
    return triangle, q, side


@inline
def _keep_plane(i: int, p: Vec3, triangle: int, tool: ContactTool, looks: Looks) -> None:
    """Write the face that a carrier outside is over, and how long it holds."""
    surface = tool.grid.surface
    for c in range(4):
        looks.face[i, 0, c] = surface.planes[triangle, 0, c]
    looks.n_face[i] = 1
    within = within_edges(p, triangle, surface)
    looks.flat[i] = over_only_for(p, triangle, within, tool.grid) - tool.round_off


@inline
def _keep_faces(i: int, p: Vec3, g: float, outward: Vec3, side: int, tables: ContactTables) -> None:
    """Write the faces that the ball touches by which a carrier is rounded, and how long they hold.

    p : in the body frame, inside.  g, outward : its depth and way out [mm].
    """
    looks, tool, radius = tables.looks, tables.tool, tables.rounding
    surface, one, two = tool.grid.surface, looks.closest[i, 1], looks.across[i]
    centre = add_scaled(p, g - radius, outward)
    if looks.closest[i, 0] != one or not 0.0 < g < radius:
        return
    straight = dot(load(surface.planes[one], 0), outward) > _SAME
    if straight:
        two = one
    if two < 0:
        return
    within = min(within_edges(centre, one, surface), within_edges(centre, two, surface))
    if within <= 0.0:
        return
    for c in range(4):
        looks.face[i, 0, c] = surface.planes[one, 0, c]
        looks.face[i, 1, c] = surface.planes[two, 0, c]
    looks.n_face[i] = 1 if straight else 2
    _, again, _ = _under_faces(i, p, radius, looks)
    if abs(again - g) < _AGREES * radius:
        free = clear_for(centre, radius, radius - g, one, two, side, within, tool.grid)
        looks.flat[i] = free - tool.round_off


@always_inline
def _under_faces(i: int, p: Vec3, radius: float, looks: Looks) -> tuple[bool, float, Vec3]:
    """Return whether a carrier is under its one or two faces, how deep, rounded [mm], and way out.

    p : in the body frame.  From the radius on the depth is not to be used.
    """
    n = load(looks.face[i], 0)
    g = looks.face[i, 0, 3] - dot(n, p)
    if looks.n_face[i] < 2:
        return g > 0.0, g, n
    other = load(looks.face[i], 1)
    beyond = looks.face[i, 1, 3] - dot(other, p)
    inside = min(g, beyond) > 0.0
    a, b, c = radius - g, radius - beyond, dot(n, other)
    whole = 1.0 - c * c
    of_n, of_other = (a - c * b) / whole, (b - c * a) / whole
    if of_other <= 0.0:
        return inside, g, n
    if of_n <= 0.0:
        return inside, beyond, other
    w = combine(of_n, n, of_other, other)
    length = norm(w)
    return inside, radius - length, scale(1.0 / length, w)


@always_inline
def _followed(i: int, p: Vec3, tables: ContactTables) -> tuple[int, Vec3]:
    """Return the closest triangle of a carrier whose last look-up holds, and its closest point."""
    looks = tables.looks
    triangle = looks.closest[i, 1]
    looks.within[i], q = signed_distance_to(
        p, looks.closest[i, 0], triangle, tables.tool.grid.surface
    )
    return triangle, q


@always_inline
def _impact(
    i: int, x: Vec3, p: Vec3, g: float, dt: float, before: Pose, tables: ContactTables
) -> tuple[bool, Vec3]:
    """Write the depth g of a carrier; return whether it has hit the surface, and its way back [mm].

    x, p : where it is in space and in the body frame [mm].
    """
    memory, noticed = tables.memory, tables.law.noticed
    row, way = memory.row[i], (0.0, 0.0, 0.0)
    change = g - memory.depth[row]
    impact = abs(change) > noticed
    if impact:
        was = to_body(combine(1.0, x, -dt, _velocity_of(i, tables)), before)
        way = sub(was, p)
        if change > noticed + norm(way):  # more than film and tool have moved
            memory.offset[row] += change
            impact = False
    memory.depth[row] = g
    return impact, way


@always_inline
def _loaded_depth(
    i: int, g: float, stiffness: float, dt: float, tables: ContactTables
) -> tuple[float, float]:
    """Absorb part of a jump; return the depth that presses [mm] and the absorbed energy [N·mm]."""
    absorbed = 0.0
    law, row, offset = tables.law, tables.memory.row[i], tables.memory.offset
    g_m, loaded = law.smoothing_depth, max(g, 0.0)
    if offset[row] > 0.0:
        loaded = max(g - offset[row], 0.0)
        if tables.per_carrier == 1:
            absorbed += stiffness * smoothed_integral(loaded, g_m)
            edge_length = local_edge_length(tables.nodes.contact_area[tables.carriers.node[i, 0]])
            offset[row] *= np.exp(-dt / (law.absorb_slowness * edge_length))
        # What has come out may come in again: that is felt at once.
        offset[row] = min(offset[row], max(g, 0.0))
        loaded = max(g, 0.0) - offset[row]
        if tables.per_carrier == 1:
            absorbed -= stiffness * smoothed_integral(loaded, g_m)
    return loaded, absorbed


@always_inline
def _pushed(i: int, direction: Vec3, tables: ContactTables) -> tuple[float, float]:
    """Return all other force on a carrier into the face [N], and the mass that it moves [t].

    A supported node moves by itself: with no other the mass is 0.
    """
    carriers, nodes = tables.carriers, tables.nodes
    if tables.per_carrier == 1:
        n = carriers.node[i, 0]
        mass = 0.0 if nodes.supported[n] else nodes.contact_mass[n]
        return -dot(load(nodes.force, n), direction), mass
    light = rate = 0.0
    for c in range(2):
        n, weight = carriers.node[i, c], carriers.weight[i, c]
        if not nodes.supported[n]:
            part = weight / nodes.contact_mass[n]
            light += weight * part
            rate -= part * dot(load(nodes.force, n), direction)
    return (rate / light, 1.0 / light) if light > 0.0 else (0.0, 0.0)


@always_inline
def _put_on(i: int, x: Vec3, f: Vec3, pose: Pose, tables: ContactTables, wrench: Floats) -> None:
    """Add a force f [N] on a carrier to its nodes and minus it to its tooth."""
    carriers, force = tables.carriers, tables.nodes.force
    store(tables.memory.force, tables.memory.row[i], f)
    if tables.per_carrier == 1:
        add_to(force, carriers.node[i, 0], f)
    else:
        for c in range(2):
            add_to(force, carriers.node[i, c], scale(carriers.weight[i, c], f))
    react(f, x, carriers.body[i], pose, wrench)


@always_inline
def _see(
    i: int, p: Vec3, lies: int, walked: float, pose: Pose, tables: ContactTables
) -> tuple[bool, int, float, Vec3, int]:
    """Return whether a carrier is inside, and if so the closest triangle, depth, way out and side.

    p : in the body frame, [mm].  lies : its side so far.  Writes its look, and how long it waits.
    """
    looks, tool, radius = tables.looks, tables.tool, tables.rounding
    way = sub(p, load(looks.place, i))
    gone = dot(way, way)
    triangle, q, fresh = looks.closest[i, 1], p, False
    # A node without a side may get one: it is looked up again.
    settled = tables.per_carrier > 1 or lies != 0 or not looks.within[i]
    if settled and gone < looks.flat[i] * abs(looks.flat[i]):
        if not looks.within[i]:
            over = dot(load(looks.face[i], 0), p) - looks.face[i, 0, 3]
            if over >= 0.0:
                looks.until[i] = walked + min(over, looks.flat[i] - sqrt(gone))
                return False, triangle, 0.0, p, lies
        else:
            inside, g, outward = _under_faces(i, p, radius, looks)
            if not inside:
                looks.within[i] = False
                looks.lasts[i] = looks.flat[i] = 0.0
            if g < radius:
                return inside, triangle, g, outward, lies
    if settled and looks.flat[i] <= 0.0 and gone < looks.lasts[i] * abs(looks.lasts[i]):
        if not looks.within[i]:  # has not come to the surface since
            looks.until[i] = walked + looks.lasts[i] - sqrt(gone)
            return False, triangle, 0.0, p, lies
        triangle, q = _followed(i, p, tables)
        if not looks.within[i]:
            looks.lasts[i] = looks.flat[i] = 0.0
    else:
        triangle, q, lies = _look_up(i, p, lies, pose, tables)
        fresh = True
    if not looks.within[i]:
        looks.until[i] = walked + looks.lasts[i]
        return False, triangle, 0.0, p, lies
    g, outward, looks.across[i] = rounded_depth(
        p, q, triangle, lies, radius, tool.grid, tool.around, looks.across[i]
    )
    if fresh:
        _keep_faces(i, p, g, outward, lies, tables)
    return True, triangle, g, outward, lies


@always_inline
def _pressure(
    i: int,
    x: Vec3,
    p: Vec3,
    g: float,
    outward: Vec3,
    dt: float,
    before: Pose,
    pose: Pose,
    tables: ContactTables,
) -> tuple[float, float, float]:
    """Return the force of a carrier along its way out [N], its energy and what it has absorbed.

    x, p : where it is in space and in the body frame [mm].  g, outward : its depth and the way out.
    """
    memory, row = tables.memory, tables.memory.row[i]
    stiffness, g_m = tables.carriers.stiffness[i], tables.law.smoothing_depth
    impact, back = _impact(i, x, p, g, dt, before, tables)
    loaded, absorbed = _loaded_depth(i, g, stiffness, dt, tables)
    magnitude = stiffness * smoothed(loaded, g_m)
    energy = stiffness * smoothed_integral(loaded, g_m)
    spent = energy
    if impact and dt > 0.0:
        pushed, mass = _pushed(i, turn(outward, pose), tables)
        if mass > 0.0:
            into = dot(back, outward)
            spent = memory.work[row] + 0.5 * dot(load(memory.force, row), turn(back, pose))
            magnitude = min(magnitude, largest_rebound(spent, into, pushed, mass, dt))
            spent += 0.5 * magnitude * into
    memory.work[row] = spent
    return magnitude, energy, absorbed


@kernel
def add_press_forces(
    pose: Pose, before: Pose, dt: float, tables: ContactTables, touch: Touch
) -> float:
    """Add the forces of the listed carriers to those of their nodes; return the largest depth [mm].

    Writes the looks, the memory, and touch, see :class:`.press_forces.PressForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    looks, carriers, memory, tool = tables.looks, tables.carriers, tables.memory, tables.tool
    side, edges, clock = memory.side, tables.per_carrier > 1, tables.clock
    if not edges:
        clock.walked[0] += tool_way(pose, before, clock.radius)
        fastest = largest_speed(clock.node, clock.node.shape[0], tables.nodes.velocity_half)
        clock.walked[0] += dt * fastest
    walked = clock.walked[0]
    work = stored = absorbed = deepest = 0.0
    n_touching = 0
    for i in range(memory.row.shape[0]):
        if walked < looks.until[i]:
            continue
        row, one_side, lies = memory.row[i], True, int(side[memory.row[i]])
        if edges:
            one_side, lies = _side_of_ends(i, tables)
            if looks.within[i] and not (one_side and lies == side[row]):
                looks.lasts[i] = looks.flat[i] = 0.0
        x = _place_of(i, tables)
        p = to_body(x, pose)
        inside, triangle, g, outward = False, 0, 0.0, p
        if one_side:
            inside, triangle, g, outward, lies = _see(i, p, lies, walked, pose, tables)
        through = not one_side
        if edges and inside and lies * tool.grid.surface.flank[looks.closest[i, 0]] < 0:
            too_deep = g - tables.law.tool_half_thickness
            through = too_deep > 0.0
            looks.until[i] = walked + _AGAIN * max(too_deep, 0.0)
        if through or (inside and side[row] * lies < 0):
            absorbed += max(memory.work[row], 0.0)
        if through or not inside:
            work += _let_go(i, dt, tables)
            continue
        side[row] = lies
        old, moved = load(memory.force, row), _velocity_of(i, tables)
        magnitude, energy, lost = _pressure(i, x, p, g, outward, dt, before, pose, tables)
        n_touching, stored, absorbed = n_touching + 1, stored + energy, absorbed + lost
        deepest = max(deepest, g - memory.offset[row] if edges else g)
        f = scale(magnitude, turn(outward, pose))
        work += 0.5 * dt * dot(add(old, f), moved)
        store(carriers.normal, i, outward)
        carriers.body[i], carriers.pressure[i] = tool.triangle_body[triangle], magnitude
        _put_on(i, x, f, pose, tables, wrench)
    sums[0], sums[1], sums[2], sums[3], sums[4] = work, absorbed, stored, n_touching, deepest
    return deepest
