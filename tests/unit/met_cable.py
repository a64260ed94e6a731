"""A cable that the edge of a blade has just met, and its stiffness."""

import numpy as np

from shellcut.cables.directional_cable import CableSet
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.state import JOINTED
from shellcut.tool.pose import Pose

AREA = 0.03


def met_cable(law, tool, minus, plus, pose=None):
    """Return what evaluates the cable, and its state; the ends are points of the body frame."""
    pose = pose or Pose.at_origin()
    state = initial_state(rectangle(2.0, 1.0, n_x=1, n_y=1))
    state.node.contact_area[:] = 0.25 * 0.4**2
    state.cable.append_blank()
    state.cable.ends[0] = 0, 1
    state.cable.m[0] = pose.rotation @ [0.0, 1.0, 0.0]
    state.cable.area[0] = AREA
    cables = CableSet(law, tool)
    evaluated(cables, state, minus, plus, pose)
    assert state.cable.status[0] == JOINTED
    return cables, state


def evaluated(cables, state, minus, plus, pose=None):
    """Put the ends at points of the body frame and evaluate; return what the cables did."""
    pose = pose or Pose.at_origin()
    state.node.x[:2] = pose.to_space(np.array([minus, plus], float))
    state.node.force[:] = 0.0
    cables.add_forces(state, pose)
    return cables.forces


def numeric_stiffness(cables, state, node, pose=None):
    """Return the largest eigenvalue of the derivative of one node's force by its own position."""
    x, delta, K = state.node.x.copy(), 1e-8, np.zeros((3, 3))
    names = ("opening_max", "status", "branch", "edge", "joint_body", "joint", "grip", "arc_grip")
    saved = {name: getattr(state.cable, name).copy() for name in (*names, "transport")}

    def force_at(place):
        for name, value in saved.items():
            getattr(state.cable, name)[:] = value
        state.node.x[:], state.node.force[:] = place, 0.0
        cables.add_forces(state, pose or Pose.at_origin())
        return state.node.force[node].copy()

    for j in range(3):
        moved = np.zeros_like(x)
        moved[node, j] = delta
        K[:, j] = -(force_at(x + moved) - force_at(x - moved)) / (2 * delta)
    force_at(x)
    return np.linalg.eigvalsh(0.5 * (K + K.T))[-1]
