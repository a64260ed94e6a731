"""Coulomb friction of the film's nodes on the faces of the tool, regularised by a spring.

A node that contact presses on a face with the force N along the outward normal n (impacts and
absorbed jumps counted, :mod:`shellcut.contact.penalty_contact`) gets a tangential force besides.
An elastic spring holds it to the tool; u is its elongation, a vector in the tool's frame, so that
the tool carries it along whatever it does. Over a step in which the node moves by d against the
tool,

    u* = P (u + d),   P = 1 - n n^T                                     (trial: it sticks)
    u' = u* min(1, mu N / (k_t |u*|)),   force -k_t u'                  (else it slips)

which is the return mapping of rigid-plastic slip with the elastic part k_t [Wriggers2006]: sticking
up to mu N, then slipping with mu N against the slip, whatever the length of the step.

*Works.* The trapezoid of the forces and of d is ½ k_t (u + u')·d. The spring stores ½ k_t u². So

    ½ k_t (u + u')·d = ½ k_t (u'² - u²) + ½ k_t (u + u')·(u + d - u'),

an identity: the last term, the mean force times the slip, is the energy dissipated. It holds for a
normal that turns (the spring loses its part along n) and for a node that comes off (N = 0, so u' =
0: what was stored is dissipated). The work itself comes from the forces on nodes and tool, each in
their own motion, so that work = stored + dissipated is a check.

*Stiffness* is that of all frictions (:mod:`.friction_term`).

A split leaves its new node with the spring of the node it comes from.
"""

from __future__ import annotations

from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, product
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.vec3 import add, add_to, combine, cross, dot, load, norm, scale, store, sub
from shellcut.state import State
from shellcut.tool.pose import Pose, to_body, turn, turn_back
from shellcut.tool.touch import Touch

from .contact_tables import ContactTables
from .friction_term import DISSIPATED, TANGENTIAL, ToolFriction
from .penalty_contact import PenaltyContact
from .settings import STEEPEST, node_stiffness


class _Springs(NamedTuple):
    """Springs of the nodes, named as in :class:`shellcut.state.NodeTable`; the kernel writes."""

    held: Annotated[Bools, "(n_near,)"]
    """Which nodes of the contact's list have a spring that is not at rest."""
    friction_spring: Annotated[Floats, "(n_node, 3)"]
    friction_force: Annotated[Floats, "(n_node, 3)"]


class CoulombFriction(ToolFriction):
    """Friction of all nodes in contact, a :class:`shellcut.simulation.tool_terms.ToolTerm`.

    Parameters
    ----------
    contact : PenaltyContact
        Presses the nodes on the tool; evaluated before this in every step.
    coefficient : float
        mu.
    """

    def __init__(self, contact: PenaltyContact, coefficient: float) -> None:
        super().__init__("friction", contact, coefficient)
        self._contact = contact
        self._tables: ContactTables | None = None
        self._springs: _Springs | None = None
        self._listed: Ints = np.zeros(0, np.int64)
        self._pose: Pose | None = None
        self._hold = Holder()
        self._call = BoundOnce(_add_friction_forces)

    def add_forces(self, state: State, pose: Pose) -> None:
        """Add the friction at t_n to the nodal forces, with the tool at the given pose."""
        before, self._pose = self._pose or pose, pose
        renewed = self._tables is not self._contact.tables
        if renewed:
            lost = self._take_list(state)
        self._call.code(
            pose, before, state.dt, self.coefficient, self._tables, self._springs, self._touch
        )
        if renewed:
            self.touch.sums[DISSIPATED] += lost

    def saved(self) -> dict[str, Any]:
        """Return the last forces; the springs are in the state."""
        return {"touch": self.touch._asdict()}

    def restore(self, state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose; after the contact's."""
        self._pose = pose
        self.touch.take(saved["touch"])
        self._take_list(state)

    def _take_list(self, state: State) -> float:
        """Switch to the contact's new list; return the energy of the springs that left it [N·mm].

        Nodes that have left are out of contact.
        """
        n, tables = state.node, self._contact.tables
        left = np.setdiff1d(self._listed, self._contact.near.ids)
        springs = n.friction_spring[left]
        lost = 0.0
        if springs.any():
            steepest = n.contact_share[left] * self._contact.law.steepest(n.contact_area[left])
            stiffness = TANGENTIAL / STEEPEST * steepest
            lost = float(product(0.5 * stiffness, (springs**2).sum(axis=1)))
            n.friction_spring[left] = n.friction_force[left] = 0.0
        self._listed, self._tables = self._contact.near.ids, tables
        springs = n.friction_spring
        self._springs = self._hold(
            _Springs(np.asarray(springs[self._listed].any(axis=1)), springs, n.friction_force)
        )
        return lost


@kernel
def _add_friction_forces(
    pose: Pose,
    pose_before: Pose,
    dt: float,
    coefficient: float,
    tables: ContactTables,
    springs: _Springs,
    touch: Touch,
) -> None:
    """Add the friction of the near nodes to their force.

    Writes the springs and touch, see :class:`.friction_term.FrictionForces`.
    """
    pose, pose_before, tables = borrowed(pose), borrowed(pose_before), borrowed(tables)
    springs = borrowed(springs)
    wrench, sums = borrowed(touch)
    wrench[:] = 0.0
    nodes, near, origin = tables.nodes, tables.near, pose.translation
    spring, force = springs.friction_spring, springs.friction_force
    work = stored = dissipated = 0.0
    n_slipping = 0
    for i in range(near.node.shape[0]):
        if not (near.within[i] or springs.held[i]):
            continue
        n = near.node[i]
        pressed = load(nodes.contact_force, n)
        pressure = norm(pressed)
        u, old = load(spring, n), load(force, n)
        if pressure == 0.0 and not springs.held[i]:
            continue
        x, moves = load(nodes.x, n), load(nodes.velocity_half, n)
        share = nodes.contact_share[n]
        stiffness = TANGENTIAL * share * node_stiffness(nodes.contact_area[n], tables.law)
        before = to_body(combine(1.0, x, -dt, moves), pose_before)
        pulled = add(u, sub(to_body(x, pose), before))
        new = (0.0, 0.0, 0.0)
        if pressure > 0.0:
            normal = turn_back(scale(1.0 / pressure, pressed), pose)
            new = combine(1.0, pulled, -dot(pulled, normal), normal)
            most, trial = coefficient * pressure, stiffness * norm(new)
            if trial > most:
                new = scale(most / trial, new)
                n_slipping += 1
        stored += 0.5 * stiffness * dot(new, new)
        dissipated += 0.5 * stiffness * dot(add(u, new), sub(pulled, new))
        f = scale(-stiffness, turn(new, pose))
        work += 0.5 * dt * dot(add(old, f), moves)
        springs.held[i] = pressure > 0.0
        store(spring, n, new)
        store(force, n, f)
        add_to(nodes.force, n, f)
        body = tables.tool.triangle_body[near.closest[i, 1]]
        moment = cross((x[0] - origin[0], x[1] - origin[1], x[2] - origin[2]), f)
        for c in range(3):
            wrench[body, c] -= f[c]
            wrench[body, 3 + c] -= moment[c]
    sums[0], sums[1], sums[2], sums[3] = work, dissipated, stored, n_slipping
