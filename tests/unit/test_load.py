"""Loads against quadrature, closed forms, and the share of each half of a split node."""

import numpy as np
import pytest

from naive import cases
from naive import load as naive
from shellcut import ShellMaterial, Simulation, Support
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.cuts import Cuts
from shellcut.loads.loads import EdgeTraction, Gravity, LoadSet, NodalForce, NodalMoment, Pressure
from shellcut.loads.supports import SupportSet
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state
from test_topology import SEQUENCE, prepared

MESH = rectangle(2.0, 1.0, n_x=2, n_y=1)


def loaded(mesh, *loads, deform=False):
    state, n = initial_state(mesh), mesh.n_node
    state.node.mass[:n] = np.arange(1.0, n + 1)
    if deform:
        cases.deform(state)
    state.node.force_rows[:n] = 7.0  # of the step before: begun anew
    state.node.force[n:] = np.nan
    loads = LoadSet(mesh, loads)
    loads.begin_forces(state)
    assert np.isnan(state.node.force[n:]).all()
    assert not state.node.director_force[:n].any()
    return state, loads


def by_quadrature(x, quads, pressure):
    force = np.zeros_like(x)
    for quad in quads:
        force[quad] += naive.pressure_rows(x[quad], pressure)
    return force


@pytest.mark.parametrize("case", cases.ALL)
@pytest.mark.parametrize("following", [False, True])
def test_pressure_against_quadrature(case, following):
    mesh = cases.ALL[case]()
    state, _ = loaded(mesh, Pressure(0.3, following=following), deform=True)
    x = state.node.x[: mesh.n_node] if following else mesh.nodes
    wanted = by_quadrature(x, mesh.quads, 0.3)
    # Round-off: 2 x 2 points are exact for the product of bilinear functions.
    np.testing.assert_allclose(
        state.node.force[: mesh.n_node], wanted, rtol=0, atol=1e-14 * np.abs(wanted).max() * 10
    )


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda f: Support([8], velocity={"x": f}), r"along x of supports\[0]"),
        (lambda f: Support([0], spin={"z": f}), r"spin along z of supports\[0]"),
        (lambda f: Gravity((0, 0, -9.0), f), r"factor of loads\[0] \(Gravity\)"),
        (lambda f: Pressure(0.1, following=True, factor=f), r"loads\[0] \(Pressure\)"),
        (lambda f: EdgeTraction("left", (1, 0, 0), f), r"loads\[0] \(EdgeTraction\)"),
        (lambda f: NodalForce([3], (1, 0, 0), f), r"loads\[0] \(NodalForce\)"),
        (lambda f: NodalMoment([3], (1, 0, 0), f), r"loads\[0] \(NodalMoment\)"),
    ],
)
def test_a_function_of_time_that_is_not_finite_is_named_with_the_time(given, said):
    one = given(lambda time: np.nan if time > 2e-6 else 1.0)
    kind = "supports" if isinstance(one, Support) else "loads"
    mesh = rectangle(2.0, 2.0, n_x=2, n_y=2)
    sim = Simulation(mesh, ShellMaterial.homogeneous(), **{kind: [one]})
    with pytest.raises(ValueError, match=rf"{said} must be finite, got nan at t = 2\.\S+e-06 s$"):
        sim.run(1e-5)


def test_gravity_nodal_force_and_factor():
    force = NodalForce([1, 4], (3.0, 0, 0), lambda t: 1 + 10 * t)
    state, loads = loaded(MESH, Gravity((0, 0, -2.0)), force)
    np.testing.assert_allclose(state.node.force[:6, 2], -2.0 * np.arange(1, 7))
    assert state.node.force[:6, 0].tolist() == [0, 3, 0, 0, 3, 0]
    state.time = 0.1
    loads.begin_forces(state)
    assert state.node.force[1, 0] == pytest.approx(6.0, rel=4e-16)


def test_edge_traction_is_shared_by_the_ends_of_boundary_edges():
    mesh = cases.skewed_flat()
    right = mesh.node_set("right")
    state, _ = loaded(mesh, EdgeTraction("right", (0.0, 2.0, -1.0)))
    length = np.linalg.norm(np.diff(mesh.nodes[right], axis=0), axis=1)
    wanted = np.zeros(right.size)
    wanted[:-1] += 0.5 * length
    wanted[1:] += 0.5 * length
    force = state.node.force[: mesh.n_node]
    np.testing.assert_allclose(force[right, 1], 2.0 * wanted, rtol=1e-14)
    np.testing.assert_allclose(force[right, 2], -wanted, rtol=1e-14)
    assert not np.delete(force, right, axis=0).any()


def test_work_is_the_trapezoid_of_force_and_step_and_counts_every_node():
    mesh = cases.skewed_flat(4, 2)  # 15 nodes: eight by lanes, seven one by one
    state, factor = initial_state(mesh), lambda t: 1 + t
    force = np.array([3.0, 1.0, 0.0])
    loads = LoadSet(mesh, [Pressure(0.3, factor=factor), NodalForce([2], force, factor)])
    assert loads.begin_forces(state) == 0.0
    state.dt, state.time = 0.5, 0.5
    velocity = np.random.default_rng(3).uniform(-1, 1, (mesh.n_node, 3))
    state.node.velocity_half[: mesh.n_node] = velocity
    dead = by_quadrature(mesh.nodes, mesh.quads, 0.3)
    dead[2] += force
    wanted = 0.5 * (1.0 + 1.5) * 0.5 * (dead * velocity).sum()
    # Round-off of a sum of 45 terms.
    assert loads.begin_forces(state) == pytest.approx(wanted, rel=1e-13)


def test_dead_pressure_goes_with_the_quads_of_a_split_node():
    mesh, shell, state = prepared()
    loads = LoadSet(mesh, [Pressure(0.3)])
    cuts = Cuts(state, shell, CohesiveLaw(), fibres=6)
    for _, side, _ in SEQUENCE:
        cases.break_side(cuts, shell, state, *side)
        n = state.n_node
        loads.begin_forces(state)
        wanted = by_quadrature(mesh.nodes[state.node.origin[:n]], state.quads, 0.3)
        largest = np.abs(wanted).max()
        np.testing.assert_allclose(state.node.force[:n], wanted, rtol=0, atol=1e-13 * largest)


# --- supports: which components are fixed, prescribed velocities, refusals


@pytest.mark.parametrize(
    ("supports", "wanted"),
    [
        ([Support.clamped([1])], {1: "111111"}),
        ([Support.pinned([1])], {1: "111000"}),
        # In the plane x = 0 the director may not leave the plane: no spin about y and z.
        ([Support.symmetry([1], "x")], {1: "100011"}),
        ([Support("left", "z", "")], {0: "001000", 3: "001000"}),
        # Supports of one node add up.
        ([Support([0], "x", ""), Support([0], "y", "x")], {0: "110100"}),
        # On a plane film a spin about z moves no director; with x and y fixed only z would be left.
        ([Support([0], "", "z")], {}),
        ([Support([0], "", "xy")], {0: "000111"}),
        ([Support([0], "", "xz")], {0: "000101"}),
        # A prescribed spin is always applied.
        ([Support([0], "", "z", spin={"z": np.cos})], {0: "000001"}),
    ],
)
def test_what_a_support_fixes(supports, wanted):
    state = initial_state(MESH)
    SupportSet(MESH, supports).initialise(state)
    node = state.node
    assert (node.supported == node.support.any(axis=1)).all()
    rows = {n: "".join(map(str, node.support[n].astype(int))) for n in range(MESH.n_node)}
    assert {n: row for n, row in rows.items() if "1" in row} == wanted


def test_prescribed_velocity_is_written_at_the_half_step():
    state = initial_state(MESH)
    moving = Support("right", velocity={"x": lambda t: 3.0 * t, "z": np.cos})
    supports = SupportSet(MESH, [Support.clamped("left"), moving])
    supports.initialise(state)
    supports.prescribe(state, 1.0, 1.0)
    for node in MESH.node_set("right"):
        assert state.node.support_rate[node].tolist() == [1.5, 0.0, np.cos(0.5), 0, 0, 0]
    assert not state.node.support_rate[MESH.node_set("left")].any()


@pytest.mark.parametrize(
    ("make", "message"),
    [
        (lambda: Support([0], rotation="q"), "rotation must be made of"),
        (lambda: Support.symmetry([0], "xy"), "normal must be one of x, y and z, got 'xy'"),
        (lambda: SupportSet(MESH, [Support([0.5])]), "list of node ids"),
    ],
)
def test_refusals(make, message):
    with pytest.raises(ValueError, match=message):
        make()


def test_a_prescribed_spin_turns_the_director():
    turned = Support("right", spin={"y": lambda time: 1e4})
    sim = Simulation(MESH, ShellMaterial.homogeneous(), supports=[Support("left"), turned])
    sim.run(until=2e-5)
    # t = (sin wt, 0, cos wt) about +y; Cayley steps err by (w dt)²/12, here 3e-6.
    t = sim.state.node.t[MESH.node_set("right"), 0]
    np.testing.assert_allclose(t, np.sin(1e4 * sim.state.time), rtol=1e-5)
    # What turns it has done work on the film.
    assert sim.ledger.support_work > 0
    assert abs(sim.ledger.imbalance) < 1e-2 * sim.ledger.support_work
