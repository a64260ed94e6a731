"""Central difference on systems whose discrete solution is known in closed form."""

import numpy as np
import pytest

from naive import kick as naive
from shellcut import Support
from shellcut.central_difference import CentralDifference
from shellcut.loads.supports import SupportSet
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state


def test_director_stays_unit_and_spin_tangent_over_random_rotations():
    # Ten directors in the spare rows of the table, each turned 10,000 times by random moments.
    state = initial_state(rectangle(1.0, 1.0, n_x=1, n_y=1))
    node, scheme = state.node, CentralDifference(damping_alpha=0.0)
    rng, n, dt, inertia = np.random.default_rng(11), 10, 1e-7, 3e-10
    for row in range(16):
        node.weigh(row, 2e-9, inertia)
    node.count = n
    node.t[:n] = rng.standard_normal((n, 3))
    node.t[:n] /= np.linalg.norm(node.t[:n], axis=1)[:, None]
    node.x[n:] = np.nan
    size = inertia / dt**2 * 0.3  # some 0.3 rad a step from each moment
    for k in range(10_000):
        node.director_force[:n] = size * rng.standard_normal((n, 3))
        scheme.kick(state, dt, dt)
        if k % 20 == 19:
            node.spin_half[:n] *= 0.5  # a random walk would run away
        scheme.drift(state, dt)
    length = np.linalg.norm(node.t[:n], axis=1)
    # Round-off: a rotation rounds its result some three times by 1.1e-16; a random walk of 1e4 of
    # them is 3e-14. Measured 2e-14, the farthest of ten.
    assert np.abs(length - 1.0).max() < 5e-14
    spin = np.linalg.norm(node.spin_half[:n], axis=1)
    assert spin.min() * dt > 0.1  # it did turn
    along = np.abs(np.einsum("ni,ni->n", node.t[:n], node.spin_half[:n]))
    # Rounded at every kick and rotation, never corrected: relative to the largest spin so far.
    assert (along / spin).max() < 1e-12
    assert np.isnan(node.x[n:]).all()  # spare rows stay as they are


@pytest.mark.parametrize("first", [True, False], ids=["first kick", "later"])
@pytest.mark.parametrize("alpha", [0.0, 3e5])
def test_kick_and_drift_are_those_of_the_plain_reference_whatever_is_supported(first, alpha):
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
