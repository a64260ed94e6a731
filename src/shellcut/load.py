"""Loads: gravity, pressure (dead or following), edge traction, nodal forces ([Frangi2010] 17).

Loads on quads and edges are kept by quad, so that each half of a split node takes the share of its
own quads; a nodal force stays with the node that keeps the id.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from ._jit import Floats, Ints, inline, kernel
from ._vec3 import add, combine, cross, load, scale, sub
from .mesh import Mesh
from .state import State
from .support import NodeChoice, choose_nodes

_G = 1.0 / np.sqrt(3.0)


def steady(_time: float) -> float:
    """Return 1: a load that is applied as a step at t = 0 and stays."""
    return 1.0


def _vector(name: str, value: Sequence[float]) -> tuple[float, float, float]:
    v = tuple(float(c) for c in value)
    if len(v) != 3 or not np.isfinite(v).all():
        raise ValueError(f"{name} must be three finite numbers, got {value!r}")
    return v


@dataclass(frozen=True)
class Gravity:
    """Body force, an acceleration [mm/s²] times mass; factor(time) scales it."""

    acceleration: Sequence[float]
    factor: Callable[[float], float] = steady


@dataclass(frozen=True)
class Pressure:
    """Pressure [MPa] along the director's side of the quads, all of them unless a set is named.

    ``following`` pressure turns and stretches with the surface; a dead one keeps the direction and
    the area of the reference.
    """

    value: float
    following: bool = False
    quads: str | None = None
    factor: Callable[[float], float] = steady


@dataclass(frozen=True)
class NodalForce:
    """Dead force [N] on every node of a set or list."""

    nodes: NodeChoice
    force: Sequence[float]
    factor: Callable[[float], float] = steady


@dataclass(frozen=True)
class NodalMoment:
    """Dead moment [N·mm] on the director of every node of a set or list.

    Its part along the director does nothing: five freedoms a node leave no drilling.
    """

    nodes: NodeChoice
    moment: Sequence[float]
    factor: Callable[[float], float] = steady


@dataclass(frozen=True)
class EdgeTraction:
    """Dead force per reference length [N/mm] on the boundary edges between nodes of a set."""

    nodes: NodeChoice
    traction: Sequence[float]
    factor: Callable[[float], float] = steady


Load = Gravity | Pressure | NodalForce | NodalMoment | EdgeTraction


class LoadSet:
    """All loads of a model, resolved to nodes and quads.

    Raises
    ------
    ValueError
        If a set is unknown, a vector has not three components, or no edge is loaded.
    """

    def __init__(self, mesh: Mesh, loads: Sequence[Load]) -> None:
        self._gravity: list[tuple[Floats, Callable[[float], float]]] = []
        self._following: list[tuple[Ints, float, Callable[[float], float]]] = []
        self._nodal: list[tuple[Ints, Floats, Callable[[float], float]]] = []
        self._moment: list[tuple[Ints, Floats, Callable[[float], float]]] = []
        # Quads in ascending order; a quad may be loaded on several of its edges.
        self._by_quad: list[tuple[Ints, Floats, Callable[[float], float]]] = []
        for one in loads:
            if isinstance(one, Gravity):
                g = np.array(_vector("acceleration", one.acceleration))
                self._gravity.append((g, one.factor))
            elif isinstance(one, NodalForce):
                ids = choose_nodes(mesh, one.nodes)
                self._nodal.append((ids, np.array(_vector("force", one.force)), one.factor))
            elif isinstance(one, NodalMoment):
                ids = choose_nodes(mesh, one.nodes)
                self._moment.append((ids, np.array(_vector("moment", one.moment)), one.factor))
            elif isinstance(one, Pressure):
                if not np.isfinite(one.value):
                    raise ValueError(f"value of a pressure must be finite in MPa, got {one.value}")
                quads = np.arange(mesh.n_quad)
                if one.quads is not None:
                    quads = np.sort(mesh.quad_set(one.quads))
                if one.following:
                    self._following.append((quads, float(one.value), one.factor))
                else:
                    rows = np.zeros((quads.size, 4, 3))
                    _pressure_rows(mesh.nodes, mesh.quads, quads, float(one.value), rows)
                    self._by_quad.append((quads, rows, one.factor))
            else:
                self._by_quad.append((*_edge_rows(mesh, one), one.factor))

    @property
    def is_empty(self) -> bool:
        """Whether there is no load at all."""
        return not (
            self._gravity or self._following or self._nodal or self._moment or self._by_quad
        )

    def add_forces(self, state: State) -> float:
        """Add the loads at t_n to the nodal forces; return their work since t_{n-1} [N·mm]."""
        if self.is_empty:
            return 0.0
        n = state.node
        total = np.zeros((n.count, 3))
        for g, factor in self._gravity:
            total += n.mass[: n.count, None] * (factor(state.time) * g)
        for ids, force, factor in self._nodal:
            np.add.at(total, ids, factor(state.time) * force)
        for quads, rows, factor in self._by_quad:
            _scatter_rows(state.quads, quads, rows, factor(state.time), total)
        for quads, value, factor in self._following:
            rows = np.empty((quads.size, 4, 3))
            _pressure_rows(n.x, state.quads, quads, value * factor(state.time), rows)
            _scatter_rows(state.quads, quads, rows, 1.0, total)
        step = state.dt * n.velocity_half[: n.count]
        work = 0.5 * float(((n.load_force[: n.count] + total) * step).sum())
        n.load_force[: n.count] = total
        n.force[: n.count] += total
        for ids, moment, factor in self._moment:
            # The force conjugate to t whose moment t x g is the part of M normal to t.
            m = np.broadcast_to(factor(state.time) * moment, (ids.size, 3))
            np.add.at(n.director_force, ids, np.cross(m, n.t[ids]))
            spin = n.spin_half[ids]
            before = np.broadcast_to(factor(state.time - state.dt) * moment, (ids.size, 3))
            work += 0.5 * state.dt * float(((m + before) * spin).sum())
        return work

    def add_corner_forces(self, state: State, quads: Ints, nodes: Ints, force: Floats) -> None:
        """Add the load on a node that comes through a single quad, gravity left out [N].

        Parameters
        ----------
        state : State
            At t_n.
        quads, nodes : ndarray of int, shape (n,)
            Which quad, and which of its nodes.
        force : ndarray, shape (n, 3)
            Added to.
        """
        for loaded, rows, factor in self._by_quad:
            first = np.searchsorted(loaded, quads, side="left")
            last = np.searchsorted(loaded, quads, side="right")
            for i in np.flatnonzero(first < last).tolist():
                corner = state.quads[quads[i]] == nodes[i]
                on_node = rows[first[i] : last[i], corner]
                force[i] += factor(state.time) * on_node.sum(axis=(0, 1))
        for loaded, value, factor in self._following:
            first = np.searchsorted(loaded, quads)
            mine = np.flatnonzero(loaded[np.minimum(first, loaded.size - 1)] == quads)
            rows = np.empty((mine.size, 4, 3))
            pressure = value * factor(state.time)
            _pressure_rows(state.node.x, state.quads, quads[mine], pressure, rows)
            force[mine] += rows[state.quads[quads[mine]] == nodes[mine, None]]


def _edge_rows(mesh: Mesh, one: EdgeTraction) -> tuple[Ints, Floats]:
    traction = np.array(_vector("traction", one.traction))
    chosen = np.zeros(mesh.n_node, np.bool_)
    chosen[choose_nodes(mesh, one.nodes)] = True
    pair = np.stack([mesh.quads, np.roll(mesh.quads, -1, axis=1)], axis=2)
    key = np.sort(pair, axis=2) @ np.array([mesh.n_node, 1])
    _, inverse, count = np.unique(key, return_inverse=True, return_counts=True)
    loaded = chosen[pair].all(axis=2) & (count[inverse].reshape(key.shape) == 1)
    if not loaded.any():
        raise ValueError(
            f"an edge traction needs boundary edges between its nodes, found none in {one.nodes!r}"
        )
    quads, side = np.nonzero(loaded)
    rows = np.zeros((quads.size, 4, 3))
    length = np.linalg.norm(
        mesh.nodes[pair[quads, side, 1]] - mesh.nodes[pair[quads, side, 0]], axis=1
    )
    half = 0.5 * length[:, None] * traction
    rows[np.arange(quads.size), side] = half
    rows[np.arange(quads.size), (side + 1) % 4] = half
    return quads, rows


@kernel
def _scatter_rows(quads: Ints, which: Ints, rows: Floats, factor: float, force: Floats) -> None:
    """Add rows : (n, 4, 3) of the quads ``which`` to force : (n_node, 3)."""
    for i in range(which.shape[0]):
        for a in range(4):
            for c in range(3):
                force[quads[which[i], a], c] += factor * rows[i, a, c]


@inline
def _weight(c: float, near: bool) -> float:
    return 0.5 * (1.0 - c) if near else 0.5 * (1.0 + c)


@kernel
def _pressure_rows(x: Floats, quads: Ints, which: Ints, pressure: float, rows: Floats) -> None:
    """Write ∫ p N_a a_1 x a_2 over 2 x 2 Gauss points into rows : (n, 4, 3)."""
    for i in range(which.shape[0]):
        e = which[i]
        x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
        x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
        x01, x32, x03, x12 = sub(x1, x0), sub(x2, x3), sub(x3, x0), sub(x2, x1)
        for a in range(4):
            for c in range(3):
                rows[i, a, c] = 0.0
        for q in range(4):
            xi = -_G if q in (0, 3) else _G
            eta = -_G if q < 2 else _G
            a1 = combine(0.5 * _weight(eta, True), x01, 0.5 * _weight(eta, False), x32)
            a2 = combine(0.5 * _weight(xi, True), x03, 0.5 * _weight(xi, False), x12)
            p = scale(pressure, cross(a1, a2))
            for a in range(4):
                n = _weight(xi, a in (0, 3)) * _weight(eta, a < 2)
                sum_ = add(load(rows[i], a), scale(n, p))
                for c in range(3):
                    rows[i, a, c] = sum_[c]
