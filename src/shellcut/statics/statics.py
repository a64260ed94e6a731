"""Statics and vibrations with the shells' own tangent: linear, load steps, arc length, modes.

docs/theory/statics.md describes the method. The parts: :mod:`shellcut.statics.tangent_solver`,
:mod:`shellcut.statics.load_path`, :mod:`shellcut.statics.vibration`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from numbers import Integral
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Ints, node_rows
from shellcut.loads.loads import Load, LoadSet
from shellcut.loads.supports import Support, SupportSet
from shellcut.loads.symmetry_plane import put_directors_into_planes
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.mitc4.initial_state import initial_state
from shellcut.mitc4.shell import MITC4Shell

from .freedoms import Freedoms, turn_directors
from .load_path import LoadPath
from .static_results import Equilibrium, Film, LinearSolution, Modes
from .tangent_solver import TangentSolver
from .vibration import largest_eigenvalue, lowest_modes


class Statics:
    """A film at rest.

    Parameters
    ----------
    mesh, material, supports, loads
        As in :class:`shellcut.Simulation`. The load factors are taken at time 1.

    Attributes
    ----------
    state : State
        Present positions and directors; solutions leave it at the last equilibrium.

    Examples
    --------
    >>> import shellcut as sc
    >>> from shellcut.mesh.structured import rectangle
    >>> film = sc.ShellMaterial.homogeneous(
    ...     young=1678.0, poisson=0.3, density=1e-9, thickness=0.074
    ... )
    >>> strip = sc.Statics(
    ...     rectangle(4.0, 2.0, size=1.0),
    ...     film,
    ...     supports=[sc.Support.clamped("left")],
    ...     loads=[sc.EdgeTraction("right", (0.1, 0.0, 0.0))],
    ... )
    >>> answer = strip.linear()
    >>> bool(answer.displacement[:, 0].max() > 0.0)
    True
    >>> pull = -answer.reaction[strip.mesh.node_set("left")].sum(axis=0)
    >>> round(float(pull[0]), 6)  # 0.1 N/mm on 2 mm
    0.2

    Raises
    ------
    ValueError
        If a set is unknown, a support moves (supports here are fixed), or the stress of a layer
        depends on the rate of strain.
    """

    @checked
    def __init__(
        self,
        mesh: Mesh,
        material: ShellMaterial,
        *,
        supports: Sequence[Support] = (),
        loads: Sequence[Load] = (),
    ) -> None:
        _refuse_motion(supports)
        if laws := material.timed_laws:
            raise ValueError(
                "statics must have layers whose stress does not depend on the rate of strain, "
                f"because statics has no time, got {', '.join(laws)}; leave out the rate factor, "
                "load a Simulation slowly, or bring it to rest by relax()"
            )
        self.mesh = mesh = put_directors_into_planes(mesh, supports)
        self.shell = MITC4Shell(mesh, material, damping_beta=0.0)
        self.state = initial_state(mesh)
        self.shell.initialise(self.state)
        SupportSet(mesh, supports).initialise(self.state)
        load_set = LoadSet(mesh, loads)
        self.state.time = 1.0
        self._freedoms = Freedoms(self.state)
        self._path = LoadPath(self.state, self.shell, self._freedoms, load_set)

    @property
    def factor(self) -> float:
        """Load factor of the last equilibrium."""
        return self._path.factor

    def move(self, displacement: Floats, rotation: Floats | None = None) -> None:
        """Move nodes from their present positions: a guess, or a prescribed boundary.

        Supported nodes then stay there; :meth:`load_steps` finds the equilibrium.

        Parameters
        ----------
        displacement : ndarray, shape (n_node, 3)
            [mm].
        rotation : ndarray, shape (n_node, 3), optional
            Spin vectors by which the directors turn [rad].
        """
        n = self.mesh.n_node
        moved = node_rows("displacement", displacement, n)
        spin = None if rotation is None else node_rows("rotation", rotation, n)
        self._path.leave()
        self.state.node.x[:n] += moved
        if spin is not None:
            turn_directors(t=self.state.node.t, spin=np.ascontiguousarray(spin))

    def linear(self) -> LinearSolution:
        """Return the linear solution about the present state.

        The residual is computed through the strains and corrected, so the solution is accurate even
        if the stiffness is ill-conditioned, as for very thin films; it includes condition and
        error.

        Raises
        ------
        NoConvergence
            If a rigid motion is not supported, or its error is above 1e-4.
        """
        self._path.begin()
        load, _, _ = self._path.forces(1.0)
        freedoms, free = self._freedoms, self._freedoms.free
        solver = TangentSolver(self.state, freedoms, self.shell)
        u = freedoms.fill(solver.solve(load[free]))
        solver.check(solver.error)
        reactions = freedoms.product(self.shell, u) - load
        largest, missed = np.abs(reactions).max(), np.abs(reactions[free]).max()
        largest = max(largest, np.abs(load).max())
        reactions[free] = 0.0
        return LinearSolution(
            *freedoms.split(u),
            *freedoms.split(reactions),
            energy=0.5 * float(load @ u),
            residual=float(missed / largest) if largest > 0.0 else 0.0,
            condition=solver.condition,
            error=solver.error,
            _film=self._film(),
        )

    def stress(self, quads: Ints | None = None, *, place: str = "mid") -> Floats:
        """Return the Cauchy stress tensors of the present state [MPa], shape (n, 3, 3).

        Parameters
        ----------
        quads : ndarray of int, shape (n,), optional
            Quad ids, all by default.
        place : {"mid", "top", "bottom", "nominal"}
            As in :meth:`shellcut.mitc4.shell.MITC4Shell.stress`.
        """
        which = np.arange(self.mesh.n_quad) if quads is None else quads
        return self.shell.stress(self.state, which, place=place)

    def load_steps(self, factors: Sequence[float]) -> list[Equilibrium]:
        """Return the equilibria at given load factors, by Newton's iteration.

        Starts from the present state and load factor. Steps that do not converge are halved, and
        so are those that end in an unstable equilibrium. Where the path itself becomes unstable a
        warning says at which load factor, and what to do; ``n_negative`` of an equilibrium tells
        how many of its motions are unstable.

        Raises
        ------
        ValueError
            If a factor is no finite number.
        NoConvergence
            If a load factor is not reached: use :meth:`arc_length`.
        """
        return self._path.load_steps(_checked_factors(factors))

    @checked
    def arc_length(
        self,
        first: Annotated[float, Option("", "change of the load factor in the first step")],
        *,
        until: Callable[[Equilibrium], bool],
        n_wanted: Annotated[int, Option("", "iterations per step", least=1)] = 5,
        longest: Annotated[float, Option("", "arc length over the first", least=1)] = 5.0,
    ) -> list[Equilibrium]:
        """Follow the load path by arc length, through limit points.

        The path starts at the equilibrium at the present load factor. Its equilibria may be
        unstable, as between two limit points: see their ``n_negative``.

        The first step is halved until it follows the path, and steps shorten where the path bends.

        Parameters
        ----------
        until : callable
            Receives each equilibrium; the path ends when it returns true, or after 200 steps: call
            again to continue.

        Raises
        ------
        ValueError
            If an argument is out of its range, or no load acts where the film can move.
        NoConvergence
            If the path is lost.
        """
        if first == 0:
            raise ValueError("first must be a number other than 0, got 0")
        return self._path.arc_length(first, until, n_wanted, longest)

    def modes(self, n: int, *, true_inertia: bool = True) -> Modes:
        """Return the ``n`` lowest free vibrations about the present state, unstable ones first.

        Parameters
        ----------
        n : int
            Number of modes, up to the number of free freedoms.
        true_inertia : bool
            Whether to use the rotary inertia rho h³/12; otherwise the explicit driver's scaled one.

        Raises
        ------
        ValueError
            If there are fewer.
        NoConvergence
            If not all of the lowest were found.
        """
        self._path.begin()
        freedoms, mass = self._freedoms, self._mass(true_inertia)
        if not (isinstance(n, Integral) and 1 <= n <= mass.size):
            raise ValueError(
                f"n must be a whole number from 1 to {mass.size}, the freedoms that the supports "
                f"leave, got {n!r}"
            )
        q2, q = lowest_modes(self.state, freedoms, self.shell, mass, int(n))
        shapes = []
        for k in range(n):
            displacement, _ = freedoms.split(freedoms.fill(q[:, k]))
            largest = np.abs(displacement).max()
            shapes.append(displacement / largest if largest > 0.0 else displacement)
        frequency = np.sign(q2) * np.sqrt(np.abs(q2)) / (2.0 * np.pi)
        return Modes(frequency, np.array(shapes))

    def largest_frequency(self) -> float:
        """Return the largest angular frequency of the explicit driver's model [rad/s].

        2 / this is the exact undamped critical step; the safe bound is in
        :mod:`shellcut.simulation.step_bound`.
        """
        self._path.begin()
        mass = self._mass(true_inertia=False)
        return float(np.sqrt(largest_eigenvalue(self._freedoms, self.shell, mass)))

    # ------------------------------------------------------------------ parts

    def _film(self) -> Film:
        n, node, quads = self.mesh.n_node, self.state.node, self.state.quads
        return Film(node.x[:n].copy(), node.t[:n].copy(), quads.copy(), self.shell)

    def _mass(self, true_inertia: bool) -> Floats:
        """Return the diagonal of the mass of the free freedoms."""
        n, node, freedoms = self.mesh.n_node, self.state.node, self._freedoms
        inertia = node.inertia[:n]
        if true_inertia:
            inertia = node.mass[:n] * self.shell.material.thickness**2 / 12.0
        return freedoms.diagonal(node.mass[:n], inertia)[freedoms.free]


def _checked_factors(factors: Sequence[float]) -> list[float]:
    try:
        values = [float(factor) for factor in factors]
    except (TypeError, ValueError):
        values = [math.nan]
    if not all(map(math.isfinite, values)):
        raise ValueError(f"factors must be a list of finite numbers, got {factors!r}")
    return values


def _refuse_motion(supports: Sequence[Support]) -> None:
    problems = [
        f"{name} of the support of {support.nodes!r} is for Simulation, statics has no time: move "
        "the nodes by Statics.move, supports then fix them there"
        for support in supports
        for name in ("velocity", "spin")
        if getattr(support, name)
    ]
    if problems:
        raise ValueError("; ".join(problems))
