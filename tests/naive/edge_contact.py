"""How much deeper than its chord an edge of the film goes into a convex tool, by search."""

import numpy as np

from naive.contact import rounded_depth, smoothed

_PLACES, _WEIGHTS = np.polynomial.legendre.leggauss(4)


def depth_at(p, tool, radius):
    """Depth of p below the rounded surface of a convex tool, negative outside, and the way out."""
    return rounded_depth(p, (tool.vertices[tool.triangles[:, 0]], tool.triangle_normals), radius)


def deepest_on_edge(a, b, tool, radius, n=9):
    """g and its place s, on ever finer grids: along the edge the depth is concave."""
    deep_a, deep_b = (max(depth_at(p, tool, radius)[0], 0.0) for p in (a, b))

    def more(s):
        depth = depth_at((1.0 - s) * a + s * b, tool, radius)[0]
        return depth - (1.0 - s) * deep_a - s * deep_b

    low, high, best = 0.0, 1.0, (-np.inf, 0.0)
    for _ in range(12):
        tried = np.linspace(low, high, n)
        found = [more(s) for s in tried]
        k = int(np.argmax(found))
        best = max(best, (found[k], tried[k]))
        low, high = tried[max(k - 1, 0)], tried[min(k + 1, n - 1)]
    return max(best[0], 0.0), best[1]


def press_of_edge(a, b, tool, radius, g_m):
    """Energy over k where it is most above that of the ends, the place s, and the energy's slopes.

    The slopes f(D) at s, at a and at b, the latter two with the shares that they are taken with.
    """
    deep_a, deep_b = (max(depth_at(p, tool, radius)[0], 0.0) for p in (a, b))
    of_a, of_b = smoothed_integral(deep_a, g_m), smoothed_integral(deep_b, g_m)

    def more(s):
        depth = max(depth_at((1.0 - s) * a + s * b, tool, radius)[0], 0.0)
        return smoothed_integral(depth, g_m) - (1.0 - s) * of_a - s * of_b

    # The hill may be narrow, but the place that is deepest beside the chord lies on it.
    near = deepest_on_edge(a, b, tool, radius)[1]
    around = np.geomspace(1e-6, 1.0, 25)
    tried = np.concatenate([np.linspace(0.0, 1.0, 25), near + around, near - around, [near]])
    tried, best = np.unique(np.clip(tried, 0.0, 1.0)), (0.0, 0.0)
    for _ in range(13):
        found = [more(s) for s in tried]
        k = int(np.argmax(found))
        best = max(best, (found[k], tried[k]))
        tried = np.linspace(tried[max(k - 1, 0)], tried[min(k + 1, len(tried) - 1)], 9)
    s = best[1]
    deep = max(depth_at((1.0 - s) * a + s * b, tool, radius)[0], 0.0)
    slopes = smoothed(deep, g_m), (1.0 - s) * smoothed(deep_a, g_m), s * smoothed(deep_b, g_m)
    return *best, slopes


def smoothed_integral(g, g_m):
    """The integral of f from 0, by Gauss points: a polynomial of third degree."""
    if g > g_m:
        return smoothed_integral(g_m, g_m) + 0.5 * (g * g - g_m * g_m)
    return 0.5 * g * sum(_WEIGHTS * [smoothed(0.5 * g * (1.0 + v), g_m) for v in _PLACES])
