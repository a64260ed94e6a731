"""Contact force of one node by brute force over all triangles of the tool."""

import numpy as np
import scipy


def closest_point(p, corners):
    """Closest point of a triangle to p: its plane if the foot lies inside, else its edges."""
    a, b, c = corners
    normal = np.cross(b - a, c - a)
    foot = p - ((p - a) @ normal) / (normal @ normal) * normal
    if all(np.cross(v - u, foot - u) @ normal >= 0 for u, v in ((a, b), (b, c), (c, a))):
        return foot
    candidates = []
    for u, v in ((a, b), (b, c), (c, a)):
        s = np.clip((p - u) @ (v - u) / ((v - u) @ (v - u)), 0.0, 1.0)
        candidates.append(u + s * (v - u))
    return min(candidates, key=lambda q: np.linalg.norm(p - q))


def distances(points, tool):
    """Distances (n_point, n_triangle) by projection on the plane, else on the three edges."""
    a, b, c = (tool.vertices[tool.triangles[:, k]] for k in range(3))
    p = points[:, None, :]
    squared = np.full((len(points), tool.n_triangle), np.inf)
    for u, v in ((a, b), (b, c), (c, a)):
        along = v - u
        s = np.clip(((p - u) * along).sum(-1) / (along * along).sum(-1), 0.0, 1.0)
        squared = np.minimum(squared, ((p - u - s[..., None] * along) ** 2).sum(-1))
    normal = tool.triangle_normals
    height = ((p - a) * normal).sum(-1)
    foot = p - height[..., None] * normal
    over = np.ones_like(squared, dtype=bool)
    for u, v in ((a, b), (b, c), (c, a)):
        over &= ((foot - u) * np.cross(normal, v - u)).sum(-1) >= 0.0
    return np.where(over, np.abs(height), np.sqrt(squared))


def winding_number(points, tool):
    """1 inside, 0 outside: solid angle of the surface over 4 pi (van Oosterom & Strackee 1983)."""
    a, b, c = (tool.vertices[tool.triangles[:, k]] - points[..., None, :] for k in range(3))
    la, lb, lc = (np.linalg.norm(r, axis=-1) for r in (a, b, c))
    volume = (a * np.cross(b, c)).sum(-1)
    below = la * lb * lc
    below += (a * b).sum(-1) * lc + (b * c).sum(-1) * la + (c * a).sum(-1) * lb
    return np.arctan2(volume, below).sum(axis=-1) / (2.0 * np.pi)


def smoothed(g, g_m):
    """f(g) of [Frangi2010] 5.2."""
    return (g / g_m) ** 3 * (3 * g_m - 2 * g) if g < g_m else g


def smoothed_integral(g, g_m):
    """The integral of f from 0 to g."""
    if g < g_m:
        r = g / g_m
        return g_m * g_m * r**4 * (0.75 - 0.4 * r)
    return 0.35 * g_m * g_m + 0.5 * (g * g - g_m * g_m)


def energy_after_a_jump(p, depth, place, offset, fades_over, k, g_m):
    """Energy of a node at p in the tool that got an offset at a place, and that offset at p."""
    now = offset * np.exp(-0.5 * np.sum((p - place) ** 2) / fades_over**2)
    return k * smoothed_integral(max(depth - now, 0.0), g_m), now


def shortest_step(normals, needed):
    """The least w with normals @ w >= needed, by least squares (Lawson & Hanson 1974, 23.4)."""
    rows = np.vstack([normals.T, needed])
    u, _ = scipy.optimize.nnls(rows, np.append(np.zeros(3), 1.0))
    rest = rows @ u - np.append(np.zeros(3), 1.0)
    return -rest[:3] / rest[3]


def rounded_depth(p, planes, radius):
    """Depth below planes (points, normals) of a convex solid opened by a ball, and direction."""
    points, normals = planes
    depths = ((points - p) * normals).sum(axis=1)
    if depths.min() >= radius:
        return depths.min(), normals[depths.argmin()]
    w = shortest_step(normals, radius - depths)
    return radius - np.linalg.norm(w), w / np.linalg.norm(w)


def node_force(x, tool, pose, side, area, penalty, g_m, radius=0.0, share=1.0):
    """What a node at x may feel: (force [N], depth [mm], tooth), one for each closest triangle.

    The edges of the tool, a convex tool, are rounded with a radius if that is given.

    Where the closest point lies on an edge or corner, any of the triangles there will do. Outside
    the tool there is one answer: no force, and no tooth. The ``share`` of a node's stiffness is
    less than one beside a cut through quads.
    """
    p = pose.rotation.T @ (x - pose.translation)
    if winding_number(p, tool) < 0.5:
        return [(np.zeros(3), 0.0, None)]
    allowed = [k for k in range(tool.n_triangle) if side * tool.flank[k] >= 0]
    places = {k: closest_point(p, tool.vertices[tool.triangles[k]]) for k in allowed}
    distance = {k: np.linalg.norm(p - q) for k, q in places.items()}
    least = min(distance.values())
    answers = []
    for k in allowed:
        if distance[k] < least + 1e-12:
            normal = tool.triangle_normals[k]
            depth = (places[k] - p) @ normal
            if radius:
                planes = tool.vertices[tool.triangles[allowed, 0]], tool.triangle_normals[allowed]
                depth, normal = rounded_depth(p, planes, radius)
            size = share * penalty * area * smoothed(max(depth, 0.0), g_m)
            answers.append((size * (pose.rotation @ normal), depth, int(tool.triangle_tooth[k])))
    return answers
