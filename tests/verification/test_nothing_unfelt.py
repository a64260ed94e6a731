"""Nothing of a tool goes deeper than half a thickness into film that does not feel it.

In the ready models with a tool, in short form: the trouser test has none, and a needle between
nodes is in tests/unit/test_point_contact.py.
"""

import numpy as np
import pytest

import shellcut as sc
from shellcut.contact.missed_penetration import ToolWires, missed_penetration
from shellcut.contact.point_contact import felt_nodes
from shellcut.contact.settings import Contact
from shellcut.fracture.criterion import Fracture
from shellcut.mesh.structured import rectangle
from shellcut.models import free_cut
from shellcut.tool.motion import StraightMotion
from shellcut.tool.shapes import straight_blade


def free_strip():
    """A blade that comes to a strip from outside, beside its lines."""
    mesh = rectangle(8.0, 6.0, size=0.4)
    return free_cut(
        mesh,
        tool=straight_blade(height=3.0).translated((-0.3, 3.1, 0.0)),
        motion=StraightMotion((1.0, 0.0, 0.0), 6000.0, ramp=1e-4),
        duration=8e-4,
        supports=[sc.Support.clamped(np.union1d(mesh.node_set("bottom"), mesh.node_set("top")))],
    )


SHORT = {
    "opening quick": (lambda: sc.opening_test("quick"), 12_000),
    "opening M1": (lambda: sc.opening_test("M1"), 12_000),
    "guillotine": (lambda: sc.guillotine(0.4, length=12.0), 8_000),
    "guillotine through quads": (
        lambda: sc.guillotine(0.4, length=12.0, fracture=Fracture(path="free")),
        8_000,
    ),
    "oscillating": (lambda: sc.oscillating(0.8), 8_000),
    "free cut": (free_strip, 5_000),
}


def deepest_unfelt(sim, n_step):
    wires, deepest = ToolWires(sim.tool), 0.0
    for _ in range(n_step):
        sim.step()
        if sim.state.step % 20 == 0:
            felt = felt_nodes(sim.tool_terms)
            deepest = max(deepest, missed_penetration(wires, sim.state, sim.pose, felt)[1])
    assert sim.ledger.tool_work > 0.0
    return deepest


@pytest.mark.slow
@pytest.mark.parametrize("name", SHORT)
def test_nothing_deeper_than_half_the_thickness_is_unfelt(name):
    build, n_step = SHORT[name]
    sim = build().simulation
    deepest = deepest_unfelt(sim, n_step)
    print(f"{name}: {deepest:.4f} mm of {sim.material.thickness} mm")
    assert deepest < 0.5 * sim.material.thickness


@pytest.mark.slow
def test_without_the_points_of_the_tool_it_would_be():
    sim = sc.opening_test("quick", contact=Contact(tool_points=False)).simulation
    assert deepest_unfelt(sim, 12_000) > 0.5 * sim.material.thickness
