"""Cutting edges with a radius: the rounded tool, and cables around it."""

import numpy as np
import pytest

from blunt_tools import box
from met_cable import AREA, evaluated, met_cable, numeric_stiffness
from naive import cable
from naive import edge as naive
from shellcut import read_tool
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.tool.pose import Pose
from shellcut.tool.rounded_edge import with_edge_radius
from shellcut.tool.shapes import straight_blade, tooth_ring

LAW = CohesiveLaw()
FRAME = (np.zeros(3), np.array([0, 0, 1.0]), np.array([0, 1.0, 0]), np.array([-1.0, 0, 0]))


@pytest.mark.parametrize("radius", [1e-3, 0.05, 0.3])
def test_the_round_is_the_inscribed_circle_of_the_wedge(radius):
    alpha = np.radians(10.0)
    sharp, blade = straight_blade(), straight_blade(edge_radius=radius)
    assert blade.edge_radius == radius
    np.testing.assert_allclose(blade.vertices[blade.edges[0]], [[0, 0, 3], [0, 0, -3]], atol=1e-12)
    np.testing.assert_allclose(blade.edge_normal, [[0, 1, 0]], atol=1e-9)
    np.testing.assert_allclose(blade.edge_back, [[-1, 0, 0]], atol=1e-9)
    on_flank = np.unique(blade.triangles[blade.flank != 0])
    x, y, _ = blade.vertices[on_flank].T
    round_ends = radius * (1.0 - np.sin(alpha))  # behind the nose
    before = -x < round_ends + 1e-9
    assert np.hypot(x[before] + radius, y[before]) == pytest.approx(radius, rel=1e-9)
    assert before.sum() > 20
    # Behind it the flanks are those of the sharp blade, moved forward by as much as the nose.
    forward = radius / np.sin(alpha) - radius
    wedge = np.minimum((forward - x[~before]) * np.tan(alpha), 0.3)
    np.testing.assert_allclose(np.abs(y[~before]), wedge, atol=1e-12)
    lost = radius**2 * (1.0 / np.tan(alpha) - (0.5 * np.pi - alpha)) * 6.0
    # Facets of 10 degrees or less, within the round: a part (10°)²/6 of its sectors and less.
    facets = 0.006 * radius**2 * 0.5 * np.pi * 6.0
    assert 0.0 <= sharp.volume()[0] - blade.volume()[0] - lost <= facets
    assert (blade.flank == 1).sum() == (blade.flank == -1).sum()


def test_teeth_are_rounded_where_they_were_sharp():
    sharp, ring = tooth_ring(), tooth_ring(edge_radius=0.05)
    assert ring.n_body == 4
    assert ring.edge_radius == 0.05
    on_edge = ring.vertices[ring.edges].reshape(-1, 3)
    np.testing.assert_allclose(np.hypot(on_edge[:, 0], on_edge[:, 1]), 9.4, atol=1e-12)
    first = on_edge[: 2 * 15]
    s = 9.4 * np.arctan2(first[:, 1], first[:, 0])
    # The nose runs where the sharp edge did, but begins higher: the relief cuts it.
    np.testing.assert_allclose(first[:, 2], 0.02 + s * np.tan(np.radians(60.0)), atol=1e-9)
    assert 0.02 < first[:, 2].min() < 0.2
    assert (ring.volume() < sharp.volume() + 0.5).all()
    middle = ring.vertices[ring.edges].mean(axis=1)
    assert np.abs(np.hypot(middle[:, 0], middle[:, 1]) - 9.4).max() < 1e-3


def test_edges_of_a_file_are_rounded_and_no_radius_is_sharp(tmp_path):
    straight_blade().write(tmp_path / "blade.stl")
    blade = read_tool(tmp_path / "blade.stl", unit="mm", edge_radius=0.1)
    forward = 0.1 / np.sin(np.radians(10.0)) - 0.1
    nose = blade.vertices[blade.edges].reshape(-1, 3)
    # Single precision of the file, seen over the sine of the half-angle.
    np.testing.assert_allclose(nose[:, 0], -forward, atol=1e-5)
    assert blade.edge_radius == 0.1
    assert blade.without_cutting().edge_radius == 0.1
    assert blade.translated((1.0, 0.0, 0.0)).edge_radius == 0.1
    blade = straight_blade()
    assert with_edge_radius(blade, 0.0) is blade
    np.testing.assert_array_equal(straight_blade(edge_radius=0.0).vertices, blade.vertices)


NO_EDGE = box((0, 0, 0), (1, 1, 1))


@pytest.mark.parametrize(
    ("build", "said"),
    [
        (lambda: straight_blade(edge_radius=-0.1), "edge_radius must be a length in mm.* got -0.1"),
        (lambda: straight_blade(edge_radius=1e-6), "at least .* for a sharp edge take 0"),
        (lambda: straight_blade(edge_radius=0.5), "does not fit the tool: .* up to about 0.3"),
        (lambda: tooth_ring(edge_radius=2.0), "edge_radius = 2 mm does not fit the tool"),
        (lambda: with_edge_radius(straight_blade(edge_radius=0.1), 0.1), "already, by 0.1 mm"),
        (lambda: with_edge_radius(NO_EDGE, 0.1), "needs a cutting edge, and this tool has none"),
    ],
)
def test_radii_that_do_not_fit_are_refused(build, said):
    with pytest.raises(ValueError, match=said):
        build()


def one_cable(radius, *, law=LAW, pose=None, ends=((-1e-6, -0.3, 0.0), (-1e-6, 0.3, 0.0))):
    return met_cable(law, straight_blade(edge_radius=radius, height=12.0), *ends, pose)


PLACES = [
    ((-0.05, -0.3, 0.2), (-0.02, 0.25, 0.1)),
    ((-0.9, -0.2, 0.5), (-0.7, 0.25, -0.3)),
    ((-1.5, -0.15, 0.0), (-1.5, 0.15, 0.0)),
    ((0.1, -0.3, 0.1), (-0.8, 0.2, 0.4)),  # one end before the nose
    ((-1.2, -0.02, 0.2), (-1.2, 0.02, 0.2)),  # close together behind the round
    ((-0.05, -0.07, 0.5), (-0.09, 0.05, -0.4)),  # in the round, but for the smallest
]


def whole_length(x, radius):
    return sum(naive.length(x[k], 2 * k - 1, 0.0, FRAME, radius)[0] for k in (0, 1))


@pytest.mark.parametrize("radius", [0.02, 0.1, 0.25])
@pytest.mark.parametrize("ends", PLACES)
def test_the_cable_takes_the_shortest_way_and_its_force_is_the_gradient(ends, radius):
    cables, state = one_cable(radius)
    result = evaluated(cables, state, *ends)
    c, x = state.cable, state.node.x[:2].copy()
    # It was met at z = 0, where it crosses the mid-plane, and there the law went on.
    np.testing.assert_allclose(c.joint_body[0], 0.0, atol=1e-12)
    born = np.array([(-1e-6, -0.3, 0.0), (-1e-6, 0.3, 0.0)])
    opened = cable.opening(*born, np.array([0.0, 1.0, 0.0]), LAW.onset)
    reached = whole_length(x, radius) - whole_length(born, radius) + opened
    assert c.opening[0] == pytest.approx(reached, abs=1e-12)
    stress = cable.stress(reached, max(reached, opened), LAW)
    # Differences of a length: 1e-6² of truncation over 0.02 mm, round-off 1e-16 / 1e-6.
    for node in (0, 1):
        for axis in np.eye(3):
            moved = np.zeros((2, 3))
            moved[node] = 1e-6 * axis
            slope = (whole_length(x + moved, radius) - whole_length(x - moved, radius)) / 2e-6
            assert c.force[0, node] @ axis == pytest.approx(-AREA * stress * slope, abs=2e-8)
    np.testing.assert_allclose(result.wrench[0, :3], -c.force[0].sum(axis=0), atol=1e-15)


def test_friction_on_the_arc_is_that_of_a_stretching_belt():
    mu, radius, n = 0.3, 0.1, 2000
    law = CohesiveLaw(joint="slip", joint_friction=mu)
    cables, state = one_cable(radius, law=law)
    w = 1.001 * radius  # the ends come to run back almost parallel
    evaluated(cables, state, (0.0, -w, 0.0), (0.0, w, 0.0))
    state.cable.opening_max[0] = state.cable.opening[0]
    friction, expected, before = 0.0, 0.0, None
    for k in range(1, n + 1):
        cables.add_forces(state, Pose(np.eye(3), np.array([1.5 * k / n, 0.0, 0.0])))
        friction += cables.forces.friction_work
        c = state.cable
        length = c.opening[0] + c.joint_slack[0]
        (_, phi) = naive.rho_and_turn(w, 1.5 * k / n, radius)
        half = mu * phi  # of both sides together 2 phi
        held = 2.0 * phi * radius * (1.0 - (1.0 - np.exp(-half)) / half)
        now = c.traction[0] * AREA * held / (length - held)
        if before is not None:
            expected += 0.5 * (now + before[0]) * (length - before[1])
        before = now, length
    assert c.arc_grip[0] == pytest.approx(held / (length - held), rel=1e-9)
    assert abs(c.grip[0]) < 1e-12  # round-off: both sides are alike
    # It sets in over the sliding way: a hundredth of a millimetre of some tenths.
    assert friction == pytest.approx(expected, rel=0.03)
    assert friction / (law.fracture_energy * AREA) > 0.02


@pytest.mark.parametrize("mu", [0.0, 0.4])
@pytest.mark.parametrize("radius", [0.02, 0.1, 0.25])
def test_stiffness_bounds_the_true_one(radius, mu):
    law = CohesiveLaw(joint="slip", joint_friction=mu) if mu else LAW
    r, off = radius, (1.0 + 1e-3) * radius  # just outside the round: the pull turns the fastest
    close = [
        ((-r, -off, 0.2), (-r, off, 0.1)),
        ((-0.6 * r, -0.95 * r, 0.0), (-1.4 * r, 1.05 * r, 0.3)),
        ((-3.0 * r, -off, 0.0), (-2.0 * r, off, -0.2)),
    ]
    for ends in (*PLACES, *close):
        cables, state = one_cable(radius, law=law)
        pose = Pose.at_origin()
        evaluated(cables, state, *ends)
        if mu:  # the edge goes on and drags the cable along, up to what friction can hold
            pose = Pose(np.eye(3), np.array([0.01, 0.003, 0.0]))
            cables.add_forces(state, pose)
        nodes, bound = cables.stiffness(state, {})
        assert nodes.tolist() == [0, 1]
        for node, limit in zip(nodes, bound, strict=True):
            true = numeric_stiffness(cables, state, node, pose)
            assert true <= limit * (1 + 1e-4)
            if not mu:  # of friction no more is known than that it adds up
                assert true > 0.6 * limit
