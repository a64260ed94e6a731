"""Load paths: equilibria under growing loads, by Newton's iteration and by arc length.

*Newton's iteration with independent stresses.* A thin film is about 10⁴ times stiffer in stretching
than in bending. A step along the tangent moves nodes on straight lines instead of arcs, which
stretches the film at second order; Newton's iteration then linearises about these spurious stresses
and converges slowly. Treat the stresses as unknowns beside the displacements u instead, as
Magisano, Leonetti and Garcea do (2017, Int. J. Numer. Meth. Engng 109, 1237-1262): with strains
s(u), their derivative D, the section's stiffness H and the load p,

    p - Dᵀ r = 0,    s(u) - H⁻¹ r = 0.

Linearised about (u, r), with G(r) the stiffness that the stresses r bring, and dr eliminated,

    [G(r) + Dᵀ H D] du = p - Dᵀ H s(u),    r + dr = H (s(u) + D du):

This is Newton's own equation, residual included, except for the stresses in G, which follow the
*linear* change of strain of the last step. Displacements along straight lines no longer affect the
stiffness. The solution is the same and convergence to it quadratic; load steps may be ten times
larger. The same kernel computes the stiffness with these stresses: the part of the strain change
that is nonlinear in du is added to the reference products.

*Arc length* after Riks (1979) with the plane constraint: the translations of an increment, weighted
by those of its first step v, satisfy v · Δq = Δl |v|; the load factor follows. The direction
continues the last increment, so a limit point is passed like any other. docs/theory/statics.md says
how steps grow, where they are halved, and what happens where the path loses its stability.

*Equilibrium* is a residual below 1e-8 of the largest force. In a thin film, the round-off of
coordinates can cause membrane forces larger than a small load; then the residual need only be below
the round-off level, but the last correction must also be small compared with the path so far.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .freedoms import Freedoms
from .static_results import Equilibrium
from .tangent_solver import NoConvergence, TangentSolver

_log = logging.getLogger(__name__)

# At equilibrium the residual is this small relative to the largest nodal load or reaction,
_TOLERANCE = 1e-8
# or is at round-off level with the last correction this small relative to the path so far.
_SMALL_CORRECTION = 1e-6
# Accuracy of single steps of an iteration, which corrects itself.
_STEP_ACCURACY = 1e-6
_MOST_ITERATIONS = 30
# A rotation of more than this [rad] in one iteration does not recover.
_LARGEST_TURN = 3.0
# Largest number of halvings of a step before the path is abandoned.
_MOST_HALVINGS = 10
_SMALLEST_SHARE = 0.5**_MOST_HALVINGS
# Equilibria of an arc length path before the user must call again.
_MOST_STEPS = 200
# Relative difference of load factors that count as equal.
_SAME_FACTOR = 1e-12

_AFTER_STEPS = (
    "a bifurcation or a limit point lies between, and the film would buckle or snap. Its stable "
    "branch: right after it move the film by about its thickness along Statics.modes(1).shape[0] "
    "and call load_steps again, or give the mesh an imperfection of that shape; past a limit "
    "point use arc_length"
)
_AFTER_ARC = (
    "one is expected from a limit point, where the load turns, to the next, and means that the "
    "film would snap under this load. If the load has not turned there is a bifurcation: give the "
    "mesh an imperfection of the shape Statics.modes(1).shape[0]"
)

# Increments of an arc length path turn by at most this, unless these halvings do not help.
_SHARPEST_TURN = math.cos(math.radians(30.0))
_MOST_TURN_HALVINGS = 4


class _Position(NamedTuple):
    """An equilibrium, or a state that others have moved since."""

    x: Floats
    t: Floats
    history: Floats
    factor: float
    force: float
    n_negative: int
    moved: bool


class LoadPath:
    """Position of a film on its load path, and methods to follow it, which move the state."""

    def __init__(self, state: State, shell: MITC4Shell, freedoms: Freedoms, loads: LoadSet) -> None:
        self.state, self.shell, self.freedoms, self._loads = state, shell, freedoms, loads
        self.factor = 0.0
        """Load factor of the last equilibrium."""
        self.n_negative, self._moved = 0, False  # an unstressed film is stable
        """Negative eigenvalues of its stiffness, and whether others have moved the film since."""
        self._at_rest: TangentSolver | None = None  # of a linear film at its last equilibrium
        self._bent: Floats | None = None
        self._residual = self._force = self._force_before = self._floor = self._energy = 0.0
        self._unbalanced = np.zeros(5 * state.n_node)
        # History of the last equilibrium, from which every iteration starts.
        self._history = state.history.copy()

    def load_steps(self, factors: Sequence[float]) -> list[Equilibrium]:
        """Return equilibria, as :meth:`shellcut.Statics.load_steps`."""
        path = []
        for factor in factors:
            # Shares of the distance to the factor: sums of powers of ½, which are exact and end at
            # 1.
            first, done, step, used = self.factor, 0.0, 1.0, 0
            leap: tuple[float, _Position] | None = None  # a whole step that lost stability
            while done < 1.0:
                start, end = self._position(), done + step
                halve = 0.5 * step > _SMALLEST_SHARE
                try:
                    used += self._newton(factor if end == 1.0 else first + end * (factor - first))
                    halve = halve and not start.moved and start.n_negative == 0 < self.n_negative
                    leap = leap or ((end, self._position()) if halve else None)
                except NoConvergence as error:
                    self._put_back(start)
                    if not halve and leap:
                        end = leap[0]
                        self._put_back(leap[1])
                        self.forces(self.factor)
                    elif not halve:
                        raise NoConvergence(
                            f"{error}; the last equilibrium is at load factor {self.factor:.6g}: "
                            "follow the path by arc length"
                        ) from error
                if halve:
                    self._put_back(start)
                    step *= 0.5
                else:
                    self._say_change(start, _AFTER_STEPS)
                    done, step = end, min(2.0 * step, 1.0 - end)
            path.append(self._equilibrium(used))
        return path

    def arc_length(
        self,
        first: float,
        until: Callable[[Equilibrium], bool],
        n_wanted: int,
        longest: float,
    ) -> list[Equilibrium]:
        """Follow the path, as :meth:`shellcut.Statics.arc_length`."""
        start = self._position()
        self.begin()
        # From the equilibrium at the present load factor, so that increments follow the path.
        load, _, small = self.forces(self.factor)
        if not load[self.freedoms.free].any():
            raise ValueError("arc length needs a load that acts where the film is free to move")
        if not small:
            self._newton(self.factor)
        path: list[Equilibrium] = []
        length, last, bound = math.nan, None, math.inf  # the first step sets the arc length
        while len(path) < _MOST_STEPS:
            last, used, length = self._arc_step_by_halves(first, length, last)
            self._say_change(start, _AFTER_ARC)
            start = self._position()
            bound = longest * length if not path else bound
            path.append(self._equilibrium(used))
            length = min(length * min(2.0, math.sqrt(n_wanted / max(used, 1))), bound)
            if until(path[-1]):
                break
        return path

    def begin(self) -> None:
        """Start from the present state, which others may have moved, and its stresses."""
        self.freedoms.update()
        if not self.freedoms.free.size:
            raise ValueError("no freedom is left: supports fix every node and director")
        self._take_load_stiffness(self.factor)
        self._bent = None

    def leave(self) -> None:
        """Note that others move the film from its last equilibrium."""
        self._moved, self._at_rest = True, None

    def forces(self, factor: float) -> tuple[Floats, Floats, bool]:
        """Return the loads of factor 1, the residual, and whether it is practically zero."""
        n, node, freedoms = self.state.n_node, self.state.node, self.freedoms
        self._loads.begin_forces(self.state)
        load = freedoms.gather(node.force[:n], node.director_force[:n])
        node.force[:n] = node.director_force[:n] = 0.0
        self.state.history[:] = self._history
        self._energy = self.shell.add_forces(self.state).strain_energy
        internal = -freedoms.gather(node.force[:n], node.director_force[:n])
        residual = factor * load - internal
        self._unbalanced = residual
        self._residual = float(np.abs(residual[freedoms.free]).max(initial=0.0))
        # Relative to the largest force at this state or at any earlier equilibrium: a path may
        # return to zero load.
        self._force = max(self._force_before, abs(factor) * np.abs(load).max())
        self._force = max(self._force, float(np.abs(internal).max()))
        return load, residual, self._residual <= _TOLERANCE * self._force

    def _take_load_stiffness(self, factor: float) -> None:
        stiffness = self._loads.stiffness(self.state)
        self.freedoms.load_stiffness = None if stiffness is None else factor * stiffness

    def _solve(self, factor: float, *forces: Floats) -> list[Floats]:
        """Return the linear solutions for forces over all freedoms."""
        freedoms = self.freedoms
        self._take_load_stiffness(factor)
        free = freedoms.free
        self.state.history[:] = self._history
        solver = self._at_rest or TangentSolver(self.state, freedoms, self.shell, self._bent)
        size = float(np.abs(self.state.node.x).max())
        sizes = np.tile([size, size, size, 1.0, 1.0], self.state.n_node)[free]
        self._floor = solver.largest_round_off(sizes)
        return [freedoms.fill(solver.solve(force[free], _STEP_ACCURACY)) for force in forces]

    def _at_round_off(self, correction: Floats, travelled: Floats) -> bool:
        """Whether the residual is at round-off level, and corrections are small."""
        small = np.linalg.norm(correction) <= _SMALL_CORRECTION * np.linalg.norm(travelled)
        return bool(small) and self._residual <= self._floor

    def _move(self, u: Floats) -> None:
        _, spin = self.freedoms.split(u)
        largest = float(np.sqrt(np.einsum("ni,ni->n", spin, spin).max()))
        if not largest <= _LARGEST_TURN:
            raise NoConvergence(f"a director would turn by {largest:.3g} rad in one iteration")
        self._bent, self._at_rest = self.freedoms.move(u), None

    # ------------------------------------------------------------------ parts

    def _newton(self, factor: float) -> int:
        """Find the equilibrium at a load factor; return the number of iterations."""
        self.begin()
        travelled = last = np.zeros(3 * self.state.n_node)
        for iteration in range(_MOST_ITERATIONS + 1):
            _, residual, small = self.forces(factor)
            same = math.isclose(factor, self.factor, rel_tol=_SAME_FACTOR)
            if small and not iteration and same and not self._moved:
                self.factor = factor
                return 0
            if iteration and (small or self._at_round_off(last, travelled)):
                self._accept(factor)
                return iteration
            if iteration < _MOST_ITERATIONS:
                (step,) = self._solve(factor, residual)
                self._move(step)
                last = _translations(step)
                travelled = travelled + last
        raise NoConvergence(
            f"no equilibrium at load factor {factor:.6g} after {_MOST_ITERATIONS} iterations, "
            f"residual {self._residual:.3g} N"
        )

    def _accept(self, factor: float) -> None:
        """Take the present state as an equilibrium, and count its unstable motions."""
        self._take_load_stiffness(factor)
        history = self.state.history.copy()
        self.state.history[:] = self._history  # the stiffness is that of the step that led here
        solver = TangentSolver(self.state, self.freedoms, self.shell)
        self.n_negative = solver.n_negative
        self._at_rest = None if history.size else solver
        self.state.history[:] = self._history = history
        self.factor, self._force_before, self._moved = factor, self._force, False

    def _say_change(self, before: _Position, advice: str) -> None:
        """Log that the number of unstable motions has changed, and what to do."""
        was, n = before.n_negative, self.n_negative
        if n != was:
            _log.log(
                logging.WARNING if n else logging.INFO,
                "at load factor %.6g the film is unstable in %d motion(s), in %d at the "
                "equilibrium before it, load factor %.6g%s",
                *(self.factor, n, was, before.factor, f": {advice}" if n else ""),
            )

    def _arc_step_by_halves(
        self, first: float, length: float, last: Floats | None
    ) -> tuple[Floats, int, float]:
        """Take one step; halve it if it does not converge or turns too sharply."""
        start = self._position()
        for attempt in range(_MOST_HALVINGS):
            try:
                increment, tangent, used, taken = self._arc_step(first, length, last)
            except NoConvergence:
                pass
            else:
                # Compare the first one with the initial direction of the path.
                before = tangent if last is None else last
                size = float(np.linalg.norm(before) * np.linalg.norm(increment))
                turns_off = float(before @ increment) < _SHARPEST_TURN * size
                if not turns_off or (last is not None and attempt >= _MOST_TURN_HALVINGS):
                    return increment, used, taken
                length = taken
            self._put_back(start)
            length, first = 0.5 * length, 0.5 * first
        smaller = "; use a smaller first step" if last is None else ""
        raise NoConvergence(
            f"the path could not be followed past load factor {self.factor:.6g}{smaller}"
        )

    def _arc_step(
        self, first: float, length: float, last: Floats | None
    ) -> tuple[Floats, Floats, int, float]:
        """Take one step; return translations of increment and tangent, iterations, arc length."""
        self.begin()
        factor = self.factor
        total = direction = moved = np.zeros(3 * self.state.n_node)
        for iteration in range(_MOST_ITERATIONS + 1):
            load, residual, small = self.forces(factor)
            if iteration and (small or self._at_round_off(moved, total)):
                self._accept(factor)
                return total, direction, iteration, length
            correction, tangent = self._solve(factor, residual, load)
            # Only translations measure length: the basis of rotations turns with the directors.
            forward = _translations(tangent)
            if iteration == 0:
                size = float(np.linalg.norm(forward))
                length = abs(first) * size if math.isnan(length) else length
                sign = first if last is None else float(last @ forward)
                direction = forward * math.copysign(1.0 / size, sign)
            # Plane constraint: the projection of all moves so far is the arc length.
            so_far = float(direction @ (total + _translations(correction)))
            gain = (length - so_far) / float(direction @ forward)
            move = correction + gain * tangent
            self._move(move)
            moved = _translations(move)
            total, factor = total + moved, factor + gain
        raise NoConvergence(f"arc step did not converge at load factor {factor:.6g}")

    def _position(self) -> _Position:
        x, t = self.state.node.x.copy(), self.state.node.t.copy()
        before, n_negative = self._force_before, self.n_negative
        return _Position(x, t, self._history, self.factor, before, n_negative, self._moved)

    def _put_back(self, position: _Position) -> None:
        self.state.node.x[:], self.state.node.t[:], self._history = position[:3]
        self.state.history[:], self._at_rest = self._history, None
        self.factor, self._force_before, self.n_negative, self._moved = position[3:]

    def _equilibrium(self, n_iteration: int) -> Equilibrium:
        n, node, freedoms = self.state.n_node, self.state.node, self.freedoms
        reactions = -self._unbalanced
        reactions[freedoms.free] = 0.0
        reaction, moment = freedoms.split(reactions)
        return Equilibrium(
            self.factor,
            node.x[:n] - node.X[:n],
            node.t[:n].copy(),
            n_iteration,
            reaction.copy(),
            moment,
            self._energy,
            self._residual / self._force if self._force > 0.0 else 0.0,
            self.n_negative,
        )


def _translations(u: Floats) -> Floats:
    return np.asarray(u.reshape(-1, 5)[:, :3].ravel())
