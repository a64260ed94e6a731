"""Contact of the film with itself: flaps behind the blade, a fold on the sheet, loose pieces.

*What is looked at.* Points are the nodes and the open flank points near cracks and notches, within
``_RINGS`` sides of them, and all nodes of pieces that nothing holds. Their partners are the quads
close to them (:mod:`.close_pairs`), found by a search that lasts until something has moved far
enough. Of the points found, a step looks only at those that may touch: a look says how far the
point may go before it does, and until all that moves has gone so far together, it is skipped.
Film that is near no crack and hangs together touches nothing.

*Force.* A point inside a sheet by the depth D (:mod:`.sheet_contact`) is pushed out with k f(D) by
the law of :mod:`.film_law`; the nodes of the quad take the opposite by their shape functions.

*History.* A point remembers the side of a sheet that it is on, so that however deep it is pushed in
it comes out where it went in. What it sees inside at first sight (film that starts so, a tip that
moves on) does not press: that depth is an offset, which goes as they part. A new half of a split
node has the memory of its other half.

*Impacts.* If the depth changes by more than a fifth of g_M in a step, the spring returns no more
energy than was put in, as in the contact with a tool (:func:`.settings.largest_rebound`), with the
mass 1 / (1/m_P + sum N_a²/m_a) that moves between point and quad.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy, Ints
from shellcut.material.shell_material import ShellMaterial
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.state import KnownTopology, State, local_edge_length
from shellcut.state.pieces import Pieces
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose
from shellcut.tool.touch import Booking, Touch

from .close_pairs import CloseQuads, Film, Own, Pairs
from .film_law import FilmLaw
from .film_outline import FilmOutline, Part
from .self_contact_kernel import add_self_contact, near_springs
from .self_contact_tables import (
    Memory,
    Presses,
    SelfContactTables,
    SelfNodes,
    Ties,
    Touches,
    Waits,
)
from .settings import Contact

# Sides from a crack within which nodes are looked at.
_RINGS = 2

# Margin of the search over the median edge length: it lasts for some ten or a hundred steps.
_MARGIN = 0.75

# Steps between two looks at how far all nodes have moved since the search: at least, at most, and
# by which factor nodes may become faster where there are more than the least. Film at rest may be
# hit: in 20 steps of waves through an edge it goes a quarter of one at a thirtieth of their speed.
_LEAST_STEPS, _MOST_STEPS, _FASTER = 10, 20, 2.0


class SelfContactForces(NamedTuple):
    """Results of one evaluation."""

    work: float
    """Work of the forces on the film since t_{n-1} [N·mm]."""
    stored: float
    """Penalty energy at t_n [N·mm]."""
    n_touching: int
    """Number of points that touch a sheet."""
    deepest: float
    """Largest depth [mm]."""
    n_looked: int
    """Number of points looked at."""


class SelfContact(ForceTerm):
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

    name = "self_contact"
    booked = (Booking("self_contact_work", 0, -1.0),)

    def __init__(
        self,
        contact: Contact,
        film: ShellMaterial,
        edge_length: float,
        part_of: Callable[[int], Part] | None = None,
    ) -> None:
        self.law = FilmLaw.of(contact, film)
        self._margin = _MARGIN * edge_length
        self._outline = FilmOutline(part_of)
        self._close = CloseQuads()
        self._known = KnownTopology()
        self._points: Ints = np.zeros(0, np.int64)
        self._own = Own(np.zeros(1, np.int64), np.zeros(0, np.int64))
        self._film_nodes: Ints = np.zeros(0, np.int64)
        self._x_then = np.zeros((0, 3))
        self._walked, self._walk_to = 0.0, 0.0
        self._look_at = 0
        self.tables: SelfContactTables | None = None
        """What the kernel takes, anew with each search."""
        self.held: Any = None
        """The same, laid out."""
        self._hold = Holder()
        self._call, self._farthest = BoundOnce(add_self_contact), BoundOnce(_farthest)
        self._springs = BoundOnce(near_springs)
        self.forces = SelfContactForces(0.0, 0.0, 0, 0.0, 0)
        """Results of the last evaluation."""
        self.deepest = 0.0
        """Largest depth so far [mm]."""
        self.n_looked = 0
        """Points looked at so far, the work that it has cost."""
        self.touch = Touch.none(0, 1)

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add its forces at t_n to the nodal forces."""
        if self._is_out_of_date(state):
            self._search(state)
        found = self._call.code(state.dt, self._walked, self.held)
        self.forces, self._walked = SelfContactForces(*found[:5]), found[5]
        self.deepest = max(self.deepest, self.forces.deepest)
        self.n_looked += self.forces.n_looked
        self.touch.sums[0] = self.forces.work

    def stiffness(self, _state: State, _counted: HeldBy) -> Held:
        """Return the nodes that may come to press soon and a bound of its stiffness [N/mm].

        A spring k between a point P and a place of a quad stores ½ k (u_P - sum N_a u_a)², at most
        k u_P² + k sum N_a u_a²: no more than 2 k at the point and 2 k N_a at the nodes.
        """
        if self.tables is None:
            return np.zeros(0, np.int64), np.zeros(0)
        room = len(self.tables.pairs.first_pair) - 1
        nodes, stiffness = np.zeros((room, 5), np.int64), np.zeros((room, 5))
        count = self._springs(self._margin, self.held, nodes, stiffness)
        return nodes[:count].ravel(), 2.0 * self.law.steepest * stiffness[:count].ravel()

    def stored(self, _state: State) -> dict[str, float]:
        """Return the penalty energy at the last evaluation, by its name in the ledger [N·mm]."""
        return {"self_contact_stored": self.forces.stored}

    # ---------------------------------------------------------------- search

    def _is_out_of_date(self, state: State) -> bool:
        """Whether the pairs may lack one that touches before the next look."""
        if not self._known.is_of(state):
            return True
        waits = self._walked <= self._walk_to  # by nodes that are listed, at each step
        if waits and 0 < state.step < self._look_at:  # before the run film may be put anywhere
            return False
        n = state.node
        way, speed = self._farthest(self._film_nodes, n.x, self._x_then, n.velocity_half)
        left, step = 0.5 * self._margin - way, state.dt * speed
        if left < _LEAST_STEPS * step:
            return True
        # The way walked counts motion back and forth, too.
        self._walk_to = self._walked + left
        steps = _MOST_STEPS if left > _FASTER * _MOST_STEPS * step else left / (_FASTER * step)
        self._look_at = state.step + max(int(steps), _LEAST_STEPS)
        return False

    def _search(self, state: State) -> None:
        before, memory = self.tables, None
        if not self._known.is_of(state):
            self._choose_points(state)
        outline, n = self._outline.of(state), state.node
        reach = self.law.thickness + self._margin
        film = self._film(state)
        pairs = self._close.find(self._points, self._own, film, state.n_quad, reach)
        memory = Memory.blank(len(pairs.first_pair) - 1)
        if before is not None:
            _take_over(before.pairs, before.memory, pairs, memory, state)
        self._known.take(state)
        self._x_then = n.x[: n.count].copy()
        self._walked, self._walk_to = 0.0, 0.5 * self._margin
        self._look_at = state.step + _LEAST_STEPS
        self.n_search += 1
        last = None if self.tables is None else self.tables.presses
        presses = Presses.with_room(len(memory.side), last)
        self._lay_out(state, pairs, memory, presses, outline)

    def _lay_out(
        self,
        state: State,
        pairs: Pairs,
        memory: Memory,
        presses: Presses,
        outline: Any,
        waits: Waits | None = None,
    ) -> None:
        """Build the kernels' tables, good until the next search."""
        n, f, quads = state.node, state.flank, state.quad.nodes
        flank = np.full(len(n.x), -1)
        flank[f.node[: f.count]] = np.arange(f.count)
        # Film moves as the ends of its flanks and its nodes do, not as virtual nodes swing.
        listed = np.zeros(len(quads), np.bool_)
        listed[pairs.row] = True
        near = np.zeros(len(n.x), np.bool_)
        near[quads[listed]] = True
        near[f.node[: f.count]] = listed[f.row[: f.count]]
        near[pairs.node] = True
        self.tables = SelfContactTables(
            law=self.law,
            pairs=pairs,
            stiffness=self.law.stiffness(n, pairs.node),
            memory=memory,
            waits=waits or Waits(np.zeros(len(pairs.node)), np.zeros(len(pairs.row))),
            moving=self._film_nodes[near[self._film_nodes]],
            outline=outline,
            quads=quads,
            nodes=SelfNodes(**{name: getattr(n, name) for name in SelfNodes._fields}),
            ties=Ties(flank, f.nodes, f.weight),
            presses=presses,
            touches=Touches.with_room(len(presses.node)),
        )
        self.held = self._hold(self.tables)

    def _choose_points(self, state: State) -> None:
        """Choose the points of a new topology: near cracks, and of pieces that nothing holds."""
        n, quads = state.node, state.quads
        near = n.halved[: n.count].copy()
        for _ in range(_RINGS):
            near[quads[near[quads].any(axis=1)]] = True
        near |= Pieces.of(state).loose_nodes(state)
        film = n.real[: n.count].copy()
        film[state.flank.node[: state.flank.count]] = True
        self._film_nodes = np.flatnonzero(film)
        self._points = np.flatnonzero(near & n.real[: n.count])
        beside = self.law.thickness / local_edge_length(n.contact_area[self._points])
        self._own = self._close.own(self._points, 1 + beside.astype(np.int64), self._film(state))

    def _film(self, state: State) -> Film:
        n, absent = state.node, self._outline.of(state).absent
        return Film(n.x, state.quad.nodes, n.quads, absent, n.n_quad_at)

    # ---------------------------------------------------------------- restart

    def saved(self) -> dict[str, Any]:
        """Return pairs, memory and the last forces."""
        saved: dict[str, Any] = {
            "revision": self._known.revision,
            "x_then": self._x_then,
            "walked": self._walked,
            "walk_to": self._walk_to,
            "look_at": self._look_at,
            "forces": self.forces._asdict(),
            "deepest": self.deepest,
            "n_looked": self.n_looked,
            "n_search": self.n_search,
        }
        t = self.tables
        if t is not None:
            saved |= {
                "pairs": t.pairs._asdict(),
                "memory": t.memory._asdict(),
                "waits": t.waits._asdict(),
                "presses": t.presses.saved(),
            }
        return saved

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._choose_points(state)
        self._known.restore(saved["revision"], state)
        self._x_then, self._walked = saved["x_then"].copy(), saved["walked"]
        self._walk_to, self._look_at = saved["walk_to"], saved["look_at"]
        self.forces, self.deepest = SelfContactForces(**saved["forces"]), saved["deepest"]
        self.touch.sums[0] = self.forces.work
        self.n_looked, self.n_search = saved["n_looked"], saved["n_search"]
        if "pairs" not in saved:
            self.tables = None
            return
        pairs = Pairs(**_copies(saved["pairs"]))
        memory = Memory(**_copies(saved["memory"]))
        presses = Presses.of_saved(saved["presses"], len(memory.side))
        waits = Waits(**_copies(saved["waits"]))
        self._lay_out(state, pairs, memory, presses, self._outline.of(state), waits)


def _copies(arrays: dict[str, Any]) -> dict[str, Any]:
    return {name: array.copy() for name, array in arrays.items()}


def _take_over(old: Pairs, was: Memory, new: Pairs, memory: Memory, state: State) -> None:
    """Give sheets what was remembered of a sheet with a common quad and the same point.

    A point that is new has the memory of another half of its node at the same place.
    """
    if not old.row.size or not new.row.size:
        return
    n_row, n = len(state.quad.nodes), state.node
    of_old, of_new = old.sheet_of_pair, new.sheet_of_pair
    # There is nothing to remember of sheets that nothing has come close to, most of them.
    met = np.flatnonzero(was.met[of_old])
    if not met.size:
        return
    of_old = of_old[met]
    key = old.node_of_sheet[of_old] * n_row + old.row[met]
    point = new.node_of_sheet[of_new]
    fresh = np.setdiff1d(new.node, old.node)
    for node in fresh.tolist():
        halves = old.node[n.origin[old.node] == n.origin[node]]
        same = halves[(n.x[halves] == n.x[node]).all(axis=1)]
        if same.size:
            point[point == node] = same[0]
    order = np.argsort(key, kind="stable")
    wanted = point * n_row + new.row
    at = order[np.minimum(np.searchsorted(key[order], wanted), key.size - 1)]
    common = np.flatnonzero(key[at] == wanted)
    # Of several old sheets that have become one, the one that presses most: it is written last.
    common = common[np.argsort(was.force[of_old[at[common]]], kind="stable")]
    for name in Memory._fields:
        getattr(memory, name)[of_new[common]] = getattr(was, name)[of_old[at[common]]]


@kernel
def _farthest(nodes: Ints, x: Floats, then: Floats, velocity: Floats) -> tuple[float, float]:
    """Return how far some nodes have moved at most, and their largest speed."""
    way = speed = 0.0
    for i in range(nodes.shape[0]):
        n = nodes[i]
        moved = fast = 0.0
        for c in range(3):
            moved += (x[n, c] - then[n, c]) ** 2
            fast += velocity[n, c] ** 2
        way, speed = max(way, moved), max(speed, fast)
    return np.sqrt(way), np.sqrt(speed)
