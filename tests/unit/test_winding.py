"""Surfaces turned to run one way."""

import numpy as np

from shellcut.mesh.structured import annulus
from shellcut.numerics.consistent_winding import common_winding


def test_a_minority_is_turned_back():
    mesh = annulus(3.0, 8.0, n_around=40, n_radial=10)
    turned = np.random.default_rng(3).choice(mesh.n_quad, mesh.n_quad // 3, replace=False)
    quads = mesh.quads.copy()
    quads[turned] = quads[turned][:, ::-1]
    winding = common_winding(quads, mesh.n_node)
    np.testing.assert_array_equal(np.flatnonzero(winding.turned), np.sort(turned))
    assert not winding.one_sided.size
    assert not winding.part.any()


def test_parts_are_turned_each_by_its_own_majority():
    one = [[0, 1, 2], [0, 2, 3], [0, 4, 3]]  # the last runs against the others
    two = [[10, 11, 12], [10, 13, 12], [10, 13, 14]]  # the second does
    winding = common_winding(np.array(one + two), 15)
    assert winding.turned.tolist() == [False, False, True, False, True, False]
    assert winding.part.tolist() == [0, 0, 0, 1, 1, 1]


def test_of_two_that_disagree_the_first_stays():
    assert common_winding(np.array([[0, 1, 2], [0, 3, 2]])[::-1], 4).turned.tolist() == [
        False,
        True,
    ]
