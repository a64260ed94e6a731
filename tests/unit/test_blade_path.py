import numpy as np
import pytest

from shellcut import ImprintError, ScrewMotion, StraightMotion, TableMotion, blade_path
from shellcut.mesh.structured import opening_disc, rectangle
from shellcut.tool.shapes import straight_blade, tooth_ring

DISC = opening_disc("quick")
SHEET = rectangle(20.0, 8.0, size=0.5)


def screw(angle_deg=95.0, **options):
    return ScrewMotion.over(angle_deg=angle_deg, duration=6e-3, pitch=12.0, **options)


def test_four_teeth_cut_one_closed_circle():
    (path,) = blade_path(tooth_ring(), screw(), DISC, 6e-3)
    assert path.closed
    radius = np.linalg.norm(path.point(np.linspace(0.0, path.length, 1000)), axis=1)
    # round-off of the least squares, and the circle's spline
    assert abs(radius - 9.4).max() < 1e-9


def test_teeth_that_do_not_meet_cut_arcs():
    paths = blade_path(tooth_ring(), screw(45.0), DISC, 6e-3, ahead=0.0, behind=0.0)
    assert len(paths) == 4
    for path in paths:
        assert not path.closed
        assert abs(np.linalg.norm(path.point(path.knots), axis=1) - 9.4).max() < 1e-9
    # (p / 2 pi) cot eta a radian more than the tooth turns, less the clearance at the start
    lead = 12.0 / (2.0 * np.pi) / np.tan(np.radians(60.0))
    swept = np.radians(45.0) * (9.4 + lead) - 0.02 / (12.0 / (2.0 * np.pi)) * (9.4 + lead)
    start = 0.02 / (12.0 / (2.0 * np.pi)) * 9.4  # turned before the tip meets the film
    assert start > 0.0
    assert paths[0].length == pytest.approx(swept, rel=2e-3)
    longer = blade_path(tooth_ring(), screw(45.0), DISC, 6e-3, ahead=0.2, behind=0.1)
    assert longer[0].length == pytest.approx(paths[0].length + 0.3, rel=1e-4)
    assert longer[0].leads == pytest.approx((0.1, 0.2), rel=1e-3)
    starts = [path.point(path.leads[0])[0] for path in longer]
    assert np.linalg.norm(starts - paths[0].point(0.0), axis=1).min() < 1e-6


@pytest.mark.parametrize("angle_deg", [5.0, 10.0, 20.0, 30.0])
def test_a_short_way_through_the_film_is_on_the_same_circle(angle_deg):
    # 1 to 3 vertices of the edge pass; a fit to the chords between them misses the circle by up to
    # 8e-3 mm where the path is led on
    (first, *_) = blade_path(tooth_ring(), screw(angle_deg), DISC, 6e-3)
    assert abs(np.linalg.norm(first.point(first.knots), axis=1) - 9.4).max() < 1e-9


def test_a_screw_off_the_middle_cuts_a_circle_about_its_axis():
    motion = screw(axis_point=(0.4, -0.2, 0.0))
    tool = tooth_ring(radius=8.0).translated((0.4, -0.2, 0.0))
    (path,) = blade_path(tool, motion, DISC, 6e-3)
    distance = np.linalg.norm(path.point(path.knots) - [0.4, -0.2, 0.0], axis=1)
    assert path.closed
    assert abs(distance - 8.0).max() < 1e-9


def test_a_straight_blade_cuts_a_line_and_the_crack_runs_on_at_both_ends():
    blade = straight_blade(length=20.0, height=3.0).translated((-0.05, 0.3, 0.0))
    motion = StraightMotion((1.0, 0.0, 0.0), speed=1000.0)
    (path,) = blade_path(blade, motion, SHEET, 10e-3)
    ends = path.point([path.leads[0], path.length - path.leads[1], path.length])
    np.testing.assert_allclose(
        ends, [[-0.05, 0.3, 0.0], [9.95, 0.3, 0.0], [12.95, 0.3, 0.0]], atol=1e-9
    )
    assert path.leads == pytest.approx((3.0 + 20.0, 3.0), abs=1e-9)  # the blade is 20 mm long


@pytest.mark.parametrize(
    ("relief_deg", "down", "expected"),
    # It enters at 14 degrees: a relief of 30 stays off the film behind, one of 0 does not.
    [(30.0, 0.25, 0.0), (0.0, 0.25, 1.5)],
)
def test_a_path_is_led_on_behind_a_body_that_presses_on_the_film(relief_deg, down, expected):
    far = 1e4  # a straight tooth
    tooth = tooth_ring(n_teeth=1, radius=far, relief_deg=relief_deg, n_arc=8)
    motion = StraightMotion((0.0, 1.0, -down), speed=1000.0)
    (path,) = blade_path(tooth.translated((8.0 - far, 0.0, 0.0)), motion, SHEET, 8e-3)
    # discretisation: the edge moves by 0.02 mm from one time to the next
    assert path.leads[0] == pytest.approx(3.0 + expected, abs=0.03)
    assert path.leads[1] == 3.0


def test_a_straight_way_in_six_digits_is_not_the_arc_of_a_huge_circle():
    times = np.linspace(0.0, 1e-2, 41)
    places = np.zeros((41, 3))
    places[:, 0] = np.linspace(0.1, 10.1, 41)
    places[:, 1] = 1e-6 * np.sin(np.arange(41.0))
    (path,) = blade_path(
        straight_blade(length=20.0, height=3.0), TableMotion(times, places), SHEET, 1e-2
    )
    assert len(path.knots) == 2
    np.testing.assert_allclose(path.point(path.length)[0], [13.1, 0.0, 0.0], atol=1e-5)


def test_an_edge_that_comes_down_flat_cuts_its_own_length():
    # lay the edge along x and push it down through the film
    times = np.linspace(0.0, 1e-3, 5)
    down = np.stack([np.full(5, 5.0), np.zeros(5), np.linspace(1.0, -1.0, 5)], axis=1)
    lying = np.tile([0.0, 0.5 * np.pi, 0.0], (5, 1))
    blade = straight_blade(length=20.0, height=3.0)
    (path,) = blade_path(blade, TableMotion(times, down, lying), SHEET, 1e-3, ahead=0.0, behind=0.0)
    ends = np.sort(path.point([0.0, path.length])[:, 0])
    edge = blade.vertices[blade.edges[0], 2]
    np.testing.assert_allclose(ends, np.sort(5.0 + edge), atol=1e-9)
    assert abs(path.point(path.knots)[:, 1:]).max() < 1e-9


def test_a_general_motion_gives_a_spline_through_the_places():
    times = np.linspace(0.0, 1e-2, 41)
    x = np.linspace(-0.5, 20.5, 41)
    places = np.stack([x, 1.2 * np.sin(0.4 * x), np.zeros(41)], axis=1)
    motion = TableMotion(times, places)
    blade = straight_blade(length=20.0, height=3.0)
    (path,) = blade_path(blade, motion, SHEET, 1e-2)
    along = path.point(np.linspace(path.leads[0] + 1.0, path.length - 4.0, 400))
    # discretisation: cubic splines through points 0.25 mm apart
    assert abs(along[:, 1] - 1.2 * np.sin(0.4 * along[:, 0])).max() < 1e-4


def test_a_tool_that_never_meets_the_film_is_refused():
    high = tooth_ring().translated((0.0, 0.0, 20.0))
    with pytest.raises(ImprintError, match="pass through the film's plane"):
        blade_path(high, screw(), DISC, 6e-3)
