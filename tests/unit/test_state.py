"""Tables that grow, and the state of a mesh at rest."""

from dataclasses import fields

import numpy as np

from naive import cases
from shellcut import StraightMotion, Support
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state, quads_of_nodes
from shellcut.models import free_cut
from shellcut.tool.shapes import straight_blade


def test_rows_are_appended_and_the_old_ones_survive_growth():
    state = initial_state(rectangle(1.0, 1.0, n_x=1, n_y=1))
    node = state.node
    capacity = len(node.x)
    node.x[3], node.origin[3], node.support[3, 4], node.contact_side[3] = (1, 2, 3), 7, True, -1
    for k in range(capacity):  # far past the reserve
        assert node.append_copy(3) == 4 + k
    assert node.count == 4 + capacity
    assert len(node.x) >= node.count
    for row in (3, 4, node.count - 1):
        assert node.x[row].tolist() == [1, 2, 3]
        assert node.origin[row] == 7
        assert node.support[row].tolist() == [False] * 4 + [True, False]
        assert node.contact_side[row] == -1
    lengths = {len(getattr(node, f.name)) for f in fields(node) if f.name != "count"}
    assert len(lengths) == 1
    for f in fields(node):
        if f.name != "count":
            array = getattr(node, f.name)
            assert array.flags.c_contiguous or array.flags.f_contiguous
            assert array.dtype in (np.float64, np.int64, np.int32, np.bool_, np.int8)
    # What the kernels read by lanes still stands one column after the other.
    for array in (node.x, node.t, node.velocity_half, node.spin_half, node.push):
        assert array.flags.f_contiguous


def test_initial_state_is_the_mesh_at_rest():
    mesh = rectangle(3.0, 2.0, n_x=3, n_y=2)
    mesh = mesh.cut([4, 5])  # a notch at the left: node 4 has a twin, node 12
    state = initial_state(mesh)
    n = state.n_node
    assert n == mesh.n_node == 13
    np.testing.assert_array_equal(state.node.x[:n], mesh.nodes)
    np.testing.assert_array_equal(state.node.t[:n], mesh.directors)
    assert np.flatnonzero(state.node.halved).tolist() == [4, 12]
    assert state.node.origin[12] == 4
    assert not state.node.velocity_half.any()
    state.node.x[0] = 99.0  # no view of the frozen mesh, nor of the reference
    state.quads[0, 0] = 7
    assert mesh.nodes[0, 0] == 0.0
    assert state.node.X[0, 0] == 0.0
    assert mesh.quads[0, 0] == 0
    assert (state.time, state.step, state.revision, state.crack_length) == (0.0, 0, 0, 0.0)
    assert state.n_cable == 0


def test_quads_of_nodes_by_brute_force():
    quads = cases.warped(4, 3).quads
    table, count = quads_of_nodes(quads, 25)
    for node in range(25):
        mine = [e for e in range(len(quads)) if node in quads[e]]
        assert table[node, : count[node]].tolist() == mine
        assert not table[node, count[node] :].any()


def test_a_film_of_one_quad_is_cut():
    """A table of one row, which NumPy takes for one stored by column, grows as any."""
    case = free_cut(
        rectangle(1.0, 1.0, size=1.0),
        tool=straight_blade(),
        motion=StraightMotion((1.0, 0.0, 0.0), speed=6000.0),
        duration=2.5e-4,
        supports=[Support.clamped("bottom"), Support.clamped("top")],
    )
    case.simulation.run(case.duration)
    assert case.simulation.state.n_quad > 1
    assert case.simulation.state.crack_length > 0.0
