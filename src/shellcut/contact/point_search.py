"""Search for the quads near points of the tool: the list of their pairs.

A quad goes with every point inside the box around its corners, wider by the capture and a slack.
Quads that follow each other lie side by side mostly: a point looks into the box around a few of
them before it looks at each.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallIds
from shellcut.numerics.jit import inline, kernel
from shellcut.state import local_edge_length

from .contact_tables import ContactNodes
from .near_nodes import in_box
from .point_tables import PointPairs

# Number of quads in a common box.
_TOGETHER = 16


@kernel
def whole_quads_near(
    near_tool: Ints,
    halved: Bools,
    share: Floats,
    quads: SmallIds,
    nodes: ContactNodes,
    margins: tuple[float, float],
    ids: Ints,
    low: Floats,
    high: Floats,
) -> int:
    """Write ids and boxes of the whole quads at the nodes near the tool; return their number.

    halved, share : of nodes, and of quads: cut ones are left out, and those with a halved node.
    margins : of the boxes, over the local edge length, and besides [mm].  ids, low, high :
    (n_quad,), (n_quad, 3), (n_quad, 3), written.
    """
    x = nodes.x
    near = np.zeros(x.shape[0], np.bool_)
    for n in near_tool:
        near[n] = True
    count = 0
    for q in range(quads.shape[0]):
        beside, whole, area = False, share[q] >= 1.0, 0.0
        for c in range(4):
            n = quads[q, c]
            beside |= near[n]
            whole &= not halved[n]
            area = max(area, nodes.contact_area[n])
        if not (beside and whole):
            continue
        margin = margins[0] * local_edge_length(area) + margins[1]
        ids[count] = q
        _box_around(q, quads, x, margin, low, high, count)
        count += 1
    return count


@inline
def _box_around(
    q: int, quads: SmallIds, x: Floats, margin: float, low: Floats, high: Floats, row: int
) -> None:
    """Write the box around a quad into a row of low, high : (n, 3)."""
    for k in range(3):
        least = most = x[quads[q, 0], k]
        for c in range(1, 4):
            here = x[quads[q, c], k]
            least, most = min(least, here), max(most, here)
        low[row, k], high[row, k] = least - margin, most + margin


@kernel
def list_pairs(
    place: Floats,
    force: Floats,
    ids: Ints,
    low: Floats,
    high: Floats,
    quads: SmallIds,
    pairs: PointPairs,
) -> int:
    """Write the list of points in the boxes of quads; return how many pairs there are.

    If there is no room for them in pairs, the list is of no use.

    place : (n_point, 3), in space [mm].  force : (n_point, 3), of the points: those that press are
    listed in any case.  ids, low, high : quads with their boxes, (n,), (n, 3), (n, 3).
    """
    room, n_box = pairs.quad.shape[0], ids.shape[0]
    n_group = (n_box + _TOGETHER - 1) // _TOGETHER
    group_low, group_high = np.full((n_group, 3), np.inf), np.full((n_group, 3), -np.inf)
    for b in range(n_box):
        for k in range(3):
            g = b // _TOGETHER
            group_low[g, k] = min(group_low[g, k], low[b, k])
            group_high[g, k] = max(group_high[g, k], high[b, k])
    listed, n_pair, largest = 0, 0, -1
    for i in range(place.shape[0]):
        p = (place[i, 0], place[i, 1], place[i, 2])
        first = n_pair
        for g in range(n_group):
            if not in_box(p, group_low, group_high, g):
                continue
            for b in range(g * _TOGETHER, min((g + 1) * _TOGETHER, n_box)):
                if in_box(p, low, high, b):
                    if n_pair < room:
                        pairs.quad[n_pair] = ids[b]
                    n_pair += 1
        pressing = force[i, 0] != 0.0 or force[i, 1] != 0.0 or force[i, 2] != 0.0
        if n_pair > first or pressing:
            pairs.point[listed], pairs.first[listed] = i, first
            listed += 1
    pairs.first[listed] = n_pair
    pairs.used[0], pairs.used[1] = listed, 0
    if n_pair > room:
        return n_pair
    for j in range(n_pair):
        for c in range(4):
            largest = max(largest, int(quads[pairs.quad[j], c]))
    met = np.zeros(largest + 1, np.bool_)
    for j in range(n_pair):
        for c in range(4):
            met[quads[pairs.quad[j], c]] = True
    for n in range(largest + 1):
        if met[n]:
            pairs.node[pairs.used[1]] = n
            pairs.used[1] += 1
    return n_pair
