"""How much deeper than its chord an edge of the film goes into a convex tool, by search."""

import numpy as np

from naive.contact import rounded_depth


def depth_at(p, tool, radius):
    """Depth of p below the rounded surface of a convex tool, negative outside, and the way out."""
    return rounded_depth(p, (tool.vertices[tool.triangles[:, 0]], tool.triangle_normals), radius)


def deepest_on_edge(a, b, tool, radius, n=41):
    """g and its place s, on ever finer grids: along the edge the depth is concave."""
    deep_a, deep_b = (max(depth_at(p, tool, radius)[0], 0.0) for p in (a, b))

    def more(s):
        depth = depth_at((1.0 - s) * a + s * b, tool, radius)[0]
        return depth - (1.0 - s) * deep_a - s * deep_b

    low, high, best = 0.0, 1.0, (-np.inf, 0.0)
    for _ in range(6):
        tried = np.linspace(low, high, n)
        found = [more(s) for s in tried]
        k = int(np.argmax(found))
        best = max(best, (found[k], tried[k]))
        low, high = max(tried[k] - (high - low) / n, 0.0), min(tried[k] + (high - low) / n, 1.0)
    return max(best[0], 0.0), best[1]
