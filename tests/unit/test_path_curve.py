import numpy as np
import pytest

from shellcut import PathCurve


def test_a_circle_is_met_to_round_off_of_its_spline():
    circle = PathCurve.circle((1.0, -2.0, 0.5), 9.4)
    assert circle.closed
    points = circle.point(np.linspace(0.0, circle.length, 5003))
    radius = np.linalg.norm(points[:, :2] - [1.0, -2.0], axis=1)
    # discretisation: (2 pi / 720)^4 / 384 of the radius, 1.4e-10 mm
    assert abs(radius - 9.4).max() < 3e-10
    assert abs(points[:, 2] - 0.5).max() < 1e-12
    np.testing.assert_allclose(circle.curvature([1.0, 20.0]), 1.0 / 9.4, rtol=1e-4)
    np.testing.assert_array_equal(circle.point(circle.length), circle.point(0.0))


def test_an_arc_about_a_tilted_normal():
    normal = np.array([1.0, 2.0, -1.0]) / np.sqrt(6.0)
    arc = PathCurve.circle((0.0, 1.0, 0.0), 3.0, normal=normal, start_deg=20.0, end_deg=110.0)
    assert not arc.closed
    assert arc.length == pytest.approx(0.5 * np.pi * 3.0, rel=1e-4)
    points = arc.point(np.linspace(0.0, arc.length, 50))
    assert abs((points - [0.0, 1.0, 0.0]) @ normal).max() < 1e-12
    turn = np.cross(points[0] - [0.0, 1.0, 0.0], points[-1] - [0.0, 1.0, 0.0]) @ normal
    assert turn == pytest.approx(9.0, rel=1e-9)  # counter-clockwise by 90 degrees


def test_nearest_points_against_a_dense_search():
    curve = PathCurve.of_function(lambda t: (t, np.sin(t)), 0.0, 8.0, n_point=60)
    rng = np.random.default_rng(2)
    points = rng.uniform((0.5, -1.3), (7.5, 1.3), (200, 2))
    u = curve.nearest(points)
    found = np.linalg.norm(curve.point(u) - points, axis=1)
    dense = curve.point(np.linspace(0.0, curve.length, 40001))
    best = np.sqrt(((points[:, None] - dense[None]) ** 2).sum(axis=2).min(axis=1))
    assert (found <= best + 1e-9).all()
    off = curve.point(u) - points
    assert abs((off * curve.tangent(u)).sum(axis=1)).max() < 1e-9


def test_a_closed_curve_has_nearest_points_across_its_seam():
    circle = PathCurve.circle((0.0, 0.0, 0.0), 2.0)
    angle = np.radians([-0.3, 0.0, 0.2, 359.9])
    points = 2.3 * np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    np.testing.assert_allclose(circle.point(circle.nearest(points)), points / 1.15, atol=1e-8)


def test_an_open_curve_goes_on_straight():
    arc = PathCurve.circle((0.0, 0.0, 0.0), 1.0, end_deg=90.0)
    beyond = arc.point(arc.length + 0.5)[0]
    np.testing.assert_allclose(beyond, [-0.5, 1.0, 0.0], atol=1e-4)
    u = arc.nearest([[-0.5, 1.2, 0.0], [1.1, -0.7, 0.0]])
    np.testing.assert_allclose(u, [arc.length + 0.5, -0.7], atol=1e-4)
    assert arc.curvature([-0.1, arc.length + 0.1]).tolist() == [0.0, 0.0]


def test_derivative_by_differences():
    curve = PathCurve.through([(0, 0), (1, 0.5), (2, -0.3), (3, 1)])
    u, d = np.array([0.3, 1.7, 3.0]), 1e-6
    difference = (curve.point(u + d) - curve.point(u - d)) / (2.0 * d)
    np.testing.assert_allclose(curve.derivative(u), difference, atol=1e-8)


@pytest.mark.parametrize(
    ("points", "closed", "words"),
    [
        ([[0.0, 0.0, 0.0, 0.0]], False, "shape"),
        ([[0.0, 0.0]], False, "open curve needs 2"),
        ([[0.0, 0.0], [1.0, 0.0]], True, "closed curve needs 3"),
        ([[0.0, 0.0], [np.nan, 0.0]], False, "point 1 is not"),
        ([[0.0, 0.0], [1.0, 0.0], [1.0, 0.0]], False, "point 2 repeats 1"),
    ],
)
def test_what_is_no_curve_is_refused(points, closed, words):
    with pytest.raises(ValueError, match=words):
        PathCurve.through(points, closed=closed)


def test_a_circle_must_have_a_radius_and_run_forward():
    with pytest.raises(ValueError, match="radius must be positive"):
        PathCurve.circle((0.0, 0.0, 0.0), -1.0)
    with pytest.raises(ValueError, match="end_deg must exceed"):
        PathCurve.circle((0.0, 0.0, 0.0), 1.0, start_deg=90.0, end_deg=0.0)
