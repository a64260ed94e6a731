import itertools

import numpy as np
import pytest

from shellcut import PathCurve
from shellcut.imprinting.chain import find_chain
from shellcut.imprinting.course import find_courses
from shellcut.imprinting.film_plane import FilmPlane
from shellcut.imprinting.pillow import pillow, pillowed_mesh
from shellcut.mesh.structured import disc, rectangle


def pillowed(mesh, curve):
    film = FilmPlane(mesh)
    (course,) = find_courses(film, [curve.mapped(film.flatten) if curve.dimension == 3 else curve])
    chain = find_chain(film, course, np.zeros(mesh.n_node, np.bool_))
    layers = pillow(film, [chain])
    return film, chain, layers


def unsmoothed(mesh, curve):
    film, _, layers = pillowed(mesh, curve)
    moved = np.flatnonzero((layers.x[: mesh.n_node] != film.x).any(axis=1))
    return pillowed_mesh(film, layers, layers.x, moved)


def edges_of(quads):
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    return set(map(tuple, np.sort(sides, axis=1).tolist()))


SHEET = rectangle(6.0, 3.0, size=0.5)
ACROSS = PathCurve.line((-1.0, 0.1), (7.0, 0.1))


@pytest.mark.parametrize(
    ("mesh", "curve", "n_copied", "n_quad"),
    [
        (SHEET, ACROSS, 13, 2 * 12),
        # two inner ends: their nodes are not copied, one quad closes the layers at each
        (SHEET, PathCurve.line((2.1, 0.1), (4.2, 0.1)), None, None),
        (disc(5.0, n_side=12, ring_radii=[3.5]), PathCurve.circle((0, 0, 0), 3.5), 48, 2 * 48),
    ],
)
def test_layers_on_both_sides(mesh, curve, n_copied, n_quad):
    _, chain, layers = pillowed(mesh, curve)
    n_node, quads = len(layers.x), layers.quads
    on = chain.nodes[chain.on_path]
    if n_copied is None:
        n_copied, n_quad = len(on), 2 * (len(on) - 1) + 2
    assert n_node == mesh.n_node + 2 * n_copied
    assert len(quads) == mesh.n_quad + n_quad
    # Euler's number: the topology is what it was
    before = mesh.n_node - len(edges_of(mesh.quads)) + mesh.n_quad
    assert n_node - len(edges_of(quads)) + len(quads) == before
    # each inner chain node joins four quads, at an inner end three
    valence = np.bincount(quads.ravel())[on]
    expected = np.full(len(on), 4)
    if not chain.closed:
        expected[[0, -1]] = 2 if chain.course.rim_start is not None else 3
    np.testing.assert_array_equal(valence, expected)
    # edges of the path are there
    keys = edges_of(quads)
    assert all((min(i, j), max(i, j)) in keys for i, j in itertools.pairwise(on))
    # quads keep their ids, and their nodes unless these were copied
    same = quads[: mesh.n_quad] == mesh.quads
    assert np.isin(mesh.quads[~same], on).all()
    np.testing.assert_array_equal(layers.parent[quads[: mesh.n_quad]], mesh.quads)


def test_the_area_is_covered_once():
    new = unsmoothed(SHEET, ACROSS)
    assert new.quad_areas().sum() == pytest.approx(18.0, rel=1e-12)


def test_sets_are_neither_lost_nor_widened():
    mesh = SHEET.with_sets(
        node_sets={
            "all": np.arange(SHEET.n_node),
            "line": SHEET.nodes_where(lambda x, y, z: abs(x - 3.0) < 1e-9),
            "patch": SHEET.nodes_where(lambda x, y, z: x > 2.9),
        },
        quad_sets={"right": np.flatnonzero(SHEET.nodes[SHEET.quads, 0].mean(axis=1) > 3.0)},
    )
    new = unsmoothed(mesh, ACROSS)
    for name, members in mesh.node_sets.items():
        np.testing.assert_array_equal(new.node_sets[name][: len(members)], members)
    assert len(new.node_set("all")) == new.n_node
    assert len(new.node_set("line")) == len(mesh.node_set("line"))
    added = new.node_set("patch")[len(mesh.node_set("patch")) :]
    assert (new.nodes[added, 0] > 3.1).all()  # those inside the patch, not those on its border
    assert len(added) == 2 * 6
    # on the rim: one copy on either side at each end of the path, none at the long sides
    assert len(new.node_set("left")) == len(mesh.node_set("left")) + 2
    assert len(new.node_set("top")) == len(mesh.node_set("top"))
    right = new.quad_set("right")
    assert len(right) == len(mesh.quad_set("right")) + 2 * 6
    assert (new.nodes[new.quads[right], 0].mean(axis=1) > 3.0).all()


def test_directors_and_origin_of_new_nodes():
    new = unsmoothed(SHEET, ACROSS)
    np.testing.assert_array_equal(new.directors, np.tile([0.0, 0.0, 1.0], (new.n_node, 1)))
    np.testing.assert_array_equal(new.origin, np.arange(new.n_node))
