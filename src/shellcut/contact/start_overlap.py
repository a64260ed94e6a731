"""Refuse a start with the tool already inside the sheet: contact would throw the sheet out."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.mesh.mesh import Mesh
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .missed_penetration import ToolWires


def check_tool_outside(mesh: Mesh, tool: Tool, grid: ClosestTriangleGrid, pose: Pose) -> None:
    """Raise ValueError if a node lies in the tool or an edge of the tool passes through a quad."""
    _, inside, _, _ = grid.query(pose.to_body(mesh.nodes))
    problems = []
    if inside.any():
        problems.append(f"nodes {_some(np.flatnonzero(inside), mesh.nodes)} lie inside the tool")
    nowhere = np.zeros(mesh.n_node, np.bool_)
    pierced, _ = ToolWires(tool).crossed_quads(mesh.nodes, mesh.quads, nowhere, pose)
    if pierced.size:
        centres = mesh.nodes[mesh.quads].mean(axis=1)
        problems.append(f"the tool passes through quads {_some(pierced, centres)}")
    if problems:
        raise ValueError(
            "the tool must start outside the sheet, but "
            + " and ".join(problems)
            + ": move the tool's start back or cut a notch for it (Mesh.cut)"
        )


def _some(ids: Ints, places: Floats) -> str:
    shown = ", ".join(
        f"{i} at ({places[i, 0]:.4g}, {places[i, 1]:.4g}, {places[i, 2]:.4g})"
        for i in ids[:5].tolist()
    )
    more = f" and {ids.size - 5} more" if ids.size > 5 else ""
    return shown + more
