"""Penalty contact of the nodes with the rigid tool ([Frangi2010] 5.2).

A node inside the tool by the depth g gets the force +k f(g) n, n the outward normal of the tool
there, and the tool gets the opposite (the minus in the paper: it prints the force on the cutter); k
and f are in :mod:`shellcut.contact.settings`. Friction on the faces is a term of its own
(:mod:`shellcut.contact.coulomb_friction`); adhesion acts in the joints of the cables.

*Search.* Global: the nodes near a tooth are listed now and then
(:mod:`shellcut.contact.near_nodes`). Local: a listed node finds the closest triangles of its
cell in a grid fixed to the tool, and knows how long the result is valid
(:mod:`shellcut.contact.tool_distance`).

*Depth and normal* are those of the tool with its convex edges rounded, so that the force is
continuous, the gradient of a potential (:mod:`shellcut.tool.rounded_depth`).

*Which face.* A blade's two flanks are a few hundredths of a millimetre apart near the edge, and a
node created inside the wedge by a split would take the nearer one, with a loaded spring. So a node
keeps a side, +1 or -1 by the flank labels of the tool, chosen at its first contact: near the
mid-plane (``_UNDECIDED``) from its own quads, if they clearly lie beside the blade; else from the
nearest face. It is forgotten when the node has left the tool. So a blade well beside the mesh line
leaves both flanks of the cut on one side of it: pushing one across would give the film energy.

*Jumps.* When the depth grows by more than node and tool have moved in the step, as after a split
that assigns a node to the other flank, the excess is not loaded: it goes into an offset, a function
of where the node is in the tool that fades with the distance from where it jumped. For this node
the flank starts at the node and rises to its own height farther on. So the force is the gradient of
a potential still, along the flank too, and what pushes the node out is work of the tool as it moves
on, or of the film that is drawn along a tool at rest; where nothing moves, nothing is loaded.
Growth by motion is no jump: a node that flies into a face is stopped however deep it goes in a
step, and rebounds with no more energy than it had before.
"""

from __future__ import annotations

from collections.abc import Callable
from math import sqrt
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, NodeStiffness, SmallInts, StiffnessBy
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.kept import take_over
from shellcut.numerics.vec3 import add_scaled, dot, load, sub
from shellcut.state import KernelNodes, State
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.pose import Pose, to_body
from shellcut.tool.signed_distance import GridCells, at_least
from shellcut.tool.tool import Tool

from .contact_tables import (
    ContactPoints,
    ContactTables,
    ContactTool,
    DistanceQueries,
    Memory,
)
from .film_outline import FilmBorderSegments, Part
from .near_nodes import Clock, NearNodes
from .press_kernel import add_press_forces
from .press_term import DEEPEST, PressTerm
from .settings import Contact, PenaltyLaw

# Margin of the list of near nodes, over the median edge length. Nodes within half of it count with
# their stiffness in the time step; the list lasts until that is used up.
_MARGIN = 2.2

# Subtracted from distances, far above their round-off: fraction of the tool's farthest coordinate.
_ROUND_OFF = 1e-10

# Of the local edge length: up to there from the crack's plane quads decide a node's side.
_UNDECIDED = 0.1


class PenaltyContact(PressTerm):
    """Contact forces of all nodes.

    Parameters
    ----------
    tool : Tool
        The rigid body.
    contact : Contact
        Parameters.
    film : ShellMaterial
        The film, which sets the parameters' defaults.
    edge_length : float
        Of a typical quad [mm].
    crack_aside : float
        How far a crack may lie from the mid-plane of its blade, in local edge lengths.
    part_of : Callable, optional
        Returns the polygon of a row that is cut; with it, places on the film's border touch the
        tool too, with a part of the stiffness of the nodes at their ends (:mod:`.border_contact`).
    """

    kept_names = (*PressTerm.kept_names, "_looks", "deepest", "near")

    def __init__(
        self,
        tool: Tool,
        contact: Contact,
        film: ShellMaterial,
        edge_length: float,
        crack_aside: float = 0.0,
        part_of: Callable[[int], Part] | None = None,
    ) -> None:
        super().__init__("contact", tool.n_tooth, None)
        self.tool = tool
        self.law = PenaltyLaw.of(contact, film, tool)
        self.thickness = film.thickness
        """h [mm]."""
        self.grid = ClosestTriangleGrid.of(tool)
        """Finds the surface near a point."""
        self.film_edges = FilmBorderSegments(self.law, part_of) if part_of is not None else None
        """Segments of the film's border, if they touch the tool."""
        self.solid = ContactTool(
            grid=self.grid.arrays,
            reach=self.grid.reach,
            empty_around=self.grid.empty_around,
            round_off=_ROUND_OFF * float(np.abs(tool.vertices).max()),
            triangle_tooth=tool.triangle_tooth,
            segments=CuttingEdges.of(tool).segments,
            undecided=_UNDECIDED + crack_aside,
        )
        """The tool, for kernels."""
        self._radius = float(np.linalg.norm(tool.vertices, axis=1).max())
        corners = [
            tool.vertices[tool.triangles[tool.triangle_body == b]] for b in range(tool.n_body)
        ]
        self.near = NearNodes(
            np.array([c.min(axis=(0, 1)) for c in corners]),
            np.array([c.max(axis=(0, 1)) for c in corners]),
            _MARGIN * edge_length,
        )
        """The nodes of the last global search."""
        self.clock = Clock(self.near.ids, np.zeros(1), self._radius)
        """Of all that waits to touch the tool."""
        # _looks, and carriers below, are names that checkpoints keep: see CONTRIBUTING.md.
        self._ids, self._looks = self.near.ids, DistanceQueries.none_yet(0)
        self._call, self._soon = BoundOnce(add_press_forces), BoundOnce(_within)
        self.deepest = 0.0
        """Largest depth of a node in the tool so far [mm]."""

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the contact forces at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        if self.near.renew(state, pose):
            self._take_list(state)
            self.n_search = self.near.n_search
        self._call.code(pose, before, state.dt, self.tables, self._touch)
        self.deepest = max(self.deepest, float(self.touch.sums[DEEPEST]))

    def stiffness(self, state: State, _counted: StiffnessBy) -> NodeStiffness:
        """Return the nodes that may come into contact soon and their steepest penalty [N/mm]."""
        near, n = self.near_nodes(state), state.node
        return near, n.contact_share[near] * self.law.steepest(n.contact_area[near])

    def near_nodes(self, state: State) -> Ints:
        """Return the nodes that may come into contact soon; before the first evaluation none.

        They depend only on the positions at the last one, not on when the list was made.
        """
        ids = self.near.ids
        return ids[self.near_soon(ids[:, None], state)]

    def near_soon(self, corners: Ints, state: State) -> Ints:
        """Return which nodes, segments or quads may come into contact soon; at first none.

        corners : (n, n_corner), node ids.
        """
        if self._pose is None:
            return self.near.ids[:0]
        solid, distance = self.solid, self.near.half_margin
        near = self.near.within(distance, corners, state, self._pose)
        cells, around, found = solid.grid.cells, solid.empty_around, np.empty_like(near)
        n = self._soon(
            corners[near], state.node.x, self._pose, cells, around, solid.reach, distance, found
        )
        return near[found[:n]]

    def saved(self) -> dict[str, Any]:
        """Return the list of near nodes, what is known of them, and the last forces."""
        return super().saved() | {"walked": self.clock.walked}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, for the nodes of ``state`` and the tool at its present pose."""
        self._pose = pose
        take_over(self, self.kept_names, saved)
        self.n_search, self._ids = self.near.n_search, self.near.ids
        carriers = self.carriers
        self._collect(state)
        for now, kept in zip(self.carriers, carriers, strict=True):
            now[:] = kept
        self.clock.walked[:] = saved["walked"]

    def _take_list(self, state: State) -> None:
        """Switch to the new list: nodes that left it are outside, all are evaluated anew."""
        n, before, near = state.node, self._ids, self.near.ids
        place = np.searchsorted(near, before)
        stays = near.take(place, mode="clip") == before if near.size else before < 0
        left = before[~stays]
        n.contact_side[left] = 0
        n.contact_depth[left] = n.contact_offset[left] = n.contact_work[left] = 0.0
        n.contact_force[left] = 0.0
        self._ids, self._looks = near, DistanceQueries.none_yet(near.size)
        self._collect(state)

    def _collect(self, state: State) -> None:
        """Build the kernel's tables, valid until a split renews the list."""
        near, n = self.near.ids, state.node
        self.carriers = ContactPoints.of(np.repeat(near[:, None], 4, axis=1))
        if self.film_edges is None:
            self.carriers.stiffness[:] = n.contact_share[near] * self.law.of_nodes(
                n.contact_area[near]
            )
        else:
            self.carriers.stiffness[:] = self.film_edges.of(state).left[near]
        self.clock = Clock(near, np.zeros(1), self._radius)
        tables = ContactTables(
            on_border=False,
            tool=self.solid,
            law=self.law,
            clock=self.clock,
            queries=self._looks,
            contact_points=self.carriers,
            memory=Memory.of_nodes(state, near),
            nodes=KernelNodes.of(state.node),
            around=state.quads_at_nodes(),
        )
        self.tables = self._address_of(tables)


@kernel
def _within(
    corners: Ints,
    x: Floats,
    pose: Pose,
    cells: GridCells,
    empty_around: SmallInts,
    reach: float,
    distance: float,
    found: Ints,
) -> int:
    """Write the rows that may be this near to the solid to found : (n,), return how many.

    corners : (n, n_corner), node ids.
    """
    pose, count, n_corner = borrowed(pose), 0, corners.shape[1]
    for i in range(corners.shape[0]):
        # All of a row is within a ball around the mean of its corners.
        middle, square = (0.0, 0.0, 0.0), 0.0
        for a in range(n_corner):
            middle = add_scaled(middle, 1.0 / n_corner, load(x, corners[i, a]))
        for a in range(n_corner):
            off = sub(load(x, corners[i, a]), middle)
            square = max(square, dot(off, off))
        away = at_least(to_body(middle, pose), reach, cells, empty_around) - sqrt(square)
        # Without a branch: a row too far away is overwritten by the next one.
        found[count] = i
        count += away <= distance
    return count
