"""In-plane pulses run along a strip at the speeds that the borders allow.

A velocity pulse f(x) released from rest parts into two halves, ½ f(x - ct) + ½ f(x + ct), with

    c = sqrt(E / rho (1 - nu²))    sides fixed across (a plate),
    c = sqrt(E / rho)              sides free, strip narrow beside the pulse (a bar),
    c = sqrt(G / rho)              moved across, fixed along (shear).

Error in c: dispersion of the mesh, of second order in its size.
"""

import numpy as np
import pytest

from courses import UNDAMPED
from shellcut import ShellMaterial, Simulation, Support
from shellcut.mesh.structured import rectangle

E, NU, RHO = 1678.0, 0.3, 1.0e-9
LENGTH = 30.0  # mm
PULSE = 1.0  # half width of the pulse [mm], over 1/e
SPEED = {
    "plate": np.sqrt(E / (RHO * (1.0 - NU**2))),
    "bar": np.sqrt(E / RHO),
    "shear": np.sqrt(E / (2.0 * (1.0 + NU) * RHO)),
}
HELD = {"plate": "yz", "bar": "z", "shear": "xz"}


def _pulse(x):
    return np.exp(-(((x - 0.25 * LENGTH) / PULSE) ** 2))


def _measure(kind, size):
    """Return the errors of speed and of shape, relative, after a run of half the strip."""
    n_x = round(LENGTH / size)
    mesh = rectangle(LENGTH, 2.0 * size, n_x=n_x, n_y=2)
    along = 1 if kind == "shear" else 0
    # 1 mm/s beside a wave speed of 1e6 mm/s: strains of 1e-6, the linear theory.
    velocity = np.zeros((mesh.n_node, 3))
    velocity[:, along] = _pulse(mesh.nodes[:, 0])
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(young=E, poisson=NU, density=RHO),
        supports=[Support(np.arange(mesh.n_node), translation=HELD[kind])],
        velocity=velocity,
        **UNDAMPED,
    )
    sim.run(until=0.5 * LENGTH / SPEED[kind])
    time = sim.state.time + 0.5 * sim.dt  # velocities live at half steps
    middle = np.arange(n_x + 1) + (n_x + 1)
    right = middle[mesh.nodes[middle, 0] > 0.5 * LENGTH]
    x, v = mesh.nodes[right, 0], sim.state.node.velocity_half[right, along]
    centre = float((x * v**2).sum() / (v**2).sum())
    speed = (centre - 0.25 * LENGTH) / time
    shape = np.abs(v - 0.5 * _pulse(x - SPEED[kind] * time)).max() / 0.5
    return abs(speed / SPEED[kind] - 1.0), float(shape)


@pytest.mark.parametrize("kind", ["plate", "bar", "shear"])
def test_a_pulse_runs_at_the_wave_speed(kind):
    sizes = np.array([0.4, 0.2, 0.1])
    speed, shape = np.array([_measure(kind, size) for size in sizes]).T
    # Discretisation, measured at 0.4, 0.2, 0.1 mm: speed -0.7, -0.16, -0.04 % (plate), -2.4, -0.43,
    # -0.10 % (bar), -1.6, -0.38, -0.09 % (shear); shape 0.8 to 2.1 % on the finest.
    assert (np.diff(speed) < 0.0).all()
    assert (np.diff(shape) < 0.0).all()
    assert speed[-1] < 1.5e-3
    assert shape[-1] < 0.03
    # Order between the two finer meshes: measured 2.03, 2.11, 2.01.
    order = np.log2(speed[-2] / speed[-1])
    assert order == pytest.approx(2.0, abs=0.2)
