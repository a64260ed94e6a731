"""What the drive has to overcome, for every kind of motion: the figure's work is the tool's."""

from math import cos, pi, sin
from types import SimpleNamespace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from notched_strip import cutting
from shellcut import ScrewMotion, ShellMaterial, Simulation, StraightMotion, TableMotion, read
from shellcut.meshing import disc, rectangle
from shellcut.models import Case
from shellcut.numerics.broken_line import BrokenLine
from shellcut.recording.resistance import COMPONENTS, Resistance, resistance_of
from shellcut.simulation.force_terms import ForceTerms
from shellcut.simulation.ledger import Ledger
from shellcut.tool.coordinate import Coordinate, HasCoordinate
from shellcut.tool.pose import Pose
from shellcut.tool.screw_axis import Axis, Line, kept_axis
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.touch import Booking, Touch

END = 1.0
WRENCHES = np.random.default_rng(5).normal(size=(4, 6))


def table(pose, n=19):
    """Tabulate a motion, given by its rotation vector and place of the body's origin."""
    times = np.linspace(0.0, END, n)
    vectors, places = zip(*[pose(t) for t in times.tolist()], strict=True)
    return TableMotion(times, places, vectors)


def screw_table(*, pitch=6.0, point=(0.0, 0.0), n=19):
    """Turn by 2 rad about z through a point and go down, as a table."""

    def pose(t):
        a, (px, py) = 2.0 * t, point
        place = (px - px * cos(a) + py * sin(a), py - px * sin(a) - py * cos(a))
        return (0.0, 0.0, a), (*place, -pitch * a / (2.0 * pi))

    return table(pose, n)


class Own:
    """A motion of a user's own: no class of the library, its coordinate in the unit given."""

    def __init__(self, motion, unit="rad", coordinate=None):
        self.motion, self.pose, self.coordinate_unit = motion, motion.pose, unit
        self.coordinate = coordinate or motion.coordinate

    def twist(self, time):
        return tuple(part.tolist() for part in self.motion.twist(time))


def coordinate(motion, unit):
    """Return a motion's own coordinate, else the angle or path of the body's origin."""
    if isinstance(motion, HasCoordinate):
        return Coordinate.own(motion, END)
    return (Coordinate.angle if unit == "rad" else Coordinate.path)(motion, END)


def resistance(motion, unit="rad"):
    kept = kept_axis(motion, END)
    unit = "mm" if isinstance(kept, Line) else unit
    return Resistance(motion, kept, coordinate(motion, unit), END)


def power(motion, wrench, time):
    """Return what the tool puts in, the wrench being that on the tool."""
    spin, velocity = motion.twist(time)
    return -float(wrench[:3] @ velocity + wrench[3:] @ spin)


def figures(r, motion, wrench, time):
    return r.of(wrench, motion.pose(time)[1], time)


def check_as(exact, motion, time):
    """Compare what a motion has to overcome with that of another; return the former."""
    wanted, found = resistance(exact), resistance(motion)
    assert found.columns == wanted.columns
    for wrench in WRENCHES:
        # Round-off: the cubics of the table pass through straight and linear data exactly.
        values = figures(wanted, exact, wrench, time)
        assert figures(found, motion, wrench, time) == pytest.approx(values, abs=1e-12)
    return found


def test_a_table_of_a_screw_is_a_screw_wherever_its_axis_is():
    screw = ScrewMotion(angular_speed=2.0, pitch=6.0)
    for motion in (screw_table(), Own(screw)):
        r = check_as(screw, motion, 0.4)
        assert r.columns == [("torque", "N*mm"), ("axial_force", "N")]
        assert r.meaning == "torque about the axis (0, 0, 1) through (0, 0, 0) mm"
    kept = kept_axis(screw_table(point=(7.0, -3.0), pitch=0.0), END)
    assert isinstance(kept, Axis)
    assert kept.direction == (0.0, 0.0, 1.0)
    # Cubic spline through a circle, 6.4 degrees apart: 1e-4 of the radius at its ends.
    assert kept.point == pytest.approx((7.0, -3.0, 0.0), abs=1e-3 * np.hypot(7.0, 3.0))


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (3.0, 0.0, -4.0), (1.0, 2.0, 2.0)])
def test_a_straight_path_has_the_force_along_it(direction):
    straight = StraightMotion(direction, speed=5.0)
    there = straight.pose(END)[1]
    # Not at constant speed: it is the path that must be straight.
    uneven = TableMotion(np.linspace(0.0, END, 5), np.outer([0.0, 0.15, 0.35, 0.65, 1.0], there))
    for motion in (uneven, Own(straight, "mm")):
        assert isinstance(kept_axis(motion, END), Line)
        r = check_as(straight, motion, 0.3)
        assert r.columns == [("force", "N")]
        assert r.meaning == resistance(straight).meaning


@pytest.mark.parametrize("advance", [(1.0, 0.0, -1.0), (1.0, 0.0, 0.0), (0.6, -0.8, 0.1)])
@pytest.mark.parametrize("pitch", [-3.0, 5.0, 40.0])
@pytest.mark.parametrize("given", ["screw", "own", "table", "from a film"])
def test_what_turns_and_moves_on_has_the_axis_about_which_it_turns(advance, pitch, given):
    """A wheel that rolls, however its motion is given: torque and force give its power."""
    exact = ScrewMotion(2.0, pitch=pitch, axis_point=(1.0, 2.0, 0.5), advance=advance)

    def pose(t):
        place = exact.pose(t)
        return (0.0, 0.0, exact.coordinate(t)), place[1]

    motion = {"screw": exact, "table": table(pose, 121)}.get(given, Own(exact))
    stray = 1e-3 if given == "from a film" else 0.0
    found, wanted = (kept_axis(one, END, stray) for one in (motion, exact))
    # Round-off; that of rates by differences; cubics through a circle.
    off = {"screw": 1e-12, "table": 2e-3}.get(given, 1e-9)
    assert found.direction == pytest.approx(wanted.direction, abs=off)
    beside = np.cross(found.direction, np.subtract(found.point, wanted.point))
    assert beside == pytest.approx(np.zeros(3), abs=2.0 * off)
    assert found.drift == pytest.approx(wanted.drift, abs=2.0 * off)
    # A screw keeps the sense of advance that it is given; else it is that of the motion.
    sense = 1.0 if given == "screw" else np.sign(pitch)
    assert np.multiply(sense, found.advance) == pytest.approx(wanted.advance, abs=2.0 * off)
    r = resistance(motion)
    assert "which moves" in r.meaning
    for wrench in WRENCHES:
        torque, force = figures(r, motion, wrench, 0.8)
        by_figures = 2.0 * (torque + sense * force * pitch / (2.0 * pi))
        exactly = power(motion, wrench, 0.8)
        assert by_figures == pytest.approx(exactly, rel=off)


class Given:
    """A term that touches the tool with a wrench given by the time."""

    name = "given"
    booked = (Booking.of_wrench("load_work", 0.0),)

    def __init__(self):
        self.touch = Touch.none(1, 1)

    def add_forces(self, state, pose):
        self.touch.wrench[0] = WRENCHES[0] + WRENCHES[1] * sin(5.0 * state.time)


@pytest.mark.parametrize(
    "motion",
    [
        ScrewMotion(2.0, pitch=5.0, ramp=0.5, axis_point=(1.0, 2.0, 0.0)),
        ScrewMotion(2.0, pitch=5.0, axis_point=(1.0, 2.0, 0.0), advance=(1.0, 0.0, -1.0)),
        Own(ScrewMotion(2.0, pitch=-9.0, axis_point=(1.0, 2.0, 0.0), advance=(1.0, 2.0, 0.0))),
        screw_table(point=(3.0, -1.0)),
    ],
    ids=["screw", "screw aside", "rolling", "table"],
)
def test_torque_and_axial_force_are_summed_over_the_angle_with_every_step(motion):
    r, term = resistance(motion), Given()
    angle_at = coordinate(motion, "rad").at
    terms, ledger = ForceTerms([term], motion), Ledger()
    angle, values = [], []
    for time in np.linspace(0.0, END, 2001).tolist():
        step = END / 2000 if time else 0.0
        state = SimpleNamespace(time=time, dt=step, tick=step)
        pose = Pose.of(*motion.pose(time))
        terms.add_forces(state, pose, ledger)
        angle.append(angle_at(time))
        values.append(r.of(term.touch.wrench[0], pose.translation, time))
    run = {"terms": terms, "tooth_wrenches": terms.wrench, "ledger": ledger}
    sim = SimpleNamespace(**run, pose=pose, state=state, work_in_film=ledger.tool_work)
    row = {name: value for name, _, value in r.row(sim)}
    for (name, _), column in zip(r.columns, np.array(values).T, strict=True):
        # Of the same steps: arc and chord.
        wanted = BrokenLine(np.array(angle), column).integral(0.0, angle[-1])
        assert row[f"{name}_integral"] == pytest.approx(wanted, rel=1e-5)


def tumbling(t):
    return (0.3 * t, sin(t), 1.2 * t), (4.0 * t, t * t, -2.0 * sin(t))


GENERAL = {
    "turns about no axis": (table(tumbling), "torque"),
    "goes around a bend": (
        table(lambda t: ((0.0, 0.0, 0.0), (3.0 * sin(t), 3.0 * cos(t), -t))),
        "force",
    ),
    "turns back": (table(lambda t: ((0.0, 0.0, sin(4.0 * t)), (0.0, 0.0, 0.0))), "torque"),
    "goes and comes": (table(lambda t: ((0.0, 0.0, 0.0), (sin(4.0 * t), 0.0, 0.0))), "force"),
    "a crank": (
        Own(StraightMotion((1.0, 0.0, 0.0), 5.0), "rad", lambda t: 0.2 + t + 0.5 * t * t),
        "torque",
    ),
}


@pytest.mark.parametrize("name", GENERAL)
def test_what_keeps_nothing_has_the_generalised_force_of_its_coordinate(name):
    motion, figure = GENERAL[name]
    assert kept_axis(motion, END) is None
    unit = "rad" if figure == "torque" else "mm"
    r, q = resistance(motion, unit), coordinate(motion, unit).at
    assert r.columns == [(figure, "N*mm" if figure == "torque" else "N")]
    assert r.meaning.startswith(f"generalised {figure}: work of the tool per ")
    for t in (0.11, 0.52, 0.93):
        # The rate by other means and a hundred times farther apart: 1e-8 of it, squared steps.
        d = 1e-4
        rate = (q(t + d) - q(t - d)) / (2.0 * d)
        for wrench in WRENCHES:
            (found,) = figures(r, motion, wrench, t)
            assert found * rate == pytest.approx(power(motion, wrench, t), rel=1e-5, abs=1e-9)


WAY = 17.0
"""Of a blade along x through a film [mm]."""


def resistance_along(poses, origin, n=401):
    """Return that of an upright blade that passes poses, with the body's origin elsewhere in it.

    poses : takes the share of the way; returns rotation vector and place of the cutting edge at the
    height of the film.
    """
    share = np.linspace(0.0, 1.0, n)
    vectors, places = (np.array(part) for part in zip(*map(poses, share.tolist()), strict=True))
    turns = Rotation.from_rotvec(vectors)
    motion = TableMotion(END * share, places + turns.apply(origin), vectors)
    tool = straight_blade(length=30.0, height=6.0).translated(-np.array(origin))
    film = rectangle(20.0, 8.0, size=1.0)
    sim = Simulation(film, ShellMaterial.homogeneous(), tool=tool, motion=motion)
    return resistance_of(sim, 1.1 * END), motion  # it stops before the end of the run


def tilts(s):
    return (0.0, np.radians(5.0) * np.clip(4.0 * s - 3.0, 0.0, 1.0), 0.0), (WAY * s, 0.0, 0.0)


def tilts_evenly(s):
    return (0.0, np.radians(5.0) * s, 0.0), (WAY * s, 0.0, 0.0)


def wobbles(s):
    return (0.0, 0.0, np.radians(0.6) * sin(40.0 * s)), (WAY * s, 0.0, 0.0)


def steered(s):  # along y = 1.5 sin, the blade along its tangent
    return (0.0, 0.0, np.arctan(1.5 * 2.0 * pi / WAY * cos(2.0 * pi * s))), (
        WAY * s,
        1.5 * sin(2.0 * pi * s),
        0.0,
    )


def swings(s):  # by half a degree about a place 2 m above the film
    return (0.0, -WAY / 2000.0 * s, 0.0), (
        2000.0 * sin(WAY / 2000.0 * s),
        0.0,
        2000.0 * (1.0 - cos(WAY / 2000.0 * s)),
    )


@pytest.mark.parametrize("origin", [(0.0, 0.0, 0.0), (0.0, 0.0, 1500.0), (-40.0, 300.0, 20.0)])
@pytest.mark.parametrize("poses", [tilts, tilts_evenly, wobbles, steered, swings])
def test_a_tool_that_keeps_no_axis_is_measured_along_the_path_of_its_edge(poses, origin):
    """Whatever its turn, and wherever its origin is."""
    r, motion = resistance_along(poses, origin)
    assert (r.coordinate_name, r.columns) == ("path", [("force", "N")])
    share = np.linspace(0.0, 1.0, 4001)
    places = np.array([poses(s)[1] for s in share.tolist()])
    path = np.linalg.norm(np.diff(places, axis=0), axis=1).sum()
    assert r.coordinate(END) == pytest.approx(path, rel=2e-3)
    # A force on the edge against its path: 3 N, whatever else turns, until the tool stops.
    for t in (0.3, 0.6, END - 1e-7):
        pose, (spin, velocity) = Pose.of(*motion.pose(t)), motion.twist(t)
        arm = np.array(poses(t)[1]) - pose.translation
        along = velocity + np.cross(spin, arm)
        force = -3.0 * along / np.linalg.norm(along)
        moment = np.cross(arm, force)
        (found,) = r.of(np.concatenate([force, moment]), pose.translation, t)
        assert found == pytest.approx(3.0, rel=5e-3)


@pytest.mark.parametrize(("degrees", "figure"), [(90.0, "torque"), (20.0, "force")])
def test_a_large_turn_in_step_with_the_path_is_a_turn(degrees, figure):
    """Poses of a cap as they are measured: its axis wanders by 0.1 mm, its turn by a fifth."""
    turn = np.radians(degrees)

    def pose(t):
        angle = turn * (t + 0.2 * sin(30.0 * t) / 30.0)
        return (0.0, 0.0, angle), (0.1 * sin(20.0 * t), 0.1 * cos(11.0 * t), -2.0 * t)

    motion, film = table(pose, n=201), disc(10.2, n_side=6, n_layer=4)
    sim = Simulation(film, ShellMaterial.homogeneous(), tool=tooth_ring(), motion=motion)
    r = resistance_of(sim, END)
    assert r.columns == [(figure, "N*mm" if figure == "torque" else "N")]
    path = degrees if figure == "torque" else np.hypot(9.4 * turn, 2.0)
    assert r.coordinate(END) == pytest.approx(path, rel=0.08)


@pytest.mark.parametrize(("degrees", "figure"), [(1.2, "torque"), (0.8, "force")])
def test_a_turn_about_a_fixed_axis_is_one_from_a_degree_on(degrees, figure):
    turn = np.radians(degrees)
    motion, film = (
        table(lambda t: ((0.0, 0.0, turn * t), (0.0, 0.0, 0.0))),
        disc(10.2, n_side=6, n_layer=4),
    )
    sim = Simulation(film, ShellMaterial.homogeneous(), tool=tooth_ring(), motion=motion)
    assert resistance_of(sim, END).columns[0][0] == figure


def test_where_it_rests_the_figure_stays_that_of_when_it_moves():
    motion = table(tumbling)
    r = Resistance(motion, None, Coordinate.angle(motion, 1.5 * END), 1.5 * END)
    for wrench in WRENCHES:
        at_rest = figures(r, motion, wrench, 1.4 * END)
        # The wrench turns with no tool: of the nearest instant looked at, 3 ms before the end.
        at_end = r.of(wrench, motion.pose(END)[1], END - 1e-3)
        assert at_rest == pytest.approx(at_end, rel=0.05, abs=0.05)
    still = TableMotion([0.0, 1.0], [[1.0, 0.0, 0.0]] * 2)
    assert figures(resistance(still, "mm"), still, WRENCHES[0], 0.5) == [0.0]


def test_the_wrench_is_whole_and_about_the_worlds_origin():
    assert [name for name, _ in COMPONENTS] == [
        f"{p}_{c}" for p in ("force", "moment") for c in "xyz"
    ]
    motion, t = table(tumbling), 0.6
    r = resistance(motion)
    spin, velocity = motion.twist(t)
    origin = motion.pose(t)[1]
    at_world_origin = velocity - np.cross(spin, origin)
    for wrench in WRENCHES:
        whole = np.array(r.components(wrench, origin))
        by_whole = whole[:3] @ at_world_origin + whole[3:] @ spin
        assert by_whole == pytest.approx(power(motion, wrench, t), rel=1e-12)
    assert not np.signbit(r.components(np.zeros(6), origin)).any()


def test_a_turning_table_is_told_by_its_torque(tmp_path):
    # 20 mm from its axis, far beside the strip, the blade moves nearly straight: 1.6 mm.
    times, radius = np.linspace(0.0, 1e-4, 41), 20.0
    a = 2e4 / radius * times
    path = np.stack([radius * np.sin(a), radius - radius * np.cos(a), 0.0 * a], axis=1)
    motion = TableMotion(times, path, np.stack([0.0 * a, 0.0 * a, a], axis=1))
    sim = cutting(motion=motion, pulled=False)
    records = {"n_row": 400, "n_frame": 2, "n_snapshot": 0, "curves": False, "progress": False}
    Case("turned", sim, 8e-5).run(tmp_path, **records)
    results = read(tmp_path)
    h = results.history
    assert (results.coordinate_name, results.resistance_name) == ("angle", "torque")
    assert results.resistance_unit == "N*mm"
    assert {name for name, _ in COMPONENTS} <= h.keys()
    # The sums over every step differ by arc and chord of a step.
    assert h["torque_integral"] == pytest.approx(h["tool_work"], rel=1e-6)
    largest = np.abs(h["torque"]).max()
    assert largest > 1.0
    # About z, 20 mm beside the world's origin.
    torque = h["moment_z"] + 20.0 * h["force_x"]
    assert torque == pytest.approx(h["torque"], rel=1e-3, abs=1e-3 * largest)
