"""Split triangles into quads, from the centre of each cell to the midpoints of its edges.

A triangle gives three quads and a quad four. All cells are split, so that neighbours share the
midpoints of their edges and the mesh stays conforming.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats, Ints, product


@dataclass(frozen=True)
class QuadSplit:
    """A mesh of quads and its relation to the cells before the split.

    Nodes keep their numbers; the midpoints of edges follow, then the centres of cells.
    """

    nodes: Floats
    """Shape (n_new_node, 3)."""
    quads: Ints
    """Shape (n_quad, 4), with the orientation of their cells."""
    parent: Ints
    """Cell of each quad, shape (n_quad,): quads first, then triangles, in the given order."""
    edge_ends: Ints
    """Ends of the old mesh's edges, lower id first, sorted, shape (n_edge, 2)."""
    edge_n_cell: Ints
    """Number of cells on each, shape (n_edge,)."""
    cells: tuple[Ints, Ints]
    """The quads and triangles that were split."""
    n_node: int
    """Number of old nodes."""

    def with_middles(self, members: Ints) -> Ints:
        """Return a set of nodes extended by the new nodes between them.

        An edge's midpoint joins if both ends are members, a cell's centre if all corners are. For a
        set that lies on the boundary only, just boundary edges count: a cell in a corner has all
        its nodes on the boundary, but its inner edges and centre lie inside.
        """
        within = np.zeros(self.n_node, dtype=np.bool_)
        within[members] = True
        rim = self.edge_n_cell == 1
        edges = within[self.edge_ends].all(axis=1)
        on_rim = np.zeros(self.n_node, dtype=np.bool_)
        on_rim[self.edge_ends[rim]] = True
        if on_rim[members].all():
            return np.concatenate([members, self.n_node + np.flatnonzero(edges & rim)])
        first = self.n_node + len(self.edge_ends)
        centres = np.concatenate([within[cells].all(axis=1) for cells in self.cells])
        middles = self.n_node + np.flatnonzero(edges)
        return np.concatenate([members, middles, first + np.flatnonzero(centres)])

    def middles(self, lines: Ints) -> Ints:
        """Return the midpoints of those lines, shape (n_line, 2), that are edges of the mesh."""
        ordered = np.sort(lines, axis=1)
        key = product(ordered, np.array([self.n_node, 1]))
        keys = product(self.edge_ends, np.array([self.n_node, 1]))
        found: Ints = np.flatnonzero(np.isin(keys, key)) + self.n_node
        return found


def split_in_quads(nodes: Floats, quads: Ints, triangles: Ints) -> QuadSplit:
    """Return the mesh with each cell split into quads.

    Examples
    --------
    >>> nodes = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]])
    >>> split = split_in_quads(nodes, np.array([[0, 1, 2, 3]]), np.array([[1, 4, 2]]))
    >>> len(split.nodes), split.parent.tolist()
    (13, [0, 0, 0, 0, 1, 1, 1])
    """
    n_node = len(nodes)
    start = np.concatenate([quads.ravel(), triangles.ravel()])
    following = (np.roll(cells, -1, axis=1).ravel() for cells in (quads, triangles))
    end = np.concatenate(list(following))
    keys, edge, n_cell = np.unique(
        np.minimum(start, end) * n_node + np.maximum(start, end),
        return_inverse=True,
        return_counts=True,
    )
    ends = np.stack([keys // n_node, keys % n_node], axis=1)
    centres = [nodes[cells].mean(axis=1) for cells in (quads, triangles)]
    new_quads, parent = [], []
    first_side = first_cell = 0
    for cells in (quads, triangles):
        n, k = cells.shape
        middle = n_node + edge[first_side : first_side + n * k].reshape(n, k)
        cell = first_cell + np.arange(n)
        centre = np.broadcast_to((n_node + len(keys) + cell)[:, None], (n, k))
        corners = (cells, middle, centre, np.roll(middle, 1, axis=1))
        new_quads.append(np.stack(corners, axis=-1).reshape(-1, 4))
        parent.append(np.repeat(cell, k))
        first_side += n * k
        first_cell += n
    return QuadSplit(
        nodes=np.concatenate([nodes, nodes[ends].mean(axis=1), *centres]),
        quads=np.concatenate(new_quads).astype(np.int64),
        parent=np.concatenate(parent),
        edge_ends=ends,
        edge_n_cell=n_cell.astype(np.int64),
        cells=(quads, triangles),
        n_node=n_node,
    )
