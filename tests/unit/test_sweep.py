"""Where cutting edges pass through the film: against the geometry, worked out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from shellcut import Mesh, ScrewMotion, StraightMotion, TableMotion, Tool
from shellcut.checks import Sweep
from shellcut.mesh.structured import annulus, cylinder, opening_disc, rectangle
from shellcut.tool.shapes import straight_blade, tooth_ring

SHEET = rectangle(10.0, 4.0, size=0.5)
DOWN = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])  # x to -z


def along(speed=1000.0, direction=(1.0, 0.0, 0.0)):
    return StraightMotion(direction, speed=speed)


def blade(x=0.0, y=0.0, z=0.0, **shape):
    return straight_blade(**{"length": 2.0, "height": 3.0, **shape}).translated((x, y, z))


def turned(tool, rotation):
    return Tool.from_triangles(
        tool.vertices @ np.asarray(rotation).T,
        tool.triangles,
        edges=tool.edges,
        flank_angle_deg=tool.flank_angle_deg,
    )


@pytest.mark.parametrize("size", [0.5, 0.25])
def test_a_blade_goes_along_a_line_at_its_speed(size):
    sheet = rectangle(10.0, 4.0, size=size)
    sweep = Sweep.of(sheet, blade(x=-1.0, y=0.2), along(), 8e-3)
    place = sweep.place
    # round-off of the line, at most 1e-3 of an edge before the rim
    assert np.abs(place[:, 1:] - [0.2, 0.0]).max() < 1e-12
    assert -1e-3 * size <= place[0, 0] < 0.5 * size
    assert place[-1, 0] == pytest.approx(7.0, abs=1e-9)
    assert np.diff(place[:, 0]).max() <= 0.5 * size
    assert np.allclose(place[:, 0], -1.0 + 1000.0 * sweep.time, atol=1e-9)
    assert np.allclose(sweep.velocity, [1000.0, 0.0, 0.0])
    assert np.allclose(sweep.back, [-1.0, 0.0, 0.0])
    assert sweep.top_speed == pytest.approx(1000.0)
    (fate,) = sweep.fates
    assert (fate.stays, fate.passed_out) == (True, False)
    assert fate.first == pytest.approx(1e-3, abs=sweep.tick)
    corner = sheet.nodes[sheet.quads[sweep.quad]]
    assert (corner.min(axis=1) <= place + 1e-9).all()
    assert (corner.max(axis=1) >= place - 1e-9).all()


def test_the_distance_from_the_path_is_that_from_its_line_and_a_crack_may_lead_it():
    sweep = Sweep.of(SHEET, blade(x=-1.0, y=0.2), along(), 6e-3)
    points = np.array([[2.5, 0.2, 0.0], [2.53, 0.7, 0.0], [6.5, 0.1, 0.0], [9.5, 0.2, 0.0]])
    # the path ends at x = 5; 0.05 edges between its points
    assert sweep.distance(points) == pytest.approx([0.0, 0.5, 0.1, 0.0], abs=0.03)
    assert sweep.lead(points) == pytest.approx([0.0, 0.0, 1.5, 4.5], abs=0.03)


@pytest.mark.parametrize("back", [[], [[1.0, 0.0, 0.0]], [[1.0, 0.0, 0.0], [4.0, 0.0, 0.0]]])
def test_a_motion_that_stops_or_turns_back_is_led_straight_on(back):
    way = [[1.0, 0.0, 0.0], [5.0, 0.0, 0.0], *back]
    motion = TableMotion(6e-3 * np.arange(len(way)), way)
    sweep = Sweep.of(SHEET, blade(), motion, 6e-3 * (len(way) - 1))
    assert sweep.time.max() <= sweep.duration
    low, high = sweep.place[:, 0].min(), sweep.place[:, 0].max()
    # ahead of its farthest place, and behind the first one, where it has come down in the film
    points = np.array([[9.0, 0.0, 0.0], [7.0, 0.3, 0.0], [-1.0, 0.0, 0.0], [3.0, 0.0, 0.0]])
    assert sweep.distance(points) == pytest.approx([0.0, 0.3, 0.0, 0.0], abs=0.03)
    assert sweep.lead(points) == pytest.approx([9.0 - high, 7.0 - high, low + 1.0, 0.0], abs=0.03)


def test_a_circle_is_led_on_round_and_straight():
    disc, motion = (
        opening_disc("quick"),
        ScrewMotion.over(angle_deg=30.0, duration=6e-3, pitch=12.0),
    )
    sweep = Sweep.of(disc, tooth_ring(n_teeth=1), motion, 6e-3)
    last = sweep.place[np.argmax(np.where(sweep.along_edge, sweep.time, -1.0))]
    radius, angle = np.hypot(*last[:2]), np.arctan2(last[1], last[0])
    first = np.arctan2(sweep.place[0, 1], sweep.place[0, 0])
    turn = angle + np.sign(angle - first) * np.radians([20.0, 60.0])
    points = radius * np.column_stack([np.cos(turn), np.sin(turn), np.zeros(2)])
    assert sweep.distance(points) == pytest.approx([0.0, 0.0], abs=0.03)
    assert sweep.lead(points) == pytest.approx(radius * np.radians([20.0, 60.0]), rel=0.02)
    ahead = np.sign(angle - first) * np.array([-last[1], last[0], 0.0]) / radius
    points = last + np.outer([1.0, 3.0], ahead)
    assert sweep.distance(points) == pytest.approx([0.0, 0.0], abs=0.03)
    # not off to the side
    assert sweep.distance((last + 2.0 * ahead + 0.1 * last)[None]) > 0.1 * radius - 0.2
    # What other teeth have cut on the same circle is led by none.
    ring = Sweep.of(disc, tooth_ring(), motion, 6e-3)
    on = ring.place[ring.along_edge]
    on = on[np.abs(ring.time[ring.along_edge] - 4e-3) < 1e-3]
    c, s = np.cos(np.radians(0.13)), np.sin(np.radians(0.13))
    assert ring.lead(on @ [[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]).max() == 0.0


def test_an_edge_that_comes_down_flat_is_in_the_film_along_all_its_length_at_once():
    # The blade lies on its back: its edge, 3 mm long, along x, looks down.
    tool = turned(straight_blade(length=2.0, height=3.0), DOWN).translated((5.0, 0.0, 1.0))
    sweep = Sweep.of(SHEET, tool, along(500.0, (0.0, 0.0, -1.0)), 4e-3)
    assert sweep.time == pytest.approx(2e-3, abs=1e-12)
    assert np.ptp(sweep.place[:, 0]) == pytest.approx(3.0)
    (fate,) = sweep.fates
    assert fate.first == fate.last == pytest.approx(2e-3)
    # it is through, but the tool does not go on along the film
    assert (fate.stays, fate.passed_out) == (False, False)


def test_teeth_pass_out_below_but_not_through_a_second_edge():
    disc = opening_disc("quick")
    motion = ScrewMotion.over(angle_deg=95.0, duration=6e-3, pitch=12.0)

    def fates(tool):
        return Sweep.of(disc, tool, motion, 6e-3).fates

    angle = 360.0 * (2.0 + 0.02) / 12.0
    for fate in fates(tooth_ring(height=2.0)):
        assert fate.passed_out
        assert np.degrees(motion.coordinate(fate.last)) == pytest.approx(angle, abs=0.5)
    assert all(fate.stays for fate in fates(tooth_ring(height=5.0)))
    # Two chains on one tooth: where the lower one ends the upper one begins.
    ring = tooth_ring(height=5.0, n_teeth=1)
    low = ring.vertices[ring.edges].mean(axis=1)[:, 2] < 2.0
    one, two = fates(replace(ring, edge_chain=np.where(low, 0, 1)))
    assert (one.stays, one.passed_out, two.stays) == (False, False, True)


def test_a_blade_may_leave_over_the_rim_and_come_back_after_a_hole():
    (fate,) = Sweep.of(SHEET, blade(x=-1.0), along(), 15e-3).fates
    assert fate.last == pytest.approx(11e-3, abs=1e-4)
    assert (fate.stays, fate.passed_out) == (False, False)
    ring = annulus(2.0, 5.0, n_around=40, n_radial=6)
    sweep = Sweep.of(ring, blade(x=-6.0), along(), 9e-3)
    radius = np.linalg.norm(sweep.place, axis=1)
    # chords of the rims, and the border's width
    assert radius.min() > 2.0 * np.cos(np.pi / 40) - 1e-3
    assert radius.max() < 5.0 + 1e-3
    assert sweep.fates[0].stays


def test_an_edge_of_very_many_vertices_is_met_where_one_of_few_is():
    # 60,000 segments over 3 mm of an edge of 0.5 mm quads
    one, n = blade(x=-1.0, y=0.2), 60_000
    low, high = one.vertices[one.edges[0]]
    between = low + np.linspace(0.0, 1.0, n + 1)[:, None] * (high - low)
    names = ("edge_body", "edge_chain", "edge_normal", "edge_back")
    fine = replace(
        one,
        vertices=np.concatenate([one.vertices, between]),
        edges=one.n_vertex + np.column_stack([np.arange(n), np.arange(1, n + 1)]),
        **{name: np.repeat(getattr(one, name), n, axis=0) for name in names},
    )
    few, many = (Sweep.of(SHEET, tool, along(), 8e-3) for tool in (one, fine))
    assert many.place[many.along_edge] == pytest.approx(few.place[few.along_edge], abs=1e-9)
    assert many.fates[0].stays


def test_tools_that_stay_above_or_are_withdrawn():
    sweep = Sweep.of(SHEET, blade(z=2.0), along(), 8e-3)
    assert not sweep.fates[0].meets
    assert len(sweep.place) == 0
    assert np.isinf(sweep.distance(SHEET.nodes[:3])).all()
    way = [[2.0, 0.0, 4.0], [3.0, 0.0, 1.0], [5.0, 0.0, 1.0], [6.0, 0.0, 4.0]]
    (fate,) = Sweep.of(SHEET, blade(), TableMotion(1e-3 * np.arange(4), way), 3e-3).fates
    assert (fate.meets, fate.stays, fate.passed_out) == (True, False, False)


def test_a_curved_film_is_met_where_it_is():
    # A knife upright on the top line of a roof, which moves along it, in y.
    roof = cylinder(5.0, 20.0, n_around=30, n_along=40, arc_deg=90.0)
    knife = turned(straight_blade(length=2.0, height=3.0), [[0, -1, 0], [1, 0, 0], [0, 0, 1]])
    sweep = Sweep.of(roof, knife.translated((0.0, -11.0, 5.0)), along(1e3, (0.0, 1.0, 0.0)), 8e-3)
    assert sweep.fates[0].stays
    assert sweep.fates[0].first == pytest.approx(1e-3, abs=5e-5)
    assert np.abs(sweep.place[:, 0]).max() < 1e-9
    assert np.allclose(sweep.place[:, 1], -11.0 + 1e3 * sweep.time, atol=1e-9)
    # the top line is a line of nodes
    assert np.abs(sweep.place[:, 2] - 5.0).max() < 1e-9


def test_between_two_films_nothing_is_crossed():
    low, high = SHEET.nodes, SHEET.nodes + np.array([0.0, 0.0, 1.0])
    n = SHEET.n_node
    both = Mesh.from_arrays(
        np.concatenate([low, high]), np.concatenate([SHEET.quads, SHEET.quads + n])
    )
    sweep = Sweep.of(both, blade(x=-1.0, z=0.5), along(), 6e-3)
    assert sorted(set(sweep.place[:, 2].round(9))) == [0.0, 1.0]


@pytest.mark.parametrize("n_teeth", [2, 3, 6])
def test_a_crack_is_led_from_the_teeth_that_have_been_in_it(n_teeth):
    """Teeth on one circle: a gap is ahead of one tooth and behind the next."""
    motion = ScrewMotion.over(angle_deg=20.0, duration=6e-3, pitch=12.0)
    sweep = Sweep.of(opening_disc("quick"), tooth_ring(n_teeth=n_teeth), motion, 6e-3)
    on = [sweep.place[(sweep.chain == k) & sweep.along_edge] for k in range(n_teeth)]
    angles = [np.unwrap(np.arctan2(places[:, 1], places[:, 0])) for places in on]
    radius = np.hypot(*on[0][0, :2])
    first, last, middle = angles[0].min(), angles[0].max(), angles[0].min() + angles[0].max()
    gap = 2.0 * np.pi / n_teeth - (last - first)
    close = {"abs": 0.05 * radius * gap + 0.05}
    for share in (0.1, 0.3, 0.45, 0.55, 0.7, 0.9):
        # A crack that this tooth has driven ahead, or which has torn on behind it.
        for end in (last + share * gap, first - share * gap):
            angle = np.array([0.5 * middle, end])
            points = radius * np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
            lead = sweep.lead(points, np.zeros(2, int))
            assert lead == pytest.approx([0.0, share * gap * radius], **close)
            # Of a crack of which nothing is known the nearer tooth counts.
            nearer = min(share, 1.0 - share) * gap * radius
            assert sweep.lead(points[1:]) == pytest.approx([nearer], **close)
