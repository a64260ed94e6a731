"""A film that its supports move is cut as one at rest is by a tool that moves likewise to it."""

from math import cos, sin

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import shellcut as sc
from shellcut.meshing import rectangle
from shellcut.tool_shapes import straight_blade

UNTIL = 8e-4
BLADE_SPEED = 5000.0
PLACE = np.array([4.0, 1.0, 0.0])
"""About which a film turns [mm]."""


class Seen:
    """The blade's motion along x in a frame that turns about PLACE and goes on at a velocity."""

    coordinate_unit = "mm"

    def __init__(self, spin, velocity):
        self.spin, self.velocity = np.array(spin), np.array(velocity)
        self.way = sc.StraightMotion((1.0, 0.0, 0.0), speed=BLADE_SPEED)

    def pose(self, time):
        R = Rotation.from_rotvec(self.spin * time).as_matrix()
        _, r = self.way.pose(time)
        return R, PLACE + R @ (r - PLACE) + self.velocity * time

    def twist(self, time):
        R, r = self.pose(time)
        arm = r - PLACE - self.velocity * time
        along = R @ self.way.twist(time)[1]
        return self.spin, along + np.cross(self.spin, arm) + self.velocity

    def coordinate(self, time):
        return self.way.coordinate(time)


def cut(spin=(0.0, 0.0, 0.0), velocity=(0.0, 0.0, 0.0)):
    """Return work of the cables, length of the crack, largest force along the blade's way."""
    mesh, motion = rectangle(8.0, 4.8, size=0.8), Seen(spin, velocity)

    def rate(node, axis):
        x, y, _ = mesh.nodes[node] - PLACE
        turning, going = spin[2], velocity[axis]

        def at(time):  # about z
            c, s = cos(turning * time), sin(turning * time)
            return going + turning * (-s * x - c * y, c * x - s * y, 0.0)[axis]

        return at

    held = [*mesh.node_set("bottom"), *mesh.node_set("top")]
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(),
        supports=[
            sc.Support([int(i)], rotation="", velocity={a: rate(i, k) for k, a in enumerate("xyz")})
            for i in held
        ],
        tool=straight_blade(edge_angle_deg=60.0, length=8.0, height=8.0).translated((-0.05, 0, 0)),
        motion=motion,
        law=sc.CohesiveLaw(
            strength=18.0, plateau=12.0, opening_a=0.2, opening_p=0.6, opening_u=0.8
        ),
        fracture=sc.Fracture(path="free"),
        velocity=motion.velocity + np.cross(motion.spin, mesh.nodes - PLACE),
        damping_alpha=0.0,
        imperfection=0,
    )
    sim.notch((0.0, 0.1, 0.0), (1.2, 0.0, 0.0))
    forces = []
    while sim.state.time < UNTIL:
        sim.step()
        R, _ = motion.pose(sim.state.time)
        forces.append(R[:, 0] @ sim.tooth_wrenches.sum(axis=0)[:3])
    ledger = sim.close_ledger()
    return ledger.cohesive_work, sim.state.crack_length, np.abs(forces).max()


@pytest.fixture(scope="module")
def at_rest():
    return cut()


@pytest.mark.parametrize(
    "moved",
    [
        {"velocity": (0.0, -2000.0, 0.0)},
        {"velocity": (-BLADE_SPEED, 0.0, 0.0)},  # a web that comes to a blade at rest
        {"spin": (0.0, 0.0, 500.0)},
    ],
    ids=["aside", "web", "turned"],
)
def test_the_motion_of_the_film_does_not_matter(at_rest, moved):
    moving = cut(**moved)
    np.testing.assert_allclose(moving[:2], at_rest[:2], rtol=5e-3)
    np.testing.assert_allclose(moving[2], at_rest[2], rtol=0.05)
