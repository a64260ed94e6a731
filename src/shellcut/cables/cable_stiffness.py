"""The stiffness of cables on the nodes, for the bound on the step.

Across its direction a straight cable has the stiffness sigma A / (ell + delta_0), a branch sigma A
over its length, or over its arm where the edge is round (:mod:`.around_edge`); along it both have
the slope of unloading times A. A straight cable acts on two nodes that may move against each other:
twice that on each. Friction around the edge adds sigma A kappa / stick along the branches. A cable
between nodes is no stiffer than shares of it at them
(:func:`shellcut.fracture.flank_points.hand_on_stiffness`).
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import dot, load, norm, sub
from shellcut.state import BROKEN, JOINTED
from shellcut.tool.pose import Pose, to_body

from .around_edge import IN_THE_ROUND, path_around
from .cable_tables import CableTables, at_end
from .cohesive_law import ONSET, SHORT_BRANCH, envelope, unloading_slope


@kernel
def cable_stiffness(
    tables: CableTables, pose: Pose, grip: float, node: Ints, stiffness: Floats
) -> int:
    """Write the ends of the cables that carry, and bounds of stiffness [N/mm].

    pose : of the tool.  grip : largest eta + kappa.  node, stiffness : (4 n_cable,), written;
    returns how many.
    """
    tables = borrowed(tables)
    cables, short_branch = tables.cables, tables.law[SHORT_BRANCH]
    n = 0
    for c in range(tables.n_cable):
        if cables.status[c] == BROKEN:
            continue
        jointed = cables.status[c] == JOINTED
        of = tables.at_edge if jointed else tables.law
        area, most = cables.area[c], max(cables.opening_max[c], 0.0)
        peak = envelope(most, of)
        slope = area * unloading_slope(peak, most, of) if peak > 0.0 else 0.0
        if np.isinf(slope):
            # The literal form is rigid at birth: no step is safe for its very first instant.
            slope = 0.0
        pull = area * cables.traction[c] * (1.0 + grip)
        arms = _arms(c, pose, tables) if jointed else (0.0, 0.0)
        for side in range(2):
            here, there, share = cables.ends[c, side], cables.far[c, side], cables.share[c]
            if jointed:
                arm = max(arms[side], short_branch)
                along = load(cables.branch[c], side)
                steep = dot(along, along)
                # Across the branch pull over arm, along it the unloading. In the round these
                # directions are not normal to each other. Friction adds to that.
                k = max(pull / arm, slope) if steep < IN_THE_ROUND else pull / arm + steep * slope
                k += pull * grip / tables.joint.stick
            else:
                # Both nodes may move against each other: twice the stiffness on each.
                length = max(cables.opening[c], 0.0) + max(tables.law[ONSET], short_branch)
                k = 2.0 * max(pull / length, slope)
            # Where both flanks are at one node, at a tip, the cable acts on nothing.
            if share < 1.0 and cables.ends[c, 0] != cables.ends[c, 1]:
                node[n], stiffness[n] = here, (1.0 - share) * k
                n += 1
            if share > 0.0 and cables.far[c, 0] != cables.far[c, 1]:
                node[n], stiffness[n] = there, share * k
                n += 1
    return n


@inline
def _arms(c: int, pose: Pose, tables: CableTables) -> tuple[float, float]:
    """Return over which lengths the ends of a cable with a joint turn its pull [mm]."""
    cables, edges = tables.cables, tables.edges
    minus, plus = at_end(c, 0, tables.nodes.x, cables), at_end(c, 1, tables.nodes.x, cables)
    if edges.radius > 0.0:
        minus, plus = to_body(minus, pose), to_body(plus, pose)
        path = path_around(c, minus, plus, edges, cables.edge, cables.joint_body)
        return path.arm_minus, path.arm_plus
    joint = load(cables.joint, c)
    return norm(sub(joint, minus)), norm(sub(joint, plus))
