"""The blade-cut rule: which nodes the cutting edge has cut, whatever the stress.

It differs from [Frangi2010], where stress alone splits a node. Under a blade the sheet is held by
the cables and the tip may stay below the strength while the blade runs on; a stress criterion alone
then opens cracks on the rows on either side of it. The rule knows the blade's geometry and the
nodes' positions only: no list of nodes of an expected path exists.

Two kinds of node are cut when the edge reaches them and the blade is there. A whole one inside the
sheet is *pierced*: it lies nearly on the edge. A node of the sheet's present edge, be it of the
film's own boundary, of the flank of an earlier cut or the tip of a crack, is *passed*: it belongs
to the nearest row, provided that the blade parts its quads: some of them lie to one side of the
mid-plane and some to the other, and clearly to either side of the node. A flank that the blade
slides along has all its quads on one side, the flank of a cut that it crosses has not, whoever made
that cut and when.
"""

from __future__ import annotations

import math
from typing import Annotated, Any, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3, product, unit
from shellcut.contact.near_nodes import NearNodes, in_box
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import dot, load
from shellcut.state import KnownTopology, QuadsAtNodes, State, local_edge_length
from shellcut.tool.cutting_edge import (
    CUT_DEPTH,
    NORMAL,
    CuttingEdges,
    in_the_blade,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.pose import Pose, to_body, turn
from shellcut.tool.tool import Tool

# Lateral reach of the blade-cut rule in units of the local edge length sqrt(quad area): a pierced
# node must lie nearly on the edge (well below half the distance to the next row), a passed one
# belongs to the nearest row. The first kind is caught when the edge goes through it, so it lies no
# deeper behind the edge either: farther back a flank that is drawn under the tooth brings nodes of
# the next row near the mid-plane, and splitting those opens cracks beside the cut (six in an
# opening test with rows 0.16 mm apart).
_PIERCED_REACH = 0.3
_PASSED_REACH = 0.5

# The blade parts the quads of a node when its mid-plane lies between the centres of some and of
# others, and some lie farther than this from the node's own distance to it, on either side, in the
# same units. Two rectangles on a flank stand 0.5 to one side, and pass this limit when turned by 57
# degrees; of a cut that crosses another at 35 degrees the smaller quad stands 0.38 to its side.
_PARTED = 0.15

# Of the list of near nodes, over the largest edge length: it is looked through once in ten steps or
# so, in which the edge moves by less than a third of an edge, hence short.
_MARGIN = 0.6


class _Strips(NamedTuple):
    """The cutting edges, and boxes around the strips behind those of each tooth."""

    edges: CuttingEdges
    low: Annotated[Floats, "(n_body, 3)"]
    """Low corners of the boxes [mm]."""
    high: Annotated[Floats, "(n_body, 3)"]


class _CutNodes(NamedTuple):
    """What the kernel needs of the nodes, by the names of :class:`shellcut.state.NodeTable`."""

    x: Annotated[Floats, "(n_node, 3)"]
    supported: Annotated[Bools, "(n_node,)"]
    halved: Annotated[Bools, "(n_node,)"]
    contact_area: Annotated[Floats, "(n_node,)"]


class _CutTables(NamedTuple):
    """What the kernel takes, good until the next split."""

    strips: _Strips
    rim: Annotated[Bools, "(n,)"]
    """Whether a node lies on the film's own boundary; later ones do not."""
    nodes: _CutNodes
    around: QuadsAtNodes


class BladeCut:
    """The cutting edges seen from the nodes: who has been pierced, who has been passed.

    Parameters
    ----------
    tool : Tool
        Whose edges cut.
    largest_area : float
        Of a quad [mm²], for how far beside the edge a node may lie.
    rim : ndarray of bool, shape (n,)
        Whether a node lies on the film's own boundary; later ones do not.
    """

    def __init__(self, tool: Tool, largest_area: float, rim: Bools) -> None:
        edges = CuttingEdges.of(tool)
        size = math.sqrt(largest_area)
        low, high = edges.strip_boxes(_PASSED_REACH * size, CUT_DEPTH * size)
        self._strips = _Strips(edges=edges, low=low, high=high)
        self._near = NearNodes(low, high, _MARGIN * size)
        self._rim = rim
        self._find = BoundOnce(_cut_nodes)
        self._hold, self._known = Holder(), KnownTopology()
        self._tables: _CutTables | None = None

    def cut_nodes(self, state: State, tips: list[int], pose: Pose) -> dict[int, Floats]:
        """Return the unsupported nodes that the edge has cut and the blade's trace at each.

        The trace is the unit direction, in the sheet, in which the blade's mid-plane cuts it.
        """
        n = state.node
        if self._tables is None or not self._known.is_of(state):
            nodes = _CutNodes(**{name: getattr(n, name) for name in _CutNodes._fields})
            tables = _CutTables(self._strips, self._rim, nodes, state.quads_at_nodes())
            self._tables = self._hold(tables)
            self._known.take(state)
        self._near.renew(state, pose)
        near = self._near.ids
        edge_of = np.empty(near.size, np.int64)
        n_cut = self._find(near, pose, np.array(tips, np.int64), self._tables, edge_of)
        traces: dict[int, Floats] = {}
        if n_cut == 0:
            return traces
        segments = self._strips.edges.segments
        for i in np.flatnonzero(edge_of >= 0).tolist():
            node = int(near[i])
            trace = np.cross(n.t[node], product(pose.rotation, segments[edge_of[i], NORMAL]))
            traces[node] = unit(trace)
        return traces

    def saved(self) -> dict[str, Any]:
        """Return the list of nodes near the edges."""
        return self._near.saved()

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, a list of the nodes of ``state``."""
        self._tables = None
        self._near.restore(state, saved)


@inline
def _holds(ids: Ints, n: int) -> bool:
    found = False
    for k in range(ids.shape[0]):
        found = found or ids[k] == n
    return found


@inline
def _parted(
    n: int, x: Floats, around: QuadsAtNodes, normal: Vec3, lateral: float, least: float
) -> bool:
    """Return whether quads of a node lie on both sides of a plane, and ``least`` beside the node.

    normal : of the plane, as the nodes are in space.  lateral : of the node, from the plane [mm].
    """
    to_minus = to_plus = 0.0
    here = dot(load(x, n), normal)
    for i in range(around.n_at[n]):
        centre = -here
        for a in range(4):
            row = around.at[n, i]
            centre += around.centre[row, a] * dot(load(x, around.quads[row, a]), normal)
        to_minus, to_plus = min(to_minus, centre), max(to_plus, centre)
    return to_minus < min(-least, -lateral) and to_plus > max(least, -lateral)


@kernel
def _cut_nodes(near: Ints, pose: Pose, tips: Ints, tables: _CutTables, edge_of: Ints) -> int:
    """Write the segment that has cut each near node to edge_of : (n_near,), else -1; count them.

    tips : (n_tip,), nodes.
    """
    pose, tables = borrowed(pose), borrowed(tables)
    strips, rim, nodes, around = tables
    edges, low, high = strips
    segments, body = edges.segments, edges.body
    x, supported, contact_area = nodes.x, nodes.supported, nodes.contact_area
    n_cut = 0
    for i in range(near.shape[0]):
        n = near[i]
        edge_of[i] = -1
        if supported[n]:
            continue
        p = to_body(load(x, n), pose)
        shallowest = np.inf
        for b in range(low.shape[0]):
            if not in_box(p, low, high, b):
                continue
            size = local_edge_length(contact_area[n])
            at_an_edge = nodes.halved[n] or (n < rim.shape[0] and rim[n]) or _holds(tips, n)
            reach = (_PASSED_REACH if at_an_edge else _PIERCED_REACH) * size
            deepest = CUT_DEPTH * size if at_an_edge else reach
            for k in range(segments.shape[0]):
                if body[k] != b:
                    continue
                _, lateral, depth, owns = strip_coordinates(p, k, segments, deepest)
                if not owns or depth >= shallowest or abs(lateral) > reach:
                    continue
                if at_an_edge:
                    normal = turn(segment_part(segments, k, NORMAL), pose)
                    if not _parted(n, x, around, normal, lateral, _PARTED * size):
                        continue
                if in_the_blade(p, lateral, k, edges):
                    shallowest = depth
                    edge_of[i] = k
        if edge_of[i] >= 0:
            n_cut += 1
    return n_cut
