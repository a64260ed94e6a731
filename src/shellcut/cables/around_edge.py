r"""The path of a cable around the cutting edge, sharp or with a radius.

Look along the edge, with e towards the viewer and the joint at the origin. The axis b points to the
side of one end of the cable, k into the blade. That end is at (y, z), at the distance a along e.

*Sharp edge.* The branch is the straight line of length l = sqrt(rho² + a²), rho = |(y, z)|.

*Edge of radius r.* The round is the cylinder about (0, r); the joint lies on its nose line. Each
branch follows the shortest path from the joint to its end outside the cylinder, which is straight
on the surface unrolled: it winds along the round up to the tangent point and is straight from
there,

    rho = r beta + t,    t = sqrt(D² - r²),    beta = atan2(y, r - z) - arccos(r/D),

with D the distance of the end from the cylinder's axis, and again l = sqrt(rho² + a²). An end that
is before the tangent plane of the nose, beta <= 0, is met by the straight line. The force on the
end is along the straight part; it is the gradient of l, because the change of the arc makes up for
that of t. An end that contact lets into the round, D < r, counts as if it lay on the surface over
its place, t = 0, and the gradient of r beta is r/D across the radius. The turn of the cable on this
side is beta, or for the straight line atan2(z, y).

As the end moves across the cable, the pull turns about the tangent point, by 1/t a mm; in the round
by r/D². With the lean along e this *arm*, t, D²/r or rho of a straight line, is min(arm · l/rho,
l). In the round the gradient of rho is g = r/D > 1, and the pull changes by no more than
rho/(arm l) + g²/l.

So r enters only rho, the arm, the direction of the pull and the turn, and with r = 0 these are
those of the sharp edge. Both branches carry sigma(l^- + l^+ - slack) A, as there: without friction
a steady cut needs G h whatever r is, as all of the work is still done against the law.
"""

from __future__ import annotations

from math import acos, atan2, cos, pi, sin, sqrt
from typing import NamedTuple

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.jit import always_inline
from shellcut.numerics.vec3 import combine, dot, load, norm, sub
from shellcut.tool.cutting_edge import BACK, NORMAL, START, VECTOR, CuttingEdges, segment_part

IN_THE_ROUND = 1.0 + 1e-9
"""Square of the pull from which on an end is in the round: 1 outside, to round-off."""


class Branch(NamedTuple):
    """One side of a cable, seen along the edge."""

    place: float
    """Of the end along the segment [mm]."""
    rho: float
    """Length of the path, seen along the edge [mm]."""
    turn: float
    """By which the edge turns it [rad]."""
    arm: float
    """Over which the end turns the pull, seen along the edge [mm]."""
    pull: tuple[float, float]
    """Minus the gradient of rho, parts along b and k of the segment; 1 long outside the round."""


@always_inline
def branch_to(end: Vec3, side: float, k: int, edges: CuttingEdges) -> Branch:
    """Return the branch from a joint on segment k to an end, all in the body frame.

    side : +1 for the end on the side that b points to, else -1.
    """
    segments = edges.segments
    v, d = segment_part(segments, k, VECTOR), sub(end, segment_part(segments, k, START))
    place = dot(d, v) / norm(v)
    y = side * dot(d, segment_part(segments, k, NORMAL))
    z = dot(d, segment_part(segments, k, BACK))
    r = edges.radius
    if r > 0.0:
        from_axis = sqrt(y * y + (r - z) * (r - z))
        around = atan2(y, r - z)
        if around < -0.5 * pi:  # behind the round, across the mid-plane
            around += 2.0 * pi
        beta = around - (acos(r / from_axis) if from_axis > r else 0.0)
        if beta > 0.0:
            t = sqrt(max(from_axis * from_axis - r * r, 0.0))
            inside = 0.0 < from_axis < r
            pull = r / from_axis if inside else 1.0
            pulls = -side * pull * cos(beta), -pull * sin(beta)
            arm = from_axis / pull if inside else t
            return Branch(place, r * beta + t, beta, arm, pulls)
    rho = sqrt(y * y + z * z)
    inverse = 1.0 / rho if rho > 0.0 else 0.0
    return Branch(place, rho, atan2(z, y), rho, (-side * y * inverse, -z * inverse))


class Bend(NamedTuple):
    """A cable seen from a segment of the edge."""

    minus: Branch
    plus: Branch
    turn: float
    """phi [rad]."""


@always_inline
def bend_at(minus: Vec3, plus: Vec3, k: int, edges: CuttingEdges) -> Bend:
    """Return how a cable from minus to plus, in the body frame, is bent around segment k."""
    # +1 if the plus end is on the side that b of the segment points to.
    ahead = dot(sub(plus, minus), segment_part(edges.segments, k, NORMAL))
    side = 1.0 if ahead >= 0.0 else -1.0
    first, second = branch_to(minus, -side, k, edges), branch_to(plus, side, k, edges)
    return Bend(first, second, max(first.turn + second.turn, 0.0))


@always_inline
def path_to(branch: Branch, s: float, k: int, edges: CuttingEdges) -> tuple[float, float, Vec3]:
    """Return length and arm of a branch to a joint at s along segment k, and minus its gradient.

    The gradient is that by the place of the end, in the body frame; its length is 1 but for an end
    in the round.
    """
    segments, along = edges.segments, s - branch.place
    v = segment_part(segments, k, VECTOR)
    length = sqrt(branch.rho * branch.rho + along * along)
    share = branch.rho / length if length > 0.0 else 0.0
    across = combine(
        share * branch.pull[0],
        segment_part(segments, k, NORMAL),
        share * branch.pull[1],
        segment_part(segments, k, BACK),
    )
    lean = along / length if length > 0.0 else 0.0
    steep = branch.pull[0] ** 2 + branch.pull[1] ** 2
    if steep > IN_THE_ROUND:
        arm = 1.0 / (share / branch.arm + steep / length)
    else:
        arm = min(branch.arm / share, length) if share > 0.0 else length
    return length, arm, combine(1.0, across, lean / norm(v), v)


class CablePath(NamedTuple):
    """A cable around the edge, with its joint at some point of it."""

    minus: float
    plus: float
    """Lengths of the branches [mm]."""
    arm_minus: float
    arm_plus: float
    """Over which the ends turn the pull [mm]."""
    pull_minus: Vec3
    pull_plus: Vec3
    """At the ends, along the branches, in the body frame; 1 long but for ends in the round."""
    arc: float
    """Angle that lies on the round [rad]."""


@always_inline
def path_around(
    c: int, minus: Vec3, plus: Vec3, edges: CuttingEdges, edge: Ints, joint_body: Floats
) -> CablePath:
    """Return the path of cable c from minus to plus, in the body frame.

    edge, joint_body : segment and joint of each cable, as in the state.
    """
    k = edge[c]
    bend = bend_at(minus, plus, k, edges)
    v = segment_part(edges.segments, k, VECTOR)
    s = dot(sub(load(joint_body, c), segment_part(edges.segments, k, START)), v) / norm(v)
    length_minus, arm_minus, pull_minus = path_to(bend.minus, s, k, edges)
    length_plus, arm_plus, pull_plus = path_to(bend.plus, s, k, edges)
    arc = max(bend.minus.turn, 0.0) + max(bend.plus.turn, 0.0)
    return CablePath(length_minus, length_plus, arm_minus, arm_plus, pull_minus, pull_plus, arc)
