"""A film known beforehand, for every reader: two rectangles of 3 x 2 and 2 x 2 quads, side by side.

0 <= x <= 5, 0 <= y <= 2, quads of side 1 mm. Node sets "left" (x = 0) and "corner" (0, 0); quad
sets "film" (all) and "right part" (x > 3).
"""

import numpy as np

GRID = np.arange(18).reshape(3, 6)  # [y, x]
NODES = np.array([[float(i % 6), float(i // 6), 0.0] for i in range(18)])
QUADS = np.stack([GRID[:-1, :-1], GRID[:-1, 1:], GRID[1:, 1:], GRID[1:, :-1]], -1).reshape(-1, 4)
LEFT = GRID[:, 0]
RIGHT_PART = np.flatnonzero(NODES[QUADS].mean(axis=1)[:, 0] > 3.0)

# to a gap in the ids and another order than that of the array
NODE_ID = 10 + 7 * ((5 * np.arange(18)) % 18)
QUAD_ID = 1000 - 3 * np.arange(10)


def rows_in(mesh, points):
    """The node of the mesh at each of the points."""
    distance = np.linalg.norm(mesh.nodes[None] - np.asarray(points)[:, None], axis=2)
    assert distance.min(axis=1).max() < 1e-8  # Gmsh's own nodes are off by 4e-12
    return distance.argmin(axis=1)


def cycles(quads):
    """Quads by their corners, from the smallest on: the same for the same quad and sense."""
    return {tuple(np.roll(q, -int(np.argmin(q))).tolist()) for q in np.asarray(quads)}


def check_geometry(mesh, scale=1.0):
    """The nodes and quads are those known, all running counter-clockwise or all clockwise."""
    assert (mesh.n_node, mesh.n_quad) == (18, 10)
    row = rows_in(mesh, NODES * scale)
    known = row[QUADS]
    assert cycles(mesh.quads) in (cycles(known), cycles(known[:, ::-1]))
    return row


def check_film(mesh, scale=1.0, left="left", right_part="right part"):
    row = check_geometry(mesh, scale)
    assert set(mesh.node_set(left).tolist()) == set(row[LEFT].tolist())
    right = {frozenset(q) for q in mesh.quads[mesh.quad_set(right_part)].tolist()}
    assert right == {frozenset(q) for q in row[QUADS[RIGHT_PART]].tolist()}
    return row
