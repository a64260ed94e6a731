"""A film that its supports move is cut as one at rest is by a tool that moves likewise to it.

The tool cuts with one motion as seen from the film, whose share is the film's. Values per length or
angle, windows, checks and verdicts are those of the mirror case, a film at rest.
"""

from functools import cache
from math import cos, sin

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import shellcut as sc
from films import free_film
from shellcut.meshing import rectangle
from shellcut.models import Case
from shellcut.tool.pose_of_motion import rate_of_pose
from shellcut.tool_shapes import straight_blade

SPEED, TURN = 6000.0, 600.0
"""Of a blade as seen from the film, along a line [mm/s] or in a circle [rad/s]."""
RADIUS = 10.0
"""Of that circle [mm]."""
ALONG, ROUND = 5.6 / SPEED, 0.56 / TURN
"""Ends of the cuts [s]."""
LAW = {"strength": 18.0, "plateau": 12.0, "opening_a": 0.2, "opening_p": 0.6, "opening_u": 0.8}


class Steady:
    """A steady rigid motion about and along z and across it."""

    def __init__(self, spin=0.0, velocity=(0.0, 0.0, 0.0), unit="mm"):
        self.spin, self.velocity = np.array([0.0, 0.0, spin]), np.array(velocity)
        self.coordinate_unit = unit

    def pose(self, time):
        return Rotation.from_rotvec(self.spin * time).as_matrix(), self.velocity * time

    def twist(self, time):
        return self.spin, self.velocity

    def coordinate(self, time):
        of_unit = self.spin if self.coordinate_unit == "rad" else self.velocity
        return float(np.linalg.norm(of_unit)) * time

    def supports(self, mesh, held):
        """Return what moves nodes so, each with the film that it holds."""

        def rate(node, axis):
            (x, y, _), turning = mesh.nodes[node], float(self.spin[2])

            def at(time):
                c, s = cos(turning * time), sin(turning * time)
                return self.velocity[axis] + turning * (-s * x - c * y, c * x - s * y, 0.0)[axis]

            return at

        axes = "xyz" if self.spin.any() or self.velocity.any() else ""
        return [
            sc.Support([i], rotation="", velocity={a: rate(i, "xyz".index(a)) for a in axes})
            for i in held
        ]

    def start(self, mesh):
        velocity = self.velocity + np.cross(self.spin, mesh.nodes)
        return velocity if velocity.any() else None


def bent(points):
    """Return points of a straight strip, (n, 3), on one that is bent in its plane: x is an arc."""
    angle, r = points[:, 0] / RADIUS, RADIUS - points[:, 1]
    return np.column_stack([r * np.cos(angle), r * np.sin(angle), points[:, 2]])


def cut(folder, film, tool, until, round_it=False):
    """Run a short cut along a strip, straight or bent; return its results and its check."""
    mesh = rectangle(8.0, 4.8, size=0.8)
    held = [int(i) for i in (*mesh.node_set("bottom"), *mesh.node_set("top"))]
    blade = straight_blade(edge_angle_deg=60.0, length=1.5, height=6.0)
    blade, notch = blade.translated((-0.05, 0.0, 0.0)), np.array([(0.0, 0.1, 0.0), (1.2, 0.0, 0.0)])
    if round_it:
        mesh = sc.Mesh.from_arrays(bent(mesh.nodes), mesh.quads)
        x, y, z = blade.vertices.T
        places = np.column_stack([RADIUS - y, x, z])
        blade = sc.Tool.from_triangles(places, blade.triangles, edges=blade.edges)
        notch = bent(notch)
    sim = free_film(
        mesh,
        supports=film.supports(mesh, held),
        tool=blade,
        motion=tool,
        law=sc.CohesiveLaw(**LAW),
        velocity=film.start(mesh),
        damping_alpha=0.0,
        damping_beta=5e-8,
        imperfection=0,
    )
    sim.notch(*notch)
    case = Case("cut", sim, until)
    case.run(folder, n_row=400, n_frame=2, n_snapshot=0, curves=False, progress=False)
    return sc.read(folder), case.check


def straight(share, aside=0.0):
    """Return the motions of film and tool of a cut along x, the film also going aside [mm/s]."""
    film = Steady(velocity=(-share * SPEED, aside, 0.0))
    return film, Steady(velocity=((1.0 - share) * SPEED, aside, 0.0))


def round_about(share, aside=0.0):
    """Return those of a cut round about z, the tool also going down."""
    film = Steady(-share * TURN, (aside, 0.0, 0.0))
    down = (aside, 0.0, -2.0 * TURN)  # 2 mm per radian
    return film, Steady((1.0 - share) * TURN, down, "rad")


@pytest.fixture(scope="module")
def mirror(tmp_path_factory):
    """Return the mirror cases, each run once: a film at rest, cut along it or round about."""

    @cache
    def of(round_it):
        motions, until = (round_about(0.0), ROUND) if round_it else (straight(0.0), ALONG)
        return cut(tmp_path_factory.mktemp("mirror"), *motions, until, round_it)

    return of


def compare(found, wanted, round_it):
    """Compare a run and its check with the mirror case."""
    (one, check), (other, mirror) = found, wanted
    h, g = one.history, other.history
    assert list(h)[1:3] == list(g)[1:3] == (["angle", "torque"] if round_it else ["path", "force"])
    rate = np.degrees(TURN) if round_it else SPEED
    np.testing.assert_allclose(h[list(h)[1]], rate * h["time"], rtol=1e-9)  # round-off
    # Run-to-run scatter: a node that touches a step sooner.
    for name, rtol in {
        "cohesive_work": 5e-3,
        "crack_length": 5e-3,
        "cut_length_edge_1": 0.02,
    }.items():
        np.testing.assert_allclose(h[name][-1], g[name][-1], rtol=rtol, err_msg=name)
    work = g["tool_work"][-1]
    both = h["tool_work"] + h["support_work"]
    # Tool and supports do the work of the cut, but for the momentum that the film has taken up.
    np.testing.assert_allclose(both[-1], work, rtol=0.01)
    sums = ("torque_integral", "axial_force_integral") if round_it else ("force_integral",)
    for name in sums:
        whole = g[name][-1] if name in g else work
        # The axial force of this blade is none: what is left is compared with the work.
        off = 5e-3 * work if name.startswith("axial") else 0.0
        np.testing.assert_allclose(h[name][-1], whole, rtol=5e-3, atol=off, err_msg=name)
    s, t = one.summary, other.summary
    if not round_it:  # the bent strip swings: instants, and lines close to their limit, differ
        np.testing.assert_allclose(s["force_peak_N"], t["force_peak_N"], rtol=0.05)
        assert [line["kind"] for line in s["verdict"]] == [line["kind"] for line in t["verdict"]]
    np.testing.assert_allclose(s["kinetic_rel"], t["kinetic_rel"], rtol=0.1)
    for name in ("window_from_mm", "window_to_mm"):
        assert (name in s) == (name in t)
        np.testing.assert_allclose(s.get(name, 0.0), t.get(name, 0.0), atol=0.05)
    for name in ("force_plateau_N", "dWcoh_ds_N", "dW_ds_N"):
        np.testing.assert_allclose(s.get(name, 0.0), t.get(name, 0.0), rtol=0.01)
    np.testing.assert_allclose(s["crack_lead_mm"], t["crack_lead_mm"], atol=0.1)
    assert list(map(str, check.findings)) == list(map(str, mirror.findings))
    assert [fate.stays for fate in check.sweep.fates] == [f.stays for f in mirror.sweep.fates]
    np.testing.assert_allclose(check.sweep.place, mirror.sweep.place, atol=1e-9)
    assert check.sweep.top_speed == pytest.approx(mirror.sweep.top_speed, rel=1e-9)
    return s


SHARES = (0.5, 1.0, 1.5, -0.5)


@pytest.mark.parametrize(
    ("share", "aside"),
    [
        (1.0, 0.0),
        *(pytest.param(share, 0.0, marks=pytest.mark.slow) for share in SHARES if share != 1.0),
        pytest.param(0.0, -2000.0, marks=pytest.mark.slow),
        pytest.param(0.5, 3000.0, marks=pytest.mark.slow),
    ],
)
def test_a_film_that_comes_to_the_blade_is_cut_as_one_at_rest(tmp_path, mirror, share, aside):
    found = cut(tmp_path, *straight(share, aside), ALONG)
    summary = compare(found, mirror(False), round_it=False)
    assert "force along (1, 0, 0), as seen from the film" in summary["resistance"]


@pytest.mark.slow
@pytest.mark.parametrize(("share", "aside"), [*((share, 0.0) for share in SHARES), (0.0, 1000.0)])
def test_a_film_that_turns_under_the_teeth_is_cut_as_one_at_rest(tmp_path, mirror, share, aside):
    found = cut(tmp_path, *round_about(share, aside), ROUND, round_it=True)
    summary = compare(found, mirror(True), round_it=True)
    assert "torque about the axis (0, 0, 1) through (0, 0, 0) mm" in summary["resistance"]


@pytest.mark.parametrize("film_turns", [0.0, 400.0])
@pytest.mark.parametrize("tool_turns", [0.0, -900.0])
def test_the_motion_seen_from_the_film_has_the_rate_of_its_pose(film_turns, tool_turns):
    mesh = rectangle(4.0, 2.0, size=1.0)
    film = Steady(film_turns, (300.0, -700.0, 50.0))
    along = sc.StraightMotion((0.0, 1.0, 0.2), 900.0)
    screw = sc.ScrewMotion(-tool_turns or 1.0, pitch=2.0, axis_point=(1.0, 3.0, 0.0))
    held = [int(i) for i in (*mesh.node_set("bottom"), *mesh.node_set("top"))]
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=film.supports(mesh, held),
        tool=straight_blade(length=1.5, height=2.0).translated((0.0, 0.0, 9.0)),
        motion=screw if tool_turns else along,
        velocity=film.start(mesh),
    )
    seen = sim.motion_in_film
    for time in (2.3e-4, 5.1e-4, 8.7e-4):
        spin, velocity = seen.twist(time)
        rate = rate_of_pose(seen, time, 1e-7)
        assert spin == pytest.approx(rate[:3], abs=1e-2)
        # Of poses between ticks: 2e-4 of the speed.
        assert velocity == pytest.approx(rate[3:], abs=2.0)
