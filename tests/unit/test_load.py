"""Loads against quadrature, closed forms, and the share of each half of a split node."""

import numpy as np
import pytest

from naive import cases
from naive import load as naive
from shellcut import ShellMaterial, Simulation, Support
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.cuts import Cuts
from shellcut.loads.loads import EdgeTraction, Gravity, LoadSet, NodalForce, NodalMoment, Pressure
from shellcut.loads.supports import SupportSet, choose_nodes
from shellcut.mesh.structured import cylinder, rectangle
from shellcut.mitc4.initial_state import initial_state
from test_topology import SEQUENCE, prepared

EPS = np.finfo(float).eps


def loaded(mesh, *loads, deform=False):
    state = initial_state(mesh)
    state.node.mass[: mesh.n_node] = np.arange(1.0, mesh.n_node + 1)
    if deform:
        cases.deform(state)
    state.node.force_rows[: mesh.n_node] = 7.0  # of the step before: begun anew
    state.node.force[mesh.n_node :] = np.nan
    loads = LoadSet(mesh, loads)
    loads.begin_forces(state)
    assert np.isnan(state.node.force[mesh.n_node :]).all()
    assert not state.node.director_force[: mesh.n_node].any()
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


def test_pressure_acts_along_the_director_and_on_the_volume():
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1).with_sets(quad_sets={"one": [1]})
    state, _ = loaded(mesh, Pressure(0.5, quads="one"))
    assert state.node.force[:6, 2].tolist() == pytest.approx([0, 0.125, 0.125] * 2, abs=4 * EPS)
    assert not state.node.force[:6, :2].any()
    # On a closed cylinder with flat ends left out the resultant along x and z must vanish, and
    # virtual work of a growing radius is p times the change of volume.
    mesh = cylinder(2.0, 3.0, n_around=24, n_along=3)
    state, _ = loaded(mesh, Pressure(0.1, following=True))
    force = state.node.force[: mesh.n_node]
    assert np.abs(force.sum(axis=0)).max() < 1e-13 * np.abs(force).max() * mesh.n_node
    radial = mesh.directors
    prism = 0.5 * 24 * np.sin(2 * np.pi / 24) * 3.0  # volume / radius²
    assert (force * radial).sum() == pytest.approx(0.1 * prism * 2 * 2.0, rel=1e-13)


@pytest.mark.parametrize("bad", [np.nan, np.inf])
@pytest.mark.parametrize(
    ("given", "said"),
    [
        (lambda f: {"supports": [Support([8], velocity={"x": f})]}, r"along x of supports\[0]"),
        (
            lambda f: {"supports": [Support([8]), Support([0], spin={"z": f})]},
            r"spin along z of supports\[1]",
        ),
        (lambda f: {"loads": [Gravity((0, 0, -9.0), f)]}, r"factor of loads\[0] \(Gravity\)"),
        (lambda f: {"loads": [Pressure(0.1, following=True, factor=f)]}, r"loads\[0] \(Pressure\)"),
        (lambda f: {"loads": [EdgeTraction("left", (1, 0, 0), f)]}, r"loads\[0] \(EdgeTraction\)"),
        (lambda f: {"loads": [NodalForce([3], (1, 0, 0), f)]}, r"loads\[0] \(NodalForce\)"),
        (lambda f: {"loads": [NodalMoment([3], (1, 0, 0), f)]}, r"loads\[0] \(NodalMoment\)"),
    ],
)
def test_a_function_of_time_that_is_not_finite_is_named_with_the_time(given, said, bad):
    mesh = rectangle(2.0, 2.0, n_x=2, n_y=2)
    late = given(lambda time: bad if time > 2e-6 else 1.0)
    sim = Simulation(mesh, ShellMaterial.homogeneous(), **late)
    with pytest.raises(ValueError, match=rf"{said} must be finite, got {bad} at t = 2\.\S+e-06 s$"):
        sim.run(1e-5)


def test_gravity_nodal_force_and_factor():
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    state, loads = loaded(
        mesh, Gravity((0, 0, -2.0)), NodalForce([1, 4], (3.0, 0, 0), lambda t: 1 + 10 * t)
    )
    np.testing.assert_allclose(state.node.force[:6, 2], -2.0 * np.arange(1, 7))
    assert state.node.force[:6, 0].tolist() == [0, 3, 0, 0, 3, 0]
    state.time = 0.1
    state.node.force[:6] = 0.0
    loads.begin_forces(state)
    assert state.node.force[1, 0] == pytest.approx(6.0, rel=2 * EPS)


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


def test_work_is_the_trapezoid_of_force_and_step():
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    state = initial_state(mesh)
    loads = LoadSet(mesh, [NodalForce([2], (3.0, 1.0, 0), lambda t: 1 + t)])
    assert loads.begin_forces(state) == 0.0
    state.dt, state.time = 0.5, 0.5
    state.node.velocity_half[2] = [2.0, -4.0, 7.0]
    # ½ (1 + 1.5) (3 · 2 - 1 · 4) · 0.5
    assert loads.begin_forces(state) == pytest.approx(0.5 * 2.5 * 2.0 * 0.5, rel=4 * EPS)
    assert state.node.force[2].tolist() == [3.0 * 1.5, 1.0 * 1.5, 0.0]


def test_work_of_a_dead_pressure_counts_every_node():
    mesh = cases.skewed_flat(4, 2)  # 15 nodes: eight by lanes, seven one by one
    state = initial_state(mesh)
    loads = LoadSet(mesh, [Pressure(0.3, factor=lambda t: 1 + t)])
    state.dt, state.time = 0.5, 0.5
    velocity = np.random.default_rng(3).uniform(-1, 1, (mesh.n_node, 3))
    state.node.velocity_half[: mesh.n_node] = velocity
    dead = by_quadrature(mesh.nodes, mesh.quads, 0.3)
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
        state.node.force[:n] = 0.0
        loads.begin_forces(state)
        wanted = by_quadrature(mesh.nodes[state.node.origin[:n]], state.quads, 0.3)
        np.testing.assert_allclose(
            state.node.force[:n], wanted, rtol=0, atol=1e-13 * np.abs(wanted).max()
        )


@pytest.mark.parametrize("following", [False, True])
def test_corner_forces_add_up_to_the_load_on_the_node(following):
    mesh = cases.warped()
    loads = LoadSet(
        mesh,
        [
            Pressure(0.2, following=following, factor=lambda t: 1 + t),
            EdgeTraction("bottom", (0.1, 0.2, 0.3)),
        ],
    )
    state = initial_state(mesh)
    cases.deform(state)
    state.time = 0.5
    loads.begin_forces(state)
    for node in (5, 1):  # inside, and on the loaded side
        around = state.node.quads[node, : state.node.n_quad_at[node]]
        parts = corner_forces(loads, state, node, around)
        np.testing.assert_allclose(parts.sum(axis=0), state.node.force[node], atol=1e-15)
        back = corner_forces(loads, state, node, around[::-1])
        np.testing.assert_array_equal(back, parts[::-1])


def corner_forces(loads, state, node, quads):
    force = np.zeros((quads.size, 3))
    loads.add_corner_forces(state, quads, np.full(quads.size, node), force)
    return force


def test_gravity_and_other_quads_are_left_out_of_the_corner_forces():
    # It accelerates both halves alike: F_c would not see it, m1 f2 - m2 f1 = 0.
    mesh = cases.warped()
    loads = LoadSet(mesh, [Gravity((0, 0, -1e4))])
    state = initial_state(mesh)
    assert not corner_forces(loads, state, 5, np.arange(4)).any()
    mesh = cases.skewed_flat(4, 3).with_sets(quad_sets={"some": [9, 7, 1]})
    loads = LoadSet(mesh, [Pressure(0.2, quads="some"), Pressure(0.1, True, quads="some")])
    state = initial_state(mesh)
    quads = np.array([7, 2, 5, 1])
    nodes = state.quads[quads, 1]
    force = np.zeros((4, 3))
    loads.add_corner_forces(state, quads, nodes, force)
    assert force.any(axis=1).tolist() == [True, False, False, True]


# --- supports: which components are held, prescribed velocities, refusals


MESH = rectangle(2.0, 1.0, n_x=2, n_y=1)


def masks(*supports):
    state = initial_state(MESH)
    SupportSet(MESH, supports).initialise(state)
    assert (state.node.supported == state.node.support.any(axis=1)).all()
    return {int(n): state.node.support[n].astype(int).tolist() for n in
            np.flatnonzero(state.node.supported)}  # fmt: skip


def test_kinds_of_support():
    assert masks(Support.clamped([1])) == {1: [1] * 6}
    assert masks(Support.pinned([1])) == {1: [1, 1, 1, 0, 0, 0]}
    # In the plane x = 0 the director may not leave the plane: no spin about y and z.
    assert masks(Support.symmetry([1], "x")) == {1: [1, 0, 0, 0, 1, 1]}
    assert masks(Support("left", "z", "")) == {0: [0, 0, 1, 0, 0, 0], 3: [0, 0, 1, 0, 0, 0]}


def test_supports_of_one_node_add_up():
    both = masks(Support([0], "x", ""), Support([0], "y", "x"))
    assert both == {0: [1, 1, 0, 1, 0, 0]}


def test_spins_are_held_as_the_director_takes_them():
    # Of a plane film a spin about z moves no director; with x and y held z alone would be left.
    assert masks(Support([0], "", "z")) == {}
    assert masks(Support([0], "", "xy")) == {0: [0, 0, 0, 1, 1, 1]}
    assert masks(Support([0], "", "xz")) == {0: [0, 0, 0, 1, 0, 1]}
    # A prescribed spin is taken at its word.
    assert masks(Support([0], "", "z", spin={"z": np.cos})) == {0: [0, 0, 0, 0, 0, 1]}


def test_prescribed_velocity_is_written_at_the_half_step():
    state = initial_state(MESH)
    moving = Support("right", velocity={"x": lambda t: 3.0 * t, "z": np.cos})
    supports = SupportSet(MESH, [Support.clamped("left"), moving])
    supports.initialise(state)
    supports.prescribe(state, 1.0, 1.0)
    for node in MESH.node_set("right"):
        assert state.node.support_rate[node].tolist() == [1.5, 0.0, np.cos(0.5), 0, 0, 0]
    assert not state.node.support_rate[MESH.node_set("left")].any()


def test_reaction_is_the_sum_over_one_support():
    state = initial_state(MESH)
    supports = SupportSet(MESH, [Support.clamped("left"), Support.clamped("right")])
    state.node.reaction[: MESH.n_node] = np.arange(36.0).reshape(6, 6)
    assert supports.reaction(state, 1).tolist() == [12 + 30, 13 + 31, 14 + 32]


def test_nodes_by_name_or_ids():
    assert choose_nodes(MESH, "left").tolist() == [0, 3]
    assert choose_nodes(MESH, (1, 2)).dtype == np.int64


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
    mesh = rectangle(2.0, 1.0, n_x=2, n_y=1)
    sim = Simulation(
        mesh,
        ShellMaterial.homogeneous(),
        supports=[Support("left"), Support("right", spin={"y": lambda time: 1e4})],
    )
    sim.run(until=2e-5)
    turned = sim.state.node.t[mesh.node_set("right")]
    # t = (sin wt, 0, cos wt) about +y; Cayley steps err by (w dt)²/12, here 3e-6.
    angle = 1e4 * sim.state.time
    np.testing.assert_allclose(turned[:, 0], np.sin(angle), rtol=1e-5)
    # What turns it has done work on the film.
    assert sim.ledger.support_work > 0
    assert abs(sim.ledger.imbalance) < 1e-2 * sim.ledger.support_work
