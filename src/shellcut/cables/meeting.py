"""Where the cutting edge meets a straight cable: there the cable gets its joint.

Let a segment of the cutting edge run from a with unit vector e, and let b be the normal of the
blade's mid-plane there and k the direction into the blade. The cable straddles the mid-plane where
its ends have (p - a)·b of opposite sign, and crosses it at c. The edge has met the cable when c
lies along the segment, 0 <= (c - a)·e <= L, the edge has reached it, 0 <= (c - a)·k, and the blade
is there: below the relief of a tooth a cable passes free (:mod:`shellcut.tool.cutting_edge`). This
is a test of positions, not of motions: a cable born with the edge already past is caught at once. A
blade that runs beside the mesh line has the whole cable on one side, although its *flanks* lie on
either side of it: a cable within half an edge length of the mid-plane, whose m is along b rather
than along the blade, is met too, at its middle.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import combine, dot, load, norm, store, sub
from shellcut.state import local_edge_length
from shellcut.tool.cutting_edge import (
    CUT_DEPTH,
    NORMAL,
    START,
    edge_point,
    in_the_blade,
    may_own,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.pose import Pose, to_body, to_space, turn_back

from .around_edge import path_around
from .cable_tables import CableTables
from .cohesive_law import ONSET
from .joint_slip import slide

# A cable beside the blade belongs to the row that the blade cuts if it lies within this fraction of
# the local edge length sqrt(quad area), and if its flanks face the blade: |m · b| above cos 60°.
_BESIDE_REACH = 0.5
_FACING = 0.5


@inline
def find_joint(
    c: int, x_minus: Vec3, x_plus: Vec3, pose: Pose, before: Pose, tables: CableTables
) -> bool:
    """Bend the straight cable c around the cutting edge if that has reached it; return whether.

    Works in the body frame of the tool.  Writes edge, joint, slack, transport and overshoot of
    the cable. The joint is written where the tool had its point a step before: the force of t_n
    acts on the motion of the step by half, at the joint as at the nodes and on the tool.
    """
    tables = borrowed(tables)
    edges, cables = tables.edges, tables.cables
    segments, m = edges.segments, load(cables.m, c)
    size = local_edge_length(tables.nodes.contact_area[cables.ends[c, 0]])
    reach, deepest = _BESIDE_REACH * size, CUT_DEPTH * size
    minus = to_body(x_minus, pose)
    plus = to_body(x_plus, pose)
    across = turn_back(m, pose)
    shallowest = np.inf
    for run in range(edges.low.shape[0]):
        if not may_own(minus, plus, reach, deepest, run, edges):
            continue
        for k in range(edges.first[run], edges.first[run + 1]):
            a = segment_part(segments, k, START)
            b = segment_part(segments, k, NORMAL)
            side_minus = dot(sub(minus, a), b)
            side_plus = dot(sub(plus, a), b)
            share = 0.5
            if side_minus * side_plus <= 0.0:
                gap = side_minus - side_plus
                share = side_minus / gap if gap != 0.0 else 0.5
            elif 0.5 * abs(side_minus + side_plus) > reach or abs(dot(across, b)) < _FACING:
                continue
            crossing = combine(1.0 - share, minus, share, plus)
            along, lateral, depth, owns = strip_coordinates(crossing, k, segments, deepest)
            if not owns or depth >= shallowest:
                continue
            if not in_the_blade(crossing, lateral, k, edges):
                continue
            shallowest = depth
            cables.edge[c] = k
            cables.overshoot[c] = depth
            store(cables.joint_body, c, edge_point(along, k, segments))
    if not shallowest < np.inf:
        return False
    if tables.joint.slips:
        slide(c, minus, plus, edges, tables.joint, cables)
    p = to_space(load(cables.joint_body, c), pose)
    store(cables.joint, c, to_space(load(cables.joint_body, c), before))
    to_minus, to_plus = norm(sub(p, x_minus)), norm(sub(p, x_plus))
    if edges.radius > 0.0:
        path = path_around(c, minus, plus, edges, cables.edge, cables.joint_body)
        to_minus, to_plus = path.minus, path.plus
    straight = norm(combine(1.0, sub(x_plus, x_minus), tables.law[ONSET], m)) - tables.law[ONSET]
    cables.joint_slack[c] = to_minus + to_plus - straight
    cables.transport[c] = 0.5 * (to_minus - to_plus)
    return True
