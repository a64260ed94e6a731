"""MITC4Shell: the film. Internal and damping forces, lumped mass, stresses, stiffness bound."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.lane_instructions import WIDTH
from shellcut.numerics.lanes import aligned_zeros
from shellcut.numerics.threads import Workers, in_order
from shellcut.state import State

from .blocks import QuadBlocks, build_blocks
from .centre_stress import CentreStress, FaceStresses
from .element import N_STRAIN
from .film_tangents import FilmTangents
from .forces import (
    Work,
    add_flat_point_quads,
    add_flat_quads,
    add_full_point_quads,
    add_full_quads,
    linear_work,
    write_corner_forces,
    write_point_corner_forces,
)
from .frequency import QuadFrequencies
from .places import BLOCKS_AT_A_TIME, Places
from .point_output import PointOutput
from .quad_strains import LinearTables, QuadStep
from .section import reference_quads
from .surface import LEAST_AREA, Surface, smallest_area_ratio
from .thickness_points import PointTables

# Rotary inertia m max(h²/12, A / _INERTIA_AREA): otherwise bending waves of such a thin shell would
# limit the step ([Frangi2010] 5.2, after Hughes 1987, ch. 9).
_INERTIA_AREA = 8.0

DAMPING_SHARE = 0.15
"""Share of critical damping at the highest frequency by default: it shortens the step by 14 %. The
paper's 5e-8 s is 0.14 on the mesh ``quick``, 0.56 on M2 and more on finer ones, where it sets the
step."""


class MITC4Shell:
    """Internal forces of all quads.

    Parameters
    ----------
    mesh : Mesh
        Reference surface.
    material : ShellMaterial
        Layers.
    damping_beta : float, optional
        Stiffness-proportional damping [s]; by default that of ``damping_share``.
    damping_share : float
        Share of critical damping at the highest frequency omega of the reference film: beta is
        2 share / omega.
    workers : Workers, optional
        Threads; one by default.
    """

    def __init__(
        self,
        mesh: Mesh,
        material: ShellMaterial,
        *,
        damping_beta: float | None = None,
        damping_share: float = DAMPING_SHARE,
        workers: Workers | None = None,
    ) -> None:
        self.material = material
        self._workers = workers or Workers(mesh.n_quad)
        flat, mass, area = reference_quads(mesh, material, BLOCKS_AT_A_TIME * WIDTH)
        self.mass = mass
        """Share of each corner in the quad's mass [t], shape (n_quad, 4)."""
        self.area = area
        """Reference area of the quads [mm²], shape (n_quad,)."""
        self.reference = Surface.of(mesh)
        """Nodes, directors and corners of every quad and copy in the mesh."""
        blocks = build_blocks(mesh.nodes, mesh.quads, flat)
        self._places = Places(mesh, material, blocks, mass)
        self.has_points = bool(self.points.rule.place.size)
        """Whether the thickness is integrated with points at every step."""
        kernels: tuple[Any, Any] = (add_flat_quads, add_full_quads)
        if self.has_points:
            kernels = (add_flat_point_quads, add_full_point_quads)
        starts = (self.blocks.flat_start, self.blocks.full_start)
        # A kernel for each kind of quads in the mesh, and the starts of its strips.
        self._kernels = [
            (BoundOnce(kernel), start)
            for kernel, start in zip(kernels, starts, strict=True)
            if start[0] < start[-1]
        ]
        self._add_copies = BoundOnce(add_full_point_quads if self.has_points else add_full_quads)
        self._write_corner_forces = BoundOnce(
            write_point_corner_forces if self.has_points else write_corner_forces
        )
        self._output: CentreStress | PointOutput
        if material.is_linear:
            self._output = CentreStress(self.reference, material)
        else:
            self._output = PointOutput(material, self._places)
        self._tangents = FilmTangents(self._places, material.is_linear)
        self._history = self._history_at_rest()
        # On the film of a linear law the tangent without its pre-stress is what is damped.
        is_damped = damping_share > 0.0 if damping_beta is None else damping_beta > 0.0
        damped = self._damped_stiffness if self.has_points and is_damped else None
        self.frequencies = QuadFrequencies(
            mesh, material, self.corner_shares, self._tangent_bounds, damped
        )
        """Bounds of the largest frequency of each quad."""
        if damping_beta is None:
            damping_beta = 2.0 * damping_share / math.sqrt(self.frequencies.squared.max())
        self.damping_beta = damping_beta
        """Stiffness-proportional damping [s]."""

    @property
    def blocks(self) -> QuadBlocks:
        """Which quad is at which place."""
        return self._places.blocks

    @property
    def tables(self) -> LinearTables:
        """What does not change of the quads, by place."""
        return self._places.tables

    @property
    def points(self) -> PointTables:
        """What does not change of their thickness points, by place."""
        return self._places.points

    @property
    def mesh_quads(self) -> Ints:
        """Nodes of the mesh at the corners of every quad and copy, shape (n, 4)."""
        return self.reference.quads

    @property
    def added_inertia_factor(self) -> float:
        """Scaled over true rotary inertia of the whole film."""
        true = self.mass.sum() * self.material.thickness**2 / 12.0
        return float(product(self.mass.sum(axis=1), self._gyration(slice(None))) / true)

    def quad_inertia(self, quads: Ints) -> Floats:
        """Return the share of each corner in the rotary inertia of quads [t·mm²], shape (n, 4)."""
        return np.asarray(self.mass[quads] * self._gyration(quads)[:, None])

    def corner_shares(self, quads: Ints) -> tuple[Floats, Floats]:
        """Return the corners' shares of mass [t] and inertia [t·mm²], shape (n, 4) each."""
        return self.mass[quads], self.quad_inertia(quads)

    def _gyration(self, quads: Ints | slice) -> Floats:
        """Return the square of the radius of gyration of quads [mm²], scaled."""
        return np.maximum(self.material.thickness**2 / 12.0, self.area[quads] / _INERTIA_AREA)

    def node_inertia(self, state: State, node: int) -> tuple[float, float, float]:
        """Return mass [t], rotary inertia [t·mm²] and contact area [mm²] of a node from its quads.

        The sums run over the node's quads in ascending order, so the halves of a split node share
        the mass by elements, whatever the order of the splits.
        """
        at = state.node.quads[node, : state.node.n_quad_at[node]]
        corner = np.argmax(state.quads[at] == node, axis=1)
        return (
            float(sum(self.mass[at, corner])),
            float(sum(self.quad_inertia(at)[np.arange(at.size), corner])),
            0.25 * float(self.area[at].mean()),
        )

    def initialise(self, state: State) -> None:
        """Write mass, rotary inertia, contact area of all nodes; allocate strains and history."""
        n, node = state.n_node, state.node
        n_block = self.blocks.quad.shape[0]
        state.strain = aligned_zeros((n_block, N_STRAIN, WIDTH))
        state.strain_before = aligned_zeros((n_block, N_STRAIN, WIDTH))
        state.history = self._history = self._history_at_rest()
        for a in range(4):
            ids = state.quads[:, a]
            node.mass[:n] += np.bincount(ids, self.mass[:, a], n)
            node.inertia[:n] += np.bincount(ids, self.mass[:, a] * self._gyration(slice(None)), n)
            node.contact_area[:n] += np.bincount(ids, self.area, n)
        node.contact_area[:n] *= 0.25 / np.maximum(node.n_quad_at[:n], 1)
        node.contact_mass[:n] = node.mass[:n]
        node.push[:n, 0], node.push[:n, 1] = 1.0 / node.mass[:n], 1.0 / node.inertia[:n]

    def _history_at_rest(self) -> Floats:
        rule, n_block = self.points.rule, self.blocks.quad.shape[0]
        n_history = 4 * rule.place.size * rule.n_history
        return np.asarray(aligned_zeros((n_block, n_history, WIDTH)))

    def add_forces(self, state: State) -> Work:
        """Add minus the internal and damping forces at t_n to the nodal forces."""
        step = self._step(state)
        damped, rho = step.damped, step.rho
        n_strip, copies = self.blocks.n_strip, self._places.has_copies
        sums = np.zeros((n_strip + copies, 3))
        rows = state.node.force_rows
        quads = self._places.address(state)

        # Strips of one parity have no node in common (see :mod:`.blocks`).
        for parity in range(2 if n_strip > 1 else 1):
            for add, start in self._kernels:
                self._workers.run(add, parity, start, quads, step, rows, sums)
        if copies:  # they are the last strip
            start = self._places.copy_start
            self._add_copies(0, 1, 0, start, quads, step, rows, sums[n_strip:])
        if damped:
            state.strain, state.strain_before = state.strain_before, state.strain
        p0, p1, p2 = in_order(sums)
        if self.has_points:
            return Work(p0, 0.5 * rho * p1, p2)
        return linear_work(state, p0, p1, p2, rho) if damped else Work(0.5 * p0, 0.0, 0.0)

    def _step(self, state: State) -> QuadStep:
        """Return strains, history and damping of the step that has led to t_n."""
        rho = self.damping_beta / state.dt if state.dt > 0 else 0.0
        damped = self.damping_beta > 0.0
        return QuadStep(damped, rho, state.strain, state.strain_before, state.history, state.dt)

    def cut(
        self,
        state: State,
        row: int,
        new: int,
        shares: tuple[float, float],
        mass_shares: tuple[float, float],
    ) -> None:
        """Give the two copies of a cut quad the part of it that they carry.

        Mass and stiffness by their shares, which are written to the state; strains and history are
        copied. Their nodes are as they were: :mod:`shellcut.fracture` assigns new ones.

        Parameters
        ----------
        state : State
            With both rows in ``state.quad``.
        row, new : int
            What was cut and keeps one part, and the row of the other part, the last one.
        shares, mass_shares : tuple of two floats
            What each carries of the whole quad of the mesh and of its mass.
        """
        self._take_rows(state)
        quad, both = state.quad, [row, new]
        before = quad.share[row] / quad.mass_share[row]
        quad.share[both], quad.mass_share[both] = shares, mass_shares
        self.frequencies.cut(row, quad.share[both] / quad.mass_share[both] / before)
        self._places.cut(state, row, new)
        for copy in (row, new):
            self.mass[copy] = self._places.mass_of(state, copy)
        self._history = state.history

    def saved(self) -> dict[str, Any]:
        """Return the places of all quads and copies; all else follows from the state."""
        return {"slot": self.blocks.slot}

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        if state.n_quad < len(self.mass):
            raise ValueError("it has fewer cuts than this film has from the start")
        self._take_rows(state)
        self._places.restore(state, saved["slot"])
        for row in np.flatnonzero(state.quad.mass_share[: state.n_quad] < 1.0).tolist():
            self.mass[row] = self._places.mass_of(state, row)
        self._history = state.history

    def _take_rows(self, state: State) -> None:
        """Make room for the copies that the state has got."""
        copies = state.quad.parent[len(self.mass) : state.n_quad]
        if not copies.size:
            return
        self.mass = np.concatenate([self.mass, self.mass[copies]])
        self.area = np.concatenate([self.area, self.area[copies]])
        nodes, directors, quads = self.reference
        quads = np.concatenate([quads, quads[copies]])
        quads.flags.writeable = False  # as the mesh's: no kernel is compiled for another type
        self.reference = Surface(nodes, directors, quads)
        self.frequencies.reference = self.reference
        if isinstance(self._output, CentreStress):
            self._output.add_copies(self.reference, copies)

    def corner_forces(self, state: State, quads: Ints, nodes: Ints) -> Floats:
        """Return minus the internal and damping force of single quads on one of their nodes [N].

        Parameters
        ----------
        state : State
            Positions at t_{n+1}, strains of t_n, length of the step between.
        quads, nodes : ndarray of int, shape (n,)
            Quad, and one of its nodes.

        Returns
        -------
        ndarray, shape (n, 3)
        """
        force = np.empty((quads.size, 3))
        self._write_corner_forces(
            self.blocks.slot[quads],
            np.ascontiguousarray(nodes, np.int64),
            self._places.address(state),
            self._step(state),
            force,
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
            Height of the stress; ``nominal`` is the mean of the second Piola-Kirchhoff stress over
            the thickness, turned with the surface, without the change of area.

        Returns
        -------
        ndarray, shape (n, 3, 3)
            Components in space.
        """
        return self._output.cauchy(state, quads, place)

    def linear_stress(
        self,
        x: Floats,
        t: Floats,
        quads: Ints,
        displacement: Floats,
        rotation: Floats,
        which: Ints,
        place: str,
    ) -> Floats:
        """Return the Cauchy stress at the centre of some quads after a small motion [MPa].

        Parameters
        ----------
        x, t, quads, which, place
            As of :meth:`shellcut.mitc4.centre_stress.CentreStress.linear`.
        displacement, rotation : ndarray, shape (n_node, 3)
            The motion of the nodes [mm], and the spin vectors of the directors [rad].
        """
        assert isinstance(self._output, CentreStress), "statics accepts linear materials only"
        turn = np.cross(rotation, t)
        return self._output.linear(x, t, displacement, turn, quads, which, place)

    def face_stresses(self, state: State) -> FaceStresses:
        """Return membrane stresses, stresses at both faces, and thickness of all quads."""
        return self._output.faces(state)

    def history_means(self, state: State) -> dict[str, Floats]:
        """Return the history numbers of the quads by name, shape (n_quad,) each.

        Means over the thickness and the Gauss points; empty if no law has a history.
        """
        return self._output.history_means(state)

    def tangents(
        self,
        state: State,
        quads: Ints,
        bent: Floats | None = None,
        basis: Floats | None = None,
    ) -> Floats:
        """Return the tangent stiffness of some quads at the present state, shape (n, 20, 20).

        Freedoms as in :mod:`shellcut.mitc4.tangent`. For a nonlinear law it is the consistent one
        (:mod:`.film_tangents`), of a step from the history to the present positions.

        Parameters
        ----------
        state : State
            Positions and directors.
        quads : ndarray of int, shape (n,)
            Which quads.
        bent : ndarray, shape (n, 16), optional
            Part of the strains that is subtracted for the stresses in the stiffness; of linear
            films.
        basis : ndarray, shape (n_node, 2, 3), optional
            Unit tangents along which the directors turn.
        """
        present = self._places.present(state)
        area = self.area[quads]
        basis = np.empty((0, 2, 3)) if basis is None else basis
        return self._tangents.of_step(present, quads, area, state.history, state.dt, bent, basis)

    def tangent_product(
        self, state: State, displacement: Floats, turn: Floats, bent: Floats | None = None
    ) -> tuple[Floats, Floats]:
        """Return the tangent stiffness of the film times a motion, through the strains.

        Takes the motion of positions [mm] and directors, shape (n_node, 3), the latter normal to
        the directors; ``bent`` as in :meth:`tangents`. Returns nodal forces [N] and director forces
        [N·mm] of that shape.
        """
        rows = np.zeros((state.n_node, 6))
        present, motion = self._places.present(state), (displacement, turn)
        self._tangents.add_product(present, self.area, state.history, state.dt, bent, motion, rows)
        return rows[:, :3], rows[:, 3:]

    def collapsed_quad(self, state: State) -> tuple[int, float] | None:
        """Return a quad that has been folded flat and its share of area left, or None.

        Of films with a law that cannot stand it; all others are as they are.
        """
        if not self._tangents.has_frozen_law:
            return None
        present = Surface(state.node.x, state.node.t, state.quads)
        ratio, quad = smallest_area_ratio(self.reference, present)
        return (quad, ratio) if ratio < LEAST_AREA else None

    def evaluate_frequencies(self, state: State, quads: Ints) -> None:
        """Evaluate the frequencies of some quads anew, at the present positions and directors."""
        self._places.present(state)
        self.frequencies.evaluate(state.node.x, state.node.t, state.quads, quads)

    def _tangent_bounds(self, x: Floats, t: Floats, quads: Ints) -> Floats:
        """Return bounds of the tangents of some quads for the time step, shape (n, 20, 20)."""
        present = self._places.at(x, t)
        return self._tangents.bound(present, quads, self.area[quads], self._history)

    def _damped_stiffness(self, x: Floats, t: Floats, quads: Ints) -> Floats:
        """Return the stiffness of some quads that damping acts with, shape (n, 20, 20)."""
        return self._tangents.damping(self._places.at(x, t), quads)
