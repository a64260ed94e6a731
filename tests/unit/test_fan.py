"""Fans in order, cracks that arrive, tips and open edges."""

import numpy as np

from naive import cases
from naive import topology as naive
from shellcut.fracture.quad_fans import (
    arriving,
    boundary_edges,
    crack_tips,
    fans_of,
    is_tip,
    open_edge_copies,
)
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state

# Six by four squares; node j * 7 + i is the i-th of row j.
MESH = rectangle(6.0, 4.0, n_x=6, n_y=4)


def test_fans_go_around_counter_clockwise():
    mesh = cases.warped(5, 4)
    state = initial_state(mesh)
    boundary = set(mesh.boundary_nodes().tolist())
    for node in range(mesh.n_node):
        (fan,) = fans_of(state, node)
        assert fan.closed == (node not in boundary)
        assert len(fan.far) == len(fan.quads) + (not fan.closed)
        assert sorted(fan.quads) == [e for e in range(mesh.n_quad) if node in mesh.quads[e]]
        for k, e in enumerate(fan.quads):
            first, second = fan.far[k], fan.far[(k + 1) % len(fan.far)]
            assert {node, first, second} <= set(mesh.quads[e].tolist())
            p, q = mesh.nodes[first] - mesh.nodes[node], mesh.nodes[second] - mesh.nodes[node]
            assert np.cross(p, q) @ mesh.directors[node] > 0


def test_whole_sheet_has_no_tip_and_no_open_edge():
    state = initial_state(cases.warped(5, 4))
    assert crack_tips(state) == []
    assert not open_edge_copies(state).size
    for node in range(state.n_node):
        assert arriving(state, fans_of(state, node)) == []


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
    assert crack_tips(state) == [17]
    (fan,) = fans_of(state, 17)
    assert not fan.closed
    assert len(fan.quads) == 4
    (pair,) = arriving(state, [fan])
    assert {int(state.node.origin[n]) for n in pair} == {16}
    # The fan ends at the first of the pair: seen along the crack, from its left flank.
    assert mesh.quads[fan.quads[-1]].tolist().count(pair[0]) == 1
    # Flank nodes: one open fan of two quads, no tip.
    for node in (*pair, *np.flatnonzero(mesh.origin == 15)):
        (flank,) = fans_of(state, int(node))
        assert (len(flank.quads), flank.closed, is_tip(state, int(node))) == (2, False, False)


def test_open_edges_pair_the_flanks():
    mesh = MESH.cut([14, 15, 16, 17])
    state = initial_state(mesh)
    copies = open_edge_copies(state)
    edges = state.node.origin[copies]
    np.testing.assert_array_equal(edges[:, 0], [[14, 15], [15, 16], [16, 17]])
    np.testing.assert_array_equal(edges[:, 1], edges[:, 0])
    assert (copies[:, 0] != copies[:, 1]).any(axis=1).all()
    assert (copies[-1, :, 1] == 17).all()


def test_a_bridge_has_two_fans_and_both_cracks_arrive():
    # Cracks from both sides have met at node 17, which alone still holds.
    state = cases.welded(initial_state(MESH.cut(list(range(14, 21)))), 17)
    fans = fans_of(state, 17)
    assert [len(f.quads) for f in fans] == [2, 2]
    assert min(fans[0].quads) < min(fans[1].quads)
    pairs = arriving(state, fans)
    assert len(pairs) == 2
    assert sorted(int(state.node.origin[p[0]]) for p in pairs) == [16, 18]
    for before, after in pairs:
        assert state.node.origin[before] == state.node.origin[after]
        # The first ends a fan, the second begins the next.
        assert any(f.far[-1] == before for f in fans)
        assert any(f.far[0] == after for f in fans)
    assert crack_tips(state) == [17]


def test_fans_agree_with_a_flood_over_shared_edges():
    state = initial_state(MESH.cut(list(range(14, 21))).cut([3, 10]))
    state = cases.welded(state, 17)
    for node in range(state.n_node):
        groups = sorted(tuple(sorted(f.quads)) for f in fans_of(state, node))
        assert groups == naive.parted(state, node, [])
