"""Triangles and quads split into quads."""

import numpy as np
import pytest

from shellcut.mesh.mesh import Mesh
from shellcut.mesh.structured import rectangle
from shellcut.mesh.triangles_to_quads import split_in_quads


@pytest.fixture
def mixed():
    """4 x 3 quads, three of them cut into two triangles."""
    mesh = rectangle(4.0, 3.0, n_x=4, n_y=3)
    cut = np.array([0, 6, 11])
    corners = mesh.quads[cut]
    triangles = np.concatenate([corners[:, [0, 1, 2]], corners[:, [0, 2, 3]]])
    return mesh, np.delete(mesh.quads, cut, axis=0), triangles


def test_the_split_mesh_is_conforming_and_of_the_same_area(mixed):
    mesh, quads, triangles = mixed
    split = split_in_quads(mesh.nodes, quads, triangles)
    new = Mesh.from_arrays(split.nodes, split.quads)  # refuses cracks and turned quads
    assert new.n_quad == 4 * len(quads) + 3 * len(triangles)
    assert new.quad_areas().sum() == pytest.approx(12.0, rel=1e-14)  # round-off
    # a conforming split has two boundary edges for each there was
    assert (new.edges().n_quad == 1).sum() == 2 * (mesh.edges().n_quad == 1).sum()
    assert np.bincount(split.parent).tolist() == [4] * len(quads) + [3] * len(triangles)


def test_sets_take_the_middles_and_centres_between_their_members(mixed):
    mesh, quads, triangles = mixed
    split = split_in_quads(mesh.nodes, quads, triangles)
    x, y, _ = split.nodes.T
    for name, there in (
        ("left", x == 0.0),
        ("top", y == 1.5),
    ):
        members = split.with_middles(mesh.node_set(name))
        np.testing.assert_array_equal(np.sort(members), np.flatnonzero(there))
    rim = split.with_middles(mesh.boundary_nodes())
    new = Mesh.from_arrays(split.nodes, split.quads)
    np.testing.assert_array_equal(np.sort(rim), new.boundary_nodes())
    mesh, quads, triangles = mixed
    split = split_in_quads(mesh.nodes, quads, triangles)
    column = split.with_middles(mesh.nodes_where(lambda x, y, z: x == 2.0))
    np.testing.assert_array_equal(np.sort(column), np.flatnonzero(split.nodes[:, 0] == 2.0))
    half = split.with_middles(mesh.nodes_where(lambda x, y, z: x >= 2.0))
    np.testing.assert_array_equal(np.sort(half), np.flatnonzero(split.nodes[:, 0] >= 2.0))


def test_middles_of_lines(mixed):
    mesh, quads, triangles = mixed
    split = split_in_quads(mesh.nodes, quads, triangles)
    line = mesh.node_set("left")
    middles = split.middles(np.stack([line[1:], line[:-1]], axis=1))
    np.testing.assert_array_equal(split.nodes[middles], [[0, y, 0] for y in (-1.0, 0.0, 1.0)])
    assert split.middles(np.array([[0, 19]])).size == 0  # no edge of the mesh


def test_triangles_alone():
    split = split_in_quads(np.eye(3), np.empty((0, 4), np.int64), np.array([[0, 1, 2]]))
    assert split.quads.tolist() == [[0, 3, 6, 4], [1, 5, 6, 3], [2, 4, 6, 5]]
