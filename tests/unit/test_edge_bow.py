"""Tips, arcs and straight parts of cutting edges."""

import itertools

import numpy as np
import pytest

from shellcut import read_tool
from shellcut.contact.tool_points import tool_points
from shellcut.tool.edge_bow import EdgeBow
from shellcut.tool.shapes import tooth_ring
from teeth import arc, disc, rounded, tool_of, tooth, vee


def tips_of(tool):
    """Return the places of its tips, (n, 3), in order."""
    found = np.round(tool.vertices[EdgeBow.of(tool).tip], 9) + 0.0
    return found[np.lexsort(found.T[::-1])]


def split(line, pieces):
    """Return a line with so many collinear segments for each of its own."""
    line = np.asarray(line)
    parts = [np.linspace(a, b, pieces, endpoint=False) for a, b in itertools.pairwise(line)]
    return np.vstack([*parts, line[-1:]])


@pytest.mark.parametrize("rise", [8.0, 30.0, 75.0])
@pytest.mark.parametrize("pieces", [1, 7])
def test_the_apex_of_a_vee_is_a_tip_and_its_edges_are_straight(rise, pieces):
    tool = tool_of(tooth(split(vee(rise), pieces), height=8.0))
    bow, tips = EdgeBow.of(tool), tips_of(tool)
    assert len(tips) == 3  # the apex and the two ends
    np.testing.assert_allclose(tips[1], 0.0, atol=1e-9)
    assert np.isinf(bow.radius).all()
    assert (bow.arc == -1).all()


def test_a_tooth_of_which_one_edge_cuts_has_the_same_tip():
    one, both = (tool_of(tooth(vee(30.0), named=named)) for named in ([0], None))
    assert any((tip == 0.0).all() for tip in tips_of(one))
    assert any((tip == 0.0).all() for tip in tips_of(both))


@pytest.mark.parametrize("radius", [0.1, 3.0, 40.0])
@pytest.mark.parametrize("facet", [0.5, 5.0, 15.0])
def test_an_arc_has_its_radius_however_fine_its_facets(radius, facet):
    tool = tool_of(tooth(arc(radius, facet), height=radius))
    bow = EdgeBow.of(tool)
    assert bow.tip.sum() == 2
    inner = np.sort(bow.radius)[:-2]
    np.testing.assert_allclose(inner, radius, rtol=1e-9)
    assert len(np.unique(bow.arc)) == 1


def test_a_disc_is_one_arc_without_tips_and_a_polygon_has_corners():
    bow = EdgeBow.of(tool_of(disc(4.0, 48)))
    assert not bow.tip.any()
    np.testing.assert_allclose(bow.radius, 4.0, rtol=1e-9)
    assert len(np.unique(bow.arc)) == 1
    assert EdgeBow.of(tool_of(disc(4.0, 6))).tip.sum() == 6


def test_what_curves_in_the_plane_of_the_film_is_straight():
    ring = EdgeBow.of(tooth_ring())
    assert ring.tip.sum() == 8
    assert np.isinf(ring.radius).all()
    # A cutter that stands on a closed curve.
    n = 24
    k, angle = np.arange(n), 2.0 * np.pi * np.arange(n) / n
    ways = np.column_stack([np.cos(angle), np.sin(angle), 0.0 * angle])
    low, out, into = 4.0 * ways, 4.3 * ways + [0.0, 0.0, 2.0], 3.7 * ways + [0.0, 0.0, 2.0]
    j = (k + 1) % n
    sides = [(k, j, n + j), (k, n + j, n + k), (k, 2 * n + j, j), (k, 2 * n + k, 2 * n + j)]
    top = [(n + k, n + j, 2 * n + j), (n + k, 2 * n + j, 2 * n + k)]
    triangles = np.vstack([np.stack(t, axis=1) for t in (*sides, *top)])
    bow = EdgeBow.of(tool_of((np.vstack([low, out, into]), triangles, np.stack([k, j], axis=1))))
    assert not bow.tip.any()
    assert np.isinf(bow.radius).all()


def test_a_tooth_read_from_stl_has_the_same_points(tmp_path):
    tool = tool_of(tooth(vee(30.0)))
    tool.write(tmp_path / "tooth.stl")
    read = read_tool(tmp_path / "tooth.stl", unit="mm")
    mine, its = (tool_points(one, 0.4) for one in (tool, read))
    found = []
    for points in (mine, its):
        tip = points.place[points.radius == 0.0]
        found.append(tip[np.lexsort(np.round(tip, 4).T)])
    np.testing.assert_allclose(*found, atol=1e-6)


@pytest.mark.parametrize("radius", [0.05, 0.3, 2.0])
@pytest.mark.parametrize("size", [0.2, 0.8])
def test_no_arc_stands_out_between_its_points(radius, size):
    depth = 0.02
    tool = tool_of(tooth(rounded(radius, 60.0, 6.0)))
    points, bow = tool_points(tool, size, depth), EdgeBow.of(tool)
    on = np.flatnonzero(points.arc >= 0)
    nose = tool.edges[bow.radius < 1.01 * radius]
    for angle in np.radians(np.arange(-40.0, 41.0, 10.0)):
        way = np.array([np.sin(angle), 0.0, -np.cos(angle)])
        gap = (tool.vertices[np.unique(nose)] @ way).max() - (points.place[on] @ way).max()
        assert gap < 1.5 * depth
