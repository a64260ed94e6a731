"""A tool that starts inside the sheet is refused, one that touches nothing is not."""

import re

import numpy as np
import pytest

from far_pose import FAR
from naive import cases
from shellcut.contact.start_check import check_tool_outside
from shellcut.contact.unfelt_depth import ToolWires, missed_penetration
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.motion import ScrewMotion, StraightMotion
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.table_motion import TableMotion

BLADE = straight_blade()  # 3 mm long behind its edge, flanks at y = +-0.3 mm
MESH = rectangle(8.0, 4.0, n_x=8, n_y=4)


TURNED = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 1.0]])  # by 90°


def check(mesh, *place, turn=None, tool=BLADE, motion=None):
    pose = Pose(np.eye(3) if turn is None else turn, np.array(place, float))
    check_tool_outside(mesh, tool, ClosestTriangleGrid.build(tool), pose, motion)


def test_free_starts_are_taken():
    check(MESH, -0.01, 0, 0)
    check(MESH, 12.0, 0, 0)
    check(MESH, 4.0, 0, 3.1)  # above the sheet
    check(MESH, 0, 0, 0, tool=tooth_ring())
    check(MESH, 4.0, -2.05, 0.0, turn=TURNED)  # coming from below


def test_tools_inside_are_refused_wherever_they_are():
    with pytest.raises(ValueError, match="must start outside the sheet") as refusal:
        check(MESH, 3.5, 0, 0)
    text = str(refusal.value)
    assert "nodes 19 at (1, 0, 0), 20 at (2, 0, 0), 21 at (3, 0, 0) lie inside the tool" in text
    assert "leave a slot for it out of the film's mesh" in text
    mesh = rectangle(8.0, 4.0, n_x=2, n_y=1)  # quads of 4 x 4 mm around the blade
    with pytest.raises(ValueError, match="the tool passes through quads 0 at") as refusal:
        check(mesh, 3.8, 0, 0)
    assert "nodes" not in str(refusal.value).split("but")[1]
    with pytest.raises(ValueError, match=r"and \d+ more lie inside"):
        check(rectangle(8.0, 4.0, n_x=80, n_y=40), 4.0, 0, 0)
    with pytest.raises(ValueError, match="inside the tool"):
        check(MESH, 4.0, 0.5, 0.0, turn=TURNED)


def test_a_notch_makes_room_for_a_thin_blade_only_when_it_is_open():
    # The nodes of a closed notch still lie inside: it must be opened or the blade start outside.
    mesh = MESH.cut([18, 19, 20])
    with pytest.raises(ValueError, match="inside the tool"):
        check(mesh, 1.5, 0, 0)
    nodes = mesh.nodes.copy()
    for node in np.flatnonzero(np.isin(mesh.origin, [18, 19])):
        quads = mesh.quads[(mesh.quads == node).any(axis=1)]
        nodes[node, 1] = 0.4 * np.sign(mesh.nodes[quads, 1].mean())
    check(cases.moved_mesh(mesh, nodes), 1.0, 0, 0)


LATER_ASIDE = TableMotion([0, 1e-4, 1e-3, 2e-3], [(0, 0, 0), (0, 0, 0), (0, 0, -3), (4, 0, -3)])


@pytest.mark.parametrize(
    ("motion", "back", "z", "least", "turned"),
    [
        (StraightMotion((1, 0, 0), 100.0), (-1, 0, 0), 0.0, 3.5, True),  # out at the edge x = 0
        (StraightMotion((0, 0, -1), 100.0), (0, 0, 1), 2.8, 0.2, False),  # 3 mm high to both sides
        (StraightMotion((0, 0, 1), 100.0), (0, 0, -1), 2.8, 5.8, True),
        (LATER_ASIDE, (0, 0, 1), 2.8, 0.2, False),
        (None, (0, 0, 0), 0.0, None, True),
    ],
    ids=["along", "down", "up", "later aside", "no motion"],
)
def test_how_far_back_a_tool_is_free_is_said_and_whether_it_is_turned_wrong(
    motion, back, z, least, turned
):
    with pytest.raises(ValueError, match="or leave a slot for it out") as refusal:
        check(MESH, 3.5, 0.0, z, motion=motion)
    text = str(refusal.value)
    assert ("the direction of its motion or the film's plane" in text) == turned
    shifts = re.findall(r"start back by \((.*?)\) mm \(\[tool\] shift\),", text)
    assert len(shifts) == (least is not None)
    for shift in shifts:
        shift = np.array(shift.split(", "), float)
        assert least <= shift @ back < least + 0.15
        moved = [3.5, 0.0, z] + shift + 1e-3 * np.array(back)
        check(MESH, *moved, motion=motion)  # there it is free to start


def test_a_ring_on_its_side_is_not_only_sent_back_along_the_axis_of_its_screw():
    screw = ScrewMotion.over(angle_deg=95.0, duration=6e-3, pitch=12.0)
    on_its_side = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])
    mesh = rectangle(24.0, 24.0, n_x=12, n_y=12)
    mesh = cases.moved_mesh(mesh, mesh.nodes - [12.0, 0.0, 0.0])
    back = (
        r"back by \(-(9|10)\.?\d*, 0, 0\) mm \(\[tool\] shift\), or turn it or the film: its axis"
    )
    with pytest.raises(ValueError, match=f"must start outside the sheet.*{back}"):
        check(mesh, 0, 0, 0, turn=on_its_side, tool=tooth_ring(), motion=screw)


# --- where the tool passes through quads, against brute force over all wires


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
