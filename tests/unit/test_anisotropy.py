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


@pytest.mark.parametrize("factor", [0.3, 3.0])
@pytest.mark.parametrize("slope", [0.25, -0.1])
def test_a_factor_that_is_the_same_in_all_directions_is_a_scaled_law(factor, slope):
    def torn(film, scale):
        mesh = rectangle(12.0, 6.0, size=0.8)
        x, y = mesh.nodes[:, 0] - mesh.nodes[:, 0].min(), mesh.nodes[:, 1]
        strength = scale * np.array([12.0, 8.0, 8.0, 0.0])
        law = sc.CohesiveTable(openings=[0.0, 0.06, 0.5, 0.7], tractions=strength)
        legs = [np.flatnonzero((x < 1e-9) & (sign * y > 1.0)) for sign in (1.0, -1.0)]
        pulls = [
            sc.Support(leg, translation="yz", rotation="", velocity={"y": lambda _, v=v: v})
            for leg, v in zip(legs, (800.0, -800.0), strict=True)
        ]
        sim = free_film(
            from_zero(mesh),
            material=sc.ShellMaterial.homogeneous(thickness=0.2, young=4000.0, poisson=0.3),
            law=law,
            fracture=sc.Fracture(path="free", anisotropy=film),
            supports=[*pulls, sc.Support("right", rotation="")],
        )
        sim.notch((-0.2, -0.37, 0.0), (2.5, -0.37 + 2.7 * slope, 0.0))
        while sum(split.kind == "tear" for split in sim.state.split_log) < 3:
            sim.step()
            assert sim.state.time < 3e-3
        return sim

    film = sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=factor, across=factor)
    one, other = torn(film, 1.0), torn(None, factor)
    for ours, theirs in zip(one.state.split_log, other.state.split_log, strict=True):
        assert ours.time == pytest.approx(theirs.time, rel=1e-9)
        assert ours.end == pytest.approx(theirs.end, abs=1e-9)
