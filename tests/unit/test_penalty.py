"""The penalty law of the contact, and what it follows."""

import math

import numpy as np
import pytest

from naive import contact as naive
from shellcut import Contact, Elastic, Layer, ShellMaterial
from shellcut.contact.settings import (
    SOFTEST,
    STEEPEST,
    STIFFEST,
    PenaltyLaw,
    largest_rebound,
    smoothed,
    smoothed_integral,
)
from shellcut.tool.shapes import straight_blade, tooth_ring

BLADE = straight_blade()
G_M = 0.074 / 4


def test_force_law_is_continuous_in_value_and_slope():
    g = np.linspace(0, 2 * G_M, 20_001)
    f = np.array([smoothed(v, G_M) for v in g])
    assert f[0] == 0.0
    assert smoothed(0.3, G_M) == 0.3
    slope = np.diff(f) / np.diff(g)
    # A jump of the slope would be a jump of one; its steps are below 1e-3.
    assert np.abs(np.diff(slope)).max() < 1e-3
    assert slope[0] == pytest.approx(0.0, abs=1e-6)
    assert slope[-1] == pytest.approx(1.0, rel=1e-9)
    # Steepest at ¾ g_M: 9 (3/4)² - 8 (3/4)³ = 27/16.
    assert slope.max() == pytest.approx(STEEPEST, rel=1e-6)
    assert g[np.argmax(slope)] == pytest.approx(0.75 * G_M, rel=1e-2)
    assert [naive.smoothed(v, G_M) for v in g[::500]] == pytest.approx(f[::500], rel=1e-13)


def test_integral_of_the_force_law():
    for end in (0.3 * G_M, G_M, 1.7 * G_M, 10 * G_M):
        g = np.linspace(0, end, 4001)
        area = np.trapezoid([smoothed(v, G_M) for v in g], g)
        # Trapezoids: second order in 1/4000.
        assert smoothed_integral(end, G_M) == pytest.approx(area, rel=1e-5)
    assert smoothed_integral(G_M * (1 - 1e-12), G_M) == pytest.approx(
        smoothed_integral(G_M, G_M), rel=1e-10
    )


def law(thickness=0.074, young=1678.0, density=1e-9, tool=BLADE, **contact):
    film = ShellMaterial.homogeneous(thickness=thickness, young=young, density=density)
    return PenaltyLaw.of(Contact(**contact), film, tool)


def test_the_film_of_the_paper_has_the_numbers_of_the_paper():
    paper = law(tool=tooth_ring())
    assert paper.penalty == 1e4
    assert paper.smoothing_depth == 0.074 * 0.25


@pytest.mark.parametrize("thickness", [0.005, 0.02, 0.3, 1.0])
@pytest.mark.parametrize("young", [50.0, 1678.0, 70000.0])
def test_depth_and_step_do_not_depend_on_thickness_and_modulus(thickness, young):
    # A node of the film, on quads of 0.4 mm, pushed by what tears the film at 1 % of strain.
    area, length, density = 0.04, 0.4, 2.7e-9

    def depth_and_step(of, thickness, young, density):
        k = of.of_nodes(area)
        depth = 0.01 * young * thickness * length / k
        mass = density * thickness * length**2
        wave = length / math.sqrt(young / density)
        return depth, math.sqrt(mass / k) / wave

    paper = depth_and_step(law(), 0.074, 1678.0, 1e-9)
    other = depth_and_step(law(thickness, young, density), thickness, young, density)
    assert other == pytest.approx(paper, rel=1e-12)
    assert paper[0] < 2e-3  # mm
    assert paper[1] > 0.5  # of the time in which a wave crosses a quad


def test_stiffness_is_bounded_for_the_finest_and_the_coarsest_quads():
    own, stretching = law(), 1678.0 * 0.074
    area = np.array([1e-5, 0.01, 0.04, 0.25, 10.0])
    steepest = own.steepest(area)
    expected = [SOFTEST * stretching, 100.0, 400.0, 2500.0, STIFFEST * stretching]
    assert steepest == pytest.approx(STEEPEST * np.array(expected), rel=1e-13)
    one = [float(own.of_nodes(a)) for a in area]
    assert one == pytest.approx(expected, rel=1e-13)
    # A penalty of one's own is what it says, of every quad.
    given = law(penalty=2e4)
    assert given.steepest(area) == pytest.approx(STEEPEST * 2e4 * area, rel=1e-13)
    assert given.of_nodes(1e-5) == 2e4 * 1e-5


def test_smoothing_follows_the_film_and_stays_small_beside_the_tool():
    assert law(0.02).smoothing_depth == 0.005
    thick = law(1.0)
    assert thick.smoothing_depth == BLADE.half_thickness() / 8
    thin_blade = straight_blade(half_thickness=0.02, wedge_half_angle_deg=3.0)
    assert law(tool=thin_blade).smoothing_depth < 0.02 / 8
    assert law(0.02, smoothing=0.1).smoothing_depth == 0.002


def test_a_laminate_counts_by_its_layers():
    film = ShellMaterial(
        [Layer(Elastic(70000.0, 0.3, 2.7e-9), 0.01), Layer(Elastic(300.0, 0.3, 0.9e-9), 0.09)]
    )
    own = PenaltyLaw.of(Contact(), film, BLADE)
    assert own.penalty == pytest.approx(1e4 * 727.0 / (1678.0 * 0.074), rel=1e-12)
    assert own.smoothing_depth == pytest.approx(BLADE.half_thickness() / 8, rel=1e-12)  # < h/4


@pytest.mark.parametrize("put_in", [0.0, 0.2])
def test_the_largest_rebound_gives_back_what_was_put_in(put_in):
    before, way, pushed, mass, dt = 3.0, 0.04, 1.5, 2e-3, 0.1
    f = largest_rebound(put_in + 0.5 * before * way, way, pushed, mass, dt)
    next_way = way + (pushed - f) * dt**2 / mass
    assert next_way < 0.0  # it comes out
    got = put_in + 0.5 * (before + f) * way
    assert got + 0.5 * f * next_way == pytest.approx(0.0, abs=1e-14)


def test_a_spring_that_has_got_nothing_gives_nothing():
    assert largest_rebound(0.0, -0.1, 0.0, 1.0, 0.1) == 0.0
    assert largest_rebound(-0.25, -0.1, 0.0, 1e-3, 0.1) == 0.0
    # A node that comes in at rest may be turned round: 2 m v / dt.
    assert largest_rebound(0.0, 0.2, 0.0, 1e-3, 0.1) == pytest.approx(2e-3 * 2.0 / 0.1)


def test_half_thickness_of_plates_is_half_their_thickness():
    # A plate of 0.2 x 60 x 60 mm, the wedge on one side of it aside: V / A = 0.1 mm but for rims.
    plate = straight_blade(half_thickness=0.1, length=60.0, height=60.0)
    assert plate.half_thickness() == pytest.approx(0.1, rel=0.02)
    # Of several bodies the thinnest; four equal teeth are as thin as one.
    assert tooth_ring(n_teeth=4).half_thickness() == pytest.approx(
        tooth_ring(n_teeth=1).half_thickness(), rel=1e-9
    )
