"""Y01 Free vibration by the explicit driver against the mode of the tangent.

Films in three states (a clamped plate, a cylindrical roof, a membrane stretched by 1 %) start with
the velocity of a mode, of an amplitude of 1e-4 of the thickness. Read: the frequency, by the best
sine through some twenty periods of the film's part along the mode.

Reference: :meth:`Statics.modes` with the driver's own inertia; the central difference shortens the
period, sin(omega_n dt / 2) = omega dt / 2, which is included. Band: kind fit, 1e-5: what is left of
other modes, started because the spins are not, averages out over the periods.
"""

from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

from cases.paths import curve
from courses import UNDAMPED, recorded
from harness import Check
from shellcut import ShellMaterial, Simulation, Statics, Stepping, Support
from shellcut.mesh.structured import cylinder, disc, rectangle

ID, TITLE, FAST = "Y01", "Free vibration against the modes", True

MATERIAL = ShellMaterial.homogeneous(thickness=0.5)
PERIODS = 20
STRETCH = 1.01

SIDES = [Support.clamped(side) for side in ("left", "right", "top", "bottom")]
ENDS = [Support("top", "xz", "y"), Support("bottom", "xyz", "y")]
FILMS = {  # mesh, supports, the stretch in x and y
    "clamped plate": (partial(rectangle, 12.0, 10.0, n_x=12, n_y=10), SIDES, 1.0),
    "roof": (partial(cylinder, 10.0, 12.0, n_around=10, n_along=10, arc_deg=80.0), ENDS, 1.0),
    "stretched disc": (partial(disc, 10.0, n_side=8), [Support.pinned("rim")], STRETCH),
}

CURVES = {}
AXES = "time, s", "displacement along the mode, over its amplitude"


def best_frequency(time, value, guess):
    """Return the angular frequency of the sine nearest to the values."""

    def misfit(omega):
        waves = np.stack([np.cos(omega * time), np.sin(omega * time)], axis=1)
        return float(np.linalg.lstsq(waves, value, rcond=None)[1][0])

    width = 0.5 / PERIODS
    scan = guess * np.linspace(1.0 - width, 1.0 + width, 41)
    best = scan[np.argmin([misfit(omega) for omega in scan])]
    step = scan[1] - scan[0]
    found = minimize_scalar(
        misfit, bounds=(best - step, best + step), method="bounded", options={"xatol": 1e-9 * guess}
    )
    return float(found.x)


def frequencies(name, number):
    """Return the driver's exact angular frequency of a mode, and the measured one."""
    build, supports, stretch = FILMS[name]
    mesh = build()
    body = Statics(mesh, MATERIAL, supports=supports)
    body.state.node.x[: mesh.n_node, :2] *= stretch
    modes = body.modes(number + 1, true_inertia=False)
    omega, shape = 2.0 * np.pi * modes.frequency[number], modes.shape[number]
    dt = 0.9 * 2.0 / body.largest_frequency()
    fixed = Stepping(fixed=dt)
    sim = Simulation(mesh, MATERIAL, supports=supports, stepping=fixed, **UNDAMPED)
    if stretch != 1.0:
        sim.relax((stretch - 1.0) * mesh.nodes)
    n, node, size = mesh.n_node, sim.state.node, 1e-4 * MATERIAL.thickness
    start = node.x[:n].copy()
    node.velocity_half[:n] = size * omega * shape
    weight = node.mass[:n, None] * shape / size / (node.mass[:n, None] * shape**2).sum()

    def read(sim):
        return sim.state.time, (weight * (node.x[:n] - start)).sum()

    time, value = recorded(sim, PERIODS * 2.0 * np.pi / omega, read)
    exact = 2.0 / dt * np.arcsin(0.5 * omega * dt)
    if number == 0:
        first = time < 3.0 * 2.0 * np.pi / omega
        CURVES[f"{name}, first three periods"] = curve(
            time[first], value[first], time[first], np.sin(exact * time[first])
        )
    return exact, best_frequency(time, value, exact)


def checks():
    for name in FILMS:
        for number in (0, 2):
            exact, ours = frequencies(name, number)
            yield Check(f"omega, {name}, mode {number + 1}, 1/s", exact, ours, 1e-5, "fit")
