"""A fast crack becomes two; the plate of the literature in small, twice as fast."""

import numpy as np
import pytest

import shellcut as sc
from branching_plate import DENSITY, POISSON, YOUNG, branchings, cuts, plate
from gone_on import check_goes_on
from shellcut.fracture.branching import ANGLE, SHARE, Branching, rayleigh_speed
from shellcut.fracture.drawn_film import DrawnFilm
from shellcut.fracture.tip import Tip, restored_tips, saved_tips
from shellcut.material import Layer, Orthotropic

END = 45e-6
GLASS = {"young": YOUNG, "density": DENSITY, "thickness": 1.0}


def small(**options):
    """Return a plate of half the length under twice the pull."""
    return plate(50.0, 20.0, 20.0 / 21, pull=2.0, **options)


@pytest.fixture(scope="module")
def torn():
    """Return a plate torn through."""
    sim = small(branching=True)
    while sim.state.time < END:
        sim.step()
    return sim


def test_rayleigh_waves_of_a_film():
    # A film with nu is a body with nu / (1 + nu); for 1/4 the share is sqrt(2 - 2/sqrt 3).
    film = sc.ShellMaterial.homogeneous(poisson=1.0 / 3.0, **GLASS)
    shear = np.sqrt(YOUNG / (2.0 * (1.0 + 1.0 / 3.0)) / DENSITY)
    exact = np.sqrt(2.0 - 2.0 / np.sqrt(3.0)) * shear
    assert rayleigh_speed(film) == pytest.approx(exact, rel=1e-10)  # of the root


def test_a_crack_becomes_two_once_it_is_fast(torn):
    where, when = branchings(torn)
    x, y = where[0]
    assert 29.5 < x < 38.0  # five edges after the notch at the least
    assert abs(y) < 1.0
    places, times = cuts(torn)
    straight = times < when[0]
    assert np.abs(places[straight, 1]).max() < 0.5
    window = straight & (places[:, 0] > x - 6.0)
    speed = (x - places[window][0, 0]) / (when[0] - times[window][0])
    # Discretisation: the window ends within an edge of five edges.
    assert speed > SHARE * rayleigh_speed(torn.material) * 0.95
    slower = plate(50.0, 20.0, 20.0 / 21, pull=1.1, branching=True)
    while not len(branchings(slower)[0]):
        slower.step()
        assert slower.state.time < END
    # It takes a longer way to come to the same speed: 34.6 instead of 29.5 mm.
    assert branchings(slower)[0][0, 0] > x + 3.0
    assert len(cuts(slower)[0]) > 8


def test_both_branches_run_on_either_side(torn):
    where, when = branchings(torn)
    places, times = cuts(torn)
    near = (times > when[0]) & (places[:, 0] < where[0, 0] + 4.0) & (places[:, 0] > where[0, 0])
    ahead = places[near] - where[0]
    for side in (1.0, -1.0):
        one = ahead[side * ahead[:, 1] > 0.0]
        # Discretisation: places on sides of the mesh, and they keep no more than four edges to it.
        angle = np.arctan2(side * one[-1, 1], one[-1, 0])
        assert angle == pytest.approx(ANGLE, abs=0.2)
    assert places[places[:, 1] > 1.5, 0].max() > 45.0
    assert places[places[:, 1] < -1.5, 0].max() > 45.0


def test_no_film_is_lost_where_cracks_branch(torn):
    film = DrawnFilm.of(torn.state, torn.cracks.cuts.topology)
    X = film.at_points(torn.state.node.X)[film.polygons]
    turned = np.roll(X, -1, axis=1)
    area = 0.5 * np.abs((X[..., 0] * turned[..., 1] - X[..., 1] * turned[..., 0]).sum(axis=1))
    assert area.sum() == pytest.approx(1000.0, rel=1e-10)  # round-off
    assert torn.state.node.mass[: torn.state.n_node].sum() == pytest.approx(
        1000.0 * DENSITY, rel=1e-10
    )
    book = torn.close_ledger()
    # Of the work of the loads; time step of a film that is hit by a jump of load.
    assert abs(book.relative(book.imbalance)) < 2e-3


def test_a_run_goes_on_with_the_same_bits_between_branchings(tmp_path):
    def between(sim):
        return len(branchings(sim)[0]) == 1 and any(len(t.pace) > 2 for t in sim.cracks.tips)

    def build(**options):
        return small(branching=True, **options)

    check_goes_on(build, between, tmp_path / "c.h5", 120)


@pytest.mark.parametrize("poisson", [-0.9, 0.0, 0.49])
def test_rayleigh_waves_of_any_film(poisson):
    film = sc.ShellMaterial.homogeneous(poisson=poisson, **GLASS)
    shear = YOUNG / (2.0 * (1.0 + poisson))
    x = rayleigh_speed(film) ** 2 * DENSITY / shear
    # The secular equation of an isotropic body with the moduli of plane stress.
    ratio = 0.5 * (1.0 - poisson)
    assert (2.0 - x) ** 2 == pytest.approx(4.0 * np.sqrt((1.0 - x) * (1.0 - x * ratio)), rel=1e-9)


def test_a_crack_near_another_tip_does_not_branch():
    glass = sc.ShellMaterial.homogeneous(poisson=POISSON, **GLASS)
    branching = Branching(glass, sc.CohesiveLaw(), sc.Fracture(path="free"))
    length = YOUNG * sc.CohesiveLaw().fracture_energy / sc.CohesiveLaw().strength ** 2
    tip = Tip((0, 0), 0.0, -1, np.array([1.0, 0.0, 0.0]))
    for k in range(5):
        tip.pace = branching.pace_after(tip, k * 0.25 * length / branching.speed, 0.3 * length, 1.0)
    now = 5 * 0.25 * length / branching.speed
    assert branching.may_branch(tip, now, 1.0, 2.1 * length)
    assert not branching.may_branch(tip, now, 1.0, 1.9 * length)
    assert not branching.may_branch(tip, 1.5 * now, 1.0, 2.1 * length)  # too slow
    tip.pace = tip.pace[-2:]
    assert not branching.may_branch(tip, now, 1.0, 2.1 * length)  # has not run far


def test_only_branches_keep_their_heading_near_other_tips():
    ways = []
    for options in ({}, {"branching": True}):
        sim = small(**options)
        sim.notch((24.0, 4.0, 0.0), (26.5, 5.5, 0.0))  # a slit with two tips within the length
        while sim.state.time < 8e-6:
            sim.step()
        ways.append([cut.reference for cut in sim.state.split_log])
    assert ways[0] == ways[1]


def test_a_checkpoint_keeps_what_tips_have_run():
    heading = np.array([1.0, 0.0, 0.0])
    paces = [(), ((1e-6, 0.5), (2e-6, 0.4)), ((3e-6, 0.7),)]
    tips = [Tip((k, k + 1), 0.5, k, heading, pace=pace) for k, pace in enumerate(paces)]
    tips[1].branch = True
    again = restored_tips(saved_tips(tips))
    assert [(tip.pace, tip.branch) for tip in again] == [(t.pace, t.branch) for t in tips]


def test_what_does_not_go_with_branching_is_refused():
    with pytest.raises(ValueError, match=r"branching is of cracks through the quads only"):
        sc.Fracture(path="edges", branching=True)
    drawn = sc.ShellMaterial([Layer(Orthotropic(4000.0, 1500.0, 0.3, 700.0, 1e-9), 0.1)])
    with pytest.raises(ValueError, match=r"alike in all directions, got one with axes"):
        Branching(drawn, sc.CohesiveLaw(), sc.Fracture(path="free"))
    glass = sc.ShellMaterial.homogeneous(poisson=POISSON, **GLASS)
    rare = Branching(glass, sc.CohesiveLaw(), sc.Fracture(path="free", check_every=10))
    with pytest.raises(ValueError, match=r"set check_every to 9 or less"):
        rare.require_checks(1e-7, 1.0)
