"""The blade-cut rule: which nodes the cutting edge has cut, whatever the stress.

It differs from [Frangi2010], where stress alone splits a node. Under a blade the sheet is held by
the cables and the tip may stay below the strength while the blade runs on; a stress criterion alone
then opens cracks on the rows on either side of it. The rule knows the blade's geometry and the
nodes' positions only: no list of nodes of an expected path exists.
"""

from __future__ import annotations

import numpy as np

from ._jit import Bools, Floats, Ints, kernel
from ._vec3 import load
from .cutting_edge import CUT_DEPTH, CuttingEdges, strip_coordinates, to_body
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


class BladeCut:
    """The cutting edges seen from the nodes: who has been pierced, who has been passed."""

    def __init__(self, tool: Tool) -> None:
        self._edges = CuttingEdges.of(tool)
        points = tool.vertices[tool.edges.ravel()]
        self._low = points.min(axis=0) - CUT_DEPTH
        self._high = points.max(axis=0) + CUT_DEPTH

    def cut_nodes(
        self,
        state: State,
        tips: list[int],
        rim: Ints,
        rotation: Floats,
        translation: Floats,
    ) -> dict[int, Floats]:
        """Return the unsupported nodes that the edge has cut and the blade's trace at each.

        The trace is the unit direction, in the sheet, in which the blade's mid-plane cuts it.
        """
        n = state.node
        tip = np.zeros(n.count, np.bool_)
        tip[tips] = True
        nearest_row = tip.copy()
        nearest_row[rim] = True
        edge_of = np.full(n.count, -1, np.int64)
        _cut_nodes(
            n_node=n.count,
            x=n.x,
            supported=n.supported,
            tip=tip,
            nearest_row=nearest_row,
            halved=n.halved,
            contact_area=n.contact_area,
            rotation=rotation,
            translation=translation,
            low=self._low,
            high=self._high,
            start=self._edges.start,
            vector=self._edges.vector,
            normal=self._edges.normal,
            back=self._edges.back,
            edge_of=edge_of,
        )
        traces = {}
        for i in np.flatnonzero(edge_of >= 0).tolist():
            trace = np.cross(n.t[i], rotation @ self._edges.normal[edge_of[i]])
            traces[i] = trace / np.linalg.norm(trace)
        return traces


@kernel
def _cut_nodes(
    n_node: int,
    x: Floats,
    supported: Bools,
    tip: Bools,
    nearest_row: Bools,
    halved: Bools,
    contact_area: Floats,
    rotation: Floats,
    translation: Floats,
    low: Floats,
    high: Floats,
    start: Floats,
    vector: Floats,
    normal: Floats,
    back: Floats,
    edge_of: Ints,
) -> None:
    """Write the edge segment that has cut each node into edge_of : (n_node,), or leave it."""
    for n in range(n_node):
        # A flank that the blade slides along is within reach of its edge, but has been cut.
        if supported[n] or (halved[n] and not tip[n]):
            continue
        p = to_body(load(x, n), rotation, translation)
        if not (low[0] < p[0] < high[0] and low[1] < p[1] < high[1] and low[2] < p[2] < high[2]):
            continue
        reach = np.sqrt(4.0 * contact_area[n]) * (
            _PASSED_REACH if nearest_row[n] else _PIERCED_REACH
        )
        deepest = CUT_DEPTH if nearest_row[n] else reach
        shallowest = np.inf
        for k in range(start.shape[0]):
            _, lateral, depth, owns = strip_coordinates(p, k, start, vector, normal, back)
            if owns and depth < min(shallowest, deepest) and abs(lateral) <= reach:
                shallowest = depth
                edge_of[n] = k
