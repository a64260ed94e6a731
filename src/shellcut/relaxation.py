"""Dynamic relaxation: the state of rest under loads and held supports, by the explicit driver.

Kinetic damping ([Cundall1976]): the film swings freely, and whenever its kinetic energy has passed
a peak all velocities are set to zero, since near a peak it passes through rest's neighbourhood.
Time stands still: loads, supports and tool are those of t_0, and no viscous damping acts.
"""

from __future__ import annotations

import numpy as np

from ._jit import Floats
from .integrator import CentralDifference
from .load import LoadSet
from .shell import MITC4Shell
from .state import State
from .time_step import StableStep

# Steps between two evaluations of the stable step; what the film stretches in between is slow.
_EVALUATE_EVERY = 200

# Share of the safe bound that is used: swings are violent at first.
_SAFETY = 0.8


class NotAtRest(RuntimeError):
    """Relaxation did not reach rest; the message says how far it came."""


def find_rest(
    state: State,
    shell: MITC4Shell,
    loads: LoadSet,
    time_step: StableStep,
    *,
    tolerance: float,
    most_steps: int,
) -> int:
    """Bring the state to rest and return the number of steps it took.

    At rest the largest nodal force that is not held is below ``tolerance`` times the largest
    reaction or load.

    Raises
    ------
    NotAtRest
        After ``most_steps``.
    """
    integrator = CentralDifference(damping_alpha=0.0)
    everything = np.arange(state.quads.shape[0])
    n = state.node
    last = 0.0
    dt = 0.0
    residual = np.inf
    for step in range(most_steps):
        loads.begin_forces(state)
        shell.add_forces(state)
        residual = _residual(state, loads.largest(state))
        if residual <= tolerance:
            break
        if step % _EVALUATE_EVERY == 0:
            shell.frequencies.evaluate(n.x, n.t, state.quads, everything)
            dt = _SAFETY * time_step.bound(state)
        kinetic = integrator.kick(state, 0.0, dt) if step == 0 else integrator.kick(state, dt, dt)
        energy = kinetic.kinetic_translation + kinetic.kinetic_rotation
        if energy < last:
            n.velocity_half[: n.count] = 0.0
            n.spin_half[: n.count] = 0.0
            energy = 0.0
        last = energy
        integrator.drift(state, dt)
    else:
        raise NotAtRest(
            f"not at rest after {most_steps} steps: the largest free nodal force is still "
            f"{residual:.3g} of the largest reaction or load, wanted {tolerance:.3g}; allow more "
            "steps, or check that the film is supported"
        )
    n.velocity_half[: n.count] = 0.0
    n.spin_half[: n.count] = 0.0
    n.load_force[: n.count] = 0.0
    n.reaction[: n.count] = 0.0
    state.strain_before[:] = state.strain
    return step


def _residual(state: State, largest_load: float) -> float:
    """Return the largest free nodal force over the largest held force or load."""
    n = state.node
    force: Floats = n.force[: n.count]
    held = n.support[: n.count, :3]
    free = np.abs(np.where(held, 0.0, force)).max(initial=0.0)
    scale = max(
        np.abs(np.where(held, force, 0.0)).max(initial=0.0),
        largest_load,
    )
    return float(free / scale) if scale > 0.0 else float(free > 0.0)
