"""A tool that starts inside the sheet is refused, one that touches nothing is not."""

import re

import numpy as np
import pytest

from naive import cases
from shellcut.contact.unfelt_depth import check_tool_outside
from shellcut.mesh.structured import rectangle
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.motion import ScrewMotion, StraightMotion
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring

BLADE = straight_blade()  # 3 mm long behind its edge, flanks at y = +-0.3 mm
MESH = rectangle(8.0, 4.0, n_x=8, n_y=4)


def check(mesh, x, z=0.0):
    check_at(mesh, BLADE, np.eye(3), np.array([x, 0.0, z]))


def check_at(mesh, tool, rotation, translation):
    check_tool_outside(mesh, tool, ClosestTriangleGrid.build(tool), Pose(rotation, translation))


def test_free_starts_are_taken():
    check(MESH, -0.01)
    check(MESH, 12.0)
    check(MESH, 4.0, z=3.1)  # above the sheet
    check_at(MESH, tooth_ring(), np.eye(3), np.zeros(3))


def test_tools_inside_are_refused_wherever_they_are():
    with pytest.raises(ValueError, match="must start outside the sheet") as refusal:
        check(MESH, 3.5)
    text = str(refusal.value)
    assert "nodes 19 at (1, 0, 0), 20 at (2, 0, 0), 21 at (3, 0, 0) lie inside the tool" in text
    assert "Mesh.cut" in text
    mesh = rectangle(8.0, 4.0, n_x=2, n_y=1)  # quads of 4 x 4 mm around the blade
    with pytest.raises(ValueError, match="the tool passes through quads 0 at") as refusal:
        check(mesh, 3.8)
    assert "nodes" not in str(refusal.value).split("but")[1]
    mesh = rectangle(8.0, 4.0, n_x=80, n_y=40)
    with pytest.raises(ValueError, match=r"and \d+ more lie inside"):
        check(mesh, 4.0)
    pose = np.array([[0, -1.0, 0], [1.0, 0, 0], [0, 0, 1.0]]), np.array([4.0, -2.05, 0.0])
    check_at(MESH, BLADE, *pose)  # turned by 90°, coming from below
    with pytest.raises(ValueError, match="inside the tool"):
        check_at(MESH, BLADE, pose[0], np.array([4.0, 0.5, 0.0]))


def test_a_notch_makes_room_for_a_thin_blade_only_when_it_is_open():
    # The nodes of a closed notch still lie inside: it must be opened or the blade start outside.
    mesh = MESH.cut([18, 19, 20])
    with pytest.raises(ValueError, match="inside the tool"):
        check(mesh, 1.5)
    nodes = mesh.nodes.copy()
    for node in np.flatnonzero(np.isin(mesh.origin, [18, 19])):
        quads = mesh.quads[(mesh.quads == node).any(axis=1)]
        nodes[node, 1] = 0.4 * np.sign(mesh.nodes[quads, 1].mean())
    check(cases.moved_mesh(mesh, nodes), 1.0)


@pytest.mark.parametrize(
    ("direction", "z", "least", "turned"),
    [
        ((1.0, 0.0, 0.0), 0.0, 3.5, True),  # out at the sheet's edge x = 0
        ((0.0, 0.0, -1.0), 2.8, 0.2, False),  # the blade reaches 3 mm to both sides in z
        ((0.0, 0.0, 1.0), 2.8, 5.8, True),
        ((0.0, 0.0, 0.0), 0.0, None, True),
    ],
)
def test_how_far_back_a_tool_is_free_is_said_and_whether_it_is_turned_wrong(
    direction, z, least, turned
):
    pose = Pose(np.eye(3), np.array([3.5, 0.0, z]))
    motion = StraightMotion(direction, 100.0) if any(direction) else None
    grid = ClosestTriangleGrid.build(BLADE)
    with pytest.raises(ValueError, match=r"or cut a notch for it \(Mesh\.cut\)$") as refusal:
        check_tool_outside(MESH, BLADE, grid, pose, motion)
    text = str(refusal.value)
    assert ("its axis or the direction of its motion may be wrong" in text) == turned
    back = re.findall(r"start back by ([\d.]+) mm, against \((.*?)\),", text)
    assert len(back) == (least is not None)
    for far, way in back:
        assert least <= float(far) < least + 0.15
        assert way == "{:g}, {:g}, {:g}".format(*direction)


def test_a_ring_on_its_side_is_not_only_sent_back_along_the_axis_of_its_screw():
    screw, ring = ScrewMotion.over(angle_deg=95.0, duration=6e-3, pitch=12.0), tooth_ring()
    on_its_side = np.array([[0.0, 0.0, 1.0], [0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]])

    mesh = rectangle(24.0, 24.0, n_x=12, n_y=12)
    mesh = cases.moved_mesh(mesh, mesh.nodes - [12.0, 0.0, 0.0])
    grid = ClosestTriangleGrid.build(ring)
    with pytest.raises(ValueError, match="must start outside the sheet") as refusal:
        check_tool_outside(mesh, ring, grid, Pose.of(on_its_side, np.zeros(3)), screw)
    said = str(refusal.value)
    assert re.search(r"back by (9|10)\.?\d* mm, against \(0, 0, -1\), or turn it: its axis", said)
