"""Named tables of the contact points, with weights on the film's nodes, and their memory."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Numbers, SmallIds, SmallInts
from shellcut.state import KernelNodes, QuadsAtNodes, State
from shellcut.tool.signed_distance import TriangleGrid

from .film_outline import Outline
from .near_nodes import Clock
from .pair_search import Pairs
from .settings import PenaltyLaw, SheetLaw


class ContactPoints(NamedTuple):
    """Where a term presses film and tool on one another, row by row of its list; its kernel writes.

    A contact point is a node, or a place of a border segment or a quad: a mean of up to four nodes.
    """

    node: Annotated[Ints, "(n_row, 4)"]
    """Nodes that carry the point."""
    weight: Annotated[Floats, "(n_row, 4)"]
    """Their shape functions there."""
    tooth: Annotated[Ints, "(n_row,)"]
    """Tooth on which it presses."""
    stiffness: Annotated[Floats, "(n_row,)"]
    """k of the penalty [N/mm]."""
    pressure: Annotated[Floats, "(n_row,)"]
    """Normal force, 0 where nothing presses [N]."""
    normal: Annotated[Floats, "(n_row, 3)"]
    """Its direction on the film, a unit vector in the body frame."""

    @classmethod
    def of(cls, node: Ints) -> ContactPoints:
        """Return contact points at the first of each of some nodes (n_row, 4); none presses."""
        n = len(node)
        weight = np.zeros((n, 4))
        weight[:, 0] = 1.0
        tooth, normal = np.zeros(n, np.int64), np.zeros((n, 3))
        return cls(node.copy(), weight, tooth, np.zeros(n), np.zeros(n), normal)


class DistanceQueries(NamedTuple):
    """What is known of each contact point from its last search on the tool's surface."""

    place: Annotated[Floats, "(n_row, 3)"]
    """Where it was then, in the body frame [mm]."""
    gap: Annotated[Floats, "(n_row, 3)"]
    """Of a point outside, the vector to it from the closest point of the surface [mm]; 0 if that
    is far away. The plane through the latter and across it is in front of the tool."""
    free: Annotated[Floats, "(n_row,)"]
    """Within this distance of that place what was found holds [mm]: a point outside does not touch
    before it reaches that plane, and the depth of one inside follows from its faces."""
    face: Annotated[Ints, "(n_row, 2)"]
    """Of a point inside, the triangles whose planes give its depth, twice the same where one does;
    else -1."""
    until: Annotated[Floats, "(n_row,)"]
    """Of a point outside, the travelled distance up to which it has certainly not left [mm]."""

    @classmethod
    def none_yet(cls, n: int) -> DistanceQueries:
        """Return the table of n contact points that have not been evaluated yet."""
        place, gap, free, until = np.zeros((n, 3)), np.zeros((n, 3)), np.zeros(n), np.zeros(n)
        return cls(place, gap, free, np.full((n, 2), -1), until)


class Memory(NamedTuple):
    """What is kept of each contact, in rows of its own: of nodes it is in the state."""

    row: Annotated[Ints, "(n_row,)"]
    """Row of each contact point in the following arrays: node ids if these are the state's."""
    side: Annotated[SmallInts, "(n_kept,)"]
    """Side of the blade, or of a sheet, on which it lies: +1, -1, or 0 while unknown."""
    depth: Annotated[Floats, "(n_kept,)"]
    """Depth [mm], 0 outside."""
    offset: Annotated[Floats, "(n_kept,)"]
    """Part of the depth that does not press [mm]."""
    place: Annotated[Floats, "(n_kept, 3)"]
    """Where in the body frame the offset arose [mm]."""
    work: Annotated[Floats, "(n_kept,)"]
    """Work put into the contact since it began [N·mm]."""
    force: Annotated[Floats, "(n_kept, 3)"]
    """On the film [N]."""

    @classmethod
    def of_nodes(cls, state: State, ids: Ints) -> Memory:
        """Return that of some nodes, whose rows are in the state."""
        n = state.node
        return cls(
            row=ids,
            side=n.contact_side,
            depth=n.contact_depth,
            offset=n.contact_offset,
            place=n.contact_place,
            work=n.contact_work,
            force=n.contact_force,
        )

    @classmethod
    def blank(cls, n: int) -> Memory:
        """Return that of n contact points that touch nothing."""
        row, side = np.arange(n, dtype=np.int64), np.zeros(n, np.int8)
        depth, offset, work = np.zeros((3, n))
        place, force = np.zeros((2, n, 3))
        return cls(row, side, depth, offset, place, work, force)


def carry_over(new: Iterable[Numbers], old: Iterable[Numbers], kept: Ints) -> None:
    """Write to the rows of new arrays those that they had in old ones; kept : (n,), -1 for none."""
    to = np.flatnonzero(kept >= 0)
    for rows, had in zip(new, old, strict=True):
        if len(had):
            rows[to] = had[kept[to]]


class ContactTool(NamedTuple):
    """The tool, for the kernel."""

    grid: TriangleGrid
    """Finds the surface near a point."""
    reach: float
    """Points up to this far outside the surface are found [mm]."""
    empty_around: Annotated[SmallInts, "(n_cell,)"]
    """Cells of the grid from each to the next from which anything is."""
    round_off: float
    """Subtracted from a distance from the surface [mm]."""
    triangle_tooth: Annotated[Ints, "(n_triangle,)"]
    """Tooth of each triangle."""
    segments: Annotated[Floats, "(n_edge, 5, 3)"]
    """As in :class:`shellcut.tool.cutting_edge.CuttingEdges`."""
    undecided: float
    """Distance from the mid-plane up to which a node's quads decide its side, in local edge
    lengths."""


class ContactTables(NamedTuple):
    """Kernel arguments that stay valid until the list is made anew."""

    on_border: bool
    """Whether the contact points are on the film's border, between two nodes; else they are
    nodes."""
    tool: ContactTool
    law: PenaltyLaw
    clock: Clock
    queries: DistanceQueries
    contact_points: ContactPoints
    memory: Memory
    nodes: KernelNodes
    around: QuadsAtNodes


class ToolPoints(NamedTuple):
    """Points of the tool in its body frame, for kernels."""

    place: Annotated[Floats, "(n_of_tool, 3)"]
    """[mm]"""
    outward: Annotated[Floats, "(n_of_tool, 3)"]
    """Mean unit normal of the surface there."""
    tooth: Annotated[Ints, "(n_of_tool,)"]
    """Tooth of each."""
    segment: Annotated[Ints, "(n_of_tool,)"]
    """Segment of the cutting edge on which each lies, -1 for none."""
    radius: Annotated[Floats, "(n_of_tool,)"]
    """Of the arc of a cutting edge [mm], 0 at its tips, inf where it is straight or none."""
    arc: Annotated[Ints, "(n_of_tool,)"]
    """To which arc of a cutting edge each belongs, -1 for none."""
    share: Annotated[Floats, "(n_of_tool,)"]
    """Stiffness of each over that of a node of the film, less the more of them press together."""

    @classmethod
    def none(cls) -> ToolPoints:
        """Return no points."""
        nothing, none = np.zeros(0, np.int64), np.zeros(0)
        of_points = np.zeros((0, 3))
        return cls(of_points, of_points.copy(), nothing, nothing.copy(), none, nothing.copy(), none)


class Waits(NamedTuple):
    """How long points need not be evaluated: distances, on the scale of the clock."""

    point: Annotated[Floats, "(n_point,)"]
    """Until when a point touches nothing [mm]."""
    pair: Annotated[Floats, "(n_pair,)"]
    """Until when it is not near the quad [mm]."""


class Presses(NamedTuple):
    """Forces of the last evaluation: on a point, and on the nodes of the quad that it touches."""

    node: Annotated[Ints, "(n_room, 5)"]
    force: Annotated[Floats, "(n_room, 5, 3)"]
    """[N]"""
    n: Annotated[Ints, "(1,)"]
    """How many points press."""

    @classmethod
    def with_room(cls, n_room: int, last: Presses | None = None) -> Presses:
        """Return a table for so many points that press, with those of another table."""
        count = 0 if last is None else int(last.n[0])
        room = max(n_room, count)
        node, force = np.zeros((room, 5), np.int64), np.zeros((room, 5, 3))
        if last is not None:
            node[:count], force[:count] = last.node[:count], last.force[:count]
        return cls(node, force, np.array([count], np.int64))

    def saved(self) -> dict[str, Any]:
        """Return the rows in use."""
        count = int(self.n[0])
        return {"node": self.node[:count], "force": self.force[:count], "n": self.n}


class SheetTables(NamedTuple):
    """Kernel arguments of points against sheets, valid until the search is repeated."""

    of_tool: bool
    """Whether the points are the tool's; else they are nodes."""
    law: SheetLaw
    points: ToolPoints
    pairs: Pairs
    stiffness: Annotated[Floats, "(n_pair,)"]
    """k of the point on each quad [N/mm]."""
    memory: Memory
    """Sheet by sheet; the force is that on the point."""
    met: Annotated[Bools, "(n_sheet,)"]
    """Whether the point has been seen close to the sheet."""
    waits: Waits
    clock: Clock
    """Of points that are nodes, and of the nodes of the quads close to points."""
    outline: Outline
    quads: Annotated[SmallIds, "(n_quad, 4)"]
    nodes: KernelNodes
    contact_points: ContactPoints
    """Sheet by sheet, where and how hard the point presses on it."""
    presses: Presses
