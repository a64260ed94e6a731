"""Where the cutting edge meets a straight cable: there the cable gets its joint.

Let a segment of the cutting edge run from a with unit vector e and length L, and let b be the
normal of the blade's mid-plane there and k the direction into the blade. The edge has met the
cable if a place on it fulfils all of:

1. it is where the cable crosses the mid-plane, (p - a)·b = 0; or the middle of a cable whose ends
   lie on one side, if that is within half a side of a quad of the mid-plane and the flanks face the
   blade, |m·b| > ½: a blade that runs beside the mesh line has such cables before it;
2. the edge has reached it and is not far past it, 0 <= (p - a)·k < ``CUT_DEPTH`` sides of quads;
3. it lies along the segment, 0 <= (p - a)·e <= L, widened by 0.2 of the distance in 2 because the
   strips behind the segments of a curved edge leave wedges between them
   (:func:`shellcut.tool.cutting_edge.strip_coordinates`);
4. the blade is there: below the relief of a tooth a cable passes free, and beside the tooth's end
   face, too (:func:`shellcut.tool.cutting_edge.in_the_blade`).

Of several segments it is the one that has passed it least. This is a test of positions, not of
motions: a cable born with the edge already past is met at once.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import combine, dot, load, norm, store, sub
from shellcut.state import local_edge_length
from shellcut.tool.cutting_edge import (
    BACK,
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

# Of a depth behind the edge, in local edge lengths.
_ROUND_OFF = 1e-6


@always_inline
def has_come_to_edge(c: int, x_minus: Vec3, x_plus: Vec3, pose: Pose, tables: CableTables) -> bool:
    """Return whether an end of cable c has come to a segment of the cutting edge near it.

    Until then the edge cannot have met the cable. It is a test of a few products, for each step.
    """
    edges, segments = tables.edges, tables.edges.segments
    size = local_edge_length(tables.nodes.contact_area[tables.cables.ends[c, 0]])
    reach, deepest, before = _BESIDE_REACH * size, CUT_DEPTH * size, -_ROUND_OFF * size
    minus, plus = to_body(x_minus, pose), to_body(x_plus, pose)
    for run in range(edges.low.shape[0]):
        if not may_own(minus, plus, reach, deepest, run, edges):
            continue
        for k in range(edges.first[run], edges.first[run + 1]):
            a, back = segment_part(segments, k, START), segment_part(segments, k, BACK)
            if max(dot(sub(minus, a), back), dot(sub(plus, a), back)) >= before:
                return True
    return False


@inline
def meet_edge(
    c: int, x_minus: Vec3, x_plus: Vec3, pose: Pose, before: Pose, tables: CableTables
) -> bool:
    """Return whether the cutting edge has met the straight cable c; if so write its joint.

    Works in the body frame of the tool.  Writes edge, joint, slack, transport and overshoot of
    the cable. The joint is written where the tool had this point one step before: so its motion
    over the step is known, and the force at t_n does half of its work on it, as on the nodes.
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
