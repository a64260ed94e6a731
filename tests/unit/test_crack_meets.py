"""Cracks through quads where they meet sides, corners and each other."""

import numpy as np
import pytest

from free_strip import cut_strip, path_in, pieces_of, slanted_strip
from naive import blade_drive
from shellcut import Mesh, StraightMotion, load_checkpoint, save_checkpoint
from shellcut.contact.settings import STEEPEST
from shellcut.fracture.blade_drive import BladeDrive
from shellcut.fracture.drawn_film import DrawnFilm
from shellcut.fracture.entered_film import EnteredFilm
from shellcut.fracture.flank_points import hand_on_stiffness
from shellcut.fracture.own_cuts import OwnCuts
from shellcut.fracture.ray_ahead import GRAZE, SNAP
from shellcut.fracture.tip import Begun, Pierced, Tip
from shellcut.mesh.structured import rectangle
from shellcut.tool.cutting_edge import CuttingEdges

FORWARD = np.array([1.0, 0.0, 0.0])
H = 0.4
"""Side length of the quads [mm]."""


def aligned(turned=False):
    """Squares of 0.4 mm with a line of nodes on y = 0, their first corners anywhere if turned."""
    mesh = rectangle(6.0, 3.2, n_x=15, n_y=8)
    rolls = np.random.default_rng(2).integers(0, 4, mesh.n_quad) * turned
    quads = np.array([np.roll(quad, k) for quad, k in zip(mesh.quads, rolls, strict=True)])
    return Mesh.from_arrays(mesh.nodes, quads, node_sets=mesh.node_sets)


def start_of(sim):
    return float(sim.mesh.nodes[:, 0].min())


def at_side(sim, x, s):
    """A tip on the side from (x, 0) to (x + 0.4, 0), s of it from its first point."""
    X = sim.mesh.nodes
    a, b = (int(np.argmin(np.hypot(X[:, 0] - at, X[:, 1]))) for at in (x, x + 0.4))
    assert a < b
    low = [q for q, ring in enumerate(sim.mesh.quads) if a in ring and b in ring]
    below = min(low, key=lambda q: X[sim.mesh.quads[q], 1].mean())
    return Tip((a, b), s, below, FORWARD)


@pytest.mark.parametrize(("slope", "passes"), [(-0.5 * GRAZE, True), (-2.0 * GRAZE, False)])
def test_a_ray_along_its_own_side_passes_the_corner(slope, passes):
    """The tip came from below; its ray leaves the quad above by less or more than a graze."""
    sim = cut_strip(mesh=aligned(), notched=False)
    path, tip = path_in(sim), at_side(sim, start_of(sim) + 2.0, 0.6)
    segment = path.segment_from(sim.state, tip, FORWARD + slope * np.array([0.0, 1.0, 0.0]))
    assert (segment is not None) == passes
    if passes:
        place = path.film.at_tip(path.tip_at(segment, FORWARD), sim.state.node.X)
        # On the side beyond the corner, by as much as corners are kept clear.
        corner = [start_of(sim) + 2.4, 0.0, 0.0]
        np.testing.assert_allclose(place - corner, [0.0, SNAP * 0.4, 0.0], atol=1e-12)


@pytest.mark.parametrize("turned", [False, True])
def test_a_ray_along_its_own_side_does_not_end_where_a_crack_crosses_that_side(turned):
    """Such a segment would cut nothing off: it lies on the side."""
    sim = cut_strip(mesh=aligned(turned), notched=False)
    x = start_of(sim) + 2.0
    sim.notch((x + 0.2, -0.9, 0.0), (x + 0.2, 0.9, 0.0))
    assert path_in(sim).segment_from(sim.state, at_side(sim, x, 0.2), FORWARD) is None


def test_a_crack_along_sides_is_closed_at_its_tip_whichever_corners_come_first():
    """An end that is taken for open would begin anew there, as on another crack's flank."""
    runs = []
    for turned in (False, True):
        sim = cut_strip(mesh=aligned(turned))
        flanks = set()
        while sim.state.crack_length < 1.5:
            sim.step()
            if sim.state.crack_length > 0.0:
                flanks |= {tip.flank for tip in sim.cracks.tips}
        runs.append((flanks, [(cut.kind, cut.reference) for cut in sim.state.split_log]))
    assert runs[0][0] == runs[1][0] == {None}
    assert [kind for kind, _ in runs[0][1]] == [kind for kind, _ in runs[1][1]]
    places = [np.array([at for _, at in cuts]) for _, cuts in runs]
    np.testing.assert_allclose(places[0], places[1], atol=1e-12)


def slit(beyond):
    """A strip with a slit across y = 0, where that is, and a crack led ``beyond`` it."""
    sim = cut_strip(mesh=slanted_strip(), notched=False)
    x = start_of(sim) + 1.9
    sim.notch((x, -2.0, 0.0), (x, 1.0, 0.0))
    sim.cracks.tips.clear()
    sim.notch((x - 3.0, 0.01, 0.0), (x + beyond, 0.01, 0.0))
    return sim, x


def test_a_crack_that_has_come_to_another_goes_on_from_its_other_flank():
    sim, x = slit(0.01)
    ((there, *_),) = sim.cracks.at_tips(sim.state.node.X)
    assert there > x


def test_two_tips_at_one_place_on_a_slit_are_none_any_more():
    """The second crack comes from the other side to where the first waits on the far flank."""
    sim, x = slit(-0.01)
    free = sim.cracks
    (waiting,), (there,) = free.tips, free.at_tips(sim.state.node.X)
    assert waiting.flank is not None
    sim.notch((x + 5.1, there[1], 0.0), (there[0] - 0.5, there[1], 0.0))
    assert not free.tips


@pytest.mark.parametrize("reach", [1.0, -1.0])
def test_the_pose_beyond_a_point_is_found_from_within_a_ramp(reach):
    """The speed now is a hundredth of the speed later: the first guess is far too late."""
    sim = cut_strip(notched=False)
    edges = CuttingEdges.of(sim.tool)
    motion = StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-3)
    time, size = (1e-4, 0.4) if reach > 0.0 else (2e-3, 0.4)
    x = np.array([motion.coordinate(time) - 0.1 + 0.3, 0.05, 0.0])
    drive = BladeDrive(edges, motion)
    then = drive.find(x[None], np.array([size]), time, 0, reach)
    off, _, later = blade_drive.beyond(sim.tool, motion, x, size, 0, time, reach=reach)
    rotation, translation = motion.pose(later)
    gap = np.transpose(rotation) @ (x - translation) - sim.tool.vertices[sim.tool.edges[0, 0]]
    np.testing.assert_allclose(then.rotation[0], rotation)
    assert then.off[0] == pytest.approx(off, abs=1e-12)
    assert gap @ sim.tool.edge_back[0] == pytest.approx(reach * size, abs=0.05 * size)
    assert abs(then.off[0]) == pytest.approx(0.05, abs=1e-12)


def test_contact_holds_no_node_of_a_cut_stiffer_than_at_a_crack_along_edges():
    """There a half node has half the mass and the springs of a quarter of its quads' area."""
    sim = cut_strip(mesh=slanted_strip())
    while sim.state.flank.count < 12:
        sim.step()
    s, n = sim.state, sim.state.node
    nodes = np.flatnonzero(n.real[: n.count])
    stiffness = n.contact_share[nodes] * sim.contact.law.steepest(n.contact_area[nodes])
    held = np.zeros(n.count)
    for node, k in zip(*hand_on_stiffness(s, nodes, stiffness), strict=True):
        held[node] += k
    masters = np.unique(s.flank.nodes[: s.flank.count])
    bare = STEEPEST * sim.contact.law.penalty
    most = 0.5 * bare / sim.material.area_density
    ratio = held[masters] / n.mass[masters] / most
    assert ratio.max() <= 1.0 + 1e-9
    assert ratio.max() > 0.9


@pytest.mark.parametrize(("beside", "joins"), [(0.0, True), (0.25, True), (0.35, False)])
def test_a_crack_joins_one_that_ends_near_its_ray_and_both_are_one(beside, joins):
    """The other crack comes from the far end, beside the first by a part of an edge of 0.4 mm."""
    sim = cut_strip(mesh=slanted_strip(), notched=False)
    free, x = sim.cracks, start_of(sim)
    sim.notch((x + 7.0, 0.1 + 0.4 * beside, 0.0), (x + 1.3, 0.1 + 0.4 * beside, 0.0))
    assert len(free.tips) == 1
    sim.notch((x - 1.0, 0.1, 0.0), (x + 3.0, 0.1, 0.0))
    assert len(free.tips) == (0 if joins else 2)
    assert pieces_of(sim) == (2 if joins else 1)


def a_second_crack(mesh, degrees, side, beside, before, beyond=1.0):
    """The crack that is there, its end, the way of a second one, and the tips there are then.

    The second passes ``beside`` [mm] before the end of the first, at some degrees to its way.
    """
    sim = cut_strip(mesh=mesh, notched=False)
    free, x = sim.cracks, start_of(sim)
    sim.notch((x - 1.0, 0.17, 0.0), (x + 2.41, 0.17, 0.0))
    (end,), (first,) = free.at_tips(sim.state.node.X), free.tips
    turn = np.radians(degrees)
    way = np.array([np.cos(turn), side * np.sin(turn), 0.0])
    passes = end + beside * np.array([np.sin(turn), -side * np.cos(turn), 0.0])
    sim.notch(passes - before * way, passes + beyond * way)
    return any(tip is first for tip in free.tips), (free.at_tips(sim.state.node.X) - end) @ way


TOWARDS = pytest.mark.parametrize(
    ("mesh", "side", "degrees"),
    [
        (mesh, side, degrees)
        for mesh, side in ((aligned(), 1.0), (slanted_strip(), 1.0), (slanted_strip(), -1.0))
        for degrees in (40.0, 100.0, 130.0, 140.0, 170.0)
    ],
)
"""They come towards each other where their ways are more than 134 degrees apart, cos -0.7."""


@TOWARDS
def test_a_crack_that_comes_to_the_end_of_another_goes_on_unless_that_comes_towards_it(
    mesh, degrees, side
):
    first_is_there, ahead = a_second_crack(mesh, degrees, side, 0.0, 0.9)
    assert not first_is_there
    assert len(ahead) == (1 if degrees > 134.0 else 2)
    assert ahead.min() < -0.7  # where the second begins
    if degrees < 134.0:
        assert ahead.max() > 0.8


@TOWARDS
def test_only_a_crack_that_comes_towards_another_draws_that_to_its_end(mesh, degrees, side):
    # 0.22 edges before the end: within JOIN, beyond MERGE.
    first_is_there, ahead = a_second_crack(mesh, degrees, side, 0.22 * H, 0.8)
    assert first_is_there == (degrees < 134.0)
    assert len(ahead) == (1 if degrees > 134.0 else 3)


# --- cracks that come towards each other: on one side, with a third there, from a pierced cut


NODE = np.array([2.4, 0.4, 0.0])
"""Where the second crack ends."""
WAY = np.array([-0.8, 0.6, 0.0])
"""Its direction: through the quad that touches the side above only at the node."""


def on_one_side(beside, way=WAY):
    """A strip with a crack that ends on the side above a node, by a part of it, and another tip.

    The second crack stands before the quad through which it comes to that node.
    """
    sim = cut_strip(mesh=aligned(), notched=False)
    y = NODE[1] + beside * H
    sim.notch((-1.0, y, 0.0), (NODE[0], y, 0.0))
    sim.notch(NODE - 6.0 * way, NODE - 0.55 * way)
    assert len(sim.cracks.tips) == 2
    assert pieces_of(sim) == 1
    return sim


def advance(sim, way=WAY):
    """Advance the crack that comes last to the node."""
    free, tip = sim.cracks, sim.cracks.tips[-1]
    segment = path_in(sim).segment_from(sim.state, tip, way, None, free.tips)
    free.growth.along(sim.state, tip, segment, "criterion", 1.0)


@pytest.mark.parametrize(("beside", "joins"), [(0.2, True), (0.3, True), (0.45, False)])
def test_two_that_end_on_one_side_tear_it_between_them(beside, joins):
    sim = on_one_side(beside)
    x, length = sim.state.node.x[: sim.mesh.n_node].copy(), sim.state.crack_length
    mass = sim.state.node.mass[: sim.state.n_node].sum()
    advance(sim)
    state = sim.state
    assert len(sim.cracks.tips) == (0 if joins else 2)
    assert pieces_of(sim) == (2 if joins else 1)
    np.testing.assert_array_equal(state.node.x[: sim.mesh.n_node], x)
    assert state.node.mass[: state.n_node].sum() == pytest.approx(mass, rel=1e-12)
    if not joins:
        return
    last = state.split_log[-1]
    np.testing.assert_allclose(last.reference, NODE, atol=1e-12)
    segment = np.linalg.norm(np.subtract(state.split_log[-2].reference, NODE))
    assert state.crack_length - length == pytest.approx(segment + beside * H)
    # Cables hold all of it, and the picture shows it.
    area = state.cable.area[: state.n_cable].sum()
    assert area == pytest.approx(sim.material.thickness * (segment + beside * H), rel=1e-12)
    drawn = DrawnFilm.of(state, sim.cracks.cuts.topology)
    at = drawn.at_points(state.node.X)[drawn.crack_edges[:, 0]]
    on_it = (abs(at[..., 0] - NODE[0]) < 1e-9).all(axis=1)
    ends = np.sort(at[on_it][..., 1], axis=1)
    np.testing.assert_allclose(ends, [[NODE[1], NODE[1] + beside * H]], atol=1e-9)


@pytest.mark.parametrize(("degrees", "joins"), [(150.0, True), (140.0, True), (128.0, False)])
def test_no_side_is_torn_between_cracks_that_do_not_come_towards_each_other(degrees, joins):
    way = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0])
    sim = on_one_side(0.2, way)
    advance(sim, way)
    assert len(sim.cracks.tips) == (0 if joins else 2)
    assert pieces_of(sim) == (2 if joins else 1)


def test_a_torn_side_goes_on_from_a_checkpoint_and_keeps_the_ledger(tmp_path):
    sims = [on_one_side(0.2) for _ in range(2)]
    while sims[0].state.step < 20:
        sims[0].step()
    advance(sims[0])
    save_checkpoint(sims[0], tmp_path / "c.h5")
    load_checkpoint(sims[1], tmp_path / "c.h5")
    for sim in sims:
        while sim.cables.n_broken + sim.cables.n_joint_made == 0:
            sim.step()
            assert sim.state.step < 2000
        book = sim.close_ledger()
        assert abs(book.relative(book.imbalance)) < 2e-3
    np.testing.assert_array_equal(sims[0].state.node.x, sims[1].state.node.x)
    assert sims[0].ledger == sims[1].ledger


def test_a_third_tip_at_a_joint_stays():
    sim = on_one_side(0.2)
    free = sim.cracks
    first = free.tips[0]
    third = Tip(first.ends, first.s, first.quad, np.array([0.6, 0.8, 0.0]))
    free.tips.insert(0, third)
    # It comes straight towards the first, through the quad beyond.
    y = NODE[1] + 0.2 * H
    sim.notch((7.0, y, 0.0), (NODE[0] + 0.3, y, 0.0))
    assert any(tip is third for tip in free.tips)
    assert not any(tip is first for tip in free.tips)


def test_a_pierced_cut_joins_a_crack_that_comes_towards_it(monkeypatch):
    sim = cut_strip(mesh=slanted_strip(), notched=False)
    free, shell = sim.cracks, sim.shell
    middles = sim.mesh.nodes[sim.mesh.quads].mean(axis=1)
    row = int(np.linalg.norm(middles - [2.6, 0.0, 0.0], axis=1).argmin())
    right = sim.mesh.nodes[sim.mesh.quads[row], 0].max()
    sim.notch((7.0, middles[row, 1] + 0.06, 0.0), (right + 0.01, middles[row, 1] + 0.06, 0.0))
    (there,) = free.at_tips(sim.mesh.nodes)
    assert there[0] == pytest.approx(right, abs=0.1)
    begun = Begun(row, (0.0, 0.0), 0, Pierced(measure=1.0, force=0.0, delay=0.0, depth=0.0))
    monkeypatch.setattr(EnteredFilm, "entered_rows", lambda *_: [begun])
    monkeypatch.setattr(OwnCuts, "at_own_tip", lambda *_: False)
    free.cut_due(sim.state, sim.pose)
    (tip,) = free.tips
    assert free.at_tips(sim.mesh.nodes)[0, 0] < middles[row, 0]
    assert tip.heading[0] < 0.0
    assert len(shell.mesh_quads) == sim.state.n_quad


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("backwards", [False, True])
@pytest.mark.parametrize("aside", [-0.1, 0.03, 0.1])
def test_a_crack_joins_one_that_comes_towards_it_at_its_tip(turned, backwards, aside):
    """On a side of quads, whatever their first corners and in whichever order nodes have ids."""
    mesh = aligned(turned)
    if backwards:
        last = mesh.n_node - 1
        sets = {name: last - ids for name, ids in mesh.node_sets.items()}
        mesh = Mesh.from_arrays(mesh.nodes[::-1], last - mesh.quads, node_sets=sets)
    sim = cut_strip(mesh=mesh, notched=False)
    x, y = start_of(sim), 0.14
    sim.notch((x - 1.0, y, 0.0), (x + 2.2, y, 0.0))
    (tip,) = sim.cracks.at_tips(sim.state.node.X)
    sim.notch((x + 7.0, y + aside, 0.0), (x + 1.0, y + aside, 0.0))
    assert not sim.cracks.tips
    X = sim.mesh.nodes
    a, b = (int(np.argmin(np.hypot(X[:, 0] - tip[0], X[:, 1] - at))) for at in (0.0, H))
    # One place on that side, not two beside each other.
    (s,) = sim.cracks.cuts.topology.crossings(a, b)
    assert s == pytest.approx(y / H, abs=1e-9)
    assert pieces_of(sim) == 2
