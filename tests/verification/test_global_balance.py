"""Momentum is what tool and supports gave, and the torque of the tool is against its turn.

That each force term by itself can neither push nor turn the whole: tests/unit/test_every_term.py.
"""

import numpy as np
import pytest

import shellcut as sc
from shellcut.tool.shapes import straight_blade

# Round-off: some thousand terms are summed; relative to the sum of their sizes. Measured 6e-16.
ROUND_OFF = 1e-13


def _about_origin(sim, wrench):
    """Return force and moment about the origin of space from wrenches of the teeth."""
    force, moment = wrench.sum(axis=0)[:3], wrench.sum(axis=0)[3:]
    return force, moment + np.cross(sim.pose.translation, force)


def test_momentum_is_what_tool_and_supports_gave():
    sim = sc.guillotine(
        0.8,
        length=8.0,
        speed=12000.0,
        tool=straight_blade(length=4.0, height=3.0),
        fracture=sc.Fracture(path="edges"),
        damping_alpha=0.0,
    ).simulation
    node = sim.state.node

    def momentum():
        n = sim.state.n_node
        return node.mass[:n] @ node.velocity_half[:n]

    # The first kick, from rest, came from no force: the notch is free and unloaded.
    impulse, largest = momentum(), 0.0
    for _ in range(2500):
        before = momentum()
        sim.step()
        force, _ = _about_origin(sim, sim.tooth_wrenches)
        held = node.reaction[: sim.state.n_node, :3].sum(axis=0)
        dt = 0.5 * (sim.state.dt + sim.dt)
        step = dt * (held - force)
        # Round-off, relative to the impulse of all nodal forces, splits included.
        scale = dt * np.abs(node.force[: sim.state.n_node]).sum() + np.abs(before).max()
        assert np.abs(momentum() - before - step).max() <= ROUND_OFF * scale
        impulse = impulse + step
        largest = max(largest, float(np.abs(impulse).max()))
    assert sim.state.n_cable > 1
    assert np.abs(momentum() - impulse).max() < ROUND_OFF * 2500 * largest


def test_the_torque_on_a_resisted_screw_is_against_its_turn():
    through = sc.Fracture(path="free")
    sim = sc.opening_test("quick", duration=1.5e-3, fracture=through).simulation
    motion = sim.motion
    axis = np.array([0.0, 0.0, 1.0])
    torque, power, aside = [], [], []
    while sim.motion.coordinate(sim.state.time) < np.radians(12.0):
        sim.step()
        force, moment = _about_origin(sim, sim.tooth_wrenches)
        spin, velocity = motion.twist(sim.state.time)
        torque.append(-float(moment @ axis))  # what the drive must give, positive if resisted
        power.append(-float(force @ velocity + moment @ spin) * sim.state.dt)
        aside.append(np.abs(force[:2]).max() / max(np.abs(sim.tooth_wrenches[:, :3]).sum(), 1.0))
    # The sign, of the mean while the cuts begin: 54 to 126 N·mm.
    assert np.mean(torque[len(torque) // 2 :]) > 10.0
    # The ledger's tool work is the integral of that power, trapezoidal against midpoint twist:
    # discretisation, measured 1e-3.
    assert sim.ledger.tool_work > 0.0
    assert sim.ledger.tool_work == pytest.approx(np.sum(power), rel=5e-3)
    # Four teeth a quarter turn apart: no side force. Symmetry, up to round-off grown while the tips
    # rattle at first touch, and to a fibre that the edge of one tooth bends a step before the
    # others, which rings: 1e-5 of the force in most steps.
    assert sim.tooth_wrenches.shape == (4, 6)
    assert np.median(aside[len(aside) // 2 :]) < 1e-4
