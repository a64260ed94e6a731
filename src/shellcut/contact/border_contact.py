"""Contact of the film's border with the tool between its nodes.

An outer side, a notch or a flank that crosses the tool between its nodes is not felt there. So each
segment of the border (:mod:`.film_outline`) carries points, evenly spaced, that touch the tool as
nodes do (:mod:`.press_kernel`): a place with the weights 1 - s and s on the ends, with a force of
its own that these share.

*Stiffness.* With K of a segment from :class:`.film_outline.BorderSegments`, its m points have K / m
each, and either end gives up K / 2. As a spring on a weighted mean is no stiffer than its parts at
the nodes, all of it together is no stiffer than the nodes alone were, and neither is the step
shorter.

*Spacing.* A corner of the tool that lies between two points catches between them if they are
farther apart than the rounding of its edges lets them pass: ``SPACING`` times the radius at most.
For the points the tool's edges are rounded by half the film's thickness, or half that of a thin
tool, twice what it is for nodes: a stiff film penetrates as deep as that, and would catch. For a
film so thin that there would be more than ``MOST`` points on a typical segment, they are rounded by
more.

*Sides.* A point gets the side of the blade that the ends have, and keeps it while it is inside,
unless an end gets the other side. Where the ends have different sides the blade cuts through the
segment, and through a point that is deeper below its side than half the blade's thickness and
closer to the other: these do not press.

*Jumps.* If a point gets deeper by more than film and tool have moved (a split has made the
segment), that part is an offset of its depth, which does not press and fades as for nodes.

*Memory* belongs to the place in its row's polygon, so it outlasts splits along edges of the mesh.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, NodeStiffness, StiffnessBy
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.kept import take_over
from shellcut.state import KernelNodes, State
from shellcut.tool.pose import Pose

from .contact_tables import (
    ContactPoints,
    ContactTables,
    DistanceQueries,
    Memory,
    carry_over,
)
from .film_outline import BorderSegments
from .near_nodes import Clock
from .penalty_contact import PenaltyContact
from .press_kernel import add_press_forces
from .press_term import WORK, PressTerm
from .settings import STEEPEST

SPACING = 1.1
"""Largest distance of points on a segment, over the radius by which the tool's edges are
rounded."""

MOST = 16
"""Points on a segment as long as a typical quad, at most."""

# Of the tool's half thickness: the rounding of its edges for the points, at most.
_OF_TOOL = 0.5

# Of any segment; a key is that of the segment times this, and the place on the segment.
_MOST_OF_ANY = 1024


class BorderContact(PressTerm):
    """Contact of the film's border.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes, which knows the film's border; evaluated before this in every step.
    edge_length : float
        Of a typical quad [mm].
    """

    kept_names = (*PressTerm.kept_names, "_looks", "_memory", "_key", "_walked", "n_search")

    def __init__(self, contact: PenaltyContact, edge_length: float) -> None:
        assert contact.film_edges is not None
        self._contact, self._border = contact, contact.film_edges
        nothing = np.zeros(0, np.int64)
        super().__init__("edges", contact.tool.n_tooth, nothing)
        self._spacing = max(SPACING * contact.law.rounding, edge_length / MOST)
        thin = min(0.5 * contact.thickness, _OF_TOOL * contact.law.tool_half_thickness)
        self._rounding = max(contact.law.rounding, thin, self._spacing / SPACING)
        self._key, self._walked = nothing, np.zeros(1)
        self._looks, self._memory = DistanceQueries.none_yet(0), Memory.blank(0)
        self._of_contact: ContactTables | None = None
        self._call, self._list = BoundOnce(add_press_forces), BoundOnce(_places_on)

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the forces at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        renewed = self._of_contact is not self._contact.tables
        if renewed:
            work = self._renew(state, pose)
        self._call.code(pose, before, state.dt, self.tables, self._touch)
        if renewed:
            self.touch.sums[WORK] += work

    def stiffness(self, state: State, counted: StiffnessBy) -> NodeStiffness:
        """Return the ends of segments that may press soon and what they add at most [N/mm].

        To the stiffness of the contact of nodes that is counted, which is that of nodes alone.
        """
        soon, segments = counted[self._contact.name][0], self._border.of(state)
        near = self._contact.near_soon(segments.node, state)
        ends = segments.node[near].ravel()
        half = np.repeat(0.5 * STEEPEST * segments.stiffness[near], 2)
        # Of nothing bincount returns whole numbers.
        more: Floats = np.bincount(ends, half, state.n_node).astype(float)
        more[soon] = 0.0
        nodes = np.flatnonzero(more)
        return nodes, more[nodes]

    def felt(self, key: Ints) -> tuple[Ints, Floats]:
        """Return the first place of each of some segments, and the end, and what each presses [mm].

        key : of the segments, ascending, listed or not.
        """
        of_segment = self._key // _MOST_OF_ANY
        at: Ints = np.searchsorted(of_segment, np.append(key, np.iinfo(np.int64).max))
        listed = np.isin(of_segment, key)
        pressed: Floats = np.maximum(self._memory.depth - self._memory.offset, 0.0)
        first: Ints = np.append(0, np.cumsum(listed))[at].astype(np.int64)
        return first, pressed[listed]

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose; after the contact's."""
        self._pose = pose
        take_over(self, self.kept_names, saved)
        self._lay_out(state)

    def _renew(self, state: State, pose: Pose) -> float:
        """List the places anew; return the work of those no longer listed [N·mm]."""
        segments = self._border.of(state)
        around = self._contact.near
        near = around.within(around.margin, segments.node, state, pose)
        room = int((segments.length[near] / self._spacing + 2.0).sum())
        key, k = np.empty(room, np.int64), np.empty(room)
        node, weight = np.zeros((room, 4), np.int64), np.zeros((room, 4))
        count = self._list(near, segments, self._spacing, key, node, weight, k)
        key = key[:count].copy()
        was, had = self._key, self._memory
        at = np.searchsorted(was, key)
        same = was.take(at, mode="clip") == key if was.size else np.zeros(count, np.bool_)
        self.kept = np.where(same, at, -1)
        queries, memory = DistanceQueries.none_yet(count), Memory.blank(count)
        carry_over(memory[1:], had[1:], self.kept)
        pressed: Bools = np.asarray(had.force.any(axis=1))
        pressed[at[same]] = False
        dropped = np.flatnonzero(pressed)
        v = state.node.velocity_half[self.carriers.node[dropped]]
        moved = (self.carriers.weight[dropped, :, None] * v).sum(axis=1)
        power = float((had.force[dropped] * moved).sum())
        blank = ContactPoints.of(node[:count])
        self.carriers = blank._replace(weight=weight[:count].copy(), stiffness=k[:count].copy())
        self._key, self._looks, self._memory = key, queries, memory
        self._walked[0] = 0.0
        self.n_search += 1
        self._lay_out(state)
        return 0.5 * state.dt * power

    def _lay_out(self, state: State) -> None:
        """Build the kernel's tables, valid until the list is made anew."""
        contact = self._contact
        self.tables = self._address_of(
            ContactTables(
                on_border=True,
                tool=contact.solid,
                law=contact.law._replace(rounding=self._rounding),
                clock=Clock(np.unique(self.carriers.node), self._walked, contact.clock.radius),
                queries=self._looks,
                contact_points=self.carriers,
                memory=self._memory,
                nodes=KernelNodes.of(state.node),
                around=state.quads_at_nodes(),
            )
        )
        self._of_contact = contact.tables


@kernel
def _places_on(
    near: Ints,
    segments: BorderSegments,
    spacing: float,
    key: Ints,
    node: Ints,
    weight: Floats,
    stiffness: Floats,
) -> int:
    """Write the places on some segments : (n,); return how many there are.

    Their keys, ascending, nodes and weights : (n_room, 4), and stiffness [N/mm].
    """
    count = 0
    for e in near:
        m = min(max(int(np.ceil(segments.length[e] / spacing)), 1), _MOST_OF_ANY)
        for j in range(m):
            s = (j + 0.5) / m
            key[count] = segments.key[e] * _MOST_OF_ANY + j
            node[count, 0], node[count, 1] = segments.node[e, 0], segments.node[e, 1]
            node[count, 2] = node[count, 3] = segments.node[e, 0]
            weight[count, 0], weight[count, 1] = 1.0 - s, s
            stiffness[count] = segments.stiffness[e] / m
            count += 1
    return count
