"""The small shape with which a film begins: what it depends on, and what it does not."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import disc, rectangle
from shellcut.tool.shapes import straight_blade

FILM = sc.ShellMaterial.homogeneous()
H = FILM.thickness
TURN = np.linalg.qr(np.random.default_rng(1).normal(size=(3, 3)))[0]
TURN *= np.linalg.det(TURN)
SHIFT = np.array([31.0, -7.0, 900.0])


LEVEL = np.eye(3)
MOTION = sc.StraightMotion((1.0, 0.0, 0.0), speed=1e3)


def model(mesh, turn=LEVEL, shift=0.0, roll=0, **options):
    """A film before an upright blade, turned and shifted as a whole.

    roll : by how much the numbers of the blade's triangles are others.
    """
    blade = straight_blade(length=4.0)
    vertices = blade.vertices + np.array([mesh.nodes[:, 0].min() - 0.1, 0.0, 0.0])
    tool = sc.Tool.from_triangles(
        vertices @ turn.T + shift,
        np.roll(blade.triangles, roll, axis=0),
        edges=blade.edges[:, :: 1 - 2 * (roll > 0)],
    )
    moved = sc.Mesh.from_arrays(mesh.nodes @ turn.T + shift, mesh.quads)
    motion = sc.StraightMotion(turn[:, 0].tolist(), speed=1e3)
    options = {"law": sc.CohesiveLaw(), **options}
    return sc.Simulation(moved, FILM, tool=tool, motion=motion, **options)


def heights(sim):
    """Displacement along the directors, shape (n_node,)."""
    n = sim.mesh.n_node
    moved = sim.state.node.x[:n] - sim.mesh.nodes
    w = np.einsum("ni,ni->n", moved, sim.mesh.directors)
    # The places themselves are rounded to 1e-13.
    np.testing.assert_allclose(moved, w[:, None] * sim.mesh.directors, atol=1e-12)
    return w


SQUARE, DISC = rectangle(6.0, 6.0, size=0.5), disc(3.0, n_side=6, n_layer=3)


@pytest.mark.parametrize("mesh", [SQUARE, DISC], ids=["square", "disc"])
def test_it_moves_with_the_model_and_not_with_the_numbers(mesh):
    w = heights(model(mesh))
    assert 0.2 * H / 1000.0 < np.abs(w).max() <= H / 1000.0
    np.testing.assert_allclose(heights(model(mesh, TURN, SHIFT)), w, atol=1e-8 * H / 1000.0)
    order = np.random.default_rng(2).permutation(mesh.n_node)
    number = np.argsort(order)
    other = sc.Mesh.from_arrays(mesh.nodes[order], np.roll(number[mesh.quads][::-1], 1, axis=1))
    np.testing.assert_allclose(heights(model(other, roll=3)), w[order], atol=1e-12 * H / 1000.0)


@pytest.mark.parametrize("mirror", [(-1, 1), (1, -1), (-1, -1)])
def test_it_has_no_symmetry_of_film_and_blade(mirror):
    x, y = SQUARE.nodes[:, 0] - 3.0, SQUARE.nodes[:, 1]
    places = {(round(a, 6), round(b, 6)): k for k, (a, b) in enumerate(zip(x, y, strict=True))}
    image = [places[round(mirror[0] * a, 6), round(mirror[1] * b, 6)] for a, b in places]
    w = heights(model(SQUARE))
    for part in (w + w[image], w - w[image]):
        assert np.sqrt((part**2).mean()) > 0.1 * H / 1000.0


def test_it_is_smooth_and_costs_nothing():
    sim = model(SQUARE)
    w = heights(sim)
    step = np.abs(w[SQUARE.quads] - np.roll(w[SQUARE.quads], 1, axis=1)).max()
    assert step < 2.0 * np.pi / 6.0 * H / 1000.0  # of the shortest wave, six edges long
    # G h of a millimetre is 3.2 N*mm.
    assert 0.0 < sim.ledger.initial < 1e-6 * sim.law.fracture_energy * H
    assert sim.shell.tables.n_flat == model(SQUARE, imperfection=0).shell.tables.n_flat > 0


def test_its_number_is_its_own_shape_and_0_is_none():
    first, second, none = (heights(model(SQUARE, imperfection=k)) for k in (1, 2, 0))
    assert (first == heights(model(SQUARE))).all()
    assert abs(np.corrcoef(first, second)[0, 1]) < 0.9
    assert (none == 0.0).all()
    # By default only where a tool cuts.
    assert (heights(sc.Simulation(SQUARE, FILM, law=sc.CohesiveLaw())) == 0.0).all()
    assert (heights(model(SQUARE, law=None)) == 0.0).all()
    assert np.abs(heights(sc.Simulation(SQUARE, FILM, imperfection=1))).max() > 0.2 * H / 1000.0


@pytest.mark.parametrize("number", [-1, 1.5, 10**7])
def test_what_is_no_number_of_a_shape_is_refused(number):
    said = r"imperfection must be (a whole number|from 0 to 1,000,000), got "
    with pytest.raises(ValueError, match=said):
        model(SQUARE, imperfection=number)


def test_a_run_tells_its_number(tmp_path):
    case = sc.guillotine(1.0, length=6.0, width=4.0, notch=1.0, travel=0.2, imperfection=3)
    case.run(tmp_path, n_snapshot=0, curves=False)
    summary = sc.read(tmp_path).summary
    assert (summary["n_imperfection"], summary["imperfection_mm"]) == (3, 7.4e-5)


def under_a_blade(radius, height):
    mesh, blade = disc(radius, n_side=4, n_layer=3), straight_blade(length=4.0)
    tool = blade.translated((0.0, 0.0, height))
    return sc.Simulation(mesh, FILM, tool=tool, motion=MOTION, law=sc.CohesiveLaw())


@pytest.mark.parametrize("radius", [1e7, 1e9])
@pytest.mark.parametrize("height", [5.0, 50.0])
def test_a_tool_that_is_small_beside_the_film(radius, height):
    sim = under_a_blade(radius, height)
    z = sim.state.node.x[: sim.mesh.n_node, 2]
    assert 0.1 * H / 1000.0 < np.abs(z).max() <= H / 1000.0


def test_a_tool_that_is_huge_beside_the_film():
    said = r"1,000,000 contact points at most, .* is the unit of film"
    with pytest.raises(ValueError, match=said):
        under_a_blade(1e-7, 3.0)
