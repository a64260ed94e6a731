"""The closest-point grid against brute force: all triangles, and the winding number."""

import numpy as np
import pytest

from naive.contact import distances, winding_number
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.shapes import straight_blade, tooth_ring
from shellcut.tool.signed_distance import at_least, clear_before_plane


def random_points(tool, seed, n=500):
    """Points all over the box and, at distances from 1e-6 to 0.1 mm, around the cutting edge."""
    rng = np.random.default_rng(seed)
    lower, upper = tool.bounding_box()
    spread = rng.uniform(lower - 0.1, upper + 0.1, (n, 3))
    edge = tool.edges[rng.integers(tool.n_edge, size=n)]
    s = rng.uniform(0.0, 1.0, (n, 1))
    s[: n // 5] = np.round(s[: n // 5])  # at the vertices of the edge and beyond the tip
    on_edge = (1.0 - s) * tool.vertices[edge[:, 0]] + s * tool.vertices[edge[:, 1]]
    direction = rng.standard_normal((n, 3))
    direction /= np.linalg.norm(direction, axis=1)[:, None]
    near = on_edge + 10.0 ** rng.uniform(-6.0, -1.0, (n, 1)) * direction
    # inside, close to the edge: a thin wedge is hardly ever hit by chance
    e = rng.integers(tool.n_edge, size=n)
    on_edge = tool.vertices[tool.edges[e]].mean(axis=1)
    behind = on_edge + 10.0 ** rng.uniform(-5.0, -0.5, (n, 1)) * tool.edge_back[e]
    return np.concatenate([spread, near, behind])


def assert_matches_brute_force(tool, points):
    grid = ClosestTriangleGrid.build(tool)
    table = distances(points, tool)
    inside = winding_number(points, tool) > 0.5
    needed = inside | (table.min(axis=1) <= grid.reach)
    assert inside.sum() > 100
    for side in (-1, 0, 1):
        found, says_inside, triangle, closest = grid.query(points, side)
        assert found[needed].all()
        np.testing.assert_array_equal(says_inside, inside)
        eligible = side * tool.flank >= 0
        best = table[:, eligible].min(axis=1)[found]
        assert eligible[triangle[found]].all()
        gap = np.linalg.norm(points - closest, axis=1)[found]
        np.testing.assert_allclose(gap, best, rtol=1e-9, atol=1e-13)
        # the point lies on the triangle that is named
        chosen = table[found, triangle[found]]
        np.testing.assert_allclose(chosen, best, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize(
    ("half_angle_deg", "edge_angle_deg"), [(3.0, 55.0), (12.0, 90.0), (30.0, 55.0)]
)
def test_straight_blade_equals_brute_force(half_angle_deg, edge_angle_deg):
    tool = straight_blade(
        wedge_half_angle_deg=half_angle_deg,
        edge_angle_deg=edge_angle_deg,
        half_thickness=0.1,
        length=2.5,
        height=1.2,
    )
    assert_matches_brute_force(tool, random_points(tool, seed=11, n=700))


@pytest.mark.parametrize("half_angle_deg", [3.0, 30.0])
def test_teeth_equal_brute_force(half_angle_deg):
    tool = tooth_ring(
        n_teeth=2, radius=3.0, height=1.5, length=0.8, wedge_half_angle_deg=half_angle_deg, n_arc=8
    )
    assert_matches_brute_force(tool, random_points(tool, seed=12, n=400))


def test_a_grid_finds_no_far_point_and_refuses():
    grid = ClosestTriangleGrid.of(straight_blade())
    with pytest.raises(ValueError, match="read-only"):
        grid.arrays.lists.triangle[0] = 1
    far = np.array([[50.0, 0.0, 0.0], [0.0, -9.0, 0.0], [0.0, 0.0, 1e300], [np.nan, 0.0, 0.0]])
    found, inside, triangle, closest = grid.query(far)
    assert not found.any()
    assert not inside.any()
    assert (triangle == 0).all()
    np.testing.assert_array_equal(closest, far)
    with pytest.raises(ValueError, match=r"points must have shape \(n_point, 3\), got \(1, 2\)"):
        grid.query([0.0, 1.0])
    with pytest.raises(ValueError, match=r"side must be -1, 0 or \+1, got 2"):
        grid.query([0.0, 0.0, 0.0], side=2)
    found, inside, _, _ = ClosestTriangleGrid.of(None).query([[0.0, 0.0, 0.0], [-0.5, 0.0, 0.0]])
    assert not found.any()
    assert not inside.any()


def test_one_grid_a_tool():
    blade, other = straight_blade(), straight_blade(length=2.0)
    assert ClosestTriangleGrid.of(blade) is ClosestTriangleGrid.of(blade)
    for tool in (blade, other):
        corners = ClosestTriangleGrid.of(tool).arrays.surface.corners
        np.testing.assert_array_equal(corners, tool.vertices[tool.triangles])


def test_however_few_cells_there_are_the_answers_are_the_same(monkeypatch):
    tool = straight_blade(height=1.0, length=1.5)
    points = random_points(tool, seed=13, n=1000)
    fine = ClosestTriangleGrid.of(tool)
    monkeypatch.setattr("shellcut.tool.closest_triangles.MOST_CELLS", 500)
    coarse = ClosestTriangleGrid.of(straight_blade(height=1.0, length=1.5 + 1e-12))
    assert 250 < np.prod(coarse.arrays.cells.shape) <= 500 < np.prod(fine.arrays.cells.shape)
    both = fine.query(points, 1)[0] & coarse.query(points, 1)[0]
    _, inside_fine, _, closest_fine = fine.query(points[both], 1)
    _, inside_coarse, _, closest_coarse = coarse.query(points[both], 1)
    np.testing.assert_array_equal(inside_fine, inside_coarse)
    np.testing.assert_allclose(closest_fine, closest_coarse, atol=1e-11)


def test_what_is_not_found_is_no_closer_than_its_empty_cells_say():
    tool = straight_blade()
    grid = ClosestTriangleGrid.of(tool)
    rng = np.random.default_rng(8)
    low, high = tool.bounding_box()
    points = low + (high - low) * rng.uniform(-0.5, 1.5, (300, 3))
    found, *_ = grid.query(points)
    points = points[~found]
    least = [at_least(tuple(p), grid.reach, grid.arrays.cells, grid.empty_around) for p in points]
    true = distances(points, tool).min(axis=1)
    assert (np.array(least) <= true * (1.0 + 1e-12)).all()
    assert np.median(np.array(least) / true) > 0.5


@pytest.mark.parametrize(
    "tool",
    [straight_blade(wedge_half_angle_deg=12.0, height=1.2), tooth_ring(n_teeth=2)],
    ids=["blade", "teeth"],
)
def test_a_point_in_front_of_the_plane_through_its_closest_point_stays_outside(tool):
    grid, rng = ClosestTriangleGrid.of(tool), np.random.default_rng(3)
    points = random_points(tool, seed=14, n=400)
    found, inside, _, closest = grid.query(points)
    gap = np.linalg.norm(points - closest, axis=1)
    outside = found & ~inside & (gap > 0.0)
    p, q, gap = points[outside], closest[outside], gap[outside]
    free = [clear_before_plane(tuple(a), tuple(b), grid.arrays) for a, b in zip(p, q, strict=True)]
    free = np.maximum(free, gap)
    # In any direction, most of them along the plane and a little towards the tool.
    along = rng.standard_normal((len(p), 8, 3))
    away = ((p - q) / gap[:, None])[:, None]
    along -= ((along * away).sum(axis=2, keepdims=True) + rng.uniform(0.0, 0.2, (8, 1))) * away
    along *= (0.999 * free / np.linalg.norm(along, axis=2).T).T[..., None]
    there = p[:, None] + along
    in_front = ((there - q[:, None]) * away).sum(axis=2) > 1e-9
    assert not (winding_number(there[in_front], tool) > 0.5).any()
    assert in_front.mean() > 0.2
    assert (free > 3.0 * gap).mean() > 0.5  # which is what the plane is for
