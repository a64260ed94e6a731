"""A film known beforehand, for every reader: two rectangles of 3 x 2 and 2 x 2 quads, side by side.

0 <= x <= 5, 0 <= y <= 2, quads of side 1 mm. Node sets "left" (x = 0) and "corner" (0, 0); quad
sets "film" (all) and "right part" (x > 3).
"""

import numpy as np
import pytest

from shellcut.formats.errors import FileError
from shellcut.mesh.film_file import read_film

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


def film_of_text(path, text, **options):
    path.write_text(text)
    return read_film(path, **{"unit": "mm", **options})


def refusal_of_text(path, text, **options):
    with pytest.raises(FileError) as caught:
        film_of_text(path, text, **options)
    return str(caught.value)


def moebius_strip(n):
    """Nodes and quads of a strip of n quads with one side."""
    angle = 2.0 * np.pi * np.arange(n) / n
    out = np.stack([np.cos(angle), np.sin(angle), 0.0 * angle], axis=1)
    side = 0.5 * (np.cos(angle / 2)[:, None] * out + np.sin(angle / 2)[:, None] * [0.0, 0.0, 1.0])
    low, high = np.arange(n), n + np.arange(n)
    low_end, high_end = np.append(low[1:], high[0]), np.append(high[1:], low[0])
    nodes = np.concatenate([5.0 * out - side, 5.0 * out + side])
    return nodes, np.stack([low, low_end, high_end, high], axis=1)


def write_deck(path, mesh):
    """Write a mesh and its sets as an Abaqus deck."""
    lines = ["*NODE", *(f"{k}, {x}, {y}, {z}" for k, (x, y, z) in enumerate(mesh.nodes, 1))]
    lines.append("*ELEMENT, TYPE=S4R")
    lines += [f"{k}, {', '.join(map(str, quad + 1))}" for k, quad in enumerate(mesh.quads, 1)]
    for kind, sets in (("NSET", mesh.node_sets), ("ELSET", mesh.quad_sets)):
        for name, ids in sets.items():
            lines += [f"*{kind}, {kind}={name}", *(f"{n + 1}," for n in ids)]
    path.write_text("\n".join(lines) + "\n")
