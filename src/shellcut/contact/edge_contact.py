"""Contact of edges of the film with convex edges of the tool.

A rim, a notch or a flank that crosses an edge of the tool between its nodes is felt neither at a
node nor by a point of the tool, which is beside the film there. So each edge of the film at which
it ends (:mod:`.film_edges`) has the potential

    k max over s of  Phi(D(p(s))) - (1 - s) Phi(D_a) - s Phi(D_b),      Phi = ∫f,

the most energy that it has over what its ends are felt to have (:mod:`.edge_hills`), with f of the
nodes' contact. As s is where that is largest, the forces are, with the ways out n at s and n_a,
n_b at ends that are in the tool,

    on a:  k (1 - s) (f(D) n - f(D_a) n_a),      on b:  k s (f(D) n - f(D_b) n_b),

and minus both on the tool, at the ends: D depends on where the film is relative to it, so the
moments are those of the gradient, too. It presses at s, and takes a part of what presses at the
ends; as k is ``STIFFNESS`` of the softer one's, this is less than what does press there, and no end
is pulled into the tool.

*Nothing jumps.* D is continuous around convex edges and corners of the tool, and Phi begins with
slope zero. The potential goes to zero as the tool's edge slides along the film's to one of its
ends, where the node takes over, and as the film's edge turns until it lies on a face, on which D is
linear and Phi convex.

*Nothing is gained.* Where the edge lies on a flat end of the tool, the energy has a corner, at
which a step may give more than was put in: see :mod:`.edge_rebound` for how that is kept back.

*Which pairs.* Edges of the film at the nodes near the tool, and convex edges of the tool that do
not cut and turn by more than 10 deg, or less where a chord of the film's length may lie an eighth
of the film's thickness deep under them, as on a round bar of facets; both are listed whenever the
contact of the nodes lists those near. A pair is looked at again when film and tool may have come so
near that they touch, and the step when they have walked half of an edge.

*Sides.* An edge takes the side of the blade that its ends have, and keeps it while it is deeper
than its chord. Where they have different ones, or it is closer to the other side than to its own,
the blade goes through the film there: it does not press. If it gets deeper than its chord by more
than twice what its ends and the tool have moved (a split makes new edges), that part is an offset
of D, which does not press and goes as they part.

*Splits.* An edge whose end has split along edges of the mesh goes on as the edge of the twin: what
is kept of it stays. A cut through quads that gives an end a new node begins anew.

*Stiffness.* Let a = 27/16 be the steepest slope of f. With the weights 1 - s and s of a mean, the
first term is no stiffer than springs a k (1 - s) and a k s at the ends. The others take k (1 - s)
and k s from the springs of the nodes' contact there, each times a slope of f that is theirs, too.
So where the edges at a node have no more than its own k together, and its contact counts with
a times that, edges add nothing to it; else what they have more.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy, Ints
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce
from shellcut.state import KnownTopology, SplitRecord, State
from shellcut.tool.pose import Pose
from shellcut.tool.rounded_depth import ConvexNeighbours

from .contact_tables import Carriers, ContactNodes, ContactTables
from .edge_kernel import add_edge_forces, edge_springs, list_edge_pairs
from .edge_tables import EdgeMemory, EdgePairs, EdgeTables, ToolEdges
from .film_edges import open_edges, rows_at
from .film_outline import FilmOutline, Part
from .penalty_contact import PenaltyContact
from .press_forces import ABSORBED, WORK, PressTerm

# Room for pairs at first.
_ROOM = 256

# Of the way for which the list lasts: the step is looked at again when so much of it is walked.
_SOON = 0.5


class EdgeContact(PressTerm):
    """Contact of the film's edges.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes, evaluated before this in every step.
    edge_length : float
        Of a typical quad [mm].
    part_of : Callable
        Returns the polygon of a row that is cut.
    """

    def __init__(
        self, contact: PenaltyContact, edge_length: float, part_of: Callable[[int], Part]
    ) -> None:
        tool, self._contact = contact.tool, contact
        nowhere = Carriers.of(np.zeros((0, 4), np.int64))
        super().__init__("edges", tool.n_body, nowhere, np.zeros(0, np.int64))
        self._edges = ToolEdges.of(tool, contact.law.rounding, edge_length)
        self._radius = float(np.linalg.norm(tool.vertices, axis=1).max())
        self._around = ConvexNeighbours.of(tool)
        self._outline = FilmOutline(part_of)
        self._of_contact: ContactTables | None = None
        self._known = KnownTopology()
        self._pose: Pose | None = None
        self._soon = _SOON * contact.near.half_margin
        self._walked, self._looked_at = 0.0, 0.0
        self._hold = Holder()
        self.tables: EdgeTables | None = None
        self._held: Any = None  # these, laid out
        self._call, self._list = BoundOnce(add_edge_forces), BoundOnce(list_edge_pairs)
        self._springs, self._room = BoundOnce(edge_springs), _ROOM

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the forces at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        renewed = self._of_contact is not self._contact.tables
        if renewed:
            work, lost = self._renew(state, pose)
        held = self._held
        self._walked = self._call.code(pose, before, state.dt, self._walked, held, self._touch)
        if renewed:
            self.touch.sums[WORK] += work
            self.touch.sums[ABSORBED] += lost
        if self._walked > self._looked_at + self._soon:
            self.n_search, self._looked_at = self.n_search + 1, self._walked

    def stiffness(self, state: State, counted: HeldBy) -> Held:
        """Return the ends of edges that may press soon and what they add at most [N/mm].

        To the stiffness of the contact of nodes that is counted.
        """
        ends, alone = self.stiffness_alone()
        # Of nothing bincount returns whole numbers.
        more = np.bincount(ends, alone, state.n_node).astype(float)
        nodes = np.flatnonzero(more)
        more -= np.bincount(*counted[self._contact.name], state.n_node)
        return nodes, np.maximum(more[nodes], 0.0)

    def stiffness_alone(self) -> Held:
        """Return the ends of edges that may press soon and their steepest stiffness [N/mm].

        Edge by edge, if nothing pressed at the nodes.
        """
        if self.tables is None:
            return np.zeros(0, np.int64), np.zeros(0)
        room = 2 * len(self.tables.pairs.node)
        node, stiffness = np.empty(room, np.int64), np.empty(room)
        count = self._springs(self._pose, self._soon, self._held, node, stiffness)
        return node[:count], stiffness[:count]

    def pressing(self) -> tuple[Ints, Floats]:
        """Return the ends of the edges that press, (n, 2), and the depth that does not [mm]."""
        if self.tables is None:
            return np.zeros((0, 2), np.int64), np.zeros(0)
        memory = self.tables.memory
        presses = memory.stored > 0.0
        return self.tables.pairs.node[presses], memory.offset[presses]

    def saved(self) -> dict[str, Any]:
        """Return the list, what is kept of its edges, and the last forces."""
        if self.tables is None:
            return {"touch": self.touch._asdict()}
        return {
            "touch": self.touch._asdict(),
            "walked": self._walked,
            "looked_at": self._looked_at,
            "n_search": self.n_search,
            "pairs": self.tables.pairs._asdict(),
            "memory": self.tables.memory._asdict(),
            "carriers": self.carriers._asdict(),
        }

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose; after the contact's."""
        self._pose = pose
        self.touch.take(saved["touch"])
        self.tables = self._of_contact = None
        if "pairs" not in saved:
            return
        self._walked, self._looked_at = saved["walked"], saved["looked_at"]
        self.n_search = saved["n_search"]
        pairs = EdgePairs(**{name: rows.copy() for name, rows in saved["pairs"].items()})
        memory = EdgeMemory(**{name: rows.copy() for name, rows in saved["memory"].items()})
        self._lay_out(state, pairs, memory)
        self._take_carriers(saved["carriers"])

    def _renew(self, state: State, pose: Pose) -> tuple[float, float]:
        """List the pairs anew; return the work and the energy of edges that have gone [N·mm]."""
        rows = rows_at(state, self._contact.near.ids)
        ends = open_edges(state, self._outline.of(state), rows)
        reach = self._contact.near.half_margin + float(self._edges.reach.max(initial=0.0))
        first = np.zeros(len(ends) + 1, np.int64)
        while True:
            edge = np.empty(self._room, np.int64)
            count = self._list(ends, state.node.x, pose, self._edges, reach, first, edge)
            if count <= self._room:
                break
            self._room = 2 * count
        near = np.flatnonzero(np.diff(first))
        pairs = EdgePairs(
            node=ends[near],
            listed=_rows_among(self._contact.near.ids, ends[near]),
            first=np.append(first[near], count),
            edge=edge[:count].copy(),
            until=np.zeros(count),
            moving=np.unique(ends[near]),
        )
        memory, old = EdgeMemory.blank(len(near)), self.tables
        self.kept = np.full(len(near), -1)
        gone = (0.0, 0.0)
        if old is not None:
            self.kept = _same_edges(old.pairs.node, pairs.node, self._known.new_splits(state))
            gone = _take_over(old, memory, self.kept, state)
        self._walked = self._looked_at = 0.0
        self.n_search += 1
        self._lay_out(state, pairs, memory)
        return gone

    def _lay_out(self, state: State, pairs: EdgePairs, memory: EdgeMemory) -> None:
        """Build the kernels' tables, valid until the list is made anew."""
        contact = self._contact
        carriers = Carriers.of(pairs.node[:, [0, 1, 0, 0]])
        self.carriers = carriers._replace(body=memory.body)
        self.tables = EdgeTables(
            edges=self._edges,
            radius=self._radius,
            grid=contact.grid.arrays,
            around=self._around,
            near=contact.lookups,
            law=contact.law,
            pairs=pairs,
            memory=memory,
            carriers=self.carriers,
            captured=np.zeros(len(self._edges.start), np.int64),
            across=np.full(1, -1),
            nodes=ContactNodes.of(state),
        )
        self._held = self._hold(self.tables)
        self._of_contact = contact.tables
        self._known.take(state)


def _rows_among(ids: Ints, nodes: Ints) -> Ints:
    """Return the rows of some nodes among ids, which ascend, -1 for none; shape of nodes."""
    if not ids.size:
        return np.full(nodes.shape, -1)
    row = np.minimum(np.searchsorted(ids, nodes), ids.size - 1)
    return np.where(ids[row] == nodes, row, -1)


def _same_edges(was: Ints, now: Ints, splits: Sequence[SplitRecord]) -> Ints:
    """Return of each edge in ``now`` its row in ``was``, -1 if it was none, (n,).

    was, now : nodes at the ends, (n, 2).  splits : those in between; an edge of a twin that was
    none before goes on for that of the node it comes from, if that is none any more.
    """
    kept = np.full(len(now), -1)
    count = 1 + max(was.max(initial=0), now.max(initial=0))
    keys, wanted = was[:, 0] * count + was[:, 1], now[:, 0] * count + now[:, 1]
    _, at, to = np.intersect1d(keys, wanted, return_indices=True)
    kept[to] = at
    from_node: dict[int, int] = {}
    for s in splits:
        if s.twin >= 0:
            from_node[s.twin] = from_node.get(s.node, s.node)
    new = np.flatnonzero((kept < 0) & np.isin(now, list(from_node)).any(axis=1))
    taken = set(at.tolist())
    for i in new.tolist():
        a, b = (from_node.get(n, n) for n in now[i].tolist())
        for row in np.flatnonzero(keys == a * count + b).tolist():
            if row not in taken:
                kept[i] = row
                taken.add(row)
    return kept


def _take_over(
    old: EdgeTables, memory: EdgeMemory, kept: Ints, state: State
) -> tuple[float, float]:
    """Give edges what was kept of them; return half the last work, and energy, of those gone."""
    was, to = old.pairs.node, np.flatnonzero(kept >= 0)
    for name in ("side", "depth", "place", "offset", "stored", "force", "put_in"):
        getattr(memory, name)[to] = getattr(old.memory, name)[kept[to]]
    gone = np.setdiff1d(np.arange(len(was)), kept)
    power = (old.memory.force[gone] * state.node.velocity_half[was[gone]]).sum()
    return 0.5 * state.dt * float(power), float(old.memory.stored[gone].sum())
