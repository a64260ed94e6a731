"""Coulomb friction of the film on itself, regularised by a spring.

A point P that presses on a sheet with N along n_f (:mod:`.self_contact`) is held there by a spring
across n_f, as nodes are on the tool's faces (:mod:`.coulomb_friction`), with u its elongation:

    u* = (1 - n_f n_f^T)(u + w),    u' = u* min(1, mu N / (k_t |u*|)),    force on P: f = -k_t u'.

*Way of slip.* P is at the distance d over its foot c on the sheet, P = c + d n. What it slides on
is the sheet's film at P, which turns with the sheet: its place a step before was y = c + d n of the
positions then, with the same place of the quad and the same d, and

    w = y_{n-1} - P_{n-1},

seen in the frame of the quad then and taken to that of now. So two films that move together as a
rigid body do not slip, however far they turn in a step and however far apart their mid-surfaces
are. The forces are those of virtual work, f on P and on the nodes of the quad

    - N_a f + d (f · grad N_a) n,

N_a being the shape functions at c: no sum, as sum grad N_a = 0, and no moment: d f x n of the
second part takes up what f at P and -f at c have together.

*The spring turns with the sheet.* u is kept by its components along the tangent, across it and
along the normal of the quad at the foot, and is read there again a step later, wherever the foot is
then. It is part of what is remembered of a point and a sheet, so it survives searches, splits and
checkpoints; where they part, it goes, and what it held is dissipated.

*Works.* The forces of a step act on their own nodes until the next; half of that work and half of
the next step's are what friction did on the film in between. What is not stored is dissipated: the
mean force times the slip where the foot stays.

*Stiffness.* k_t is ``TANGENTIAL`` of the point's k and acts across it, with slip it adds the
unsymmetric mu k f'; together at most 1 + :func:`.coulomb_friction.stiffer_by` times the steepest k.
The couple's part, (d |grad N_a|)² of k_t, is less than what the steepest k leaves to it up to a
thickness of 1.5 edges.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from shellcut.arrays import Floats, Held, HeldBy, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import add_scaled, combine, cross, dot, load, norm, scale, store, sub
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose
from shellcut.tool.touch import Booking, Touch

from .coulomb_friction import TANGENTIAL, return_mapping, stiffer_by
from .quad_distance import Corners, corners_of, normal_at, place_in, tangents_at, weights_at
from .self_contact import SelfContact
from .self_contact_kernel import half_work_of, put_on
from .self_contact_tables import Memory, Presses, SelfContactTables, SelfNodes
from .sheet_contact import slopes_along


class SelfFrictionForces(NamedTuple):
    """Results of one evaluation."""

    work: float
    """Work of the friction on the film since t_{n-1} [N·mm]."""
    stored: float
    """Energy of the springs at t_n [N·mm]."""
    dissipated: float
    """Energy dissipated by slip since t_{n-1} [N·mm]."""
    n_slipping: int
    """Number of points that slip."""


_IDLE = SelfFrictionForces(0.0, 0.0, 0.0, 0)


class SelfFriction(ForceTerm):
    """Friction of the film on itself.

    Parameters
    ----------
    contact : SelfContact
        Presses the points on the sheets; evaluated before this in every step.
    coefficient : float
        mu.
    """

    name = "self_friction"
    booked = Booking("friction_work", 0, -1.0), Booking("friction_dissipated", 1)

    def __init__(self, contact: SelfContact, coefficient: float) -> None:
        self._contact, self.coefficient = contact, coefficient
        self._of: SelfContactTables | None = None
        self._drags = Presses.with_room(0)
        self._held: Any = None
        self._hold = Holder()
        self._call = BoundOnce(_add_self_friction)
        self.forces = SelfFrictionForces(0.0, 0.0, 0.0, 0)
        """Results of the last evaluation."""
        self.touch = Touch.none(0, 2)

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the friction at t_n to the nodal forces."""
        self.n_search = self._contact.n_search  # it acts where that does
        self.forces = self._evaluate(state)
        self.touch.sums[:] = self.forces.work, self.forces.dissipated

    def _evaluate(self, state: State) -> SelfFrictionForces:
        tables = self._contact.tables
        if tables is not None and self._of is not tables:
            self._take(tables, Presses.with_room(len(tables.presses.node), self._drags))
        if tables is None or not (tables.presses.n[0] or self._drags.n[0]):
            return _IDLE  # nothing presses, and nothing was held: the usual case
        held, before = self._contact.held, self.forces.stored
        work, stored, n_slipping = self._call.code(state.dt, self.coefficient, held, self._held)
        return SelfFrictionForces(work, stored, before - stored - work, n_slipping)

    def stiffness(self, _state: State, counted: HeldBy) -> Held:
        """Return the nodes that may be pressed soon and what friction adds there [N/mm]."""
        near, penalty = counted[self._contact.name]
        return near, stiffer_by(self.coefficient) * penalty

    def stored(self, _state: State) -> dict[str, float]:
        """Return the energy of the springs at the last evaluation, by its name in the ledger."""
        return {"friction_stored": self.forces.stored}

    def saved(self) -> dict[str, Any]:
        """Return the last forces; the springs are in the contact's memory."""
        return {"drags": self._drags.saved(), "forces": self.forces._asdict()}

    def restore(self, _state: State, _pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, after the contact's."""
        self.n_search = self._contact.n_search
        self.forces = SelfFrictionForces(**saved["forces"])
        self.touch.sums[:] = self.forces.work, self.forces.dissipated
        tables = self._contact.tables
        room = 0 if tables is None else len(tables.presses.node)
        self._take(tables, Presses.of_saved(saved["drags"], room))

    def _take(self, tables: SelfContactTables | None, drags: Presses) -> None:
        self._of, self._drags, self._held = tables, drags, self._hold(drags)


@inline
def _frame_at(q: Corners, xi: float, eta: float) -> tuple[Vec3, Vec3, Vec3]:
    """Return unit vectors along the first tangent, across it and along the normal of a quad."""
    a1, _ = tangents_at(q, xi, eta)
    along, n = scale(1.0 / norm(a1), a1), normal_at(q, xi, eta)
    return along, cross(n, along), n


@inline
def _spring_of(sheet: int, memory: Memory, x: Floats, quads: Ints) -> Vec3:
    """Return the elongation u as its quad has carried it here [mm]."""
    u = load(memory.drag, sheet)
    if u[0] == 0.0 and u[1] == 0.0 and u[2] == 0.0:
        return u
    xi, eta = memory.drag_place[sheet, 0], memory.drag_place[sheet, 1]
    along, across, n = _frame_at(corners_of(x, quads, memory.drag_row[sheet]), xi, eta)
    return add_scaled(combine(u[0], along, u[1], across), u[2], n)


@inline
def _way_of_slip(
    row: int,
    node: int,
    xi: float,
    eta: float,
    over: float,
    dt: float,
    nodes: SelfNodes,
    quads: Ints,
) -> Vec3:
    """Return the way of a point against the sheet's film over the last step [mm].

    By its components in the frame of the quad.  over : d [mm].
    """
    x, v = nodes.x, nodes.velocity_half
    n0, n1, n2, n3 = quads[row, 0], quads[row, 1], quads[row, 2], quads[row, 3]
    then = Corners(
        add_scaled(load(x, n0), -dt, load(v, n0)),
        add_scaled(load(x, n1), -dt, load(v, n1)),
        add_scaled(load(x, n2), -dt, load(v, n2)),
        add_scaled(load(x, n3), -dt, load(v, n3)),
    )
    along, across, n = _frame_at(then, xi, eta)
    slid_on = add_scaled(place_in(then, xi, eta), over, n)
    way = sub(slid_on, add_scaled(load(x, node), -dt, load(v, node)))
    return dot(way, along), dot(way, across), dot(way, n)


@kernel
def _add_self_friction(
    dt: float, coefficient: float, tables: SelfContactTables, drags: Presses
) -> tuple[float, float, int]:
    """Add the friction of all points that press, and minus it on the sheets, to the nodes.

    Writes the springs in the memory, and drags.  Returns the work on the nodes over the last step,
    the stored energy and the number of points that slip.
    """
    tables, drags = borrowed(tables), borrowed(drags)
    memory, nodes, quads = tables.memory, tables.nodes, tables.quads
    presses, touches, x = tables.presses, tables.touches, tables.nodes.x
    work = half_work_of(drags, nodes, dt)
    stored = 0.0
    n_slipping = count = 0
    for i in range(presses.n[0]):
        sheet, row = touches.sheet[i], touches.row[i]
        pressed = load(presses.force[i], 0)
        pressure = norm(pressed)
        if pressure == 0.0:
            store(memory.drag, sheet, (0.0, 0.0, 0.0))
            continue
        xi, eta = touches.place[i, 0], touches.place[i, 1]
        q, node = corners_of(x, quads, row), presses.node[i, 0]
        along, across, n = _frame_at(q, xi, eta)
        over = dot(sub(load(x, node), place_in(q, xi, eta)), n)
        u = _spring_of(sheet, memory, x, quads)
        w = _way_of_slip(row, node, xi, eta, over, dt, nodes, quads)
        carried = add_scaled(combine(w[0], along, w[1], across), w[2], n)
        pulled = add_scaled(u, 1.0, carried)
        stiffness = TANGENTIAL * tables.stiffness[touches.point[i]]
        normal = scale(1.0 / pressure, pressed)
        new, slips = return_mapping(pulled, normal, stiffness, coefficient * pressure)
        n_slipping += slips
        stored += 0.5 * stiffness * dot(new, new)
        store(memory.drag, sheet, (dot(new, along), dot(new, across), dot(new, n)))
        memory.drag_row[sheet] = row
        memory.drag_place[sheet, 0], memory.drag_place[sheet, 1] = xi, eta
        f = scale(-stiffness, new)
        put_on(count, 0, node, f, nodes, drags)
        weights, slopes = weights_at(xi, eta), slopes_along(f, xi, eta, q)
        for a in range(4):
            couple = over * slopes[a]
            back = combine(-weights[a], f, couple, n)
            put_on(count, a + 1, quads[row, a], back, nodes, drags)
        count += 1
    drags.n[0] = count
    work += half_work_of(drags, nodes, dt)
    return work, stored, n_slipping
