r"""Slip of a joint: what a cable does where it is bent around the cutting edge.

The joint is massless, and the cable bears on the edge in a bend that turns its direction, seen
along the edge, by the angle phi. With the unit vector e along the edge, an end of the cable lies at
the place s^± along it and at the distance rho^± from it; l^± is the length of that branch, and

    sin theta^± = (s^± - s)/l^±,    cos theta^± = rho^±/l^±

tell how it leans along the edge when the joint is at s. A branch of tension T^± pulls the joint by
T^± sin theta^± along the edge and by T^± cos theta^± across it.

**Friction in the bend.** Let the bend be an arc of radius r, however small. A tension T that leans
by theta presses on it with T cos²theta / r per length, and a piece of the angle d phi has the
length r d phi / cos theta. With C = T cos theta and S = T sin theta, the pulls across and along,
Coulomb friction mu in the direction psi of the slip changes them by

    dC = -mu C cos(psi) d phi,    dS = -mu C sin(psi) d phi,

whatever r is. Slip along the edge only (psi = 90°) leaves C as it is and takes mu C phi off S; slip
around it only (psi = 0) is Euler's belt, ln(C^-/C^+) = mu phi. The two are taken one beside the
other, each with its own limit: together they may reach sqrt(2) times the friction of one slip in a
direction between them.

**Along the edge**, with C the mean of both branches, the joint rests as long as

    |sin theta^- + sin theta^+| <= mu phi (cos theta^- + cos theta^+)/2.

Otherwise it slips until this is an equality. The left side is -d(l^- + l^+)/ds and falls steadily
with s, as a length to a line is convex; so the place is unique, lies between the old one and that
without friction, and does not depend on the step or on a stiffness. Without friction it is the
shortest path around the edge, s = (s^- rho^+ + s^+ rho^-)/(rho^- + rho^+). At a vertex of the edge
the joint continues to the next segment; at the open end of an edge it stays. The work T (sin
theta^- + sin theta^+) ds of the slip is friction's.

**Around the edge** the law gives the mean tension, T = sigma A, and friction a difference of the
two, T^± = T (1 -+ kappa), so that with the transport u = (l^- - l^+)/2 of cable around the edge

    T^- dl^- + T^+ dl^+ = T dl + 2 T kappa du :

the first part is done against the law, the second to friction. Euler's belt limits kappa to tanh(mu
phi cos(theta)/2), which it reaches over the sliding distance ``stick``: kappa grows with u by that
limit over ``stick``, and stays at the limit. (Rigid sticking would tie two nodes to each other.)

**On an arc of some length** a cable that is drawn out slides on the round, too. Let it stretch
evenly, so that the point x from the middle of the arc b = r phi/cos(theta) slides by x dl/l:
outwards, against friction, and the tension grows from the nose to both tangent points as exp(mu
cos(theta) beta). The law gives the mean of the tension over the cable's whole length l, so that the
branches carry T (1 + eta) with

    eta = b (1 - q)/(l - b (1 - q)),    q = (1 - exp(-B/2))/(B/2),    B = mu phi cos(theta),

about mu r phi²/(4 l) for a small radius; while the cable shortens, B changes its sign. The work
T eta dl is friction's. Over a steady cut it adds int sigma eta dl / G to F/(G h), which grows from
0 in proportion to r. It sets in over ``stick`` as well, as half of the arc slides by b dl/(2 l).

A steady cut by a straight edge that moves with the speed v across itself and xi v along itself
leaves cables whose branches are parallel, phi = pi, and lean by tan theta = min(xi, mu pi/2) = rho.
The work of the law, G h v, is then V v + rho H v with H = rho V, so

    V = G h/(1 + rho²),    H = G h rho/(1 + rho²),    friction H (xi - rho) v.

Perfect adhesion has rho = xi, which is Atkins' result, and free slip rho = 0.
"""

from __future__ import annotations

from math import exp, sqrt, tanh

import numpy as np

from shellcut.arrays import Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import combine, dot, load, norm, store, sub
from shellcut.tool.cutting_edge import START, VECTOR, CuttingEdges, segment_part
from shellcut.tool.tool import Tool

from .around_edge import Bend, bend_at
from .cable_tables import CableRows, JointLaw
from .cohesive_law import CohesiveTable

# Of the search for the place of a joint: ten turns are usual, and below this part of the lengths
# there is only round-off.
_MOST_TURNS = 100
_CLOSE = 1e-13


def joint_law(law: CohesiveTable, tool: Tool | None) -> JointLaw:
    """Return what the kernel needs to know of the joints."""
    friction = law.joint_friction if law.joint == "slip" else 0.0
    return JointLaw(law.joint != "adhesion", friction, law.stick, neighbours(tool))


def neighbours(tool: Tool | None) -> Ints:
    """Return the segments before and after each one of its chain, shape (n_edge, 2).

    -1 at an open end.
    """
    if tool is None:
        return np.zeros((0, 2), np.int64)
    rows = np.arange(tool.n_edge)
    onward = np.column_stack([rows - 1, rows + 1])
    for chain in tool.chains():
        mine = rows[tool.edge_chain == chain.chain]
        first, last = mine[0], mine[-1]
        onward[first, 0] = last if chain.closed else -1
        onward[last, 1] = first if chain.closed else -1
    return onward


@always_inline
def _lean(s: float, bend: Bend) -> tuple[float, float]:
    """Return sin theta^- + sin theta^+ and the mean of their cosines for a joint at s."""
    pull = cosine = 0.0
    for end in (bend.minus, bend.plus):
        along, across = end.place - s, end.rho
        length = sqrt(along * along + across * across)
        if length > 0.0:
            pull += along / length
            cosine += 0.5 * across / length
    return pull, cosine


@inline
def place_on_line(s: float, bend: Bend, friction: float) -> float:
    """Return where on the line of its segment a joint that was at s stops [mm]."""
    pull, cosine = _lean(s, bend)
    grip = friction * bend.turn
    if abs(pull) <= grip * cosine:
        return s
    across = bend.minus.rho + bend.plus.rho
    if across == 0.0:
        return s
    free = (bend.minus.place * bend.plus.rho + bend.plus.place * bend.minus.rho) / across
    if grip == 0.0:
        return free
    # Between a, where it slips, and b, where it does not: false position, Illinois variant.
    sign = 1.0 if pull > 0.0 else -1.0
    a, b = s, free
    f_a = abs(pull) - grip * cosine
    pull, cosine = _lean(b, bend)
    f_b = sign * pull - grip * cosine
    moved = 0
    for _ in range(_MOST_TURNS):
        if not f_b < 0.0 or abs(b - a) <= _CLOSE * (abs(a) + abs(b) + across):
            break
        middle = (a * f_b - b * f_a) / (f_b - f_a)
        pull, cosine = _lean(middle, bend)
        f = sign * pull - grip * cosine
        if f > 0.0:
            a, f_a = middle, f
            f_b *= 0.5 if moved > 0 else 1.0
            moved = 1
        else:
            b, f_b = middle, f
            f_a *= 0.5 if moved < 0 else 1.0
            moved = -1
    return b


@inline
def slide(
    c: int, minus: Vec3, plus: Vec3, edges: CuttingEdges, joint: JointLaw, cables: CableRows
) -> float:
    """Let the joint of cable c slip along the edge; return mu phi cos(theta) of its place.

    minus, plus : ends of the cable in the body frame [mm].  Writes edge and joint_body.
    """
    edges, joint, cables = borrowed(edges), borrowed(joint), borrowed(cables)
    segments = edges.segments
    k = cables.edge[c]
    start, v = segment_part(segments, k, START), segment_part(segments, k, VECTOR)
    s = dot(sub(load(cables.joint_body, c), start), v) / norm(v)
    before = s
    heading = 0
    for _ in range(segments.shape[0] + 1):
        length = norm(segment_part(segments, k, VECTOR))
        bend = bend_at(minus, plus, k, edges)
        goal = place_on_line(s, bend, joint.friction)
        if (goal - s) * heading < 0.0:
            break  # a vertex that both segments slide towards
        if 0.0 <= goal <= length:
            s = goal
            break
        heading = 1 if goal > length else -1
        s = length if heading > 0 else 0.0
        onward = joint.onward[k, 1 if heading > 0 else 0]
        if onward < 0:
            break
        k = onward
        s = 0.0 if heading > 0 else norm(segment_part(segments, k, VECTOR))
    if s != before or k != cables.edge[c]:
        v = segment_part(segments, k, VECTOR)
        store(cables.joint_body, c, combine(1.0, segment_part(segments, k, START), s / norm(v), v))
        cables.edge[c] = k
    bend = bend_at(minus, plus, k, edges)
    _, cosine = _lean(s, bend)
    belt: float = joint.friction * bend.turn * cosine
    return belt


@always_inline
def grip(c: int, transport: float, belt: float, stick: float, cables: CableRows) -> float:
    """Return kappa of cable c after its transport u around the edge; write both.

    belt : mu phi cos(theta), the logarithm of the largest ratio of the two tensions.
    """
    limit = tanh(0.5 * belt)
    kappa: float = cables.grip[c] + limit * (transport - cables.transport[c]) / stick
    kappa = min(max(kappa, -limit), limit)
    cables.grip[c], cables.transport[c] = kappa, transport
    return kappa


@always_inline
def drag_on_arc(
    c: int, grown: float, length: float, arc: float, belt: float, stick: float, cables: CableRows
) -> float:
    """Return eta of cable c, which has grown by ``grown`` to ``length`` [mm]; write it.

    arc : length of it on the round [mm].  belt : mu phi cos(theta).
    """
    half = 0.5 * belt
    most = arc * (1.0 - (1.0 - exp(-half)) / half)
    least = arc * (1.0 - (exp(half) - 1.0) / half)
    most, least = most / (length - most), least / (length - least)
    eta: float = cables.arc_grip[c] + most * 0.5 * arc * grown / (length * stick)
    eta = min(max(eta, least), most)
    cables.arc_grip[c] = eta
    return eta
