"""Ways to part the quads of a node: complete, and weighed as the parts add up."""

import itertools

import numpy as np
import pytest

from naive import cases
from naive import topology as naive
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.candidate_splits import PartingTable, partings_of, weigh_partings
from shellcut.fracture.criterion import Split
from shellcut.loads.loads import EdgeTraction, LoadSet, Pressure
from shellcut.mesh.structured import rectangle

ROW = [14, 15, 16, 17]  # of six by four squares; node j * 7 + i is the i-th of row j
NONE = frozenset()
STRENGTH = 18.0
ANY_TURN = -1.0  # cosine


def sheet():
    return rectangle(6.0, 4.0, n_x=6, n_y=4)


def split_of(way, table, k):
    return Split(way.node, way.minus, way.plus, table.m[k], 1.0, table.force[k], False)


def test_partings_are_all_ways_to_part_the_quads():
    shell, state = cases.set_up(sheet().cut(ROW))
    mass = shell.mass
    # Interior: any two of four edges; tip: any of the three inner edges; boundary: one edge; a
    # corner has nothing to part.
    for node, count in ((24, 6), (17, 3), (3, 1), (0, 0)):
        ways = partings_of(state, node, mass, NONE)
        assert len(ways) == count
        for way in ways:
            groups = naive.parted(state, node, [*way.back, *way.ahead])
            assert sorted([tuple(sorted(way.minus)), tuple(sorted(way.plus))]) == groups
            # Edges of 1 mm; of the tip's, the one of the notch has no cable.
            assert way.length == 0.5 * len({*way.back, *way.ahead} - {16})
            assert sum(way.mass) == pytest.approx(state.node.mass[node], rel=1e-14)
            assert way.cables == ()


@pytest.mark.parametrize("loaded", [False, True])
def test_force_is_that_of_the_two_sides(loaded):
    # On a warped film in any state: F_c, m, direction and chord from their definitions in NumPy.
    mesh = cases.warped(5, 4)
    shell, state = cases.set_up(mesh, damping_beta=2e-6)
    cases.forces_of(shell, state)
    cases.deform(state)
    state.dt = 1e-5
    loads = LoadSet(
        mesh, [Pressure(0.2), EdgeTraction("bottom", (0.1, 0.2, 0.3))] if loaded else []
    )
    nodes = [1, 8, 14, 15]
    ways = [partings_of(state, n, shell.mass, NONE) for n in nodes]
    table = PartingTable(shell, loads, STRENGTH, ways, ANY_TURN, weigh_partings)
    largest = table.weigh(state)
    bounds = [0, 1, 7, 13, 19]
    assert table.admissible == [[*range(*ends)] for ends in itertools.pairwise(bounds)]
    assert [way.node for way in table.ways] == np.repeat(nodes, np.diff(bounds)).tolist()
    assert largest == table.measure.max()
    for k, way in enumerate(table.ways):
        sides = []
        for quads in (way.minus, way.plus):
            e, at = np.array(quads), np.full(len(quads), way.node)
            force = shell.corner_forces(state, e, at)
            loads.add_corner_forces(state, e, at, force)
            sides.append(force.sum(axis=0))
        m1, m2 = way.mass
        wanted = (m1 * sides[1] - m2 * sides[0]) / (m1 + m2)
        # Round-off of sums of a few forces.
        np.testing.assert_allclose(table.force[k], wanted, atol=1e-14 * np.abs(sides).max())
        x, t = state.node.x, state.node.t[way.node]
        start = x[way.back[0]] if way.back else x[way.node]
        chord = x[way.ahead[0]] - start
        assert table.chord[k] == pytest.approx(np.linalg.norm(chord), rel=1e-13)
        e = chord - (chord @ t) * t
        e /= np.linalg.norm(e)
        np.testing.assert_allclose(table.direction[k], e, atol=1e-13)
        m = np.cross(t, e)
        np.testing.assert_allclose(table.m[k], m / np.linalg.norm(m), atol=1e-13)
        assert table.pull[k] == pytest.approx(table.force[k] @ table.m[k], rel=1e-13)
        carried = STRENGTH * cases.FILM.thickness * way.length
        assert table.measure[k] == pytest.approx(table.pull[k] / carried, rel=1e-13)


def table_of(shell, state, node, turn=57.0, free_edges=NONE):
    """The partings of a node of the sheet, not weighed; turn : the largest one [degrees]."""
    ways = partings_of(state, node, shell.mass, free_edges)
    limit = float(np.cos(np.radians(turn)))
    return PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], limit, weigh_partings)


def test_turn_of_a_crack_and_the_least_turn_where_all_exceed_the_limit():
    shell, state = cases.set_up(sheet().cut(ROW))
    ahead = [way.ahead[0] for way in table_of(shell, state, 17).ways]
    straight = [ahead.index(18)]
    assert table_of(shell, state, 17, 57.0).admissible == [straight]
    assert table_of(shell, state, 17, 91.0).admissible == [[0, 1, 2]]
    nodes = sheet().nodes.copy()
    nodes[:, 1] += 2.6 * np.maximum(nodes[:, 0] - 3.0, 0.0)  # now it turns by 69 degrees
    _, state = cases.set_up(cases.moved_mesh(sheet(), nodes).cut(ROW))
    assert table_of(shell, state, 17, 57.0).admissible == [straight]
    assert table_of(shell, state, 17, 80.0).admissible == [straight]


def test_a_parting_that_turns_too_far_makes_nothing_due():
    # Pulled along the notch: the measures of the ways to the sides are the largest.
    shell, state = cases.set_up(sheet().cut(ROW))
    state.node.x[: state.n_node, :2] *= 1.5, 0.7  # it grows narrow
    narrow, wide = (table_of(shell, state, 17, turn) for turn in (57.0, 91.0))
    straight, every = narrow.admissible[0], wide.admissible[0]
    assert wide.weigh(state) == wide.measure[every].max() >= 1.0
    assert wide.nodes_due() == [0]
    assert narrow.weigh(state) == narrow.measure[straight].max() < 1.0
    assert narrow.nodes_due() == []
    np.testing.assert_array_equal(narrow.measure, wide.measure)


def test_to_go_on_across_a_fold_is_no_turn():
    # Film that a blade drags along stands up behind the tip: the crack comes from above.
    shell, state = cases.set_up(sheet().cut(ROW))
    x = state.node.x[: state.n_node]
    behind = state.node.X[: state.n_node, 0] < 2.5
    x[behind] = np.stack([3.0 + 0.0 * x[:, 0], x[:, 1], 3.0 - x[:, 0]], axis=1)[behind]
    table = table_of(shell, state, 17)
    table.weigh(state)
    ((straight,),) = table.admissible
    assert table.ways[straight].ahead == (18,)


def test_free_edges_have_nothing_to_hold_them():
    shell, state = cases.set_up(sheet())
    table = table_of(shell, state, 3, free_edges=frozenset({(3, 10)}))
    (way,) = table.ways
    assert way.length == 0.0
    for stretch, measure in ((1.01, np.inf), (0.99, -np.inf)):
        state.node.x[: sheet().n_node, 0] = stretch * sheet().nodes[:, 0]
        assert table.weigh(state) == measure


def split_sheet():
    """A sheet whose node 17 has been split along its row, its two cables under force."""
    shell, state = cases.set_up(sheet())
    table = table_of(shell, state, 17)
    table.weigh(state)
    ways = table.ways
    k = next(k for k, o in enumerate(ways) if {*o.back, *o.ahead} == {16, 18})
    cracks = cases.edge_cracks(sheet(), shell, state, CohesiveLaw())
    cracks.split(state, split_of(ways[k], table, k))
    pull = np.array([[7.0, 14.0, 21.0], [-7.0, -14.0, -21.0]])
    state.cable.force[:2] = pull, 2.0 * pull
    return shell, state, ways[k]


def test_cables_pull_on_their_side_until_they_break():
    shell, state, _ = split_sheet()
    table = table_of(shell, state, 17)
    (way,) = table.ways  # the flank's one edge: two quads, one on either side of it
    table.weigh(state)
    # Each of the two cables holds the flank of one of them.
    assert sorted(side for side, *_ in way.cables) == [0, 1]
    assert sorted(cable for _, cable, _ in way.cables) == [0, 1]
    pull = [state.cable.force[cable, end] for _, cable, end in sorted(way.cables)]
    for side, cable, end in way.cables:
        assert state.cable.row[cable, end] in (way.minus, way.plus)[side]
    m1, m2 = way.mass
    np.testing.assert_allclose(
        table.force[0], (m1 * pull[1] - m2 * pull[0]) / (m1 + m2), rtol=1e-14
    )
    state.cable.status[:2] = 2  # broken: nothing left
    table.weigh(state)
    assert not table.force.any()
