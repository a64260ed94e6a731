"""Refuse a start with the tool already inside the sheet: the contact would throw it out."""

from __future__ import annotations

import numpy as np

from ._jit import Floats
from .mesh import Mesh
from .tool import Tool
from .tool_grid import ClosestTriangleGrid


def check_tool_outside(mesh: Mesh, tool: Tool, rotation: Floats, translation: Floats) -> None:
    """Raise ValueError if a node lies in the tool or an edge of the tool passes through a quad."""
    body = (mesh.nodes - translation) @ rotation
    grid = ClosestTriangleGrid.build(tool)
    _, inside, _, _ = grid.query(body)
    problems = []
    if inside.any():
        problems.append(f"nodes {_some(np.flatnonzero(inside), mesh.nodes)} lie inside the tool")
    pierced = _pierced_quads(body[mesh.quads], tool)
    if pierced.size:
        centres = mesh.nodes[mesh.quads].mean(axis=1)
        problems.append(f"the tool passes through quads {_some(pierced, centres)}")
    if problems:
        raise ValueError(
            "the tool must start outside the sheet, but "
            + " and ".join(problems)
            + ": move the tool's start back or cut a notch for it (Mesh.cut)"
        )


def _some(ids: np.ndarray[tuple[int, ...], np.dtype[np.int64]], places: Floats) -> str:
    shown = ", ".join(
        f"{i} at ({places[i, 0]:.4g}, {places[i, 1]:.4g}, {places[i, 2]:.4g})"
        for i in ids[:5].tolist()
    )
    more = f" and {ids.size - 5} more" if ids.size > 5 else ""
    return shown + more


def _pierced_quads(corners: Floats, tool: Tool) -> np.ndarray[tuple[int, ...], np.dtype[np.int64]]:
    """Return the quads (corners in the body frame) that an edge of the tool's surface crosses."""
    pair = np.sort(
        np.concatenate(
            [tool.triangles[:, [0, 1]], tool.triangles[:, [1, 2]], tool.triangles[:, [2, 0]]]
        ),
        axis=1,
    )
    pair = np.unique(pair, axis=0)
    start, end = tool.vertices[pair[:, 0]], tool.vertices[pair[:, 1]]
    low, high = tool.bounding_box()
    near = np.flatnonzero(
        ((corners.max(axis=1) >= low) & (corners.min(axis=1) <= high)).all(axis=1)
    )
    crossed = []
    for e in near.tolist():
        c = corners[e]
        box = (np.maximum(start, end) >= c.min(axis=0)) & (np.minimum(start, end) <= c.max(axis=0))
        i = np.flatnonzero(box.all(axis=1))
        halves = (c[[0, 1, 2]], c[[0, 2, 3]])
        if any(_crosses(start[i], end[i], *half).any() for half in halves):
            crossed.append(e)
    return np.array(crossed, np.int64)


def _crosses(
    start: Floats, end: Floats, a: Floats, b: Floats, c: Floats
) -> np.ndarray[tuple[int, ...], np.dtype[np.bool_]]:
    """Whether segments cross the triangle (a, b, c), its border left out."""
    normal = np.cross(b - a, c - a)
    d0, d1 = (start - a) @ normal, (end - a) @ normal
    through = d0 * d1 < 0
    share = np.divide(d0, d0 - d1, out=np.zeros_like(d0), where=through)
    p = start + share[:, None] * (end - start)
    for u, v in ((a, b), (b, c), (c, a)):
        through &= np.cross(v - u, p - u) @ normal > 1e-9 * (normal @ normal)
    return np.asarray(through)
