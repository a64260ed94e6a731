"""The blade-cut rule: which nodes the cutting edge has cut, whatever the stress.

It differs from [Frangi2010], where stress alone splits a node. Under a blade the sheet is held by
the cables and the tip may stay below the strength while the blade runs on; a stress criterion alone
then opens cracks on the rows on either side of it. The rule knows the blade's geometry and the
nodes' positions only: no list of nodes of an expected path exists.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from ._jit import Bools, Floats, Ints, bound_once, inline, kernel
from ._vec3 import load
from .cutting_edge import CUT_DEPTH, NORMAL, CuttingEdges, strip_coordinates, to_body
from .near_nodes import NearNodes, in_box
from .state import State
from .tool import Tool

# Lateral reach of the blade-cut rule in units of the local edge length sqrt(quad area): a node no
# crack has reached must lie nearly on the edge (well below half the distance to the next row); a
# tip, or a node of a free edge where the blade comes in, belongs to the nearest row. The first kind
# is caught when the edge goes through it, so it lies no deeper behind the edge either: farther back
# a flank that is drawn under the tooth brings nodes of the next row near the mid-plane, and
# splitting those opens cracks beside the cut (six in an opening test with rows 0.16 mm apart).
_PIERCED_REACH = 0.3
_PASSED_REACH = 0.5

# Of the list of near nodes [mm]: it is looked through once in ten steps or so, hence short.
_MARGIN = 0.25


class BladeCut:
    """The cutting edges seen from the nodes: who has been pierced, who has been passed.

    Parameters
    ----------
    tool : Tool
        Whose edges cut.
    largest_area : float
        Of a quad [mm²], for how far beside the edge a node may lie.
    """

    def __init__(self, tool: Tool, largest_area: float) -> None:
        self._edges = CuttingEdges.of(tool)
        self._low, self._high = self._edges.strip_boxes(_PASSED_REACH * math.sqrt(largest_area))
        self._near = NearNodes(self._low, self._high, _MARGIN)
        self._find = bound_once(_cut_nodes)

    def cut_nodes(
        self,
        state: State,
        tips: list[int],
        rim: Bools,
        rotation: Floats,
        translation: Floats,
    ) -> dict[int, Floats]:
        """Return the unsupported nodes that the edge has cut and the blade's trace at each.

        The trace is the unit direction, in the sheet, in which the blade's mid-plane cuts it.
        rim : (n,), whether a node lies on the film's own boundary; later ones do not.
        """
        n = state.node
        self._near.renew(state, rotation, translation)
        near = self._near.ids
        edge_of = np.empty(near.size, np.int64)
        n_cut = self._find(
            near,
            n.x,
            n.supported,
            np.array(tips, np.int64),
            rim,
            n.halved,
            n.contact_area,
            rotation,
            translation,
            self._low,
            self._high,
            self._edges.segments,
            self._edges.body,
            edge_of,
        )
        traces: dict[int, Floats] = {}
        if n_cut == 0:
            return traces
        for i in np.flatnonzero(edge_of >= 0).tolist():
            node = int(near[i])
            trace = np.cross(n.t[node], rotation @ self._edges.segments[edge_of[i], NORMAL])
            traces[node] = trace / np.linalg.norm(trace)
        return traces

    def saved(self) -> dict[str, Any]:
        """Return the list of nodes near the edges."""
        return self._near.saved()

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, a list of the nodes of ``state``."""
        self._near.restore(state, saved)


@inline
def _holds(ids: Ints, n: int) -> bool:
    found = False
    for k in range(ids.shape[0]):
        found = found or ids[k] == n
    return found


@kernel
def _cut_nodes(
    near: Ints,
    x: Floats,
    supported: Bools,
    tips: Ints,
    rim: Bools,
    halved: Bools,
    contact_area: Floats,
    rotation: Floats,
    translation: Floats,
    low: Floats,
    high: Floats,
    segments: Floats,
    body: Ints,
    edge_of: Ints,
) -> int:
    """Write the segment that has cut each near node to edge_of : (n_near,), else -1; count them.

    low, high : (n_body, 3), boxes around the strips of each tooth.  body : (n_edge,).
    """
    n_cut = 0
    for i in range(near.shape[0]):
        n = near[i]
        edge_of[i] = -1
        # A flank that the blade slides along is within reach of its edge, but has been cut.
        if supported[n] or (halved[n] and not _holds(tips, n)):
            continue
        p = to_body(load(x, n), rotation, translation)
        shallowest = np.inf
        for b in range(low.shape[0]):
            if not in_box(p, low, high, b):
                continue
            nearest_row = _holds(tips, n) or (n < rim.shape[0] and rim[n])
            reach = _PASSED_REACH if nearest_row else _PIERCED_REACH
            reach *= np.sqrt(4.0 * contact_area[n])
            deepest = CUT_DEPTH if nearest_row else reach
            for k in range(segments.shape[0]):
                if body[k] != b:
                    continue
                _, lateral, depth, owns = strip_coordinates(p, k, segments)
                if owns and depth < min(shallowest, deepest) and abs(lateral) <= reach:
                    shallowest = depth
                    edge_of[i] = k
        if edge_of[i] >= 0:
            n_cut += 1
    return n_cut
