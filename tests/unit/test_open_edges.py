"""Rims, flanks of cracks along sides, and where these end."""

import numpy as np

from naive import cases
from shellcut.fracture.open_edges import boundary_edges, crack_edges, crack_tips
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state

# Six by four squares; node j * 7 + i is the i-th of row j.
MESH = rectangle(6.0, 4.0, n_x=6, n_y=4)


def flanks(state):
    return crack_edges(state.quads, state.node.origin[: state.n_node])


def test_whole_sheet_has_no_tip_and_no_open_edge():
    state = initial_state(cases.warped(5, 4))
    assert crack_tips(state) == {}
    assert not flanks(state).size


def test_boundary_edges_run_around_the_sheet():
    edges = boundary_edges(initial_state(MESH))
    assert len(edges) == 20
    for i, j in edges:
        # In the direction of their quad: the sheet lies to the left.
        along = MESH.nodes[j] - MESH.nodes[i]
        inward = np.cross([0, 0, 1], along)
        middle = 0.5 * (MESH.nodes[i] + MESH.nodes[j]) - [3, 0, 0]
        assert inward @ middle < 0


def test_a_notch_has_one_tip():
    mesh = MESH.cut([14, 15, 16, 17])
    state = initial_state(mesh)
    ((node, far),) = crack_tips(state).items()
    assert (node, state.node.origin[far]) == (17, 16)


def test_open_edges_pair_the_flanks():
    mesh = MESH.cut([14, 15, 16, 17])
    state = initial_state(mesh)
    copies = flanks(state)
    edges = state.node.origin[copies]
    np.testing.assert_array_equal(edges[:, 0], [[14, 15], [15, 16], [16, 17]])
    np.testing.assert_array_equal(edges[:, 1], edges[:, 0])
    assert (copies[:, 0] != copies[:, 1]).any(axis=1).all()
    assert (copies[-1, :, 1] == 17).all()


def test_at_a_bridge_one_of_the_cracks_that_arrive_is_told():
    # Cracks from both sides have met at node 17, which alone still holds.
    state = cases.welded(initial_state(MESH.cut(list(range(14, 21)))), 17)
    ((node, far),) = crack_tips(state).items()
    assert node == 17
    assert state.node.origin[far] in (16, 18)
    assert (flanks(state) == 17).any(axis=2).all(axis=1).sum() == 2
