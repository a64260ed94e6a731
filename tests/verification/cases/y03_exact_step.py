"""Y03 The exact critical step: stable just below, unstable just above, and the driver's own bound.

Seven films start with random velocities of 1e-2 mm/s and run 600 steps at 0.95 and at 1.05 of the
exact step 2 / omega (sqrt(1 + xi²) - xi), xi = beta omega / 2, undamped and damped; omega is
:meth:`Statics.largest_frequency`. Read: growth of the largest velocity, and the driver's safe bound
over the exact step.

Bands are bounds: growth below 10 and above 1e4; the safe bound between 0.8 and 1 of the exact step
on the first five meshes. Where quads differ it lies lower (0.71 to 0.79), for information: a bound
by the worst quad alone does not know what its better neighbours take over.
"""

import numpy as np

from films import shaken
from harness import Check
from shellcut import ShellMaterial, Simulation, Statics, Stepping
from shellcut.mesh.structured import annulus, cylinder, opening_disc, rectangle
from shellcut.simulation.instability import UnstableStep

ID, TITLE, FAST = "Y03", "Exact critical step", True

MATERIAL = ShellMaterial.homogeneous()
UNEVEN = ("opening disc", "distorted")
KICK, CALM, GROWN = 1e-2, 10.0, 1e4


MESHES = {
    "squares": lambda: rectangle(3.0, 2.0, n_x=6, n_y=4),
    "slender": lambda: rectangle(3.0, 2.0, n_x=3, n_y=10),
    "cylinder": lambda: cylinder(3.0, 3.0, n_around=6, n_along=4, arc_deg=90.0),
    "strip": lambda: rectangle(6.0, 0.5, n_x=12, n_y=1),
    "ring": lambda: annulus(2.0, 4.0, n_around=24, n_radial=5),
    "opening disc": lambda: opening_disc("quick"),
    "distorted": lambda: shaken(rectangle(3.0, 2.0, n_x=6, n_y=4), 0.12),
}


def growth(mesh, beta, dt):
    """Return by how much a small random motion grows in 600 steps, at most GROWN and a step's."""
    kick = KICK * np.random.default_rng(0).standard_normal((mesh.n_node, 3))
    sim = Simulation(
        mesh,
        MATERIAL,
        damping_alpha=0.0,
        damping_beta=beta,
        stepping=Stepping(fixed=dt),
        velocity=kick,
    )
    start = largest = float(np.abs(kick).max())
    try:
        for _ in range(600):
            sim.step()
            largest = max(largest, float(np.abs(sim.state.node.velocity_half).max()))
            if largest > GROWN * start:
                break
    except UnstableStep:
        largest = GROWN * start
    return largest / start


def checks():
    for name, build in MESHES.items():
        mesh = build()
        omega = Statics(mesh, MATERIAL).largest_frequency()
        for beta in (0.0, 5e-8):
            xi = 0.5 * beta * omega
            exact = 2.0 / omega * (np.sqrt(1.0 + xi * xi) - xi)
            what = f"{name}, {'damped' if beta else 'undamped'}"
            below, above = growth(mesh, beta, 0.95 * exact), growth(mesh, beta, 1.05 * exact)
            sim = Simulation(mesh, MATERIAL, damping_alpha=0.0, damping_beta=beta)
            share = sim.time_step.bound(sim.state) / exact
            yield Check(f"growth at 0.95, {what}", 1.0, below, CALM - 1.0, "bound")
            reached = min(above, GROWN)
            yield Check(f"growth at 1.05, {what}", GROWN, reached, 1e-6, "bound")
            safe, even = f"safe / exact step, {what}", name not in UNEVEN
            yield Check(safe, 0.9, share, 0.1 + 1e-6, "bound, 0.8 to 1", even, absolute=True)
