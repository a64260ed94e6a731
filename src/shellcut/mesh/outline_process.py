"""Mesh an outline with Gmsh, in a process of its own: ``outline_process.py LOOPS OUT``.

:mod:`shellcut.mesh.outline` starts the process, gives the loops of nodes, ``loop_0``, ``loop_1``
..., and the ``size``, and reads the answer: ``nodes``, shape (n, 2), ``quads``, ``n_triangle`` that
are left, and the nodes of each loop, ``rim_0``, ... This file imports nothing of shellcut, so that
it starts at once.
"""

from __future__ import annotations

import sys
from typing import Any

_ALGORITHMS = (6, 5, 8)  # frontal-Delaunay, Delaunay, frontal for quads: tried if triangles remain
_OPTIONS = {
    "General.Terminal": 0,
    "General.NumThreads": 1,
    "Mesh.RecombineAll": 1,
    "Mesh.RecombinationAlgorithm": 1,  # Blossom
    "Mesh.MeshSizeExtendFromBoundary": 1,
    "Mesh.MeshSizeFromPoints": 1,
    "Mesh.ElementOrder": 1,
    "Mesh.RandomSeed": 1,
}


def main(given: str, out: str) -> None:
    """Mesh the loops and write the answer."""
    import gmsh
    import numpy as np

    with np.load(given) as held:
        loops = [held[f"loop_{k}"] for k in range(len(held) - 1)]
        size = float(held["size"])
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    for name, value in _OPTIONS.items():
        gmsh.option.setNumber(name, value)
    answer: dict[str, Any] = {}
    for algorithm in _ALGORITHMS:
        answer = _meshed(gmsh, loops, size, algorithm)
        if not answer["n_triangle"]:
            break
    gmsh.finalize()
    np.savez(out, **answer)


def _meshed(gmsh: Any, loops: list[Any], size: float, algorithm: int) -> dict[str, Any]:
    import numpy as np

    gmsh.clear()
    gmsh.option.setNumber("Mesh.Algorithm", algorithm)
    geo = gmsh.model.geo
    curve_loops, point_tags = [], []
    for loop in loops:
        points = [geo.addPoint(x, y, 0.0, size) for x, y in loop.tolist()]
        lines = [geo.addLine(p, q) for p, q in zip(points, points[1:] + points[:1], strict=True)]
        for line in lines:
            geo.mesh.setTransfiniteCurve(line, 2)
        curve_loops.append(geo.addCurveLoop(lines))
        point_tags.append(points)
    geo.addPlaneSurface(curve_loops)
    geo.synchronize()
    gmsh.model.mesh.generate(2)
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    row = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    row[tags.astype(np.int64)] = np.arange(len(tags))
    corners = {3: np.empty((0, 4), np.int64), 2: np.empty((0, 3), np.int64)}
    kinds, _, node_tags = gmsh.model.mesh.getElements(2)
    for kind, members in zip(kinds, node_tags, strict=True):
        corners[int(kind)] = row[members.astype(np.int64)].reshape(-1, 4 if kind == 3 else 3)
    rims = {
        f"rim_{k}": np.array([row[int(gmsh.model.mesh.getNodes(0, p)[0][0])] for p in points])
        for k, points in enumerate(point_tags)
    }
    nodes = xyz.reshape(-1, 3)[:, :2]
    return {"nodes": nodes, "quads": corners[3], "n_triangle": len(corners[2]), **rims}


if __name__ == "__main__":
    main(*sys.argv[1:])
