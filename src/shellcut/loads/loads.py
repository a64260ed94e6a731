"""Loads: gravity, pressure (dead or following), edge traction, nodal forces ([Frangi2010] 17).

Dead loads are summed to the nodes once; when a node splits, the loads of both halves are recomputed
from their own quads (:mod:`.dead_loads`). Of a cut quad each copy has what acts on its own part of
the film (:mod:`.cut_quads`). A nodal force stays with the node that keeps the id.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked, finite_at
from shellcut.arrays import Floats, Ints, Number, product, three
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.jit import BoundOnce, always_inline, kernel
from shellcut.numerics.lane_instructions import WIDTH
from shellcut.numerics.lanes import add_row_columns, total, vector_at, zero
from shellcut.numerics.threads import NODE_CHUNK, Workers
from shellcut.numerics.vec3 import dot, scale
from shellcut.state import State

from .cut_quads import CutQuads
from .dead_loads import DeadLoad, DeadPressure, EdgeForces, Rule, Weight
from .pressure import FollowingPressure
from .supports import NodeChoice, choose_nodes

Factor = Callable[[float], float]


def steady(_time: float) -> float:
    """Return 1: a load applied as a step at t = 0, constant from then on."""
    return 1.0


@checked
@dataclass(frozen=True)
class Gravity:
    """Body force, acceleration [mm/s²] times mass; factor(time) scales it.

    Examples
    --------
    >>> load = Gravity((0.0, 0.0, -9810.0))
    """

    acceleration: Annotated[Sequence[float], Option("mm/s^2", "force over mass", form="3 numbers")]
    factor: Factor = steady


@checked
@dataclass(frozen=True)
class Pressure:
    """Pressure [MPa] along the director's side of the quads; all quads unless a set is given.

    ``following`` pressure turns and stretches with the surface; dead pressure keeps direction and
    area of the reference.

    Examples
    --------
    >>> load = Pressure(0.01, following=True)  # 10 kPa
    """

    value: Annotated[float, Option("MPa", "positive towards the side of the directors")]
    following: Annotated[bool, Option("", "whether it follows the surface")] = False
    quads: Annotated[str | None, Option("", "quad set", unset="all quads")] = None
    factor: Factor = steady


@checked
@dataclass(frozen=True)
class NodalForce:
    """Dead force [N] on every node of a set or list.

    Examples
    --------
    >>> load = NodalForce([12], (0.0, 0.0, -0.5), factor=lambda time: min(time / 1e-3, 1.0))
    """

    nodes: NodeChoice
    force: Annotated[Sequence[float], Option("N", "force on each node", form="3 numbers")]
    factor: Factor = steady


@checked
@dataclass(frozen=True)
class NodalMoment:
    """Dead moment [N·mm] on the director of every node of a set or list.

    Its part along the director has no effect: with five freedoms per node there is no drilling.

    Examples
    --------
    >>> load = NodalMoment("right", (0.0, 3.0, 0.0))
    """

    nodes: NodeChoice
    moment: Annotated[Sequence[float], Option("N*mm", "moment on each", form="3 numbers")]
    factor: Factor = steady


@checked
@dataclass(frozen=True)
class EdgeTraction:
    """Dead force per reference length [N/mm] on the sides of the border between nodes of a set.

    Examples
    --------
    >>> load = EdgeTraction("right", (2.0, 0.0, 0.0))  # pulls along x
    """

    nodes: NodeChoice
    traction: Annotated[Sequence[float], Option("N/mm", "force over length", form="3 numbers")]
    factor: Factor = steady


Load = Gravity | Pressure | NodalForce | NodalMoment | EdgeTraction


class LoadSet:
    """All loads of a model, resolved to nodes and quads; ValueError if one cannot be."""

    def __init__(self, mesh: Mesh, loads: Sequence[Load], workers: Workers | None = None) -> None:
        self._workers = workers or Workers(0)
        self._cleared = BoundOnce(_clear_forces)
        self._added = BoundOnce(_add_dead_force)
        self.cut = CutQuads()
        """Which part of its quad each copy holds; whoever cuts a quad writes it down here."""
        self._dead: list[DeadLoad] = []
        self._following: list[FollowingPressure] = []
        rule: Rule
        self._nodal: list[tuple[Ints, Floats, Factor]] = []
        self._moment: list[tuple[Ints, Floats, Factor]] = []
        for k, load in enumerate(loads):
            factor = finite_at(f"factor of loads[{k}] ({type(load).__name__})", load.factor)
            if isinstance(load, Gravity):
                g = three("acceleration", load.acceleration)
                self._dead.append(DeadLoad(factor, Weight(g)))
            elif isinstance(load, NodalForce):
                ids = choose_nodes(mesh, load.nodes)
                self._nodal.append((ids, three("force", load.force), factor))
            elif isinstance(load, NodalMoment):
                ids = choose_nodes(mesh, load.nodes)
                self._moment.append((ids, three("moment", load.moment), factor))
            elif isinstance(load, Pressure):
                if not np.isfinite(load.value):
                    raise ValueError(f"value of a pressure must be finite in MPa, got {load.value}")
                quads = np.arange(mesh.n_quad) if load.quads is None else mesh.quad_set(load.quads)
                if load.following:
                    push = FollowingPressure(mesh, quads, float(load.value), factor, self.cut)
                    self._following.append(push)
                else:
                    rule = DeadPressure(mesh, quads, float(load.value), self.cut)
                    self._dead.append(DeadLoad(factor, rule))
            else:
                rule = EdgeForces(*_loaded_sides(mesh, load), self.cut)
                self._dead.append(DeadLoad(factor, rule))

    def begin_forces(self, state: State) -> float:
        """Set the nodal forces to the loads at t_n; return their work since t_{n-1} [N·mm]."""
        n, dt = state.node, state.dt
        now, before = state.time, state.time - state.tick
        work = 0.0
        self._workers.run(self._cleared, n.count, n.force_rows)
        for dead in self._dead:
            dead.follow(state)
            times, sums = float(dead.factor(now)), np.zeros(-(-n.count // NODE_CHUNK))
            self._workers.run(
                self._added, n.count, dead.force, times, n.velocity_half, n.force_rows, sums
            )
            work += 0.5 * (times + dead.factor(before)) * dt * float(np.add.reduce(sums))
        self._add_nodal_forces(state, n.force)
        for ids, force, factor in self._nodal:
            mean = 0.5 * (factor(now) + factor(before)) * force
            work += dt * float(product(n.velocity_half[ids], mean).sum())
        if self._following:
            pushed = np.zeros((n.count, 3))
            for push in self._following:
                push.add_forces(state, pushed)
            step = dt * n.velocity_half[: n.count]
            work += 0.5 * float(((n.load_force[: n.count] + pushed) * step).sum())
            n.load_force[: n.count] = pushed
            n.force[: n.count] += pushed
        for ids, moment, factor in self._moment:
            # The force conjugate to t whose moment t x g is the part of M normal to t.
            m = np.broadcast_to(factor(now) * moment, (ids.size, 3))
            np.add.at(n.director_force, ids, np.cross(m, n.t[ids]))
            mean = 0.5 * (factor(now) + factor(before)) * moment
            work += dt * float(product(n.spin_half[ids], mean).sum())
        return work

    def largest(self, state: State) -> float:
        """Return the largest component of the nodal loads, without moments [N]."""
        n = state.node.count
        every = state.node.load_force[:n].copy()
        for dead in self._dead:
            dead.follow(state)
            every += dead.factor(state.time) * dead.force[:n]
        self._add_nodal_forces(state, every)
        return float(np.abs(every).max(initial=0.0))

    def _add_nodal_forces(self, state: State, force: Floats) -> None:
        """Add the forces given for single nodes to those on the nodes, (n_node, 3) [N]."""
        for ids, vector, factor in self._nodal:
            np.add.at(force, ids, factor(state.time) * vector)

    def stiffness(self, state: State) -> Floats | None:
        """Return the stiffness of following pressure, shape (n_quad, 12, 12) [N/mm], or None."""
        if not self._following:
            return None
        stiffness = np.zeros((state.quads.shape[0], 12, 12))
        for push in self._following:
            push.add_stiffness(state, stiffness)
        return stiffness

    def add_corner_forces(self, state: State, quads: Ints, nodes: Ints, force: Floats) -> None:
        """Add the load on a node from a single quad, without gravity [N].

        quads, nodes : (n,), quad and one of its nodes.  force : (n, 3), added to.
        """
        corner = state.quads[quads] == nodes[:, None]
        for dead in self._dead:
            rows = dead.rule.on_rows(state, quads)
            if rows is not None:
                force += dead.factor(state.time) * rows[corner]
        for push in self._following:
            force += push.on_rows(state, quads)[corner]


def _loaded_sides(mesh: Mesh, load: EdgeTraction) -> tuple[Ints, Ints, Floats]:
    """Return quads and sides on which an edge traction acts, and the force on each [N], (n, 3)."""
    traction = three("traction", load.traction)
    chosen = np.zeros(mesh.n_node, np.bool_)
    chosen[choose_nodes(mesh, load.nodes)] = True
    pair = np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=2)
    key = product(np.sort(pair, axis=2), np.array([mesh.n_node, 1]))
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    loaded = chosen[pair].all(axis=2) & (count[inverse].reshape(key.shape) == 1)
    if not loaded.any():
        raise ValueError(
            f"an edge traction needs quad sides on the border, found none in {load.nodes!r}"
        )
    quads, side = np.nonzero(loaded)
    length = np.linalg.norm(
        mesh.nodes[pair[quads, side, 1]] - mesh.nodes[pair[quads, side, 0]], axis=1
    )
    return quads, side, length[:, None] * traction


@always_inline
def _dead_at(
    n: int,
    lane: int | None,
    dead: Floats,
    factor: float,
    velocity: Floats,
    rows: Floats,
) -> Number:
    """Add factor dead at node ``n``, or the eight from ``n``; return the power of ``dead``."""
    force, v = vector_at(dead, n, lane), vector_at(velocity, n, lane)
    # The power is of the load at factor 1: begin_forces scales it by the mean of both factors.
    add_row_columns(rows, n, lane, scale(factor, force))
    return dot(force, v)


@kernel
def _add_dead_force(
    first: int,
    stride: int,
    n_node: int,
    dead: Floats,
    factor: float,
    velocity: Floats,
    rows: Floats,
    sums: Floats,
) -> None:
    """Add factor dead : (n_node, 3) to rows : (n_node, 8), in every ``stride``-th chunk.

    Writes the power of ``dead`` to sums : (n_chunk,).
    """
    for chunk in range(first, sums.shape[0], stride):
        start, stop = chunk * NODE_CHUNK, min(n_node, (chunk + 1) * NODE_CHUNK)
        powers = zero(None)
        for n in range(start, stop - WIDTH + 1, WIDTH):
            powers = powers + _dead_at(n, None, dead, factor, velocity, rows)
        power = total(powers)
        for n in range(stop - (stop - start) % WIDTH, stop):
            power += _dead_at(n, 0, dead, factor, velocity, rows)
        sums[chunk] = power


@kernel
def _clear_forces(first: int, stride: int, n_node: int, rows: Floats) -> None:
    """Set rows : (n_node, 8) to zero in every ``stride``-th chunk."""
    for chunk in range(first, (n_node + NODE_CHUNK - 1) // NODE_CHUNK, stride):
        start, stop = chunk * NODE_CHUNK, min(n_node, (chunk + 1) * NODE_CHUNK)
        for n in range(start, stop):
            for c in range(8):
                rows[n, c] = 0.0
