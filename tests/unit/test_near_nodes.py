"""The list of near nodes: complete as long as it lasts, whatever has happened before."""

import numpy as np

from shellcut.contact.near_nodes import NearNodes
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.tool.motion import ScrewMotion

LOW = np.array([[0.0, 0.0, -1.0], [3.0, 1.0, -0.5]])
HIGH = np.array([[1.0, 2.0, 1.0], [4.0, 2.0, 0.5]])
MARGIN = 0.4
MOTION = ScrewMotion(20.0, pitch=2.0, axis=(0, 0, 1), axis_point=(1.0, 0.5, 0.0))


def sheet():
    mesh = rectangle(8.0, 4.0, n_x=40, n_y=20)
    state = initial_state(mesh)
    state.node.x[mesh.n_node :] = np.nan
    return mesh, state


def inside(x, pose, margin):
    """By NumPy: nodes within a margin of any box."""
    body = ((x - pose[1]) @ pose[0])[:, None]
    found = ((body > LOW - margin) & (body < HIGH + margin)).all(axis=2)
    return np.flatnonzero(found.any(axis=1))


def test_the_list_holds_every_node_within_half_the_margin_while_it_lasts():
    mesh, state = sheet()
    near = NearNodes(LOW, HIGH, MARGIN)
    rng = np.random.default_rng(4)
    state.dt = 1e-4
    renewals = 0
    for step in range(200):
        state.step, state.time = step, step * state.dt
        v = 40.0 * rng.uniform(-1, 1, (mesh.n_node, 3)) + [0, 0, 20.0]
        state.node.velocity_half[: mesh.n_node] = v
        state.node.x[: mesh.n_node] += state.dt * v
        pose = MOTION.pose(state.time)
        renewals += near.renew(state, pose)
        x = state.node.x[: mesh.n_node]
        # Between two looks tool and nodes have gone a little further.
        assert np.isin(inside(x, pose, 0.5 * MARGIN - 10 * 0.02), near.ids).all()
    assert 3 < renewals < 50


def test_a_split_and_another_state_are_searched_at_once():
    _, state = sheet()
    near = NearNodes(LOW, HIGH, MARGIN)
    pose = MOTION.pose(0.0)
    assert near.renew(state, pose)
    state.step = 1
    assert not near.renew(state, pose)
    new = state.node.append_copy(int(near.ids[0]))
    state.revision += 1
    assert near.renew(state, pose)
    assert new in near.ids
    _, other = sheet()
    other.revision = state.revision
    other.step = 1
    assert near.renew(other, pose)
    assert new not in near.ids
