"""Arguments of the kernel of the cables, in named tables."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from shellcut.arrays import Floats, Ints, SmallInts, Vec3
from shellcut.numerics.jit import always_inline
from shellcut.numerics.vec3 import combine, load
from shellcut.state import KernelNodes
from shellcut.tool.cutting_edge import CuttingEdges


class CableRows(NamedTuple):
    """What it needs of the cables, by the names of :class:`shellcut.state.CableTable`."""

    ends: Annotated[Ints, "(n_cable, 2)"]
    far: Annotated[Ints, "(n_cable, 2)"]
    share: Annotated[Floats, "(n_cable,)"]
    area: Annotated[Floats, "(n_cable,)"]
    m: Annotated[Floats, "(n_cable, 3)"]
    start_force: Annotated[Floats, "(n_cable, 3)"]
    status: Annotated[SmallInts, "(n_cable,)"]
    """Written from here on."""
    opening: Annotated[Floats, "(n_cable,)"]
    opening_max: Annotated[Floats, "(n_cable,)"]
    traction: Annotated[Floats, "(n_cable,)"]
    edge: Annotated[Ints, "(n_cable,)"]
    joint_body: Annotated[Floats, "(n_cable, 3)"]
    joint: Annotated[Floats, "(n_cable, 3)"]
    joint_slack: Annotated[Floats, "(n_cable,)"]
    grip: Annotated[Floats, "(n_cable,)"]
    arc_grip: Annotated[Floats, "(n_cable,)"]
    transport: Annotated[Floats, "(n_cable,)"]
    overshoot: Annotated[Floats, "(n_cable,)"]
    branch: Annotated[Floats, "(n_cable, 2, 3)"]
    force: Annotated[Floats, "(n_cable, 2, 3)"]
    work: Annotated[Floats, "(n_cable,)"]
    start_work: Annotated[Floats, "(n_cable,)"]
    shed: Annotated[Floats, "(n_cable,)"]
    end_time: Annotated[Floats, "(n_cable,)"]


class JointLaw(NamedTuple):
    """What the joints do, see :mod:`shellcut.cables.joint_slip`."""

    slips: bool
    """Whether they may move on the edge."""
    friction: float
    """mu."""
    stick: float
    """Sliding distance over which friction around the edge sets in [mm]."""
    onward: Annotated[Ints, "(n_edge, 2)"]
    """Segments before and after each one of its chain, -1 at an open end."""


class CableTables(NamedTuple):
    """Arguments of the kernel that last until the next split."""

    n_cable: int
    """Number of cables; the rows beyond are in reserve."""
    directional: bool
    """Whether the cables may meet the edges."""
    law: Annotated[Floats, "(n_parameter,)"]
    """Of :meth:`CohesiveTable.parameters`."""
    at_edge: Annotated[Floats, "(n_of_edge,)"]
    """The same of cables with a joint, :meth:`CohesiveTable.at_edge`."""
    joint: JointLaw
    edges: CuttingEdges
    nodes: KernelNodes
    cables: CableRows


@always_inline
def at_end(c: int, end: int, rows: Floats, cables: CableRows) -> Vec3:
    """Return rows : (n_node, 3) at an end of cable c, between the nodes that carry it."""
    here, there, share = cables.ends[c, end], cables.far[c, end], cables.share[c]
    return combine(1.0 - share, load(rows, here), share, load(rows, there))
