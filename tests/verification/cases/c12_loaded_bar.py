"""C12 Bar loaded suddenly at its end: waves in one dimension, by the explicit driver.

A strip of shells, nu = 0, length L, fixed at one end; at the other the stress sigma0 acts from
t = 0 on. Read: displacement of that end, arrival of the front at the middle, and the critical step.

Source: d'Alembert. The displacement of the end is a triangle in time: 0 to 2 sigma0 L / E at t = 2
L / c and back, with c = sqrt(E / rho). On equal quads of length s with lumped mass the fastest
membrane mode of a chain that is fixed at one end has omega = (2 c / s) cos(pi / 4 n), hence the
critical step s / c. All nodes are fixed in y, z and rotation: otherwise a strip one quad wide rocks
faster, omega² = 12 k G / (rho s²), by transverse shear against the scaled inertia; its step is
printed for information.

Bands: kind mesh. Behind a front of n quads the central difference rings over n^(1/3) of them
(Airy): the front is smeared by (s / L) n^(1/3) of the length.
"""

import numpy as np

from cases.paths import curve
from harness import Check
from shellcut import EdgeTraction, Mesh, ShellMaterial, Simulation, Statics, Support
from shellcut.mesh.structured import rectangle

ID, TITLE, FAST = "C12", "Suddenly loaded bar", True

LENGTH, N = 100.0, 100
YOUNG, DENSITY, THICKNESS = 1000.0, 1e-9, 1.0
STRESS = 1e-4 * YOUNG  # strains of 1e-4: the linear theory to as much
MATERIAL = ShellMaterial.homogeneous(young=YOUNG, poisson=0.0, density=DENSITY, thickness=THICKNESS)
SPEED = np.sqrt(YOUNG / DENSITY)

CURVES = {}
AXES = "t c / L", "displacement of the end over 2 σ₀ L / E"


def bar() -> tuple[Mesh, dict]:
    mesh = rectangle(LENGTH, LENGTH / N, n_x=N, n_y=1)
    options = {
        "supports": [Support.clamped("left"), Support(np.arange(mesh.n_node), translation="yz")],
        "loads": [EdgeTraction("right", (STRESS * THICKNESS, 0.0, 0.0))],
    }
    return mesh, options


def triangle(time: np.ndarray) -> np.ndarray:
    """Return the displacement of the end over 2 sigma0 L / E."""
    return 1.0 - np.abs(1.0 - (time * SPEED / (2.0 * LENGTH)) % 2.0)


def swing() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return times, displacement of the end over 2 sigma0 L / E, velocity at L / 2."""
    mesh, options = bar()
    sim = Simulation(mesh, MATERIAL, **options, damping_alpha=0.0, damping_beta=0.0)
    end, middle = mesh.node_set("right"), mesh.nodes_where(lambda x, y, z: x == LENGTH / 2)
    rows = []
    while sim.state.time < 4.0 * LENGTH / SPEED:
        sim.step()
        node = sim.state.node
        tip = (node.x[end, 0] - node.X[end, 0]).mean()
        rows.append((sim.state.time, tip, node.velocity_half[middle, 0].mean(), sim.state.dt))
    time, tip, velocity, _ = np.array(rows).T
    return time, tip * YOUNG / (2.0 * STRESS * LENGTH), velocity


def checks() -> list[Check]:
    time, tip, velocity = swing()
    exact = triangle(time)
    CURVES["loaded end"] = curve(time * SPEED / LENGTH, tip, [0.0, 2.0, 4.0], [0.0, 1.0, 0.0])
    smear = N ** (1.0 / 3.0) / N
    # Front: the velocity sigma0 / rho c comes to the middle after L / 2 c; half of it passes then.
    half = 0.5 * STRESS / (DENSITY * SPEED)
    k = int(np.argmax(velocity > half))
    part = (half - velocity[k - 1]) / (velocity[k] - velocity[k - 1])
    dt = time[1] - time[0]
    arrival = time[k - 1] + dt * (part + 0.5)  # velocities are those of half steps
    mesh, options = bar()
    omega = Statics(mesh, MATERIAL, **options).largest_frequency()
    options["supports"] = options["supports"][:1]
    free = 2.0 / Statics(mesh, MATERIAL, **options).largest_frequency() * SPEED * N / LENGTH
    exact_omega = 2.0 * SPEED * N / LENGTH * np.cos(np.pi / (4 * N))
    off = float(np.abs(tip - exact).max())
    return [
        Check("largest displacement / (2 sigma0 L / E)", 1.0, tip.max(), smear, "mesh, front"),
        Check("its time, c / L", 2.0, time[tip.argmax()] * SPEED / LENGTH, smear, "mesh, front"),
        Check("largest departure from the triangle", 0.0, off, smear, "mesh, front", absolute=True),
        Check("front speed to L / 2, over c", 1.0, 0.5 * LENGTH / arrival / SPEED, smear, "mesh"),
        Check(
            "critical step, s / c", 1.0, 2.0 / omega * SPEED * N / LENGTH, 1e-4, "end of the chain"
        ),
        Check("largest frequency, chain of n", exact_omega, omega, 1e-6, "round-off"),
        Check(
            "critical step, bending free, s / c",
            1.0,
            free,
            1e-4,
            "rocking of the strip",
            gate=False,
        ),
    ]
