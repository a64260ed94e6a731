"""Surfaces put in order: duplicates, flat triangles, orientation, seams between faces."""

import numpy as np
import pytest

from known_film import moebius_strip
from shellcut.mesh.structured import annulus
from shellcut.numerics.consistent_winding import common_winding
from shellcut.tool.surface import Surface
from shellcut.tool.surface_repair import closed_seams, repaired
from test_tool import joined, wedge


def test_a_sound_surface_stays_as_it_is():
    vertices, triangles = wedge()
    done = repaired(vertices, triangles)
    np.testing.assert_array_equal(done.vertices, vertices)
    np.testing.assert_array_equal(done.triangles, triangles)
    assert not done.notes
    assert not done.problems


def problems(done):
    return Surface(done.vertices, done.triangles).problems()


def test_separate_corners_become_one_vertex_within_a_tolerance():
    vertices, triangles = wedge()
    soup = vertices[triangles].reshape(-1, 3)
    ids = np.arange(len(soup)).reshape(-1, 3)
    done = repaired(soup, ids)
    assert len(done.vertices) == 6
    assert problems(done) == []
    soup = soup + 1e-4 * np.random.default_rng(1).uniform(-1.0, 1.0, soup.shape)
    assert problems(repaired(soup, ids))
    assert not problems(repaired(soup, ids, tolerance=1e-3))


def test_only_closed_bodies_inside_out_are_turned():
    (v, t), other = wedge(), wedge(at=(5.0, 0.0, 0.0))
    done = repaired(*joined((v, t[:, ::-1]), other))
    assert done.notes == ["1 of 2 bodies was inside out and is turned"]
    assert (Surface(done.vertices, done.triangles).body_volumes() > 0.0).all()
    opened = repaired(v, t[:-1, ::-1])
    assert not opened.notes
    assert "the surface has a hole" in problems(opened)[0]


def test_triangles_without_an_area_or_there_twice_go():
    vertices, triangles = wedge()
    twin = np.concatenate([vertices, vertices[:1]])
    done = repaired(twin, np.concatenate([triangles, [(0, 6, 3), (6, 0, 3)]]))
    assert len(done.triangles) == len(triangles)
    assert done.notes == ["2 triangles without an area are removed"]
    again = triangles[[0, 3]][:, [1, 2, 0]]
    done = repaired(vertices, np.concatenate([triangles, again]))
    assert len(done.triangles) == len(triangles)
    assert done.notes == ["2 repeated triangles are removed"]


@pytest.mark.parametrize("beside", [0.0, 1e-9])
def test_a_flat_triangle_of_a_corner_on_its_longest_side_is_swapped_away(beside):
    # The side 0 - 3 is split at its middle, or a hair beside, on one face only; a flat triangle
    # fills the seam.
    vertices, triangles = wedge()
    middle = len(vertices)
    vertices = np.concatenate([vertices, 0.5 * (vertices[[0]] + vertices[[3]])])
    vertices[-1, 1] += beside
    row = next(t for t in triangles.tolist() if (0, 3) in zip(t, t[1:] + t[:1], strict=True))
    apex = next(v for v in row if v not in (0, 3))
    rest = [t for t in triangles.tolist() if t != row]
    done = repaired(
        vertices, np.array([*rest, (0, middle, apex), (middle, 3, apex), (0, 3, middle)])
    )
    assert problems(done) == []
    (volume,) = Surface(done.vertices, done.triangles).body_volumes()
    assert volume == pytest.approx(
        Surface(*wedge()).body_volumes()[0], rel=1e-8 if beside else 1e-12
    )


def test_a_moebius_strip_is_a_problem():
    nodes, quads = moebius_strip(9)
    done = repaired(nodes, np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]]))
    assert "18 triangles around" in done.problems[0]
    assert "one side only" in done.problems[0]


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
    two = np.array([[0, 3, 2], [0, 1, 2]])  # the first stays
    assert common_winding(two, 4).turned.tolist() == [False, True]


def test_seams_of_faces_that_differ_are_closed():
    """A double pyramid whose halves have different vertices on one side of the common square."""
    square = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    tips = [[0.5, 0.5, -1], [0.5, 0.5, 1]]
    extra = [[0.3, 0, 0], [0.7, 1e-3, 0], [0.5, 0, 0]]
    places = np.array([*square, *square, *tips, *extra], dtype=float)
    triangles = []
    for rim, tip, turn in (([0, 10, 11, 1, 2, 3], 8, -1), ([4, 12, 5, 6, 7], 9, 1)):
        pairs = zip(rim, [*rim[1:], rim[0]], strict=True)
        triangles += [[a, b, tip][::turn] for a, b in pairs]
    joined, rows = closed_seams(places, np.array(triangles), merge=1e-6, reach=2e-3)
    assert len(rows) == len(triangles) + 3
    assert len(joined) == 9
    assert not Surface(joined, rows).problems()
    joined, rows = closed_seams(places, np.array(triangles), merge=1e-6, reach=5e-4)
    assert len(rows) == len(triangles) + 2  # the vertex a micrometre away stays out
    assert "open edges: the surface has a hole" in Surface(joined, rows).problems()[0]
