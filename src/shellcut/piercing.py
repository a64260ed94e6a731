"""Where the surface of the tool passes through quads of the sheet.

Contact sees nodes only: a tooth that comes down between nodes is not felt until it reaches one.
What went unnoticed is measured here and reported; and at the start nothing may pass through.
"""

from __future__ import annotations

import numpy as np

from ._jit import Bools, Floats, Ints, Vec3, inline, kernel
from ._vec3 import combine, cross, dot, load, norm, store, sub
from .cutting_edge import to_body
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
        wires = wires[np.argsort(body, kind="stable")]
        self._wires = tool.vertices[wires]
        self._first = np.searchsorted(np.sort(body), np.arange(tool.n_body + 1))

    def crossed_quads(
        self,
        x: Floats,
        quads: Ints,
        asked: Bools,
        rotation: Floats,
        translation: Floats,
    ) -> tuple[Ints, Floats]:
        """Return the quads that the tool passes through, and how far.

        Parameters
        ----------
        x : ndarray, shape (n_node, 3)
            Positions [mm].
        quads : ndarray of int, shape (n_quad, 4)
            Node ids.
        asked : ndarray of bool, shape (n_quad,)
            Which of them to look at.
        rotation, translation : ndarray, shapes (3, 3) and (3,)
            Pose of the tool.

        Returns
        -------
        quads : ndarray of int, shape (n,)
        depth : ndarray, shape (n,)
            Distance of the nearer end of the deepest wire from the quad's plane [mm].
        """
        depth = np.zeros(quads.shape[0])
        _deepest_crossings(
            x=x,
            quads=quads,
            asked=asked,
            rotation=rotation,
            translation=translation,
            wires=self._wires,
            first=self._first,
            depth=depth,
        )
        crossed = np.flatnonzero(depth > 0.0)
        return crossed, depth[crossed]


def unfelt_penetration(
    wires: ToolWires, state: State, rotation: Floats, translation: Floats
) -> tuple[int, float]:
    """Return how many whole quads the tool passes through unnoticed, and the largest depth [mm].

    A quad notices when one of its nodes is in contact, and is no longer whole when one has split.
    """
    n = state.node
    noticed = n.halved | (n.contact_depth > 0.0)
    whole = np.asarray(~noticed[state.quads].any(axis=1))
    quads, depth = wires.crossed_quads(n.x, state.quads, whole, rotation, translation)
    return quads.size, float(depth.max(initial=0.0))


@kernel
def _deepest_crossings(
    x: Floats,
    quads: Ints,
    asked: Bools,
    rotation: Floats,
    translation: Floats,
    wires: Floats,
    first: Ints,
    depth: Floats,
) -> None:
    """Write how deep any wire passes through each quad asked for to depth : (n_quad,), else leave.

    wires : (n_wire, 2, 3), their ends, tooth after tooth; those of tooth b begin at first[b].
    """
    n_body = first.shape[0] - 1
    tooth = np.empty((n_body, 2, 3))
    for b in range(n_body):
        for c in range(3):
            ends = wires[first[b] : first[b + 1], :, c]
            tooth[b, 0, c] = ends.min()
            tooth[b, 1, c] = ends.max()
    corner = np.empty((4, 3))
    low, high = np.empty(3), np.empty(3)
    for e in range(quads.shape[0]):
        if not asked[e]:
            continue
        for a in range(4):
            store(corner, a, to_body(load(x, quads[e, a]), rotation, translation))
        for c in range(3):
            low[c] = min(min(corner[0, c], corner[1, c]), min(corner[2, c], corner[3, c]))
            high[c] = max(max(corner[0, c], corner[1, c]), max(corner[2, c], corner[3, c]))
        halves = (load(corner, 0), load(corner, 1), load(corner, 2), load(corner, 3))
        for b in range(n_body):
            apart = False
            for c in range(3):
                apart = apart or high[c] < tooth[b, 0, c] or low[c] > tooth[b, 1, c]
            if apart:
                continue
            for k in range(first[b], first[b + 1]):
                apart = False
                for c in range(3):
                    one, two = wires[k, 0, c], wires[k, 1, c]
                    apart = apart or max(one, two) < low[c] or min(one, two) > high[c]
                if apart:
                    continue
                start = (wires[k, 0, 0], wires[k, 0, 1], wires[k, 0, 2])
                end = (wires[k, 1, 0], wires[k, 1, 1], wires[k, 1, 2])
                depth[e] = max(
                    depth[e],
                    _crossing_depth(start, end, halves[0], halves[1], halves[2]),
                    _crossing_depth(start, end, halves[0], halves[2], halves[3]),
                )


@inline
def _crossing_depth(start: Vec3, end: Vec3, a: Vec3, b: Vec3, c: Vec3) -> float:
    """Return how far a segment passes through the triangle (a, b, c), 0 if it does not."""
    normal = cross(sub(b, a), sub(c, a))
    d0, d1 = dot(sub(start, a), normal), dot(sub(end, a), normal)
    if d0 * d1 >= 0.0:
        return 0.0
    p = combine(1.0, start, d0 / (d0 - d1), sub(end, start))
    border = _BORDER * dot(normal, normal)
    if (
        dot(cross(sub(b, a), sub(p, a)), normal) <= border
        or dot(cross(sub(c, b), sub(p, b)), normal) <= border
        or dot(cross(sub(a, c), sub(p, c)), normal) <= border
    ):
        return 0.0
    return min(abs(d0), abs(d1)) / norm(normal)
