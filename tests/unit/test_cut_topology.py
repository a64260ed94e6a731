"""Which copies share nodes: closed tips, rims, broken sides, cuts of what is cut already."""

import numpy as np
import pytest

from shellcut.fracture.cut_topology import CutTopology
from shellcut.fracture.quad_polygon import (
    FLANK,
    WHOLE,
    contains,
    density,
    divide,
    on_side,
    share_of,
)
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import quads_of_nodes

# Rows of three quads; the middle of the mesh is node 5 + 4 k of the middle row.
MESH = rectangle(3.0, 3.0, size=1.0)


def topology():
    return CutTopology(MESH.quads, *quads_of_nodes(MESH.quads, MESH.n_node))


def quad_at(x, y):
    centre = MESH.nodes[MESH.quads].mean(axis=1) - MESH.nodes.min(axis=0)
    return int(np.argmin(np.hypot(centre[:, 0] - x, centre[:, 1] - y)))


def node_at(x, y):
    return int(np.argmin(np.hypot(*(MESH.nodes - MESH.nodes.min(axis=0) - [x, y, 0.0])[:, :2].T)))


def across(quad, height=0.5):
    """Return where a line at a height crosses the left and the right side of a quad."""
    X, places = MESH.nodes[MESH.quads[quad]], []
    for x in (X[:, 0].min(), X[:, 0].max()):
        for side in range(4):
            a, b = X[side], X[(side + 1) % 4]
            if a[0] == b[0] == x:
                places.append(on_side(side, height if b[1] > a[1] else 1.0 - height))
    return places


def classes_along(cuts, y):
    """How many classes the nodes at this height have, from the left to the right."""
    return [len(cuts.classes(node_at(x, y))) for x in range(4)]


def test_a_crack_is_closed_at_its_tip_and_open_behind():
    cuts = topology()
    for x, wanted in ((0.5, [2, 1, 1, 1]), (1.5, [2, 2, 1, 1]), (2.5, [2, 2, 2, 2])):
        cuts.cut(quad_at(x, 1.5), *across(quad_at(x, 1.5)))
        assert classes_along(cuts, 1.0) == classes_along(cuts, 2.0) == wanted
        assert classes_along(cuts, 0.0) == classes_along(cuts, 3.0) == [1, 1, 1, 1]
    # Of the two classes at each node one has film there.
    for x in range(4):
        real = [cuts.is_real(members) for members in cuts.classes(node_at(x, 1))]
        assert sorted(real) == [False, True]


def test_cracks_that_miss_each_other_on_a_side_stay_closed():
    cuts = topology()
    for x, height in ((0.5, 0.3), (1.5, 0.6)):
        cuts.cut(quad_at(x, 1.5), *across(quad_at(x, 1.5), height))
    assert classes_along(cuts, 1.0) == classes_along(cuts, 2.0) == [2, 1, 1, 1]


def test_broken_sides_part_the_nodes_between_them():
    cuts = topology()
    for x, wanted in ((0, [2, 1, 1, 1]), (1, [2, 2, 1, 1])):
        cuts.break_side(node_at(x, 1), node_at(x + 1, 1))
        assert classes_along(cuts, 1.0) == wanted
    assert all(cuts.is_real(members) for members in cuts.classes(node_at(1, 1)))


def test_a_cut_of_a_copy_and_its_undoing():
    cuts, quad = topology(), quad_at(1.5, 1.5)
    left, right = across(quad)
    new = cuts.cut(quad, left, right)
    before = cuts.polygon(new), cuts.classes(node_at(1, 1)), cuts.n_row
    middle = (0.5 * (left[0] + right[0]), 0.5 * (left[1] + right[1]))
    end = next(p for p in cuts.polygon(new).points if p not in (left, right))
    newer = cuts.cut(new, middle, end)
    assert cuts.rows_of(quad) == [quad, new, newer]
    cuts.mend(new, newer, before[0])
    assert before == (cuts.polygon(new), cuts.classes(node_at(1, 1)), cuts.n_row)
    cuts.mend(quad, new, WHOLE)
    assert cuts.rows_of(quad) == [quad]
    assert cuts.polygon(quad) == WHOLE


def test_saved_topology_is_the_same():
    one, other = topology(), topology()
    for x in (0.5, 1.5):
        one.cut(quad_at(x, 1.5), *across(quad_at(x, 1.5), 0.4))
    one.break_side(node_at(2, 1), node_at(2, 2))
    other.restore(one.saved())
    for node in range(MESH.n_node):
        assert one.classes(node) == other.classes(node)
    assert one.crossings(node_at(1, 1), node_at(1, 2)) == pytest.approx([0.4])


def test_shares_of_random_chords_sum_to_one():
    """Also of a distorted, warped quad; each part lies on its own side of the chord."""
    rng = np.random.default_rng(0)
    X = np.array([[0, 0, 0.1], [1.3, 0.1, 0.0], [1.1, 0.9, 0.2], [-0.2, 1.2, 0.0]])
    parts = [WHOLE]
    for _ in range(40):
        polygon = parts.pop(int(rng.integers(len(parts))))
        k = len(polygon.points)
        i, j = rng.choice(k, 2, replace=False)
        ends = []
        for e in (i, j):
            a, b = np.array(polygon.points[e]), np.array(polygon.points[(e + 1) % k])
            ends.append(tuple(a + rng.uniform(0.2, 0.8) * (b - a)))
        right, left = divide(polygon, *ends)
        parts += [right, left]
        assert FLANK in right.sides
        assert FLANK in left.sides
        assert contains(polygon, tuple(np.mean(right.points, axis=0)))
        assert not contains(left, tuple(np.mean(right.points, axis=0)))
    shares = [share_of(polygon, density(X)) for polygon in parts]
    assert min(shares) > 0.0
    assert sum(shares) == pytest.approx(1.0, abs=1e-13)
