import itertools

import numpy as np
import pytest

from films import unstructured_disc
from shellcut import ImprintError, PathCurve
from shellcut.imprinting.chain import find_chain
from shellcut.imprinting.course import find_courses
from shellcut.imprinting.film_plane import FilmPlane
from shellcut.mesh.structured import opening_disc, rectangle


def chain_of(mesh, curve, taken=()):
    film = FilmPlane(mesh)
    (course,) = find_courses(film, [curve.mapped(film.flatten) if curve.dimension == 3 else curve])
    blocked = np.zeros(mesh.n_node, np.bool_)
    blocked[list(taken)] = True
    return find_chain(film, course, blocked)


def edge_keys(mesh):
    return set(map(tuple, mesh.edges().nodes.tolist()))


def test_a_ring_of_edges_on_the_path_is_found():
    mesh = opening_disc("quick")
    chain = chain_of(mesh, PathCurve.circle((0, 0, 0), 9.4))
    assert chain.closed
    assert sorted(chain.nodes.tolist()) == sorted(mesh.node_set("ring").tolist())


def test_a_straight_row_is_taken_rather_than_steps():
    mesh = rectangle(10.0, 4.0, size=0.5)
    chain = chain_of(mesh, PathCurve.line((-1.0, 0.1), (12.0, 0.1)))
    np.testing.assert_allclose(mesh.nodes[chain.nodes, 1], 0.0, atol=1e-12)
    assert (np.diff(chain.u) > 0.0).all()
    assert chain.on_path == slice(0, 21)


def test_a_chain_follows_edges_forward_on_an_unstructured_mesh():
    mesh = unstructured_disc(spacing=1.9)
    for curve in (
        PathCurve.circle((0.3, 0.1, 0.0), 6.0),
        PathCurve.line((-12.0, 0.4), (12.0, 1.9)),
        PathCurve.line((-4.0, 0.4), (4.0, 1.9)),
    ):
        chain = chain_of(mesh, curve)
        nodes = chain.nodes.tolist()
        pairs = list(itertools.pairwise(nodes))
        pairs += [(nodes[-1], nodes[0])] if chain.closed else []
        assert all((min(p), max(p)) in edge_keys(mesh) for p in pairs)
        assert len(set(nodes)) == len(nodes)
        assert (np.diff(chain.u) > 0.0).all()
        off = np.linalg.norm(mesh.nodes[nodes] - curve.mapped(_in_space).point(chain.u), axis=1)
        assert off[chain.on_path].max() < 1.8 * 1.1  # reach, in edge lengths of 0.9 to 1.1 mm


def _in_space(points):
    return np.column_stack([points[:, :2], np.zeros(len(points))])


def test_inner_ends_lie_beyond_the_path():
    mesh = rectangle(10.0, 4.0, size=0.5)
    chain = chain_of(mesh, PathCurve.line((3.1, 0.1), (7.2, 0.1)))
    x = mesh.nodes[chain.nodes, 0]
    assert x[1] <= 3.1
    assert x[-2] >= 7.2
    assert chain.on_path == slice(1, len(x) - 1)


def test_where_no_line_runs_is_told():
    mesh = rectangle(10.0, 4.0, size=0.5)
    wall = mesh.nodes_where(lambda x, y, z: abs(x - 5.0) < 1e-9)
    with pytest.raises(ImprintError, match=r"none that ends at \(4\.5"):
        chain_of(mesh, PathCurve.line((-1.0, 0.1), (12.0, 0.1)), taken=wall.tolist())
