import numpy as np
import pytest

from shellcut.imprinting.membrane_step import membrane_steps
from shellcut.material.shell_material import Elastic

FILM = Elastic(young=1678.0, poisson=0.3, density=1e-9)
SQUARE = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]])


def test_a_square_in_closed_form():
    # Largest eigenvalue of a square's plane-stress stiffness on a quarter of its mass each. The
    # uniform strain modes have 4 E / (rho s² (1 - nu)) (equal biaxial), the largest.
    for side in (0.4, 1.0):
        step = membrane_steps(side * SQUARE, np.array([[0, 1, 2, 3]]), FILM)[0]
        omega2 = 4.0 * FILM.young / (FILM.density * side**2 * (1.0 - FILM.poisson))
        assert step == pytest.approx(2.0 / np.sqrt(omega2), rel=1e-12)


def test_rigid_motion_and_scale():
    quad = np.array([[0.0, 0.0], [1.3, 0.1], [1.1, 0.9], [-0.1, 0.7]])
    ids = np.array([[0, 1, 2, 3]])
    step = membrane_steps(quad, ids, FILM)[0]
    c, s = np.cos(0.7), np.sin(0.7)
    turned = quad @ np.array([[c, s], [-s, c]]) + [3.0, -1.0]
    assert membrane_steps(turned, ids, FILM)[0] == pytest.approx(step, rel=1e-12)
    assert membrane_steps(2.0 * quad, ids, FILM)[0] == pytest.approx(2.0 * step, rel=1e-12)


def test_it_is_the_step_of_a_run():
    """Without contact, cables and damping the step of a run is this one: same quads and masses."""
    from shellcut import ShellMaterial, Simulation, Stepping
    from shellcut.mesh.structured import opening_disc

    mesh = opening_disc("quick")
    sim = Simulation(
        mesh, ShellMaterial.homogeneous(), stepping=Stepping(safety=1.0), damping_beta=0.0
    )
    sim.run(1e-7)
    ours = membrane_steps(mesh.nodes[:, :2], mesh.quads, FILM).min()
    # bending with its scaled inertia must stay below the membrane: within 1 %
    assert sim.state.dt == pytest.approx(ours, rel=0.01)
