"""Coulomb friction of film and tool, regularised by a spring.

Where a term presses the film on the tool with the force N along the outward normal n, at a carrier
(a node, a place of an edge, the foot of a point of the tool on a quad), the film gets a tangential
force besides. An elastic spring holds it to the tool; u is its elongation, the elastic slip, a
vector in the tool's frame, so that the tool carries it along whatever it does. Over a step in which
the film at the carrier moves by d against the tool,

    u* = P (u + d),   P = 1 - n n^T                                     (trial: it sticks)
    u' = u* min(1, mu N / (k_t |u*|)),   force f' = -k_t u'             (else it slips)

which is the return mapping of rigid-plastic slip with the elastic part k_t [Wriggers2006]: sticking
up to mu N, then slipping with mu N against the slip, whatever the length of the step. The nodes of
the carrier take f' by their shape functions, the tool minus that.

*Works.* The force f of t_{n-1} has acted on its own carrier, which has moved by d_f, and f' acts on
that of now. So with the energies -½ f·u and -½ f'·u' that the spring stored and stores

    dissipated = -½ (f·d_f + f'·d) - ½ f·u + ½ f'·u'.

With the same carrier and k_t as in the last step (a node) that is ½ k_t (u + u')·(u + d - u'), the
mean force times the slip: also for a normal that turns (the spring loses its part along n), and for
what comes off (N = 0, so u' = 0: what was stored is dissipated). The work itself comes from the
forces on film and tool, each in their own motion, so that work = stored + dissipated is a check.

*History.* The spring of a node is kept in the state, and a split leaves its new node that of the
node it comes from. The spring of a point of the tool follows the point from quad to quad. That of
a place on an edge stays with the place. What leaves the list of the term that presses it lets go.

*Stiffness.* k_t is ``TANGENTIAL`` times the k of the penalty: what is pressed slips by mu N / k_t =
2 mu f(g) from rest, less than its own depth for mu up to ½. The spring acts across the normal, the
penalty along it; slip adds the unsymmetric term mu k f'. With a = 27/16 the steepest slope of the
penalty, the largest singular value of the two together is at most k sqrt(a² (1 + mu²) +
TANGENTIAL²). What that is more than a k enters the bound on the step, 4 % of a k for mu = 0.2, so
2 % of the step at most. Places on edges share the k of their nodes, and so its springs.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Held, HeldBy, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.vec3 import add, add_scaled, add_to, dot, load, norm, scale, store, sub
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose, to_body, turn, turn_back
from shellcut.tool.touch import ON_TOOL, Booking, Touch, react

from .contact_tables import Carriers, ContactNodes
from .press_forces import TOUCHING, PressTerm
from .settings import STEEPEST

TANGENTIAL = 0.5
"""Stiffness of the tangential spring over that of the penalty."""


def stiffer_by(coefficient: float) -> float:
    """Return what friction adds to the steepest penalty in the bound on the step, over that."""
    coupled = (1.0 + coefficient**2) + (TANGENTIAL / STEEPEST) ** 2
    return float(np.sqrt(coupled)) - 1.0


@always_inline
def return_mapping(trial: Vec3, normal: Vec3, stiffness: float, most: float) -> tuple[Vec3, bool]:
    """Return the elastic slip u' [mm], and whether it slips.

    trial : u + d [mm].  stiffness : k_t [N/mm].  most : mu N [N].
    """
    new = add_scaled(trial, -dot(trial, normal), normal)
    pull = stiffness * norm(new)
    if pull > most:
        return scale(most / pull, new), True
    return new, False


class Springs(NamedTuple):
    """Springs of friction: a row for each of the list, and after them those that have left it."""

    row: Annotated[Ints, "(n_spring,)"]
    """Of ``slip`` and ``force``: node ids if these are the state's."""
    holds: Annotated[Bools, "(n_spring,)"]
    """Whether it has been stretched."""
    node: Annotated[Ints, "(n_spring, 4)"]
    """Carrier of the force."""
    weight: Annotated[Floats, "(n_spring, 4)"]
    """Its shape functions."""
    slip: Annotated[Floats, "(n_kept, 3)"]
    """Elastic slip u, in the tool's frame [mm]."""
    force: Annotated[Floats, "(n_kept, 3)"]
    """On the film [N]."""

    @classmethod
    def at_rest(cls, node: Ints) -> Springs:
        """Return those of carriers with these nodes (n, 4) that nothing has stretched."""
        n, at = len(node), Carriers.of(node)
        slip, force = np.zeros((2, n, 3))
        row, holds = np.arange(n, dtype=np.int64), np.zeros(n, np.bool_)
        return cls(row, holds, at.node, at.weight, slip, force)


class FrictionTables(NamedTuple):
    """Kernel arguments that stay valid until the list is made anew."""

    carriers: Carriers
    springs: Springs
    nodes: ContactNodes


class FrictionForces(NamedTuple):
    """Results of one evaluation of the friction."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_body, 6)."""
    node_work: float
    """Work of the friction on the nodes since t_{n-1} [N·mm]."""
    dissipated: float
    """Energy dissipated by slip since t_{n-1} [N·mm]."""
    stored: float
    """Energy of the springs at t_n [N·mm]."""
    n_slipping: int
    """Number of nodes, points of the tool or edges of the film that slip."""


_WORK, _DISSIPATED, _STORED = 0, 1, 2  # columns of Touch.sums, in the order of these fields


class CoulombFriction(ForceTerm):
    """Friction of all that a term presses.

    Parameters
    ----------
    name : str
        Of the term.
    pressing : PressTerm
        Whose pressure it acts across; evaluated before this in every step.
    coefficient : float
        mu.
    """

    booked = (
        Booking("friction_work", _WORK, -1.0),
        Booking("friction_work", ON_TOOL, -1.0),
        Booking("friction_dissipated", _DISSIPATED),
    )
    """What goes from the sums into the ledger."""

    def __init__(self, name: str, pressing: PressTerm, coefficient: float) -> None:
        self.name, self.coefficient, self._pressing = name, coefficient, pressing
        self.touch = Touch.none(len(pressing.touch.wrench), len(FrictionForces._fields) - 1)
        self._touch, self._hold = Holder()(self.touch), Holder()
        self.springs = Springs.at_rest(pressing.carriers.node)
        """Those of all that is listed."""
        self._of: object = None
        self._held: Any = None
        self._pose: Pose | None = None
        self._rests = True  # no evaluation would change what the last one has written
        self._call = BoundOnce(_add_friction)

    @property
    def forces(self) -> FrictionForces:
        """Results of the last evaluation."""
        work, dissipated, stored, n_slipping = self.touch.sums.tolist()
        return FrictionForces(self.touch.wrench.copy(), work, dissipated, stored, int(n_slipping))

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the friction at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        self.n_search = self._pressing.n_search  # it acts where that does
        presses = self._pressing.touch.sums[TOUCHING] > 0.0
        quiet = not presses and bool(self.touch.sums[_STORED] == 0.0)
        if self._of is not self._pressing.tables:
            self._take_list(state)
        elif quiet and self._rests:
            return
        self._call.code(pose, before, state.dt, self.coefficient, self._held, self._touch)
        self._rests = quiet

    def stiffness(self, _state: State, counted: HeldBy) -> Held:
        """Return the nodes that may be pressed soon and what friction adds there [N/mm]."""
        near, penalty = counted[self._pressing.name]
        return near, stiffer_by(self.coefficient) * penalty

    def stored(self, _state: State) -> dict[str, float]:
        """Return the energy of the springs at the last evaluation, by its name in the ledger."""
        return {"friction_stored": float(self.touch.sums[_STORED])}

    def saved(self) -> dict[str, Any]:
        """Return the springs, but those of nodes, which are in the state, and the last forces."""
        saved: dict[str, Any] = {"touch": self.touch._asdict()}
        if self._pressing.kept is not None:
            saved["springs"] = self.springs._asdict()
        return saved

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose; after the other term's."""
        self._pose, self._rests = pose, False
        self.n_search = self._pressing.n_search
        self.touch.take(saved["touch"])
        if "springs" in saved:
            self.springs = Springs(**{k: rows.copy() for k, rows in saved["springs"].items()})
            self._lay_out(state)
        else:
            self._take_list(state)

    def _take_list(self, state: State) -> None:
        """Switch to the other term's new list; what has left it lets go in this step."""
        node, kept, was = self._pressing.carriers.node, self._pressing.kept, self.springs
        if kept is None:
            left = np.isin(was.row, node[:, 0], invert=True) & was.holds
            springs = Springs.at_rest(np.concatenate([node, was.node[left]]))
            row, force = springs.node[:, 0].copy(), state.node.friction_force
            holds = np.asarray(force[row].any(axis=1))
            self.springs = springs._replace(
                row=row, holds=holds, slip=state.node.friction_spring, force=force
            )
        else:
            rows = np.append(kept, np.setdiff1d(np.flatnonzero(was.holds), kept))
            self.springs = Springs.at_rest(np.concatenate([node, was.node[rows[len(node) :]]]))
            to = np.flatnonzero(rows >= 0)
            for new, old in zip(self.springs[1:], was[1:], strict=True):
                new[to] = old[rows[to]]
        self._lay_out(state)

    def _lay_out(self, state: State) -> None:
        nodes = ContactNodes.of(state)
        self._of = self._pressing.tables
        self._held = self._hold(FrictionTables(self._pressing.carriers, self.springs, nodes))


@inline
def _carried(
    i: int, node: Ints, weight: Floats, nodes: ContactNodes, dt: float, pose: Pose, before: Pose
) -> tuple[Vec3, Vec3, Vec3]:
    """Return where a carrier is, its velocity, and its way against the tool in the tool's frame."""
    x, v = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for c in range(4):
        x = add_scaled(x, weight[i, c], load(nodes.x, node[i, c]))
        v = add_scaled(v, weight[i, c], load(nodes.velocity_half, node[i, c]))
    return x, v, sub(to_body(x, pose), to_body(add_scaled(x, -dt, v), before))


@kernel
def _add_friction(
    pose: Pose,
    before: Pose,
    dt: float,
    coefficient: float,
    tables: FrictionTables,
    touch: Touch,
) -> None:
    """Add the friction at all carriers to the forces of their nodes.

    Writes the springs and touch, see :class:`FrictionForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    carriers, springs, nodes = tables.carriers, tables.springs, tables.nodes
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    work = stored = dissipated = 0.0
    n_slipping, n_listed = 0, carriers.pressure.shape[0]
    for i in range(springs.row.shape[0]):
        pressure = carriers.pressure[i] if i < n_listed else 0.0
        if pressure == 0.0 and not springs.holds[i]:
            continue
        row = springs.row[i]
        u, f = load(springs.slip, row), load(springs.force, row)
        if springs.holds[i]:
            _, v, d = _carried(i, springs.node, springs.weight, nodes, dt, pose, before)
            work += 0.5 * dt * dot(f, v)
            dissipated -= 0.5 * dot(turn_back(f, before), add(u, d))
        new, f = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if pressure > 0.0:
            k_t, normal = TANGENTIAL * carriers.stiffness[i], load(carriers.normal, i)
            x, v, d = _carried(i, carriers.node, carriers.weight, nodes, dt, pose, before)
            new, slips = return_mapping(add(u, d), normal, k_t, coefficient * pressure)
            f = scale(-k_t, turn(new, pose))
            n_slipping += slips
            stored += 0.5 * k_t * dot(new, new)
            work += 0.5 * dt * dot(f, v)
            dissipated += 0.5 * k_t * dot(new, sub(d, new))
            for c in range(4):
                n, weight = carriers.node[i, c], carriers.weight[i, c]
                springs.node[i, c], springs.weight[i, c] = n, weight
                add_to(nodes.force, n, scale(weight, f))
            react(f, x, carriers.body[i], pose, wrench)
        store(springs.slip, row, new)
        store(springs.force, row, f)
        springs.holds[i] = pressure > 0.0
    sums[0], sums[1], sums[2], sums[3] = work, dissipated, stored, n_slipping
