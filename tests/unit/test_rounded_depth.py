"""The depth under rounded convex edges: continuous forces around edges and corners of a tooth."""

import numpy as np
import pytest

from blunt_tools import box
from naive.contact import rounded_depth as naive_depth
from shellcut.arrays import Bools, Floats, Ints
from shellcut.contact.settings import STEEPEST
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import kernel
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.rounded_depth import ConvexNeighbours, rounded_depth
from shellcut.tool.shapes import round_bar, straight_blade, tooth_ring
from shellcut.tool.signed_distance import TriangleGrid, signed_distance
from shellcut.tool.surface import Surface

R = 0.037  # mm
G_M = 0.5 * R
AROUND = 0.02  # radius of the sweeps [mm]
TOOTH = tooth_ring(n_teeth=1)
SURFACE = Surface(TOOTH.vertices, TOOTH.triangles)


@kernel
def _evaluate(
    x: Floats,
    side: int,
    radius: float,
    grid: TriangleGrid,
    around: ConvexNeighbours,
    depth: Floats,
    out: Floats,
    own: Bools,
    triangle: Ints,
    across: Ints,
) -> None:
    grid, around = borrowed(grid), borrowed(around)
    for i in range(x.shape[0]):
        p = (x[i, 0], x[i, 1], x[i, 2])
        _, inside, t, q, whole = signed_distance(p, side, grid)
        own[i] = (not inside) or side * grid.surface.flank[whole] >= 0
        triangle[i] = t
        if inside:
            g, n, across[i] = rounded_depth(p, q, t, side, radius, grid, around, across[i])
            depth[i] = g
            out[i, 0], out[i, 1], out[i, 2] = n


def depths(tool, x, side, radius=R, across=None):
    """Depth, way out, and whether the closest face is one that a node of this side feels.

    across : (n,), face that is tried first as the one beyond an edge; replaced by the one found.
    """
    n = len(x)
    depth, out, own, triangle = np.zeros(n), np.zeros((n, 3)), np.ones(n, bool), np.zeros(n, int)
    grid, around = ClosestTriangleGrid.of(tool).arrays, ConvexNeighbours.of(tool)
    if across is None:
        across = np.full(n, -1)
    rows = depth, out, own, triangle, across
    _evaluate(np.ascontiguousarray(x), side, radius, grid, around, *rows)
    return depth, out, own


def force(depth, out):
    """f(D) n, over k."""
    g = np.maximum(depth, 0.0)
    f = np.where(g < G_M, (g / G_M) ** 3 * (3 * G_M - 2 * g), g)
    return f[:, None] * out


def largest_slope(x, side):
    """Largest change of the force between neighbouring points, over their distance and k."""
    depth, out, own = depths(TOOTH, x, side)
    change = np.linalg.norm(np.diff(force(depth, out), axis=0), axis=1)
    change[~(own[1:] & own[:-1])] = 0.0  # a node of this side is not there
    return (change / np.linalg.norm(np.diff(x, axis=0), axis=1)).max()


def circle(centre, u, v, n=2001):
    angle = np.linspace(-np.pi, np.pi, n)[:, None]
    return centre + AROUND * (np.cos(angle) * u + np.sin(angle) * v)


def sides_of(triangles):
    """The sides that a node near these triangles may have: not both, at a cutting edge."""
    flanks = set(TOOTH.flank[triangles].tolist()) - {0}
    return () if len(flanks) == 2 else (flanks.pop() if flanks else 1,)


def test_the_force_is_continuous_around_every_edge_of_a_tooth():
    # Where it slides, force over distance is at most the slope of f along n, 27/16, and across it
    # f over the radius of the rounding that is left, 1.3 here. Without the rounding, two thirds of
    # the edges are above 5 and the sharp ones at 865: jumps, whatever the distance.
    slopes, n_sharp = [], 0
    for e in np.flatnonzero(np.abs(SURFACE.turn) > 1e-6):
        a, b = TOOTH.vertices[SURFACE.lo[e]], TOOTH.vertices[SURFACE.hi[e]]
        along = (b - a) / np.linalg.norm(b - a)
        beside = [SURFACE.forward[e], SURFACE.backward[e]]
        inward = -SURFACE.normals[beside].sum(axis=0)
        inward /= np.linalg.norm(inward)
        for side in sides_of(beside):
            x = circle(a + 0.37 * (b - a), inward, np.cross(along, inward))
            slopes.append(largest_slope(x, side))
            n_sharp += SURFACE.turn[e] > np.radians(60.0)
    assert len(slopes) > 1000
    assert n_sharp > 50
    assert np.quantile(slopes, 0.99) < STEEPEST
    # Beside the tip, where the cutting edge is nearer than the radius, up to twice that.
    assert max(slopes) < 2.0 * STEEPEST


def test_the_force_is_continuous_around_every_corner_of_a_tooth():
    rng = np.random.default_rng(2)
    slopes = []
    for vertex in range(TOOTH.n_vertex):
        for side in sides_of((TOOTH.triangles == vertex).any(axis=1)):
            q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
            x = circle(TOOTH.vertices[vertex], q[:, 0], q[:, 1])
            slopes.append(largest_slope(x, side))
    assert len(slopes) > 450
    assert np.quantile(slopes, 0.97) < STEEPEST
    # Where a hollow flank of facets meets another face a kink is left, of 1 % of the force at most.
    step = 2.0 * np.pi * AROUND / 2000
    assert max(slopes) * step < 0.015 * AROUND


def test_the_way_out_is_the_gradient_of_the_depth():
    rng = np.random.default_rng(5)
    edges = np.flatnonzero(SURFACE.turn > np.radians(10.0))
    e = rng.choice(edges, 300)
    ends = TOOTH.vertices[np.stack([SURFACE.lo[e], SURFACE.hi[e]])]
    x = ends[0] + rng.uniform(0, 1, (300, 1)) * (ends[1] - ends[0])
    # Not halfway between two faces, where a hollow flank leaves its kink (below).
    for beside in (SURFACE.forward[e], SURFACE.backward[e]):
        x -= rng.uniform(0.005, 0.025, (300, 1)) * SURFACE.normals[beside]
    h = 1e-6
    checked = 0
    for side in (1, -1):
        depth, out, own = depths(TOOTH, x, side)
        slope = np.zeros_like(x)
        for c in range(3):
            step = np.zeros(3)
            step[c] = h
            up, _, own_up = depths(TOOTH, x + step, side)
            down, _, own_down = depths(TOOTH, x - step, side)
            slope[:, c] = (up - down) / (2.0 * h)
            own &= own_up & own_down & (up != 0.0) & (down != 0.0)
        inside = own & (depth > 1e-3) & (depth < 0.9 * R)
        checked += inside.sum()
        # Central differences of a function with a curvature of 1/r: within h/r where it is smooth.
        miss = np.linalg.norm(slope + out, axis=1)[inside]
        assert np.quantile(miss, 0.95) < 1e-4
    assert checked > 100


@pytest.mark.parametrize("side", [1, -1])
def test_it_is_that_of_the_opened_solid(side):
    blade = straight_blade()
    rng = np.random.default_rng(8)
    kept = side * blade.flank >= 0
    points, normals = blade.vertices[blade.triangles[kept, 0]], blade.triangle_normals[kept]
    corner = rng.choice(blade.vertices[np.abs(blade.vertices[:, 1]) > 0.1], 200)
    centre = blade.vertices.mean(axis=0)
    x = corner + rng.uniform(0, 0.06, (200, 3)) * np.sign(centre - corner)
    depth, out, own = depths(blade, x, side)
    felt = own & (depth != 0.0)
    rounded = 0
    for k in np.flatnonzero(felt):
        wanted, way = naive_depth(x[k], (points, normals), R)
        assert depth[k] == pytest.approx(wanted, abs=1e-9 * R)
        if depth[k] < R:
            np.testing.assert_allclose(out[k], way, atol=1e-7)
            rounded += np.abs(normals @ way).max() < 1.0 - 1e-6
    assert rounded > 20


def test_a_lip_of_a_corner_is_lost_as_the_closed_form_says():
    cube = box((-0.5,) * 3, (0.5,) * 3)
    # Along the diagonal of an edge, and of a corner: r (1/cos 45 deg - 1), r (sqrt 3 - 1).
    for n, lip in ((2, np.sqrt(2.0) - 1.0), (3, np.sqrt(3.0) - 1.0)):
        way = np.array([1.0] * n + [0.0] * (3 - n)) / np.sqrt(n)
        start = np.array([0.5] * n + [0.1] * (3 - n))
        depth, out, _ = depths(cube, np.array([start - (lip * R + 0.01) * way]), 0)
        assert depth[0] == pytest.approx(0.01, abs=1e-12)
        np.testing.assert_allclose(out[0], way, atol=1e-12)


@pytest.mark.parametrize("depth", [0.004, 0.02, R, 0.2])
def test_a_round_bar_of_facets_stays_round(depth):
    """Its depth is at most a facet's sagitta below, a lip above; the way out leans by half a turn.

    The facets of 5° are those of the oscillating cut.
    """
    n, radius, half = 72, 3.0, np.pi / 72
    bar = round_bar(diameter=2.0 * radius, tilt_deg=0.0, n_around=n)
    angle = np.linspace(0.0, 2.0 * np.pi, 2881)
    outward = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    for z in (0.0, 0.37, -2.2):
        x = (radius - depth) * outward + [-radius, 0.0, z]
        found, out, _ = depths(bar, x, 0)
        assert (found < depth + 1e-9).all()
        assert (found > depth - radius * (1.0 - np.cos(half)) - 1e-9).all()
        assert np.einsum("ij,ij->i", out, outward).min() > np.cos(1.01 * half)
        # The slope along the circle is the sine of the lean.
        way = np.linalg.norm(np.diff(x, axis=0), axis=1)
        assert np.abs(np.diff(found) / way).max() < np.sin(1.01 * half)


@pytest.mark.parametrize("side", [0, 1, -1])
def test_no_face_that_is_tried_first_changes_the_depth(side):
    rng = np.random.default_rng(8)
    corners = TOOTH.vertices[TOOTH.triangles]
    weights = rng.dirichlet(np.ones(3), 4000)
    on = rng.integers(0, TOOTH.n_triangle, 4000)
    x = (corners[on] * weights[:, :, None]).sum(axis=1)
    x -= rng.uniform(0.0, R, (4000, 1)) * TOOTH.triangle_normals[on]
    found = np.full(4000, -1)
    depth, out, _ = depths(TOOTH, x, side, across=found)
    assert (found >= 0).sum() > 50
    near = (on + rng.integers(-6, 7, (20, 4000))) % TOOTH.n_triangle  # most of them beside it
    for tried in (found.copy(), *near):
        again, way, _ = depths(TOOTH, x, side, across=tried)
        np.testing.assert_allclose(again, depth, rtol=0.0, atol=1e-9 * R)
        np.testing.assert_allclose(way, out, rtol=0.0, atol=1e-6)
