"""Adjacency and geometry of quads: sides, normals, angles, areas, shapes, mean directors.

X are positions, quads their corner node ids; corners are numbered as in :mod:`shellcut.mesh`.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, norm, product, unit
from shellcut.numerics.connected_parts import close_parts

_FLAT = 1e-12  # directors this close to their mean are set to it: round-off of a plane mesh

_OFF_PLANE = 1e-6  # relative to the film's size: it is flat if its nodes are closer to a plane

_COINCIDENT = 1e-9  # relative to the film's size: nodes closer than this are at one place


class QuadSides:
    """The sides of quads, grouped where two quads share one.

    The sides of group k, whose ends are ``nodes[k]``, belong to
    ``quads[start[k] : start[k] + n_quad[k]]``.
    """

    def __init__(self, quads: Ints, n_node: int, ids: Ints) -> None:
        tail = quads[ids]
        head = np.roll(tail, -1, axis=1)
        keys = (np.minimum(tail, head) * n_node + np.maximum(tail, head)).ravel()
        order = np.argsort(keys, kind="stable")
        sides = np.unique(keys[order], return_index=True, return_counts=True)
        keys, self.start, self.n_quad = sides
        self.quads = ids[order // 4]
        self.nodes = np.stack([keys // n_node, keys % n_node], axis=1)
        self._forward = (tail < head).ravel()[order]  # the side runs from lower to higher id

    def neighbours(self) -> tuple[Ints, Ints, Bools]:
        """Return the two quads of every inner side, and whether they have the same orientation."""
        start = self.start[self.n_quad == 2]
        turning_alike = self._forward[start] != self._forward[start + 1]
        return self.quads[start], self.quads[start + 1], turning_alike


def first_at_place(X: Floats, nodes: Ints, reach: float | None = None) -> Ints:
    """Return for every node the first of some nodes at its place, or within ``reach``; itself."""
    points = X[nodes]
    if reach is None:
        reach = _COINCIDENT * float(np.ptp(points if len(points) else X, axis=0).max())
    spot = close_parts(points, reach)
    _, first = np.unique(spot, return_index=True)
    place = np.arange(len(X))
    place[nodes] = nodes[first[spot]]
    return place


def corner_vectors(X: Floats, quads: Ints, a: int) -> tuple[Floats, Floats]:
    """Return the vectors p and q along the sides at corner ``a`` of every quad."""
    at = X[quads[:, a]]
    return X[quads[:, (a + 1) % 4]] - at, X[quads[:, (a + 3) % 4]] - at


def quad_vectors(X: Floats, quads: Ints) -> Floats:
    """Return the vector areas [mm²] of every quad or polygon, along the mean normals."""
    x = X[quads]
    vectors = 0.5 * np.cross(x[:, 2] - x[:, 0], x[:, 3] - x[:, 1])  # from the diagonals
    for k in range(4, x.shape[1]):  # of polygons with more corners
        vectors += 0.5 * np.cross(x[:, k - 1] - x[:, 0], x[:, k] - x[:, 0])
    return np.asarray(vectors)


def edge_lengths(X: Floats, quads: Ints) -> Floats:
    """Return the side lengths of every quad, from corner a to a+1."""
    sides = (X[quads[:, (a + 1) % 4]] - X[quads[:, a]] for a in range(4))
    return np.stack([norm(side) for side in sides], axis=1)


def scaled_jacobian(X: Floats, quads: Ints) -> Floats:
    """Return the smallest scaled Jacobian of every quad; see :meth:`Mesh.scaled_jacobian`."""
    normals = unit(quad_vectors(X, quads))
    least = np.ones(len(quads))
    for a in range(4):
        p, q = corner_vectors(X, quads, a)
        jacobian = np.einsum("ij,ij->i", np.cross(p, q), normals)
        lengths = norm(p) * norm(q)
        scaled = np.divide(jacobian, lengths, out=np.zeros(len(quads)), where=lengths > 0.0)
        np.minimum(least, scaled, out=least)
    return least


def mean_directors(X: Floats, quads: Ints) -> Floats:
    """Return the area-weighted mean of the corner normals at every node, of unit length."""
    # |p × q| is twice the area of the corner's triangle: the plain sum is area-weighted
    sums = np.zeros_like(X)
    for a in range(4):
        vectors = np.cross(*corner_vectors(X, quads, a))
        for i in range(3):
            sums[:, i] += np.bincount(quads[:, a], weights=vectors[:, i], minlength=len(X))
    T = unit(sums)
    mean = unit(T.mean(axis=0, keepdims=True))
    if np.abs(T - mean).max() < _FLAT:
        T[:] = unit(np.where(np.abs(mean) < _FLAT, 0.0, mean))
    T += 0.0  # no negative zeros
    return T


def corner_normals(corners: Floats) -> Floats:
    """Return the unit normals of quads by their diagonals, corners : (..., 4, 3)."""
    first, second = corners[..., 2, :] - corners[..., 0, :], corners[..., 3, :] - corners[..., 1, :]
    return unit(np.cross(first, second))


def plane_normal(nodes: Floats, quads: Ints) -> Floats | None:
    """Return the unit normal of a flat film, on the side of its quads; None of any other."""
    normal = unit(corner_normals(nodes[quads]).mean(axis=0))
    off = float(np.ptp(product(nodes, normal)))
    flat = normal.any() and off <= _OFF_PLANE * norm(np.ptp(nodes, axis=0))
    return normal if flat else None
