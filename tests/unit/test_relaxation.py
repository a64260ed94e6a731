"""Dynamic relaxation: rest under load agrees with statics, pretension, refusals."""

import numpy as np
import pytest

from shellcut import EdgeTraction, Gravity, Mesh, Pressure, ShellMaterial, Simulation, Statics
from shellcut import Support as S
from shellcut.mesh.structured import cylinder, disc, rectangle
from shellcut.simulation.relaxation import NotAtRest

MESH = disc(5.0, n_side=6, n_layer=2)
FILM = ShellMaterial.homogeneous()
CENTRE = MESH.node_set("centre")


def film(*loads):
    return Simulation(MESH, FILM, supports=[S.clamped("rim")], loads=loads)


def test_rest_under_pressure_is_the_static_equilibrium():
    sim = film(Pressure(0.01))
    assert sim.relax(tolerance=1e-6) > 10
    still = Statics(MESH, FILM, supports=[S.clamped("rim")], loads=[Pressure(0.01)])
    (rest,) = still.load_steps([1.0])
    # The residual is 1e-6 of the reactions; the film is soft where it is nearly flat.
    np.testing.assert_allclose(sim.state.node.x[CENTRE, 2], rest.displacement[CENTRE, 2], rtol=1e-3)
    # Rest stays rest: time and ledger start afresh, the strain energy is the initial energy.
    assert sim.state.time == 0.0
    assert sim.ledger.initial == pytest.approx(sim.ledger.strain, rel=1e-9)
    sim.run(until=2e-5)
    assert sim.ledger.kinetic < 1e-5 * sim.ledger.strain
    assert abs(sim.ledger.imbalance) < 1e-8 * sim.ledger.strain


def cap():
    """A spherical cap of radius 10, 30° from its pole to the rim, directors left to the mesh."""
    flat = disc(1.0, n_side=6)
    polar = np.radians(30.0) * np.linalg.norm(flat.nodes, axis=1)
    around = np.arctan2(flat.nodes[:, 1], flat.nodes[:, 0])
    ring = np.sin(polar)
    nodes = 10.0 * np.stack([ring * np.cos(around), ring * np.sin(around), np.cos(polar)], axis=1)
    return Mesh.from_arrays(nodes, flat.quads, node_sets={"rim": flat.node_set("rim")})


ROOF = cylinder(10.0, 10.0, n_around=8, n_along=8, arc_deg=80.0)
SHEET = rectangle(10.0, 10.0, n_x=6, n_y=6)
WEIGHT = Gravity((0.0, 0.0, -9810.0))


@pytest.mark.parametrize(
    ("mesh", "supports", "load"),
    [
        (ROOF, [S.pinned("left"), S.pinned("right")], WEIGHT),
        (ROOF, [S.clamped("left"), S.clamped("right")], Pressure(1e-3)),
        (ROOF, [S.clamped("left"), S.clamped("right")], Pressure(-1e-4)),
        (cap(), [S.clamped("rim")], Pressure(-1e-2, following=True)),
        (SHEET, [S.clamped("left")], WEIGHT),
        (SHEET, [S.clamped("left")], EdgeTraction("right", (0.1, 0.0, 0.0))),
    ],
    ids=["weight", "pressure", "suction", "cap", "sheet", "pull"],
)
def test_plain_films_come_to_rest_with_default_settings(mesh, supports, load):
    # After every stop the film starts with half a kick. With a whole one the highest modes grow
    # from stop to stop: three of these flew apart.
    sim = Simulation(mesh, FILM, supports=supports, loads=[load])
    sim.relax()
    (rest,) = Statics(mesh, FILM, supports=supports, loads=[load]).load_steps([1.0])
    x, t = sim.state.node.x[: mesh.n_node], sim.state.node.t[: mesh.n_node]
    # The default tolerance leaves 1e-5 of the reactions, of which the softest motions make 0.1 %.
    scale = abs(rest.displacement).max()
    np.testing.assert_allclose(x - mesh.nodes, rest.displacement, atol=5e-3 * scale)
    np.testing.assert_allclose(np.linalg.norm(t, axis=1), 1.0, atol=1e-12)


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
    with pytest.raises(ValueError, match=r"displacement must have shape"):
        sim.relax(np.zeros((3, 3)))
    with pytest.raises(NotAtRest, match="not at rest after 5 steps"):
        sim.relax(most_steps=5)
    sim = film()
    sim.run(until=1e-6)
    with pytest.raises(ValueError, match="relax before the run"):
        sim.relax()


@pytest.mark.parametrize(
    ("load", "displacement", "cause"),
    [
        (Pressure(1e6), None, "the loads are far too large for the film"),
        (Pressure(0.01), 1e6 * MESH.nodes, "the prescribed displacement strains the film"),
    ],
)
def test_what_flies_apart_is_blamed_for_it_and_put_back(load, displacement, cause):
    sim = film(load)
    with pytest.raises(NotAtRest, match=rf"quad \d+ at .* mm; {cause}.*where they were before"):
        sim.relax(displacement)
    assert (sim.state.node.x[: MESH.n_node] == MESH.nodes).all()
    assert sim.dt > 0.0
    assert sim.ledger.strain == 0.0


def test_a_start_beyond_all_measure_is_not_laid_on_the_step():
    sim = film()
    sim.state.node.x[CENTRE[0]] = 1e9
    blamed = r"before the first step: quad \d+ .*what moved its nodes"
    with pytest.raises(RuntimeError, match=blamed) as error:
        sim.relax()
    assert "safety" not in str(error.value)
