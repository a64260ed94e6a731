"""Dynamic relaxation: rest under load agrees with statics, pretension, refusals."""

import numpy as np
import pytest

from shellcut import Pressure, ShellMaterial, Simulation, Statics, Support
from shellcut.meshing import disc
from shellcut.relaxation import NotAtRest

MESH = disc(5.0, n_side=6, n_layer=2)
FILM = ShellMaterial.homogeneous()
CENTRE = MESH.node_set("centre")


def film(*loads):
    return Simulation(MESH, FILM, supports=[Support.clamped("rim")], loads=loads)


def test_rest_under_pressure_is_the_static_equilibrium():
    sim = film(Pressure(0.01))
    assert sim.relax(tolerance=1e-6) > 10
    still = Statics(MESH, FILM, supports=[Support.clamped("rim")], loads=[Pressure(0.01)])
    (rest,) = still.load_steps([1.0])
    # The residual is 1e-6 of the reactions; the film is soft where it is nearly flat.
    np.testing.assert_allclose(sim.state.node.x[CENTRE, 2], rest.displacement[CENTRE, 2], rtol=1e-3)
    # Rest stays rest: time and ledger start afresh, the strain energy is the initial energy.
    assert sim.state.time == 0.0
    assert sim.ledger.initial == pytest.approx(sim.ledger.strain, rel=1e-9)
    sim.run(until=2e-5)
    assert sim.ledger.kinetic < 1e-5 * sim.ledger.strain
    assert abs(sim.ledger.imbalance) < 1e-8 * sim.ledger.strain


def test_a_stretched_film_has_the_closed_form_stress_and_a_shorter_step():
    sim, stretch = film(), 2e-2
    loose = sim.dt
    sim.relax(stretch * MESH.nodes)
    # Equibiaxial: E = s + s²/2, S = E_young/(1 - nu) E; Cauchy = S at unchanged thickness, since
    # F = 1 + s twice and J = (1 + s)².
    strain = stretch + 0.5 * stretch**2
    stress = sim.shell.stress(sim.state, np.arange(3))
    np.testing.assert_allclose(stress[:, 0, 0], 1678.0 / 0.7 * strain, rtol=1e-9)
    assert sim.dt < 0.99 * loose


def test_refusals():
    sim = film(Pressure(0.01))
    with pytest.raises(ValueError, match=r"displacement must be finite and of shape"):
        sim.relax(np.zeros((3, 3)))
    with pytest.raises(NotAtRest, match="not at rest after 5 steps"):
        sim.relax(most_steps=5)
    sim = film()
    sim.run(until=1e-6)
    with pytest.raises(ValueError, match="relax before the run"):
        sim.relax()
