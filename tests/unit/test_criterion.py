"""Which node splits, along which edges: nodal force, stress, turn limit, blade-cut rule."""

import numpy as np
import pytest

from naive import cases
from naive.topology import half_edges
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.fracture.criterion import Fracture, SplitCriterion
from shellcut.fracture.quad_fans import boundary_edges, crack_tips, open_edges
from shellcut.loads.loads import LoadSet, Pressure
from shellcut.mesh.structured import rectangle
from shellcut.tool.pose import Pose
from shellcut.tool.shapes import straight_blade

H = 0.074
STRENGTH = 18.0
BLADE = straight_blade()
STEP = 0.05
ROW = [14, 15, 16, 17]  # of six by four squares; node j * 7 + i is the i-th of row j


def sheet():
    return rectangle(6.0, 4.0, n_x=6, n_y=4)


def pulled(mesh, strain, loads=(), tool=None, **fracture):
    """A film under the homogeneous strain, with its criterion."""
    shell, state = cases.set_up(mesh)
    F = np.eye(3)
    F[:2, :2] += strain
    state.node.x[: mesh.n_node] = mesh.nodes @ F.T
    criterion = SplitCriterion(
        Fracture(**fracture),
        STRENGTH,
        shell,
        LoadSet(mesh, loads),
        tool,
        frozenset(open_edges(state)),
        np.zeros(0, np.int64),
    )
    E = 0.5 * (F.T @ F - np.eye(3))[:2, :2]
    s = cases.FILM.layers[0].material.plane_stress() @ [E[0, 0], E[1, 1], 2 * E[0, 1]]
    S = np.zeros((3, 3))
    S[:2, :2] = [[s[0], s[2]], [s[2], s[1]]]
    return shell, state, criterion, F @ S


def due(criterion, state, tips=None, pose=None):
    far_off = Pose(np.eye(3), np.full(3, 1e3))
    tips = crack_tips(state) if tips is None else tips
    return criterion.due(state, tips, pose or far_off)


@pytest.mark.parametrize("skewed", [False, True])
def test_force_between_the_halves_is_the_traction_on_the_opened_edges(skewed):
    mesh = cases.skewed_flat(6, 4, seed=5, amount=0.12) if skewed else sheet()
    _, state, criterion, P = pulled(mesh, np.array([[0.001, 0.0], [0.0, 0.02]]))
    found = due(criterion, state, range(mesh.n_node))
    inner = [s for s in found if s.node not in mesh.boundary_nodes()]
    assert inner
    for split in inner:
        # Closed form: first Piola-Kirchhoff traction on half of each opened edge, as a polygon.
        halves = half_edges(mesh, state, split)
        fars = [far for far, _ in halves]
        assert len(fars) == 2
        ends = mesh.nodes[fars]
        across = ends[1] - ends[0]
        normal = np.array([across[1], -across[0], 0.0])
        normal *= np.sign(normal @ split.m)
        wanted = P @ normal * 0.5 * H
        np.testing.assert_allclose(split.force, wanted, rtol=0, atol=1e-11 * np.abs(wanted).max())
        area = H * sum(half for _, half in halves)
        assert split.measure == pytest.approx(wanted @ split.m / (STRENGTH * area), rel=1e-11)
        # m is the unit normal in the sheet, from minus to plus.
        assert np.linalg.norm(split.m) == pytest.approx(1.0, rel=1e-14)
        assert split.m[2] == 0.0
        centre = [state.node.x[state.quads[list(g)]].mean(axis=(0, 1))
                  for g in (split.minus, split.plus)]  # fmt: skip
        assert (centre[1] - centre[0]) @ split.m > 0
        assert split.measure >= 1.0
        assert not split.blade


def test_straight_split_of_a_pulled_strip_carries_sigma_h_edge():
    mesh = sheet().cut(ROW)
    _, state, criterion, P = pulled(mesh, np.diag([0.0, 0.03]))
    (split,) = due(criterion, state)
    assert split.node == 17
    assert half_edges(mesh, state, split) == [(18, 0.5)]  # the notch itself carries no cable
    # The tip's two quads ahead and two behind: the traction of half the edge ahead, P h / 2, and
    # of half the edge behind, where the flanks of this homogeneous state still pull.
    assert abs(split.force @ split.m) == pytest.approx(P[1, 1] * H * 1.0, rel=1e-11)
    assert split.measure == pytest.approx(P[1, 1] * 1.0 / (STRENGTH * 0.5), rel=1e-11)


@pytest.mark.parametrize(("factor", "expected"), [(0.98, 0), (1.02, 1)])
def test_due_at_the_strength(factor, expected):
    # The measure of the notch tip is twice P / sigma_F, see above.
    strain = factor * 0.5 * STRENGTH / (1678.0 / 0.91)
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.diag([0.0, strain]))
    assert len(due(criterion, state)) == expected


def test_common_acceleration_pulls_nothing_apart():
    # Dead pressure on an unstrained skewed film: every part moves alike, so F_c = 0 although the
    # two sides' forces and masses differ. Without the masses it would be half their difference.
    mesh = cases.skewed_flat(6, 4, seed=5, amount=0.2)
    shell, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), [Pressure(0.1)])
    table, _ = criterion._weighed(state, [16, 17, 24])
    for way, force in zip(table.ways, table.force, strict=True):
        minus = np.array(way.minus)
        one = np.zeros((minus.size, 3))
        at = np.full(minus.size, way.node)
        LoadSet(mesh, [Pressure(0.1)]).add_corner_forces(state, minus, at, one)
        total = np.abs(one.sum(axis=0)).max()
        assert total > 0.01
        assert np.abs(force).max() < 1e-13 * total * 10
    assert not np.isnan(table.measure).any()
    assert shell.damping_beta == 0.0


@pytest.mark.parametrize(("limit", "node"), [(57.0, None), (80.0, None), (100.0, 17)])
def test_turn_limit(limit, node):
    # Pulled along the notch: the crack would have to turn by 90°.
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.diag([0.05, -0.015]), turn_limit_deg=limit)
    found = due(criterion, state)
    assert [s.node for s in found] == ([] if node is None else [node])
    if found:
        assert half_edges(mesh, state, found[0])[0][0] in (10, 24)


def test_turn_is_measured_from_the_arriving_crack():
    mesh = sheet().cut(ROW)
    for limit, count in ((57.0, 1), (91.0, 3)):
        _, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), turn_limit_deg=limit)
        table, _ = criterion._weighed(state, [17])
        ways = [table.ways[k] for k in table.admissible[0]]
        assert len(ways) == count
        assert (18,) in [way.ahead for way in ways]


@pytest.mark.parametrize("criterion_name", ["force", "stress"])
def test_strongest_first_and_no_two_share_a_quad(criterion_name):
    mesh = rectangle(10.0, 8.0, n_x=10, n_y=8)
    _, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), criterion=criterion_name)
    # The strain grows towards the middle of the right half.
    x, y, _ = mesh.nodes.T
    state.node.x[: mesh.n_node, 1] = y * (1.0 + 0.02 * np.exp(-((x - 6.0) ** 2) / 8.0))
    found = due(criterion, state, range(mesh.n_node))
    assert len(found) >= 2
    measures = [s.measure for s in found]
    assert measures == sorted(measures, reverse=True)
    assert min(measures) >= 1.0
    used = [e for s in found for e in (*s.minus, *s.plus)]
    assert len(used) == len(set(used))
    if criterion_name == "force":
        everything = criterion._by_force(state, list(range(mesh.n_node)), [])
        assert found[0].measure == max(s.measure for s in everything)
        # Any node that was left out shares a quad with a stronger one.
        for split in everything:
            rivals = [s for s in found if {*s.minus, *s.plus} & {*split.minus, *split.plus}]
            assert max(s.measure for s in rivals) >= split.measure


def test_stress_criterion_reads_the_recovered_stress():
    mesh = sheet().cut(ROW)
    shell, state, criterion, _ = pulled(mesh, np.diag([0.0, 0.012]), criterion="stress")
    (split,) = due(criterion, state)
    sigma = shell.stress(state, np.array([0]))[0, 1, 1]
    assert split.measure == pytest.approx(sigma / STRENGTH, rel=1e-9)
    assert half_edges(mesh, state, split) == [(18, 0.5)]
    _, state, criterion, _ = pulled(mesh, np.diag([0.0, 0.009]), criterion="stress")
    assert due(criterion, state) == []


@pytest.mark.parametrize("criterion_name", ["force", "stress"])
def test_supported_nodes_never_split(criterion_name):
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.diag([0.0, 0.05]), criterion=criterion_name)
    assert due(criterion, state)
    state.node.supported[: mesh.n_node] = True
    assert due(criterion, state) == []


def test_options_are_forgotten_when_the_topology_changes():
    mesh = sheet().cut(ROW)
    shell, state, criterion, _ = pulled(mesh, np.diag([0.0, 0.05]))
    (split,) = due(criterion, state)
    cases.edge_cracks(mesh, shell, state, CohesiveLaw()).split(state, split)
    (split,) = due(criterion, state)
    assert split.node == 18
    assert [far for far, _ in half_edges(mesh, state, split)] == [17, 19]  # arriving and leaving


# --- the blade-cut rule ------------------------------------------------------------------------


def at(x, y=0.0):
    """Pose of the blade with its edge at a place; it moves along +x, and y is lateral."""
    return Pose(np.eye(3), np.array([x, y, 0.0]))


@pytest.mark.parametrize(
    ("edge", "expected"),
    [
        ((3.01, 0.0), [17]),  # just pierced
        ((2.99, 0.0), []),  # not reached
        ((3.01, 0.29), [17]),  # within 0.3 of the edge length, beside
        ((3.01, -0.29), [17]),
        ((3.01, 0.31), []),  # beyond
        ((3.29, 0.0), [17]),  # the edge is 0.3 of the edge length past the node
        ((3.31, 0.0), []),  # farther: it came beside the mid-plane behind the edge, uncut
    ],
)
def test_pierced_node_splits_along_the_trace_whatever_the_stress(edge, expected):
    # The blade stands over a sheet that nothing pulls; behind its edge the film is one more node.
    mesh = sheet()
    _, state, criterion, _ = pulled(mesh, np.diag([0.0, -0.01]), tool=BLADE)
    state.node.supported[[14, 15, 16]] = True  # whatever the blade has passed is none of the test
    state.node.supported[[21, 22, 23, 7, 8, 9]] = True
    state.node.x[: mesh.n_node] = mesh.nodes
    found = due(criterion, state, pose=at(*edge))
    assert [s.node for s in found] == expected
    for split in found:
        assert split.blade
        assert [far for far, _ in half_edges(mesh, state, split)] == [16, 18]
        assert abs(split.m[1]) == pytest.approx(1.0)
    _, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), tool=BLADE, blade_cut=False)
    assert due(criterion, state, pose=at(3.01, 0.0)) == []


@pytest.mark.parametrize(
    ("edge", "expected"), [((3.2, 0.45), [17]), ((3.2, 0.55), []), ((2.9, 0.0), [])]
)
def test_passed_tip_splits_within_half_an_edge(edge, expected):
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), tool=BLADE)
    found = due(criterion, state, pose=at(*edge))
    assert [s.node for s in found] == expected
    for split in found:
        assert split.blade
        assert half_edges(mesh, state, split) == [(18, 0.5)]


def test_flanks_behind_the_edge_are_not_cut_again():
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), tool=BLADE)
    # The edge is right over the flank nodes of the notch, and ahead of it nothing is passed.
    assert due(criterion, state, pose=at(2.05, 0.0)) == []


def slide(cracks, state, criterion, start, angle_deg, way):
    """Move the blade over a sheet at rest, splitting what it cuts; return where it was each time.

    Each row: the origin of the node, and how far the edge was past it [mm].
    """
    c, s = np.cos(np.radians(angle_deg)), np.sin(np.radians(angle_deg))
    rotation = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    past = []
    for path in np.arange(0.0, way, STEP):
        edge = np.asarray(start) + path * rotation[:, 0]
        for split in due(criterion, state, pose=Pose(rotation, edge)):
            assert split.blade
            depth = (edge - state.node.x[split.node]) @ rotation[:, 0]
            past.append((int(state.node.origin[split.node]), float(depth)))
            cracks.split(state, split)
    return past


@pytest.mark.parametrize("crossing_deg", [90.0, 60.0, 45.0, 120.0])
@pytest.mark.parametrize("made", ["beforehand", "in the run"])
def test_the_far_flank_of_an_earlier_cut_is_cut_when_the_edge_reaches_it(made, crossing_deg):
    # Rows along x, columns at an angle to them; the first cut is the middle column, the second the
    # row y = 0 that crosses it.
    flat = rectangle(6.0, 4.0, n_x=6, n_y=4)
    nodes = flat.nodes.copy()
    nodes[:, 0] += nodes[:, 1] / np.tan(np.radians(crossing_deg))
    mesh = cases.moved_mesh(flat, nodes)
    column = np.flatnonzero(flat.nodes[:, 0] == 3.0)
    film = mesh.cut(column) if made == "beforehand" else mesh
    shell, state = cases.set_up(film)
    rim = np.unique(boundary_edges(state))
    criterion = SplitCriterion(
        Fracture(),
        STRENGTH,
        shell,
        LoadSet(film, ()),
        straight_blade(length=1.0),
        frozenset(open_edges(state)),
        rim,
    )
    cracks = cases.edge_cracks(film, shell, state, CohesiveLaw())
    bottom = mesh.nodes[column[0]]
    along = (mesh.nodes[column[-1]] - bottom) / np.linalg.norm(mesh.nodes[column[-1]] - bottom)
    if made == "in the run":
        first = slide(cracks, state, criterion, bottom - 0.1 * along, crossing_deg, 9.0)
        assert sorted(node for node, _ in first) == column.tolist()
    second = slide(cracks, state, criterion, (-0.1, 0.0, 0.0), 0.0, 8.0)
    # Every node of the row is cut, and both halves of the one in the first cut.
    row = np.flatnonzero(flat.nodes[:, 1] == 0.0)
    crossed = np.intersect1d(row, column)
    assert sorted(node for node, _ in second) == sorted([*row, *crossed])
    # As soon as the edge has come to it: the near half is a tip, cut by then or when it is reached.
    assert max(depth for _, depth in second) < STEP + 1e-9
    # Nobody cut the flanks that the blade slid along.
    assert state.n_node == film.n_node + (0 if made == "beforehand" else 5) + len(second)


def test_the_rim_beside_a_path_is_not_notched():
    # The blade runs along the sheet 0.4 edge lengths off its lower rim.
    mesh = sheet()
    shell, state = cases.set_up(mesh)
    criterion = SplitCriterion(
        Fracture(),
        STRENGTH,
        shell,
        LoadSet(mesh, ()),
        straight_blade(length=1.0),
        frozenset(),
        np.unique(boundary_edges(state)),
    )
    cracks = cases.edge_cracks(mesh, shell, state, CohesiveLaw())
    past = slide(cracks, state, criterion, (0.5, -1.6, 0.0), 0.0, 5.0)
    assert past == []


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_rim_that_is_drawn_along_the_blade_is_not_cut(side):
    # Film to one side of the blade, sheared until its rim x = 0 lies nearly along the blade: quads
    # on either side of a rim node, the mid-plane beside them all.
    mesh = sheet()
    shell, state = cases.set_up(mesh)
    X = mesh.nodes
    x, y = X[:, 0] + 2.0 * (X[:, 1] - 2.0), side * (0.35 * (2.0 - X[:, 1]) + 0.08)
    state.node.x[: mesh.n_node] = np.stack([x, y, X[:, 2]], axis=1)
    rim = np.unique(boundary_edges(state))
    loads, free = LoadSet(mesh, ()), frozenset()
    criterion = SplitCriterion(Fracture(), STRENGTH, shell, loads, BLADE, free, rim)
    edges = [at(x) for x in np.arange(-8.0, 8.0, STEP)]
    assert all(due(criterion, state, pose=edge) == [] for edge in edges)
    # Of film that lies across the mid-plane the rim is cut.
    state.node.x[: mesh.n_node, 1] -= 0.43 * side
    found = [split.node for edge in edges for split in due(criterion, state, pose=edge)]
    assert 21 in found  # on the rim, one row from the side that was next to the blade


def test_supported_nodes_are_not_cut():
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.zeros((2, 2)), tool=BLADE)
    state.node.supported[17] = True
    assert due(criterion, state, pose=at(3.2, 0.0)) == []


def test_a_blade_split_goes_before_a_stronger_measure():
    mesh = sheet().cut(ROW)
    _, state, criterion, _ = pulled(mesh, np.diag([0.0, 0.05]), tool=BLADE)
    found = due(criterion, state, [*crack_tips(state), 26], at(3.05, 0.0))
    assert len(found) == 2
    assert found[0].node == 17
    assert found[0].blade
    assert not any(s.blade for s in found[1:])


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"criterion": "strain"}, "criterion must be 'force' or 'stress', got 'strain'"),
        ({"drop_loose": "some"}, "drop_loose must be 'never' or 'clear'"),
        ({"turn_limit_deg": 180.0}, "turn_limit_deg must be positive and below 180, got 180.0 deg"),
        ({"check_every": 0}, "check_every must be 1 or more, got 0"),
        ({"check_every": 2.5}, "check_every"),
        ({"criterion": "x", "check_every": -1}, "criterion.*; check_every"),
    ],
)
def test_refusals(changes, message):
    with pytest.raises(ValueError, match=message):
        Fracture(**changes)
