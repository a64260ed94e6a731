"""No penetration above half a thickness without force: tool in film, border of film in tool.

In the ready models with a tool, the finer ones in short form: the trouser test has none. A needle
between nodes is in tests/unit/test_point_contact.py, a round bar in test_border_contact.py there.
"""

import numpy as np
import pytest

import shellcut as sc
from blunt_tools import spike
from courses import recorded
from shellcut.mesh.structured import rectangle
from shellcut.models import free_cut
from shellcut.recording.unfelt_penetration import UnfeltPenetration
from shellcut.tool.shapes import straight_blade


def free_strip():
    """A blade that reaches a strip from outside, beside its lines."""
    mesh = rectangle(8.0, 6.0, size=0.4)
    return free_cut(
        mesh,
        tool=straight_blade(height=3.0).translated((-0.3, 3.1, 0.0)),
        motion=sc.StraightMotion((1.0, 0.0, 0.0), 6000.0, ramp=1e-4),
        duration=8e-4,
        supports=[sc.Support.clamped(np.union1d(mesh.node_set("bottom"), mesh.node_set("top")))],
    )


FREE = sc.Fracture(path="free")
SHORT = {
    "opening quick": (lambda: sc.opening_test("quick"), 45_000),
    "opening M1": (lambda: sc.opening_test("M1"), 57_000),
    "opening M2": (lambda: sc.opening_test("M2"), 40_000),
    "guillotine": (lambda: sc.guillotine(0.4, length=12.0), 8_000),
    "through quads": (lambda: sc.guillotine(0.4, length=12.0, fracture=FREE), 8_000),
    "oscillating": (lambda: sc.oscillating(0.8), 8_000),
    "free cut": (free_strip, 5_000),
}


# Of the thickness; perturbed runs of the coarse quads of quick have 0.22 with a standard deviation
# of 0.09 (docs/limits.md).
DEEPEST = {"opening quick": 0.6}


def deepest_unfelt(sim, n_step):
    """Depths of the tool in quads, and of borders of the film in the tool."""
    unfelt = UnfeltPenetration(sim)
    found = recorded(sim, lambda one: one.state.step >= n_step, lambda one: unfelt.now(), every=20)
    assert sim.ledger.tool_work > 0.0
    return found.max(axis=1)


@pytest.mark.parametrize("felt", [True, False])
def test_a_spike_between_nodes_is_deep_within_a_quad_where_nothing_feels_it(felt):
    film = rectangle(4.0, 4.0, n_x=4, n_y=4)
    sim = sc.Simulation(
        film,
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped(film.boundary_nodes())],
        tool=spike().translated((2.37, 0.21, 0.01)),
        motion=sc.StraightMotion((0.0, 0.0, -1.0), 2000.0, ramp=2e-5),
        contact=sc.Contact(tool_points=felt),
    )
    unfelt = UnfeltPenetration(sim)
    sim.run(6e-5)  # 0.1 mm, in which none of its faces comes to a node
    within, _ = unfelt.now()
    way = sim.motion.coordinate(sim.state.time) - 0.01
    # Felt, the film gives way; else the gauge says how far the tip has gone through it.
    assert within < 0.5 * sim.material.thickness if felt else within == pytest.approx(way, rel=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHORT)
def test_nothing_deeper_than_about_half_the_thickness_is_unfelt(name):
    build, n_step = SHORT[name]
    sim = build().simulation
    deepest = deepest_unfelt(sim, n_step)
    print(f"{name}: {deepest} mm of {sim.material.thickness} mm")
    assert (deepest < DEEPEST.get(name, 0.5) * sim.material.thickness).all()


@pytest.mark.slow
def test_without_what_feels_them_edges_of_the_film_would_be_deeper():
    # A cutting edge that goes through film cuts it at once; what goes between nodes of whole film
    # is in tests/unit/test_point_contact.py.
    sim = sc.opening_test("quick", contact=sc.Contact(film_edges=False)).simulation
    assert deepest_unfelt(sim, 12_000)[1] > 0.5 * sim.material.thickness
