"""The flat film in its own plane, with edge lengths and rim, as the imprint needs it.

The directors' side is up, so all quads are counter-clockwise. The rim consists of loops of boundary
edges with the film on their left. It is divided into *pieces*, smooth curves on which nodes may
slide; between them are corners, which may not: nodes where the rim turns sharply, where the
membership in a named set changes, and all nodes of a pre-crack.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.mesh.mesh import Mesh

from .path_curve import PathCurve

FLATNESS = 1e-6
"""Largest deviation of nodes from the plane, relative to the film's size: text has 7 digits."""

CORNER_TURN = np.radians(30.0)
"""At a node where the rim turns by more there is a corner."""


class ImprintError(ValueError):
    """The path cannot be imprinted in this mesh; the message says why and what to do.

    Examples
    --------
    >>> from shellcut import PathCurve, imprint
    >>> from shellcut.mesh.structured import rectangle
    >>> try:
    ...     imprint(rectangle(6.0, 4.0, size=1.0), PathCurve.line((0.0, 9.0), (6.0, 9.0)))
    ... except ImprintError as error:
    ...     print(str(error)[:35])
    the path must run through the film,
    """


@dataclass(frozen=True, eq=False)
class RimPiece:
    """A smooth piece of the rim between two corners, or a whole loop without corners."""

    nodes: Ints
    """In order, the film on the left; a closed piece does not repeat its first node."""
    curve: PathCurve
    """Through the nodes, in the film's plane; node k is at knot k."""


class FilmPlane:
    """A flat mesh in its plane.

    Parameters
    ----------
    mesh : Mesh

    Attributes
    ----------
    x : ndarray, shape (n_node, 2)
        Positions in the plane [mm].
    edge_length : ndarray, shape (n_node,)
        Mean length of the edges at each node [mm].
    boundary : ndarray of bool, shape (n_node,)
        Whether a node is on the rim, including holes and pre-cracks.
    cracked : ndarray of bool, shape (n_node,)
        Nodes of pre-cracks: they have a twin, or are the tip.
    pieces : list of RimPiece
    corner : ndarray of bool, shape (n_node,)
        Rim nodes that do not slide.
    pinned : ndarray of bool, shape (n_node,)
        Inner nodes on the border of a named set, and nodes of pre-cracks.

    Raises
    ------
    ImprintError
        If the film is not flat.
    """

    def __init__(self, mesh: Mesh) -> None:
        self.mesh = mesh
        X = mesh.nodes[mesh.quads]
        normal = np.cross(X[:, 2] - X[:, 0], X[:, 3] - X[:, 1]).sum(axis=0)
        normal /= np.linalg.norm(normal)
        normal[np.abs(normal) < 1e-14] = 0.0
        reference = np.eye(3)[int(np.abs(normal).argmin())]
        first = reference - (reference @ normal) * normal
        first /= np.linalg.norm(first)
        self._axes = np.stack([first, np.cross(normal, first), normal])
        level = mesh.nodes @ normal
        self._level = float(0.5 * (level.min() + level.max()))
        size = float(np.linalg.norm(np.ptp(mesh.nodes, axis=0)))
        off = np.abs(level - self._level)
        if off.max() > FLATNESS * size:
            n = int(off.argmax())
            raise ImprintError(
                f"a path can be put into flat films only, got node {n} {off[n]:.3g} mm off the "
                "plane of the others; mesh the path of a curved film by hand"
            )
        self.x: Floats = np.ascontiguousarray(mesh.nodes @ self._axes[:2].T)
        edges = mesh.edges()
        ends = edges.nodes
        length = np.linalg.norm(self.x[ends[:, 1]] - self.x[ends[:, 0]], axis=1)
        total = np.bincount(ends.ravel(), np.repeat(length, 2), mesh.n_node)
        self.edge_length: Floats = total / np.bincount(ends.ravel(), minlength=mesh.n_node)
        self.boundary: Bools = np.zeros(mesh.n_node, np.bool_)
        self.boundary[ends[edges.n_quad == 1]] = True
        self.cracked = _cracked(mesh)
        self.pieces, self.corner = self._rim()
        self.pinned: Bools = self._borders() | self.cracked

    @property
    def normal(self) -> Floats:
        """Unit normal on the directors' side, shape (3,)."""
        normal: Floats = self._axes[2]
        return normal

    @property
    def level(self) -> float:
        """Distance of the plane from the origin along the normal [mm]."""
        return self._level

    def flatten(self, points: Floats) -> Floats:
        """Return the coordinates in the plane of points in space, shape (n, 2)."""
        return np.asarray(points @ self._axes[:2].T)

    def lift(self, x: Floats) -> Floats:
        """Return the points in space of coordinates in the plane, shape (n, 3)."""
        return np.asarray(x @ self._axes[:2] + self._level * self._axes[2])

    def off_plane(self, points: Floats) -> Floats:
        """Return the heights of points in space over the plane [mm]."""
        return np.asarray(points @ self._axes[2] - self._level)

    def place(self, x: Floats) -> str:
        """Name a point of the plane by its coordinates in space."""
        return "(" + ", ".join(f"{c:.4g}" for c in self.lift(x[None])[0] + 0.0) + ")"

    def _rim(self) -> tuple[list[RimPiece], Bools]:
        quads = self.mesh.quads
        edges = self.mesh.edges()
        rim = edges.n_quad == 1
        # the sides of the quads in their own direction, the film on the left
        tail, head = quads.ravel(), np.roll(quads, -1, axis=1).ravel()
        n = self.mesh.n_node
        keys = np.minimum(tail, head) * n + np.maximum(tail, head)
        single = np.isin(keys, edges.nodes[rim, 0] * n + edges.nodes[rim, 1])
        after = dict(zip(tail[single].tolist(), head[single].tolist(), strict=True))
        corner = self._corners(after)
        pieces = []
        left = dict(after)
        while left:
            first = next((k for k in left if corner[k]), next(iter(left)))
            nodes = [first]
            while True:
                nodes.append(left.pop(nodes[-1]))
                if nodes[-1] == first or corner[nodes[-1]]:
                    break
            closed = nodes[-1] == first and not corner[first]
            points = self.x[nodes]
            if not self.cracked[nodes].all():
                ids = np.array(nodes[:-1] if closed else nodes, dtype=np.int64)
                pieces.append(RimPiece(ids, PathCurve.through(points, closed=closed)))
        return pieces, corner

    def _corners(self, after: dict[int, int]) -> Bools:
        tail = np.array(list(after), dtype=np.int64)
        head = np.array([after[n] for n in tail.tolist()], dtype=np.int64)
        way = self.x[head] - self.x[tail]
        arriving = np.zeros((self.mesh.n_node, 2))
        arriving[head] = way
        before = arriving[tail]
        cross = before[:, 0] * way[:, 1] - before[:, 1] * way[:, 0]
        turn = np.abs(np.arctan2(cross, (before * way).sum(axis=1)))
        corner = self.cracked.copy()
        corner[tail[turn > CORNER_TURN]] = True
        for members in self.mesh.node_sets.values():
            within = self._within(members)
            corner[tail[within[tail] & ~within[head]]] = True
            corner[head[within[head] & ~within[tail]]] = True
        return np.asarray(corner | self._between_quad_sets())

    def _between_quad_sets(self) -> Bools:
        # nodes whose quads differ in the sets they belong to
        mesh = self.mesh
        table = np.zeros((mesh.n_quad, len(mesh.quad_sets) + 1), np.bool_)
        for k, ids in enumerate(mesh.quad_sets.values()):
            table[ids, k] = True
        member = np.unique(table, axis=0, return_inverse=True)[1].reshape(-1)
        low = np.full(mesh.n_node, len(mesh.quads))
        high = np.zeros(mesh.n_node, np.int64)
        np.minimum.at(low, mesh.quads.ravel(), np.repeat(member, 4))
        np.maximum.at(high, mesh.quads.ravel(), np.repeat(member, 4))
        return np.asarray(low != high)

    def _borders(self) -> Bools:
        # inner nodes on the border of a named set: not all their neighbours are in it
        mesh = self.mesh
        border = self._between_quad_sets()
        for members in mesh.node_sets.values():
            within = self._within(members)
            partly = mesh.quads[~within[mesh.quads].all(axis=1)]
            border[partly[within[partly]]] = True
        return np.asarray(border & ~self.boundary)

    def _within(self, members: Ints) -> Bools:
        within = np.zeros(self.mesh.n_node, np.bool_)
        within[members] = True
        return within


def _cracked(mesh: Mesh) -> Bools:
    # nodes with a twin, and the rim neighbours shared by both flanks: the tips
    twins = np.bincount(mesh.origin, minlength=mesh.n_node)[mesh.origin] > 1
    edges = mesh.edges()
    rim = edges.nodes[edges.n_quad == 1]
    ends = mesh.origin[rim]
    keys = ends.min(axis=1) * mesh.n_node + ends.max(axis=1)
    _, back, count = np.unique(keys, return_inverse=True, return_counts=True)
    flank = count[back.reshape(-1)] > 1
    cracked = twins.copy()
    cracked[rim[flank]] = True
    return np.asarray(cracked)
