"""Friction of the film on itself: law, momentum, works, history and restart."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import shellcut as sc
from courses import UNDAMPED
from naive.booking import book
from naive.self_friction import forces_on_sheet, returned, slip_speed
from naive.shell import shape
from shellcut.contact.coulomb_friction import CoulombFriction
from shellcut.mesh.structured import rectangle
from shellcut.tool.pose import Pose
from two_pieces import CASES, ON, H, approached, evaluated, split, touching

MU = 0.3
AT_REST = Pose.at_origin()


class Drawn:
    """Two pieces that touch, and their friction; the second is moved step by step."""

    def __init__(self, case, warp=0.0):
        gap, way, tilt = CASES[case]
        self.state, self.contact, x, self.first = touching(gap, tilt, warp)
        self.friction = CoulombFriction("self_friction", self.contact, MU)
        away = np.zeros_like(x)
        away[self.first :] = way
        approached(self.state, self.contact, x, away)
        self.x, self.dt = x, 1e-6
        self.works = dict.fromkeys(("friction_work", "friction_dissipated"), 0.0)
        self.friction.add_forces(self.state, AT_REST)

    def step(self, moved):
        """Move all nodes by moved : (n_node, 3); return the friction on them and what it did."""
        n = self.state.node
        self.x = self.x + moved
        self.state.dt = self.dt
        n.velocity_half[: n.count] = moved / self.dt
        evaluated(self.state, self.contact, self.x)
        n.force_rows[:] = 0.0
        self.friction.add_forces(self.state, AT_REST)
        book(self.friction, self.works, 0.0)
        return n.force[: n.count].copy(), self.friction.forces

    def shift(self, way):
        moved = np.zeros_like(self.x)
        moved[self.first :] = way
        return self.step(moved)

    def pressure(self):
        pressure = self.contact.carriers.pressure
        return pressure[pressure > 0.0]

    def springs(self):
        """k_t of the points that press."""
        carriers = self.contact.carriers
        return 0.5 * carriers.stiffness[carriers.pressure > 0.0]


@pytest.mark.parametrize("case", CASES)
def test_forces_are_those_of_virtual_work(case):
    drawn = Drawn(case, warp=0.01)
    rng = np.random.default_rng(8)
    drawn.step(1e-5 * rng.normal(size=drawn.x.shape))
    before = drawn.friction.springs
    u_before, quad_before = before.slip.copy(), before.node.copy()
    moved = 1e-5 * rng.normal(size=drawn.x.shape)
    force, found = drawn.step(moved)
    carriers, points = drawn.contact.carriers, drawn.contact.point_of_sheet()
    wanted = np.zeros_like(force)
    slipping, pressing = 0, np.flatnonzero(carriers.pressure)
    for sheet in pressing:
        quad, node, w = carriers.node[sheet], points[sheet], carriers.weight[sheet]
        xi, eta = w @ [-1, 1, 1, -1], w @ [-1, -1, 1, 1]
        np.testing.assert_array_equal(quad_before[sheet], quad)
        corners, pressed = drawn.x[quad], carriers.pressure[sheet] * carriers.normal[sheet]
        _, one, two = shape(xi, eta) @ corners
        n = np.cross(one, two) / np.linalg.norm(np.cross(one, two))
        one /= np.linalg.norm(one)
        over = (drawn.x[node] - shape(xi, eta)[0] @ corners) @ n
        slip = slip_speed(moved[node], corners, moved[quad], xi, eta, over)
        # The frame at the new foot, by which the old one differs to second order only.
        u = u_before[sheet] @ np.array([one, np.cross(n, one), n])
        k = 0.5 * carriers.stiffness[sheet]
        new = returned(u + slip, pressed, MU, k)
        slipping += np.linalg.norm(new) < 0.999 * np.linalg.norm(u + slip - (u + slip) @ n * n)
        wanted[node] += -k * new
        wanted[quad] += forces_on_sheet(-k * new, corners, xi, eta, over)
    scale = np.abs(wanted).max()
    assert scale > 0.0
    np.testing.assert_allclose(force, wanted, atol=2e-3 * scale)
    assert found.n_slipping <= pressing.size
    # Neither a sum nor a moment.
    np.testing.assert_allclose(force.sum(axis=0), 0.0, atol=1e-13 * scale)
    np.testing.assert_allclose(np.cross(drawn.x, force).sum(axis=0), 0.0, atol=1e-11 * scale)


def test_a_piece_drawn_over_another_sticks_and_slips_in_closed_form():
    drawn = Drawn("face")
    pressure, k_t = drawn.pressure(), drawn.springs()
    slips_at = MU * pressure / k_t
    one_step = 0.05 * slips_at.min()
    way = 0.0
    for _ in range(60):
        force, found = drawn.shift((one_step, 0.0, 0.0))
        way += one_step
        drag = force[drawn.first :].sum(axis=0)
        # The points of either piece, one by one; they press as before, the film is flat.
        wanted = np.minimum(k_t * way, MU * pressure).sum()
        # On the other piece's points the force is that of the first: all signs are the same.
        assert -drag[0] == pytest.approx(wanted, rel=1e-6)
        np.testing.assert_allclose(drag[1:], 0.0, atol=1e-6 * wanted)
    assert found.n_slipping == len(pressure)
    slip = np.maximum(way - slips_at, 0.0)
    spent = (MU * pressure * slip).sum()
    # The step in which a point begins to slip is divided by the trapezoid: less than one step.
    assert drawn.works["friction_dissipated"] == pytest.approx(spent, rel=0.02)
    assert found.stored == pytest.approx((0.5 * k_t * slips_at**2).sum(), rel=1e-6)
    works = drawn.works
    kept = works["friction_dissipated"] + found.stored
    assert works["friction_work"] == pytest.approx(kept, rel=1e-9)


@pytest.fixture
def stuck():
    """Two pieces drawn over half of what their springs take, and what that stored."""
    drawn = Drawn("face")
    slips_at = MU * drawn.pressure() / drawn.springs()
    return drawn, *drawn.shift((0.5 * slips_at.min(), 0.0, 0.0))


def test_pieces_that_turn_together_do_not_slip_and_take_the_spring_along(stuck):
    drawn, at_first, before = stuck
    # 40 deg about an axis that is neither in the film nor normal to it, in small steps.
    axis, n = np.array([1.0, -2.0, 2.0]) / 3.0, 40
    turn = Rotation.from_rotvec(np.radians(40.0) / n * axis).as_matrix()
    for _ in range(n):
        force, found = drawn.step(drawn.x @ turn.T - drawn.x)
    # The frames turn exactly; the foot is found to 1e-13, and the points press by their depth.
    assert found.stored == pytest.approx(before.stored, rel=1e-8)
    wanted = at_first @ np.linalg.matrix_power(turn, n).T
    np.testing.assert_allclose(force, wanted, atol=1e-8 * np.abs(force).max())
    assert found.n_slipping == 0


def test_the_halves_of_a_split_node_keep_side_spring_and_energy(stuck):
    drawn, _, before = stuck
    touched, node = drawn.contact.forces, int(drawn.contact.tables.presses.node[0, 0])
    assert node >= drawn.first
    half = split(drawn.state, node)
    drawn.x = np.vstack([drawn.x, drawn.x[node]])
    pull, after = drawn.step(np.zeros_like(drawn.x))
    push, touches = evaluated(drawn.state, drawn.contact, drawn.x)
    assert touches.n_touching == touched.n_touching + 1
    for now, then in ((after, before), (touches, touched)):
        assert now.stored == pytest.approx(then.stored, rel=1e-12)
    assert after.dissipated == pytest.approx(0.0, abs=1e-12 * before.stored)
    for force in (pull, push):
        np.testing.assert_allclose(force[node], force[half], rtol=1e-12)


def test_what_a_spring_held_is_dissipated_when_they_part(stuck):
    drawn, _, before = stuck
    _, after = drawn.shift((0.0, 0.0, H))
    assert before.stored > 0.0
    assert after.stored == 0.0
    # The half of the work that the last force did on the way is across the pull: none.
    assert drawn.works["friction_dissipated"] == pytest.approx(before.stored, rel=1e-6)
    assert not drawn.friction.springs.slip.any()


def test_friction_without_contact_is_refused():
    with pytest.raises(ValueError, match="needs self_contact = true"):
        sc.Contact(self_friction=0.2)


def lying(pull, push=2e7, **options):
    """A loose piece on a sheet that cannot move, pressed on it and pulled along it."""
    sheet, piece = rectangle(3.0, 2.0, n_x=6, n_y=4), rectangle(0.9, 0.6, n_x=3, n_y=2)
    onto = sheet.nodes.mean(axis=0) - piece.nodes.mean(axis=0) + [-0.6, 0.1, H]
    nodes = np.concatenate([sheet.nodes, piece.nodes + onto])
    mesh = sc.Mesh.from_arrays(nodes, np.concatenate([sheet.quads, piece.quads + sheet.n_node]))
    sim = sc.Simulation(
        mesh,
        sc.ShellMaterial.homogeneous(thickness=H),
        supports=[sc.Support.clamped(np.arange(sheet.n_node))],
        loads=[sc.Gravity((pull, 0.0, -push))],
        contact=replace(ON, self_friction=MU),
        **UNDAMPED | options,
    )
    return sim, np.arange(sheet.n_node, mesh.n_node)


def test_a_piece_on_the_film_accelerates_by_coulombs_law():
    push, pull = 2e7, 1e7
    sim, piece = lying(pull, push)
    while sim.state.time < 1.5e-4:
        sim.step()
    n, m = sim.state.node, sim.state.node.mass[piece]
    mass = m.sum()
    way, v = (m @ x / mass for x in (n.x[piece] - n.X[piece], n.velocity_half[piece]))
    # It bounces a little on its springs: what presses is its weight and what has stopped its fall.
    time = sim.state.time - 0.5 * sim.state.dt
    assert v[0] == pytest.approx(pull * time - MU * (push * time + v[2]), rel=5e-3)
    book = sim.close_ledger()
    spent = mass * (pull * way[0] - 0.5 * v[0] ** 2)
    assert book.friction_dissipated == pytest.approx(spent, rel=0.01)
    kept = book.friction_dissipated + book.friction_stored
    assert book.friction_work == pytest.approx(kept, rel=1e-6)
    assert abs(book.imbalance) < 5e-3 * book.load_work
