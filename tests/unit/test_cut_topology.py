"""Which copies share nodes: closed tips, rims, broken sides, cuts of what is cut already."""

import numpy as np

from shellcut.fracture.cut_topology import CutTopology
from shellcut.fracture.quad_polygon import (
    WHOLE,
    on_side,
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
