"""A cable with a joint: its length, the directions of its branches and what friction adds.

Around a sharp edge the branches are straight lines in space; a round edge sends them along its
surface (:mod:`shellcut.cables.around_edge`). A joint that slips does so first
(:mod:`shellcut.cables.joint_slip`).
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Vec3
from shellcut.numerics.jit import always_inline
from shellcut.numerics.vec3 import add, dot, load, norm, scale, store, sub
from shellcut.tool.pose import Pose, to_body, to_space, turn

from .around_edge import path_around
from .cable_tables import CableTables
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
        arm_minus, arm_plus = path.arm_minus, path.arm_plus
        along_minus, along_plus = turn(path.pull_minus, pose), turn(path.pull_plus, pose)
        moved_minus = sub(minus, to_space(at_minus, before))
        moved_plus = sub(plus, to_space(at_plus, before))
    else:
        to_minus, to_plus = sub(p, minus), sub(p, plus)
        ell_minus, ell_plus = norm(to_minus), norm(to_plus)
        arm_minus, arm_plus = ell_minus, ell_plus
        along_minus, along_plus = scale(1.0 / ell_minus, to_minus), scale(1.0 / ell_plus, to_plus)
    # A shorter one keeps its direction: the bound sigma A / arm on the stiffness stays finite.
    if arm_minus >= tables.law[SHORT_BRANCH]:
        store(cables.branch[c], 0, along_minus)
    if arm_plus >= tables.law[SHORT_BRANCH]:
        store(cables.branch[c], 1, along_plus)
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
