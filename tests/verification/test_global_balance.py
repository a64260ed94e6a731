"""Momentum is what tool and supports gave.

That each force term by itself can neither push nor turn the whole: tests/unit/test_every_term.py.
"""

import numpy as np

import shellcut as sc
from shellcut.tool.shapes import straight_blade

# Round-off: some thousand terms are summed; relative to the sum of their sizes. Measured 6e-16.
ROUND_OFF = 1e-13


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
        force = sim.tooth_wrenches[:, :3].sum(axis=0)
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
