"""A clamped disc under a pressure step: peak of the centre, free flight before it, energy.

R = 10.2 mm, h = 0.074 mm, E = 1678 MPa, nu = 0.3, density 1e-9 t/mm³, dead pressure 0.05 MPa from
t = 0 on, no damping. Other programs find the peak of the central deflection at 2.148 mm, 78.0 us
(OpenRadioss, QBAT and QEPH) and 2.146 mm, 78 us (OpenSees ASDShellQ4) on another butterfly mesh of
2,652 quads.
"""

from functools import cache

import numpy as np
import pytest

from shellcut.loads.loads import Pressure
from shellcut.loads.supports import Support
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.structured import disc
from shellcut.simulation.simulation import Simulation

PRESSURE = 0.05  # MPa
SURFACE_DENSITY = 1.0e-9 * 0.074  # t/mm²
COARSE, MEDIUM, FINE = (16, 5), (24, 8), (34, 11)  # n_side and n_layer: 576, 1,344, 2,652 quads


@cache
def _run(n_side: int, n_layer: int) -> dict[str, np.ndarray]:
    mesh = disc(10.2, n_side=n_side, n_layer=n_layer)
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        supports=[Support.clamped("rim")],
        loads=[Pressure(PRESSURE)],
        damping_alpha=0.0,
        damping_beta=0.0,
    )
    centre = mesh.node_set("centre")
    rows = []
    while sim.state.time < 0.9e-4:
        sim.step()
        z = float(sim.state.node.x[centre, 2].mean())
        rows.append((sim.state.time, z, sim.ledger.load_work, sim.ledger.imbalance))
    names = ("time", "centre", "load_work", "imbalance")
    return dict(zip(names, np.array(rows).T, strict=True))


def _peak(run: dict[str, np.ndarray]) -> tuple[float, float]:
    """Return time and height of the peak, by a parabola through seven steps (below 1e-4)."""
    k = int(run["centre"].argmax())
    near = slice(k - 3, k + 4)
    c2, c1, c0 = np.polyfit(run["time"][near] - run["time"][k], run["centre"][near], 2)
    return float(run["time"][k] - 0.5 * c1 / c2), float(c0 - 0.25 * c1 * c1 / c2)


def test_the_peak_is_that_of_other_programs() -> None:
    time, height = _peak(_run(*FINE))
    # Literature band, for a mesh of the same fineness, not the same mesh: measured 2.136 mm
    # (-0.6 %) at 77.7 us (-0.4 %).
    assert height == pytest.approx(2.148, rel=0.01)
    assert time == pytest.approx(78.0e-6, rel=0.015)


def test_free_flight_is_exact_until_the_rim_is_felt() -> None:
    # The sheet is flat inside until the wave from the rim comes, one ring of quads a step, and
    # pressure and mass are lumped alike: x = ½ (p / rho h) t² for the central difference too.
    run = _run(*FINE)
    flight = 0.5 * PRESSURE / SURFACE_DENSITY * run["time"] ** 2
    rings = FINE[1] + FINE[0] // 2
    # Round-off of some thirty sums, relative: measured 1e-15.
    assert np.allclose(run["centre"][:rings], flight[:rings], rtol=1e-12, atol=0.0)
    # Later the tension arrives, but nothing yet bends the middle. Discretisation: measured 1e-6
    # at 23 us, of 4.7 us that the fastest wave takes to the middle and back twice.
    early = run["time"] < 20e-6
    assert np.allclose(run["centre"][early], flight[early], rtol=1e-5, atol=0.0)
    # It does not stay so: after the peak the membrane has turned the middle back.
    late = run["time"] > 85e-6
    assert (run["centre"][late] < 0.8 * flight[late]).all()


def test_energy_is_balanced() -> None:
    # Discretisation in time: the strain energy is a function of state, its work a sum by the
    # trapezoidal rule. Measured 5e-5 of the work at the largest, at the stable step.
    run = _run(*FINE)
    assert np.abs(run["imbalance"]).max() < 2e-4 * run["load_work"].max()


def test_meshes_converge_to_one_value() -> None:
    # The focus of the waves in the middle is what needs a fine mesh. Reference: 5,376 quads give
    # 2.1317 mm at 77.30 us, 2,652 quads with a quarter of the rotary inertia 2.1313 at 77.28.
    peaks = [_peak(_run(*mesh)) for mesh in (COARSE, MEDIUM, FINE)]
    height = np.array([abs(h / 2.1315 - 1.0) for _, h in peaks])
    time = np.array([abs(t / 77.29e-6 - 1.0) for t, _ in peaks])
    # Discretisation: errors sorted, the last below 0.5 and 1 % (measured 4.7, 0.4, 0.2 % and
    # 3.7, 2.6, 0.5 %).
    assert (np.diff(height) < 0.0).all()
    assert (np.diff(time) < 0.0).all()
    assert height[-1] < 0.005
    assert time[-1] < 0.01


def test_the_volume_is_converged_on_every_mesh() -> None:
    # The largest swept volume, work over pressure, needs no fine mesh. Discretisation: measured
    # 245.56, 245.39, 245.60 mm³; 245.59 on 5,376 quads.
    for mesh in (COARSE, MEDIUM, FINE):
        assert _run(*mesh)["load_work"].max() / PRESSURE == pytest.approx(245.59, rel=0.002)
