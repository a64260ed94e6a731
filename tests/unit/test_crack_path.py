"""Which way cracks go: asked for, needed by another option, or best for the mesh."""

import numpy as np
import pytest

import shellcut as sc
from films import cut_by, free_film, pieces
from shellcut import Fracture, Recorder, StraightMotion, guillotine, opening_test
from shellcut.checks.row import lies_under
from shellcut.checks.sweep import Sweep
from shellcut.mesh.structured import opening_disc, rectangle
from shellcut.models import free_cut
from shellcut.models.free_cut import with_path
from shellcut.recording.resistance import resistance_of
from shellcut.recording.status_line import start_lines
from shellcut.tool.shapes import straight_blade, tooth_ring

SIDES = [sc.Support.clamped("bottom"), sc.Support.clamped("top")]


ALONG = StraightMotion((1.0, 0.0, 0.0), 6000.0)
SCREW = sc.ScrewMotion.over(angle_deg=60.0, duration=4e-3, pitch=12.0)


def blade(y=0.0, length=12.0):
    """A blade that stands just before the rim of a strip."""
    return straight_blade(length=length, height=3.0).translated((-0.05, y, 0.0))


def by_hand(**options):
    """A blade before a strip whose rows do not care for it."""
    film = rectangle(4.0, 2.4, n_x=5, n_y=3)
    return cut_by(blade(length=4.0), film, 6000.0, **{"fracture": None} | options)


def notched(mesh, tool=None, motion=ALONG, duration=1e-3, notch=2.0, supports=SIDES):
    """The case of a notched film, and the tips of its notch."""
    case = free_cut(
        mesh, tool=tool or blade(), motion=motion, duration=duration, notch=notch, supports=supports
    )
    sim = case.simulation
    return case, sim.cracks.at_tips(sim.mesh.nodes)


@pytest.mark.parametrize(
    "option",
    [
        {"criterion": "stress"},
        {"blade_cut": False},
        {"turn_limit_deg": 80.0},
        {"equilibrium_start": True},
    ],
)
def test_what_exists_along_edges_only_asks_for_them(option):
    assert Fracture(**option).decided().path == "edges"
    (name,) = option
    with pytest.raises(ValueError, match=f"path = 'free' fits {name} = "):
        Fracture(path="free", **option)
    sim = by_hand(fracture=Fracture(**option))
    assert sim.fracture.path == "edges"
    said = "\n".join(start_lines(sim, resistance_of(sim, 1e-4), 1e-4))
    assert f'(fracture.path = "edges"), because of {name} = ' in said


def test_what_exists_through_quads_only_asks_for_them():
    option = {"anisotropy": sc.Anisotropy(direction=(1.0, 0.0, 0.0))}
    assert Fracture(**option).needed_path == Fracture(**option).decided().path == "free"
    for other, said in (
        ({"path": "edges"}, "through the quads only: take path='free'"),
        ({"criterion": "stress"}, r"leave out criterion.*sides only, or .*for cracks thr"),
    ):
        with pytest.raises(ValueError, match=said):
            Fracture(**other, **option)


def test_every_wrong_option_is_named():
    with pytest.raises(ValueError, match=r"criterion = 'force' only, got 'stress'.*turn_limit_deg"):
        Fracture(path="free", criterion="stress", turn_limit_deg=80.0)
    with pytest.raises(ValueError, match="path must be 'free' or 'edges', got 'imprint'"):
        Fracture(path="imprint")


@pytest.mark.parametrize("path", [None, "edges"])
def test_start_and_summary_say_which_way_cracks_go(path, tmp_path):
    sim = by_hand(fracture=path and Fracture(path=path))
    path = path or "free"
    assert sim.inputs["fracture"] == sim.fracture == Fracture(path=path)
    said = "\n".join(start_lines(sim, resistance_of(sim, 1e-4), 1e-4))
    assert ("\ncracks through the quads of the mesh" in f"\n{said}") == (path == "free")
    options = {"n_snapshot": 0, "n_frame": 2, "progress": False}
    recorder = Recorder(sim, tmp_path, until=1e-6, name="cut", **options)
    sim.run(1e-6, [recorder])
    assert sc.read(tmp_path).summary["crack_path"] == path


def test_the_opening_test_follows_edges_where_they_lie_under_the_whole_path():
    beside = tooth_ring(radius=9.0)
    for options, path in (({}, "edges"), ({"tool": beside}, "free")):
        sim = opening_test("quick", **options).simulation
        assert sim.fracture.path == path
        np.testing.assert_array_equal(sim.mesh.nodes, opening_disc("quick").nodes)
    needs_edges = Fracture(turn_limit_deg=80.0)
    case = opening_test("quick", tool=beside, fracture=needs_edges)
    assert case.simulation.fracture == Fracture(path="edges", turn_limit_deg=80.0)
    assert any("a row of sides of quads must lie" in str(found) for found in case.check.findings)


def test_the_guillotine_follows_edges_where_they_lie_under_the_whole_path():
    strip = {"size": 0.8, "length": 8.0, "notch": 1.6, "travel": 2.0}
    assert guillotine(width=4.8, **strip).simulation.fracture.path == "edges"
    between = guillotine(width=4.0, **strip).simulation
    assert between.fracture.path == "free"
    through = guillotine(width=4.8, fracture=Fracture(path="free"), **strip).simulation
    for sim in (between, through):
        np.testing.assert_allclose(sim.cracks.at_tips(sim.mesh.nodes), [[1.6, 0, 0]])
    with pytest.raises(ValueError, match=r"make width / size even, take fracture\.path = 'free'"):
        guillotine(width=4.0, fracture=Fracture(path="edges"), **strip)


@pytest.mark.parametrize(("mesh", "angle_deg"), [("quick", 5.0), ("M1", 95.0), ("M2", 20.0)])
def test_a_ring_is_a_row_within_a_two_hundredth_of_an_edge(mesh, angle_deg):
    duration = 6e-3 * angle_deg / 95.0
    screw = sc.ScrewMotion.over(angle_deg=angle_deg, duration=duration, pitch=12.0)
    disc, h = opening_disc(mesh), 2.0 * np.pi * 9.4 / {"quick": 72, "M1": 152, "M2": 276}[mesh]
    for off, under in ((0.0, True), (0.001, True), (0.01, False), (-0.01, False), (0.3, False)):
        tool = tooth_ring(radius=9.4 + off * h, phase_deg=7.3)
        assert lies_under(Sweep.of(disc, tool, screw, duration)) is under


@pytest.mark.parametrize("angle_deg", [0.5, 6.0, 95.0])
@pytest.mark.parametrize("radius", [9.4, 9.0])
def test_the_length_of_a_run_does_not_choose_where_cracks_go(angle_deg, radius):
    duration = 6e-3 * angle_deg / 95.0
    screw = sc.ScrewMotion.over(angle_deg=angle_deg, duration=duration, pitch=12.0)
    tool, disc = tooth_ring(radius=radius, phase_deg=7.3), opening_disc("quick")
    times = np.linspace(0.0, duration, 20)
    vectors = np.array([[0.0, 0.0, screw.coordinate(time)] for time in times])
    table = sc.TableMotion(times, [screw.pose(time)[1] for time in times], vectors)
    for motion in (screw, table)[: 1 + (angle_deg >= 1.0)]:  # to 0.5° this table meets no film
        path = with_path(disc, tool, motion, duration, None).path
        assert path == ("edges" if radius == 9.4 else "free")


def test_a_row_that_ends_beyond_the_run_is_none():
    short, long = rectangle(6.0, 4.0, size=0.5), rectangle(12.0, 4.0, size=0.5)
    bent = long.nodes + [[0.0, 0.1, 0.0]] * (long.nodes[:, [0]] > 6.1)
    bent = sc.Mesh.from_arrays(bent, long.quads)
    for film, path in ((short, "edges"), (long, "edges"), (bent, "free")):
        for duration in (1e-4, 5e-4, 3e-3):
            assert with_path(film, blade(length=6.0), ALONG, duration, None).path == path


def test_no_row_lies_under_a_path_along_a_cut_or_where_nothing_cuts():
    film = rectangle(6.0, 4.0, size=0.5)
    middle = film.nodes_where(lambda x, y, z: (np.abs(y) < 1e-9) & (x < 2.1))
    cut = film.cut(middle[np.argsort(film.nodes[middle, 0])])
    for mesh, y, under in (
        (film, 0.0, True),
        (cut, 0.0, False),
        (film, 2.0, False),
        (film, 9.0, False),
    ):
        assert lies_under(Sweep.of(mesh, blade(y, length=6.0), ALONG, 5e-4)) is under


def test_the_notch_of_a_film_that_comes_to_the_tool_is_that_of_a_tool_that_comes():
    mesh, came = rectangle(8.0, 4.8, size=0.8), {"velocity": {"x": lambda _: -3000.0}}
    moved = [sc.Support(side, **came) for side in ("bottom", "top")]
    rest = sc.TableMotion([0.0, 1e-3], np.zeros((2, 3)))
    _, (mine,) = notched(mesh, blade(), rest, supports=moved)
    _, (other,) = notched(mesh, blade(), sc.StraightMotion((1.0, 0.0, 0.0), speed=3000.0))
    np.testing.assert_allclose(mine, other, atol=1e-9)


def test_a_notch_along_a_straight_path():
    c, s = np.cos(0.3), np.sin(0.3)
    sharp = straight_blade(length=12.0, height=3.0)
    turned = sc.Tool.from_triangles(
        sharp.vertices @ np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]]),
        sharp.triangles,
        edges=sharp.edges,
        flank_angle_deg=sharp.flank_angle_deg,
    ).translated((-0.05, -1.0, 0.0))
    motion = StraightMotion((c, s, 0.0), 6000.0)
    case, (end,) = notched(rectangle(8.0, 4.8, size=0.8), turned, motion)
    start = np.array([0.0, -1.0 + 0.05 * np.tan(0.3), 0.0])
    along, beside = (end - start) @ np.array([[c, -s], [s, c], [0.0, 0.0]])
    assert 2.0 <= along < 2.8
    assert abs(beside) < 0.05 * 0.8  # corners that are nearer are met
    assert case.simulation.state.crack_length == 0.0
    assert case.check.findings == ()


@pytest.mark.parametrize("on_row", [False, True])
def test_a_notch_along_an_arc_within_the_film_has_two_ends(on_row):
    # One tooth comes down on the disc, on its ring of edges or beside it.
    radius = 9.4 if on_row else 7.7
    tool, held = tooth_ring(n_teeth=1, radius=radius), [sc.Support.clamped("rim")]
    case, ends = notched(opening_disc("M1"), tool, SCREW, 4e-3, 4.0, held)
    sim = case.simulation
    h = np.sqrt(sim.shell.area.max())
    assert len(ends) == 2
    assert sim.state.crack_length == 0.0
    angle = np.ptp(np.unwrap(np.arctan2(ends[:, 1], ends[:, 0])))
    if on_row:
        # It begins at the edge behind the first place.
        assert 4.0 - 2.0 * np.pi * 9.4 / 152 < 9.4 * angle < 4.0 + 1e-3
        return
    assert 4.0 - 0.1 < 7.7 * angle < 4.0 + 3.0 * h
    # L²/8R of a segment of one edge and the corners that are met, measured 0.05 edges.
    for points in (ends, np.array([cut.reference for cut in sim.state.split_log])):
        np.testing.assert_allclose(np.hypot(points[:, 0], points[:, 1]), 7.7, atol=0.1 * h)


@pytest.mark.parametrize("outside", [-1e-4, 2e-4, 9e-4])
def test_a_notch_whose_first_place_is_just_outside_the_rim_begins_at_it(outside):
    """Places of the path count that miss the film by less than a thousandth of an edge."""
    h, speed, ticks = 0.8, 6000.0, 200
    duration = (0.05 - outside * h) / speed * ticks / 3
    case, (end,) = notched(rectangle(8.0, 4.8, size=h), blade(0.1), duration=duration, notch=1.0)
    assert 1.0 - outside * h <= end[0] < 1.0 + h
    assert end[1] == pytest.approx(0.1, abs=1e-9)
    assert case.simulation.state.split_log[0].reference[0] == pytest.approx(0.0, abs=1e-9)


def test_a_notch_may_be_longer_than_the_way_of_the_run():
    _, (end,) = notched(rectangle(6.0, 4.0, size=0.5), blade(0.03), duration=1e-4)  # 0.6 mm
    assert end[0] >= 2.0


@pytest.mark.parametrize("x", [0.0, -3e-17, 3e-17, -10.0])
def test_a_notch_through_a_point_on_the_rim_or_far_outside_begins_at_the_rim(x):
    sim = by_hand(fracture=Fracture(path="free"))
    sim.notch((x - 10.0, 0.1, 0.0), (x, 0.1, 0.0), (2.0, 0.1, 0.0))
    assert sim.state.split_log[0].reference[0] == pytest.approx(0.0, abs=1e-9)
    ends = sim.cracks.at_tips(sim.mesh.nodes)
    np.testing.assert_allclose(ends, [[2.4, 0.1, 0.0]], atol=1e-9)


def test_a_notch_that_begins_within_a_quad_begins_at_its_side():
    sim = by_hand(fracture=Fracture(path="free"))
    sim.notch((2.1, 0.1, 0.0), (5.0, 0.1, 0.0))
    ends = sim.cracks.at_tips(sim.mesh.nodes)
    np.testing.assert_allclose(ends, [[1.6, 0.1, 0.0]], atol=1e-9)
    assert sum(cut.kind == "notch" for cut in sim.state.split_log) == 3


@pytest.mark.parametrize(
    ("points", "said"),
    [
        ([(-0.5, 0.1, 0), (2.9, 0.1, 0), (0.3, -0.2, 0)], "the film: it turns too sharply"),
        ([(2.4, 0.1, 0), (5.0, 0.1, 0)], "a notch must lead into the film, got one at"),
        ([(0.0, 0.0), (1.0, 0.0, 0.0)], "two different points in mm"),
        ([(0.0, 0.0, np.nan), (1.0, 0.0, 0.0)], "two different points in mm"),
        ([(1.0, 1.0, 1.0), (1.0, 1.0, 1.0)], "two different points in mm"),
        ([(0.0, 0.0, 50.0), (1.0, 0.0, 50.0)], "must begin within a quad or at the border"),
    ],
)
def test_a_notch_that_cannot_be_cut_is_refused(points, said):
    with pytest.raises(ValueError, match=said):
        by_hand(fracture=Fracture(path="free")).notch(*points)


def test_a_notch_needs_cracks_through_quads_a_film_at_rest_and_an_edge_that_comes_by():
    line = (0.0, 0.0, 0.0), (1.0, 0.0, 0.0)
    with pytest.raises(ValueError, match=r"through quads.*Mesh\.cut"):
        by_hand(fracture=Fracture(path="edges")).notch(*line)
    sim = by_hand()
    sim.state.node.x[3] += 1e-3
    with pytest.raises(ValueError, match="before it is stretched"):
        sim.notch(*line)
    above = blade().translated((0.0, 0.0, 9.0))
    with pytest.raises(ValueError, match="got none that moves through the film: pass notch=0"):
        notched(rectangle(8.0, 4.8, size=0.8), above)


CLOSED = {
    "square on sides of quads": [(3.2, -1.6), (6.4, -1.6), (6.4, 1.6), (3.2, 1.6)],
    "oblique": [(3.0, -1.5), (6.5, -1.1), (6.3, 1.9), (2.9, 1.45)],
    "triangle": [(2.7, -2.1), (7.3, -1.3), (4.4, 2.2)],
    "touches a side": [
        (5.03 + 2.5 * np.cos(angle), 0.07 + 2.5 * np.sin(angle))
        for angle in np.linspace(0.0, 2.0 * np.pi, 13)[:-1] + 0.67333
    ],
}


@pytest.mark.parametrize("corners", CLOSED.values(), ids=CLOSED)
def test_a_notch_that_ends_where_it_began_cuts_a_piece_out(corners):
    film = rectangle(10.0, 8.0, size=0.8)
    sim = free_film(film, supports=[sc.Support.clamped("left")])
    sim.notch(*((x, y, 0.0) for x, y in [*corners, corners[0]]))
    quads = sim.state.quads
    of_row = pieces(quads)
    rest = of_row[(quads == film.node_set("left")[0]).any(axis=1)][0]
    loose = sim.state.node.mass[np.unique(quads[of_row != rest])].sum()
    x, y = np.array(corners).T
    area = 0.5 * abs((x * np.roll(y, -1) - y * np.roll(x, -1)).sum())
    # Corners within quads are cut off.
    assert loose == pytest.approx(1e-9 * 0.074 * area, rel=0.05)


@pytest.mark.parametrize("own", [False, True])
def test_the_notch_of_the_guillotine_lies_where_the_tool_goes(own):
    strip = {"length": 8.0, "width": 4.8, "size": 0.8}
    strip = {"mesh": rectangle(8.0, 4.8, size=0.8)} if own else strip
    moved = straight_blade(length=8.0).translated((0.0, 0.7, 0.0))
    sim = guillotine(tool=moved, notch=1.6, travel=2.0, **strip).simulation
    np.testing.assert_allclose(sim.cracks.at_tips(sim.mesh.nodes), [[1.6, 0.7, 0]], atol=1e-9)


def test_simulation_refuses_anisotropy_under_a_tool():
    film = sc.Anisotropy(direction=(1.0, 0.0, 0.0), along=0.5)
    with pytest.raises(ValueError, match=r"cracks that no blade drives, got a tool"):
        by_hand(fracture=Fracture(path="free", anisotropy=film))
