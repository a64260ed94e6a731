"""Films that tear more easily one way: factors, cables, and what is refused."""

import numpy as np
import pytest

import shellcut as sc
from films import free_film, from_zero
from shellcut.mesh.structured import rectangle

UP = np.array([0.0, 0.0, 1.0])


@pytest.mark.parametrize(("angle", "wanted"), [(0.0, 1.0), (45.0, 0.6), (90.0, 1.0), (135.0, 1.4)])
def test_the_factor_follows_from_the_angle_to_md_in_the_sheet(angle, wanted):
    film = sc.Anisotropy(direction=(2.0, 2.0, 0.0), along=0.6, across=1.4)
    path = 3.0 * np.array([np.cos(np.radians(angle)), np.sin(np.radians(angle)), 0.0])
    assert film.factors(path[None], UP)[0] == pytest.approx(wanted, rel=1e-12)  # round-off
    assert film.factors(-path[None], UP) == film.factors(path[None], UP)


def test_only_the_part_of_md_in_the_sheet_counts_and_none_is_refused():
    film = sc.Anisotropy(direction=(1.0, 1.0, 3.0), along=0.6, across=1.4)
    # Of MD 2/11 of the square lies in the sheet: so much of the difference is left.
    factors = film.factors(np.array([[1.0, 1.0, 0.0], [1.0, -1.0, 0.0]]), UP)
    assert factors == pytest.approx(1.0 + np.array([-0.4, 0.4]) * 2.0 / 11.0, rel=1e-12)
    with pytest.raises(ValueError, match="must be a vector"):
        sc.Anisotropy(direction=(0, 0, 0))


def notched(mesh, film, *ends, **options):
    """Return a film with a straight notch between two places."""
    sim = free_film(mesh, fracture=sc.Fracture(path="free", anisotropy=film), **options)
    sim.notch(*ends)
    return sim


def test_a_cable_has_the_factor_of_its_segment():
    film, stretch = sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=0.5, across=1.0), 1.02
    mesh = rectangle(4.0, 3.0, size=0.5)
    rim = mesh.nodes[:, 0].min()
    sim = notched(mesh, film, (rim - 1.0, 0.2, 0.0), (rim + 1.2, 0.2, 0.0))
    # Drawn across the notch, beyond the strength: the crack grows almost along MD.
    sim.state.node.x[:, 1] *= stretch
    for _ in range(2):
        sim.cracks.cut_due(sim.state, sim.pose)
    cable = sim.state.cable
    assert cable.count > 0
    # A cable keeps the normal to its segment in space: here that in the reference film.
    normal = cable.m[: cable.count] * [1.0, stretch, 1.0]
    factor = film.factors(np.cross(normal, UP), UP)
    section = sim.material.thickness * cable.length[: cable.count]
    np.testing.assert_allclose(cable.area[: cable.count], factor * section, rtol=1e-12)  # round-off


def test_of_two_equally_good_paths_a_crack_takes_one():
    """Pulled across MD, three times as tough along it: J e / f is largest at 45° to either side.

    It does not branch, but tacks: as soon as the other path releases more it takes that one.
    """

    def pulled(name, speed):
        return sc.Support(name, velocity={"y": lambda time: speed * min(1.0, time / 2e-4)})

    sim = notched(
        from_zero(rectangle(9.0, 6.0, size=0.6)),
        sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=3.0, across=1.0),
        (-1.0, 0.0, 0.0),
        (3.0, 0.0, 0.0),
        supports=[pulled("top", 400.0), pulled("bottom", -400.0)],
        law=sc.CohesiveLaw(plateau=12.0, opening_a=0.02, opening_p=0.05, opening_u=0.1),
        damping_alpha=2000.0,
    )
    while sim.state.crack_length < 5.0:
        sim.step()
        assert len(sim.cracks.tips) == 1
    places = np.array([cut.reference[:2] for cut in sim.state.split_log if cut.kind != "notch"])
    pieces = np.diff(places, axis=0)
    assert len(places) > 6
    assert np.abs(pieces[0]) == pytest.approx([0.6, 0.6], rel=0.05)  # at 45°, though all is even
    assert np.unique(np.sign(pieces[:, 1])).size == 2
    # One line: its pieces lead from each place to the next, and from the last to the tip.
    last = sim.state.crack_length - np.linalg.norm(pieces, axis=1).sum()
    assert 0.0 < last < 1.5 * 0.6
    book = sim.close_ledger()
    assert abs(book.relative(book.imbalance)) < 5e-3
