"""Blades through random meshes on any path: nothing blows up, and the ledger closes.

Straight cuts at random angles and heights from a notch at the rim, and teeth that come down in the
middle and turn. A short version of a fuzz over hundreds of seeds.
"""

import numpy as np
import pytest

import shellcut as sc
from shellcut.mesh.structured import rectangle
from shellcut.tool_shapes import straight_blade, tooth_ring

LENGTH, WIDTH, SIZE = 12.0, 10.0, 0.8


def film(rng):
    mesh = rectangle(LENGTH, WIDTH, size=SIZE)
    X = mesh.nodes - [*mesh.nodes.mean(axis=0)[:2], 0.0]
    inside = np.ones(mesh.n_node, bool)
    inside[mesh.boundary_nodes()] = False
    X[inside, :2] += rng.uniform(-0.22, 0.22, (inside.sum(), 2)) * SIZE
    return X, mesh


def line(rng):
    """Return a blade that enters at the left rim, its time, and how far off its path a place is."""
    X, mesh = film(rng)
    angle = np.radians(rng.uniform(-25.0, 25.0))
    c, s = np.cos(angle), np.sin(angle)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    free = (np.abs(X[:, 0] + LENGTH / 2) < 1e-9) & (np.abs(X[:, 1]) < WIDTH / 2 - 1e-6)
    held = np.setdiff1d(mesh.boundary_nodes(), np.flatnonzero(free))
    start = turn @ [-LENGTH / 2, rng.uniform(-1.0, 1.0), 0.0]
    blade = straight_blade(length=20.0, height=6.0).translated((start[0] - 0.9, start[1], 0.0))
    sim = sc.Simulation(
        sc.Mesh.from_arrays(X @ turn.T, mesh.quads, node_sets={"held": held}),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("held")],
        tool=blade,
        motion=sc.StraightMotion((1.0, 0.0, 0.0), speed=6000.0, ramp=1e-4),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
    )
    ahead = np.array([1.0, 0.0, 0.0])
    sim.notch(start - 1.5 * ahead, start + 2.0 * ahead)
    return sim, 8.0 / 6000.0, lambda places: np.abs(places[:, 1] - start[1])


def arc(rng):
    """Return teeth that screw down into the film, likewise."""
    X, mesh = film(rng)
    radius = rng.uniform(2.5, 3.5)
    sim = sc.Simulation(
        sc.Mesh.from_arrays(X, mesh.quads, node_sets={"rim": mesh.boundary_nodes()}),
        sc.ShellMaterial.homogeneous(),
        supports=[sc.Support.clamped("rim")],
        tool=tooth_ring(n_teeth=2, radius=radius),
        motion=sc.ScrewMotion.over(angle_deg=120.0, duration=4e-3, pitch=rng.uniform(8.0, 14.0)),
        law=sc.CohesiveLaw(),
        fracture=sc.Fracture(path="free"),
    )
    return sim, 2.5e-3, lambda places: np.abs(np.hypot(places[:, 0], places[:, 1]) - radius)


@pytest.mark.parametrize(("path", "seed"), [(line, 1), (line, 2), (arc, 1)])
def test_any_path_through_any_mesh(path, seed):
    sim, until, off = path(np.random.default_rng(seed))
    largest = worst = 0.0
    while sim.state.time < until:
        sim.step()
        if sim.state.step % 100 == 0:
            book = sim.close_ledger()
            largest = max(largest, book.tool_work)
            if book.tool_work > 2.0:
                worst = max(worst, abs(book.imbalance) / largest)
    assert sim.state.crack_length > 3.0
    assert sim.cables.n_broken > 0
    assert worst < 5e-3
    # The cuts begin on the path, also of a tooth that turns: they aim where its edge will be. They
    # move onto corners within 0.05 edges; an eighth of the edge squared over the least radius is as
    # much. Only where a tooth comes down is there no path behind it yet.
    log = [cut for cut in sim.state.split_log if cut.kind != "notch" and cut.measure > 0.0]
    assert off(np.array([cut.reference for cut in log])).max() < 0.1 * SIZE
    # Cables were met in time, on the way of the edge.
    cables = sim.state.cable
    assert cables.overshoot[: cables.count].max() < 0.25 * SIZE
    # All mass is still there, and only real nodes or flank points are touched.
    nodes = sim.state.node
    assert nodes.mass[: nodes.count].sum() == pytest.approx(
        sim.mesh.quad_areas().sum() * 0.074e-9, rel=1e-12
    )
    assert not nodes.contact_force[: nodes.count][~nodes.real[: nodes.count]].any()
