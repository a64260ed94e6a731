"""Cables against their formulae, their potential, and the balance of forces and moments."""

import numpy as np
import pytest

from far_pose import FAR
from met_cable import numeric_stiffness
from naive import cable as naive
from shellcut.cables.cohesive_law import CohesiveLaw, CohesiveTable, area_below
from shellcut.cables.directional_cable import CableSet
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.state import BROKEN, JOINTED, NOT_MET, STRAIGHT
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring

LAW = CohesiveLaw()
AREA = 0.03
HERE = Pose.at_origin()
BLADE = straight_blade()  # edge x = y = 0, 3 > z > -3; blade at x < 0; plus is y > 0


def state_with(*pairs, m=(0.0, 1.0, 0.0)):
    """A state with one cable for each pair of end positions; spare rows poisoned."""
    n = len(pairs)
    state = initial_state(rectangle(2.0 * n + 1.0, 1.0, n_x=2 * n + 1, n_y=1))
    state.node.contact_area[:] = 0.25 * 0.4**2
    state.node.x[:] = np.nan
    for k, (minus, plus) in enumerate(pairs):
        assert state.cable.append_blank() == k
        state.cable.ends[k] = 2 * k, 2 * k + 1
        state.node.x[2 * k], state.node.x[2 * k + 1] = minus, plus
        state.cable.m[k] = m
        state.cable.branch[k] = m, -np.array(m)
        state.cable.area[k] = AREA
    return state


def at(*place):
    return Pose(np.eye(3), np.array(place, dtype=float))


def evaluate(cables, state, pose=HERE):
    """Forces on the nodes of the cables from one evaluation, and what it did."""
    state.node.force[:] = 0.0
    cables.add_forces(state, pose)
    return state.node.force[: 2 * state.n_cable].copy(), cables.forces


def random_cables(seed=0):
    rng = np.random.default_rng(seed)
    m = np.array([0.6, 0.8, 0.0])
    sizes = [1e-4, 2e-3, 0.03, 0.3, 1.0, 3.4, 4.5]
    pairs = []
    for size in sizes:
        a = rng.uniform(-1, 1, 3)
        w = m + 0.8 * rng.uniform(-1, 1, 3)
        pairs.append((a, a + size * w / np.linalg.norm(w)))
    return state_with(*pairs, m=m)


EXPONENTIAL = CohesiveTable.exponential(strength=18.0, fracture_energy=8.0)


@pytest.mark.parametrize(
    "law", [LAW, CohesiveLaw(onset=0.0), EXPONENTIAL], ids=["paper", "no onset", "exponential"]
)
@pytest.mark.parametrize("loaded", [True, False])
def test_straight_cables_match_the_naive_twin(law, loaded):
    state = random_cables()
    c = state.cable
    if not loaded:  # unloaded from 1.02 of the present length
        c.opening_max[:7] = [2e-4, 3e-3, 0.0302, 0.302, 1.002, 3.401, 4.6]
    largest = c.opening_max[:7].copy()
    forces, result = evaluate(CableSet(law, None), state)
    for k in range(7):
        minus, plus = state.node.x[2 * k : 2 * k + 2]
        ell, f_minus, f_plus = naive.straight(minus, plus, c.m[k], AREA, largest[k], law)
        assert c.opening[k] == pytest.approx(ell, abs=1e-15)
        assert c.opening_max[k] == max(c.opening[k], largest[k])
        # Round-off of a difference of positions of 1 mm, 1e-16, in a length of delta_0 = 5e-3; with
        # the slope 18 / delta_0 of the unloading, 1e-12 of the strength.
        scale = 1e-11 * law.strength * AREA
        np.testing.assert_allclose(forces[2 * k], f_minus, rtol=0, atol=scale)
        np.testing.assert_allclose(forces[2 * k + 1], f_plus, rtol=0, atol=scale)
    assert (c.status[:7] == [STRAIGHT] * 6 + [BROKEN]).all()
    assert result.n_broken == 1
    assert not result.wrench.any()
    again, result = evaluate(CableSet(law, None), state)
    assert not again[12:].any()  # broken for good
    assert result.n_broken == 0


MET = np.array(
    [
        ([-0.01, -0.3, 0.5], [-0.01, 0.2, 0.7]),
        ([-0.02, -0.004, -1.0], [-0.01, 0.006, -1.001]),
        ([-0.3, -0.5, 2.0], [-0.2, 0.9, 2.4]),
    ]
)
"""Ends of cables where the edge meets them, in the frame of the blade, and their m there."""
MET_M = np.array([0.0, 1.0, 0.0])
EDGE = np.zeros(3), np.array([0.0, 0.0, 1.0]), np.array([0.0, 1.0, 0.0])
"""A point of the edge, its direction and the normal to the blade's mid-plane."""


def jointed_cables(pose, tool=BLADE, law=LAW):
    """Three cables that the edge has just met, opened further since."""
    rotation, translation = pose
    space = [tuple(rotation @ p + translation for p in pair) for pair in MET]
    m = rotation @ MET_M
    state = state_with(*space, m=m)
    cables = CableSet(law, tool)
    _, result = evaluate(cables, state, pose)
    assert result.n_joint_made == 3
    assert (state.cable.status[:3] == JOINTED).all()
    rng = np.random.default_rng(8)
    state.node.x[:6] += rng.uniform(-0.2, 0.2, (6, 3))
    return cables, state


@pytest.mark.parametrize(
    "law",
    [LAW, CohesiveLaw(cutting_energy=30.0), EXPONENTIAL],
    ids=["whole", "severed", "exponential"],
)
def test_jointed_cables_match_the_naive_twin_and_their_sum_goes_to_the_tool(law):
    cables, state = jointed_cables(FAR, law=law)
    c, at_edge = state.cable, law
    if law.cutting_energy is not None:
        at_edge = naive.severed(law, law.cutting_energy)
    forces, result = evaluate(cables, state, FAR)
    assert result.n_joint_made == 0  # there is never a second one
    for k in range(3):
        joint, slack = naive.met(*MET[k], MET_M, law.onset, *EDGE)
        joint = FAR[0] @ joint + FAR[1]
        np.testing.assert_allclose(c.joint[k], joint, atol=1e-14)
        assert c.joint_slack[k] == pytest.approx(slack, abs=1e-14)
        minus, plus = state.node.x[2 * k : 2 * k + 2]
        largest = naive.opening(*MET[k], MET_M, law.onset)
        ell, f_minus, f_plus = naive.jointed(minus, plus, joint, slack, AREA, largest, at_edge)
        assert c.opening[k] == pytest.approx(ell, abs=1e-14)
        np.testing.assert_allclose(forces[2 * k], f_minus, rtol=0, atol=1e-12)
        np.testing.assert_allclose(forces[2 * k + 1], f_plus, rtol=0, atol=1e-12)
    np.testing.assert_allclose(result.wrench[0, :3], -forces.sum(axis=0), atol=1e-15)


def test_first_step_pulls_along_m_whatever_the_onset_and_then_along_w():
    for law in (LAW, CohesiveLaw(onset=0.0)):
        m = np.array([0.6, 0.0, 0.8])
        state = state_with(([1, 2, 3], [1, 2, 3]), m=m)
        cables = CableSet(law, None)
        forces, _ = evaluate(cables, state)
        np.testing.assert_allclose(forces[0], law.strength * AREA * m, rtol=1e-13, atol=1e-16)
        np.testing.assert_allclose(forces[1], -forces[0])
    # [Frangi2010] 4, literal: onset = 0.
    state.node.x[1] += [1e-5, 0.0, 0.0]
    forces, result = evaluate(cables, state)
    np.testing.assert_allclose(forces[0], [law.traction(1e-5) * AREA, 0, 0], rtol=1e-9)
    assert np.abs(result.couple).max() < 1e-20


def test_short_branch_keeps_its_last_direction():
    cables, state = jointed_cables(HERE)
    evaluate(cables, state)
    before = state.cable.branch[0].copy()
    state.node.x[1] = state.cable.joint[0] + [9e-4, 0.0, 0.0]
    forces, _ = evaluate(cables, state)
    np.testing.assert_array_equal(state.cable.branch[0, 1], before[1])
    np.testing.assert_allclose(forces[1], state.cable.traction[0] * AREA * before[1], rtol=1e-14)
    state.node.x[1] = state.cable.joint[0] + [1.1e-3, 0.0, 0.0]
    evaluate(cables, state)
    np.testing.assert_allclose(state.cable.branch[0, 1], [-1, 0, 0], atol=1e-12)


# --- finding the joint -------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("minus", "plus", "met"),
    [
        ((1e-6, -0.2, 0), (1e-6, 0.2, 0), False),  # the edge has not come yet
        ((-1e-6, -0.2, 0), (-1e-6, 0.2, 0), True),
        ((-1.0, -0.2, 0), (-1.0, 0.2, 0), True),  # born 1 mm late
        ((-1.6, -0.2, 0), (-1.6, 0.2, 0), False),  # behind the blade
        ((-0.01, -0.2, 3.1), (-0.01, 0.2, 3.1), False),  # above the edge's end
        ((-0.01, -0.2, -3.1), (-0.01, 0.2, -3.1), False),  # below it
        ((-0.01, 0.1, 0), (-0.01, 0.4, 0), False),  # both ends on the plus side
        ((-0.01, -0.4, 0), (-0.01, -0.1, 0), False),
        ((0.2, -0.2, 0), (-0.3, 0.2, 0), True),  # crosses the mid-plane at x = -0.05
        ((0.3, -0.2, 0), (-0.2, 0.2, 0), False),  # crosses it at x = +0.05, ahead of the edge
        ((-0.01, -1e-9, 0), (-0.01, 1e-9, 0), True),  # hardly opened yet
        ((-0.01, 0.2, 0), (-0.01, -0.2, 0), True),  # either way round
    ],
)
@pytest.mark.parametrize("pose", [HERE, FAR], ids=["here", "far"])
def test_joint_is_a_matter_of_positions(minus, plus, met, pose):
    ends = [pose[0] @ p + pose[1] for p in (minus, plus)]
    state = state_with(ends, m=pose[0] @ [0.0, 1.0, 0.0])
    _, result = evaluate(CableSet(LAW, BLADE), state, pose)
    assert result.n_joint_made == int(met)
    assert state.cable.status[0] == (JOINTED if met else STRAIGHT)
    state = state_with(ends)
    evaluate(CableSet(LAW, BLADE, directional=False), state, pose)
    assert state.cable.status[0] == STRAIGHT


@pytest.mark.parametrize("tool", [BLADE, tooth_ring()], ids=["blade", "teeth"])
@pytest.mark.parametrize("pose", [HERE, FAR], ids=["here", "far"])
def test_the_joint_is_on_the_edge_beside_where_the_cable_crosses_the_mid_plane(tool, pose):
    """Wherever on the cable that is, and however it lies: twenty cables, each by itself."""
    rng, off = np.random.default_rng(5), []
    for _ in range(20):
        k = int(rng.integers(tool.n_edge))
        start, stop = tool.vertices[tool.edges[k]]
        along, normal = (stop - start) / np.linalg.norm(stop - start), tool.edge_normal[k]
        crossing = tool.point(k, rng.uniform(0.3, 0.7)) + 0.01 * tool.edge_back[k]
        # From the crossing to the plus side, off the normal; back along the same line by any part.
        way = normal + rng.uniform(-0.5, 0.5) * along + rng.uniform(-0.02, 0.02) * tool.edge_back[k]
        share, size = rng.uniform(0.02, 0.98), rng.uniform(0.01, 0.1)
        minus, plus = crossing - share * size * way, crossing + (1.0 - share) * size * way
        cables = CableSet(LAW, tool)
        state = state_with(pose.to_space(np.array([minus, plus])), m=pose.rotation @ normal)
        evaluate(cables, state, pose)
        c = state.cable
        assert c.edge[0] == k
        joint, slack = naive.met(minus, plus, normal, LAW.onset, start, along, normal)
        np.testing.assert_allclose(c.joint_body[0], joint, atol=1e-12)
        np.testing.assert_allclose(c.joint[0], pose.to_space(joint[None])[0], atol=1e-12)
        assert c.joint_slack[0] == pytest.approx(slack, abs=1e-12)
        assert c.overshoot[0] == pytest.approx(0.01, rel=1e-9)
        off.append(np.linalg.norm(joint - crossing))
    np.testing.assert_allclose(off, 0.01, rtol=1e-9)


def test_each_tooth_gets_its_own_wrench():
    tool, pairs = tooth_ring(), []
    for body in range(4):
        k = np.flatnonzero(tool.edge_body == body)[2]
        p = tool.point(int(k), 0.5) + 0.01 * tool.edge_back[k]
        pairs.append((p - 0.2 * tool.edge_normal[k], p + 0.1 * tool.edge_normal[k]))
    state = state_with(*pairs)
    across = np.diff(pairs, axis=1)[:, 0]
    state.cable.m[:4] = across / np.linalg.norm(across, axis=1)[:, None]
    forces, result = evaluate(CableSet(LAW, tool), state)
    assert (tool.edge_body[state.cable.edge[:4]] == [0, 1, 2, 3]).all()
    push = -forces.reshape(4, 2, 3).sum(axis=1)
    assert np.abs(push).max() > 0.01
    np.testing.assert_allclose(result.wrench[:, :3], push, atol=1e-14)
    moment = np.cross(state.cable.joint[:4], push)
    np.testing.assert_allclose(result.wrench[:, 3:], moment, atol=1e-12)


# --- work --------------------------------------------------------------------------------------


@pytest.mark.parametrize("joint", ["adhesion", "free"])
def test_a_new_joint_takes_up_what_the_tool_gives(joint):
    """Half of its first force acts on the way of the step, on the tool as on the cable."""
    state = state_with(([-0.14, -0.01, 0.0], [-0.14, 0.01, 0.0]))
    cables = CableSet(CohesiveLaw(joint=joint), BLADE)
    state.node.velocity_half[:2] = 0.0
    state.dt = 1e-6
    evaluate(cables, state, at(-0.145, 0, 0))
    assert state.cable.status[0] == STRAIGHT
    _, result = evaluate(cables, state, HERE)
    assert result.n_joint_made == 1
    given = -0.5 * result.wrench[0, 0] * 0.145
    assert given > 0.1 * LAW.strength * AREA * 0.145
    # Round-off: nothing else moves, and the joint has nowhere to slip to.
    assert result.work == pytest.approx(given, rel=1e-12)
    assert result.friction_work == 0.0


@pytest.mark.parametrize(
    ("area", "opened", "back"),
    [(1.0, 0.02, 0.0), (12.0, 0.02, 0.3), (1.0, 1.6, 0.3), (30.0, 0.4, 0.3), (12.0, 1.6, 0.0)],
)
def test_an_edge_severs_a_cable_at_its_own_area_and_the_books_hold_the_rest(area, opened, back):
    """Torn open by ``opened``, unloaded by a part of it, then met and drawn out by the blade."""
    law = CohesiveLaw(cutting_energy=area)
    state = state_with(([0, 0, 0], [0, 0, 0]))
    state.cable.edge[0] = NOT_MET
    cables, place = CableSet(law, BLADE), np.array([-4.0, 0.0, 0.0])
    evaluate(cables, state, at(*place))
    state.dt = 1e-6

    def moved(by, way=0.0, n=2000):
        step = 0.5 * by / n * np.array([[0, -1.0, 0], [0, 1.0, 0]])
        state.node.velocity_half[:2] = step / state.dt
        for _ in range(n):
            state.node.x[:2] += step
            place[0] += way / n
            evaluate(cables, state, at(*place))

    def booked():
        assert state.cable.work[0] == pytest.approx(sum(cables.energies(state)), rel=3e-3)

    moved(opened)
    booked()
    moved(-back * opened)
    assert state.cable.status[0] == STRAIGHT
    most = state.cable.opening_max[0]
    moved(0.0, 3.999)
    moved(0.0, 0.002)
    booked()  # on the law of the edge, or severed at once
    moved(0.0, 4.0, 6000)
    c, whole, cut = state.cable, law.parameters(), law.at_edge(0.0).parameters()
    assert c.status[0] == BROKEN
    shed = area_below(most, whole) - area_below(most, cut)
    # What it has not got back of the way from its largest opening is not shed.
    left = 0.5 * (1.0 - (1.0 - back) ** 2) * most
    shed -= (law.traction(most) - law.at_edge(0.0).traction(most)) * left
    assert c.shed[0] == pytest.approx(shed, abs=1e-9 + 2e-3 * area)
    assert cables.energies(state) == (0.0, pytest.approx((area + c.shed[0]) * AREA, rel=1e-12))
    booked()


def test_the_start_force_works_by_what_is_left_of_it_over_each_step():
    """Two cables are opened, closed and opened on in long steps; all four ends move."""
    m, starts = np.array([0.0, 1.0, 0.0]), np.array([[0.05, -0.1, 0.2], [-0.3, 0.05, 0.1]])
    state = state_with(([0, 0, 0], [0, 0, 0]), ([1, 0, 0], [1, 0, 0]), m=m)
    state.cable.start_force[:2] = starts
    cables, rng = CableSet(LAW, None), np.random.default_rng(4)
    before, _ = evaluate(cables, state)
    np.testing.assert_allclose(before[::2], starts + LAW.strength * AREA * m, rtol=1e-13)
    state.dt, largest, works = 1e-6, np.zeros(2), []
    for way in (0.012, 0.015, -0.02, 0.016, -0.01, 0.019, 0.025, 0.2, 0.1):
        moves = 0.2 * abs(way) * rng.standard_normal((2, 2, 3))
        moves[:, :, 1] += [-0.5 * way, 0.5 * way]
        state.node.velocity_half[:4] = moves.reshape(4, 3) / state.dt
        state.node.x[:4] += moves.reshape(4, 3)
        forces, result = evaluate(cables, state)
        wanted = np.zeros(2)
        for k in range(2):
            left = naive.fade(largest[k], LAW.start_opening)
            opened = naive.opening(*state.node.x[2 * k : 2 * k + 2], m, LAW.onset)
            largest[k] = max(largest[k], opened)
            left += naive.fade(largest[k], LAW.start_opening)
            wanted[k] = 0.5 * left * starts[k] @ (moves[k, 1] - moves[k, 0])
        assert result.start_work == pytest.approx(wanted.sum(), rel=1e-11, abs=1e-16)
        # The nodes give what the law and the start take.
        given = -0.5 * ((before + forces) * moves.reshape(4, 3)).sum()
        assert result.work + result.start_work == pytest.approx(given, rel=1e-11)
        works.append(wanted)
        before = forces
    np.testing.assert_allclose(state.cable.start_work[:2], np.sum(works, axis=0), rtol=1e-11)
    assert (np.abs(works[:6]).min(axis=1) > 1e-6).sum() > 4
    assert (works[-1] == 0.0).all()


# --- stiffness for the stable step -------------------------------------------------------------


def test_stiffness_bounds_the_true_one():
    for cables, state in (
        (CableSet(LAW, None), random_cables()),
        jointed_cables(HERE),
        jointed_cables(HERE, law=CohesiveLaw(cutting_energy=30.0)),
    ):
        state.time = 1.0  # not newborn
        evaluate(cables, state, HERE)
        nodes, bound = cables.stiffness(state, {})
        live = np.flatnonzero(state.cable.status[: state.n_cable] != BROKEN)
        assert nodes.tolist() == [n for k in live for n in (2 * k, 2 * k + 1)]
        for node, limit in zip(nodes, bound, strict=True):
            true = numeric_stiffness(cables, state, node)
            # A straight cable counts twice, for its two ends may move against each other.
            factor = 2.0 if state.cable.status[node // 2] == STRAIGHT else 1.0
            assert factor * true <= limit * (1 + 1e-4)
            assert factor * true > 0.3 * limit


def test_newborn_cable_counts_with_its_full_strength():
    cables = CableSet(LAW, BLADE)
    _, result = evaluate(cables, state_with())  # none yet
    assert (result.work, result.n_broken, result.n_joint_made) == (0.0, 0, 0)
    assert result.wrench.shape == (1, 6)
    state = state_with(([0, 0, 0], [0, 0, 0]))
    _, bound = cables.stiffness(state, {})  # before any evaluation
    np.testing.assert_allclose(bound, 2 * 18.0 * AREA / LAW.onset, rtol=1e-14)
