"""The closed form of the depth beside two faces, against a search."""

from types import SimpleNamespace

import numpy as np
import pytest

from naive.contact import rounded_depth
from naive.edge_contact import deepest_on_edge
from shellcut.contact.tool_wedge import Place, deepest_in_wedge, place_in_wedge, wedge_along

R = 0.037  # mm


def unit(v):
    return v / np.linalg.norm(v)


def wedges(rng, n):
    """Two faces through the origin and an edge of the film across them, n times."""
    for _ in range(n):
        one = unit(rng.normal(size=3))
        two = unit(one * rng.uniform(-0.8, 0.98) + 0.6 * unit(rng.normal(size=3)))
        ridge, inward = unit(np.cross(one, two)), -unit(one + two)
        middle = rng.uniform(-0.01, 0.06) * inward + rng.uniform(-0.1, 0.1) * ridge
        along = unit(one - rng.uniform(0.05, 2.0) * two + rng.uniform(-0.5, 0.5) * ridge)
        s = rng.uniform(0.1, 0.9)
        yield one, two, middle - 0.4 * s * along, middle + 0.4 * (1.0 - s) * along


def of_faces(one, two, a, b):
    return wedge_along(tuple(a), tuple(b - a), tuple(one), tuple(two), 0.0, 0.0)


def test_depth_and_way_out_are_those_of_two_planes():
    rng, seen = np.random.default_rng(1), set()
    for one, two, a, b in wedges(rng, 40):
        wedge = of_faces(one, two, a, b)
        for s in rng.uniform(size=5):
            here = place_in_wedge(s, wedge, R)
            planes = np.zeros((2, 3)), np.array([one, two])
            depth, out = rounded_depth(a + s * (b - a), planes, R)
            assert here.inside == (depth > 0.0)
            on_one_face = min(np.abs(out - one).max(), np.abs(out - two).max()) < 1e-9
            seen.add((here.inside, depth > R, on_one_face))
            if here.inside:
                assert here.depth == pytest.approx(depth, abs=1e-12)
                np.testing.assert_allclose(here.out, out, atol=1e-7)
    # On the round, on a face, deeper than the round.
    assert {(True, False, False), (True, False, True), (True, True, True)} <= seen


def test_deepest_place_is_that_of_a_search():
    rng, found_at = np.random.default_rng(2), []
    for one, two, a, b in wedges(rng, 120):
        tool = SimpleNamespace(
            vertices=np.zeros((1, 3)),
            triangles=np.zeros((2, 1), int),
            triangle_normals=np.array([one, two]),
        )
        wanted, at = deepest_on_edge(a, b, tool, R)
        wedge = of_faces(one, two, a, b)
        ends = [place_in_wedge(s, wedge, R) for s in (0.0, 1.0)]
        says, found = deepest_in_wedge(wedge, *ends, R)
        assert says
        # At a kink the search comes to 1e-7 of the edge, so to 1e-8 mm of the depth.
        assert found.depth == pytest.approx(max(wanted, 0.0), abs=1e-8)
        if found.depth > 0.0:
            found_at.append(found.here.depth > R)
            assert found.s == pytest.approx(at, abs=1e-4)
    assert 5 < sum(found_at) < len(found_at) - 5


def test_a_wedge_deeper_than_the_tool_at_an_end_says_nothing():
    one, two = np.array([1.0, 0.0, 0.0]), np.array([0.0, 1.0, 0.0])
    # Into the first face and on, away from the second: another face of the tool must end that.
    wedge = of_faces(one, two, np.array([0.1, -1.0, 0.0]), np.array([-0.3, -2.0, 0.0]))
    outside = Place(False, 0.0, (0.0, 0.0, 0.0))
    says, found = deepest_in_wedge(wedge, outside, outside, R)
    assert not says
    assert found.s == 1.0
