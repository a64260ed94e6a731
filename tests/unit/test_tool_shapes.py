"""The tooth ring and the straight blade: geometry against their formulas."""

import re

import numpy as np
import pytest

from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.tool import ToolError

RADIUS, HALF_THICKNESS, LENGTH, HEIGHT, CLEARANCE = 9.4, 0.35, 1.5, 5.0, 0.02
SLOPE = np.tan(np.radians(12.0))


def half_width(d):
    return np.minimum(d * SLOPE, HALF_THICKNESS)


def tooth_length(z, eta_deg=60.0, relief_deg=30.0):
    """Distance from the edge back to the end of the section at the height z above the tip."""
    with np.errstate(divide="ignore"):
        back = np.minimum(z / np.tan(np.radians(relief_deg)), LENGTH)
    return z / np.tan(np.radians(eta_deg)) + back


def section_points(tool, z):
    """Points where the plane at height z cuts the edges of the first tooth's flank triangles."""
    rows = tool.triangles[(tool.triangle_body == 0) & (tool.flank != 0)]
    points = []
    for i, j in ((0, 1), (1, 2), (2, 0)):
        a, b = tool.vertices[rows[:, i]], tool.vertices[rows[:, j]]
        cut = (a[:, 2] - z) * (b[:, 2] - z) < 0.0
        s = ((z - a[:, 2]) / (b[:, 2] - a[:, 2] + ~cut))[cut, None]
        points.append((1.0 - s) * a[cut] + s * b[cut])
    return np.concatenate(points)


def unwrapped(points, phase=0.0):
    """Straight coordinates (s, n) of points of the first tooth."""
    s = RADIUS * (np.arctan2(points[:, 1], points[:, 0]) - phase)
    return s, np.hypot(points[:, 0], points[:, 1]) - RADIUS


class TestToothRing:
    def test_edge_vertices_lie_on_the_cylinder_and_on_their_line(self):
        tool = tooth_ring()
        on_edge = tool.vertices[tool.edges]
        assert np.abs(np.hypot(on_edge[..., 0], on_edge[..., 1]) - RADIUS).max() < 1e-12
        first = on_edge[tool.edge_chain == 0].reshape(-1, 3)
        s, _ = unwrapped(first)
        expected = CLEARANCE + s * np.tan(np.radians(60.0))
        np.testing.assert_allclose(first[:, 2], expected, atol=1e-12)
        np.testing.assert_allclose(first[0], [RADIUS, 0.0, CLEARANCE], atol=1e-12)
        assert first[-1, 2] == pytest.approx(HEIGHT + CLEARANCE, abs=1e-12)

    @pytest.mark.parametrize("eta_deg", [40.0, 60.0, 90.0])
    def test_section_is_the_stated_wedge(self, eta_deg):
        tool = tooth_ring(edge_inclination_deg=eta_deg)
        chords = tool.vertices[tool.edges].mean(axis=1)
        assert np.abs(np.hypot(chords[:, 0], chords[:, 1]) - RADIUS).max() < 1e-3
        for z in (0.3, 0.8, 2.1, 3.9):
            s, n = unwrapped(section_points(tool, CLEARANCE + z))
            d = z / np.tan(np.radians(eta_deg)) - s
            length = tooth_length(z, eta_deg)
            # slanting edges of the facets span up to 0.3 mm of arc: 1.1e-3 mm, measured
            np.testing.assert_allclose(np.abs(n), half_width(d), atol=2e-3)
            assert d.min() == pytest.approx(0.0, abs=1e-3)
            assert d.max() == pytest.approx(length, abs=1e-3)
            assert np.ptp(n) == pytest.approx(2.0 * half_width(length), abs=4e-3)

    @pytest.mark.parametrize(("eta_deg", "relief_deg"), [(60.0, 30.0), (90.0, 30.0), (35.0, 0.0)])
    def test_volume_is_that_of_the_straight_tooth(self, eta_deg, relief_deg):
        tool = tooth_ring(edge_inclination_deg=eta_deg, relief_deg=relief_deg, n_teeth=3)
        # a section from d = 0 to L holds the integral of 2 min(d tan a, w); wrapping a wedge that
        # is even in n leaves its volume
        z = (np.arange(4000) + 0.5) * HEIGHT / 4000
        length = tooth_length(z, eta_deg, relief_deg)
        shoulder = HALF_THICKNESS / SLOPE
        tip = np.minimum(length, shoulder)
        area = SLOPE * tip**2 + 2.0 * HALF_THICKNESS * (length - tip)
        np.testing.assert_allclose(tool.volume(), area.mean() * HEIGHT, rtol=1e-3)

    def test_sides_and_directions_at_the_edge(self):
        tool = tooth_ring(phase_deg=20.0)
        middle = tool.vertices[tool.edges].mean(axis=1)
        outward = middle * [1.0, 1.0, 0.0] / np.hypot(middle[:, 0], middle[:, 1])[:, None]
        forward = np.cross([0.0, 0.0, 1.0], outward)
        assert ((tool.edge_normal * outward).sum(axis=1) > 0.999).all()
        assert ((tool.edge_back * forward).sum(axis=1) < -0.8).all()
        along = np.diff(tool.vertices[tool.edges], axis=1)[:, 0]
        for vectors in (tool.edge_normal, along):
            scale = np.linalg.norm(vectors, axis=1)
            assert np.abs((tool.edge_back * vectors).sum(axis=1) / scale).max() < 1e-12
        assert (along[:, 2] > 0.0).all()
        centre = tool.vertices[tool.triangles].mean(axis=1)
        n = np.hypot(centre[:, 0], centre[:, 1]) - RADIUS
        flank = tool.flank != 0
        np.testing.assert_array_equal(np.sign(n[flank]), tool.flank[flank])
        radial = centre * [1.0, 1.0, 0.0] / np.hypot(centre[:, 0], centre[:, 1])[:, None]
        sideways = np.abs((tool.triangle_normals * radial).sum(axis=1)) > 0.5
        np.testing.assert_array_equal(flank, sideways)  # not bottom, back and top

    def test_teeth_are_turned_copies_in_order(self):
        tool = tooth_ring(n_teeth=3, phase_deg=15.0)
        tips = tool.vertices[tool.edges[np.flatnonzero(np.diff(tool.edge_chain, prepend=-1)), 0]]
        angle = np.degrees(np.arctan2(tips[:, 1], tips[:, 0])) % 360.0
        np.testing.assert_allclose(angle, [15.0, 135.0, 255.0], atol=1e-9)
        np.testing.assert_array_equal(tool.edge_body, tool.edge_chain)
        np.testing.assert_allclose(tool.volume(), tool.volume()[0], rtol=1e-12)

    @pytest.mark.parametrize(
        "parameters",
        [
            {"edge_inclination_deg": 90.0, "relief_deg": 0.0},
            {"edge_inclination_deg": 25.0, "n_teeth": 2},
            {"wedge_half_angle_deg": 3.0, "half_thickness": 0.02},
            {"wedge_half_angle_deg": 3.0, "half_thickness": 1.0},
            {"wedge_half_angle_deg": 30.0, "half_thickness": 0.4},
            {"half_thickness": SLOPE * LENGTH, "edge_inclination_deg": 90.0},
            {"relief_deg": 73.0},
            {"radius": 1.2, "n_teeth": 1, "height": 2.0, "length": 0.5},
            {"n_arc": 40},
            {"n_arc": 11},  # the fewest
        ],
    )
    def test_shapes_of_all_sorts_are_sound_and_well_labelled(self, parameters):
        tool = tooth_ring(**parameters)  # every check of the surface has passed
        assert tool.n_body == tool.n_chain == parameters.get("n_teeth", 4)
        assert (tool.volume() > 0.0).all()
        assert (tool.flank == 1).sum() == (tool.flank == -1).sum() > 0


class TestStraightBlade:
    @pytest.mark.parametrize("angle_deg", [90.0, 60.0, 30.0])
    @pytest.mark.parametrize("length", [3.0, 1.0])
    def test_volume(self, angle_deg, length):
        tool = straight_blade(edge_angle_deg=angle_deg, length=length, height=4.0)
        slope = np.tan(np.radians(10.0))
        wedge = min(0.3 / slope, length)
        area = slope * wedge**2 + 2.0 * 0.3 * (length - wedge)
        np.testing.assert_allclose(tool.volume(), [4.0 * area], rtol=1e-12)

    @pytest.mark.parametrize("angle_deg", [90.0, 45.0])
    def test_edge_runs_down_through_the_origin(self, angle_deg):
        tool = straight_blade(edge_angle_deg=angle_deg)
        angle = np.radians(angle_deg)
        np.testing.assert_allclose(tool.point(0, 0.5), 0.0, atol=1e-15)
        top = [3.0 / np.tan(angle), 0.0, 3.0]
        np.testing.assert_allclose(tool.point(0, 0.0), top, atol=1e-12)
        np.testing.assert_allclose(tool.edge_normal, [[0.0, 1.0, 0.0]], atol=1e-12)
        back = [[-np.sin(angle), 0.0, np.cos(angle)]]
        np.testing.assert_allclose(tool.edge_back, back, atol=1e-12)

    def test_a_blade_has_its_lengths_and_flanks(self):
        tool = straight_blade()
        np.testing.assert_array_equal(
            tool.flank, np.where(np.abs(n := tool.triangle_normals[:, 1]) > 0.5, np.sign(n), 0.0)
        )
        tool = straight_blade(length=2.5, height=4.0, half_thickness=0.2)
        lower, upper = tool.bounding_box()
        np.testing.assert_allclose(lower, [-2.5, -0.2, -2.0], atol=1e-12)
        np.testing.assert_allclose(upper, [0.0, 0.2, 2.0], atol=1e-12)


@pytest.mark.parametrize(
    ("build", "parameters", "told"),
    [
        (
            straight_blade,
            {"edge_angle_deg": 20.0, "wedge_half_angle_deg": 30.0},
            "wedge_half_angle_deg = 30 is 59.4 seen along an edge at edge_angle_deg = 20",
        ),
        (tooth_ring, {"n_teeth": 14}, "14 teeth overlap: each takes 26.7 of 25.7 degrees"),
        (tooth_ring, {"half_thickness": 9.5}, "half_thickness = 9.5 must be below radius = 9.4"),
        (tooth_ring, {"relief_deg": 80.0}, "relief rises by length * tan(relief_deg) = 8.507 mm"),
        (tooth_ring, {"n_arc": 5}, "use at least 11"),
    ],
)
def test_what_is_no_tool_is_refused(build, parameters, told):
    with pytest.raises(ToolError, match=re.escape(told)):
        build(**parameters)
