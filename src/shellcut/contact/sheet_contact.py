"""Contact of points with sheets of film: of the tool's corners and edges, and of film with film.

*Film with film*: flaps behind the blade, a fold on the sheet, other pieces. Points are the nodes
and the open flank points near cracks and notches, within ``_RINGS`` sides of them, and all nodes of
pieces that are loose or not the heaviest. A piece that is near no crack does not touch itself.

*The tool*: nodes feel its faces; a corner of it that comes down between nodes feels the film here
(:mod:`.tool_points`). The side of the film on which it is first near, facing it, is its own;
when it has passed the film by g it presses with k_p f(g). k_p is the stiffness of a node there over
the number of points that may press on its quads together: a single tip is as stiff as a node, and
so are all points of a ball that are on one node's quads. It leaves film at a crack alone: quads
with a node on a flank, and cut ones. There the blade is between the flanks; a corner of it that
overlaps a quad a little did not come through its face. The flanks are kept apart by the nodes on
the blade's faces. A point that slips off the border, or whose film is cut, loses contact, and the
energy of its spring is lost.

*Force.* A point inside a sheet by the depth D (:mod:`.quad_distance`) gets k f(D) in its outward
direction, the nodes of the quad the opposite by their shape functions: the gradient of k ∫f, in the
nodes as in the tool.

*Search and waiting.* Pairs of points and quads (:mod:`.pair_search`) are listed until something may
have moved by half of the margin (:class:`.near_nodes.ListAge`). A step adds to the distance
*walked* by how much points and film may have approached each other. Only those points found are
evaluated that may touch: an evaluation tells how far the point may move before it does, and until
that distance has been walked the point is skipped.

*History.* A point remembers the side of a sheet that it is on, so that however deep it is pushed in
it comes out on the side where it entered. A depth at the first evaluation (film that starts so, a
tip that moves on) does not press: it is an offset, which vanishes as they separate. A new half of a
split node has the memory of its other half.

*Impacts.* If the depth changes by more than a fifth of g_M in a step, the spring returns no more
energy than was put in, as where nodes touch the tool (:func:`.settings.largest_rebound`), with the
mass 1 / (1/m_P + sum N_a²/m_a) that moves between point and quad; a point of the tool has no 1/m_P.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, NodeStiffness, StiffnessBy
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.kept import take_over
from shellcut.state import KernelNodes, KnownTopology, State, local_edge_length
from shellcut.state.pieces import Pieces
from shellcut.tool.pose import Pose
from shellcut.tool.touch import Booking

from .contact_tables import (
    ContactPoints,
    Memory,
    Presses,
    SheetTables,
    ToolPoints,
    Waits,
    carry_over,
)
from .film_outline import FilmOutline, Part
from .near_nodes import Clock, ListAge, film_nodes
from .pair_search import Pairs, PairSearch, Points
from .penalty_contact import PenaltyContact
from .press_term import DEEPEST, STORED, WORK, PressTerm
from .settings import STEEPEST, Contact, SheetLaw, film_stiffness
from .sheet_press import add_sheet_forces, closest_of_pairs
from .tool_points import tool_points

# Sides from a crack within which nodes are evaluated.
_RINGS = 2

# Margin of the search over the edge length, of nodes and of points of the tool: it lasts for some
# ten or a hundred steps.
_MARGIN, _SLACK = 0.75, 0.6

# Distance of a point of the tool from the film beyond which it does not touch it, and distance
# moved after which a point that does not face the film is evaluated again, over the edge length.
_CAPTURE, _UNDECIDED = 0.5, 0.02


class SheetContact(PressTerm):
    """Points that press on sheets of film: what is the same for nodes and for points of the tool.

    Parameters
    ----------
    name : str
        Of the term.
    law : SheetLaw
    points : ToolPoints
        None of a term whose points are nodes.
    n_tooth : int
        Teeth of the tool.
    margin : float
        Of the search [mm].
    outline : FilmOutline
        Of the film.
    """

    kept_names = (
        *PressTerm.kept_names,
        "_pairs",
        "_memory",
        "_waits",
        "_age",
        "_met",
        "_tracked",
        "deepest",
        "n_looked",
        "n_search",
    )

    def __init__(
        self,
        name: str,
        law: SheetLaw,
        points: ToolPoints,
        n_tooth: int,
        margin: float,
        outline: FilmOutline,
    ) -> None:
        nothing = np.zeros(0, np.int64)
        super().__init__(name, n_tooth, nothing)
        self.law, self.points, self._margin, self._outline = law, points, margin, outline
        self._of_tool = n_tooth > 0
        radius = float(np.linalg.norm(points.place, axis=1).max(initial=0.0))
        self._clock = Clock(nothing, np.zeros(1), radius)
        self._pairs, self._memory = Pairs.none(), Memory.blank(0)
        self._point_of_sheet: Ints = nothing
        self._met: Bools = np.zeros(0, np.bool_)
        self._waits, self._presses = Waits(np.zeros(0), np.zeros(0)), Presses.with_room(0)
        self._tracked: Ints = nothing
        self._age = ListAge(0.5 * margin, radius if self._of_tool else None)
        self._find = PairSearch()
        self._call, self._closest = BoundOnce(add_sheet_forces), BoundOnce(closest_of_pairs)
        self.address: Any = None
        """That of the tables, for the kernels."""
        self.deepest = 0.0
        """Largest depth so far [mm]."""
        self.n_looked = 0
        """Points evaluated so far, a measure of the work."""

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the forces at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        if self._age.is_over(state, pose, self._tracked):
            self._search(state, pose)
        self.n_looked += self._call.code(pose, before, state.dt, self.address, self._touch)
        self.deepest = max(self.deepest, float(self.touch.sums[DEEPEST]))

    def point_of_sheet(self) -> Ints:
        """Return the point of every contact point."""
        return self._point_of_sheet

    def knows_side(self) -> Bools:
        """Return of every contact point whether its point has a known side of the sheet."""
        return np.asarray(self._memory.side != 0)

    def _near(self, state: State, pose: Pose) -> tuple[Points, Ints, Ints]:
        """Return the points that need partners, the quads that may be, and the nodes near them."""
        raise NotImplementedError

    def _stiffness_of(self, state: State) -> Floats:
        """Return k of every pair [N/mm]."""
        raise NotImplementedError

    # ---------------------------------------------------------------- search

    def _search(self, state: State, pose: Pose) -> None:
        """List the pairs anew."""
        was, had, had_points, met = self._pairs, self._memory, self.carriers, self._met
        points, rows, self._tracked = self._near(state, pose)
        reach = self._margin + (self.law.capture if self._of_tool else self.law.thickness)
        self._pairs = self._find.find(points, rows, reach, state)
        n_sheet, n_point = self._pairs.n_sheet, len(self._pairs.point)
        self.kept = self._same_sheets(was, state)
        self._memory, self._met = Memory.blank(n_sheet), np.zeros(n_sheet, np.bool_)
        self.carriers = ContactPoints.of(np.zeros((n_sheet, 4), np.int64))
        now = *self._memory[1:], *self.carriers, self._met
        carry_over(now, (*had[1:], *had_points, met), self.kept)
        self._waits = Waits(np.zeros(n_point), np.zeros(len(self._pairs.row)))
        self._presses = Presses.with_room(n_sheet, self._presses)
        self._age.begin(state, pose)
        self._clock.walked[0] = 0.0
        self.n_search += 1
        self._lay_out(state)

    def _same_sheets(self, old: Pairs, state: State) -> Ints:
        """Return for each sheet that of old pairs with a common quad and the same point, or -1.

        A node that is new has those of another half of its node at the same place.
        """
        new, kept, n = self._pairs, np.full(self._pairs.n_sheet, -1), state.node
        # There is nothing to remember of most sheets: their points have not come close, or got a
        # side.
        of_old, of_new = old.sheet_of_pair, new.sheet_of_pair
        known = self._memory.side != 0 if self._of_tool else self._met
        met = np.flatnonzero(known[of_old])
        if not met.size or not new.row.size:
            return kept
        of_old, n_row = of_old[met], len(state.quad.nodes)
        key = old.point_of_sheet[of_old] * n_row + old.row[met]
        point = new.point_of_sheet[of_new]
        fresh = [] if self._of_tool else np.setdiff1d(new.point, old.point).tolist()
        for node in fresh:
            halves = old.point[n.origin[old.point] == n.origin[node]]
            same = halves[(n.x[halves] == n.x[node]).all(axis=1)]
            if same.size:
                point[point == node] = same[0]
        order = np.argsort(key, kind="stable")
        wanted = point * n_row + new.row
        at = order[np.minimum(np.searchsorted(key[order], wanted), key.size - 1)]
        common = np.flatnonzero(key[at] == wanted)
        # Of several old sheets that have become one, that which presses most: it is written last.
        pressed = self.carriers.pressure[of_old[at[common]]]
        common = common[np.argsort(pressed, kind="stable")]
        kept[of_new[common]] = of_old[at[common]]
        return kept

    def _lay_out(self, state: State) -> None:
        """Build the kernels' tables, good until the next search."""
        f, pairs, quads = state.flank, self._pairs, state.quad.nodes
        self._point_of_sheet = pairs.point_of_sheet
        # Film moves as the ends of its flanks and its nodes do, not as virtual nodes swing.
        listed, near = np.zeros(len(quads), np.bool_), np.zeros(len(state.node.x), np.bool_)
        listed[pairs.row] = True
        near[quads[listed]] = True
        near &= state.node.real
        near[f.node[: f.count]] = listed[f.row[: f.count]]
        if not self._of_tool:
            near[pairs.point] = True
        self._clock = self._clock._replace(node=np.flatnonzero(near))
        self.tables = SheetTables(
            of_tool=self._of_tool,
            law=self.law,
            points=self.points,
            pairs=pairs,
            stiffness=self._stiffness_of(state),
            memory=self._memory,
            met=self._met,
            waits=self._waits,
            clock=self._clock,
            outline=self._outline.of(state),
            quads=quads,
            nodes=KernelNodes.of(state.node),
            contact_points=self.carriers,
            presses=self._presses,
        )
        self.address = self._address_of(self.tables)

    def _places(self, within: float = np.inf) -> Floats:
        """Return distance [mm] and weights of the closest place of every pair, (n_pair, 5).

        Without weights where the quad's box is farther away than ``within`` [mm].
        """
        found = np.zeros((len(self._pairs.row), 5))
        if self._pose is not None:
            self._closest(self._pose, self.address, within, found)
        return found

    # ---------------------------------------------------------------- restart

    def saved(self) -> dict[str, Any]:
        """Return pairs, memory and the last forces."""
        walked = float(self._clock.walked[0])
        return super().saved() | {"presses": self._presses.saved(), "walked": walked}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose."""
        take_over(self, self.kept_names, saved)
        self._pose = pose
        self._presses = Presses.with_room(self._pairs.n_sheet, Presses(**saved["presses"]))
        self._clock.walked[:] = saved["walked"]
        self._lay_out(state)


class PointContact(SheetContact):
    """Contact of the tool's points with quads.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes, evaluated before this in every step.
    edge_length : float
        Of the film's smaller quads [mm].
    """

    def __init__(self, contact: PenaltyContact, edge_length: float) -> None:
        law = SheetLaw(
            thickness=0.0,
            smoothing_depth=contact.law.smoothing_depth,
            capture=_CAPTURE * edge_length,
            undecided=_UNDECIDED * edge_length,
        )
        tool = contact.tool
        points = tool_points(tool, edge_length, contact.law.smoothing_depth)
        super().__init__("points", law, points, tool.n_tooth, _SLACK * edge_length, FilmOutline())
        self.nodes = contact
        """The contact of nodes."""

    def felt_nodes(self) -> Ints:
        """Return the nodes of the quads that a point presses on."""
        return np.unique(self.carriers.node[self.carriers.pressure > 0.0])

    def stiffness(self, _state: State, _counted: StiffnessBy) -> NodeStiffness:
        """Return the nodes that points may press soon and their steepest penalty [N/mm].

        A spring k_p on the foot is no stiffer than springs k_p N_a at the nodes (the N_a weigh a
        mean). Between two searches a point moves by half of the margin at most from where it was
        listed, so by the whole of it from where it is now. So only points count that press or are
        no farther from a quad, and N_a of its nodes is taken as 1 + ``_SLACK`` - distance over edge
        length, from 0 to 1.
        """
        if self.tables is None or self._pose is None:
            return np.zeros(0, np.int64), np.zeros(0)
        nodes, pairs = self.tables.nodes, self._pairs
        sheet, depth = pairs.sheet_of_pair, self._memory.depth
        within = self._margin + float(depth.max(initial=0.0))
        soon = self._places(within)[:, 0] <= self._margin + depth[sheet]
        points = pairs.point_of_pair[soon, None]
        key = points * len(nodes.x) + self.tables.quads[pairs.row[soon]]
        point, node = np.divmod(np.unique(key), len(nodes.x))
        p, area = self._pose.to_space(self.points.place)[point], nodes.contact_area[node]
        away = np.linalg.norm(nodes.x[node] - p, axis=1) / local_edge_length(area)
        weight = self.points.share[point] * np.clip(1.0 + _SLACK - away, 0.0, 1.0)
        return node, weight * self.nodes.law.steepest(area)

    def _near(self, state: State, pose: Pose) -> tuple[Points, Ints, Ints]:
        near, place = self.nodes.near, pose.to_space(self.points.place)
        rows = near.within(near.margin, state.quads, state, pose)
        halved = state.node.halved[state.quads[rows]].any(axis=1)
        whole = rows[(state.quad.share[rows] >= 1.0) & ~halved]
        points = Points(np.arange(len(place)), place, np.full(len(place), -1))
        return points, whole, near.ids

    def _stiffness_of(self, state: State) -> Floats:
        area = state.node.contact_area[state.quad.nodes[self._pairs.row]].mean(axis=1)
        share = self.points.share[self._pairs.point_of_pair]
        return share * self.nodes.law.of_nodes(area)


class SelfContact(SheetContact):
    """Forces of the film on itself.

    Parameters
    ----------
    contact : Contact
        Parameters.
    film : ShellMaterial
        Of the film, which sets the law.
    edge_length : float
        Of a typical quad [mm].
    part_of : Callable, optional
        Returns the polygon of a row, if quads may be cut.
    """

    booked = (Booking("self_contact_work", WORK, -1.0),)

    def __init__(
        self,
        contact: Contact,
        film: ShellMaterial,
        edge_length: float,
        part_of: Callable[[int], Part] | None = None,
    ) -> None:
        law = SheetLaw(film.thickness, contact.smoothing * film.thickness)
        outline, margin = FilmOutline(part_of), _MARGIN * edge_length
        super().__init__("self_contact", law, ToolPoints.none(), 0, margin, outline)
        self._film, self._ids, self._rings = film, self._tracked, self._tracked
        self._chosen_for = KnownTopology()

    def stiffness(self, _state: State, _counted: StiffnessBy) -> NodeStiffness:
        """Return the nodes that may press soon and a bound of its stiffness [N/mm].

        A spring k between a point P and a place of a quad stores ½ k (u_P - sum N_a u_a)², at most
        k u_P² + k sum N_a u_a²: no more than 2 k at the point and 2 k N_a at the nodes. It is taken
        at the places of sheets that are closest now, of points closer to them than the thickness
        and the margin.
        """
        if self.tables is None:
            return np.zeros(0, np.int64), np.zeros(0)
        pairs, places = self._pairs, self._places()
        order = np.lexsort((places[:, 0], pairs.sheet_of_pair))
        nearest = order[pairs.first_pair[:-1]]
        nearest = nearest[places[nearest, 0] <= self.law.thickness + self._margin]
        node = np.column_stack(
            [pairs.point_of_pair[nearest], self.tables.quads[pairs.row[nearest]]]
        )
        k = self.tables.stiffness[nearest, None] * np.insert(places[nearest, 1:], 0, 1.0, axis=1)
        return node.ravel(), 2.0 * STEEPEST * k.ravel()

    def stored(self, _state: State) -> dict[str, float]:
        """Return the penalty energy at the last evaluation, by its name in the balance [N·mm]."""
        return {"self_contact_stored": float(self.touch.sums[STORED])}

    def _near(self, state: State, pose: Pose) -> tuple[Points, Ints, Ints]:
        n, quads = state.node, state.quads
        if not self._chosen_for.is_of(state):
            near = n.halved[: n.count].copy()
            for _ in range(_RINGS):
                near[quads[near[quads].any(axis=1)]] = True
            near |= Pieces.of(state).nodes_that_meet_others(state)
            self._ids = np.flatnonzero(near & n.real[: n.count])
            beside = self.law.thickness / local_edge_length(n.contact_area[self._ids])
            self._rings = 1 + beside.astype(np.int64)
            self._chosen_for.take(state)
        rows = np.flatnonzero(~self._outline.of(state).absent[: state.n_quad])
        return Points(self._ids, n.x[self._ids], self._rings), rows, film_nodes(state)

    def _stiffness_of(self, state: State) -> Floats:
        return film_stiffness(state.node, self._pairs.point_of_pair, self._film)


def felt_nodes(terms: Iterable[object]) -> Ints:
    """Return the nodes of the quads that a point of the tool presses on, ascending."""
    felt = [term.felt_nodes() for term in terms if isinstance(term, PointContact)]
    return np.unique(np.concatenate(felt)) if felt else np.zeros(0, np.int64)
