"""Named tables of the arguments of the penalty contact's kernel, and of all that presses."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallInts
from shellcut.state import QuadsAtNodes, State
from shellcut.tool.rounded_depth import ConvexNeighbours
from shellcut.tool.signed_distance import TriangleGrid

from .settings import PenaltyLaw


class Carriers(NamedTuple):
    """Where a term presses film and tool on one another, row by row of its list; its kernel writes.

    A carrier is a node, or the place of an edge or a quad: a mean of up to four nodes.
    """

    node: Annotated[Ints, "(n_row, 4)"]
    """Nodes that carry the place."""
    weight: Annotated[Floats, "(n_row, 4)"]
    """Their shape functions there."""
    body: Annotated[Ints, "(n_row,)"]
    """Tooth on which it presses."""
    stiffness: Annotated[Floats, "(n_row,)"]
    """k of the penalty [N/mm]."""
    pressure: Annotated[Floats, "(n_row,)"]
    """Normal force, 0 where nothing presses [N]."""
    normal: Annotated[Floats, "(n_row, 3)"]
    """Its direction on the film, a unit vector in the body frame."""

    @classmethod
    def of(cls, node: Ints) -> Carriers:
        """Return those of the first of each of some nodes (n_row, 4), where nothing presses."""
        n = len(node)
        weight = np.zeros((n, 4))
        weight[:, 0] = 1.0
        body, normal = np.zeros(n, np.int64), np.zeros((n, 3))
        return cls(node.copy(), weight, body, np.zeros(n), np.zeros(n), normal)


class Lookups(NamedTuple):
    """What is known of each listed node in the tool, most of it from its last look-up."""

    node: Annotated[Ints, "(n_near,)"]
    """Node ids, ascending."""
    place: Annotated[Floats, "(n_near, 3)"]
    """Position of the look-up, in the body frame [mm]."""
    lasts: Annotated[Floats, "(n_near,)"]
    """Range of validity [mm]: the result holds while the node is closer than this to that
    position."""
    within: Annotated[Bools, "(n_near,)"]
    """Whether the node was inside."""
    closest: Annotated[Ints, "(n_near, 2)"]
    """If inside: the closest triangle of all, and the closest of its side."""
    depth: Annotated[Floats, "(n_near,)"]
    """If inside: the depth below the rounded surface, at this step [mm]."""
    out: Annotated[Floats, "(n_near, 3)"]
    """And the unit vector out there, in the body frame."""
    across: Annotated[Ints, "(n_near,)"]
    """Face beyond the edge around which it was rounded last, -1 for none."""

    @classmethod
    def none_yet(cls, nodes: Ints) -> Lookups:
        """Return the table of nodes that have not been looked up yet."""
        return cls(
            node=nodes,
            place=np.zeros((nodes.size, 3)),
            lasts=np.zeros(nodes.size),
            within=np.zeros(nodes.size, np.bool_),
            closest=np.zeros((nodes.size, 2), np.int64),
            depth=np.zeros(nodes.size),
            out=np.zeros((nodes.size, 3)),
            across=np.full(nodes.size, -1),
        )


class ContactTool(NamedTuple):
    """The tool, for the kernel."""

    grid: TriangleGrid
    """Finds the surface near a point."""
    reach: float
    """Points up to this far outside the surface are found [mm]."""
    round_off: float
    """Subtracted from a distance from the surface [mm]."""
    triangle_body: Annotated[Ints, "(n_triangle,)"]
    """Tooth of each triangle."""
    segments: Annotated[Floats, "(n_edge, 4, 3)"]
    """As in :class:`shellcut.tool.cutting_edge.CuttingEdges`."""
    around: ConvexNeighbours
    """Of its triangles, for the rounding of convex edges."""
    undecided: float
    """Distance from the mid-plane up to which a node's quads decide its side, in local edge
    lengths."""


class ContactNodes(NamedTuple):
    """Fields of the nodes that kernels need, named as in :class:`shellcut.state.NodeTable`."""

    x: Annotated[Floats, "(n_node, 3)"]
    velocity_half: Annotated[Floats, "(n_node, 3)"]
    contact_area: Annotated[Floats, "(n_node,)"]
    contact_share: Annotated[Floats, "(n_node,)"]
    contact_mass: Annotated[Floats, "(n_node,)"]
    supported: Annotated[Bools, "(n_node,)"]
    contact_side: Annotated[SmallInts, "(n_node,)"]
    """Kernels write this and the following fields."""
    contact_depth: Annotated[Floats, "(n_node,)"]
    contact_offset: Annotated[Floats, "(n_node,)"]
    contact_work: Annotated[Floats, "(n_node,)"]
    contact_force: Annotated[Floats, "(n_node, 3)"]
    force: Annotated[Floats, "(n_node, 3)"]

    @classmethod
    def of(cls, state: State) -> ContactNodes:
        """Return those of a state, good until the next split."""
        return cls(*(getattr(state.node, name) for name in cls._fields))


class ContactTables(NamedTuple):
    """Kernel arguments that stay valid until the list of near nodes is renewed."""

    tool: ContactTool
    law: PenaltyLaw
    near: Lookups
    carriers: Carriers
    nodes: ContactNodes
    around: QuadsAtNodes
