"""Corners and edges of the tool against quads of the film."""

import numpy as np
import pytest

from blunt_tools import ball, box, needle
from naive.contact import smoothed
from shellcut import Contact, ShellMaterial, Simulation, StraightMotion, Support, opening_test
from shellcut.contact.sheet_contact import felt_nodes
from shellcut.contact.tool_points import tool_points
from shellcut.contact.unfelt_depth import ToolWires
from shellcut.mesh.structured import rectangle
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring

GAP = 0.01


def pricked(tool_points=True, friction=0.0, **options):
    """A clamped film of 1 mm quads, and a needle above the inside of one that comes down."""
    mesh = rectangle(4.0, 4.0, n_x=4, n_y=4)
    return Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        supports=[Support.clamped(mesh.boundary_nodes())],
        tool=needle().translated((2.37, 0.21, GAP)),
        motion=StraightMotion((0.0, 0.0, -1.0), speed=2000.0, ramp=2e-5),
        contact=Contact(tool_points=tool_points, friction=friction),
        **options,
    )


def term(sim):
    return next(t for t in sim.terms if t.name == "points")


def press(sim, depth, shift=(0.0, 0.0)):
    """Evaluate with the film as it is and the needle's tip this deep; return what it did."""
    s = sim.state
    s.step += 10  # a point that rests is looked at again
    s.node.force[:] = 0.0
    place = np.array([*shift, -(GAP + depth)])
    term(sim).add_forces(s, Pose(np.eye(3), place))
    return term(sim).forces


def pressing(depth=0.02):
    """A film that is not flat, and a needle in it; the terms, the state, and the point."""
    sim = pricked()
    s = sim.state
    inner = ~s.node.supported[: s.n_node]
    s.node.x[: s.n_node][inner] += np.random.default_rng(6).uniform(-0.02, 0.02, (inner.sum(), 3))
    for to in (*np.linspace(-0.1, depth, 12), depth):  # and rests there
        press(sim, to)
    points = term(sim)
    assert points.forces.n_touching == 1
    return sim, points, s, int(np.flatnonzero(points.carriers.pressure)[0])


def test_a_box_pushes_with_corners_and_edges():
    points = tool_points(box((0, 0, 0), (1, 1, 1)), 0.5)
    # Eight corners, three points on each of twelve edges; none on the diagonals of the faces.
    assert len(points.place) == 8 + 12 * 3
    on_edge = (np.isclose(points.place, 0) | np.isclose(points.place, 1)).sum(axis=1)
    assert (on_edge >= 2).all()
    away = ((points.place - 0.5) * points.outward).sum(axis=1)
    assert (away > 0.3).all()


def test_a_cutting_edge_pushes_along_its_length_and_with_its_tips():
    ring = tooth_ring(n_teeth=1)
    points, ends = tool_points(ring, 0.4), ring.vertices[ring.edges]
    tip = ends[:, :, 2].argmin()
    away = np.linalg.norm(points.place - ends.reshape(-1, 3)[tip], axis=1)
    assert away.min() == 0.0
    assert points.radius[away.argmin()] == 0.0
    assert points.outward[away.argmin(), 2] < -0.5
    # The others know their segment and lie on it, no farther apart than half an edge of the film.
    on = np.flatnonzero((points.segment >= 0) & (points.radius > 0.0))
    start, vector = ends[points.segment[on], 0], np.diff(ends, axis=1)[points.segment[on], 0]
    share = ((points.place[on] - start) * vector).sum(axis=1) / (vector**2).sum(axis=1)
    np.testing.assert_allclose(points.place[on], start + share[:, None] * vector, atol=1e-9)
    assert ((share > 0.0) & (share < 1.0 + 1e-9)).all()
    blade = tool_points(straight_blade(height=3.0), 0.4)
    z = np.sort(blade.place[np.hypot(blade.place[:, 0], blade.place[:, 1]) < 1e-9, 2])
    assert np.diff(z).max() < 0.2 + 1e-9
    assert sorted(blade.place[blade.radius == 0.0, 2]) == pytest.approx([-1.5, 1.5], abs=1e-9)


def test_points_are_spread_and_share_their_stiffness():
    points = tool_points(ball(2.0, 3), 0.8)
    gaps = np.linalg.norm(points.place[:, None] - points.place[None], axis=2)
    np.fill_diagonal(gaps, np.inf)
    assert gaps.min() >= 0.4 * 0.8
    # What a node between them gets from all: about one node's stiffness.
    weight = np.clip(1.0 - gaps / 0.8, 0.0, None) @ points.share + points.share
    assert 0.8 < np.median(weight) < 1.25
    alone = tool_points(needle(), 0.8)
    tip = np.linalg.norm(alone.place, axis=1).argmin()
    assert alone.share[tip] > 0.9


def test_the_list_holds_every_point_in_the_box_of_a_whole_quad():
    sim = opening_test("quick", angle_deg=5.0, duration=4e-4).simulation
    points, s = term(sim), sim.state
    while not s.node.halved.any():
        sim.step()
    points._search(s, sim.pose)
    # By NumPy: the whole quads at the nodes near the tool, and the boxes around them.
    near = np.isin(s.quads, sim.contact.near.ids).any(axis=1)
    cut = (s.quad.share[: s.n_quad] < 1.0) | s.node.halved[s.quads].any(axis=1)
    whole = np.flatnonzero(near & ~cut)
    corners = s.node.x[s.quads[whole]]
    margin = points.law.capture + points._margin
    low, high = corners.min(axis=1) - margin, corners.max(axis=1) + margin
    p = sim.pose.to_space(points.points.place)[:, None]
    point, row = np.nonzero(((low < p) & (p < high)).all(axis=2))
    pairs = points.tables.pairs
    found = np.unique(np.column_stack([pairs.point_of_pair, pairs.row]), axis=0)
    np.testing.assert_array_equal(found, np.column_stack([point, whole[row]]))
    assert point.size > 20  # so there is something to find
    # Quads of one sheet hang together, and two sheets of a point have no common node.
    for k in np.unique(point):
        of_point = pairs.point_of_pair == k
        sheets = pairs.sheet_of_pair[of_point]
        nodes = [set(s.quads[pairs.row[of_point][sheets == i]].ravel()) for i in np.unique(sheets)]
        assert sum(map(len, nodes)) == len(set().union(*nodes))


def test_waiting_misses_nothing():
    waits, looks = pricked(), pricked()
    n_listed = 0
    while waits.motion.coordinate(waits.state.time) < 0.1:
        waits.step()
        if (tables := term(looks).tables) is not None:
            tables.waits.point[:] = tables.waits.pair[:] = 0.0
        looks.step()
        points = term(waits)
        n_listed += len(points.tables.pairs.point)
        assert points.forces[1:] == term(looks).forces[1:]
    assert points.forces.n_touching == 1
    assert points.n_looked < 0.5 * n_listed
    np.testing.assert_array_equal(waits.state.node.x, looks.state.node.x)


@pytest.mark.parametrize("on", [True, False])
def test_a_needle_between_nodes_is_felt_at_first_touch(on):
    wires = ToolWires(needle().translated((2.37, 0.21, GAP)))
    sim, touched, deepest = pricked(on), None, 0.0
    nowhere = np.zeros(len(sim.state.node.x), bool)
    while sim.motion.coordinate(sim.state.time) < 0.4:
        sim.step()
        if touched is None and sum(t.forces.wrench[0, 2] for t in sim.terms) > 0.0:
            touched = sim.motion.coordinate(sim.state.time)
        if sim.state.step % 50 == 0:
            _, depth = wires.crossed_quads(sim.state.node.x, sim.state.quads, nowhere, sim.pose)
            deepest = max(deepest, depth.max(initial=0.0))
    if not on:
        assert touched is None
        assert deepest > 0.3  # it goes through; half the thickness is 0.037 mm
        return
    assert GAP <= touched < GAP + 1e-3  # at the first step beyond the gap, of 0.4 µm
    assert deepest < 0.01
    ledger = sim.close_ledger()
    assert ledger.tool_work > 0.1
    assert abs(ledger.imbalance) < 1e-4 * ledger.tool_work
    # It gives back what it takes: no more is in it than the springs hold.
    assert ledger.contact_work == pytest.approx(ledger.contact_stored, rel=2e-3)
    assert felt_nodes(sim.terms).size == 4


def test_the_force_is_that_of_its_depth_and_shared_by_shape_functions():
    _, points, s, k = pressing()
    result = points.forces
    nodes, weights = points.carriers.node[k], points.carriers.weight[k]
    tip = points.points.place[points.point_of_sheet()[k]] - [0.0, 0.0, GAP + 0.02]
    foot = weights @ s.node.x[nodes]
    depth = np.linalg.norm(tip - foot)
    # The tip has the stiffness of a node, whose area is a quarter of a quad of 1 mm². The needle is
    # thin: the force sets in over an eighth of the volume over the surface of its twelve sides.
    slant = np.hypot(2.0, 0.5 * np.cos(np.pi / 12.0))
    surface = 0.75 + 12.0 * 0.5 * np.sin(np.pi / 12.0) * slant
    assert points.carriers.stiffness[k] == pytest.approx(1e4 * 0.25, rel=1e-12)
    size = 1e4 * 0.25 * smoothed(depth, 0.125 * (0.75 * 2.0 / 3.0) / surface)
    push = size * (tip - foot) / depth
    # Round-off: the foot is found to 1e-12 of the quad, the depth is some micrometres.
    np.testing.assert_allclose(s.node.force[nodes], weights[:, None] * push, rtol=1e-7)
    np.testing.assert_allclose(result.wrench[0, :3], -push, rtol=1e-7)
    arm = foot + np.array([0.0, 0.0, GAP + 0.02])
    np.testing.assert_allclose(result.wrench[0, 3:], -np.cross(arm, push), rtol=1e-7, atol=1e-9)
    assert weights.sum() == pytest.approx(1.0, rel=1e-14)
    # The pull of the film on the point is along its normal there.
    assert push[2] < -0.9 * size


def test_a_point_that_slides_over_the_mesh_is_felt_throughout():
    # The tip is drawn over the film in its plane, over sides and a node: its force does not jump.
    sim, _, _, _ = pressing(0.05)
    forces = np.array(
        [press(sim, 0.05, (d, 0.3 * d)).wrench[0, :3] for d in np.linspace(0.0, 0.9, 901)]
    )
    assert (forces[:, 2] > 0.0).all()
    # Steps of 1 µm along a film whose slopes are 0.04 at most: 0.04 µm of depth, of some 50 µm.
    assert np.abs(np.diff(forces, axis=0)).max() < 0.03 * np.abs(forces).max()


def test_film_at_a_crack_is_left_alone():
    sim, points, s, k = pressing()
    assert points.forces.stored > 0.0
    s.node.halved[points.carriers.node[k, 0]] = True
    s.revision += 1
    result = press(sim, 0.02)
    assert result.n_touching == 0
    assert not result.wrench.any()
    assert result.stored == 0.0


def test_it_counts_in_the_step():
    sim, points, s, k = pressing()
    nodes, stiffness = points.stiffness(s, {})
    total = np.bincount(nodes, stiffness, s.n_node)
    felt = points.carriers.node[k]
    share = points.points.share[points.point_of_sheet()[k]]
    steepest = share * sim.contact.law.steepest(s.node.contact_area[felt])
    assert (total[felt] >= points.carriers.weight[k] * steepest).all()
    assert total.max() < 3.0 * steepest.max()


# ---------------------------------------------------------------- friction
