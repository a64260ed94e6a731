import numpy as np
import pytest

from shellcut import ImprintError, PathCurve
from shellcut.imprinting.course import check_room, find_courses
from shellcut.imprinting.film_plane import FilmPlane
from shellcut.mesh.structured import annulus, disc, rectangle


def courses(mesh, *curves):
    film = FilmPlane(mesh)
    flat = [c.mapped(film.flatten) if c.dimension == 3 else c for c in curves]
    found = find_courses(film, flat)
    check_room(film, found)
    return found


def refusal(mesh, *curves):
    with pytest.raises(ImprintError) as caught:
        courses(mesh, *curves)
    return str(caught.value)


SHEET = rectangle(10.0, 6.0, size=0.5)


def test_a_line_is_cut_to_the_film():
    (course,) = courses(SHEET, PathCurve.line((-1.0, 0.2), (14.0, 0.2)))
    assert (course.start, course.end) == pytest.approx((1.0, 11.0), abs=1e-12)
    np.testing.assert_allclose(course.rim_start.x, [0.0, 0.2], atol=1e-12)
    np.testing.assert_allclose(course.rim_end.x, [10.0, 0.2], atol=1e-12)
    assert not course.closed


def test_a_hole_parts_a_line():
    found = courses(annulus(3.0, 10.0, n_around=80, n_radial=18), PathCurve.line((-12, 0), (12, 0)))
    ends = [(c.start, c.end) for c in found]
    # crossings with the splines through the rims' nodes: discretisation of the circles, 1e-6
    np.testing.assert_allclose(ends, [(2.0, 9.0), (15.0, 22.0)], atol=1e-5)


def test_a_closed_curve_may_leave_and_come_back():
    (course,) = courses(SHEET, PathCurve.circle((5.0, -3.0, 0.0), 2.0))
    assert course.length == pytest.approx(2.0 * np.pi, rel=1e-5)
    assert not course.closed
    (whole,) = courses(SHEET, PathCurve.circle((5.0, 0.0, 0.0), 2.0))
    assert whole.closed


def test_an_inner_end_near_the_rim_is_led_on():
    near, far = PathCurve.line((5.0, 0.2), (9.0, 0.2)), PathCurve.line((5.0, 0.2), (8.0, 0.2))
    assert courses(SHEET, near)[0].rim_end is not None
    assert courses(SHEET, near)[0].end == pytest.approx(5.0, abs=1e-12)
    assert courses(SHEET, far)[0].rim_end is None
    assert courses(SHEET, far)[0].rim_start is None


def test_a_path_through_a_corner_ends_there():
    (course,) = courses(SHEET, PathCurve.line((-1.0, -4.0), (6.0, 3.0)))
    assert course.rim_start.corner == 0


def test_what_the_mesh_cannot_take_is_refused_with_the_place():
    assert "outside" in refusal(SHEET, PathCurve.line((0, 9), (5, 9)))
    assert "0.45 mm, got 0.3 mm" in refusal(SHEET, PathCurve.circle((5.0, 0.0, 0.0), 2.7))
    assert "bend more tightly" in refusal(SHEET, PathCurve.circle((5.0, 0.0, 0.0), 0.8))
    assert "35 degrees at least, got 20" in refusal(
        SHEET, PathCurve.line((-1.0, 1.0), (14.0, 1.0 + 15.0 * np.tan(np.radians(20.0))))
    )
    assert "right through a corner" in refusal(SHEET, PathCurve.line((-1.0, 2.8), (12.0, 2.8)))
    crossing = PathCurve.line((-1, 0.2), (12, 0.2)), PathCurve.line((5, -4), (5, 4))
    assert "must not cross" in refusal(SHEET, *crossing)
    eight = PathCurve.of_function(
        lambda t: (5.0 + 4.0 * np.sin(t), 2.0 * np.sin(2.0 * t)), 0.0, 2.0 * np.pi, closed=True
    )
    assert "must not cross, got (5, 0, 0)" in refusal(rectangle(10.0, 6.0, size=0.25), eight)
    assert "for 4 edges at least" in refusal(SHEET, PathCurve.line((4.0, 0.1), (5.0, 0.1)))


def test_a_pre_crack_on_the_path_is_refused():
    on_line = SHEET.nodes_where(lambda x, y, z: (abs(y) < 1e-9) & (x < 2.1))
    message = refusal(SHEET.cut(on_line), PathCurve.line((-1, 0), (12, 0)))
    assert "pre-cracks" in message
    assert "cut a notch after the imprint" in message


def test_a_mesh_of_huge_quads_is_refused():
    with pytest.raises(ImprintError, match="refine the mesh"):
        courses(disc(10.2, n_side=2), PathCurve.circle((0, 0, 0), 9.4))
