"""Films that tear more easily one way: factors, cables, and what is refused."""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle

UP = np.array([0.0, 0.0, 1.0])
FILM = sc.Anisotropy(direction=(1.0, 1.0, 3.0), along=0.6, across=1.4)


@pytest.mark.parametrize(("angle", "wanted"), [(0.0, 1.0), (45.0, 0.6), (90.0, 1.0), (135.0, 1.4)])
def test_the_factor_goes_with_the_angle_to_md_in_the_sheet(angle, wanted):
    film = sc.Anisotropy(direction=(2.0, 2.0, 0.0), along=0.6, across=1.4)
    way = 3.0 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
    assert film.factor(way, UP) == pytest.approx(wanted, rel=1e-12)  # round-off
    assert film.factor(-way, UP) == film.factor(way, UP)


def test_only_the_part_of_md_in_the_sheet_counts():
    # Of MD 2/11 of the square lies in the sheet: so much of the difference is left.
    factors = FILM.factors(np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]]), UP)
    assert factors == pytest.approx(1.0 + np.array([-0.4, 0.4]) * 2.0 / 11.0, rel=1e-12)


def test_a_cable_has_the_factor_of_its_segment():
    film = sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=0.5, across=1.0)
    mesh = rectangle(4.0, 3.0, size=0.5)
    fracture = sc.Fracture(path="free", anisotropy=film)
    sim = sc.Simulation(
        mesh, sc.ShellMaterial.homogeneous(), law=sc.CohesiveLaw(), fracture=fracture
    )
    rim = mesh.nodes[:, 0].min()
    sim.notch((rim - 1.0, 0.2, 0.0), (rim + 1.2, 0.2, 0.0))
    free = sim.cracks.free
    for _ in range(2):
        (tip,) = free.tips
        segment = free._path.segment_from(sim.state, tip, tip.heading)
        free._advance(sim.state, tip, segment, "criterion", 1.0)
    cable = sim.state.cable
    held = sim.material.thickness * cable.length[: cable.count]
    assert cable.count > 0
    np.testing.assert_allclose(cable.area[: cable.count], 0.5 * held, rtol=1e-12)  # round-off


@pytest.mark.parametrize(
    "wrong", [{"direction": (0, 0, 0)}, {"direction": (1, 0, 0), "along": 0.0}]
)
def test_nonsense_is_refused(wrong):
    with pytest.raises(ValueError, match=r"must be a (vector|positive number)"):
        sc.Anisotropy(**wrong)


def test_it_needs_cracks_through_the_quads():
    with pytest.raises(ValueError, match="take path='free'"):
        sc.Fracture(path="edges", anisotropy=FILM)
