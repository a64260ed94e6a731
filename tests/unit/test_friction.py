"""Coulomb friction on the tool's faces: the return mapping, works, restarts, settings."""

import numpy as np
import pytest

from naive.booking import book
from shellcut import Contact, ScrewMotion, ShellMaterial
from shellcut.contact.coulomb_friction import TANGENTIAL, CoulombFriction
from shellcut.contact.penalty_contact import PenaltyContact
from shellcut.contact.settings import STEEPEST
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade

BLADE = straight_blade()
FILM = ShellMaterial.homogeneous(thickness=0.074)
AREA, PENALTY, MU = 0.04, 1e4, 0.3
K = TANGENTIAL * PENALTY * AREA
DT = 1e-6
FLANK = 0.3  # half thickness of the blade, whose flanks are parallel from 1.7 mm behind its edge on


def on_flank(depth):
    """A state with a node on the plus flank, this deep, and the terms that press and hold it."""
    state = initial_state(rectangle(1.0, 1.0, n_x=1, n_y=1))
    state.node.x[: state.n_node] = (50.0, 60.0, 70.0)
    state.node.x[0] = (-2.4, FLANK - depth, 0.0)
    state.node.contact_area[:] = AREA
    state.node.mass[:] = state.node.contact_mass[:] = 1e-3
    contact = PenaltyContact(BLADE, Contact(penalty=PENALTY, friction=MU), FILM, 0.4)
    return state, contact, CoulombFriction("friction", contact, MU)


def step(state, contact, friction, d, pose, entries, dt=DT, on_tool=0.0):
    """Move the node by d over a step and evaluate; return the friction on it."""
    state.dt = dt
    state.node.velocity_half[0] = np.asarray(d) / dt if dt else 0.0
    state.node.x[0] += d
    state.node.force[:] = 0.0
    contact.add_forces(state, pose)
    pressed = state.node.force[0].copy()
    friction.add_forces(state, pose)
    book(friction, entries, on_tool)
    return state.node.force[0] - pressed, pressed, friction.forces


def no_entries():
    return dict.fromkeys(("friction_work", "friction_dissipated"), 0.0)


def started(depth=0.05):
    state, contact, friction = on_flank(-1e-3)
    entries = no_entries()
    here = Pose.at_origin()
    step(state, contact, friction, np.zeros(3), here, entries, dt=0.0)
    for _ in range(10):  # by motion: a jump would not press
        step(state, contact, friction, [0.0, -(depth + 1e-3) / 10, 0.0], here, entries)
    return state, contact, friction, entries


def test_a_moving_tool_and_node_agree_with_a_plain_return_mapping():
    rng = np.random.default_rng(4)
    state, contact, friction, entries = started()
    motion = ScrewMotion(400.0, pitch=9.0, axis=(1, 2, 3), axis_point=(0.3, -1, 0.2))
    first = motion.pose(0.0)
    state.node.x[0] = first.to_space(state.node.x[:1])[0]
    step(state, contact, friction, np.zeros(3), first, entries, dt=0.0)
    u = state.node.friction_spring[0].copy()
    old = state.node.friction_force[0].copy()
    before, pose = first, first
    slipped = 0
    for k in range(1, 60):
        before, pose = pose, Pose.of(*motion.pose(k * DT * 100))
        x = state.node.x[0].copy()
        to = pose.to_space(
            before.to_body(x[None]) + rng.uniform(-1, 1, (1, 3)) * [2e-2, 1e-4, 2e-2]
        )
        f, pressed, result = step(state, contact, friction, to[0] - x, pose, entries, dt=DT * 100)
        n = pose.rotation.T @ pressed / np.linalg.norm(pressed)
        d = pose.to_body(state.node.x[:1])[0] - before.to_body(x[None])[0]
        trial = u + d - n * (n @ (u + d))
        limit = MU * np.linalg.norm(pressed) / K
        new = trial * min(1.0, limit / np.linalg.norm(trial))
        slipped += np.linalg.norm(trial) > limit
        spent = 0.5 * K * (u + new) @ (u + d - new)
        # Round-off of positions of some mm, over springs of micrometres.
        np.testing.assert_allclose(f, -K * pose.rotation @ new, rtol=0, atol=1e-9 * K)
        assert result.dissipated == pytest.approx(spent, abs=1e-12 * K)
        assert result.stored == pytest.approx(0.5 * K * new @ new, rel=1e-9)
        assert result.node_work == pytest.approx(0.5 * (old + f) @ (to[0] - x), rel=1e-9, abs=1e-12)
        moment = np.cross(state.node.x[0] - pose.translation, f)
        np.testing.assert_allclose(result.wrench[0], -np.append(f, moment), atol=1e-9 * K)
        u, old = new, f
    assert 10 < slipped < 55
    # What parts gives up what its spring held.
    _, _, parted = step(state, contact, friction, pose.rotation @ [0.0, 1.0, 0.0], pose, entries)
    assert parted.stored == 0.0
    assert parted.dissipated == pytest.approx(result.stored, rel=1e-9)


def test_without_pressure_there_is_no_friction():
    state, contact, friction = on_flank(0.05)
    entries = no_entries()
    for _ in range(2):  # a jump: the node lies in the tool, and nothing presses
        step(state, contact, friction, [1e-3, 0.0, 0.0], Pose.at_origin(), entries, dt=0.0)
        assert state.node.contact_depth[0] > 0.0
        assert not state.node.friction_force[0].any()


def test_it_counts_in_the_step():
    state, contact, friction, _ = started()
    nodes, stiffness = contact.stiffness(state, {})
    also, more = friction.stiffness(state, {contact.name: (nodes, stiffness)})
    np.testing.assert_array_equal(nodes, also)
    coupled = np.array([[STEEPEST, 0.0], [MU * STEEPEST, TANGENTIAL]])
    largest = np.linalg.svd(coupled, compute_uv=False)[0] / STEEPEST
    assert (stiffness + more >= largest * stiffness).all()
    assert (more < 0.1 * stiffness).all()
