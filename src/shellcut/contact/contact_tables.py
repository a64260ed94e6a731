"""What the kernel of the penalty contact takes, in named tables."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts
from shellcut.state import QuadsAtNodes
from shellcut.tool.signed_distance import TriangleGrid

from .settings import PenaltyLaw


class Lookups(NamedTuple):
    """Of each listed node, what its last look-up in the tool found."""

    node: Annotated[Ints, "(n_near,)"]
    """The node, ascending."""
    place: Annotated[Floats, "(n_near, 3)"]
    """Where it was then, in the body frame [mm]."""
    lasts: Annotated[Floats, "(n_near,)"]
    """How far from there this lasts [mm]: good as long as the node is closer to its place."""
    within: Annotated[Bools, "(n_near,)"]
    """Whether it was inside."""
    closest: Annotated[Ints, "(n_near, 2)"]
    """The closest triangles of all and of its side if it was."""

    @classmethod
    def none_yet(cls, nodes: Ints) -> Lookups:
        """Return those of nodes that have not been looked up."""
        return cls(
            node=nodes,
            place=np.zeros((nodes.size, 3)),
            lasts=np.zeros(nodes.size),
            within=np.zeros(nodes.size, np.bool_),
            closest=np.zeros((nodes.size, 2), np.int64),
        )


class ContactTool(NamedTuple):
    """The tool as the kernel takes it."""

    grid: TriangleGrid
    """Finds the surface near a point."""
    reach: float
    """Points up to this far outside the surface are found [mm]."""
    round_off: float
    """Taken off a distance from the surface [mm]."""
    triangle_body: Annotated[Ints, "(n_triangle,)"]
    """Tooth of each triangle."""
    segments: Annotated[Floats, "(n_edge, 4, 3)"]
    """As of :class:`shellcut.tool.cutting_edge.CuttingEdges`."""


class ContactNodes(NamedTuple):
    """What the kernel needs of the nodes, by the names of :class:`shellcut.state.NodeTable`."""

    x: Annotated[Floats, "(n_node, 3)"]
    velocity_half: Annotated[Floats, "(n_node, 3)"]
    contact_area: Annotated[Floats, "(n_node,)"]
    mass: Annotated[Floats, "(n_node,)"]
    supported: Annotated[Bools, "(n_node,)"]
    contact_side: Annotated[SmallInts, "(n_node,)"]
    """Written from here on."""
    contact_depth: Annotated[Floats, "(n_node,)"]
    contact_offset: Annotated[Floats, "(n_node,)"]
    contact_work: Annotated[Floats, "(n_node,)"]
    contact_force: Annotated[Floats, "(n_node, 3)"]
    force: Annotated[Floats, "(n_node, 3)"]


class ContactTables(NamedTuple):
    """All that the kernel takes and that lasts until the list of near nodes is renewed."""

    tool: ContactTool
    law: PenaltyLaw
    near: Lookups
    nodes: ContactNodes
    around: QuadsAtNodes
