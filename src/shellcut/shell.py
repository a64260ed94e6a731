"""MITC4Shell: the film. Internal and damping forces, lumped mass, stresses, stiffness bound.

Damping is proportional to the stiffness, on the strain rate: the stress acts on s + beta ds/dt,
with ds/dt = (s_n - s_{n-1}) / dt, the rate of the half step before t_n (so the step stays explicit;
[Frangi2010] 5.2). The work of the damping stress over a step is summed as
½ (r_{n-1} + r_n) · (s_n - s_{n-1}) with r its resultants, the central difference's own work.
"""

from __future__ import annotations

import numpy as np

from ._jit import Bools, Floats, Ints, inline, kernel
from .centre_stress import CentreStress
from .material import ShellMaterial
from .mesh import Mesh
from .mitc4 import N_STRAIN, covariant_metric, nodal_forces, resultants
from .quad_frequency import QuadFrequencies
from .section import build_sections
from .state import State
from .tangent import N_FREEDOM, quad_tangents
from .thickness_points import build_points, point_resultants

# Rotary inertia m max(h²/12, A / _INERTIA_AREA): bending waves of so thin a shell would otherwise
# set the step ([Frangi2010] 5.2, after Hughes 1987, ch. 9).
_INERTIA_AREA = 8.0


class MITC4Shell:
    """Internal forces of all quads.

    Parameters
    ----------
    mesh : Mesh
        Reference surface.
    material : ShellMaterial
        Layers.
    damping_beta : float
        Stiffness-proportional damping [s].
    """

    def __init__(self, mesh: Mesh, material: ShellMaterial, *, damping_beta: float) -> None:
        self.material = material
        self.damping_beta = damping_beta
        self.section = build_sections(mesh.nodes, mesh.directors, mesh.quads, material)
        self.points = build_points(mesh.nodes, mesh.directors, mesh.quads, material)
        rotary = np.maximum(material.thickness**2 / 12.0, self.section.area / _INERTIA_AREA)
        self.quad_inertia = self.section.mass * rotary[:, None]
        """Share of each node in the quad's rotary inertia [t·mm²], shape (n_quad, 4)."""
        true = self.section.mass.sum() * material.thickness**2 / 12.0
        self.added_inertia_factor = float(self.quad_inertia.sum() / true)
        """Scaled over true rotary inertia of the whole film."""
        self.metric = np.zeros((mesh.n_quad, N_STRAIN))
        """Scalar products of the reference surface, subtracted from the current ones."""
        _reference_metric(X=mesh.nodes, T=mesh.directors, quads=mesh.quads, metric=self.metric)
        self._centre_stress = CentreStress(mesh, material)
        self.frequencies = QuadFrequencies(
            mesh, material, self.section.mass, self.quad_inertia, self._tangents
        )
        """Bounds of the largest frequency of each quad."""

    def node_inertia(self, state: State, node: int) -> tuple[float, float, float]:
        """Return mass [t], rotary inertia [t·mm²] and contact area [mm²] of a node from its quads.

        The sums run over the node's quads in ascending order, so that the two halves of a split
        node share the mass by elements, whatever the order of the splits.
        """
        at = state.node.quads[node, : state.node.n_quad_at[node]]
        corner = np.argmax(state.quads[at] == node, axis=1)
        return (
            float(sum(self.section.mass[at, corner])),
            float(sum(self.quad_inertia[at, corner])),
            0.25 * float(self.section.area[at].mean()),
        )

    def initialise(self, state: State) -> None:
        """Write mass, rotary inertia and contact area of all nodes; lay out the history."""
        p = self.points
        state.history = np.zeros((self.metric.shape[0], 4, p.n_point, p.n_history))
        for n in range(state.n_node):
            mass, inertia, area = self.node_inertia(state, n)
            state.node.mass[n], state.node.inertia[n] = mass, inertia
            state.node.contact_area[n] = area

    def add_forces(self, state: State) -> tuple[float, float]:
        """Add minus the internal and damping forces at t_n to the nodal forces.

        Returns
        -------
        strain_energy : float
            At t_n [N·mm].
        damping_work : float
            Dissipated since t_{n-1} [N·mm].
        """
        s, p, n = self.section, self.points, state.node
        rate = self.damping_beta / state.dt if state.dt > 0 else 0.0
        return _add_quad_forces(
            x=n.x,
            t=n.t,
            quads=state.quads,
            metric=self.metric,
            flat=s.flat,
            row=s.row,
            h_flat=s.h_flat,
            h_full=s.h_full,
            cartesian=p.map,
            weight=p.weight,
            place=p.place,
            kind=p.kind,
            parameters=p.parameters,
            shear=p.shear,
            history=state.history,
            damping_rate=rate,
            strain=state.strain,
            strain_step=state.strain_step,
            force=n.force,
            director_force=n.director_force,
        )

    def corner_forces(self, state: State, quads: Ints, nodes: Ints, dt: float) -> Floats:
        """Return minus the internal and damping force of single quads on one of their nodes [N].

        Parameters
        ----------
        state : State
            Positions at t_{n+1}, strains of t_n.
        quads, nodes : ndarray of int, shape (n,)
            Which quad, and which of its nodes.
        dt : float
            Length of the step between [s].

        Returns
        -------
        ndarray, shape (n, 3)
        """
        s, p = self.section, self.points
        force = np.empty((quads.size, 3))
        _corner_forces(
            which=quads,
            nodes=nodes,
            x=state.node.x,
            t=state.node.t,
            quads=state.quads,
            metric=self.metric,
            flat=s.flat,
            row=s.row,
            h_flat=s.h_flat,
            h_full=s.h_full,
            cartesian=p.map,
            weight=p.weight,
            place=p.place,
            kind=p.kind,
            parameters=p.parameters,
            shear=p.shear,
            history=state.history,
            damping_rate=self.damping_beta / dt if dt > 0 else 0.0,
            strain=state.strain,
            force=force,
        )
        return force

    def stress(self, state: State, quads: Ints, *, place: str = "mid") -> Floats:
        """Return the Cauchy stress tensor at the centre of some quads [MPa].

        Parameters
        ----------
        state : State
            Current positions.
        quads : ndarray of int, shape (n,)
            Which quads.
        place : {"mid", "top", "bottom", "nominal"}
            Height at which it is taken; ``nominal`` is the mid-surface's second Piola-Kirchhoff
            stress turned with the surface, without the change of area.

        Returns
        -------
        ndarray, shape (n, 3, 3)
            Components in space.
        """
        return self._centre_stress.cauchy(state.node.x, state.node.t, state.quads, quads, place)

    def tangents(self, state: State, quads: Ints) -> Floats:
        """Return the tangent stiffness of some quads at the present state, shape (n, 20, 20).

        Freedoms as in :mod:`shellcut.tangent`; of the pre-integrated section.
        """
        return self._tangents(state.node.x, state.node.t, state.quads, quads)

    def _tangents(self, x: Floats, t: Floats, quads: Ints, which: Ints) -> Floats:
        s = self.section
        tangent = np.empty((which.size, N_FREEDOM, N_FREEDOM))
        quad_tangents(
            which=which,
            x=x,
            t=t,
            quads=quads,
            metric=self.metric,
            flat=s.flat,
            row=s.row,
            h_flat=s.h_flat,
            h_full=s.h_full,
            tangent=tangent,
        )
        return tangent


@inline
def _gather(rows: Floats, quads: Ints, e: int, out: Floats) -> None:
    for a in range(4):
        n = quads[e, a]
        for c in range(3):
            out[a, c] = rows[n, c]


@kernel
def _reference_metric(X: Floats, T: Floats, quads: Ints, metric: Floats) -> None:
    xe, te = np.empty((4, 3)), np.empty((4, 3))
    for e in range(quads.shape[0]):
        _gather(X, quads, e, xe)
        _gather(T, quads, e, te)
        covariant_metric(xe, te, metric[e])


@kernel
def _add_quad_forces(
    x: Floats,
    t: Floats,
    quads: Ints,
    metric: Floats,
    flat: Bools,
    row: Ints,
    h_flat: Floats,
    h_full: Floats,
    cartesian: Floats,
    weight: Floats,
    place: Floats,
    kind: Ints,
    parameters: Floats,
    shear: Floats,
    history: Floats,
    damping_rate: float,
    strain: Floats,
    strain_step: Floats,
    force: Floats,
    director_force: Floats,
) -> tuple[float, float]:
    """Add minus dW/dx and dW/dt of every quad, with stiffness damping, to the nodal forces.

    x, t, force, director_force : (n_node, 3).  quads : (n_quad, 4).  metric : (n_quad, 20).
    cartesian .. shear : fields of PointTable, taken if it has points, with history : (n_quad, 4,
    n_point, n_history).  damping_rate : beta / dt.  Writes history, strain and strain_step :
    (n_quad, 20), reading the last ones.
    Returns strain energy and damping work [N·mm].
    """
    xe, te = np.empty((4, 3)), np.empty((4, 3))
    fx, ft = np.empty((4, 3)), np.empty((4, 3))
    s, ds = np.empty(20), np.empty(20)
    r, rd = np.empty(20), np.empty(20)
    energy = 0.0
    damping = 0.0
    for e in range(quads.shape[0]):
        _gather(x, quads, e, xe)
        _gather(t, quads, e, te)
        covariant_metric(xe, te, s)
        for k in range(20):
            s[k] -= metric[e, k]
            ds[k] = s[k] - strain[e, k]
        if place.shape[0] > 0:
            energy += point_resultants(
                s, e, cartesian, weight, place, kind, parameters, shear, history[e], history[e], r
            )
        else:
            resultants(s, flat[e], h_flat, h_full, row[e], r)
            for k in range(20):
                energy += 0.5 * s[k] * r[k]
        if damping_rate > 0.0:
            resultants(ds, flat[e], h_flat, h_full, row[e], rd)
            work = 0.0
            for k in range(20):
                work += (strain_step[e, k] + ds[k]) * rd[k]
                r[k] += damping_rate * rd[k]
            damping += 0.5 * damping_rate * work
        for k in range(20):
            strain[e, k] = s[k]
            strain_step[e, k] = ds[k]
        nodal_forces(xe, te, r, fx, ft)
        for a in range(4):
            n = quads[e, a]
            for c in range(3):
                force[n, c] -= fx[a, c]
                director_force[n, c] -= ft[a, c]
    return energy, damping


@kernel
def _corner_forces(
    which: Ints,
    nodes: Ints,
    x: Floats,
    t: Floats,
    quads: Ints,
    metric: Floats,
    flat: Bools,
    row: Ints,
    h_flat: Floats,
    h_full: Floats,
    cartesian: Floats,
    weight: Floats,
    place: Floats,
    kind: Ints,
    parameters: Floats,
    shear: Floats,
    history: Floats,
    damping_rate: float,
    strain: Floats,
    force: Floats,
) -> None:
    """Write minus the force of quad which[i] on its node nodes[i] to force : (n, 3)."""
    xe, te = np.empty((4, 3)), np.empty((4, 3))
    fx, ft = np.empty((4, 3)), np.empty((4, 3))
    s, r = np.empty(20), np.empty(20)
    ds, rd = np.empty(20), np.empty(20)
    trial = np.empty_like(history[0])
    for i in range(which.shape[0]):
        e = which[i]
        _gather(x, quads, e, xe)
        _gather(t, quads, e, te)
        covariant_metric(xe, te, s)
        for k in range(20):
            s[k] -= metric[e, k]
            ds[k] = damping_rate * (s[k] - strain[e, k])
        resultants(ds, flat[e], h_flat, h_full, row[e], rd)
        if place.shape[0] > 0:
            point_resultants(
                s, e, cartesian, weight, place, kind, parameters, shear, history[e], trial, r
            )
        else:
            resultants(s, flat[e], h_flat, h_full, row[e], r)
        for k in range(20):
            r[k] += rd[k]
        nodal_forces(xe, te, r, fx, ft)
        for a in range(4):
            if quads[e, a] == nodes[i]:
                for c in range(3):
                    force[i, c] = -fx[a, c]
