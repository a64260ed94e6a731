"""Supports: which components are held, prescribed velocities, refusals."""

import numpy as np
import pytest

from shellcut import ShellMaterial, Simulation, Support
from shellcut.loads.supports import SupportSet, choose_nodes
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state

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
