"""Loads on cut quads: each copy bears what acts on its own part of the film."""

import numpy as np
import pytest

import shellcut as sc
from films import free_film, pieces
from naive.load import pressure_rows_of_part
from shellcut.fracture.cuts import Cuts
from shellcut.fracture.quad_polygon import FLANK, along_side, on_side
from shellcut.fracture.tip import Segment
from shellcut.loads.loads import LoadSet
from shellcut.mesh.structured import rectangle


def rising(time):
    return 1.0 + time


LOADS = {
    "dead": [sc.Pressure(0.3, factor=rising)],
    "following": [sc.Pressure(0.2, following=True, factor=rising)],
    "some": [sc.Pressure(0.2, True, quads="some"), sc.Pressure(-0.1, quads="some")],
    "edge": [sc.EdgeTraction("right", (2.0, 0.3, -1.0)), sc.EdgeTraction("top", (0.1, 0.0, 1.0))],
    "weight": [sc.Gravity((10.0, 20.0, -9810.0))],
}


def film():
    """Return a film in a state that is nowhere symmetric: curved, stretched, in motion."""
    mesh = rectangle(4.0, 3.0, size=0.5)
    X, rng = mesh.nodes.copy(), np.random.default_rng(3)
    X[:, 2] = 0.1 * X[:, 0] ** 2 + 0.05 * X[:, 0] * X[:, 1]
    mesh = sc.Mesh.from_arrays(X, mesh.quads, node_sets=mesh.node_sets)
    mesh = mesh.with_sets(quad_sets={"some": np.arange(0, mesh.n_quad, 2)})
    sim = sc.Simulation(mesh, sc.ShellMaterial.homogeneous(), threads=1)
    sim.state.time, n = 0.5, sim.state.node
    n.x[: n.count] += 0.1 * rng.normal(size=(n.count, 3))
    n.velocity_half[: n.count] = rng.normal(size=(n.count, 3))
    return sim


def random_cut(sim, cuts, row, rng):
    """Cut a row from one place of its boundary to another."""
    polygon = cuts.topology.polygon(row)
    count = len(polygon.points)
    ends = []
    for e in rng.choice(count, 2, replace=False):
        a, b = np.array(polygon.points[e]), np.array(polygon.points[(e + 1) % count])
        side = polygon.sides[e]
        if side >= 0:
            s_a, s_b = (along_side(side, tuple(p)) for p in (a, b))
            ends.append(on_side(side, s_a + rng.uniform(0.2, 0.8) * (s_b - s_a)))
        else:
            ends.append(tuple(a + rng.uniform(0.2, 0.8) * (b - a)))
    cuts.along(sim.state, Segment(row, *ends, FLANK, -1), "criterion", 1.0)


def random_cuts(sim, loads, number, rng, after=lambda state: None):
    """Cut rows, every second one at the rim under a load."""
    cuts = Cuts(sim.state, sim.shell, sc.CohesiveLaw(), loads=loads, fibres=6)
    topology = cuts.topology
    rim = np.flatnonzero(np.isin(sim.mesh.quads, sim.mesh.node_set("right")).any(axis=1))
    for k in range(number):
        random_cut(sim, cuts, int(rng.integers(topology.n_row) if k % 2 else rng.choice(rim)), rng)
        after(sim.state)
    return topology


def resultants(state, loads):
    """Return force, moment and power of the loads on the nodes."""
    n, c = state.node, state.node.count
    loads.begin_forces(state)
    force = n.force[:c].copy()
    x, v = n.x[:c], n.velocity_half[:c]
    return force.sum(axis=0), np.cross(x, force).sum(axis=0), (force * v).sum()


@pytest.mark.parametrize("load", LOADS)
def test_no_cut_changes_force_moment_or_power(load):
    sim = film()
    loads = LoadSet(sim.mesh, LOADS[load])
    before = resultants(sim.state, loads)
    random_cuts(sim, loads, 20, np.random.default_rng(11))
    after = resultants(sim.state, loads)
    assert sim.state.n_node > sim.mesh.n_node
    n = sim.state.node
    every = np.abs(n.force[: n.count]).sum()
    for one, other in zip(before, after, strict=True):
        np.testing.assert_allclose(other, one, rtol=0, atol=1e-12 * every)  # round-off


@pytest.mark.parametrize("load", LOADS)
def test_loads_that_follow_the_cuts_are_those_of_a_film_cut_before(load):
    # As after a resumed run: the same bits.
    sim = film()
    loads, n = LoadSet(sim.mesh, LOADS[load]), sim.state.node
    loads.begin_forces(sim.state)
    random_cuts(sim, loads, 15, np.random.default_rng(2), loads.begin_forces)
    followed = n.force[: n.count].copy()
    anew = LoadSet(sim.mesh, LOADS[load])
    for row, moments, sides in zip(*loads.cut.parts, strict=True):
        anew.cut.take(int(row), moments, sides)
    anew.begin_forces(sim.state)
    np.testing.assert_array_equal(n.force[: n.count], followed)


@pytest.mark.parametrize("following", [False, True])
def test_pressure_on_every_copy_against_quadrature(following):
    sim = film()
    loads = LoadSet(sim.mesh, [sc.Pressure(0.3, following=following)])
    topology = random_cuts(sim, loads, 15, np.random.default_rng(5))
    s = sim.state
    loads.begin_forces(s)
    wanted = np.zeros((s.n_node, 3))
    for row in range(s.n_quad):
        points = topology.polygon(row).points
        corners = sim.mesh.nodes[sim.mesh.quads[topology.parent(row)]]
        x = s.node.x[s.quads[row]] if following else corners
        wanted[s.quads[row]] += pressure_rows_of_part(x, points, 0.3)
    # Round-off: both are exact for the polynomials of bilinear quads.
    scale = np.abs(wanted).max()
    np.testing.assert_allclose(s.node.force[: s.n_node], wanted, rtol=0, atol=1e-13 * scale)


@pytest.mark.parametrize("load", LOADS)
def test_corner_forces_of_copies_add_up_to_the_load_on_the_node(load):
    """But for the weight, which accelerates both halves of a node alike and is left out."""
    sim = film()
    loads = LoadSet(sim.mesh, LOADS[load])
    random_cuts(sim, loads, 15, np.random.default_rng(8))
    s = sim.state
    loads.begin_forces(s)
    total, rows = np.zeros((s.n_node, 3)), np.arange(s.n_quad)
    for nodes in s.quads.T.astype(np.int64):
        force = np.zeros((s.n_quad, 3))
        loads.add_corner_forces(s, rows, nodes, force)
        np.add.at(total, nodes, force)
    wanted = s.node.force[: s.n_node] * (load != "weight")
    np.testing.assert_allclose(total, wanted, rtol=0, atol=1e-13 * np.abs(total).max())


def test_the_parts_of_a_strip_bear_pressure_times_their_area():
    mesh = rectangle(6.0, 3.0, size=0.5)
    loads = [sc.Pressure(0.2, True), sc.EdgeTraction("top", (0.0, 1.0, 0.0))]
    sim = free_film(mesh, loads=loads)
    x, y, _ = mesh.nodes.min(axis=0)
    sim.notch((x + 2.13, y - 0.1, 0.0), (x + 2.87, y + 3.1, 0.0))
    s, n = sim.state, sim.state.node
    sim.loads.begin_forces(s)
    corner, of_row = int(np.argmin(mesh.nodes @ [1.0, 1.0, 0.0])), pieces(s.quads)
    rows = of_row == of_row[(s.quads == corner).any(axis=1)][0]
    _, along, across = n.force[np.unique(s.quads[rows])].sum(axis=0)
    area = sim.shell.area[: s.n_quad] @ (s.quad.share[: s.n_quad] * rows)
    assert across == pytest.approx(0.2 * area, rel=1e-12)  # round-off
    # A cut is moved onto corners within a twentieth of an edge.
    assert area == pytest.approx(3.0 * 2.5, abs=3.0 * 0.025)
    assert along == pytest.approx(2.846, abs=0.025)
    assert n.force[: n.count].sum(axis=0) == pytest.approx([0.0, 6.0, 3.6], abs=1e-12)
