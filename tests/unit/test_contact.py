"""Penalty contact: the law, which face, jumps, balance, the search."""

import numpy as np
import pytest

from naive import cases
from naive import contact as naive
from shellcut.contact import (
    ABSORB_TIME,
    JUMP,
    STEEPEST,
    Contact,
    PenaltyContact,
    smoothed,
    smoothed_integral,
)
from shellcut.meshing import rectangle
from shellcut.motion import ScrewMotion
from shellcut.state import initial_state
from shellcut.tool_shapes import straight_blade, tooth_ring

HERE = np.eye(3), np.zeros(3)
POSE = ScrewMotion(300.0, pitch=7.0, axis=(1, 2, 3), axis_point=(0.3, -1, 0.2)).pose(0.004)
BLADE = straight_blade()
H = 0.074
G_M = H / 4
AREA = 0.04
FOREVER = 1.0  # a step so long that every absorbed jump has decayed


def test_force_law_is_continuous_in_value_and_slope():
    g = np.linspace(0, 2 * G_M, 20_001)
    f = np.array([smoothed(v, G_M) for v in g])
    assert f[0] == 0.0
    assert smoothed(0.3, G_M) == 0.3
    slope = np.diff(f) / np.diff(g)
    # A jump of the slope would be a jump of one; its steps are below 1e-3.
    assert np.abs(np.diff(slope)).max() < 1e-3
    assert slope[0] == pytest.approx(0.0, abs=1e-6)
    assert slope[-1] == pytest.approx(1.0, rel=1e-9)
    # Steepest at ¾ g_M: 9 (3/4)² - 8 (3/4)³ = 27/16.
    assert slope.max() == pytest.approx(STEEPEST, rel=1e-6)
    assert g[np.argmax(slope)] == pytest.approx(0.75 * G_M, rel=1e-2)
    assert [naive.smoothed(v, G_M) for v in g[::500]] == pytest.approx(f[::500], rel=1e-13)


def test_integral_of_the_force_law():
    for end in (0.3 * G_M, G_M, 1.7 * G_M, 10 * G_M):
        g = np.linspace(0, end, 4001)
        area = np.trapezoid([smoothed(v, G_M) for v in g], g)
        # Trapezoids: second order in 1/4000.
        assert smoothed_integral(end, G_M) == pytest.approx(area, rel=1e-5)
    assert smoothed_integral(G_M * (1 - 1e-12), G_M) == pytest.approx(
        smoothed_integral(G_M, G_M), rel=1e-10
    )


def nodes_at(points, far=(50.0, 60.0, 70.0)):
    """A state whose first nodes lie at some points; the others are far away."""
    n = len(points)
    state = initial_state(rectangle(float(n), 1.0, n_x=n, n_y=1))
    state.node.x[: state.n_node] = far
    state.node.x[:n] = points
    state.node.contact_area[:] = AREA
    state.node.x[state.n_node :] = np.nan
    state.dt = FOREVER
    return state


def evaluate(contact, state, pose=HERE):
    state.node.force[:] = 0.0
    result = contact.add_forces(state, *pose)
    return state.node.force[: state.n_node].copy(), result


def points_in_and_around(tool, n, seed):
    """Half of them all over the box, half under the faces: a box is mostly outside a thin tooth."""
    rng = np.random.default_rng(seed)
    spread = rng.uniform(*tool.bounding_box(), (n, 3))
    k = rng.integers(tool.n_triangle, size=n)
    weights = rng.dirichlet([1, 1, 1], n)
    under = np.einsum("kc,kci->ki", weights, tool.vertices[tool.triangles[k]])
    under -= 10.0 ** rng.uniform(-3, -0.7, (n, 1)) * tool.triangle_normals[k]
    return np.vstack([spread, under])


RING = tooth_ring(n_teeth=2, n_arc=4, length=1.0, height=1.5)
TOOLS = pytest.mark.parametrize("tool", [BLADE, RING], ids=["blade", "ring"])
POSES = pytest.mark.parametrize("pose", [HERE, POSE], ids=["here", "far"])


@POSES
@TOOLS
def test_forces_match_brute_force_over_all_triangles(tool, pose):
    points = points_in_and_around(tool, 12, seed=3) @ pose[0].T + pose[1]
    state = nodes_at(points)
    forces, result = evaluate(PenaltyContact(tool, Contact(penalty=2e4), H), state, pose)
    wrench = np.zeros((tool.n_body, 6))
    inside = 0
    for n, p in enumerate(points):
        side = int(state.node.contact_side[n])
        answers = naive.node_force(p, tool, *pose, side, AREA, 2e4, G_M)
        force, depth, body = min(answers, key=lambda a: np.linalg.norm(a[0] - forces[n]))
        # Round-off: a depth of 1e-3 mm or more from positions of 10 mm, 1e-13 of it.
        np.testing.assert_allclose(forces[n], force, rtol=0, atol=1e-10 * 2e4 * AREA)
        assert state.node.contact_depth[n] == pytest.approx(depth, abs=1e-13)
        if body is not None:
            inside += 1
            wrench[body, :3] -= force
            wrench[body, 3:] -= np.cross(p - pose[1], force)
    assert inside >= 8
    assert result.n_inside == inside
    depths = state.node.contact_depth[: len(points)]
    assert result.deepest == depths.max()
    np.testing.assert_allclose(result.wrench, wrench, atol=1e-10 * np.abs(wrench).max())
    stored = sum(2e4 * AREA * smoothed_integral(g, G_M) for g in depths)
    assert result.stored == pytest.approx(stored, rel=1e-12)


@pytest.mark.parametrize("sign", [1, -1])
def test_node_on_either_flank_is_pushed_out_of_it(sign):
    # 1 mm behind the edge the half-width is tan 10° = 0.176 mm; the node is 0.02 mm deep in it.
    slope = np.tan(np.radians(10.0))
    y = sign * (slope - 0.02)
    state = nodes_at([[-1.0, y, 0.3]], far=[50.0, y, 0.3])  # its quads lie straight ahead
    forces, result = evaluate(PenaltyContact(BLADE, Contact(), H), state)
    depth = 0.02 * np.cos(np.radians(10.0))
    size = 1e4 * AREA * depth  # above g_M = 0.0185
    outward = np.array([np.sin(np.radians(10.0)), sign * np.cos(np.radians(10.0)), 0.0])
    np.testing.assert_allclose(forces[0], size * outward, rtol=1e-9, atol=1e-12)
    assert state.node.contact_side[0] == sign
    assert result.n_inside == 1
    # A torque about the body's origin, and never a force on what is outside.
    np.testing.assert_allclose(
        result.wrench[0, 3:], -np.cross(state.node.x[0], forces[0]), atol=1e-12
    )
    assert not forces[1:].any()


def film_beside(sign, gap=0.005, behind=0.3):
    """A film on one side of the mid-plane whose edge node has slipped over it by ``gap``."""
    mesh = rectangle(2.0, 0.8, n_x=5, n_y=2)
    if sign > 0:
        y = mesh.nodes[:, 1] + 0.4 - gap
        node = 2
    else:
        y = mesh.nodes[:, 1] - 0.4 + gap
        node = 2 + 2 * 6
    x = mesh.nodes[:, 0] - mesh.nodes[node, 0] - behind
    mesh = cases.moved_mesh(mesh, np.column_stack([x, y]))
    state = initial_state(mesh)
    state.node.contact_area[:] = AREA
    state.dt = FOREVER
    return state, node


@pytest.mark.parametrize("sign", [1, -1])
def test_fan_decides_the_side_where_the_nearest_face_is_wrong(sign):
    state, node = film_beside(sign)
    assert np.sign(state.node.x[node, 1]) == -sign  # nearest: the other face
    contact = PenaltyContact(BLADE, Contact(), H)
    forces, _ = evaluate(contact, state)
    assert state.node.contact_side[node] == sign
    assert forces[node, 1] * sign > 0
    depth = (0.3 * np.tan(np.radians(10)) + 0.005) * np.cos(np.radians(10))
    assert state.node.contact_depth[node] == pytest.approx(depth, rel=1e-9)
    # The side is kept while the node is inside, even if its quads should move over...
    other = state.node.x[:, 1].copy()
    state.node.x[:, 1] = np.where(np.arange(len(other)) == node, other, -other)
    evaluate(contact, state)
    assert state.node.contact_side[node] == sign
    # ...and forgotten outside.
    state.node.x[node, 0] = 0.5
    evaluate(contact, state)
    assert state.node.contact_side[node] == 0
    assert state.node.contact_depth[node] == 0.0


@pytest.mark.parametrize("sign", [1, -1])
def test_node_with_quads_on_both_sides_takes_the_nearest_face(sign):
    mesh = rectangle(2.0, 0.8, n_x=5, n_y=2)
    node = 2 + 6
    place = mesh.nodes.copy() - mesh.nodes[node] + [-0.3, sign * 0.004, 0.0]
    state = initial_state(cases.moved_mesh(mesh, place))
    state.node.contact_area[:], state.dt = AREA, FOREVER
    evaluate(PenaltyContact(BLADE, Contact(), H), state)
    assert state.node.contact_side[node] == sign


@pytest.mark.parametrize("outside", [True, False])
@pytest.mark.parametrize("n_teeth", [1, 2, 4])
def test_a_tooth_across_the_ring_claims_no_node(n_teeth, outside):
    # The strip of every tooth's mid-plane goes on across the ring and has the other sign there.
    tool = tooth_ring(n_teeth=n_teeth, edge_inclination_deg=90.0)
    for body in range(n_teeth):
        k = int(np.flatnonzero(tool.edge_body == body)[4])
        # 0.18 mm behind its own edge, it is some 0.02 mm behind that of the tooth across.
        p = tool.point(k, 0.5) + 0.18 * tool.edge_back[k]
        radial = p * [1, 1, 0] / np.hypot(p[0], p[1])
        tangent = np.cross([0, 0, 1], radial)
        # The node has slipped over to the face that its quads do not lie on.
        out = 1.0 if outside else -1.0
        p = p + (9.4 - out * 0.003 - np.hypot(p[0], p[1])) * radial
        mesh = rectangle(1.2, 0.4, n_x=3, n_y=1)
        corner = 1 if outside else 1 + 4
        local = mesh.nodes - mesh.nodes[corner]
        state = initial_state(mesh)
        # x of the sheet runs clockwise seen from above, its y outwards: director down.
        state.node.x[: mesh.n_node] = p - local[:, :1] * tangent + local[:, 1:2] * radial
        state.node.contact_area[:], state.dt = AREA, FOREVER
        forces, _ = evaluate(PenaltyContact(tool, Contact(), H), state)
        assert state.node.contact_side[corner] == out, body
        assert out * (forces[corner] @ radial) > 0


def test_a_jump_is_absorbed_and_let_go():
    state = nodes_at([[-1.0, 0.1, 0.0]])
    contact = PenaltyContact(BLADE, Contact(), H)
    state.dt = 0.0
    forces, result = evaluate(contact, state)
    depth = state.node.contact_depth[0]
    assert depth > 5 * JUMP
    assert not forces.any()  # all of it is absorbed at first
    assert result.stored == 0.0
    state.dt = 1e-6
    for step in range(1, 41):
        forces, _ = evaluate(contact, state)
        loaded = depth * (1 - np.exp(-step * 1e-6 / ABSORB_TIME))
        size = 1e4 * AREA * smoothed(loaded, G_M)
        assert np.linalg.norm(forces[0]) == pytest.approx(size, rel=1e-9)
        assert state.node.contact_offset[0] == pytest.approx(depth - loaded, rel=1e-12)


def test_growth_by_less_than_a_jump_is_loaded_at_once():
    slope = np.tan(np.radians(10.0))
    state = nodes_at([[-1.0, slope - 0.009, 0.0]])
    state.dt = 1e-9
    contact = PenaltyContact(BLADE, Contact(), H)
    for y in (0.009, 0.018, 0.027):
        state.node.x[0, 1] = slope - y
        forces, _ = evaluate(contact, state)
        size = 1e4 * AREA * smoothed(y * np.cos(np.radians(10.0)), G_M)
        assert np.linalg.norm(forces[0]) == pytest.approx(size, rel=1e-9)
    assert state.node.contact_offset[0] == 0.0
    # A jump later on absorbs the excess of that step only.
    state.node.x[0, 1] = slope - 0.06
    evaluate(contact, state)
    added = (0.06 - 0.027) * np.cos(np.radians(10.0))
    assert state.node.contact_offset[0] == pytest.approx(added, rel=1e-4)


def test_work_is_the_trapezoid_also_when_a_node_leaves():
    state = nodes_at([[-1.0, 0.15, 0.0]])
    contact = PenaltyContact(BLADE, Contact(), H)
    old, _ = evaluate(contact, state)
    v = np.array([3.0, 40.0, -1.0])
    state.node.velocity_half[0] = v
    state.dt = 1e-4
    state.node.x[0] += state.dt * v
    new, result = evaluate(contact, state)
    assert result.node_work == pytest.approx(0.5e-4 * (old[0] + new[0]) @ v, rel=1e-12)
    state.node.x[0, 1] = 5.0  # out of the tool, and out of the list
    gone, result = evaluate(contact, state)
    assert not gone.any()
    assert not state.node.contact_force[0].any()
    assert result.node_work == pytest.approx(0.5e-4 * new[0] @ v, rel=1e-12)
    assert result.n_inside == 0


@TOOLS
def test_forces_and_moments_on_tool_and_nodes_cancel(tool):
    points = points_in_and_around(tool, 40, seed=5) @ POSE[0].T + POSE[1]
    state = nodes_at(points)
    forces, result = evaluate(PenaltyContact(tool, Contact(), H), state, POSE)
    assert result.n_inside > 10
    on_tool = result.wrench.sum(axis=0)
    moment = np.cross(state.node.x[: state.n_node], forces).sum(axis=0)
    moment += on_tool[3:] + np.cross(POSE[1], on_tool[:3])
    scale = np.abs(forces).sum()
    # Round-off of sums over hundreds of nodes some 10 mm away.
    assert np.abs(forces.sum(axis=0) + on_tool[:3]).max() < 1e-14 * scale
    assert np.abs(moment).max() < 1e-13 * scale


def test_the_list_of_near_nodes_never_misses_one():
    # The blade runs 4 mm along a film in steps of 0.03 mm, the film rises against it: a lasting
    # list must give what a fresh search gives.
    mesh = rectangle(8.0, 1.0, n_x=40, n_y=4)
    state = initial_state(mesh)
    state.node.contact_area[:] = AREA
    state.node.velocity_half[: mesh.n_node] = [-1e3, 0.0, 2e3]
    contact = PenaltyContact(BLADE, Contact(), H)
    state.dt = 1e-5
    searched, listed = 0, None
    for step in range(130):
        state.node.x[: mesh.n_node] += state.dt * state.node.velocity_half[: mesh.n_node]
        pose = np.eye(3), np.array([0.03 * step, 0.0, 0.02 * step])
        _, result = evaluate(contact, state, pose)
        searched += listed is not contact.near.ids
        listed = contact.near.ids
        body = state.node.x[: mesh.n_node] - pose[1]
        found = [naive_inside(p) for p in body]
        assert result.n_inside == sum(found), step
    assert 5 < searched < 60


@TOOLS
def test_what_a_look_up_remembers_changes_no_bit(tool):
    # Nodes slide along the faces, in and out; now and then the list is made anew after a split,
    # which leaves a node without a side. A contact that has forgotten all gives the same.
    rng = np.random.default_rng(9)
    state = nodes_at(points_in_and_around(tool, 40, seed=6))
    state.dt = 1e-6
    contact = PenaltyContact(tool, Contact(), H)
    remembered = 0
    for step in range(200):
        state.step = step
        state.node.x[:80] += 2e-4 * (rng.uniform(-1, 1, (80, 3)) + np.array([0.6, -0.3, 0.5]))
        if step % 7 == 0:
            state.revision += 1
            state.node.contact_side[step % 80 :: 3] = 0
        before = [
            rows.copy()
            for rows in (
                state.node.contact_side,
                state.node.contact_depth,
                state.node.contact_offset,
                state.node.contact_force,
            )
        ]
        forces, result = evaluate(contact, state)
        lasts, within = contact._arguments[14:16]
        remembered += np.count_nonzero(within & (lasts > 0.0))
        after = [
            state.node.contact_side.copy(),
            state.node.contact_depth.copy(),
            state.node.contact_offset.copy(),
        ]
        state.node.contact_side[:], state.node.contact_depth[:] = before[:2]
        state.node.contact_offset[:], state.node.contact_force[:] = before[2:]
        fresh, again = evaluate(PenaltyContact(tool, Contact(), H), state)
        np.testing.assert_array_equal(fresh, forces)
        np.testing.assert_array_equal(again.wrench, result.wrench)
        assert again[1:] == result[1:]
        np.testing.assert_array_equal(state.node.contact_side, after[0])
        np.testing.assert_array_equal(state.node.contact_depth, after[1])
        np.testing.assert_array_equal(state.node.contact_offset, after[2])
    assert remembered > 500


def naive_inside(p):
    slope = np.tan(np.radians(10.0))
    return -3.0 < p[0] < 0 and abs(p[2]) < 3.0 and abs(p[1]) < min(-slope * p[0], 0.3)


def test_a_node_that_a_split_leaves_without_a_side_looks_for_it_anew():
    state = nodes_at([[-1.0, 0.06, 0.0]])
    contact = PenaltyContact(BLADE, Contact(), H)
    evaluate(contact, state)
    state.node.x[0, 1] = -0.06
    evaluate(contact, state)
    assert state.node.contact_side[0] == 1  # kept across the mid-plane
    state.revision += 1
    state.node.contact_side[0] = 0
    evaluate(contact, state)
    assert state.node.contact_side[0] == -1


def test_a_split_renews_the_list():
    state = nodes_at([[-1.0, 0.1, 0.0]])
    contact = PenaltyContact(BLADE, Contact(), H)
    evaluate(contact, state)
    new = state.node.append_copy(0)
    evaluate(contact, state)
    assert new not in contact.near.ids
    state.revision += 1
    evaluate(contact, state)
    assert new in contact.near.ids


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"penalty": 0.0}, "penalty must be positive"),
        ({"penalty": np.inf}, "penalty"),
        ({"smoothing": -1.0}, "smoothing must be positive, got -1.0"),
        ({"penalty": -1.0, "smoothing": 0.0}, "penalty.*; smoothing"),
    ],
)
def test_refusals(changes, message):
    with pytest.raises(ValueError, match=message):
        Contact(**changes)
