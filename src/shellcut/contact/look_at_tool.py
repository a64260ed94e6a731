"""Where a point of the film is in the tool: side, depth and way out, and how long that holds.

The depth is that below the tool with its convex edges rounded (:mod:`shellcut.tool.rounded_depth`).

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

from shellcut.arrays import Vec3
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add_scaled, combine, dot, load, norm, scale, store, sub
from shellcut.state import QuadsAtNodes, local_edge_length
from shellcut.tool.cutting_edge import CUT_DEPTH, NORMAL, segment_part, strip_coordinates
from shellcut.tool.pose import Pose, to_body
from shellcut.tool.rounded_depth import rounded_depth
from shellcut.tool.signed_distance import (
    at_least,
    clear_for,
    closest_of_side,
    over_only_for,
    signed_distance_to,
    within_edges,
)

from .contact_tables import ContactNodes, ContactTables, ContactTool, Looks

# Of the local edge length: quads whose mean centre is farther from the mid-plane lie beside it.
_CLEARLY_BESIDE = 0.15

# Cosine of an angle between normals that is none.
_SAME = 1.0 - 1e-12

# Of the radius: depths that agree so far are one.
_AGREES = 1e-9


@always_inline
def see(
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
    settled = tables.on_edges or lies != 0 or not looks.within[i]
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
        # Where its last look-up holds, the closest triangle is the same.
        surface = tool.grid.surface
        looks.within[i], q = signed_distance_to(p, looks.closest[i, 0], triangle, surface)
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
    normal = load(grid.surface.pseudo_normals[triangle], feature)
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
    if side == 0 and not tables.on_edges:
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
