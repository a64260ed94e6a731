"""The pairs of points and quads, beside those that a look at every box gives."""

import numpy as np
import pytest

from shellcut.contact.pair_search import PairSearch, Points
from shellcut.mesh.structured import rectangle
from shellcut.mitc4.initial_state import initial_state

MESH = rectangle(6.0, 4.0, size=0.5)


@pytest.mark.parametrize("reach", [0.1, 3.0])  # few pairs a point; more than room is made for
def test_pairs_are_those_of_the_boxes(reach):
    state = initial_state(MESH)
    rng = np.random.default_rng(0)
    place = np.column_stack([rng.uniform(-0.5, 6.5, 30), rng.uniform(-2.5, 2.5, 30), np.zeros(30)])
    points = Points(np.arange(30), place, np.full(30, -1))
    rows = np.arange(0, MESH.n_quad, 2)
    found = PairSearch().find(points, rows, reach, state)
    corner = MESH.nodes[MESH.quads[rows]]
    low, high = corner.min(axis=1) - reach, corner.max(axis=1) + reach
    near = ((place[:, None] >= low) & (place[:, None] <= high)).all(axis=2)
    point, which = np.nonzero(near)
    got = sorted(zip(found.point_of_pair.tolist(), found.row.tolist(), strict=True))
    assert got == sorted(zip(point.tolist(), rows[which].tolist(), strict=True))
    assert (len(got) > 16 * 31) == (reach > 1.0)
