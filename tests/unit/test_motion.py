"""Prescribed motions: end values, and twists against differences of poses."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import PchipInterpolator
from scipy.spatial.transform import Rotation

from shellcut.formats.errors import FileError
from shellcut.tool.coordinate import Coordinate, HasCoordinate
from shellcut.tool.motion import Motion, ScrewMotion, StraightMotion
from shellcut.tool.table_motion import TableMotion

DURATION = 6.0e-3


def table(n=9, seed=5):
    rng = np.random.default_rng(seed)
    times = np.linspace(0.0, 1.0, n) ** 1.3
    return times, rng.normal(size=(n, 3)), np.cumsum(0.4 * rng.normal(size=(n, 3)), axis=0)


TILTED = ScrewMotion(
    angular_speed=300.0,
    pitch=12.0,
    ramp=1e-3,
    axis=(1.0, 2.0, 3.0),
    axis_point=(1.0, -2.0, 0.5),
    advance=(0.0, 1.0, -1.0),
)
MOTIONS = [
    (ScrewMotion.over(angle_deg=95.0, duration=DURATION, pitch=12.0), 1e-3),
    (TILTED, 1e-3),
    (StraightMotion((1.0, 1.0, 0.0), speed=6000.0, ramp=1e-3), 1e-3),
    (TableMotion(*table()), 1.0),
    (TableMotion(*table()[:2]), 1.0),
    (TableMotion([0.0, 1.0], np.zeros((2, 3)), [[0.0, 0.0, 0.0], [0.0, 1e-5, 0.0]]), 1.0),
]


@pytest.mark.parametrize(("motion", "scale"), MOTIONS)
@pytest.mark.parametrize("part", [0.03, 0.13, 0.58, 0.96])
def test_pose_is_a_rotation_and_twist_and_speed_are_its_rate(motion, scale, part):
    checked: Motion = motion
    time, h = part * scale, 2e-5 * scale
    rotation, origin = checked.pose(time)
    np.testing.assert_allclose(rotation @ rotation.T, np.eye(3), atol=1e-14)
    assert np.linalg.det(rotation) == pytest.approx(1.0)
    assert (rotation.shape, origin.shape) == ((3, 3), (3,))

    def rate(of):  # fourth-order central difference
        at = {k: of(time + k * h) for k in (-2, -1, 1, 2)}
        return (8.0 * (at[1] - at[-1]) - (at[2] - at[-2])) / (12.0 * h)

    spin_matrix = rate(lambda t: motion.pose(t)[0]) @ rotation.T
    spin = [spin_matrix[2, 1], spin_matrix[0, 2], spin_matrix[1, 0]]
    angular_velocity, velocity = motion.twist(time)
    np.testing.assert_allclose(angular_velocity, spin, rtol=1e-6, atol=1e-9 / scale)
    np.testing.assert_allclose(velocity, rate(lambda t: motion.pose(t)[1]), rtol=1e-6, atol=1e-9)
    if isinstance(motion, HasCoordinate):
        speed = np.linalg.norm(angular_velocity if motion.coordinate_unit == "rad" else velocity)
        assert rate(motion.coordinate) == pytest.approx(speed, rel=1e-8)


class TestScrew:
    def test_a_screw_reaches_its_angle_and_advances_by_its_pitch(self):
        screw = ScrewMotion.over(angle_deg=95.0, duration=DURATION, pitch=12.0)
        assert screw.coordinate(DURATION) == pytest.approx(np.radians(95.0), rel=1e-14)
        assert screw.ramp == pytest.approx(0.03 * DURATION)
        # the ramp covers half of its part
        assert screw.coordinate(screw.ramp) == pytest.approx(0.5 * screw.ramp * screw.angular_speed)
        assert screw.twist(2.0 * DURATION)[0][2] == screw.angular_speed
        rotation, origin = screw.pose(-1.0)
        np.testing.assert_array_equal(rotation, np.eye(3))
        np.testing.assert_array_equal(origin, np.zeros(3))
        assert not np.any(screw.twist(-1.0))
        assert screw.coordinate(-1.0) == 0.0
        rotation, origin = ScrewMotion(angular_speed=0.5 * np.pi, pitch=12.0).pose(1.0)
        np.testing.assert_allclose(origin, [0.0, 0.0, -3.0], rtol=1e-14)
        np.testing.assert_allclose(rotation @ [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], atol=1e-15)

    def test_points_of_the_axis_only_advance(self):
        rotation, origin = TILTED.pose(2e-3)
        angle = TILTED.coordinate(2e-3)
        point = np.array(TILTED.axis_point) + 0.7 * np.array(TILTED.axis)
        advance = 12.0 * angle / (2.0 * np.pi) * np.array([0.0, 1.0, -1.0]) / np.sqrt(2.0)
        np.testing.assert_allclose(rotation @ point + origin - point, advance, atol=1e-14)


def test_a_straight_motion():
    motion = StraightMotion((0.0, 3.0, 4.0), speed=10.0, ramp=0.2)
    assert motion.coordinate(1.0) == pytest.approx(9.0)
    rotation, origin = motion.pose(1.0)
    np.testing.assert_allclose(origin, [0.0, 5.4, 7.2])
    np.testing.assert_array_equal(rotation, np.eye(3))
    np.testing.assert_allclose(motion.twist(1.0)[1], [0.0, 6.0, 8.0])
    assert StraightMotion((1.0, 0.0, 0.0), speed=10.0).twist(0.0)[1][0] == 10.0


class TestTable:
    def test_along_a_line_it_is_the_monotone_cubic_of_scipy(self):
        times, z = table()[0], np.array([0.0, 1.0, 3.0, 3.0, 2.0, 2.5, 4.0, 7.0, 8.0])
        way = np.array([2.0, -1.0, 2.0]) / 3.0
        motion, cubic = TableMotion(times, z[:, None] * way), PchipInterpolator(times, z)
        for time in np.linspace(0.0, 1.0, 200):
            if times[1] < time < times[-2]:  # at the ends other rules hold
                np.testing.assert_allclose(motion.pose(time)[1], cubic(time) * way, atol=1e-12)

    @pytest.mark.parametrize(
        ("times", "places"),
        [((0.0, 0.1, 1.0, 3.0), (0, 0, 5, 5)), ((0, 1, 2, 3), (0, 5, 5, 0)), ((0, 1), (0, 5))],
    )
    @pytest.mark.parametrize("turns", [False, True])
    def test_it_stays_between_its_entries(self, times, places, turns):
        rows = np.array(places)[:, None] * [[0.0, 0.6, 0.8]]
        moved = (np.zeros_like(rows), 0.4 * rows) if turns else (rows,)
        motion = TableMotion(times, *moved)
        path = np.abs(np.diff(places)).sum() * (0.4 if turns else 1.0)
        travel = (Coordinate.angle if turns else Coordinate.path)(motion, times[-1])
        # Entries between two of the 2,000 times at which the speed is summed.
        assert travel.at(times[-1]) == pytest.approx(path, rel=1e-5)
        if not turns:
            far = [motion.pose(time)[1] @ [0.0, 0.6, 0.8] for time in np.linspace(0, times[-1], 99)]
            assert min(far) > -1e-12
            assert max(far) < 5.0 + 1e-12

    def test_points_of_a_circle_give_it_to_third_order(self):
        def off(n):
            angle = np.linspace(0.0, 2.0, n + 1)
            motion = TableMotion(angle, np.stack([np.cos(angle), np.sin(angle), 0 * angle], axis=1))
            places = np.array([motion.pose(time)[1] for time in np.linspace(0.0, 2.0, 301)])
            return np.abs(np.linalg.norm(places, axis=1) - 1.0).max()

        assert off(20) < 6e-5
        assert off(40) < off(20) / 7.0

    def test_turned_entries_give_turned_poses(self):
        times, translations, vectors = table()
        Q, turned = Rotation.from_rotvec([0.3, -1.0, 0.5]), Rotation.from_rotvec(vectors)
        here = TableMotion(times, translations, vectors)
        there = TableMotion(times, Q.apply(translations), (Q * turned).as_rotvec(), unwrap=True)
        for time in np.linspace(0.0, 1.0, 41):
            (R, r), (S, s) = here.pose(time), there.pose(time)
            np.testing.assert_allclose(S, Q.as_matrix() @ R, atol=1e-12)
            np.testing.assert_allclose(s, Q.apply(r), atol=1e-12)

    def test_it_passes_its_entries_without_a_jump_of_velocity(self):
        times, translations, vectors = table()
        motion = TableMotion(times, translations, vectors)
        for i, time in enumerate(times[1:-1].tolist(), 1):
            rotation, origin = motion.pose(time)
            np.testing.assert_allclose(origin, translations[i], atol=1e-12)
            exact = Rotation.from_rotvec(vectors[i]).as_matrix()
            np.testing.assert_allclose(rotation, exact, atol=1e-12)
            for low, high in zip(motion.twist(time - 1e-9), motion.twist(time), strict=True):
                np.testing.assert_allclose(low, high, atol=1e-5)

    def test_end_poses_are_held_at_rest_outside_and_copies_are_kept(self):
        times, translations, vectors = table()
        motion = TableMotion(times, translations, vectors)
        for outside, end in ((-1.0, 0), (3.0, -1)):
            rotation, origin = motion.pose(outside)
            np.testing.assert_allclose(origin, translations[end], atol=1e-12)
            expected = Rotation.from_rotvec(vectors[end]).as_matrix()
            np.testing.assert_allclose(rotation, expected, atol=1e-12)
            assert not np.any(motion.twist(outside))
        assert np.any(motion.twist(times[-1]))
        times[0] = -9.0
        assert motion.times[0] == 0.0
        with pytest.raises(ValueError, match="read-only"):
            motion.translations[0, 0] = 1.0

    @pytest.mark.parametrize("axis", [(0.0, 0.0, 1.0), (2.0, -1.0, 2.0)])
    @pytest.mark.parametrize(
        "angles",
        [
            *((0, 360), (0, 494), (0, -270), (0, 180), (170, -170), (30, 400, 350)),
            *((0, 10, 20, 3620, 3600), (0, 134, 270, 630)),
        ],
    )
    def test_rows_about_one_axis_turn_by_their_difference(self, axis, angles):
        way, angle = np.array(axis) / np.linalg.norm(axis), np.radians(angles)
        times = np.arange(len(angles), dtype=float)
        motion = TableMotion(times, np.zeros((len(angles), 3)), angle[:, None] * way)
        for low, high in pairwise(times):
            spins = [motion.twist(t)[0] for t in np.linspace(low, high, 4001)[:-1] + 1.25e-4]
            np.testing.assert_allclose(np.cross(spins, way), 0.0, atol=1e-9 * np.abs(angle).max())
            turned = float(np.dot(spins, way).mean()) * (high - low)
            assert turned == pytest.approx(angle[int(high)] - angle[int(low)], rel=1e-5)
        for time, at in zip(times, angle, strict=True):
            exact = Rotation.from_rotvec(at * way).as_matrix()
            np.testing.assert_allclose(motion.pose(time)[0], exact, atol=1e-11)

    def test_a_large_turn_stops_where_its_axis_changes(self):
        vectors = [[0, 0, 0], [0, 0, 4 * np.pi], [0, 0, 0], [0, 0.5, 0], [0, 1.0, 0], [0, 8.0, 0]]
        motion = TableMotion(np.arange(6.0), np.zeros((6, 3)), vectors)
        travel = Coordinate.angle(motion, 5.0)
        for i, done in enumerate((0.0, 4 * np.pi, 8 * np.pi, 8 * np.pi + 0.5)):
            assert travel.at(i) == pytest.approx(done, rel=1e-5)
        np.testing.assert_allclose(motion.twist(2.0)[0], 0.0, atol=1e-12)
        vectors = [[0, 0, 0], [0, 0, 4 * np.pi], [0, 0, 0], [0, 0.3, -0.3]]  # a corner of 45°
        bent = TableMotion(np.arange(4.0), np.zeros((4, 3)), vectors)
        np.testing.assert_allclose(bent.twist(2.0)[0], 0.0, atol=1e-12)
        for time in [*np.linspace(0.1, 4.9, 77), 1.0, 2.0, 3.0, 4.0]:
            for low, high in zip(motion.twist(time - 1e-9), motion.twist(time), strict=True):
                np.testing.assert_allclose(low, high, atol=1e-4)

    @pytest.mark.parametrize(
        ("angles", "way"), [((359, 1, 3), 4), ((-178, 179), -3), ((5, 715), -10)]
    )
    def test_angles_that_wrap_go_the_shorter_way_by_a_key(self, angles, way):
        vectors = np.radians(angles)[:, None] * [0.0, 0.6, 0.8]
        zeros, times = np.zeros((len(angles), 3)), np.arange(len(angles), dtype=float)
        motion = TableMotion(times, zeros, vectors, unwrap=True)
        travel = Coordinate.angle(motion, times[-1])
        assert travel.at(times[-1]) == pytest.approx(np.radians(abs(way)), rel=1e-6)
        assert motion.leap is None
        assert np.sign(motion.twist(0.5)[0][2]) == np.sign(way)
        with pytest.raises(ValueError, match=r"with unwrap, got 170\.0 from entry 0 to 1"):
            TableMotion(
                [0.0, 1.0], np.zeros((2, 3)), [[0, 0, 0], [0, 0, np.radians(170)]], unwrap=True
            )

    @pytest.mark.parametrize(
        ("angles", "leap"),
        [
            *(((355, 357, 359, 1, 3), 2), ((3, 1, 359), 1), ((0, 350, 20), None)),
            *(((0, 720), None), ((0, 200, 400), None), ((0, 1, 2, 300), None)),
        ],
    )
    def test_a_jump_of_a_sensor_is_seen(self, angles, leap):
        vectors = np.radians(angles)[:, None] * [0.0, 0.0, 1.0]
        times = np.arange(len(angles), dtype=float)
        assert TableMotion(times, np.zeros((len(angles), 3)), vectors).leap == leap


LINE, TURNS = np.zeros((3, 3)), [[0, 0, 0], [0, 0, 1], [0, 3, 0]]


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: ScrewMotion(1.0, axis=(0.0, 0.0, 0.0)), "axis must not be zero: it is a dir"),
        (lambda: ScrewMotion(1.0, advance=(0.0, 0.0, 0.0)), "advance must not be zero"),
        (lambda: ScrewMotion(1.0, axis_point=(0.0, np.nan, 0.0)), "must be three finite numbers"),
        (lambda: StraightMotion((0.0, 0.0, 0.0), speed=1.0), "direction must not be zero"),
        (lambda: TableMotion([0.0], LINE[:1]), r"times must have shape \(n_time,\) with at least"),
        (lambda: TableMotion([0, 1, 1], LINE), "times must increase, entry 2 is 1 after 1 s"),
        (lambda: TableMotion([0, 1], LINE), r"translations must have shape \(2, 3\), got \(3, 3\)"),
        (lambda: TableMotion([0, 1], LINE[:2], np.zeros((2, 4))), r"vectors must have shape \(2"),
        (lambda: TableMotion([0, 1], [[0, 0, 0], [0, np.inf, 0]]), "must be finite, entry 1"),
        (
            lambda: TableMotion([0, 1, 2], LINE, TURNS),
            r"where the axis changes, got 181.2 from entry 1 to 2: add entries .* or unwrap",
        ),
    ],
)
def test_motions_that_cannot_be_are_refused(build, message):
    with pytest.raises(ValueError, match=message):
        build()


def table_of(tmp_path, text):
    path = tmp_path / "motion.csv"
    path.write_text(text, encoding="utf-8", newline="")
    return TableMotion.read_csv(path)


@pytest.mark.parametrize(
    "text",
    [
        "time [s],z [mm],angle [deg]\n0,0,0\n0.001,-0.5,90\n0.002,-1,180\n",
        "# a press\ntime [ms]; angle [deg]; z [um]\n0,0; 0; 0\n1,0; 90; -500,0\n2; 180; -1e3\n",
        "Time (ms)\tAngle (turn)\tZ (cm)\n0\t0\t0\n1\t0,25\t-0,05\n2\t0,5\t-0,1\n",
        "\ufefftime / us,rz / rad,z / m\r\n\r\n0,0,0\r\n1000,1.5707963267948966,-5e-4\r\n"
        "2000,3.141592653589793,-1e-3\r\n",
        '"time [s]","z [mm]","rz [deg]"\n"0","0","0"\n"0.001","-0.5","90"\n"0.002","-1","180"\n',
    ],
)
def test_headings_units_separators_and_decimal_commas(tmp_path, text):
    motion = table_of(tmp_path, text)
    np.testing.assert_allclose(motion.times, [0.0, 1e-3, 2e-3], rtol=1e-15)
    np.testing.assert_allclose(motion.translations, [[0, 0, z] for z in (0.0, -0.5, -1.0)])
    np.testing.assert_allclose(
        motion.rotation_vectors, [[0, 0, a] for a in (0.0, np.pi / 2, np.pi)], rtol=1e-15
    )


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("# nothing\n", "a line of headings"),
        ("time [s],w [mm]\n0,0\n", "got 'w [mm]'"),
        ("time [h]\n0\n", "time must be a unit of time (ns, us, ms, s, min), got 'h'"),
        ("time [s],time [ms]\n0,0\n", "each column must occur once, got time again"),
        ("x [mm]\n0\n", "there must be a column time"),
        ("time [s],angle [deg],rz [deg]\n0,0,0\n", "as angle or as rx, ry, rz, got both"),
        ("time [s],z [mm]\n0,0\n", "two lines of numbers or more, got 1"),
        ("time [s],z [mm]\n0,0\n1\n", "line 3: there must be 2 numbers, got 1"),
        ("time [s],z [mm]\n0,0\n1,x\n", "line 3: must be a number, got 'x'"),
        ("time [s],z [mm]\n0,0\n0,1\n", "times must increase"),
    ],
)
def test_refusals(tmp_path, text, words):
    with pytest.raises(FileError) as refused:
        table_of(tmp_path, text)
    assert words in str(refused.value)
