"""Central difference: kick and drift ([Frangi2010] 5.2).

Velocities live at half steps, positions and forces at whole steps:

    v_{n+1/2} = [(1 - ½ alpha Δ) v_{n-1/2} + Δ f_n / m] / (1 + ½ alpha Δ),  Δ = ½ (dt_{n-1} + dt_n)
    x_{n+1}   = x_n + dt_n v_{n+1/2}

and likewise the spin omega of the director, with the moment t x g of the director force g and the
scaled inertia. The spin lies in the tangent plane: the moment is normal to t_n, and the Cayley
rotation about omega keeps omega normal to the new director, so that there is no drilling freedom to
eliminate. With the kinetic energy taken as ½ m v_{n-1/2} · v_{n+1/2} and every work as
½ (f_{n-1} + f_n) · Δx, the energy balance of a constant step is an identity to round-off.

The first kick, from v_0 at t_0, is a half one. Mass damping (alpha) enters the balance with errors
of the order alpha dt.
"""

from __future__ import annotations

from dataclasses import dataclass

from ._jit import Bools, Floats, kernel
from ._vec3 import cross, load, rotate_director, scale, store
from .state import State


@dataclass(frozen=True)
class KickResult:
    """Energies that only the kick can see, at t_n."""

    kinetic_translation: float
    """[N·mm]"""
    kinetic_rotation: float
    """Of the scaled inertia [N·mm]."""
    mass_damping: float
    """Dissipated by alpha over the interval centred at t_n [N·mm]."""
    support_work: float
    """Work of the reactions since t_{n-1} [N·mm]."""


class CentralDifference:
    """Advance velocities and positions of all nodes.

    Parameters
    ----------
    damping_alpha : float
        Mass-proportional damping [1/s].
    """

    def __init__(self, *, damping_alpha: float) -> None:
        self.damping_alpha = damping_alpha

    def kick(self, state: State, dt_last: float, dt_next: float) -> KickResult:
        """Take velocities from t_{n-1/2} to t_{n+1/2} with the forces at t_n."""
        n = state.node
        return KickResult(
            *_kick(
                n_node=n.count,
                dt_last=dt_last,
                dt=0.5 * (dt_last + dt_next),
                alpha=self.damping_alpha,
                t=n.t,
                force=n.force,
                director_force=n.director_force,
                mass=n.mass,
                inertia=n.inertia,
                supported=n.supported,
                support=n.support,
                support_rate=n.support_rate,
                velocity=n.velocity_half,
                spin=n.spin_half,
                reaction=n.reaction,
            )
        )

    def drift(self, state: State, dt: float) -> None:
        """Take positions and directors from t_n to t_{n+1}."""
        n = state.node
        _drift(n_node=n.count, dt=dt, velocity=n.velocity_half, spin=n.spin_half, x=n.x, t=n.t)


@kernel
def _kick(
    n_node: int,
    dt_last: float,
    dt: float,
    alpha: float,
    t: Floats,
    force: Floats,
    director_force: Floats,
    mass: Floats,
    inertia: Floats,
    supported: Bools,
    support: Bools,
    support_rate: Floats,
    velocity: Floats,
    spin: Floats,
    reaction: Floats,
) -> tuple[float, float, float, float]:
    """Advance velocity and spin : (n_node, 3) by dt; write reaction : (n_node, 6)."""
    keep = (1.0 - 0.5 * alpha * dt) / (1.0 + 0.5 * alpha * dt)
    push = dt / (1.0 + 0.5 * alpha * dt)
    translation = 0.0
    rotation = 0.0
    damping = 0.0
    support_work = 0.0
    for n in range(n_node):
        m, j = mass[n], inertia[n]
        moment = cross(load(t, n), load(director_force, n))
        held = supported[n]
        kinetic = 0.0
        spun = 0.0
        mean2 = 0.0
        for c in range(3):
            before = velocity[n, c]
            after = keep * before + push * force[n, c] / m
            spin_before = spin[n, c]
            spin_after = keep * spin_before + push * moment[c] / j
            if held:
                if support[n, c]:
                    after = support_rate[n, c]
                    r = m * (after - before) / dt + alpha * m * 0.5 * (after + before) - force[n, c]
                    support_work += 0.5 * (reaction[n, c] + r) * before * dt_last
                    reaction[n, c] = r
                if support[n, 3 + c]:
                    spin_after = support_rate[n, 3 + c]
                    r = (
                        j * (spin_after - spin_before) / dt
                        + alpha * j * 0.5 * (spin_after + spin_before)
                        - moment[c]
                    )
                    support_work += 0.5 * (reaction[n, 3 + c] + r) * spin_before * dt_last
                    reaction[n, 3 + c] = r
            # The first kick starts from v_0: its v_{-1/2} is the mirror image 2 v_0 - v_{1/2}.
            kinetic += (before if dt_last > 0.0 else 2.0 * before - after) * after
            spun += (spin_before if dt_last > 0.0 else 2.0 * spin_before - spin_after) * spin_after
            mean2 += m * (before + after) ** 2 + j * (spin_before + spin_after) ** 2
            velocity[n, c] = after
            spin[n, c] = spin_after
        translation += 0.5 * m * kinetic
        rotation += 0.5 * j * spun
        damping += mean2
    return translation, rotation, 0.25 * alpha * dt * damping, support_work


@kernel
def _drift(n_node: int, dt: float, velocity: Floats, spin: Floats, x: Floats, t: Floats) -> None:
    """Advance x and t : (n_node, 3) by dt."""
    for n in range(n_node):
        for c in range(3):
            x[n, c] += dt * velocity[n, c]
        store(t, n, rotate_director(load(t, n), scale(dt, load(spin, n))))
