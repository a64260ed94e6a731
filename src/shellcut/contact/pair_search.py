"""Search for the quads close to some points: pairs for the looks at quads.

Boxes around the quads, wider by the reach, are sorted along one axis; a point asks those that may
begin before it and end behind it. What hangs together with a node is no partner of it: quads with a
node that is within some *rings* of sides of it, counted along the film and not across cracks.

The partners of a point fall into *sheets*: quads that hang together by common nodes. A point
between two flaps has two sheets as partners, and touches each by itself.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallIds
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.state import State

from .near_nodes import in_box

# Pairs that room is made for at first, over the points; partners of a point, at most.
_ROOM, _MOST = 16, 4096


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
    """Points whose partners are looked for."""

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
        n, quads, place = state.node, state.quad.nodes, points.place
        if not rows.size or not points.ids.size or not np.isfinite(place).all():
            return Pairs.none()
        low, high = np.empty((2, rows.size, 3))
        self._boxes(rows, quads, n.x, reach, low, high)
        near = np.flatnonzero(((low <= place.max(0)) & (high >= place.min(0))).all(axis=1))
        axis = int(np.argmax(place.max(0) - place.min(0)))
        near = near[np.argsort(low[near, axis], kind="stable")]
        boxes, at = Boxes(rows[near], low[near], high[near]), place[:, axis]
        widest = float((boxes.high - boxes.low)[:, axis].max(initial=0.0))
        begin = np.searchsorted(boxes.low[:, axis], at - widest)
        end = np.searchsorted(boxes.low[:, axis], at, side="right")
        room = _ROOM * points.ids.size
        while True:
            found = np.empty((room, 3), np.int64)
            count = self._find(points, boxes, begin, end, quads, n.quads, n.n_quad_at, found)
            if count <= room:
                return _in_sheets(points.ids, found[:count])
            room = count


def _in_sheets(ids: Ints, found: Ints) -> Pairs:
    """Return pairs from rows (place of the point, sheet, row), which ascend."""
    point, sheet, row = found.T
    new = np.flatnonzero(np.diff(point, prepend=-1) | np.diff(sheet, prepend=-1))
    at = point[new]
    first_sheet = np.flatnonzero(np.diff(at, prepend=-1))
    return Pairs(
        point=ids[at[first_sheet]],
        first_sheet=np.append(first_sheet, at.size),
        first_pair=np.append(new, point.size),
        row=np.ascontiguousarray(row),
    )


@kernel
def _write_boxes(
    rows: Ints, quads: SmallIds, x: Floats, reach: float, low: Floats, high: Floats
) -> None:
    """Write the boxes around some rows, wider by the reach [mm]: low, high : (n, 3)."""
    for i in range(rows.shape[0]):
        for c in range(3):
            lowest = highest = x[quads[rows[i], 0], c]
            for a in range(1, 4):
                here = x[quads[rows[i], a], c]
                lowest, highest = min(lowest, here), max(highest, here)
            low[i, c], high[i, c] = lowest - reach, highest + reach


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
    # The rows at the nodes of a ring hold the next one.
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
    begin: Ints,
    stop: Ints,
    quads: SmallIds,
    at: SmallIds,
    n_at: SmallIds,
    found: Ints,
) -> int:
    """Write (place of the point, sheet, row) of every pair to found : (n, 3); return their number.

    They ascend. The number is right also where there is no room for all.  begin, stop : (n_point,),
    of the boxes that each point asks.  at, n_at : rows at every node.
    """
    of_row = np.full(quads.shape[0], -1, np.int64)  # point that a row hangs together with
    of_node, owner, ring = np.full(at.shape[0], -1), np.full(at.shape[0], -1), np.empty_like(n_at)
    met_by = np.full(at.shape[0], -1)  # point of the pair, ``owner``, that a node was met by
    leader, partner = np.empty(_MOST, np.int64), np.empty(_MOST, np.int64)
    count = 0
    for i in range(points.ids.shape[0]):
        if points.rings[i] >= 0:
            _mark_rings(i, points, quads, at, n_at, of_row, of_node, ring)
        p, n_pair = (points.place[i, 0], points.place[i, 1], points.place[i, 2]), 0
        for j in range(begin[i], stop[i]):
            row = boxes.row[j]
            if of_row[row] == i or n_pair == _MOST or not in_box(p, boxes.low, boxes.high, j):
                continue
            k = n_pair
            while k > 0 and partner[k - 1] > row:
                partner[k] = partner[k - 1]
                k -= 1
            partner[k] = row
            n_pair += 1
        # Pairs with a common node are of one sheet: the first of them leads it.
        for k in range(n_pair):
            leader[k] = k
            for a in range(4):
                node = quads[partner[k], a]
                if met_by[node] != i:
                    met_by[node], owner[node] = i, k
                one, two = _leader_of(k, leader), _leader_of(owner[node], leader)
                leader[max(one, two)] = min(one, two)
        for k in range(n_pair):
            if count < found.shape[0]:
                _insert(found, count, i, _leader_of(k, leader), partner[k])
            count += 1
    return count


@inline
def _leader_of(k: int, leader: Ints) -> int:
    """Return the first pair of the sheet of a pair."""
    while leader[k] != k:
        k = leader[k]
    return k


@inline
def _insert(found: Ints, count: int, point: int, sheet: int, row: int) -> None:
    """Put a pair behind the others of its point and sheet; rows come in ascending order."""
    place = count
    while place > 0 and found[place - 1, 0] == point and found[place - 1, 1] > sheet:
        for c in range(3):
            found[place, c] = found[place - 1, c]
        place -= 1
    found[place, 0], found[place, 1], found[place, 2] = point, sheet, row
