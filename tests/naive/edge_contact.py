"""How much deeper than its chord an edge of the film goes into a convex tool, by search."""

import numpy as np

from naive.contact import rounded_depth, winding_number


def depth_at(p, tool, radius):
    """Depth of p below the rounded surface of a convex tool, 0 outside, and the way out."""
    if winding_number(p, tool) < 0.5:
        return 0.0, np.zeros(3)
    planes = tool.vertices[tool.triangles[:, 0]], tool.triangle_normals
    depth, out = rounded_depth(p, planes, radius)
    return max(depth, 0.0), out


def deepest_on_edge(a, b, tool, radius, n=41):
    """g and its place s, on ever finer grids."""
    deep_a, deep_b = depth_at(a, tool, radius)[0], depth_at(b, tool, radius)[0]

    def more(s):
        depth = depth_at((1.0 - s) * a + s * b, tool, radius)[0]
        return depth - (1.0 - s) * deep_a - s * deep_b

    low, high, best = 0.0, 1.0, (0.0, 0.0)
    for _ in range(6):
        tried = np.linspace(low, high, n)
        found = [more(s) for s in tried]
        k = int(np.argmax(found))
        best = max(best, (found[k], tried[k]))
        low, high = max(tried[k] - (high - low) / n, 0.0), min(tried[k] + (high - low) / n, 1.0)
    return best
