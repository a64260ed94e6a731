"""Where a point of the film is in the tool: side, depth and exit direction.

The depth is that below the tool with its convex edges rounded (:mod:`shellcut.tool.rounded_depth`).

*Waiting.* A search of the surface holds for a while. A point outside whose closest point of the
surface is q stays outside in front of the plane through q that is square to the line from q to it,
until it has moved in the body frame by its distance from what of the tool lies in front of that
plane, too (:func:`.clear_before_plane`). That of a point inside, whose depth follows from one or
two faces, holds until it has moved so far that another face may count. One clock adds up how far
tool and film may have approached each other: the motion of the tool, and the largest speed of a
listed node times the step. Until it has advanced as far as a point outside may move, not even the
point's place is needed.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Vec3
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add_scaled, dot, load, norm, store, sub
from shellcut.state import KernelNodes, QuadsAtNodes, local_edge_length
from shellcut.tool.cutting_edge import CUT_DEPTH, NORMAL, segment_part, strip_coordinates
from shellcut.tool.pose import Pose, to_body
from shellcut.tool.rounded_depth import depth_under_faces, rounded_depth
from shellcut.tool.signed_distance import (
    at_least,
    ball_clearance,
    clear_before_plane,
    closest_of_side,
    closest_of_solid,
)

from .contact_tables import ContactTables, ContactTool

# Of the radius of rounding: depths that agree so far are the same.
_AGREES = 1e-9

# Of the local edge length: quads whose mean centre is farther from the mid-plane lie beside it.
_CLEARLY_BESIDE = 0.15


@always_inline
def depth_in_tool(
    i: int, p: Vec3, side: int, walked: float, pose: Pose, tables: ContactTables
) -> tuple[bool, int, int, float, Vec3, int]:
    """Return inside, the closest triangle of all, that of its side, depth, outward, and the side.

    Depth [mm] and outward direction are those of the rounded surface at the triangle of its side.
    Of a point outside only the first and the last mean anything. A node without a side gets one
    when it is first inside.

    p : in the body frame, [mm].  side : so far; +1 or -1 of the blade, along the normal of its
    mid-plane, 0 of none.  walked : on the clock [mm].  Writes the point's query.
    """
    tool, queries, grid = tables.tool, tables.queries, tables.tool.grid
    radius = tables.law.rounding
    one, two = queries.face[i, 0], queries.face[i, 1]
    moved, gap = sub(p, load(queries.place, i)), load(queries.gap, i)
    rest, away = queries.free[i] - norm(moved), norm(gap)
    if one < 0 and away > 0.0:
        rest = min(rest, away + dot(gap, moved) / away - tool.round_off)
    if rest > 0.0:
        if one < 0:
            queries.until[i] = walked + rest
            return False, 0, 0, 0.0, p, side
        if side == tables.memory.side[tables.memory.row[i]]:
            known, g, outward = depth_under_faces(p, one, two, radius, grid)
            # Deeper than that, the other side of the blade may be closer.
            if known and g < tables.law.tool_half_thickness:
                return True, one, one, g, outward, side
    store(queries.place, i, p)
    queries.free[i], queries.face[i, 0], queries.until[i] = 0.0, -1, walked
    found, inside, whole, q = closest_of_solid(p, grid)
    if not inside:
        gap = sub(p, q)  # of what is not found, 0
        away = norm(gap) if found else at_least(p, tool.reach, grid.cells, tool.empty_around)
        free = max(clear_before_plane(p, q, grid), away) if found else away
        store(queries.gap, i, gap)
        queries.free[i], queries.until[i] = free - tool.round_off, walked + away - tool.round_off
        return False, whole, whole, 0.0, p, side
    flank, triangle = grid.surface.flank, whole
    if side == 0 and not tables.on_border:
        side = _side_of_quads(
            tables.contact_points.node[i, 0], pose, tool, tables.nodes, tables.around
        )
        side = int(flank[whole]) if side == 0 else side
    # The film may be pushed in deeper than the blade is thick: what lies on a flank stays there.
    if side * flank[whole] < 0:
        _, triangle, _, q = closest_of_side(p, side, grid)
    g, outward, other = rounded_depth(p, q, triangle, side, radius, grid)
    # A node without a side may get one in the next step.
    if whole == triangle and other >= 0 and (side != 0 or tables.on_border):
        _keep_faces(i, p, g, outward, triangle, other, side, tables)
    return True, whole, triangle, g, outward, side


@inline
def _keep_faces(
    i: int,
    p: Vec3,
    g: float,
    outward: Vec3,
    one: int,
    two: int,
    side: int,
    tables: ContactTables,
) -> None:
    """Write the faces that give a point its depth, and how long they do.

    p : in the body frame, inside.  g, outward : its depth and outward direction [mm].
    """
    queries, grid, radius = tables.queries, tables.tool.grid, tables.law.rounding
    known, again, _ = depth_under_faces(p, one, two, radius, grid)
    # At a concave edge the closest point is no foot on a plane.
    if not known or abs(again - g) > _AGREES * radius:
        return
    centre = add_scaled(p, g - radius, outward)
    free = ball_clearance(centre, radius, p, one, two, side, grid) - tables.tool.round_off
    if free > 0.0:
        queries.free[i] = free
        queries.face[i, 0], queries.face[i, 1] = one, two


@inline
def _side_of_quads(
    n: int, pose: Pose, tool: ContactTool, nodes: KernelNodes, around: QuadsAtNodes
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
    centre, sum_of_shares = (0.0, 0.0, 0.0), 0.0
    for i in range(around.n_at[n]):
        sum_of_shares += around.share[around.at[n, i]]
    for i in range(around.n_at[n]):
        row = around.at[n, i]
        share = around.share[row] / sum_of_shares
        for a in range(4):
            other, weight = around.quads[row, a], share * around.centre[row, a]
            centre = add_scaled(centre, weight, load(x, other))
    gap = sub(to_body(centre, pose), here)
    beside = dot(gap, segment_part(segments, k_best, NORMAL))
    if abs(beside) < _CLEARLY_BESIDE * size:
        return 0
    return 1 if beside > 0.0 else -1
