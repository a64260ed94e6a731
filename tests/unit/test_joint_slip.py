"""Joints that slip along the cutting edge, and cables that slip around it."""

import numpy as np
import pytest
import scipy.optimize

import shellcut as sc
from blunt_tools import needle, prism
from far_pose import FAR
from met_cable import AREA, evaluated, met_cable
from naive import cable as naive
from shellcut.cables.joint_slip import neighbours
from shellcut.state import BROKEN
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring

FREE = sc.CohesiveLaw(joint="free")
BLADE = straight_blade(height=40.0)  # edge x = y = 0, blade at x < 0, plus is y > 0


def slip(mu):
    return sc.CohesiveLaw(joint="slip", joint_friction=mu)


def one_cable(law, minus, plus, *, pose=None, tool=BLADE):
    return met_cable(law, tool, minus, plus, pose)


def pulls(state):
    """Tensions of the minus and the plus branch [N]."""
    return np.linalg.norm(state.cable.force[0], axis=1)


ENDS = [
    ((-0.4, -0.3, 0.5), (-0.6, 0.2, 0.7)),
    ((-1.2, -0.05, -0.4), (-1.0, 0.05, 0.9)),
    ((-0.02, -0.3, 1.0), (-0.5, 0.1, -1.0)),
    ((-0.9, -0.3, 1.4), (-0.8, 0.3, 1.2)),
]


@pytest.mark.parametrize("pose", [Pose.at_origin(), Pose.of(*FAR)], ids=["here", "far"])
@pytest.mark.parametrize("ends", ENDS)
def test_a_free_joint_lies_where_the_cable_is_shortest(ends, pose):
    cables, state = one_cable(FREE, (-0.01, -0.3, 0.0), (-0.01, 0.3, 0.0), pose=pose)
    forces = evaluated(cables, state, *ends, pose)

    def length(z):
        return sum(np.linalg.norm(np.subtract(end, (0, 0, z))) for end in ends)

    shortest = scipy.optimize.minimize_scalar(length, bounds=(-5, 5), options={"xatol": 1e-12})
    # A minimum is found to the root of the precision.
    np.testing.assert_allclose(state.cable.joint_body[0], [0, 0, shortest.x], atol=3e-8)
    on_tool = pose.rotation.T @ forces.wrench[0, :3]
    assert abs(on_tool[2]) < 1e-13  # round-off: a smooth edge takes no force along itself
    assert np.linalg.norm(on_tool) > 0.1


@pytest.mark.parametrize("mu", [0.05, 1.0])
@pytest.mark.parametrize("ends", ENDS)
def test_a_joint_slips_to_the_limit_of_friction_and_no_farther(ends, mu):
    cables, state = one_cable(slip(mu), (-0.01, -0.3, 3.0), (-0.01, 0.3, 3.0))
    evaluated(cables, state, *ends)
    place = naive.place_at_rest(
        *np.array(ends), np.zeros(3), *np.array([(0, 0, 1), (-1, 0, 0), (0, 1, 0)]), 3.0, mu
    )
    assert place < 3.0
    assert state.cable.joint_body[0, 2] == pytest.approx(place, abs=1e-10)
    # There it stays, bit for bit, whatever the stress: friction grows with the tension.
    slipped = state.cable.joint_body[0].copy()
    for _ in range(3):
        cables.add_forces(state, Pose.at_origin())
    np.testing.assert_array_equal(state.cable.joint_body[0], slipped)


def dragged(law, xi, n=4000):
    """Drag one cable by a blade that advances by 1 and slides by xi per time, to its end."""
    w = 1e-3  # of 4 mm: the branches are parallel
    cables, state = one_cable(law, (-1e-6, -w, 0.0), (-1e-6, w, 0.0))
    begin = sum(cables.energies(state))  # of the opening 2 w that it was born with
    state.dt = dt = 2.2 / n
    work, friction, last = np.zeros(3), 0.0, np.zeros(3)
    motion = np.array([1.0, 0.0, xi])
    for k in range(1, n + 1):
        state.time = k * dt
        cables.add_forces(state, Pose(np.eye(3), state.time * motion))
        done = cables.forces
        force = -done.wrench[0, :3]
        work += 0.5 * (force + last) * dt * motion
        friction += done.friction_work
        last = force
    assert state.cable.status[0] == BROKEN
    return work, friction, cables.energies(state)[1] - begin, state


@pytest.mark.parametrize(
    ("mu", "xi"),
    [(None, 0.5), (None, 2.0), (0.0, 1.0), (0.2, 0.0), (0.2, 2.0), (0.6, 0.5), (0.6, 2.0)],
)
def test_slice_and_push_of_one_cable(xi, mu):
    law = {None: sc.CohesiveLaw(), 0.0: FREE}.get(mu) or slip(mu)
    (push, _, along), friction, dissipated, state = dragged(law, xi)
    whole = law.fracture_energy * AREA
    rho = xi if mu is None else min(xi, 0.5 * np.pi * mu)
    # First step and onset: 5e-3 mm of 2 mm; for the friction, w of the way until it has built up.
    assert push / whole == pytest.approx(1.0 / (1.0 + rho**2), rel=5e-3)
    assert along / whole == pytest.approx(xi * rho / (1.0 + rho**2), rel=5e-3, abs=1e-12)
    assert friction / whole == pytest.approx(rho * (xi - rho) / (1.0 + rho**2), rel=1e-2, abs=1e-12)
    # The ledger: a step is 1/4000 of the way, the first of them from a standing start.
    assert push + along == pytest.approx(dissipated + friction, rel=5e-4)
    assert state.cable.grip[0] == 0.0  # nothing goes around the edge


def test_around_the_edge_the_tensions_part_as_euler_says():
    mu, n, way = 0.3, 400, 0.2
    cables, state = one_cable(slip(mu), (-0.01, -0.3, 0.0), (-0.01, 0.3, 0.0))
    ends = np.array([(-0.6, -0.2, 0.0), (-0.6, 0.2, 0.0)])
    evaluated(cables, state, *ends)
    begin = sum(cables.energies(state))
    state.dt = 1.0
    ratios, done, friction, by_law = [], 0.0, 0.0, 0.0
    # The minus end runs away from the edge, the plus end comes nearer by half as much.
    step = np.array([(-way / n, 0, 0), (0.5 * way / n, 0, 0)])
    state.node.velocity_half[:2] = step
    for _ in range(n):
        before = state.cable.force[0].copy()
        ends = ends + step
        result = evaluated(cables, state, *ends)
        done -= np.sum(0.5 * (before + state.cable.force[0]) * step)
        friction += result.friction_work
        by_law += result.work
        ratios.append(np.divide(*pulls(state)))
    branches = ends[:, :2] / np.linalg.norm(ends[:, :2], axis=1)[:, None]
    turn = np.pi - np.arccos(branches[0] @ branches[1])
    assert ratios[-1] == pytest.approx(np.exp(mu * turn), rel=1e-9)
    assert ratios[0] < 1.1  # it builds up over the sliding way
    assert friction > 0.0
    # Each part by its own forces, and together all that the nodes have done.
    assert by_law == pytest.approx(sum(cables.energies(state)) - begin, rel=1e-5)
    assert by_law + friction == pytest.approx(done, rel=1e-12)
    # Turned round, it sticks first and then slides the other way.
    for _ in range(n):
        ends = ends - step
        evaluated(cables, state, *ends)
    assert np.divide(*pulls(state)) == pytest.approx(np.exp(-mu * turn), rel=0.05)


def test_cables_that_an_edge_severs_slip_by_the_law_that_they_have_there():
    """The way over which friction sets in is a share of their own opening, not of the film's."""
    film = sc.CohesiveLaw(
        cutting_energy=10.0, severing_pressure=400.0, joint="slip", joint_friction=0.3
    )
    edge, ends = film.at_edge(0.0), np.array([(-0.1, -0.05, 0.0), (-0.1, 0.05, 0.0)])
    found = []
    for law in (film, edge):
        cables, state = one_cable(law, (-0.01, -0.05, 0.0), (-0.01, 0.05, 0.0))
        for k in range(4):
            evaluated(cables, state, *(ends + k * np.array([(-1e-4, 0.0, 0.0), (5e-5, 0.0, 0.0)])))
        found.append(pulls(state))
    assert found[0] == pytest.approx(found[1], rel=1e-12)
    assert found[0][0] > 1.01 * found[0][1] > 0.0  # it has begun to slip


def test_a_joint_goes_on_over_vertices_and_stays_at_the_open_end():
    tool = tooth_ring(n_teeth=1, radius=6.0)
    chain = tool.vertices[np.append(tool.edges[:, 0], tool.edges[-1, 1])]
    middle = tool.point(3, 0.5) + 0.01 * tool.edge_back[3]
    side = 0.2 * tool.edge_normal[3]
    cables, state = one_cable(FREE, middle - side, middle + side, tool=tool)
    back, normal = tool.edge_back[8], tool.edge_normal[8]
    minus = tool.point(8, 0.2) + 0.5 * back - 0.1 * normal
    ends = np.array([minus, tool.point(9, 0.3) + 0.5 * back + 0.2 * normal])
    evaluated(cables, state, *ends)
    assert state.cable.edge[0] in (8, 9)
    s = np.linspace(0.0, 1.0, 10_001)[:, None, None]
    places = chain[:-1] + s * np.diff(chain, axis=0)
    lengths = sum(np.linalg.norm(places - end, axis=2) for end in ends)
    to_joint = np.linalg.norm(ends - state.cable.joint_body[0], axis=1).sum()
    assert to_joint == pytest.approx(lengths.min(), abs=1e-8)
    blade = straight_blade(height=2.0)
    cables, state = one_cable(FREE, (-0.01, -0.3, 0.5), (-0.01, 0.3, 0.5), tool=blade)
    evaluated(cables, state, (-0.5, -0.3, 1.8), (-0.5, 0.3, 1.8))
    np.testing.assert_allclose(state.cable.joint_body[0], [0, 0, 1.0], atol=1e-15)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        (
            {"slice_ratio": 1.5, "tool": straight_blade(height=4.0)},
            r"slides by 2\.25 mm from -2 to 2 mm .* height of 5\.5 mm",
        ),
        ({"slice_ratio": 1.0, "tool": needle()}, "slice_ratio needs a cutting edge"),
    ],
)
def test_an_edge_that_leaves_the_film_is_refused(options, said):
    with pytest.raises(ValueError, match=said):
        sc.guillotine(1.0, length=6.0, width=4.0, travel=1.5, **options)


def test_a_square_whose_upper_edges_cut_is_a_closed_chain():
    square = prism([(0, 0), (1, 0), (1, 1), (0, 1)], 0, 1)
    box = sc.Tool.from_triangles(*square, edges=[(4, 5), (5, 6), (6, 7), (7, 4)])
    assert neighbours(box).tolist() == [[3, 1], [0, 2], [1, 3], [2, 0]]
    assert neighbours(None).shape == (0, 2)
