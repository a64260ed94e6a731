"""Dynamic relaxation: the state of rest under loads and fixed supports, by the explicit driver.

Kinetic damping ([Cundall1976]): the film swings freely, and whenever its kinetic energy has passed
a peak all velocities are set to zero, since near a peak it passes through rest's neighbourhood.
Time stands still: loads, supports and tool are those of t_0, and no viscous damping acts.

From a stop at the whole step n the film starts as from t_0, with a *half* kick to
v_{n+1/2} = ½ dt f/m. A mode of frequency omega, at the distance u from rest, is then at
(1 - ½ (omega dt)²) u one step on, no farther than it was, for every stable step. After a whole kick
it would be at (1 - (omega dt)²) u: modes with omega dt > √2 would grow at every stop, up to
threefold, and a film that is stopped often enough would fly apart.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, node_rows
from shellcut.central_difference import CentralDifference
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.pose import Pose

from .stable_step import StableStep

# Steps between two evaluations of all quads, and between two updates of their bounds,
# which never lie below the frequencies.
_EVALUATE_EVERY = 200
_UPDATE_EVERY = 20

# Share of the safe bound that is used: swings are violent at first.
_SAFETY = 0.8


class NotAtRest(RuntimeError):
    """Relaxation did not reach rest; the message says how far it got."""


def find_rest(
    state: State,
    shell: MITC4Shell,
    loads: LoadSet,
    terms: Sequence[ForceTerm],
    time_step: StableStep,
    displacement: Floats | None,
    *,
    tolerance: float,
    most_steps: int,
    most_strain: float,
) -> int:
    """Move the nodes by a displacement, bring the state to rest and return the number of steps.

    At rest the largest unsupported nodal force is below ``tolerance`` times the largest
    reaction or load, and the largest moment on a director below that times the mean side of a quad.

    Raises
    ------
    NotAtRest
        After ``most_steps``, where they have led; or when the strain energy exceeds
        ``most_strain`` [N·mm], the film being put back to where it was: positions, directors and
        history.
    """
    n = state.node
    before = n.x[: n.count].copy(), n.t[: n.count].copy(), state.history.copy()
    if displacement is not None:
        n.x[: n.count] += node_rows("displacement", displacement, n.count)
        for term in terms:
            term.begin(state)
    n.support_rate[: n.count] = 0.0
    edge = float(np.sqrt(shell.area.mean()))
    film = _Swing(state, shell, time_step)
    film.stop()
    for step in range(most_steps):
        loads.begin_forces(state)
        strain = shell.add_forces(state).strain_energy
        for term in terms:
            term.add_forces(state, Pose.at_origin())
        if not strain <= most_strain:
            message = _flown_apart(state, shell, step, strain)
            n.x[: n.count], n.t[: n.count], state.history[:] = before
            for term in terms:
                term.begin(state)
            film.stop()
            raise NotAtRest(message)
        film.kick(step)
        residual = _residual(state, loads.largest(state), edge)
        if residual <= tolerance:
            break
        film.drift()
    film.stop()
    n.load_force[: n.count] = 0.0
    n.reaction[: n.count] = 0.0
    state.strain_before[:] = state.strain
    if not residual <= tolerance:
        raise NotAtRest(
            f"not at rest after {most_steps} steps: the largest free nodal force is still "
            f"{residual:.3g} of the largest reaction or load, wanted {tolerance:.3g}; allow more "
            "steps, or check that the film is supported"
        )
    return step


class _Swing:
    """The free swing of the film from stop to stop."""

    def __init__(self, state: State, shell: MITC4Shell, time_step: StableStep) -> None:
        self._state, self._shell, self._time_step = state, shell, time_step
        self._integrator = CentralDifference(damping_alpha=0.0)
        self._everything = np.arange(state.quads.shape[0])
        self._dt = 0.0  # of the last drift, none since a stop
        self._next = 0.0
        self._kinetic = 0.0

    def stop(self) -> None:
        self._state.node.stop()
        self._dt = 0.0

    def kick(self, step: int) -> None:
        """Advance the velocities, or stop and start anew where the kinetic energy has fallen."""
        self._update_bound(step)
        swinging = self._dt > 0.0
        kinetic = self._integrator.kick(self._state, self._dt, self._next).kinetic
        if swinging and kinetic < self._kinetic:
            kinetic = self._integrator.restart(self._state, self._next).kinetic
        self._kinetic = kinetic

    def drift(self) -> None:
        self._integrator.drift(self._state, self._next)
        self._dt = self._next

    def _update_bound(self, step: int) -> None:
        n, quads = self._state.node, self._state.quads
        if step % _EVALUATE_EVERY == 0:
            self._shell.evaluate_frequencies(self._state, self._everything)
        elif step % _UPDATE_EVERY == 0:
            self._shell.frequencies.follow(n.x, n.t, quads)
        else:
            return
        self._next = _SAFETY * self._time_step.bound(self._state)


def _residual(state: State, largest_load: float, edge: float) -> float:
    """Return the largest free force, or moment over ``edge``, over the largest reaction or load.

    The kick has just written the reactions: minus the force, of nodes at rest.
    """
    n = state.node
    force, reaction = n.force[: n.count], n.reaction[: n.count]
    moment = np.cross(n.t[: n.count], n.director_force[: n.count]) + reaction[:, 3:]
    free = max(_largest(force + reaction[:, :3]), _largest(moment) / edge)
    scale = max(_largest(reaction[:, :3]), largest_load)
    return float(free / scale) if scale > 0.0 else float(free > 0.0)


def _largest(rows: Floats) -> float:
    return float(np.abs(rows).max(initial=0.0))


def _flown_apart(state: State, shell: MITC4Shell, step: int, strain: float) -> str:
    quad = state.most_strained_quad()
    x, y, z = state.node.X[state.quads[quad]].mean(axis=0)
    cause = (
        "the prescribed displacement strains the film beyond all measure"
        if step == 0
        else "the loads are far too large for the film, or something in it is not supported"
    )
    return (
        f"the film flew apart after {step} steps of relaxation: strain energy {strain:.3g} N·mm, "
        f"most strained is quad {quad} at ({x:.4g}, {y:.4g}, {z:.4g}) mm; {cause}: check their "
        "units (mm, N, MPa). The nodes are where they were before"
    )
