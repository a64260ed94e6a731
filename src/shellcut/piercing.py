"""Where the surface of the tool passes through quads of the sheet.

Contact sees nodes only: a tooth that comes down between nodes is not felt until it reaches one.
What went unnoticed is measured here and reported; and at the start nothing may pass through.
"""

from __future__ import annotations

import numpy as np

from ._jit import Bools, Floats, Ints
from .state import State
from .tool import Tool

# Share of a quad's half below which a crossing counts as lying on its border.
_BORDER = 1e-9


class ToolWires:
    """The edges of the tool's triangles, which cross what the surface passes through."""

    def __init__(self, tool: Tool) -> None:
        sides = tool.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        wires, first = np.unique(np.sort(sides, axis=1), axis=0, return_index=True)
        body = tool.triangle_body[first // 3]
        self._teeth = [
            (tool.vertices[wires[body == b, 0]], tool.vertices[wires[body == b, 1]])
            for b in range(tool.n_body)
        ]

    def crossed_quads(self, corners: Floats) -> tuple[Ints, Floats]:
        """Return the quads that the tool passes through, and how far.

        Parameters
        ----------
        corners : ndarray, shape (n_quad, 4, 3)
            Of the quads, in the body frame of the tool [mm].

        Returns
        -------
        quads : ndarray of int, shape (n,)
        depth : ndarray, shape (n,)
            Distance of the nearer end of the deepest wire from the quad's plane [mm].
        """
        quads, depths = [], []
        low, high = corners.min(axis=1), corners.max(axis=1)
        for start, end in self._teeth:
            wire_low, wire_high = np.minimum(start, end), np.maximum(start, end)
            near = ((high >= wire_low.min(axis=0)) & (low <= wire_high.max(axis=0))).all(axis=1)
            for e in np.flatnonzero(near).tolist():
                i = np.flatnonzero(((wire_high >= low[e]) & (wire_low <= high[e])).all(axis=1))
                if i.size == 0:
                    continue
                depth = max(
                    _crossing_depth(start[i], end[i], *corners[e, [0, 1, 2]]),
                    _crossing_depth(start[i], end[i], *corners[e, [0, 2, 3]]),
                )
                if depth > 0.0:
                    quads.append(e)
                    depths.append(depth)
        return np.array(quads, np.int64), np.array(depths)


def unfelt_penetration(
    wires: ToolWires, state: State, rotation: Floats, translation: Floats
) -> tuple[int, float]:
    """Return how many whole quads the tool passes through unnoticed, and the largest depth [mm].

    A quad notices when one of its nodes is in contact, and is no longer whole when one has split.
    """
    n = state.node
    noticed = n.halved | (n.contact_depth > 0.0)
    whole = ~noticed[state.quads].any(axis=1)
    corners = (n.x[state.quads[whole]] - translation) @ rotation
    quads, depth = wires.crossed_quads(corners)
    return quads.size, float(depth.max(initial=0.0))


def _crossing_depth(start: Floats, end: Floats, a: Floats, b: Floats, c: Floats) -> float:
    """Return how far segments pass through the triangle (a, b, c), 0 if none does."""
    normal = np.cross(b - a, c - a)
    d0, d1 = (start - a) @ normal, (end - a) @ normal
    through: Bools = d0 * d1 < 0
    share = np.divide(d0, d0 - d1, out=np.zeros_like(d0), where=through)
    p = start + share[:, None] * (end - start)
    for u, v in ((a, b), (b, c), (c, a)):
        through = through & (np.cross(v - u, p - u) @ normal > _BORDER * (normal @ normal))
    depth = np.minimum(np.abs(d0), np.abs(d1))[through]
    return float(depth.max(initial=0.0) / np.linalg.norm(normal))
