"""Statics and vibrations with the shells' own tangent: linear, load steps, arc length, modes.

The residual is that of the explicit driver (loads minus internal forces), the tangent is the
derivative of the very same kernel, so equilibrium found here is equilibrium there. Dead loads are
conservative; the stiffness of following pressure and of dead moments is left out of the tangent,
which costs iterations, not accuracy.

*Newton's iteration with stresses of their own.* A thin film stretches with some 10⁴ times the
stiffness it bends with. A step along the tangent moves nodes on straight lines instead of arcs,
which stretches the film at second order; Newton's iteration then linearises about these spurious
stresses and creeps. Take instead stresses as unknowns beside the displacements u, as Magisano,
Leonetti and Garcea do (2017, Int. J. Numer. Meth. Engng 109, 1237-1262): with strains s(u), their
derivative D, the section's stiffness H and the load p,

    p - Dᵀ r = 0,    s(u) - H⁻¹ r = 0.

Linearised about (u, r), with G(r) the stiffness that the stresses r bring, and dr eliminated,

    [G(r) + Dᵀ H D] du = p - Dᵀ H s(u),    r + dr = H (s(u) + D du):

Newton's own equation, residual included, but for the stresses in G, which follow the *linear*
change of strain of the last step. Displacements along straight lines no longer enter the
stiffness. The point that is found is the same, convergence there quadratic; load steps may be
larger by an order of magnitude. The stiffness with these stresses is taken by the same kernel, the
part of the strain change that is not linear in du added to the reference products.

*Arc length* after Riks (1979) with the plane constraint: the translations of an increment, weighed
by those of its first step v, keep v · Δq = Δl |v|; the load factor follows. The direction is the
one that goes on from the last increment, so a limit point is passed as any other.

A step that does not converge is taken again by halves, from the last equilibrium.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
import scipy

from ._jit import Floats
from .freedoms import Freedoms, turn_directors
from .load import Load, LoadSet
from .material import ShellMaterial
from .mesh import Mesh
from .shell import MITC4Shell
from .state import initial_state
from .support import Support, SupportSet

# Equilibrium is reached when the residual is this small beside the largest nodal load or reaction,
_TOLERANCE = 1e-8
# or no larger than what the stiffness makes of last digits that are off: a thin film's membrane
# answers the round-off of coordinates with more than 1e-8 of a small load.
_LAST_DIGIT = float(np.finfo(float).eps)
_MOST_ITERATIONS = 30
# A turn of more than this [rad] in one iteration does not come back.
_LARGEST_TURN = 3.0
# A step is halved so often before the path is given up.
_MOST_HALVINGS = 10


# Of a force, the part that may be lost in the last digits of what the stiffness sums to it; of
# films of slenderness 1e4 it is 1e-6, at a singular stiffness one.
_LOST = 1e-2
_SINGULAR = (
    "the stiffness is singular: a rigid motion is not supported, or the path is at a bifurcation"
)


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
        Iterations it took, those of intermediate steps included.
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
    factor : float
        Load factor of the present state.

    Examples
    --------
    >>> import shellcut as sc
    >>> from shellcut.meshing import rectangle
    >>> film = sc.ShellMaterial.homogeneous(
    ...     young=1678.0, poisson=0.3, density=1e-9, thickness=0.074
    ... )
    >>> strip = sc.Statics(
    ...     rectangle(4.0, 2.0, size=1.0),
    ...     film,
    ...     supports=[sc.Support.clamped("left")],
    ...     loads=[sc.EdgeTraction("right", (0.1, 0.0, 0.0))],
    ... )
    >>> displacement, rotation = strip.linear()
    >>> bool(displacement[:, 0].max() > 0.0)
    True
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
        self.factor = 0.0
        self._freedoms = Freedoms(self.state)
        self._bent: Floats | None = None
        self._residual = self._force = self._force_before = self._floor = 0.0

    def move(self, displacement: Floats, rotation: Floats | None = None) -> None:
        """Move nodes from where they are: a guess, a stretched rim, a prescribed boundary.

        Supported nodes stay where they are put; :meth:`load_steps` then finds the equilibrium.

        Parameters
        ----------
        displacement : ndarray, shape (n_node, 3)
            [mm].
        rotation : ndarray, shape (n_node, 3), optional
            Spin vectors by which the directors turn [rad].
        """
        n = self.mesh.n_node
        for name, value in (("displacement", displacement), ("rotation", rotation)):
            if value is not None and (
                np.shape(value) != (n, 3) or not np.isfinite(np.asarray(value)).all()
            ):
                raise ValueError(
                    f"{name} must be finite and of shape ({n}, 3), got {np.shape(value)}"
                )
        self.state.node.x[:n] += displacement
        if rotation is not None:
            turn_directors(t=self.state.node.t, spin=np.ascontiguousarray(rotation, float))
        self._bent = None

    def linear(self) -> tuple[Floats, Floats]:
        """Return displacement [mm] and spin vector [rad] of the linear solution about the state.

        Returns
        -------
        displacement, rotation : ndarray, shape (n_node, 3)
        """
        self._begin()
        load, _, _ = self._forces(1.0)
        return self._freedoms.split(self._solve(load)[0])

    def load_steps(self, factors: Sequence[float]) -> list[Equilibrium]:
        """Return the equilibria at given load factors, by Newton's iteration.

        Starts from the present state and load factor. Steps that do not converge are halved.

        Raises
        ------
        NoConvergence
            If a load factor is not reached: use :meth:`arc_length`.
        """
        path = []
        for factor in factors:
            step, used = factor - self.factor, 0
            smallest = abs(step) * 0.5**_MOST_HALVINGS
            done = False
            while not done:
                done = abs(step) >= abs(factor - self.factor)
                start = self._position()
                try:
                    used += self._newton(factor if done else self.factor + step)
                except NoConvergence as error:
                    self._put_back(start)
                    step, done = 0.5 * step, False
                    if abs(step) <= smallest:
                        raise NoConvergence(
                            f"{error}; the last equilibrium is at load factor {self.factor:.6g}: "
                            "follow the path by arc length"
                        ) from error
            path.append(self._equilibrium(used))
        return path

    def arc_length(
        self,
        first: float,
        *,
        until: Callable[[Equilibrium], bool],
        n_wanted: int = 5,
        most_steps: int = 200,
    ) -> list[Equilibrium]:
        """Follow the load path by arc length, through limit points, from the present state.

        Parameters
        ----------
        first : float
            Change of the load factor in the first step, which sets the arc length.
        until : callable
            Ends the path when true of an equilibrium.
        n_wanted : int
            Iterations a step should take; the arc length follows it.
        most_steps : int
            Steps at most.

        Raises
        ------
        NoConvergence
            If the path is lost.
        """
        path: list[Equilibrium] = []
        length, last = math.nan, None  # the first step sets the arc length
        while len(path) < most_steps:
            start = self._position()
            for _attempt in range(_MOST_HALVINGS):
                try:
                    increment, used, length = self._arc_step(first, length, last)
                    break
                except NoConvergence:
                    self._put_back(start)
                    length, first = 0.5 * length, 0.5 * first
            else:
                raise NoConvergence(
                    f"the path could not be followed past load factor {self.factor:.6g}"
                )
            last = increment
            length *= min(2.0, math.sqrt(n_wanted / max(used, 1)))
            path.append(self._equilibrium(used))
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
        K, mass = self._vibration(true_inertia)
        q2, q = scipy.sparse.linalg.eigsh(
            K,
            k=n,
            M=scipy.sparse.csc_array(scipy.sparse.diags_array(mass)),
            sigma=0.0,
            which="LM",
            OPinv=scipy.sparse.linalg.LinearOperator(K.shape, matvec=_solver(K)),
        )
        order = np.argsort(q2)
        shapes = []
        for k in order:
            displacement, _ = self._freedoms.split(self._freedoms.fill(q[:, k]))
            shapes.append(displacement / np.abs(displacement).max())
        frequency = np.sqrt(np.maximum(q2[order], 0.0)) / (2.0 * np.pi)
        return Modes(frequency, np.array(shapes))

    def largest_frequency(self) -> float:
        """Return the largest angular frequency of the explicit driver's model [rad/s].

        2 / this is the exact undamped critical step, beside the safe bound of
        :mod:`shellcut.time_step`.
        """
        K, mass = self._vibration(true_inertia=False)
        scale = scipy.sparse.diags_array(1.0 / np.sqrt(mass))
        largest = scipy.sparse.linalg.eigsh(
            scale @ K @ scale, k=1, which="LA", return_eigenvectors=False
        )
        return float(np.sqrt(largest[0]))

    # ------------------------------------------------------------------ parts

    def _vibration(self, true_inertia: bool) -> tuple[scipy.sparse.csc_array, Floats]:
        """Return stiffness and diagonal of the mass of the free freedoms."""
        self._begin()
        n, node, freedoms = self.mesh.n_node, self.state.node, self._freedoms
        inertia = node.inertia[:n]
        if true_inertia:
            inertia = node.mass[:n] * self.shell.material.thickness**2 / 12.0
        mass = freedoms.diagonal(node.mass[:n], inertia)[freedoms.free]
        return freedoms.restrict(freedoms.stiffness(self.shell)), mass

    def _begin(self) -> None:
        """Start from the present state, which others may have moved, and its own stresses."""
        self._freedoms.update()
        self._bent = None

    def _forces(self, factor: float) -> tuple[Floats, Floats, bool]:
        """Return the loads of factor 1, the residual, and whether it is as good as zero."""
        n, node, freedoms = self.mesh.n_node, self.state.node, self._freedoms
        self._loads.begin_forces(self.state)
        load = freedoms.gather(node.force[:n], node.director_force[:n])
        node.force[:n] = node.director_force[:n] = 0.0
        self.shell.add_forces(self.state)
        internal = -freedoms.gather(node.force[:n], node.director_force[:n])
        residual = factor * load - internal
        self._residual = float(np.abs(residual[freedoms.free]).max(initial=0.0))
        # Beside the largest force at this state or at any equilibrium before: a path may come back
        # to no load.
        self._force = max(self._force_before, abs(factor) * np.abs(load).max())
        self._force = max(self._force, float(np.abs(internal).max()))
        return load, residual, self._residual <= max(_TOLERANCE * self._force, self._floor)

    def _solve(self, *forces: Floats) -> list[Floats]:
        """Return the linear answers to forces over all freedoms."""
        freedoms = self._freedoms
        free = freedoms.free
        K = freedoms.restrict(freedoms.stiffness(self.shell, self._bent))
        size = float(np.abs(self.state.node.x).max())
        sizes = np.tile([size, size, size, 1.0, 1.0], self.mesh.n_node)[free]
        sum_up, solve = abs(K), _solver(K)
        self._floor = _LAST_DIGIT * float((sum_up @ sizes).max(initial=0.0))
        answers = []
        for force in forces:
            q = solve(force[free])
            lost = _LAST_DIGIT * float((sum_up @ np.abs(q)).max(initial=0.0))
            if not lost <= _LOST * float(np.abs(force[free]).max(initial=0.0)):
                raise NoConvergence(_SINGULAR)
            answers.append(freedoms.fill(q))
        return answers

    def _move(self, u: Floats) -> None:
        _, spin = self._freedoms.split(u)
        largest = float(np.sqrt(np.einsum("ni,ni->n", spin, spin).max()))
        if not largest <= _LARGEST_TURN:
            raise NoConvergence(f"a director would turn by {largest:.3g} rad in one iteration")
        self._bent = self._freedoms.move(u)

    def _newton(self, factor: float) -> int:
        """Go to the equilibrium at a load factor; return the iterations it took."""
        self._begin()
        for iteration in range(_MOST_ITERATIONS + 1):
            _, residual, small = self._forces(factor)
            if small and iteration:
                self.factor, self._force_before = factor, self._force
                return iteration
            if iteration < _MOST_ITERATIONS:
                self._move(self._solve(residual)[0])
        raise NoConvergence(
            f"no equilibrium at load factor {factor:.6g} after {_MOST_ITERATIONS} iterations, "
            f"residual {self._residual:.3g} N"
        )

    def _arc_step(
        self, first: float, length: float, last: Floats | None
    ) -> tuple[Floats, int, float]:
        """Take one step; return the translations of the increment, iterations, arc length."""
        self._begin()
        factor = self.factor
        total = way = np.zeros(3 * self.mesh.n_node)
        for iteration in range(_MOST_ITERATIONS + 1):
            load, residual, small = self._forces(factor)
            if small and iteration:
                self.factor, self._force_before = factor, self._force
                return total, iteration, length
            correction, tangent = self._solve(residual, load)
            # Only translations measure the way: turns change their basis with the directors.
            forward = _translations(tangent)
            if iteration == 0:
                size = float(np.linalg.norm(forward))
                length = abs(first) * size if math.isnan(length) else length
                sign = first if last is None else float(last @ forward)
                way = forward * math.copysign(1.0 / size, sign)
            # The plane: the way's part of all moves so far is the arc length.
            so_far = float(way @ (total + _translations(correction)))
            gain = (length - so_far) / float(way @ forward)
            move = correction + gain * tangent
            self._move(move)
            total, factor = total + _translations(move), factor + gain
        raise NoConvergence(f"arc step did not converge at load factor {factor:.6g}")

    def _position(self) -> tuple[Floats, Floats]:
        return self.state.node.x.copy(), self.state.node.t.copy()

    def _put_back(self, position: tuple[Floats, Floats]) -> None:
        self.state.node.x[:], self.state.node.t[:] = position

    def _equilibrium(self, n_iteration: int) -> Equilibrium:
        n, node = self.mesh.n_node, self.state.node
        return Equilibrium(self.factor, node.x[:n] - node.X[:n], node.t[:n].copy(), n_iteration)


def _translations(u: Floats) -> Floats:
    return np.asarray(u.reshape(-1, 5)[:, :3].ravel())


def _solver(K: scipy.sparse.csc_array) -> Callable[[Floats], Floats]:
    """Factorise the free stiffness.

    Raises
    ------
    NoConvergence
        If it is singular: a support is missing, or the path is at a bifurcation.
    """
    try:
        # The order is that of the free freedoms, the pivots are those of the diagonal if they can.
        factor = scipy.sparse.linalg.splu(
            K,
            permc_spec="NATURAL",
            diag_pivot_thresh=0.01,
            relax=20,
            options={"SymmetricMode": True},
        )
    except RuntimeError as error:
        raise NoConvergence(_SINGULAR) from error

    def solve(rhs: Floats) -> Floats:
        return np.asarray(factor.solve(rhs))

    return solve
