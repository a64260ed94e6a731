"""Bodies without cutting edges: boxes, prisms, a cone, a spike and balls."""

import numpy as np

from shellcut import Tool

_SIDES = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
BOX_FACES = np.array([half for a, b, c, d in _SIDES for half in ((a, b, c), (a, c, d))])
"""Triangles of a box on the corners of :func:`box_corners`."""


def blunt(vertices, triangles):
    """Return a tool of which no edge cuts."""
    return Tool.from_triangles(vertices, triangles, edges="none")


def box_corners(low, high):
    """Return the corners of a box, (8, 3), z running fastest."""
    return np.array(np.meshgrid(*zip(low, high, strict=True), indexing="ij"), float).reshape(3, 8).T


def box(low, high):
    return blunt(box_corners(low, high), BOX_FACES)


def prism(section, low, high):
    """Return vertices and triangles over a convex section, (n, 2), counter-clockwise."""
    section = np.asarray(section, float)
    n = len(section)
    vertices = np.vstack([np.column_stack([section, np.full(n, z)]) for z in (low, high)])
    triangles = []
    for i in range(n):
        j = (i + 1) % n
        triangles += [(i, j, n + j), (i, n + j, n + i)]
    for i in range(1, n - 1):
        triangles += [(0, i + 1, i), (n, n + i, n + i + 1)]
    return vertices, np.array(triangles)


def needle(radius=0.5, height=2.0, n=12):
    """Return a cone with its tip, at the origin, down."""
    angle = 2.0 * np.pi * np.arange(n) / n
    rim = np.column_stack([radius * np.cos(angle), radius * np.sin(angle), np.full(n, height)])
    vertices = np.vstack([[0.0, 0.0, 0.0], rim, [0.0, 0.0, height]])
    after = (np.arange(n) + 1) % n
    sides = [(0, 1 + j, 1 + k) for k, j in enumerate(after)]
    top = [(n + 1, 1 + k, 1 + j) for k, j in enumerate(after)]
    return blunt(vertices, sides + top)


def spike():
    """Return a slender tetrahedron with its tip, at the origin, down."""
    vertices = [[0.0, 0.0, 0.0], [0.5, 0.0, 2.0], [-0.3, 0.4, 2.0], [-0.3, -0.4, 2.0]]
    return blunt(vertices, [[0, 2, 1], [0, 3, 2], [0, 1, 3], [1, 2, 3]])


def ball(radius, halvings):
    """Return an octahedron with its triangles halved, on a sphere about the origin."""
    v = [(1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)]
    t = [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)]
    vertices, triangles = np.array(v, float), np.array(t)
    for _ in range(halvings):
        a, b, c = (vertices[triangles[:, k]] for k in range(3))
        k = len(vertices) + np.arange(6 * len(triangles)).reshape(6, -1)
        vertices = np.vstack([vertices, a, b, c, a + b, b + c, c + a])
        vertices /= np.linalg.norm(vertices, axis=1, keepdims=True)
        four = ((0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5))
        triangles = np.vstack([np.column_stack([k[i] for i in one]) for one in four])
    return blunt(radius * vertices, triangles)
