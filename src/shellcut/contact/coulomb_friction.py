"""Coulomb friction of what touches, regularised by a spring.

Where a term presses the film with the force N along the normal n, at a contact point (a node, a
place on the border, the foot of a point of the tool on a quad) against the tool, or at a node
against a sheet of film, the film gets a tangential force besides. An elastic spring ties it to the
*body* that it slides on; u is its elongation, the elastic slip, a vector in the frame of the body,
which moves with the body. Over a step in which the film at the contact point moves by d against the
body,

    u* = P (u + d),   P = 1 - n n^T                                     (trial: it sticks)
    u' = u* min(1, mu N / (k_t |u*|)),   force f' = -k_t u'             (else it slips)

which is the return mapping of rigid-plastic slip with the elastic part k_t [Wriggers2006]: sticking
up to mu N, then slipping with mu N against the slip, whatever the length of the step. The nodes of
the contact point get f' by their shape functions, the body minus that.

*Film as the body.* A node P is at the distance d_n over its foot c on the sheet. What it slides on
is the sheet's film at P, which turns with the sheet: the frame of the quad at c (along its first
tangent, across it, along the normal n_q) with its origin at y = c + d_n n_q, where P is, and
likewise of the positions a step before, with the same place of the quad and the same d_n. So two
films that move together as a rigid body do not slip, however far they turn in a step and however
far apart their mid-surfaces are. The forces are those of virtual work, f on P and on the nodes of
the quad

    - N_a f + d_n (f · grad N_a) n_q,

N_a being the shape functions at c: no sum, as sum grad N_a = 0, and no moment: d_n f x n_q of the
second part takes up what f at P and -f at c have together.

*Works.* The force f of t_{n-1} has acted on its own contact point, which has moved by d_f, and f'
acts on that of now. So with the energies -½ f·u and -½ f'·u' that the spring stored and stores

    dissipated = -½ (f·d_f + f'·d) - ½ f·u + ½ f'·u'.

With the same contact point and k_t as in the last step (a node) that is ½ k_t (u + u')·(u + d -
u'), the mean force times the slip: also for a normal that turns (the spring loses its part along
n), and for a point that separates (N = 0, so u' = 0: what was stored is dissipated). The work
itself comes from the forces on film and tool, each in their own motion, so that work = stored +
dissipated is a check. Of film on film, whose frames follow from the same nodes, what is not stored
is dissipated.

*History.* The spring of a node is kept in the state, and a split leaves its new node that of the
node it was split from. The spring of a point of the tool follows the point from quad to quad, as
does that of a node on a sheet, where it is read again in the frame of the quad at its last foot.
That of a place on the border stays with the place. A spring whose point leaves the list of the
pressing term is released.

*Stiffness.* k_t is ``TANGENTIAL`` times the k of the penalty: what is pressed slips by mu N / k_t =
2 mu f(g) from rest, less than its own depth for mu up to ½. The spring acts across the normal, the
penalty along it; slip adds the unsymmetric term mu k f'. With a = 27/16 the steepest slope of the
penalty, the largest singular value of the two together is at most k sqrt(a² (1 + mu²) +
TANGENTIAL²). What that is more than a k enters the bound on the step, 4 % of a k for mu = 0.2, so 2
% of the step at most. Places on the border share the k of their nodes, and so its springs. The
couple of film on film, (d |grad N_a|)² of k_t, is less than what the steepest k leaves to it up to
a thickness of 1.5 edges.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, NodeStiffness, StiffnessBy, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import (
    add,
    add_scaled,
    add_to,
    combine,
    cross,
    dot,
    load,
    mean_of,
    norm,
    scale,
    store,
    sub,
)
from shellcut.state import KernelNodes, State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose
from shellcut.tool.touch import ON_TOOL, Booking, Touch, react

from .contact_tables import ContactPoints, carry_over
from .press_term import TOUCHING, PressTerm
from .quad_distance import Corners, normal_at, place_in, slopes_along, tangents_at
from .settings import STEEPEST
from .sheet_contact import SelfContact

TANGENTIAL = 0.5
"""Stiffness of the tangential spring over that of the penalty."""


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
    """Nodes of the contact point on which the force acts."""
    weight: Annotated[Floats, "(n_spring, 4)"]
    """Its shape functions."""
    slip: Annotated[Floats, "(n_kept, 3)"]
    """Elastic slip u, in the body's frame [mm]."""
    force: Annotated[Floats, "(n_kept, 3)"]
    """On the film [N], on the node where film is the body."""
    point: Annotated[Ints, "(n_point,)"]
    """That node; none of a tool."""
    back: Annotated[Floats, "(n_point, 4, 3)"]
    """On the nodes of the quad [N]."""

    @classmethod
    def at_rest(cls, node: Ints, on_film: bool = False) -> Springs:
        """Return those of contact points with these nodes (n, 4) that nothing has stretched."""
        n, at = len(node), ContactPoints.of(node)
        slip, force = np.zeros((2, n, 3))
        row, holds = np.arange(n, dtype=np.int64), np.zeros(n, np.bool_)
        n_point = n if on_film else 0
        point, back = np.zeros(n_point, np.int64), np.zeros((n_point, 4, 3))
        return cls(row, holds, at.node, at.weight, slip, force, point, back)


class FrictionTables(NamedTuple):
    """Kernel arguments that stay valid until the list is made anew."""

    point: Annotated[Ints, "(n_listed,)"]
    """Nodes that are pressed on the quads of the contact points; none where the tool is the
    body."""
    contact_points: ContactPoints
    springs: Springs
    nodes: KernelNodes


class FrictionForces(NamedTuple):
    """Results of one evaluation of the friction."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_tooth, 6)."""
    node_work: float
    """Work of the friction on the nodes since t_{n-1} [N·mm]."""
    dissipated: float
    """Energy dissipated by slip since t_{n-1} [N·mm]."""
    stored: float
    """Energy of the springs at t_n [N·mm]."""
    n_slipping: int
    """Number of nodes, points of the tool or places on the border that slip."""


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
    """What the energy balance gets from the sums."""

    def __init__(self, name: str, pressing: PressTerm, coefficient: float) -> None:
        self.name, self.coefficient, self._pressing = name, coefficient, pressing
        self.touch = Touch.none(len(pressing.touch.wrench), len(FrictionForces._fields) - 1)
        self._touch, self._address_of = TableWriter()(self.touch), TableWriter()
        self._on_film = isinstance(pressing, SelfContact)
        self.springs = Springs.at_rest(pressing.carriers.node, self._on_film)
        """Those of all that is listed."""
        self._of: object = None
        self._address: Any = None
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
        self._call.code(pose, before, state.dt, self.coefficient, self._address, self._touch)
        self._rests = quiet

    def stiffness(self, _state: State, counted: StiffnessBy) -> NodeStiffness:
        """Return the nodes that may be pressed soon and what friction adds there [N/mm]."""
        near, penalty = counted[self._pressing.name]
        coupled = (1.0 + self.coefficient**2) + (TANGENTIAL / STEEPEST) ** 2
        return near, (float(np.sqrt(coupled)) - 1.0) * penalty

    def stored(self, _state: State) -> dict[str, float]:
        """Return the energy of the springs at the last evaluation, by its name in the balance."""
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
        """Switch to the other term's new list; what has left it is released in this step."""
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
            nodes = np.concatenate([node, was.node[rows[len(node) :]]])
            self.springs = Springs.at_rest(nodes, self._on_film)
            carry_over(self.springs[1:], was[1:], rows)
            # Halves of a split node have a spring each; its force has acted once.
            again = np.setdiff1d(np.flatnonzero(rows >= 0), np.unique(rows, return_index=True)[1])
            self.springs.force[again] = 0.0
            if self._on_film:
                self.springs.back[again] = 0.0
        self._lay_out(state)

    def _lay_out(self, state: State) -> None:
        nodes, pressing = KernelNodes.of(state.node), self._pressing
        point: Ints = np.zeros(0, np.int64)
        if isinstance(pressing, SelfContact):
            point = pressing.point_of_sheet()
        self._of = pressing.tables
        self._address = self._address_of(
            FrictionTables(point, pressing.carriers, self.springs, nodes)
        )


class _Frame(NamedTuple):
    """Of what film slides on: its origin [mm] and unit vectors."""

    at: Vec3
    along: Vec3
    across: Vec3
    normal: Vec3


@inline
def _frame_of(pose: Pose) -> _Frame:
    """Return the frame of the tool."""
    r, at = pose.rotation, pose.translation
    return _Frame(
        (at[0], at[1], at[2]),
        (r[0, 0], r[1, 0], r[2, 0]),
        (r[0, 1], r[1, 1], r[2, 1]),
        (r[0, 2], r[1, 2], r[2, 2]),
    )


@inline
def _seen(d: Vec3, frame: _Frame) -> Vec3:
    """Return the components of a vector in a frame."""
    return dot(frame.along, d), dot(frame.across, d), dot(frame.normal, d)


@inline
def _in_space(u: Vec3, frame: _Frame) -> Vec3:
    """Return a vector from its components in a frame."""
    return add_scaled(combine(u[0], frame.along, u[1], frame.across), u[2], frame.normal)


@inline
def _quad_at(i: int, node: Ints, nodes: KernelNodes, dt: float) -> Corners:
    """Return the corners of the quad of a contact point, dt ago [mm]."""
    x, v = nodes.x, nodes.velocity_half
    a, b, c, d = node[i, 0], node[i, 1], node[i, 2], node[i, 3]
    return Corners(
        add_scaled(load(x, a), -dt, load(v, a)),
        add_scaled(load(x, b), -dt, load(v, b)),
        add_scaled(load(x, c), -dt, load(v, c)),
        add_scaled(load(x, d), -dt, load(v, d)),
    )


@inline
def _place_of(i: int, weight: Floats) -> tuple[float, float]:
    """Return xi and eta of a contact point from its shape functions."""
    w0, w1, w2, w3 = weight[i, 0], weight[i, 1], weight[i, 2], weight[i, 3]
    return (w1 + w2) - (w0 + w3), (w2 + w3) - (w0 + w1)


@inline
def _frame_on(q: Corners, xi: float, eta: float, over: float) -> _Frame:
    """Return the frame of a quad at a place, its origin ``over`` above that [mm]."""
    a1, _ = tangents_at(q, xi, eta)
    along, n = scale(1.0 / norm(a1), a1), normal_at(q, xi, eta)
    return _Frame(add_scaled(place_in(q, xi, eta), over, n), along, cross(n, along), n)


@inline
def _slid(x: Vec3, v: Vec3, dt: float, now: _Frame, then: _Frame) -> Vec3:
    """Return the displacement of film at x in a body's frame over the last step [mm]."""
    was = _seen(sub(add_scaled(x, -dt, v), then.at), then)
    return sub(_seen(sub(x, now.at), now), was)


@kernel
def _add_friction(
    pose: Pose,
    before: Pose,
    dt: float,
    coefficient: float,
    tables: FrictionTables,
    touch: Touch,
) -> None:
    """Add the friction at all contact points to the forces of their nodes.

    Writes the springs and touch, see :class:`FrictionForces`.
    """
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    points, springs, nodes = tables.contact_points, tables.springs, tables.nodes
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    on_film, n_listed = springs.point.shape[0] > 0, points.pressure.shape[0]
    now, then = _frame_of(pose), _frame_of(before)
    work = stored = dissipated = 0.0
    n_slipping = 0
    for i in range(springs.row.shape[0]):
        pressure = points.pressure[i] if i < n_listed else 0.0
        if pressure == 0.0 and not springs.holds[i]:
            continue
        row = springs.row[i]
        u, f = load(springs.slip, row), load(springs.force, row)
        # The force of t_{n-1} acts for half of the step on the contact point that it belonged to.
        if springs.holds[i] and not on_film:
            x = mean_of(nodes.x, springs.node, springs.weight, i)
            v = mean_of(nodes.velocity_half, springs.node, springs.weight, i)
            work += 0.5 * dt * dot(f, v)
            dissipated -= 0.5 * dot(_seen(f, then), add(u, _slid(x, v, dt, now, then)))
        elif springs.holds[i]:
            work += 0.5 * dt * _power_on_film(i, nodes, springs)
            xi, eta = _place_of(i, springs.weight)
            frame = _frame_on(_quad_at(i, springs.node, nodes, 0.0), xi, eta, 0.0)
            u = _in_space(u, frame)  # the foot may now be on another quad, with another frame
        new, f = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        if pressure > 0.0:
            k_t, normal, over = TANGENTIAL * points.stiffness[i], load(points.normal, i), 0.0
            if on_film:
                xi, eta = _place_of(i, points.weight)
                x, v = load(nodes.x, tables.point[i]), load(nodes.velocity_half, tables.point[i])
                q = _quad_at(i, points.node, nodes, 0.0)
                over = dot(sub(x, place_in(q, xi, eta)), normal_at(q, xi, eta))
                now = _frame_on(q, xi, eta, over)
                then = _frame_on(_quad_at(i, points.node, nodes, dt), xi, eta, over)
                u, normal = _seen(u, now), _seen(normal, now)
            else:
                x = mean_of(nodes.x, points.node, points.weight, i)
                v = mean_of(nodes.velocity_half, points.node, points.weight, i)
            d = _slid(x, v, dt, now, then)
            new, slips = return_mapping(add(u, d), normal, k_t, coefficient * pressure)
            f = _in_space(scale(-k_t, new), now)
            n_slipping += slips
            stored += 0.5 * k_t * dot(new, new)
            for c in range(4):
                springs.node[i, c], springs.weight[i, c] = (
                    points.node[i, c],
                    points.weight[i, c],
                )
            if on_film:
                slopes = slopes_along(f, xi, eta, q)
                springs.point[i] = tables.point[i]
                add_to(nodes.force, tables.point[i], f)
                for c in range(4):
                    back = combine(-points.weight[i, c], f, over * slopes[c], now.normal)
                    store(springs.back[i], c, back)
                    add_to(nodes.force, points.node[i, c], back)
            else:
                work += 0.5 * dt * dot(f, v)
                dissipated += 0.5 * k_t * dot(new, sub(d, new))
                for c in range(4):
                    add_to(nodes.force, points.node[i, c], scale(points.weight[i, c], f))
                react(f, x, points.tooth[i], pose, wrench)
        store(springs.slip, row, new)
        store(springs.force, row, f)
        springs.holds[i] = pressure > 0.0
        if on_film and pressure > 0.0:
            work += 0.5 * dt * _power_on_film(i, nodes, springs)
    if on_film:  # all frames follow from the same nodes: what is not stored is dissipated
        dissipated = sums[_STORED] - stored - work
    sums[0], sums[1], sums[2], sums[3] = work, dissipated, stored, n_slipping


@inline
def _power_on_film(i: int, nodes: KernelNodes, springs: Springs) -> float:
    """Return the power of the last forces of a node on a sheet [N·mm/s]."""
    springs = borrowed(springs)
    v = nodes.velocity_half
    power = dot(load(springs.force, i), load(v, springs.point[i]))
    for c in range(4):
        power += dot(load(springs.back[i], c), load(v, springs.node[i, c]))
    return power
