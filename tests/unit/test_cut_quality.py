"""Figures of a cut's quality, on films cut by hand whose answers are known."""

import dataclasses
from itertools import pairwise

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from opening_frame import RADIUS, disc, opening_frame
from shellcut import Mesh, ShellMaterial, Simulation
from shellcut.fracture.open_edges import crack_edges
from shellcut.mesh.structured import rectangle
from shellcut.numerics.connected_parts import connected_parts
from shellcut.recording.frame_capture import frame_of
from shellcut.results.cut_quality import UNITS, cut_quality

N_X, N_Y = 10, 8  # quads of 1 mm
EXACT = 1e-12  # round-off of lengths of some mm and angles of some degrees


def node(x, y):
    """The node at (x, y) of the uncut sheet."""
    (found,) = SHEET.nodes_where(lambda X, Y, Z: np.hypot(X - x, Y - y) < 1e-9)
    return int(found)


def still_frame(mesh, points=None, held=()):
    sim = Simulation(mesh, ShellMaterial.homogeneous())
    frame = frame_of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm")
    points = mesh.nodes if points is None else points
    on = np.isin(np.arange(mesh.n_node), held)
    return dataclasses.replace(frame, points=points, held=on)


SHEET = rectangle(float(N_X), float(N_Y), n_x=N_X, n_y=N_Y)
Y0 = float(SHEET.nodes[:, 1].min())


def cut(*lines):
    """The sheet cut along lines of points (x, y), y from the sheet's lower side."""
    mesh = SHEET
    for line in lines:
        mesh = mesh.cut([node(x, Y0 + y) for x, y in line])
    return mesh


def straight(x0, x1, y=4):
    step = 1 if x1 > x0 else -1
    return [(x, y) for x in range(x0, x1 + step, step)]


def turned(mesh, quads, angle, *, about, axis):
    """The points with the nodes of some quads turned about a line [deg]."""
    points = mesh.nodes.copy()
    ids = np.unique(mesh.quads[quads])
    turn = Rotation.from_rotvec(np.radians(angle) * np.asarray(axis, float))
    points[ids] = turn.apply(points[ids] - about) + about
    return points


def test_an_uncut_film_is_one_piece_that_holds():
    quality = cut_quality(still_frame(SHEET, held=[0]))
    figures = quality.figures()
    assert set(figures) == set(UNITS)
    assert figures.pop("n_piece") == 1
    assert not any(figures.values())
    assert quality.pieces[0].area == pytest.approx(N_X * N_Y, rel=EXACT)


def test_a_straight_crack_and_the_width_of_its_slit():
    mesh = cut(straight(3, 7))
    points = mesh.nodes.copy()
    twin = mesh.origin != np.arange(mesh.n_node)
    points[twin, 2] += 0.6  # three nodes of the upper flank: half of it at the two edges outside
    figures = cut_quality(still_frame(mesh, points)).figures()
    assert figures["crack_length"] == pytest.approx(4.0, rel=EXACT)
    assert figures["slit_width_largest"] == pytest.approx(0.6, rel=EXACT)
    assert figures["slit_width_mean"] == pytest.approx((0.3 + 0.6 + 0.6 + 0.3) / 4, rel=EXACT)
    # Its ends look away from each other, and it frees no flap.
    counts = {name: figures[name] for name in figures if name.startswith("n_")}
    assert counts == {"n_crack": 1, "n_bridge": 0, "n_flap": 0, "n_piece": 1, "n_loose": 0}


def test_bridges_between_cracks():
    quality = cut_quality(still_frame(cut(straight(2, 4), straight(7, 9))))
    (bridge,) = quality.bridges
    assert bridge.width == pytest.approx(3.0, rel=EXACT)
    np.testing.assert_allclose(np.sort(bridge.ends[:, 0]), [4.0, 7.0], atol=EXACT)
    quality = cut_quality(still_frame(cut(straight(0, 3), straight(10, 8))))
    assert [bridge.width for bridge in quality.bridges] == [pytest.approx(5.0, rel=EXACT)]
    assert quality.flaps == ()
    mesh = cut(straight(2, 8))
    at, twin = np.flatnonzero(mesh.origin == node(5, Y0 + 4))
    quads = np.where(mesh.quads == twin, at, mesh.quads)  # sewn together again
    sewn = {"quads": quads, "crack_edges": crack_edges(quads, mesh.origin)}
    quality = cut_quality(dataclasses.replace(still_frame(mesh), **sewn))
    assert len(quality.cracks) == 2
    assert [bridge.width for bridge in quality.bridges] == [0.0]
    assert quality.crack_length == pytest.approx(6.0, rel=EXACT)


# A tongue of 3 mm x 3 mm, hinged on x = 3 between y = 2 and y = 5.
U_SHAPE = [(3, 2), (4, 2), (5, 2), (6, 2), (6, 3), (6, 4), (6, 5), (5, 5), (4, 5), (3, 5)]


def within(mesh, x, y):
    """The quads whose middles are between these ends."""
    middle = mesh.nodes[mesh.quads].mean(axis=1)[:, :2] - [0.0, Y0]
    return np.flatnonzero(((middle > (x[0], y[0])) & (middle < (x[1], y[1]))).all(axis=1))


@pytest.mark.parametrize("angle", [0.01, 35.0, 120.0])
def test_a_flap_turned_about_its_hinge(angle):
    mesh = cut(U_SHAPE)
    tongue = within(mesh, (3, 6), (2, 5))
    points = turned(mesh, tongue, angle, about=[3, Y0, 0], axis=[0, 1, 0])
    quality = cut_quality(still_frame(mesh, points))
    (flap,) = quality.flaps
    assert flap.quads.tolist() == tongue.tolist()
    assert flap.area == pytest.approx(9.0, rel=EXACT)
    # Round-off of the coordinates, seen from the size of the tongue.
    assert (flap.angle, flap.steepest) == pytest.approx((angle, angle), rel=1e-10)
    np.testing.assert_allclose(flap.line[[0, -1], 0], 3.0, atol=EXACT)
    assert quality.cutout is None
    assert len(quality.pieces) == 1


def test_a_bent_flap_is_steeper_than_its_mean():
    mesh = cut(U_SHAPE)
    points = mesh.nodes.copy()
    ids = np.unique(mesh.quads[within(mesh, (3, 6), (2, 5))])
    points[ids, 2] = 0.1 * (points[ids, 0] - 3.0) ** 2  # slopes 0.1, 0.3, 0.5
    (flap,) = cut_quality(still_frame(mesh, points)).flaps
    assert flap.steepest == pytest.approx(np.degrees(np.arctan(0.5)), rel=1e-10)
    assert flap.angle == pytest.approx(np.degrees(np.arctan(0.3)), rel=1e-10)


# Of 3 mm x 2 mm.
SQUARE = [(3, 2), (4, 2), (5, 2), (6, 2), (6, 3), (6, 4), (5, 4), (4, 4), (3, 4), (3, 3)]


@pytest.mark.parametrize("held", ["rim", "nothing"])
def test_a_patch_cut_out_is_loose(held):
    mesh = cut([*SQUARE, SQUARE[0]])
    quality = cut_quality(still_frame(mesh, held=[node(0, Y0)] if held == "rim" else []))
    rest, patch = quality.pieces
    assert (rest.loose, patch.loose) == (False, True)
    assert patch.area == pytest.approx(6.0, rel=EXACT)
    assert rest.area == pytest.approx(N_X * N_Y - 6.0, rel=EXACT)
    figures = quality.figures()
    assert (figures["n_loose"], figures["cut_share"], figures["n_flap"]) == (1, 1.0, 0)
    assert figures["loose_area"] == pytest.approx(6.0, rel=EXACT)
    assert figures["crack_length"] == pytest.approx(10.0, rel=EXACT)
    assert quality.cutout.quads.tolist() == patch.quads.tolist()


def test_the_last_bridge_of_a_cut_out_and_how_far_it_has_tipped():
    # All of the square but the edge from (3, 3) to (3, 2).
    mesh = cut(SQUARE)
    patch = within(mesh, (3, 6), (2, 4))
    points = turned(mesh, patch, 25.0, about=[3, Y0, 0], axis=[0, 1, 0])
    quality = cut_quality(still_frame(mesh, points, held=[node(0, Y0)]))
    # At the corner (3, 2) the crack arrives along x, so its ends do not face each other there: the
    # flap tells of the hinge, 1 mm long.
    (flap,) = quality.flaps
    assert flap.quads.tolist() == patch.tolist()
    assert np.linalg.norm(flap.line[0] - flap.line[-1]) == pytest.approx(1.0, rel=EXACT)
    assert flap.angle == pytest.approx(25.0, rel=1e-10)


@pytest.mark.parametrize("angle", [20.0, 45.0, 80.0])
def test_four_arcs_on_a_circle(angle):
    frame = opening_frame(angle)
    quality = cut_quality(frame)
    assert len(quality.cracks) == len(quality.bridges) == len(quality.flaps) == 4
    # Together once around, up to half the turn of an edge in the direction of each end.
    around = quality.crack_length + sum(bridge.width for bridge in quality.bridges)
    assert around == pytest.approx(2 * np.pi * RADIUS, rel=5e-3)
    assert quality.cut_share == pytest.approx(quality.crack_length / around, rel=EXACT)
    assert len({round(bridge.width, 9) for bridge in quality.bridges}) == 1
    # Four equal flaps: segments between the arc and its chord, by whole quads.
    half = 0.5 * quality.crack_length / 4 / RADIUS
    segment = RADIUS**2 * (half - np.sin(half) * np.cos(half))
    h = 2 * np.pi * RADIUS / (4 * 38)
    for flap in quality.flaps:
        assert abs(flap.area - segment) < h * 2 * RADIUS * np.sin(half)
    assert quality.figures()["n_loose"] == 0


def test_a_disc_that_hangs_by_four_bridges_and_has_tipped():
    frame = opening_frame(80.0)
    points = frame.reference.copy()
    ids = np.unique(frame.quads[cut_quality(frame).cutout.quads])
    points[ids] = Rotation.from_rotvec([np.radians(12.0), 0, 0]).apply(points[ids])
    quality = cut_quality(dataclasses.replace(frame, points=points))
    assert len(quality.bridges) == 4
    assert quality.cutout.angle == pytest.approx(12.0, rel=1e-10)
    assert quality.cutout.area == pytest.approx(np.pi * RADIUS**2, rel=0.01)  # chords of quads
    assert len(quality.pieces) == 1


def test_a_single_arc_has_a_bridge_once_it_faces_itself():
    # One tooth: by 80 degrees nothing, by 270 the two ends of the one crack.
    nodes, quads = disc(16, [RADIUS - 0.8, RADIUS, 10.2])
    mesh = Mesh.from_arrays(nodes, quads)
    on = np.flatnonzero(np.abs(np.hypot(*nodes.T) - RADIUS) < 1e-9)
    on = on[np.argsort(np.arctan2(*nodes[on].T[::-1]))]  # 64 nodes
    assert cut_quality(still_frame(mesh.cut(on[:15]))).bridges == ()
    quality = cut_quality(still_frame(mesh.cut(on[:49])))
    (bridge,) = quality.bridges
    # Up to half the turn of an edge in the direction of each end.
    assert bridge.width == pytest.approx(2 * np.pi * RADIUS / 4, rel=0.02)
    assert quality.cut_share == pytest.approx(0.75, rel=0.01)
    assert quality.cutout.quads.tolist() == quality.flaps[0].quads.tolist()


def test_branches_and_loops_are_one_crack():
    quality = cut_quality(still_frame(cut(straight(2, 8), [(5, 4), (5, 5), (5, 6)])))
    assert len(quality.cracks) == 1
    assert quality.crack_length == pytest.approx(8.0, rel=EXACT)
    (line,) = quality.cracks
    assert len(line) == 7
    assert abs(line[0, 0] - line[-1, 0]) == pytest.approx(6.0, rel=EXACT)

    def around(x):
        ring = [(x + i, 2) for i in range(3)] + [(x + 2, 3), (x + 2, 4), (x + 1, 4), (x, 4), (x, 3)]
        return [*ring, ring[0]]

    quality = cut_quality(still_frame(cut(straight(3, 7, y=3), around(1), around(7)), held=[0]))
    assert len(quality.cracks) == 1
    assert quality.crack_length == pytest.approx(4.0 + 2 * 8.0, rel=EXACT)
    assert quality.cutout.area == pytest.approx(4.0, rel=EXACT)
    assert quality.figures()["n_loose"] == 2


def crossing_cuts(*lines):
    """The sheet, held at a corner, parted along lines that may meet and cross."""
    ids = [[node(x, Y0 + y) for x, y in line] for line in lines]
    parted = {frozenset(side) for line in ids for side in pairwise(line)}
    corner = np.arange(SHEET.quads.size).reshape(-1, 4)
    ends: dict[tuple[int, int], tuple[int, int]] = {}
    pairs = []
    for old, own in zip(SHEET.quads.tolist(), corner.tolist(), strict=True):
        for k in range(4):
            i, j = old[k - 1], old[k]
            ends[i, j] = own[k - 1], own[k]
            if (j, i) in ends and frozenset((i, j)) not in parted:
                pairs += zip(ends[i, j], ends[j, i][::-1], strict=True)
    quads = connected_parts(*np.array(pairs).T, corner.size)[corner]
    origin = np.empty(quads.max() + 1, dtype=int)
    origin[quads] = SHEET.quads
    whole = still_frame(SHEET, held=[node(0, Y0)])
    names = "points", "reference", "director", "velocity", "held"
    of_nodes = {name: getattr(whole, name)[origin] for name in names}
    crossed = {"quads": quads, "crack_edges": crack_edges(quads, origin)}
    return dataclasses.replace(whole, **of_nodes, **crossed)


# A loop of 3 mm x 2 mm from its corner (3, 2), and what else is cut.
LOOP = [*SQUARE, SQUARE[0]]
OVERRUNS = {
    "its end runs out of it": [[*LOOP, (2, 2)]],
    "its end runs into it": [[(3, 3), (3, 2), *SQUARE[1:9], (3, 3), (4, 3)]],
    "both ends cross at a corner": [[(3, 1), *LOOP, (2, 2), (1, 2)]],
    "its start is long": [[(3, y) for y in range(8)], [*SQUARE[:9]]],
    "two cracks that cross twice": [
        [*straight(1, 6, 2), (6, 3), (6, 4), (6, 5)],
        [(3, 1), (3, 2), (3, 3), (3, 4), *straight(4, 8)],
    ],
    "four straight cuts": [
        straight(1, 8, 2),
        straight(2, 7, 4),
        [(3, y) for y in range(1, 7)],
        [(6, y) for y in range(1, 6)],
    ],
    "a crack across": [LOOP, [(4, 1), (4, 2), (4, 3), (4, 4), (4, 5)]],
    "a slit inside and branches": [[*LOOP, (3, 1)], straight(6, 9, 3), [(4, 3), (5, 3)]],
    "a smaller loop at its corner": [LOOP, [(6, 4), (7, 4), (7, 5), (6, 5), (6, 4)]],
}


@pytest.mark.parametrize("rolled", [False, True])
@pytest.mark.parametrize("name", OVERRUNS)
def test_a_line_that_is_closed_is_cut_wholly_whatever_else_is_cut(name, rolled):
    frame = crossing_cuts(*OVERRUNS[name])
    if rolled:  # to a part of a cylinder
        x, y, _ = frame.reference.T
        shape = np.stack([8.0 * np.sin(x / 8.0), y, 8.0 * np.cos(x / 8.0)], axis=1)
        frame = dataclasses.replace(frame, reference=shape, points=shape)
    quality = cut_quality(frame)
    inside = within(SHEET, (3, 6), (2, 4))
    assert quality.cut_share == 1.0
    assert quality.cutout.quads.tolist() == inside.tolist()
    chord = 16.0 * np.sin(1.0 / 16.0) if rolled else 1.0
    assert quality.cutout.area == pytest.approx(6.0 * chord, rel=EXACT)
    assert quality.figures()["n_loose"] >= 1


def test_branches_of_cracks_around_a_cut_out_leave_its_bridges():
    # Two cracks around 6 mm x 4 mm, which face each other across 2 mm on both sides; the branch is
    # longer than either of them, and leads out of the sheet's middle.
    lower = [(2, 3), (2, 2), *straight(3, 7, 2), (8, 2), (8, 3)]
    upper = [(2, 5), (2, 6), *straight(3, 7, 6), (8, 6), (8, 5)]
    branch = [(8, 2), (8, 1), *straight(7, 1, 1)]
    plain = cut_quality(crossing_cuts(lower, upper))
    quality = cut_quality(crossing_cuts(lower, upper, branch))
    assert [bridge.width for bridge in quality.bridges] == pytest.approx([2.0, 2.0], rel=EXACT)
    assert quality.cut_share == pytest.approx(16.0 / 20.0, rel=EXACT)
    assert quality.cut_share == pytest.approx(plain.cut_share, rel=EXACT)
    assert quality.cutout.quads.tolist() == plain.cutout.quads.tolist()


def test_ends_that_overran_and_face_each_other_leave_the_line_closed():
    # The tails at the corners of 8 mm x 4 mm face each other along its lower and upper side.
    loop = [*straight(1, 9, 2), *[(9, y) for y in range(3, 6)], *straight(9, 1, 6)]
    loop += [(1, y) for y in range(5, 1, -1)]
    tails = [
        [(x, y), (x, y + out), (x + into, y + out)]
        for x, into in ((1, 1), (9, -1))
        for y, out in ((2, -1), (6, 1))
    ]
    quality = cut_quality(crossing_cuts(loop, *tails))
    assert [bridge.width for bridge in quality.bridges] == pytest.approx([6.0, 6.0], rel=EXACT)
    assert quality.cut_share == 1.0
    assert quality.cutout.area == pytest.approx(32.0, rel=EXACT)
