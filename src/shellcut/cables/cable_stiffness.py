"""The stiffness of cables on the nodes, for the bound on the step.

Across its direction a straight cable has the stiffness sigma A / (ell + delta_0), a branch sigma A
/ ell^±; along it both have the slope of unloading times A. A straight cable acts on two nodes that
may move against each other: twice that on each. Friction around the edge adds sigma A kappa / stick
along the branches. A cable between nodes is no stiffer than shares of it at them
(:func:`shellcut.fracture.flank_points.hand_on_stiffness`).
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallInts
from shellcut.numerics.jit import kernel
from shellcut.numerics.vec3 import combine, load, norm, sub
from shellcut.state import BROKEN, JOINTED

from .cohesive_law import CohesiveTable, envelope, unloading_slope


class CableColumns(NamedTuple):
    """What is needed of the cables, by the names of :class:`shellcut.state.CableTable`."""

    ends: Annotated[Ints, "(n_cable, 2)"]
    far: Annotated[Ints, "(n_cable, 2)"]
    share: Annotated[Floats, "(n_cable,)"]
    area: Annotated[Floats, "(n_cable,)"]
    status: Annotated[SmallInts, "(n_cable,)"]
    opening: Annotated[Floats, "(n_cable,)"]
    opening_max: Annotated[Floats, "(n_cable,)"]
    traction: Annotated[Floats, "(n_cable,)"]
    joint: Annotated[Floats, "(n_cable, 3)"]


class Compliance(NamedTuple):
    """Lengths over which their forces turn or set in [mm], and how tightly they may grip."""

    sharpest: float
    """Least of a straight cable."""
    short_branch: float
    """Least of a branch."""
    stick: float
    """Sliding distance of a cable around the edge over which friction sets in."""
    grip: float
    """Largest kappa."""

    @classmethod
    def of(cls, law: CohesiveTable, grip: float) -> Compliance:
        """Return that of a law."""
        return cls(max(law.onset, law.short_branch), law.short_branch, law.stick, grip)


@kernel
def cable_stiffness(
    count: int,
    x: Floats,
    cables: CableColumns,
    law: Floats,
    at_edge: Floats,
    within: Compliance,
    node: Ints,
    stiffness: Floats,
) -> int:
    """Write the ends of the first ``count`` cables that carry, and bounds of stiffness [N/mm].

    x : of the nodes (n_node, 3).  law, at_edge : of straight and jointed cables, from
    :meth:`CohesiveTable.parameters`.  node, stiffness : (4 n_cable,), written; returns how many.
    """
    n = 0
    for c in range(count):
        if cables.status[c] == BROKEN:
            continue
        jointed = cables.status[c] == JOINTED
        of = at_edge if jointed else law
        area, most = cables.area[c], max(cables.opening_max[c], 0.0)
        peak = envelope(most, of)
        slope = area * unloading_slope(peak, most, of) if peak > 0.0 else 0.0
        if np.isinf(slope):
            # The literal form is rigid at birth: no step is safe for its very first instant.
            slope = 0.0
        pull = area * cables.traction[c] * (1.0 + within.grip)
        for side in range(2):
            here, there, share = cables.ends[c, side], cables.far[c, side], cables.share[c]
            if jointed:
                end = combine(1.0 - share, load(x, here), share, load(x, there))
                branch = max(norm(sub(load(cables.joint, c), end)), within.short_branch)
                # Across the branch pull over length, along it the unloading; friction adds to that.
                k = max(pull / branch, slope) + pull * within.grip / within.stick
            else:
                # Both nodes may move against each other: twice the stiffness on each.
                k = 2.0 * max(pull / (max(cables.opening[c], 0.0) + within.sharpest), slope)
            # Where both flanks are at one node, at a tip, the cable acts on nothing.
            if share < 1.0 and cables.ends[c, 0] != cables.ends[c, 1]:
                node[n], stiffness[n] = here, (1.0 - share) * k
                n += 1
            if share > 0.0 and cables.far[c, 0] != cables.far[c, 1]:
                node[n], stiffness[n] = there, share * k
                n += 1
    return n
