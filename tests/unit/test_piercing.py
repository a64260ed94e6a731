"""Where the tool passes through quads, against brute force over all wires."""

import numpy as np
import pytest

from far_pose import FAR
from naive import cases
from shellcut.contact.unfelt_depth import ToolWires, missed_penetration
from shellcut.mitc4.initial_state import initial_state
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring


def crossing_depth(a, b, triangle):
    """How far the segment a b passes through a triangle, by the signs of volumes."""
    p, q, r = triangle
    normal = np.cross(q - p, r - p)
    da, db = (a - p) @ normal, (b - p) @ normal
    if da * db >= 0:
        return 0.0
    volumes = [np.linalg.det([b - a, u - a, v - a]) for u, v in ((p, q), (q, r), (r, p))]
    if not (all(v > 0 for v in volumes) or all(v < 0 for v in volumes)):
        return 0.0
    return min(abs(da), abs(db)) / np.linalg.norm(normal)


def brute_force(x, quads, tool, pose):
    body = (x - pose[1]) @ pose[0]
    wires = {
        tuple(sorted(side))
        for t in tool.triangles.tolist()
        for side in zip(t, t[1:] + t[:1], strict=True)
    }
    depth = np.zeros(len(quads))
    for e, (i, j, k, m) in enumerate(quads):
        for a, b in wires:
            for half in ((i, j, k), (i, k, m)):
                found = crossing_depth(tool.vertices[a], tool.vertices[b], body[list(half)])
                depth[e] = max(depth[e], found)
    return depth


RING = tooth_ring(n_teeth=2, n_arc=4, length=1.0, height=1.5)


@pytest.mark.parametrize("tool", [straight_blade(), RING], ids=["blade", "ring"])
def test_depths_match_brute_force(tool):
    # A warped sheet laid through the tool, off its symmetries, then turned far with it.
    mesh = cases.warped(7, 5)
    centre = tool.vertices[tool.triangles[: tool.n_triangle // tool.n_body]].mean(axis=(0, 1))
    x = 0.5 * (mesh.nodes - mesh.nodes.mean(axis=0)) + centre + [0.013, 0.021, 0.007]
    x = x @ FAR[0].T + FAR[1]
    wanted = brute_force(x, mesh.quads, tool, FAR)
    noticed = np.zeros(mesh.n_node, np.bool_)
    quads, depth = ToolWires(tool).crossed_quads(x, mesh.quads, noticed, FAR)
    assert quads.size > 2
    np.testing.assert_array_equal(quads, np.flatnonzero(wanted))
    np.testing.assert_allclose(depth, wanted[quads], atol=1e-12)
    noticed[mesh.quads[quads[0], 2]] = True
    left = quads[~noticed[mesh.quads[quads]].any(axis=1)]
    assert left.size < quads.size
    others, _ = ToolWires(tool).crossed_quads(x, mesh.quads, noticed, FAR)
    np.testing.assert_array_equal(others, left)


def test_what_a_node_has_felt_or_a_crack_opened_does_not_count():
    mesh = cases.skewed_flat(4, 3)
    state = initial_state(mesh)
    tool = straight_blade()
    beside = np.array([0.2, 0.0, 0.0])
    pose = Pose(np.eye(3), mesh.nodes[mesh.quads[5]].mean(axis=0) + beside)
    wires = ToolWires(tool)
    count, depth = missed_penetration(wires, state, pose)
    assert count >= 1
    assert depth > 0.1
    state.node.contact_depth[mesh.quads[5, 0]] = 0.01
    assert missed_penetration(wires, state, pose)[0] < count
    state.node.halved[: mesh.n_node] = True
    assert missed_penetration(wires, state, pose) == (0, 0.0)
