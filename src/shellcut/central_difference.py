"""Central difference: kick and drift ([Frangi2010] 5.2).

Velocities live at half steps, positions and forces at whole steps:

    v_{n+1/2} = [(1 - ½ alpha Δ) v_{n-1/2} + Δ f_n / m] / (1 + ½ alpha Δ),  Δ = ½ (dt_{n-1} + dt_n)
    x_{n+1}   = x_n + dt_n v_{n+1/2}

and likewise the spin omega of the director, with the moment t x g of the director force g and the
scaled inertia. The spin lies in the tangent plane: the moment is normal to t_n, and the Cayley
rotation about omega keeps omega normal to the new director, so that there is no drilling freedom to
eliminate. Where a support leaves a director one axis f to turn about, omega stays along f, and a
director not normal to f moves on a cone. With the kinetic energy taken as
½ m v_{n-1/2} · v_{n+1/2} and every work as ½ (f_{n-1} + f_n) · Δx, the energy balance of a
constant step is an identity to round-off.

The first kick, from v_0 at t_0, is a half one. Mass damping (alpha) enters the balance with errors
of the order alpha dt.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from .arrays import Bools, Floats, Ints, Number, Vec3, Vector
from .numerics.borrowed import borrowed
from .numerics.jit import BoundOnce, always_inline, kernel
from .numerics.lane_instructions import WIDTH
from .numerics.lanes import along, at, put_at, row_columns, total, vector_at, zero
from .numerics.processor import align_stack
from .numerics.table_address import TableWriter
from .numerics.threads import NODE_CHUNK, Workers, in_order
from .numerics.vec3 import add, add_scaled, combine, cross, dot, load, rotate_director, scale
from .state import KnownTopology, State

# Square of the sine below which a director counts as along the axis of its prescribed spin.
_POLE = 1e-18


class KickResult(NamedTuple):
    """Energies that only the kick can see, at t_n."""

    kinetic_translation: float
    """[N·mm]"""
    kinetic_rotation: float
    """Energy of the scaled inertia [N·mm]."""
    mass_damping: float
    """Dissipated by alpha over the interval centred at t_n [N·mm]."""
    support_work: float
    """Work of the reactions since t_{n-1} [N·mm]."""

    @property
    def kinetic(self) -> float:
        """Energy of translation and rotation [N·mm]."""
        return self.kinetic_translation + self.kinetic_rotation


class _KickStep(NamedTuple):
    """Numbers of one kick."""

    dt_last: float
    """Length of the step before t_n, 0 for the first kick [s]."""
    dt: float
    """Time between the velocities before and after [s]."""
    alpha: float
    """Mass damping [1/s]."""


class _Nodes(NamedTuple):
    """What the kernels need of the nodes, by the names of :class:`shellcut.state.NodeTable`."""

    x: Annotated[Floats, "(n_node, 3)"]
    """Written by the drift, as is t."""
    t: Annotated[Floats, "(n_node, 3)"]
    force_rows: Annotated[Floats, "(n_node, 8)"]
    mass: Annotated[Floats, "(n_node,)"]
    inertia: Annotated[Floats, "(n_node,)"]
    push: Annotated[Floats, "(n_node, 2)"]
    support: Annotated[Bools, "(n_node, 6)"]
    support_rate: Annotated[Floats, "(n_node, 6)"]
    velocity_half: Annotated[Floats, "(n_node, 3)"]
    """Written by the kick, as is all from here on."""
    spin_half: Annotated[Floats, "(n_node, 3)"]
    reaction: Annotated[Floats, "(n_node, 6)"]


class _Supported(NamedTuple):
    """Which nodes are supported."""

    node: Annotated[Ints, "(n_supported,)"]
    """Ascending."""
    first: Annotated[Ints, "(n_chunk + 1,)"]
    """The first of them in every chunk of nodes, and the end."""


class CentralDifference:
    """Advance velocities and positions of all nodes.

    Parameters
    ----------
    damping_alpha : float
        Mass-proportional damping [1/s].
    workers : Workers, optional
        Threads; one by default.
    """

    def __init__(self, *, damping_alpha: float, workers: Workers | None = None) -> None:
        self.damping_alpha = float(damping_alpha)
        self._workers = workers or Workers(0)
        self._known = KnownTopology()
        self._supported: _Supported | None = None
        self._nodes: _Nodes | None = None
        self._sums = np.zeros((0, 4))
        self._address_of_supported, self._address_of_nodes = TableWriter(), TableWriter()
        self._kick, self._drift = BoundOnce(_kick), BoundOnce(_drift)

    def kick(self, state: State, dt_last: float, dt_next: float) -> KickResult:
        """Take velocities from t_{n-1/2} to t_{n+1/2} with the forces at t_n."""
        if not self._known.is_of(state):
            self._collect(state)
        count, alpha, dt = state.node.count, self.damping_alpha, 0.5 * (dt_last + dt_next)
        sums = self._sums
        self._workers.run(
            self._kick, count, float(dt_last), dt, alpha, self._nodes, self._supported, sums
        )
        translation, rotation, mean, support_work = in_order(sums)
        damping = 0.25 * alpha * dt * mean
        return KickResult(0.5 * translation, 0.5 * rotation, damping, support_work)

    def restart(self, state: State, dt_next: float) -> KickResult:
        """Stop the film at t_n and take the half kick to t_{n+1/2}, as from t_0."""
        state.node.stop()
        return self.kick(state, 0.0, dt_next)

    def drift(self, state: State, dt: float) -> None:
        """Take positions and directors from t_n to t_{n+1}."""
        if not self._known.is_of(state):
            self._collect(state)
        self._workers.run(self._drift, state.node.count, float(dt), self._nodes)

    def _collect(self, state: State) -> None:
        """Lay out what the kernels take, good until the next split."""
        n = state.node
        ids = np.flatnonzero(n.supported[: n.count])
        chunks = np.arange(0, n.count + NODE_CHUNK, NODE_CHUNK)
        supported = _Supported(node=ids, first=np.searchsorted(ids, chunks))
        nodes = _Nodes(**{name: getattr(n, name) for name in _Nodes._fields})
        self._sums = np.zeros((chunks.size - 1, 4))
        self._supported, self._nodes = (
            self._address_of_supported(supported),
            self._address_of_nodes(nodes),
        )
        self._known.take(state)


@always_inline
def _put_vector(values: Floats, n: int, lane: int | None, v: Vector) -> None:
    put_at(values, n, 0, lane, v[0])
    put_at(values, n, 1, lane, v[1])
    put_at(values, n, 2, lane, v[2])


@always_inline
def _kick_nodes(
    n: int, lane: int | None, step: _KickStep, nodes: _Nodes
) -> tuple[Number, Number, Number]:
    """Advance node ``n``, or the eight from it; return m v·v', j w·w' and the damping's sum."""
    dt, alpha, mirror = step.dt, step.alpha, step.dt_last == 0.0
    velocity, spin = nodes.velocity_half, nodes.spin_half
    # v_{n+1/2} = keep v_{n-1/2} + each f / m, the first equation of this module.
    keep = (1.0 - 0.5 * alpha * dt) / (1.0 + 0.5 * alpha * dt)
    each = dt / (1.0 + 0.5 * alpha * dt)
    r = row_columns(nodes.force_rows, n, lane)
    by_mass, by_inertia = at(nodes.push, n, 0, lane), at(nodes.push, n, 1, lane)
    v, w = vector_at(velocity, n, lane), vector_at(spin, n, lane)
    # t x g has no part along t: the spin stays in the tangent plane.
    moment = cross(vector_at(nodes.t, n, lane), r[3:6])
    v_after = combine(keep, v, each * by_mass, r[0:3])
    w_after = combine(keep, w, each * by_inertia, moment)
    _put_vector(velocity, n, lane, v_after)
    _put_vector(spin, n, lane, w_after)
    # Supported nodes have no push and count nothing here.
    m, j = along(nodes.mass, n, lane), along(nodes.inertia, n, lane)
    m, j = m * m * by_mass, j * j * by_inertia
    # Twice the mean velocity; the damping's factor ¼ alpha dt follows in the caller.
    v_mean, w_mean = add(v, v_after), add(w, w_after)
    # The first kick is a half one, from v_0: v_{-1/2} = 2 v_0 - v_{1/2}.
    if mirror:
        v, w = combine(2.0, v, -1.0, v_after), combine(2.0, w, -1.0, w_after)
    return (
        m * dot(v, v_after),
        j * dot(w, w_after),
        m * dot(v_mean, v_mean) + j * dot(w_mean, w_mean),
    )


@always_inline
def _spin_with_prescribed_axis(
    n: int, support: Bools, rate: Floats, t: Vec3, free: Vec3
) -> tuple[Vec3, bool]:
    """Return the spin of a director whose turn about one axis h is prescribed, and whether one is.

    It turns about h as prescribed, and freely about h x t: in the plane of h and t. A director
    along h has no such plane, and none of its spin is prescribed.
    """
    h = (
        1.0 if support[n, 3] else 0.0,
        1.0 if support[n, 4] else 0.0,
        1.0 if support[n, 5] else 0.0,
    )
    axis = cross(h, t)
    square = dot(axis, axis)
    if dot(h, h) != 1.0 or square < _POLE:
        return free, False
    # h and h x t are normal to each other, also where the director leans.
    about_h = dot(h, (rate[n, 3], rate[n, 4], rate[n, 5]))
    return combine(about_h, h, dot(axis, free) / square, axis), True


@always_inline
def _kick_supported(
    n: int,
    first: int,
    step: _KickStep,
    m: float,
    force: Vec3,
    before: Vec3,
    nodes: _Nodes,
) -> tuple[Vec3, float, float, float]:
    """Return a supported node's velocity after the kick, m v·v', the damping's sum and the work.

    ``first`` is 0 for translation and 3 for rotation; the reaction is written.
    """
    dt_last, dt, alpha = step
    support, support_rate, reaction = nodes.support, nodes.support_rate, nodes.reaction
    keep = (1.0 - 0.5 * alpha * dt) / (1.0 + 0.5 * alpha * dt)
    push = dt / (1.0 + 0.5 * alpha * dt) / m
    rate = 1.0 / dt
    free = combine(keep, before, push, force)
    kinetic, damping, work = 0.0, 0.0, 0.0
    after = (
        support_rate[n, first] if support[n, first] else free[0],
        support_rate[n, first + 1] if support[n, first + 1] else free[1],
        support_rate[n, first + 2] if support[n, first + 2] else free[2],
    )
    in_plane = False
    if first == 3:
        spin, in_plane = _spin_with_prescribed_axis(
            n, support, support_rate, load(nodes.t, n), free
        )
        if in_plane:
            after = spin
    for c in range(3):
        v, w = before[c], after[c]
        if support[n, first + c] or in_plane:
            # Reaction: mass x acceleration and damping, less the nodal force.
            r = m * (rate * (w - v) + 0.5 * alpha * (w + v)) - force[c]
            work += 0.5 * (reaction[n, first + c] + r) * v * dt_last
            reaction[n, first + c] = r
        damping += m * (v + w) ** 2
        # The first kick starts from v_0: its v_{-1/2} is the mirror image 2 v_0 - v_{1/2}.
        kinetic += m * (v if dt_last > 0.0 else 2.0 * v - w) * w
    return after, kinetic, damping, work


@kernel
def _kick(
    first: int,
    stride: int,
    n_node: int,
    dt_last: float,
    dt: float,
    alpha: float,
    nodes: _Nodes,
    supported: _Supported,
    sums: Floats,
) -> None:
    """Advance velocity and spin of the chunks first, first + stride, ... of nodes.

    dt_last, dt, alpha : as in _KickStep.
    sums : (n_chunk, 4), written: m v·v', j w·w', the damping's sum and the work of the reactions.
    """
    align_stack()
    step, nodes, supported = _KickStep(dt_last, dt, alpha), borrowed(nodes), borrowed(supported)
    velocity, spin, rows = nodes.velocity_half, nodes.spin_half, nodes.force_rows
    moved = np.empty((supported.node.shape[0], 6))
    for chunk in range(first, sums.shape[0], stride):
        start, stop = chunk * NODE_CHUNK, min(n_node, (chunk + 1) * NODE_CHUNK)
        sums[chunk] = 0.0
        # First, and aside: their old velocities are needed, which the loop below overwrites.
        for i in range(supported.first[chunk], supported.first[chunk + 1]):
            n = supported.node[i]
            director = load(nodes.t, n)
            force = rows[n, 0], rows[n, 1], rows[n, 2]
            moment = cross(director, (rows[n, 3], rows[n, 4], rows[n, 5]))
            v, kinetic, damping, work = _kick_supported(
                n, 0, step, nodes.mass[n], force, load(velocity, n), nodes
            )
            w, kinetic_spin, damping_spin, work_spin = _kick_supported(
                n, 3, step, nodes.inertia[n], moment, load(spin, n), nodes
            )
            for c in range(3):
                moved[i, c] = v[c]
                moved[i, 3 + c] = w[c]
            sums[chunk, 0] += kinetic
            sums[chunk, 1] += kinetic_spin
            sums[chunk, 2] += damping + damping_spin
            sums[chunk, 3] += work + work_spin
        p0, p1, p2 = zero(None), zero(None), zero(None)
        for n in range(start, stop - WIDTH + 1, WIDTH):
            q0, q1, q2 = _kick_nodes(n, None, step, nodes)
            p0, p1, p2 = p0 + q0, p1 + q1, p2 + q2
        s0, s1, s2 = total(p0), total(p1), total(p2)
        # What is left of the chunk, node by node: the same function with one lane.
        for n in range(stop - (stop - start) % WIDTH, stop):
            q0, q1, q2 = _kick_nodes(n, 0, step, nodes)
            s0, s1, s2 = s0 + q0, s1 + q1, s2 + q2
        sums[chunk, 0] += s0
        sums[chunk, 1] += s1
        sums[chunk, 2] += s2
        # Only now, for the loop over eight nodes writes them all.
        for i in range(supported.first[chunk], supported.first[chunk + 1]):
            for c in range(3):
                velocity[supported.node[i], c] = moved[i, c]
                spin[supported.node[i], c] = moved[i, 3 + c]


@always_inline
def _drift_nodes(n: int, lane: int | None, dt: float, nodes: _Nodes) -> None:
    v, w = vector_at(nodes.velocity_half, n, lane), vector_at(nodes.spin_half, n, lane)
    _put_vector(nodes.x, n, lane, add_scaled(vector_at(nodes.x, n, lane), dt, v))
    turned = rotate_director(vector_at(nodes.t, n, lane), scale(dt, w))
    _put_vector(nodes.t, n, lane, turned)


@kernel
def _drift(first: int, stride: int, n_node: int, dt: float, nodes: _Nodes) -> None:
    """Advance positions and directors by dt, of every stride-th chunk."""
    align_stack()
    nodes = borrowed(nodes)
    for chunk in range(first, (n_node + NODE_CHUNK - 1) // NODE_CHUNK, stride):
        start, stop = chunk * NODE_CHUNK, min(n_node, (chunk + 1) * NODE_CHUNK)
        for n in range(start, stop - WIDTH + 1, WIDTH):
            _drift_nodes(n, None, dt, nodes)
        for n in range(stop - (stop - start) % WIDTH, stop):
            _drift_nodes(n, 0, dt, nodes)
