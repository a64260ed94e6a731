"""Coulomb friction where edges of the film cross edges of the tool.

An edge of the film from a node a to a node b that presses on an edge of the tool between them
(:mod:`.edge_contact`) is held there, at its place s, by a spring across the way out n, as nodes are
on the tool's faces (:mod:`.coulomb_friction`): u is its elongation in the tool's frame, d what the
film at s has moved against the tool in the step, P = 1 - n n^T,

    u* = P (u + d),    u' = u* min(1, mu N / (k_t |u*|)),    force on the film -k_t u',

with the shares 1 - s and s on a and b, and minus that at s on the tool. d is the way of the film's
material there, s held: where the edges slide along one another their crossing runs away from it.

*Which pressure.* The edge presses with the energy that the film at s has over that of its ends
(:mod:`.edge_contact`): with f(D) at s, and takes (1 - s) f(D_a) and s f(D_b) from what its ends are
pressed with. The nodes rub with all that they are pressed with. So mu multiplies what the edge
adds,

    N = k max(f(D) - (1 - s) f(D_a) - s f(D_b), 0),

and friction of nodes and edges together takes mu times the sum of all pressures at most: N_a + N_b
+ N is what presses at a, at b and at s together.

*Works*, as of the tool's points (:mod:`.point_friction`): the force f of t_{n-1} has acted on the
film at its own place, which has moved by d_f, so

    dissipated = - ½ (f · d_f + f' · d) - (stored' - stored),

the mean force times the slip where the place stays.

*History.* The spring belongs to the edge of the film: it is kept from one edge of the tool to the
next, through new lists and checkpoints, and through splits along edges of the mesh (a twin's edge
goes on with it); a cut through quads that gives an end a new node lets it go. Towards an end of the
film's edge g goes to zero, so N does, and the node takes over.

*Stiffness.* Pressures of nodes and edges add up to those of nodes alone (:mod:`.edge_contact`), and
so does the slip that they let go; but the springs of the nodes stay as stiff as they are, and those
of the edges come on top, with k_t at both ends.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Held, HeldBy, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import add, combine, cross, dot, load, norm, scale, store, sub
from shellcut.state import State
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.touch import Touch

from .edge_contact import EdgeContact
from .edge_kernel import edge_stiffness
from .edge_tables import EdgeNodes, EdgeTables
from .friction_term import DISSIPATED, TANGENTIAL, WORK, ToolFriction
from .settings import STEEPEST


class _Springs(NamedTuple):
    """Springs of the film's edges, in the order of the contact's list; the kernel writes."""

    node: Annotated[Ints, "(n_film, 2)"]
    """Ends of the edge."""
    place: Annotated[Floats, "(n_film,)"]
    """Where the force acts, from 0 at one end to 1 at the other."""
    spring: Annotated[Floats, "(n_film, 3)"]
    """Elongation u in the tool's frame [mm]."""
    pull: Annotated[Floats, "(n_film, 3)"]
    """Force on the film in the tool's frame [N]."""
    force: Annotated[Floats, "(n_film, 3)"]
    """The same in space."""
    stored: Annotated[Floats, "(n_film,)"]
    """Energy [N·mm]."""

    @classmethod
    def at_rest(cls, node: Ints) -> _Springs:
        """Return those of edges with these ends that nothing presses."""
        n = len(node)
        return cls(
            node=node.copy(),
            place=np.zeros(n),
            spring=np.zeros((n, 3)),
            pull=np.zeros((n, 3)),
            force=np.zeros((n, 3)),
            stored=np.zeros(n),
        )


class EdgeFriction(ToolFriction):
    """Friction of the film's edges, a :class:`shellcut.simulation.tool_terms.ToolTerm`.

    Parameters
    ----------
    edges : EdgeContact
        Presses edges of the film on those of the tool; evaluated before this in every step.
    coefficient : float
        mu.
    """

    def __init__(self, edges: EdgeContact, coefficient: float) -> None:
        super().__init__("edge_friction", edges, coefficient)
        self._edges = edges
        self._of: EdgeTables | None = None
        self._springs = _Springs.at_rest(np.zeros((0, 2), np.int64))
        self._held: Any = None
        self._pose: Pose | None = None
        self._hold = Holder()
        self._call, self._let_go = BoundOnce(_add_edge_friction), BoundOnce(_let_go)

    def stiffness(self, state: State, counted: HeldBy) -> Held:
        """Return the ends of edges that may press soon and what friction adds there [N/mm]."""
        slips, springs = super().stiffness(state, counted), self._edges.stiffness_alone()
        return (
            np.concatenate([slips[0], springs[0]]),
            np.concatenate([slips[1], TANGENTIAL / STEEPEST * springs[1]]),
        )

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the friction at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        quiet, renewed = self._is_quiet(), self._of is not self._edges.tables
        if renewed:
            work, lost = self._take_list(state, before, pose)
        elif quiet and self._rests:
            return
        self._call.code(
            pose, before, state.dt, self.coefficient, self._edges.held, self._held, self._touch
        )
        if renewed:
            self.touch.sums[WORK] += work
            self.touch.sums[DISSIPATED] += lost
        self._rests = quiet and not renewed

    def saved(self) -> dict[str, Any]:
        """Return the springs and the last forces."""
        return {"springs": self._springs._asdict(), "touch": self.touch._asdict()}

    def restore(self, _state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose; after the edges'."""
        self._pose = pose
        self.touch.take(saved["touch"])
        self._rests = False
        self._take(_Springs(**{name: rows.copy() for name, rows in saved["springs"].items()}))

    def _take_list(self, state: State, before: Pose, pose: Pose) -> tuple[float, float]:
        """Switch to the edges' new list.

        Returns half the last work of edges that have left it, and what they dissipate [N·mm].
        """
        tables, kept, old = self._edges.tables, self._edges.kept, self._springs
        assert tables is not None
        gone = np.setdiff1d(np.arange(len(old.node)), kept)
        gone = gone[old.force[gone].any(axis=1)]
        lost = 0.0, 0.0
        if gone.size:
            lost = self._let_go(pose, before, state.dt, gone, old, tables.nodes)
        springs, to = _Springs.at_rest(tables.pairs.node), np.flatnonzero(kept >= 0)
        for new, was in zip(springs[1:], old[1:], strict=True):
            new[to] = was[kept[to]]
        self._take(springs)
        return lost

    def _take(self, springs: _Springs) -> None:
        self._of = self._edges.tables
        self._springs, self._held = springs, self._hold(springs)


@inline
def _way_of_place(
    i: int, springs: _Springs, nodes: EdgeNodes, dt: float, pose: Pose, before: Pose
) -> tuple[Vec3, Vec3, Vec3]:
    """Return the place of a spring, its velocity, and its way against the tool in its frame."""
    a, b, s = springs.node[i, 0], springs.node[i, 1], springs.place[i]
    x = combine(1.0 - s, load(nodes.x, a), s, load(nodes.x, b))
    moves = combine(1.0 - s, load(nodes.velocity_half, a), s, load(nodes.velocity_half, b))
    return x, moves, sub(to_body(x, pose), to_body(combine(1.0, x, -dt, moves), before))


@kernel
def _let_go(
    pose: Pose, before: Pose, dt: float, gone: Ints, springs: _Springs, nodes: EdgeNodes
) -> tuple[float, float]:
    """Return half the work of some springs over the last step, and what they dissipate [N·mm]."""
    pose, before = borrowed(pose), borrowed(before)
    springs, nodes = borrowed(springs), borrowed(nodes)
    work = dissipated = 0.0
    for i in gone:
        _, moves, d = _way_of_place(i, springs, nodes, dt, pose, before)
        work += 0.5 * dt * dot(load(springs.force, i), moves)
        dissipated += springs.stored[i] - 0.5 * dot(load(springs.pull, i), d)
    return work, dissipated


@kernel
def _add_edge_friction(
    pose: Pose,
    before: Pose,
    dt: float,
    coefficient: float,
    tables: EdgeTables,
    springs: _Springs,
    touch: Touch,
) -> None:
    """Add the friction of the edges to the forces of their ends.

    Writes the springs and touch, see :class:`.friction_term.FrictionForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    springs = borrowed(springs)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    presses, nodes, origin = tables.presses, tables.nodes, pose.translation
    work = stored = dissipated = 0.0
    n_slipping = 0
    for i in range(springs.stored.shape[0]):
        pressure, old = presses.pressure[i], load(springs.force, i)
        held = dot(old, old) > 0.0
        if pressure <= 0.0 and not held:
            continue
        if held:
            _, moves, d = _way_of_place(i, springs, nodes, dt, pose, before)
            work += 0.5 * dt * dot(old, moves)
            dissipated -= 0.5 * dot(load(springs.pull, i), d)
        dissipated += springs.stored[i]
        springs.stored[i] = 0.0
        new, pull, f = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if pressure > 0.0:
            s = springs.place[i] = presses.place[i]
            x, moves, d = _way_of_place(i, springs, nodes, dt, pose, before)
            stiffness = TANGENTIAL * edge_stiffness(i, tables.pairs, nodes, tables.law)
            pulled, out = add(load(springs.spring, i), d), load(presses.out, i)
            normal = scale(1.0 / norm(out), out)
            new = combine(1.0, pulled, -dot(pulled, normal), normal)
            most, trial = coefficient * pressure, stiffness * norm(new)
            if trial > most:
                new = scale(most / trial, new)
                n_slipping += 1
            pull = scale(-stiffness, new)
            f = turn(pull, pose)
            springs.stored[i] = 0.5 * stiffness * dot(new, new)
            stored += springs.stored[i]
            work += 0.5 * dt * dot(f, moves)
            dissipated -= 0.5 * dot(pull, d) + springs.stored[i]
            a, b, body = springs.node[i, 0], springs.node[i, 1], presses.body[i]
            moment = cross((x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]), f)
            for c in range(3):
                nodes.force[a, c] += (1.0 - s) * f[c]
                nodes.force[b, c] += s * f[c]
                wrench[body, c] -= f[c]
                wrench[body, 3 + c] -= moment[c]
        store(springs.spring, i, new)
        store(springs.pull, i, pull)
        store(springs.force, i, f)
    sums[0], sums[1], sums[2], sums[3] = work, dissipated, stored, n_slipping
