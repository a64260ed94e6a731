"""Where a blade has passed the tip of a crack: where it is, and nowhere else; likewise cables."""

import numpy as np
import pytest

from shellcut import CohesiveLaw, StraightMotion, opening_test, read_tool
from shellcut.cables.directional_cable import CableSet
from shellcut.fracture.blade_drive import BladeDrive
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from shellcut.state import JOINTED
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade, tooth_ring

REACH = 0.3  # behind the edge, within which the film is surely cut [mm]
HERE = Pose.at_origin()
RADIUS = 9.4


def cut_of(tool, points):
    """Return at which of these places a blade has passed the tip of a crack."""
    motion = StraightMotion((1.0, 0.0, 0.0), speed=1.0)
    drive = BladeDrive(CuttingEdges.of(tool), motion)
    return drive.find(points, np.ones(len(points)), 0.0).passed.copy()


def cables_met(tool, points, across):
    """Return which of the cables, ends at these places plus and minus ``across``, are met."""
    n = len(points)
    state = initial_state(rectangle(2.0 * n, 1.0, n_x=2 * n - 1, n_y=1))
    state.node.contact_area[:] = 0.25 * 0.4**2
    for k in range(n):
        state.cable.append_blank()
        state.cable.ends[k] = 2 * k, 2 * k + 1
        state.node.x[2 * k : 2 * k + 2] = points[k] - across[k], points[k] + across[k]
        state.cable.m[k] = across[k] / np.linalg.norm(across[k])
        state.cable.area[k] = 0.03
    CableSet(CohesiveLaw(), tool).add_forces(state, HERE)
    return state.cable.status[:n] == JOINTED


def tooth_regions(eta_deg, relief_deg, height, s, z):
    """Where an edge that has come to all of this has surely cut, and surely not.

    s and z are the straight coordinates of a tooth. What is less than 0.02 mm off is in neither.
    """
    eta, relief = np.radians(eta_deg), np.radians(relief_deg)
    depth = (z / np.tan(eta) - s) * np.sin(eta)
    along = s * np.cos(eta) + z * np.sin(eta)
    over = (z + s * np.tan(relief)) * np.cos(relief)
    cut = (depth > 0.02) & (depth < REACH - 0.02) & (along > 0.02) & (over > 0.6 * depth)
    whole = (depth < -0.02) | (over < -0.02) | (z > height + 0.02)
    return cut & (z < height - 0.2), whole


@pytest.mark.parametrize(
    ("from_file", "half_thickness"), [(False, 0.35), (True, 0.35), (False, 0.03)]
)
@pytest.mark.parametrize(
    ("eta", "relief", "height"), [(30, 0, 2.0), (60, 60, 3.0), (85, 5, 2.0), (89, 30, 2.0)]
)
def test_nodes_are_cut_where_the_tooth_is(eta, relief, height, half_thickness, from_file, tmp_path):
    shape = {"edge_inclination_deg": eta, "relief_deg": relief, "height": height}
    tool = tooth_ring(n_teeth=1, half_thickness=half_thickness, **shape)
    if from_file:
        tool.write(tmp_path / "tooth.stl")
        tool = read_tool(tmp_path / "tooth.stl", unit="mm")
        # Corners of its back turn by 100 degrees: found by angle, they would cut too.
        tool = tool.without_cutting(*range(1, tool.n_chain)) if tool.n_chain > 1 else tool
    s, z = grid(-1.0, 1.2)
    cut, whole = tooth_regions(eta, relief, height, s, z)
    assert cut.sum() > 20
    assert ((z < 0.0) & whole).sum() > 50
    # On the mid-plane, and well beside a thin tooth: the faces have pushed the node there.
    for n in (0.0, 0.2, -0.2):
        found = cut_of(tool, wrapped(s, n, z))
        assert found[cut].all()
        assert not found[whole].any()
    s, z, cut = s[::3], z[::3], cut[::3]
    places = wrapped(s, 0.0, z)
    across = 0.05 * places * [1.0, 1.0, 0.0] / RADIUS
    met = cables_met(tool, places, across)
    assert met[cut].all()
    # Deeper than a whole node's reach a cable is met as well, but only inside the tooth.
    outside = z < -np.tan(np.radians(relief)) * s - 0.02
    assert not met[outside | (z / np.tan(np.radians(eta)) - s < -0.02)].any()


def grid(low, high):
    s, z = np.meshgrid(np.arange(-1.2, 0.8, 0.08), np.arange(low, high, 0.08))
    return s.ravel() + 0.003, z.ravel() + 0.004


def wrapped(s, n, z):
    angle = s / RADIUS
    return np.stack(
        [(RADIUS + n) * np.cos(angle), (RADIUS + n) * np.sin(angle), 0.02 + z + 0.0 * s], axis=1
    )


@pytest.mark.parametrize("edge_angle", [40.0, 60.0, 90.0])
def test_nodes_are_cut_where_a_straight_blade_is(edge_angle):
    blade = straight_blade(edge_angle_deg=edge_angle, length=0.8, height=1.0)
    (x, z), angle = grid(-1.2, 1.2), np.radians(edge_angle)
    depth = (z / np.tan(angle) - x) * np.sin(angle)
    found = cut_of(blade, np.stack([x, 0.1 + 0.0 * x, z], axis=1))
    inside = (depth > 0.005) & (depth < REACH - 0.005) & (abs(z) < 0.5 - 0.25 * depth - 0.01)
    # Within the strip: at a slanted edge's upper end that leaves the blade, at its lower end not.
    along = np.sin(angle) * (z + 0.5) + np.cos(angle) * (x + 0.5 / np.tan(angle))
    inside &= (along > 0.0) & (along < 1.0 / np.sin(angle))
    assert inside.sum() > 20
    assert found[inside].all()
    assert not found[(abs(z) > 0.5) | (depth < -1e-9)].any()


def test_film_that_presses_on_a_relief_is_not_cut():
    # Contact yields by some thousandths of a millimetre; 0.02 mm here.
    tool = tooth_ring(n_teeth=1, relief_deg=10.0, edge_inclination_deg=85.0)
    s = -np.linspace(0.15, 1.2, 30)
    assert not cut_of(tool, wrapped(s, 0.0, -s * np.tan(np.radians(10.0)) + 0.02)).any()


def test_a_steep_tooth_cuts_only_the_side_through_which_it_goes():
    # The tips stand 0.02 mm over nodes of the ring and press between them when they come down: each
    # breaks the side from there to the next node, 5 degrees ahead, and nothing behind it.
    sim = opening_test("quick", tool=tooth_ring(edge_inclination_deg=85.0)).simulation
    while len(sim.state.split_log) < 4 or np.degrees(sim.motion.coordinate(sim.state.time)) < 1.5:
        sim.step()
        assert np.degrees(sim.motion.coordinate(sim.state.time)) < 6.0
    assert [split.kind for split in sim.state.split_log] == ["puncture"] * 4
    ends = sim.cracks.at_tips(sim.mesh.nodes)
    angles = np.sort(np.degrees(np.arctan2(ends[:, 1], ends[:, 0])) % 360.0)
    wanted = np.sort(np.add.outer(np.arange(4) * 90.0, [0.0, 5.0]).ravel())
    np.testing.assert_allclose(angles, wanted, atol=1e-9)
    # The tips themselves press between the nodes; no node is in a tooth.
    assert sim.contact.forces.deepest == 0.0
