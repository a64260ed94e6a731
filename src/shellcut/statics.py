"""Statics and vibrations with the shells' own tangent: linear, load steps, arc length, modes.

The residual is that of the explicit driver (loads minus internal forces), the tangent is the
derivative of the very same kernel, so equilibrium found here is equilibrium there. Dead loads are
conservative; the stiffness of following pressure is left out of the tangent, which costs
iterations, not accuracy.

Arc length: after Crisfield (1981), cylindrical: the free part of the increment and no load term
in the constraint |Δq| = Δl, the root chosen that goes on in the direction of the last increment.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy import sparse
from scipy.sparse.linalg import eigsh, splu

from ._jit import Floats
from .freedoms import Freedoms
from .load import Load, LoadSet
from .material import ShellMaterial
from .mesh import Mesh
from .shell import MITC4Shell
from .state import initial_state
from .support import Support, SupportSet

# Equilibrium is reached when the residual is this small beside the largest nodal load or reaction.
_TOLERANCE = 1e-8
_MOST_ITERATIONS = 30


class NoConvergence(RuntimeError):
    """Newton's iteration did not reach equilibrium; the message names load factor and residual."""


@dataclass(frozen=True)
class Equilibrium:
    """One point of a load path.

    Attributes
    ----------
    factor : float
        Load factor.
    displacement : ndarray, shape (n_node, 3)
        From the reference [mm].
    director : ndarray, shape (n_node, 3)
        Unit directors.
    n_iteration : int
        Iterations it took.
    """

    factor: float
    displacement: Floats
    director: Floats
    n_iteration: int


@dataclass(frozen=True)
class Modes:
    """Free vibrations.

    Attributes
    ----------
    frequency : ndarray, shape (n,)
        Ascending [Hz].
    shape : ndarray, shape (n, n_node, 3)
        Displacements, of largest component 1.
    """

    frequency: Floats
    shape: Floats


class Statics:
    """A film at rest.

    Parameters
    ----------
    mesh, material, supports, loads
        As of :class:`shellcut.Simulation`. The factors of the loads are taken at time 1.

    Attributes
    ----------
    state : State
        Present positions and directors; solutions leave it at the last equilibrium.
    """

    def __init__(
        self,
        mesh: Mesh,
        material: ShellMaterial,
        *,
        supports: Sequence[Support] = (),
        loads: Sequence[Load] = (),
    ) -> None:
        self.mesh = mesh
        self.shell = MITC4Shell(mesh, material, damping_beta=0.0)
        self.state = initial_state(mesh)
        self.shell.initialise(self.state)
        SupportSet(mesh, supports).initialise(self.state)
        self._loads = LoadSet(mesh, loads)
        self.state.time = 1.0

    def linear(self) -> tuple[Floats, Floats]:
        """Return displacement [mm] and spin vector [rad] of the linear solution about the state.

        Returns
        -------
        displacement, rotation : ndarray, shape (n_node, 3)
        """
        freedoms = Freedoms(self.state)
        load, _ = self._forces(freedoms, 1.0)
        K, Z = freedoms.stiffness(self.shell), freedoms.free
        q = _solver(Z.T @ K @ Z)(Z.T @ load)
        return freedoms.split(Z @ q)

    def load_steps(self, factors: Sequence[float]) -> list[Equilibrium]:
        """Return the equilibria at increasing load factors, by Newton's iteration.

        Raises
        ------
        NoConvergence
            If a step is not reached: take smaller ones, or :meth:`arc_length`.
        """
        path = []
        for factor in factors:
            for iteration in range(_MOST_ITERATIONS):
                freedoms = Freedoms(self.state)
                load, internal = self._forces(freedoms, factor)
                Z = freedoms.free
                residual = Z.T @ (load - internal)
                if iteration and self._small(residual, load, internal):
                    break
                K = freedoms.stiffness(self.shell)
                freedoms.move(Z @ _solver(Z.T @ K @ Z)(residual))
            else:
                raise NoConvergence(
                    f"no equilibrium at load factor {factor:.6g} after {_MOST_ITERATIONS} "
                    f"iterations, residual {np.abs(residual).max():.3g} N: take smaller load "
                    "steps or follow the path by arc length"
                )
            path.append(self._equilibrium(factor, iteration))
        return path

    def arc_length(
        self,
        first: float,
        *,
        until: Callable[[Equilibrium], bool],
        n_wanted: int = 5,
        most_steps: int = 200,
    ) -> list[Equilibrium]:
        """Follow the load path by arc length, through limit points.

        Parameters
        ----------
        first : float
            Load factor of the first step, which sets the arc length.
        until : callable
            Ends the path when true of an equilibrium.
        n_wanted : int
            Iterations a step should take; the arc length follows it.
        most_steps : int
            Steps at most.
        """
        path: list[Equilibrium] = []
        factor, length, last = 0.0, math.nan, None  # the first step sets the arc length
        while len(path) < most_steps:
            start = self.state.node.x.copy(), self.state.node.t.copy()
            for _attempt in range(8):
                try:
                    factor_new, increment, used, length = self._arc_step(
                        factor, first, length, last
                    )
                    break
                except NoConvergence:
                    self.state.node.x[:], self.state.node.t[:] = start
                    length *= 0.25
                    first *= 0.25
            else:
                raise NoConvergence(f"the path could not be followed past load factor {factor:.6g}")
            last, factor = increment, factor_new
            length *= min(2.0, math.sqrt(n_wanted / max(used, 1)))
            path.append(self._equilibrium(factor, used))
            if until(path[-1]):
                break
        return path

    def modes(self, n: int, *, true_inertia: bool = True) -> Modes:
        """Return the ``n`` lowest free vibrations about the present state.

        Parameters
        ----------
        n : int
            How many.
        true_inertia : bool
            With the rotary inertia rho h³/12; otherwise with the scaled one of the explicit driver.
        """
        freedoms, K, mass = self._vibration(true_inertia)
        q2, q = eigsh(K, k=n, M=mass, sigma=0.0, which="LM")
        order = np.argsort(q2)
        shapes = []
        for k in order:
            displacement, _ = freedoms.split(freedoms.free @ q[:, k])
            shapes.append(displacement / np.abs(displacement).max())
        frequency = np.sqrt(np.maximum(q2[order], 0.0)) / (2.0 * np.pi)
        return Modes(frequency, np.array(shapes))

    def largest_frequency(self) -> float:
        """Return the largest angular frequency of the explicit driver's model [rad/s].

        2 / this is the exact undamped critical step, beside the safe bound of
        :mod:`shellcut.time_step`.
        """
        _, K, mass = self._vibration(true_inertia=False)
        scale = sparse.diags_array(1.0 / np.sqrt(mass.diagonal()))
        largest = eigsh(scale @ K @ scale, k=1, which="LA", return_eigenvectors=False)
        return float(np.sqrt(largest[0]))

    # ------------------------------------------------------------------ parts

    def _vibration(self, true_inertia: bool) -> tuple[Freedoms, sparse.csr_array, sparse.csr_array]:
        freedoms = Freedoms(self.state)
        n, node = self.mesh.n_node, self.state.node
        inertia = node.inertia[:n]
        if true_inertia:
            inertia = node.mass[:n] * self.shell.material.thickness**2 / 12.0
        mass = sparse.diags_array(freedoms.diagonal(node.mass[:n], inertia))
        Z = freedoms.free
        return freedoms, Z.T @ freedoms.stiffness(self.shell) @ Z, sparse.csr_array(Z.T @ mass @ Z)

    def _forces(self, freedoms: Freedoms, factor: float) -> tuple[Floats, Floats]:
        """Return load times factor, and internal forces, over all freedoms."""
        n, node = self.mesh.n_node, self.state.node
        node.force[:n] = node.director_force[:n] = 0.0
        self._loads.add_forces(self.state)
        load = factor * freedoms.gather(node.force[:n], node.director_force[:n])
        node.force[:n] = node.director_force[:n] = 0.0
        self.shell.add_forces(self.state)
        return load, -freedoms.gather(node.force[:n], node.director_force[:n])

    def _small(self, residual: Floats, load: Floats, internal: Floats) -> bool:
        scale = max(np.abs(load).max(), np.abs(internal).max())
        return bool(np.abs(residual).max(initial=0.0) <= _TOLERANCE * scale)

    def _equilibrium(self, factor: float, n_iteration: int) -> Equilibrium:
        n, node = self.mesh.n_node, self.state.node
        return Equilibrium(factor, node.x[:n] - node.X[:n], node.t[:n].copy(), n_iteration)

    def _arc_step(
        self, factor: float, first: float, length: float, last: Floats | None
    ) -> tuple[float, Floats, int, float]:
        """Take one step; return load factor, increment over all freedoms, iterations, length."""
        total = np.zeros(5 * self.mesh.n_node)
        for iteration in range(_MOST_ITERATIONS):
            freedoms = Freedoms(self.state)
            Z = freedoms.free
            load, internal = self._forces(freedoms, 1.0)
            solve = _solver(Z.T @ freedoms.stiffness(self.shell) @ Z)
            tangent = Z @ solve(Z.T @ load)
            if iteration == 0:
                # Only translations measure the way: turns change their basis with the directors.
                way = _translations(tangent)
                if math.isnan(length):
                    length = abs(first) * float(np.linalg.norm(way))
                step = length / float(np.linalg.norm(way))
                forward = _translations(last) @ way if last is not None else first
                step = math.copysign(step, float(forward))
                move, gain = step * tangent, step
            else:
                residual = Z.T @ (factor * load - internal)
                if self._small(residual, factor * load, internal):
                    return factor, total, iteration, length
                correction = Z @ solve(residual)
                gain = _root(
                    _translations(total), _translations(correction), _translations(tangent), length
                )
                move = correction + gain * tangent
            freedoms.move(move)
            total = total + move
            factor += gain
        raise NoConvergence(f"arc step did not converge at load factor {factor:.6g}")


def _translations(u: Floats) -> Floats:
    return np.asarray(u.reshape(-1, 5)[:, :3].ravel())


def _root(total: Floats, correction: Floats, tangent: Floats, length: float) -> float:
    """Return dλ with |total + correction + dλ tangent| = length, on the side of the increment."""
    way = total + correction
    a, b, c = tangent @ tangent, tangent @ way, way @ way - length * length
    inside = b * b - a * c
    if inside < 0.0:
        raise NoConvergence("the arc does not meet the path")
    roots = [(-b + sign * math.sqrt(inside)) / a for sign in (1.0, -1.0)]
    return float(max(roots, key=lambda gain: total @ (way + gain * tangent)))


def _solver(K: sparse.csr_array) -> Callable[[Floats], Floats]:
    """Factorise the free stiffness.

    Raises
    ------
    NoConvergence
        If it is singular: a support is missing, or the path is at a bifurcation.
    """
    try:
        factor = splu(sparse.csc_array(K))
    except RuntimeError as error:
        raise NoConvergence(
            "the stiffness is singular: a rigid motion is not supported, or the path is at a "
            "bifurcation"
        ) from error

    def solve(rhs: Floats) -> Floats:
        return np.asarray(factor.solve(rhs))

    return solve
