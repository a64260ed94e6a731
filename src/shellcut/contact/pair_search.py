"""Search for the quads close to some points: pairs for the distance queries on quads.

Boxes around the quads, wider by the reach, are sorted along one axis; a point tests those that may
begin before it and end behind it. Film that is connected to a node nearby is no partner of it:
quads with a node that is within some *rings* of sides of it, counted along the film and not across
cracks.

The partners of a point fall into *sheets*: quads connected by common nodes. A point
between two flaps has two sheets as partners, and touches each by itself.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds
from shellcut.numerics.boxes import box_around, in_box
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import load
from shellcut.state import State

# Pairs that room is made for at first, over the points.
_ROOM = 16


class Pairs(NamedTuple):
    """Points and the quads close to them, sheet by sheet."""

    point: Annotated[Ints, "(n_point,)"]
    """Those of the points that have partners, ascending."""
    first_sheet: Annotated[Ints, "(n_point_1,)"]
    """First sheet of every point, and the end."""
    first_pair: Annotated[Ints, "(n_sheet_1,)"]
    """First pair of every sheet, and the end."""
    row: Annotated[Ints, "(n_pair,)"]
    """Quad or copy of every pair, ascending within a sheet."""

    @property
    def n_sheet(self) -> int:
        """Number of sheets, of all points together."""
        return len(self.first_pair) - 1

    @property
    def sheet_of_pair(self) -> Ints:
        """Sheet of every pair, shape (n_pair,)."""
        return np.repeat(np.arange(self.n_sheet), np.diff(self.first_pair))

    @property
    def point_of_sheet(self) -> Ints:
        """Point of every sheet, shape (n_sheet,)."""
        return np.repeat(self.point, np.diff(self.first_sheet))

    @property
    def point_of_pair(self) -> Ints:
        """Point of every pair, shape (n_pair,)."""
        return self.point_of_sheet[self.sheet_of_pair]

    @classmethod
    def none(cls) -> Pairs:
        """Return the list of nothing near."""
        nothing = np.zeros(0, np.int64)
        return cls(nothing, np.zeros(1, np.int64), np.zeros(1, np.int64), nothing)


class Points(NamedTuple):
    """Points whose partners are searched."""

    ids: Annotated[Ints, "(n,)"]
    """Nodes, or rows of the tool's points, ascending."""
    place: Annotated[Floats, "(n, 3)"]
    """In space [mm]."""
    rings: Annotated[Ints, "(n,)"]
    """Sides along the film within which nothing is a partner of a node; -1 of no node."""


class Boxes(NamedTuple):
    """Around quads, sorted by where they begin along an axis."""

    row: Annotated[Ints, "(n_box,)"]
    low: Annotated[Floats, "(n_box, 3)"]
    high: Annotated[Floats, "(n_box, 3)"]


class PairSearch:
    """Finds the quads close to points."""

    def __init__(self) -> None:
        self._boxes, self._find = BoundOnce(_write_boxes), BoundOnce(_find)

    def find(self, points: Points, rows: Ints, reach: float, state: State) -> Pairs:
        """Return the pairs of points and quads closer than ``reach`` by their boxes.

        Parameters
        ----------
        points : Points
        rows : ndarray of int, shape (n_row,)
            Quads that may be partners.
        reach : float
            [mm]
        state : State
        """
        n, quads = state.node, state.quad.nodes
        row, (low, high) = np.empty(rows.size, np.int64), np.empty((2, rows.size, 3))
        boxes = Boxes(row, low, high)
        n_box, axis, widest = self._boxes(points.place, rows, quads, n.x, reach, boxes)
        order = np.argsort(low[:n_box, axis], kind="stable")
        boxes = Boxes(row[order], low[order], high[order])
        # The first box that may contain each point.
        begin = np.searchsorted(boxes.low[:, axis], points.place[:, axis] - widest)
        n_point, room = points.ids.size, _ROOM * (points.ids.size + 1)
        while True:
            pairs = Pairs(*(np.empty(k, np.int64) for k in (n_point, n_point + 1, room + 1, room)))
            n_pair, n_sheet, n_met = self._find(
                points, boxes, axis, begin, quads, n.quads, n.n_quad_at, pairs
            )
            if n_pair <= room:
                ends = (n_met, n_met + 1, n_sheet + 1, n_pair)
                return Pairs(*(table[:end].copy() for table, end in zip(pairs, ends, strict=True)))
            room = n_pair


@kernel
def _write_boxes(
    place: Floats, rows: Ints, quads: SmallIds, x: Floats, reach: float, boxes: Boxes
) -> tuple[int, int, float]:
    """Write the boxes around those of some rows that are near any of some points.

    They are wider by the reach [mm].  place : (n_point, 3).  Returns their number, the axis along
    which the points lie farthest apart, and how wide the boxes are along it at most [mm].
    """
    low, high = np.full(3, np.inf), np.full(3, -np.inf)
    for i in range(place.shape[0]):
        for c in range(3):
            if not np.isfinite(place[i, c]):
                return 0, 0, 0.0
            low[c], high[c] = min(low[c], place[i, c]), max(high[c], place[i, c])
    axis, count, widest = 0, 0, 0.0
    for c in range(1, 3):
        if high[c] - low[c] > high[axis] - low[axis]:
            axis = c
    for row in rows:
        a, b = load(x, quads[row, 0]), load(x, quads[row, 1])
        lowest, highest = box_around(a, b, load(x, quads[row, 2]), load(x, quads[row, 3]))
        near = True
        for c in range(3):
            boxes.low[count, c], boxes.high[count, c] = lowest[c] - reach, highest[c] + reach
            near &= boxes.low[count, c] <= high[c] and boxes.high[count, c] >= low[c]
        if near:
            boxes.row[count] = row
            widest = max(widest, boxes.high[count, axis] - boxes.low[count, axis])
            count += 1
    return count, axis, widest


@inline
def _mark_rings(
    i: int,
    points: Points,
    quads: SmallIds,
    at: SmallIds,
    n_at: SmallIds,
    of_row: Ints,
    of_node: Ints,
    ring: Ints,
) -> None:
    """Write i to of_row : (n_row,) for the rows with a node within the rings of the i-th point.

    of_node : (n_node,), likewise.  ring : (n_node,), room for the nodes of the rings.
    """
    ring[0], n_ring, begin = points.ids[i], 1, 0
    # The rows at the nodes of a ring contain the next ring.
    for _ in range(points.rings[i] + 1):
        end = n_ring
        for k in range(begin, end):
            for j in range(n_at[ring[k]]):
                row = at[ring[k], j]
                if of_row[row] == i:
                    continue
                of_row[row] = i
                for a in range(4):
                    node = quads[row, a]
                    if of_node[node] != i:
                        of_node[node] = i
                        ring[n_ring] = node
                        n_ring += 1
        begin = end


@kernel
def _find(
    points: Points,
    boxes: Boxes,
    axis: int,
    begin: Ints,
    quads: SmallIds,
    at: SmallIds,
    n_at: SmallIds,
    pairs: Pairs,
) -> tuple[int, int, int]:
    """Write the pairs; return how many pairs, sheets and points with partners there are.

    The number of pairs is right also where there is no room for all.  axis : along which the boxes
    ascend.  begin : (n_point,), first box that may contain each point.  at, n_at : rows at every
    node.
    """
    of_row = np.full(quads.shape[0], -1, np.int64)  # point that a row is connected to
    of_node, ring = np.full(at.shape[0], -1), np.empty_like(n_at)
    met_by = np.full(at.shape[0], -1)  # point of the pair, ``owner``, that a node was met by
    owner = np.empty_like(met_by)
    leader, partner = np.empty_like(boxes.row), np.empty_like(boxes.row)
    n_pair, n_sheet, n_point = 0, 0, 0
    for i in range(points.ids.shape[0]):
        if points.rings[i] >= 0:
            _mark_rings(i, points, quads, at, n_at, of_row, of_node, ring)
        p, n = (points.place[i, 0], points.place[i, 1], points.place[i, 2]), 0
        for j in range(begin[i], boxes.row.shape[0]):
            row = boxes.row[j]
            if boxes.low[j, axis] > p[axis]:
                break
            if of_row[row] == i or not in_box(p, boxes.low, boxes.high, j):
                continue
            # Few quads are near a point, so an insertion keeps them ascending.
            k = n
            while k > 0 and partner[k - 1] > row:
                partner[k] = partner[k - 1]
                k -= 1
            partner[k] = row
            n += 1
        if n == 0 or n_pair + n > pairs.row.shape[0]:
            n_pair += n
            continue
        # Pairs with a common node are of the same sheet: the first of them stands for the sheet.
        for k in range(n):
            leader[k] = k
            for a in range(4):
                node = quads[partner[k], a]
                if met_by[node] != i:
                    met_by[node], owner[node] = i, k
                first, second = _leader_of(k, leader), _leader_of(owner[node], leader)
                leader[max(first, second)] = min(first, second)
        pairs.point[n_point], pairs.first_sheet[n_point] = points.ids[i], n_sheet
        n_point += 1
        for k in range(n):
            if leader[k] != k:
                continue
            pairs.first_pair[n_sheet] = n_pair
            n_sheet += 1
            for j in range(k, n):
                if _leader_of(j, leader) == k:
                    pairs.row[n_pair] = partner[j]
                    n_pair += 1
    pairs.first_sheet[n_point], pairs.first_pair[n_sheet] = n_sheet, min(n_pair, pairs.row.shape[0])
    return n_pair, n_sheet, n_point


@inline
def _leader_of(k: int, leader: Ints) -> int:
    """Return the first pair of the sheet of a pair."""
    while leader[k] != k:
        k = leader[k]
    return k
