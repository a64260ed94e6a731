"""Central difference on systems whose discrete solution is known in closed form."""

import numpy as np
import pytest

from naive import cases
from naive import kick as naive
from shellcut import Gravity, Simulation, Support
from shellcut.central_difference import CentralDifference
from shellcut.loads.supports import SupportSet
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state

EPS = np.finfo(float).eps
MASS, INERTIA = 2e-9, 3e-10


def one_quad(alpha=0.0):
    mesh = rectangle(1.0, 1.0, n_x=1, n_y=1)
    state = initial_state(mesh)
    for row in range(16):
        state.node.weigh(row, MASS, INERTIA)
    return mesh, state, CentralDifference(damping_alpha=alpha)


def test_director_stays_unit_and_spin_tangent_over_random_rotations():
    _, state, scheme = one_quad()
    node = state.node
    rng = np.random.default_rng(11)
    # Ten thousand kicks and drifts by random moments, on ten directors: 1e5 rotations. A quad of
    # a hundred nodes would do as well; the table has spare rows enough.
    node.count = 10
    node.t[:10] = rng.standard_normal((10, 3))
    node.t[:10] /= np.linalg.norm(node.t[:10], axis=1)[:, None]
    dt, size = 1e-7, INERTIA / 1e-7**2 * 0.3  # some 0.3 rad a step from each moment
    g = size * rng.standard_normal((10_000, 10, 3))
    for k in range(10_000):
        node.director_force[:10] = g[k]
        scheme.kick(state, dt, dt)
        if k % 20 == 19:
            node.spin_half[:10] *= 0.5  # a random walk would run away
        scheme.drift(state, dt)
    length = np.linalg.norm(node.t[:10], axis=1)
    # Round-off: a rotation rounds its result some three times by EPS/2; a random walk of 1e4 of
    # them is 3e-14. Measured 2e-14, the farthest of ten.
    assert np.abs(length - 1.0).max() < 5e-14
    spin = np.linalg.norm(node.spin_half[:10], axis=1)
    assert spin.min() * dt > 0.1  # it did turn
    along = np.abs(np.einsum("ni,ni->n", node.t[:10], node.spin_half[:10]))
    # Rounded at every kick and rotation, never corrected: relative to the largest spin so far.
    assert (along / spin).max() < 1e-12


def test_energy_is_an_identity_to_round_off():
    # Any forces at all, director forces too: change of ½ m v- v+ = ½ (f_n-1 + f_n) dx.
    _, state, scheme = one_quad()
    rng = np.random.default_rng(4)
    dt, node = 1e-6, state.node
    node.velocity_half[:4] = rng.standard_normal((4, 3))
    work, scale, last = 0.0, 0.0, None
    for n in range(200):
        node.force[:4] = rng.standard_normal((4, 3))
        node.director_force[:4] = 1e-2 * rng.standard_normal((4, 3))
        moment = np.cross(node.t[:4], node.director_force[:4])
        if n:
            done = 0.5 * dt * (last[0] + node.force[:4]) * node.velocity_half[:4]
            turned = 0.5 * dt * (last[1] + moment) * node.spin_half[:4]
            work += done.sum() + turned.sum()
            scale += np.abs(done).sum() + np.abs(turned).sum()
        result = scheme.kick(state, dt, dt)
        kinetic = result.kinetic_translation + result.kinetic_rotation
        if n == 0:
            start = kinetic
        last = node.force[:4].copy(), moment
        scheme.drift(state, dt)
    # Round-off relative to the sum of all works, taken without their signs.
    assert abs(kinetic - start - work) < 1e-13 * scale
    assert result.kinetic_rotation > 1e-4 * kinetic
    assert result.mass_damping == 0.0
    assert result.support_work == 0.0


@pytest.mark.parametrize(("before", "after", "mean"), [(0.0, 2e-6, 1e-6), (1e-6, 3e-6, 2e-6)])
def test_a_kick_takes_the_mean_of_two_unequal_steps_from_rest_half_of_one(before, after, mean):
    _, state, scheme = one_quad()
    state.node.force[:4] = [1.0, 0.0, 0.0]
    scheme.kick(state, before, after)
    assert state.node.velocity_half[0, 0] == pytest.approx(mean / MASS, rel=4 * EPS)


def test_alpha_acts_on_the_mean_velocity_in_the_kick_and_in_the_reaction():
    # m (v+ - v-)/dt + alpha m ½ (v+ + v-) = f + r, for free and for held components.
    alpha, dt = 2e4, 1e-6
    mesh, state, scheme = one_quad(alpha)
    SupportSet(mesh, [Support([1], "x", "")]).initialise(state)
    node = state.node
    node.velocity_half[:4], node.spin_half[:4] = [3.0, -1.0, 2.0], [1.0, 5.0, 0.0]
    node.force[:4], node.director_force[:4] = [1e-3, 2e-3, -1e-3], [5e-4, 1e-4, 0.0]
    node.support_rate[1, 0] = 7.0
    v, w = node.velocity_half[:4].copy(), node.spin_half[:4].copy()
    scheme.kick(state, dt, dt)
    after, spun = node.velocity_half[:4], node.spin_half[:4]
    left = MASS * (after - v) / dt + alpha * MASS * 0.5 * (after + v)
    right = node.force[:4] + node.reaction[:4, :3]
    np.testing.assert_allclose(left, right, rtol=0, atol=1e-13 * np.abs(left).max())
    assert after[1, 0] == 7.0
    assert node.reaction[1, 0] != 0.0
    assert not node.reaction[[0, 2, 3]].any()
    moment = np.cross(node.t[:4], node.director_force[:4])
    left = INERTIA * (spun - w) / dt + alpha * INERTIA * 0.5 * (spun + w)
    np.testing.assert_allclose(left, moment, rtol=0, atol=1e-13 * np.abs(left).max())


def test_constant_acceleration_needs_the_reaction_m_a():
    mesh, state, scheme = one_quad()
    a, dt = 1e7, 1e-6
    support = Support([1], rotation="", velocity={"x": lambda time: a * time})
    supports = SupportSet(mesh, [support])
    supports.initialise(state)
    time = 0.0
    booked = []
    for n in range(50):
        state.node.force[1] = [0.4, 0.3, 0.0]
        state.time = time
        supports.prescribe(state, dt, 1.0)
        result = scheme.kick(state, dt if n else 0.0, dt)
        work = booked[-1][0] + result.support_work if n else result.support_work
        booked.append((work, result.kinetic_translation, state.node.x[1, 0]))
        # m a minus the applied force along x, minus the force where it is held at rest.
        np.testing.assert_allclose(
            state.node.reaction[1, :3], [MASS * a - 0.4, -0.3, 0.0], rtol=0, atol=1e-12
        )
        scheme.drift(state, dt)
        time += dt
    assert state.node.x[1, 0] - 1.0 == pytest.approx(0.5 * a * time**2, rel=1e-12)
    # The work of reaction and force together is the change of kinetic energy, to round-off of the
    # sum; from the second kick on, as the first is a half one.
    (work_1, kinetic_1, x_1), (work_n, kinetic_n, x_n) = booked[1], booked[-1]
    assert work_n - work_1 + 0.4 * (x_n - x_1) == pytest.approx(kinetic_n - kinetic_1, rel=1e-11)
    assert supports.reaction(state, 0) == pytest.approx([MASS * a - 0.4, -0.3, 0.0], abs=1e-12)
    assert not state.node.reaction[[0, 2, 3]].any()


def test_a_held_spin_does_not_turn_and_its_reaction_balances_the_moment():
    mesh, state, scheme = one_quad()
    SupportSet(mesh, [Support([2], translation="", rotation="xyz")]).initialise(state)
    state.node.director_force[:4] = [2.0, 3.0, 4.0]
    scheme.kick(state, 0.0, 1e-6)
    scheme.drift(state, 1e-6)
    np.testing.assert_array_equal(state.node.t[2], [0, 0, 1])
    assert np.abs(state.node.t[0] - [0, 0, 1]).max() > 1e-4
    # t x g = (0, 0, 1) x (2, 3, 4) = (-3, 2, 0); the reaction is minus that.
    np.testing.assert_allclose(state.node.reaction[2, 3:], [3.0, -2.0, 0.0], atol=4 * EPS)


@pytest.mark.parametrize("first", [True, False], ids=["first kick", "later"])
@pytest.mark.parametrize("alpha", [0.0, 3e5])
def test_kick_and_drift_are_those_of_the_plain_twin_whatever_is_held(first, alpha):
    """Twenty-one nodes, each with other components held, at rest or moved, from any velocity."""
    mesh = rectangle(6.0, 2.0, n_x=6, n_y=2)
    state, scheme = initial_state(mesh), CentralDifference(damping_alpha=alpha)
    node, n, rng = state.node, mesh.n_node, np.random.default_rng(12)
    mass, inertia = rng.uniform(1e-9, 3e-9, n), rng.uniform(1e-10, 3e-10, n)
    for row in range(n):
        node.weigh(row, mass[row], inertia[row])
    axes = ["", "x", "y", "z", "xy", "yz", "xz", "xyz"]
    supports = [
        Support([k], axes[k % 8], axes[(k // 2 + k) % 8]) for k in range(n) if k % 8 or k % 3
    ]
    SupportSet(mesh, supports).initialise(state)
    node.t[:n] = rng.standard_normal((n, 3))
    node.t[:n] /= np.linalg.norm(node.t[:n], axis=1)[:, None]
    for rows in (node.velocity_half, node.spin_half):
        rows[:n] = rng.standard_normal((n, 3))
    held = node.support[:n]
    node.support_rate[:n] = np.where(held, rng.standard_normal((n, 6)), 0.0)
    node.reaction[:n] = np.where(held, rng.standard_normal((n, 6)), 0.0)
    node.force[:n] = 1e-3 * rng.standard_normal((n, 3))
    node.director_force[:n] = 1e-3 * rng.standard_normal((n, 3))
    dt_last, dt = (0.0, 2e-6) if first else (1e-6, 2e-6)
    moment = np.cross(node.t[:n], node.director_force[:n])
    parts = [
        (mass, node.velocity_half[:n].copy(), node.force[:n].copy(), slice(0, 3), False),
        (inertia, node.spin_half[:n].copy(), moment, slice(3, 6), True),
    ]
    was, t = node.reaction[:n].copy(), node.t[:n].copy()
    result = scheme.kick(state, dt_last, dt)
    energies = np.zeros((2, 3))
    after = np.zeros((2, n, 3))
    for k, (m, before, load, own, spins) in enumerate(parts):
        for i in range(n):
            rate = node.support_rate[i, own]
            given = m[i], before[i], load[i], held[i, own], rate, was[i, own]
            director = t[i] if spins else None
            after[k, i], reaction, part = naive.kicked(*given, alpha, dt_last, dt, director)
            np.testing.assert_allclose(node.reaction[i, own], reaction, rtol=1e-11, atol=1e-15)
            energies[k] += part
    np.testing.assert_allclose(node.velocity_half[:n], after[0], rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(node.spin_half[:n], after[1], rtol=1e-11, atol=1e-12)
    assert result.kinetic_translation == pytest.approx(energies[0, 0], rel=1e-12)
    assert result.kinetic_rotation == pytest.approx(energies[1, 0], rel=1e-12)
    assert result.mass_damping == pytest.approx(energies[:, 1].sum(), rel=1e-12)
    assert result.support_work == pytest.approx(energies[:, 2].sum(), rel=1e-12)
    assert (result.support_work == 0.0) == first
    x = node.x[:n].copy()
    scheme.drift(state, 1e-1)
    np.testing.assert_allclose(node.x[:n], x + 1e-1 * after[0], rtol=0, atol=1e-13)
    directors = [naive.turned(*pair) for pair in zip(t, 1e-1 * after[1], strict=True)]
    np.testing.assert_allclose(node.t[:n], directors, rtol=0, atol=1e-12)


def test_drift_leaves_spare_rows_alone():
    _, state, scheme = one_quad()
    state.node.x[4:] = np.nan
    state.node.velocity_half[:] = 1.0
    scheme.kick(state, 1e-6, 1e-6)
    scheme.drift(state, 1e-6)
    assert np.isnan(state.node.x[4:]).all()
    assert (state.node.velocity_half[4:] == 1.0).all()


@pytest.mark.parametrize("case", cases.ALL)
def test_free_fall_is_g(case):
    mesh = cases.ALL[case]()
    # So strong that the inner forces, the rounding of positions times the frequency squared or some
    # 1e-2 mm/s², are below 1e-12 of it.
    g = np.array([2e11, -3e11, -5e11])
    sim = Simulation(mesh, cases.FILM, loads=[Gravity(g)], damping_alpha=0.0)
    sim.step()
    ledger = sim.ledger
    start = ledger.kinetic - ledger.load_work
    for _ in range(49):
        sim.step()
    s = sim.state
    half = s.time + 0.5 * sim.dt
    fallen = s.node.velocity_half[: mesh.n_node] / (g * half)
    assert np.abs(fallen - 1.0).max() < 1e-12
    moved = s.node.x[: mesh.n_node] - mesh.nodes
    np.testing.assert_allclose(moved, np.tile(0.5 * g * s.time**2, (mesh.n_node, 1)), rtol=1e-9)
    # From the second kick on, as the first is a half one.
    assert ledger.load_work == pytest.approx(ledger.kinetic - start, rel=1e-12)
