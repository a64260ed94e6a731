"""Directional cohesive cables: straight until the cutting edge meets them, then bent around it.

=================  =====================================================  ====  ==================
symbol             here                                                   unit  source
=================  =====================================================  ====  ==================
w                  separation, from the minus to the plus node            mm    [Frangi2010] (10)
m                  mean normal to the flanks at birth                     1     [Frangi2010] 4
A_i                ``area``: thickness times half the crack edges         mm²   [Frangi2010] 4
ell                ``opening``: how far it has lengthened, for the law    mm    [Frangi2010] Fig. 4
F_i^-, F_i^+       ``force``: cable forces on the two nodes               N     [Frangi2010] Fig. 3
=================  =====================================================  ====  ==================

**Straight cable.** The paper applies ±sigma_F A m at the first step and sigma A along w from the
second on. Here d = w + delta_0 m, ell = |d| - delta_0 and the force is sigma(ell) A d/|d|: the same
force at w = 0, the same direction once |w| >> delta_0, and the gradient of a potential on any
loading path, so that a cable pulled apart monotonically needs exactly G A. As d is not along the
line of the two nodes, the pair has a small couple F x w, at most sigma_F A delta_0; it is the named
couple of the moment balance (:attr:`CableForces.couple`). ``onset = 0`` in the law gives the
literal form.

**Joint.** Where the cutting edge has met the cable (:mod:`shellcut.cables.meeting`) the cable is
bent around it. There is one joint a cable, and only the edge, not the flanks of the blade, makes
joints ([Frangi2010] 4). From then on

    ell = ell^- + ell^+ - slack,        F^± = sigma(ell) A (joint - x^±)/ell^±,

where ``slack`` is the length that bending around the edge added at that instant (the overshoot of
the test and delta_0): with it the law continues where it was. The tool receives -(F^- + F^+).
A branch shorter than ``law.short_branch`` keeps its last direction.

A sharp edge severs: from the joint on sigma is that of the law cut off at G_s
(:mod:`shellcut.cables.cohesive_law`). Beyond its plateau that is less than before, and what the
cable has taken up to there, A(ell_max), is more than the law cut off has below it. The difference,
``shed``, is dissipated at that moment.

The joint sticks to its point of the edge (perfect adhesion), or slips as the law says
(:mod:`shellcut.cables.joint_slip`): then it moves along the edge, and friction around the edge
makes the stress of the branches (1 + eta + kappa) sigma and (1 + eta - kappa) sigma: kappa is
``grip``, eta, of an edge with a radius, ``arc_grip``.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, NodeStiffness, StiffnessBy, Vec3, product
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, always_inline, inline, kernel
from shellcut.numerics.kept import saved_of, take_over
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import (
    add,
    add_to,
    combine,
    cross,
    dot,
    load,
    norm,
    scale,
    store,
    sub,
)
from shellcut.state import BROKEN, JOINTED, NOT_MET, STRAIGHT, KernelNodes, OncePerTopology, State
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool
from shellcut.tool.touch import Booking, Touch, react

from .bent_cable import Joint, bend, work_at_edge
from .cable_stiffness import cable_stiffness
from .cable_tables import CableRows, CableTables, at_end
from .cohesive_law import (
    AREA,
    ONSET,
    OPENING_U,
    START_OPENING,
    CohesiveTable,
    energies,
    traction,
)
from .joint_slip import joint_law
from .meeting import has_come_to_edge, meet_edge

# What a checkpoint keeps of them; the cables are in the state.
_KEPT = "touch", "n_joint_made", "n_broken"


class CableForces(NamedTuple):
    """What the cables did in one evaluation."""

    wrench: Floats
    """Force [N] and moment about the body origin [N·mm] on each tooth, shape (n_tooth, 6)."""
    couple: Floats
    """Sum of the couples F x w of straight cables and short branches [N·mm], shape (3,)."""
    work: float
    """Work done on the cables since t_{n-1} [N·mm], without the equilibrium start."""
    start_work: float
    """Work done on the equilibrium-start forces since t_{n-1} [N·mm]."""
    friction_work: float
    """Work against friction of the joints on the edge since t_{n-1} [N·mm]."""
    n_joint_made: int
    """Joints made at this evaluation."""
    n_broken: int
    """Cables that broke at this evaluation."""


_N_SUM = 8  # the numbers of CableForces and, last, its couple


class CableSet(ForceTerm):
    """Forces of all cables.

    Parameters
    ----------
    law : CohesiveTable
        Stress against length.
    tool : Tool, optional
        Whose cutting edges the cables may meet.
    directional : bool
        False gives classical cables that never meet the blade, for comparison.
    """

    booked = (
        Booking("cohesive_work", 0),
        Booking("cohesive_start_work", 1),
        Booking("joint_friction", 2),
    )
    """What the energy balance gets from the sums."""
    n_search = -1  # cables turn, and pull, from step to step

    def __init__(self, law: CohesiveTable, tool: Tool | None, *, directional: bool = True) -> None:
        self.name = "joints"  # of its columns: only cables with a joint touch the tool
        self.law = law
        self.at_edge = law.at_edge(tool.edge_radius if tool is not None else 0.0)
        """Law of the cables that the edge has met."""
        self.directional = directional and tool is not None
        self._laws = law.parameters(), self.at_edge.parameters()
        self._edges = CuttingEdges.of(tool)
        self._joint = joint_law(self.at_edge, tool)
        # kappa, and eta + kappa of a round edge, of a cable that is bent back on itself.
        belt = np.pi * self._joint.friction
        self._grip = math.tanh(0.5 * belt)
        if belt and self._edges.radius:
            self._grip += 0.5 * belt / -math.expm1(-0.5 * belt) - 1.0
        self._pose: Pose | None = None
        self._tables = OncePerTopology(self._laid_out)
        self._address_of = TableWriter()
        self._call = BoundOnce(_add_cable_forces)
        self._energies_of, self._stiffness = BoundOnce(_energies), BoundOnce(cable_stiffness)
        self.touch = Touch.none(tool.n_tooth if tool is not None else 1, _N_SUM)
        self._touch = TableWriter()(self.touch)
        self.n_joint_made = self.n_broken = 0
        """Joints made and cables broken so far."""

    @property
    def forces(self) -> CableForces:
        """Results of the last evaluation."""
        work, start_work, friction_work, n_made, n_broken, *couple = self.touch.sums.tolist()
        return CableForces(
            self.touch.wrench.copy(),
            np.array(couple),
            work,
            start_work,
            friction_work,
            int(n_made),
            int(n_broken),
        )

    def add_forces(self, state: State, pose: Pose) -> None:
        """Find joints, add the cable forces at t_n to the nodal forces.

        Parameters
        ----------
        state : State
            At t_n.
        pose : Pose
            Of the tool at t_n.
        """
        if state.n_cable == 0:
            self._pose = pose
            return
        tables = self._tables.of(state)
        before, self._pose = self._pose or pose, pose
        n_made, n_broken = self._call.code(pose, before, state.dt, state.time, tables, self._touch)
        self.n_joint_made += n_made
        self.n_broken += n_broken

    def _laid_out(self, state: State) -> CableTables:
        """Return the arguments of the kernels."""
        c = state.cable
        tables = CableTables(
            n_cable=c.count,
            directional=self.directional,
            law=self._laws[0],
            at_edge=self._laws[1],
            joint=self._joint,
            edges=self._edges,
            nodes=KernelNodes.of(state.node),
            cables=CableRows(**{name: getattr(c, name) for name in CableRows._fields}),
        )
        return self._address_of(tables)

    def energies(self, state: State) -> tuple[float, float]:
        """Return stored and dissipated energy of all cables by their laws [N·mm].

        Together they are the work done on the cables, apart from the equilibrium start.
        """
        c, n = state.cable, state.cable.count
        stored, dissipated, area = np.empty(n), np.empty(n), c.area[:n]
        self._energies_of(self._tables.of(state), stored, dissipated)
        return float(product(stored, area)), float(product(dissipated, area))

    def stored(self, state: State) -> dict[str, float]:
        """Return :meth:`energies` by their entries of the energy balance [N·mm]."""
        stored, dissipated = self.energies(state)
        return {"cohesive_stored": stored, "cohesive_dissipated": dissipated}

    def saved(self) -> dict[str, Any]:
        """Return the last forces and the counts so far; the cables are in the state."""
        return saved_of(self, _KEPT)

    def restore(self, _state: State, pose: Pose, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, with the tool at its present pose."""
        self._pose = pose
        take_over(self, _KEPT, saved)

    def stiffness(self, state: State, _counted: StiffnessBy) -> NodeStiffness:
        """Return the nodes that cables act on and a bound of their stiffness on each [N/mm]."""
        room = 4 * state.n_cable
        node, stiffness = np.empty(room, np.int64), np.empty(room)
        pose = self._pose or Pose.at_origin()  # without one no cable has a joint
        count = self._stiffness(self._tables.of(state), pose, self._grip, node, stiffness)
        return node[:count], stiffness[:count]


@always_inline
def _straight_length(c: int, minus: Vec3, plus: Vec3, onset: float, cables: CableRows) -> float:
    """Return the length measure of a straight cable [mm]; write the directions of its ends."""
    d = combine(1.0, sub(plus, minus), onset, load(cables.m, c))
    length = norm(d)
    # Only at the very birth of a cable without onset is its direction still m.
    along = scale(1.0 / length, d) if length > 0.0 else load(cables.m, c)
    store(cables.branch[c], 0, along)
    store(cables.branch[c], 1, scale(-1.0, along))
    return length - onset


@inline
def _work(ell: float, ell_max: float, law: Floats) -> float:
    """Return the work done on a cable by a law, per area [N/mm]."""
    stored, dissipated = energies(ell, ell_max, law)
    return stored + dissipated


@always_inline
def add_at_end(c: int, end: int, force: Vec3, rows: Floats, cables: CableRows) -> None:
    """Add a force at an end of cable c to rows : (n_node, 3)."""
    share = cables.share[c]
    add_to(rows, cables.ends[c, end], scale(1.0 - share, force))
    add_to(rows, cables.far[c, end], scale(share, force))


@kernel
def _add_cable_forces(
    pose: Pose,
    before: Pose,
    dt: float,
    time: float,
    tables: CableTables,
    touch: Touch,
) -> tuple[int, int]:
    """Add the forces of all live cables to those of the nodes.

    Writes the cables' opening, stress, joint, branch directions, force and work, and touch, see
    :class:`CableForces`.  Returns how many joints were made and how many cables broke.
    """
    address = tables  # a single address, for the search of joints, which LLVM keeps as a call
    pose, before, tables = borrowed(pose), borrowed(before), borrowed(tables)
    wrench, sums = borrowed(touch)
    wrench[:], sums[:] = 0.0, 0.0
    couple = sums[5:]
    nodes, cables, radius = tables.nodes, tables.cables, tables.edges.radius
    start_opening = tables.law[START_OPENING]
    status, opening_max = cables.status, cables.opening_max
    work = 0.0
    start_work = 0.0
    friction_work = 0.0
    n_made = 0
    n_broken = 0
    for c in range(tables.n_cable):
        if status[c] == BROKEN:
            continue
        minus, plus = at_end(c, 0, nodes.x, cables), at_end(c, 1, nodes.x, cables)
        # An edge bends a cable once, from the first meeting on [Frangi2010].
        met = False
        may_meet = tables.directional and status[c] == STRAIGHT
        if may_meet and has_come_to_edge(c, minus, plus, pose, tables):
            met = meet_edge(c, minus, plus, pose, before, address)
        if met:
            status[c] = JOINTED
            n_made += 1
        jointed = status[c] == JOINTED
        # A sharp edge severs part of the fibres: from the joint on another law applies.
        law = tables.at_edge if jointed else tables.law
        nothing = (0.0, 0.0, 0.0)
        joint = Joint(nothing, nothing, nothing, nothing, nothing, 0.0, 0.0)
        # Of friction at t_{n-1}, as is the force: read before bend() writes those of t_n.
        gain_minus = cables.arc_grip[c] + cables.grip[c]
        gain_plus = cables.arc_grip[c] - cables.grip[c]
        if jointed:
            ell, joint = bend(c, minus, plus, pose, before, tables)
        else:
            ell = _straight_length(c, minus, plus, tables.law[ONSET], cables)

        # The start forces, by which a crack begins in equilibrium, fade as the cable opens.
        fade_old = max(0.0, 1.0 - opening_max[c] / start_opening)
        cables.opening[c] = ell
        opening_max[c] = max(opening_max[c], ell)
        fade = max(0.0, 1.0 - opening_max[c] / start_opening)
        if met:  # what the law at the edge no longer stores is dissipated at once
            cables.shed[c] = _work(ell, opening_max[c], tables.law)
            cables.shed[c] -= _work(ell, opening_max[c], law)
        # The traction of the measured length pulls each half along its own branch.
        sigma = traction(ell, opening_max[c], law)
        cables.traction[c] = sigma
        extra = scale(fade, load(cables.start_force, c))
        pull = sigma * cables.area[c]
        by_law_minus = scale(pull, load(cables.branch[c], 0))
        by_law_plus = scale(pull, load(cables.branch[c], 1))
        f_minus = scale(1.0 + joint.gain_minus, by_law_minus)
        f_plus = scale(1.0 + joint.gain_plus, by_law_plus)

        # Work on the cable over the last step, ½ (f_{n-1} + f_n) · Δx at both ends and the joint.
        v_minus = at_end(c, 0, nodes.velocity_half, cables)
        v_plus = at_end(c, 1, nodes.velocity_half, cables)
        was_minus, was_plus = load(cables.force[c], 0), load(cables.force[c], 1)
        # Of the forces by the law alone: the gain by friction is taken out, its work follows below.
        mean_minus = combine(0.5 / (1.0 + gain_minus), was_minus, 0.5, by_law_minus)
        mean_plus = combine(0.5 / (1.0 + gain_plus), was_plus, 0.5, by_law_plus)
        done = -dt * (dot(mean_minus, v_minus) + dot(mean_plus, v_plus))
        if jointed:
            done += work_at_edge(mean_minus, mean_plus, joint, radius)
        cables.work[c] += done
        work += done
        if jointed and tables.joint.slips:
            mean_minus = combine(0.5, was_minus, 0.5, f_minus)
            mean_plus = combine(0.5, was_plus, 0.5, f_plus)
            friction_work -= dot(add(mean_minus, mean_plus), joint.slipped)
            # What friction adds to the law's forces, as above.
            was = 0.5 * gain_minus / (1.0 + gain_minus)
            mean_minus = combine(was, was_minus, 0.5 * joint.gain_minus, by_law_minus)
            was = 0.5 * gain_plus / (1.0 + gain_plus)
            mean_plus = combine(was, was_plus, 0.5 * joint.gain_plus, by_law_plus)
            friction_work -= dt * (dot(mean_minus, v_minus) + dot(mean_plus, v_plus))
            friction_work += work_at_edge(mean_minus, mean_plus, joint, radius)
        relative = sub(v_plus, v_minus)
        started = dt * 0.5 * (fade_old + fade) * dot(load(cables.start_force, c), relative)
        cables.start_work[c] += started
        start_work += started
        store(cables.force[c], 0, f_minus)
        store(cables.force[c], 1, f_plus)
        add_at_end(c, 0, add(f_minus, extra), nodes.force, cables)
        add_at_end(c, 1, sub(f_plus, extra), nodes.force, cables)

        # Forces on both ends and the tool sum to zero; their moments leave the named couple.
        if jointed:
            p, tooth = joint.place, tables.edges.tooth[cables.edge[c]]
            if radius > 0.0:  # the halves leave the round of the edge at places of their own
                react(f_minus, minus, tooth, pose, wrench)
                react(f_plus, plus, tooth, pose, wrench)
            else:
                react(add(f_minus, f_plus), p, tooth, pose, wrench)
                rest = add(cross(sub(minus, p), f_minus), cross(sub(plus, p), f_plus))
                for k in range(3):
                    couple[k] += rest[k]
            rest = cross(sub(minus, plus), extra)
        else:
            rest = cross(sub(minus, plus), add(f_minus, extra))
        for k in range(3):
            couple[k] += rest[k]

        # The law is irreversible: past its end the cable never carries again.
        if not opening_max[c] < law[OPENING_U]:
            status[c] = BROKEN
            cables.end_time[c] = time
            n_broken += 1
    sums[0], sums[1], sums[2], sums[3], sums[4] = work, start_work, friction_work, n_made, n_broken
    return n_made, n_broken


@kernel
def _energies(tables: CableTables, stored: Floats, dissipated: Floats) -> None:
    """Write stored and dissipated energy per area [N/mm], both : (n,), of the first n cables."""
    tables = borrowed(tables)
    cables = tables.cables
    for c in range(stored.shape[0]):
        law = tables.at_edge if cables.edge[c] != NOT_MET else tables.law
        if cables.status[c] == BROKEN:
            stored[c], dissipated[c] = 0.0, law[AREA]
        else:
            stored[c], dissipated[c] = energies(cables.opening[c], cables.opening_max[c], law)
        dissipated[c] += cables.shed[c]
