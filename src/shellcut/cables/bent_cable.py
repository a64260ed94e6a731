"""A cable with a joint: its length, the directions of its branches and what friction adds.

Around a sharp edge the branches are straight lines in space; a round edge sends them along its
surface (:mod:`shellcut.cables.around_edge`). A joint that slips does so first
(:mod:`shellcut.cables.joint_slip`).
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Floats, Vec3
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add, dot, load, norm, scale, store, sub
from shellcut.tool.pose import Pose, to_body, to_space, turn

from .around_edge import path_around
from .cable_tables import CableRows, CableTables
from .cohesive_law import SHORT_BRANCH
from .joint_slip import drag_on_arc, grip, slide


class Joint(NamedTuple):
    """The joint of a cable at one evaluation, in space."""

    place: Vec3
    """[mm]"""
    moved: Vec3
    """Since the last evaluation, with the tool and along the edge [mm]."""
    slipped: Vec3
    """Of this, along the edge [mm]."""
    moved_minus: Vec3
    moved_plus: Vec3
    """What is fixed to the tool at the ends has moved with it, where the edge is round [mm]."""
    gain_minus: float
    gain_plus: float
    """What friction adds to the branches, over the stress."""


@always_inline
def bend(
    c: int, minus: Vec3, plus: Vec3, pose: Pose, before: Pose, tables: CableTables
) -> tuple[float, Joint]:
    """Return the length measure of a cable with a joint [mm], and the joint.

    Writes the directions of its ends, its joint and its friction.
    """
    cables, edges, joint, belt = tables.cables, tables.edges, tables.joint, 0.0
    slipped = moved_minus = moved_plus = (0.0, 0.0, 0.0)
    if joint.slips:
        body_point = to_space(load(cables.joint_body, c), pose)
        belt = slide(c, to_body(minus, pose), to_body(plus, pose), edges, joint, cables)
    p = to_space(load(cables.joint_body, c), pose)
    if joint.slips:
        slipped = sub(p, body_point)
    moved = sub(p, load(cables.joint, c))
    store(cables.joint, c, p)
    arc = 0.0
    if edges.radius > 0.0:
        at_minus, at_plus = to_body(minus, pose), to_body(plus, pose)
        path = path_around(c, at_minus, at_plus, edges, cables.edge, cables.joint_body)
        ell_minus, ell_plus, arc = path.minus, path.plus, path.arc
        if ell_minus >= tables.law[SHORT_BRANCH]:
            keep_direction(cables.branch, c, 0, turn(path.pull_minus, pose))
        if ell_plus >= tables.law[SHORT_BRANCH]:
            keep_direction(cables.branch, c, 1, turn(path.pull_plus, pose))
        moved_minus = sub(minus, to_space(at_minus, before))
        moved_plus = sub(plus, to_space(at_plus, before))
    else:
        ell_minus, ell_plus = _branch_lengths(c, p, minus, plus, tables.law[SHORT_BRANCH], cables)
    kappa = eta = 0.0
    slack: float = cables.joint_slack[c]
    if belt > 0.0:
        kappa = grip(c, 0.5 * (ell_minus - ell_plus), belt, joint.stick, cables)
        if arc > 0.0:
            cosine = belt / (joint.friction * arc)
            length = ell_minus + ell_plus
            grown = length - slack - cables.opening[c]
            on_round = arc * edges.radius / cosine
            eta = drag_on_arc(c, grown, length, on_round, belt, joint.stick, cables)
    moves = Joint(p, moved, slipped, moved_minus, moved_plus, eta + kappa, eta - kappa)
    return ell_minus + ell_plus - slack, moves


@always_inline
def work_at_edge(on_minus: Vec3, on_plus: Vec3, joint: Joint, radius: float) -> float:
    """Return the work of forces at the edge on a cable whose ends they pull [N·mm]."""
    if radius > 0.0:
        # They act along the branches, not at the joint; that counts where the tool turns.
        by_tool = dot(on_minus, joint.moved_minus) + dot(on_plus, joint.moved_plus)
        return by_tool + dot(add(on_minus, on_plus), joint.slipped)
    return dot(add(on_minus, on_plus), joint.moved)


@always_inline
def _branch_lengths(
    c: int, p: Vec3, minus: Vec3, plus: Vec3, short_branch: float, cables: CableRows
) -> tuple[float, float]:
    """Return the lengths of the branches to a joint at p [mm]; write the directions of the ends."""
    to_minus, to_plus = sub(p, minus), sub(p, plus)
    length_minus, length_plus = norm(to_minus), norm(to_plus)
    # A shorter branch keeps its direction: the bound sigma A / ell on the stiffness stays finite.
    if length_minus >= short_branch:
        keep_direction(cables.branch, c, 0, scale(1.0 / length_minus, to_minus))
    if length_plus >= short_branch:
        keep_direction(cables.branch, c, 1, scale(1.0 / length_plus, to_plus))
    return length_minus, length_plus


@inline
def keep_direction(branch: Floats, c: int, side: int, unit: Vec3) -> None:
    """Write the direction of an end of cable c into branch : (n_cable, 2, 3)."""
    branch[c, side, 0] = unit[0]
    branch[c, side, 1] = unit[1]
    branch[c, side, 2] = unit[2]
