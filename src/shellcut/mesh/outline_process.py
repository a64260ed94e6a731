"""Mesh an outline with Gmsh, in a process of its own: ``outline_process.py LOOPS OUT``.

:mod:`shellcut.mesh.outline` starts the process, gives the loops of nodes, ``loop_0``, ``loop_1``
..., the ``size``, and points ``near_0``, ... about which it is ``size_0``, ... up to the distance
``band_0``, ... and rises by ``growth`` from there. It reads the answer: ``nodes``, shape (n, 2),
``quads``, ``n_triangle`` that are left, and the nodes of each loop, ``rim_0``, ... This file
imports nothing of shellcut, so that it starts at once.
"""

from __future__ import annotations

import sys
from typing import Any

import numpy as np

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
_SCALES = (1.0, 1.01, 1.02, 1.03, 1.04, 0.99, 0.98, 0.97)
"""Factors on the size: the mesh whose narrowest quad is widest is taken. That quad sets the time
step of a run, which differs by half between them."""


def main(given: str, out: str) -> None:
    """Mesh the loops and write the answer."""
    import gmsh

    with np.load(given) as file:
        content = dict(file)
    loops = [content[f"loop_{k}"] for k in range(len(content)) if f"loop_{k}" in content]
    gmsh.initialize(readConfigFiles=False, interruptible=False)
    for name, value in _OPTIONS.items():
        gmsh.option.setNumber(name, value)
    answer: dict[str, Any] = {}
    for algorithm in _ALGORITHMS:
        scales = _SCALES if "near_0" in content else (1.0,)
        tries = [_meshed(gmsh, loops, content, algorithm, scale) for scale in scales]
        answer = max(tries, key=_narrowest)
        if not answer["n_triangle"]:
            break
    gmsh.finalize()
    np.savez(out, **answer)


def _narrowest(answer: dict[str, Any]) -> float:
    """Return the least area of a quad over its longest side; with triangles less than 0."""
    if answer["n_triangle"]:
        return -float(answer["n_triangle"])
    x, y = answer["nodes"][answer["quads"]].transpose(2, 1, 0)
    area = 0.5 * abs((x[2] - x[0]) * (y[3] - y[1]) - (x[3] - x[1]) * (y[2] - y[0]))
    side = np.hypot(np.roll(x, -1, axis=0) - x, np.roll(y, -1, axis=0) - y)
    return float((area / side.max(axis=0)).min())


def _meshed(
    gmsh: Any, loops: list[Any], content: dict[str, Any], algorithm: int, scale: float
) -> dict[str, Any]:
    size = float(content["size"])
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
    if "near_0" in content:
        _set_field(gmsh, content, scale, size)
    gmsh.model.mesh.generate(2)
    tags, xyz, _ = gmsh.model.mesh.getNodes()
    row = np.zeros(int(tags.max()) + 1, dtype=np.int64)
    row[tags.astype(np.int64)] = np.arange(len(tags))
    corners = {3: np.empty((0, 4), np.int64), 2: np.empty((0, 3), np.int64)}
    kinds, _, node_tags = gmsh.model.mesh.getElements(2)
    for kind, members in zip(kinds, node_tags, strict=True):
        corners[int(kind)] = row[members.astype(np.int64)].reshape(-1, 4 if kind == 3 else 3)
    corner_ids = {
        f"loop_{k}": np.array([row[int(gmsh.model.mesh.getNodes(0, p)[0][0])] for p in points])
        for k, points in enumerate(point_tags)
    }
    nodes, quads = xyz.reshape(-1, 3)[:, :2], corners[3]
    if "near_0" in content and len(quads):  # without the points of the field
        used, quads = np.unique(quads, return_inverse=True)
        place = np.searchsorted(used, np.arange(len(nodes)))
        corner_ids = {name: place[ids] for name, ids in corner_ids.items()}
        nodes, quads = nodes[used], quads.reshape(-1, 4)
    return {"nodes": nodes, "quads": quads, "n_triangle": len(corners[2]), **corner_ids}


def _set_field(gmsh: Any, content: dict[str, Any], scale: float, size: float) -> None:
    field, growth, rises = gmsh.model.mesh.field, float(content["growth"]), []
    for k in range(sum(name.startswith("near_") for name in content)):
        least, band = scale * float(content[f"size_{k}"]), float(content[f"band_{k}"])
        points = [gmsh.model.geo.addPoint(x, y, 0.0) for x, y in content[f"near_{k}"].tolist()]
        distance, rise = field.add("Distance"), field.add("Threshold")
        field.setNumbers(distance, "PointsList", points)
        field.setNumber(rise, "InField", distance)
        field.setNumber(rise, "SizeMin", least)
        field.setNumber(rise, "SizeMax", size)
        field.setNumber(rise, "DistMin", band)
        field.setNumber(rise, "DistMax", band + (size - least) / growth)
        rises.append(rise)
    gmsh.model.geo.synchronize()
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", rises)
    field.setAsBackgroundMesh(smallest)
    for name in ("Mesh.MeshSizeExtendFromBoundary", "Mesh.MeshSizeFromPoints"):
        gmsh.option.setNumber(name, 0)


if __name__ == "__main__":
    main(*sys.argv[1:])
