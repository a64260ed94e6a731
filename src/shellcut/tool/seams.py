"""Close the seams between faces of a CAD surface that were triangulated apart.

Neighbouring faces follow their common edge within the file's tolerance, but may put vertices on it
at different places. Each vertex on one side is put into the edge of the other side as well: no
vertex moves, and thin gaps close. Wider ones stay for the checks of the tool.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
import scipy

from shellcut.arrays import Floats, Ints, norm, product

from .surface import merge_vertices

_MOST_ROUNDS = 6  # a triangle with several open edges takes a round for each; then few are left

Edge = tuple[int, int]


def closed_seams(
    vertices: Floats, triangles: Ints, *, merge: float, reach: float
) -> tuple[Floats, Ints, int]:
    """Return the surface with vertices of either side in both sides of each seam, and how many.

    Vertices closer than ``merge`` become one, those farther than ``reach`` from an edge are not put
    into it [mm].
    """
    vertices, triangles, _ = merge_vertices(vertices, triangles, None, merge)
    collapsed = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    triangles = triangles[~collapsed]
    n_put = 0
    for _ in range(_MOST_ROUNDS):
        triangles, n = _round(vertices, triangles, reach)
        n_put += n
        if not n:
            break
    return vertices, triangles, n_put


def _round(vertices: Floats, triangles: Ints, reach: float) -> tuple[Ints, int]:
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    key = product(np.sort(sides, axis=1), np.array([len(vertices), 1]))
    _, first, uses = np.unique(key, return_index=True, return_counts=True)
    alone = first[uses == 1]
    if not len(alone):
        return triangles, 0
    rim = np.unique(sides[alone])
    tree = scipy.spatial.cKDTree(vertices[rim])
    fans: dict[int, list[list[int]]] = {}
    n_put = 0
    for side in alone.tolist():
        t, corner = side % len(triangles), side // len(triangles)
        if t in fans:
            continue
        a, b, c = np.roll(triangles[t], -corner).tolist()
        half = 0.5 * float(norm(vertices[b] - vertices[a]))
        near = tree.query_ball_point(0.5 * (vertices[a] + vertices[b]), half + reach)
        between = _between(vertices, (a, b), [int(v) for v in rim[near] if v != c], reach)
        if between:
            row = [a, *between, b]
            fans[t] = [[p, q, c] for p, q in pairwise(row)]
            n_put += len(between)
    kept = np.ones(len(triangles), dtype=bool)
    kept[list(fans)] = False
    new = np.array([row for rows in fans.values() for row in rows], dtype=np.int64)
    return np.concatenate([triangles[kept], new.reshape(-1, 3)]), n_put


def _between(vertices: Floats, edge: Edge, candidates: list[int], reach: float) -> list[int]:
    # the candidates beside the inside of an edge, in order along it
    start, along = vertices[edge[0]], vertices[edge[1]] - vertices[edge[0]]
    others = np.array([v for v in candidates if v not in edge], dtype=np.int64)
    if not len(others):
        return []
    away = vertices[others] - start
    share = product(away, along) / (product(along, along))
    off = np.linalg.norm(away - share[:, None] * along, axis=1)
    fits = (share > 0.0) & (share < 1.0) & (off <= reach)
    return [int(v) for v in others[fits][np.argsort(share[fits], kind="stable")]]
