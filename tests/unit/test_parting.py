"""Ways to part the quads of a node: complete, and weighed as the parts add up."""

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
    table = PartingTable(shell, loads, STRENGTH, ways, weigh_partings)
    largest = table.weigh(state)
    assert table.start == [0, 1, 7, 13, 19]
    assert table.owner == [0, *[1] * 6, *[2] * 6, *[3] * 6]
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


def test_turn_of_a_crack_and_the_least_turn_where_all_exceed_the_limit():
    shell, state = cases.set_up(sheet().cut(ROW))
    ways = partings_of(state, 17, shell.mass, NONE)
    table = PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], weigh_partings)
    table.weigh(state)
    ahead = [way.ahead[0] for way in table.ways]
    straight = [ahead.index(18)]
    assert table.admissible(0, np.cos(np.radians(57.0))) == straight
    assert len(table.admissible(0, np.cos(np.radians(91.0)))) == 3
    nodes = sheet().nodes.copy()
    nodes[:, 1] += 2.6 * np.maximum(nodes[:, 0] - 3.0, 0.0)  # now it turns by 69 degrees
    _, state = cases.set_up(cases.moved_mesh(sheet(), nodes).cut(ROW))
    ways = partings_of(state, 17, shell.mass, NONE)
    table = PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], weigh_partings)
    assert table.admissible(0, np.cos(np.radians(57.0))) == straight
    assert table.admissible(0, np.cos(np.radians(80.0))) == straight


def test_to_go_on_across_a_fold_is_no_turn():
    # Film that a blade drags along stands up behind the tip: the crack comes from above.
    shell, state = cases.set_up(sheet().cut(ROW))
    x = state.node.x[: state.n_node]
    behind = state.node.X[: state.n_node, 0] < 2.5
    x[behind] = np.stack([3.0 + 0.0 * x[:, 0], x[:, 1], 3.0 - x[:, 0]], axis=1)[behind]
    ways = partings_of(state, 17, shell.mass, NONE)
    table = PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], weigh_partings)
    table.weigh(state)
    (straight,) = table.admissible(0, np.cos(np.radians(57.0)))
    assert table.ways[straight].ahead == (18,)


def test_free_edges_have_nothing_to_hold_them():
    shell, state = cases.set_up(sheet())
    ways = partings_of(state, 3, shell.mass, frozenset({(3, 10)}))
    (way,) = ways
    assert way.length == 0.0
    table = PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], weigh_partings)
    for stretch, measure in ((1.01, np.inf), (0.99, -np.inf)):
        state.node.x[: sheet().n_node, 0] = stretch * sheet().nodes[:, 0]
        assert table.weigh(state) == measure


def split_sheet():
    """A sheet whose node 17 has been split along its row, its two cables under force."""
    shell, state = cases.set_up(sheet())
    ways = partings_of(state, 17, shell.mass, NONE)
    table = PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], weigh_partings)
    table.weigh(state)
    k = next(k for k, o in enumerate(ways) if {*o.back, *o.ahead} == {16, 18})
    cracks = cases.edge_cracks(sheet(), shell, state, CohesiveLaw())
    cracks.split(state, split_of(ways[k], table, k))
    pull = np.array([[7.0, 14.0, 21.0], [-7.0, -14.0, -21.0]])
    state.cable.force[:2] = pull, 2.0 * pull
    return shell, state, ways[k]


def test_cables_pull_on_their_side_until_they_break():
    shell, state, _ = split_sheet()
    ways = partings_of(state, 17, shell.mass, NONE)
    table = PartingTable(shell, LoadSet(sheet(), []), STRENGTH, [ways], weigh_partings)
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
