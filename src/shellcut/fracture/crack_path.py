"""Where a crack goes next: from its tip through the quad ahead to a place on its boundary.

A tip lies on a side of the mesh, at a node of it, or on the flank of an earlier cut that the crack
has run into. From there a ray goes through the polygon of the row ahead, and :mod:`.ray_ahead` says
where it leaves that.

A crack whose new tip lies on the very side on which an oncoming one ends, nearer than ``JOIN``
across its way, has no row left to go through: the part of the side between them is torn.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, norm, product, unit
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.small_matrices import least_squares
from shellcut.state import KnownTopology, State

from .cut_topology import CutTopology
from .quad_fans import boundary_edges
from .quad_polygon import AWAY, CORNERS, FLANK, Point, along_side, on_side
from .ray_ahead import ALONG_SIDE, AT_CROSSING, AT_POINT, SNAP, Aimed, leave
from .rows_ahead import RowsAhead, table_of
from .segment import Segment
from .tip import Tip
from .tip_places import End, TipPlaces

NEAR = 0.5
"""Of the local edge length: nodes that are nearer to the mid-plane of a blade are on its way."""

_ASKED, _STRAIGHT_UP = np.zeros(1, np.int64), np.zeros((1, 3))


class CrackPath(TipPlaces):
    """Finds the segments through the rows ahead of tips."""

    def __init__(
        self, topology: CutTopology, shell: MITC4Shell, *, sides_only: bool = False
    ) -> None:
        super().__init__(topology, shell, sides_only=sides_only)
        self._leave, self._known = BoundOnce(leave), KnownTopology()
        self._tables: dict[tuple[Tip, ...], RowsAhead | None] = {}

    def rim_tip(self, state: State, start: Floats, end: Floats) -> Tip | None:
        """Return a tip on the rim where a line between two points first crosses it.

        Seen along the film's normal there: on a curved film the line leaves the sheet, and a side
        of the rim is crossed from which it is nearer than the side is long.
        """
        way = end - start
        best, found = np.inf, None
        for a, b in boundary_edges(state).tolist():
            A, B = state.node.X[[a, b]]
            size, n = float(norm(A - B)), state.node.t[a] + state.node.t[b]
            n = unit(n)
            in_sheet = np.stack([way, A - B, A - start], axis=1)
            in_sheet -= np.outer(n, product(n, in_sheet))
            base, gap = in_sheet[:, :2], in_sheet[:, 2]
            ahead, s = least_squares(base, gap)
            miss = norm(product(base, (ahead, s)) - gap)
            on_it = miss < AWAY * size and -AWAY < s < 1.0 + AWAY
            height = abs(product(A + s * (B - A) - start - ahead * way, n))
            if on_it and height < size and -AWAY < ahead < min(best, 1.0):
                best, direction = ahead, unit(way)
                at_end = next((n for n, at in ((a, 0.0), (b, 1.0)) if abs(s - at) < SNAP), None)
                if at_end is not None:
                    found = Tip((at_end, at_end), 0.0, -1, direction, 0.0)
                else:
                    ends, s = ((a, b), s) if a < b else ((b, a), 1.0 - s)
                    found = Tip(ends, float(s), -1, direction, 0.0)
        return found

    def segment_from(
        self,
        state: State,
        tip: Tip,
        direction: Floats,
        lean: Floats | None = None,
        others: Sequence[Tip] = (),
    ) -> Segment | None:
        """Return the segment from a tip in a direction in space, None if no row lies there.

        lean : of the plane in which it lies, see :mod:`.ray_ahead`.  others : tips that it may
        join.
        """
        if not self._known.is_of(state):
            self._tables.clear()
            self._known.take(state)
        of = tip, *others
        if of not in self._tables:
            ahead = self.rows_ahead(tip)
            ends = [self.oncoming(row, entry, tip.heading, others) for row, entry in ahead]
            self._tables[of] = table_of(state, self, ahead, ends) if ahead else None
        table = self._tables[of]
        return table and self._segment(state, table, direction, lean)

    def segment(
        self,
        state: State,
        row: int,
        entry: Point,
        direction: Floats,
        lean: Floats | None = None,
        ends: Sequence[End] = (),
    ) -> Segment | None:
        """Return the segment through a row from a place in it, None if it does not lead through.

        lean : as of :meth:`segment_from`.  ends : of cracks in the row that it may join.
        """
        table = table_of(state, self, [(row, entry)], [ends])
        return self._segment(state, table, direction, lean)

    def side_near(
        self,
        state: State,
        row: int,
        place: Point,
        way: Floats,
        lean: Floats,
        within: float = NEAR,
    ) -> Segment | None:
        """Return the side of a row along which a plane through a place of it is best followed.

        Both its ends lie within so many local edge lengths of the plane; the segment leads the way
        of ``way``. None if no side does that can be broken.

        way, lean : as of :meth:`segment_from`.
        """
        at = self.place_in(state, row, place)
        normal = unit(np.cross(at.t - lean, way))
        gaps = state.node.x[state.quads[row]] - at.x
        off, far = np.abs(product(gaps, normal)), product(gaps, way)
        found, least = None, within * at.size
        for a in range(4):
            b = (a + 1) % 4
            if max(off[a], off[b]) < least and self.may_break(row, a, b):
                least = float(max(off[a], off[b]))
                start, stop = (a, b) if far[a] < far[b] else (b, a)
                found = Segment(row, CORNERS[start], CORNERS[stop], a, stop, along_side=True)
        return found

    def _segment(
        self, state: State, table: RowsAhead, direction: Floats, lean: Floats | None
    ) -> Segment | None:
        """Return the segment through the first row of a table into which a direction leads."""
        aimed = Aimed.of(1)
        self._leave(
            table,
            np.array([0, len(table.row)]),
            np.ascontiguousarray(direction).reshape(1, 1, 3),
            _STRAIGHT_UP if lean is None else np.ascontiguousarray(lean).reshape(1, 3),
            _ASKED,
            state.node.x,
            state.node.t,
            aimed,
        )
        return self.segment_of(table, aimed, 0)

    def segment_of(self, ahead: RowsAhead, aimed: Aimed, i: int) -> Segment | None:
        """Return the segment that the kernel has found from tip i, None if it has none."""
        k, kind, j, nth = aimed.way[i].tolist()
        if k < 0:
            return None
        row, (xi, eta), right = int(ahead.row[k]), ahead.entry[k].tolist(), float(aimed.right[i])
        polygon = self.topology.polygon(row)
        side, corner, (to_xi, to_eta) = polygon.sides[j], -1, aimed.exit[i].tolist()
        end = to_xi, to_eta
        if kind in (AT_POINT, ALONG_SIDE):
            end, side, corner = polygon.points[j], nth, int(ahead.corner[k, j])
        elif kind == AT_CROSSING:
            end = on_side(side, float(ahead.known[ahead.crossing[k, j, 0] + nth]))
        elif side != FLANK:
            end = on_side(side, along_side(side, end))
        return Segment(row, (xi, eta), end, side, corner, kind == ALONG_SIDE, right)

    def between(self, tip: Tip, other: Tip) -> tuple[tuple[int, int], float, float] | None:
        """Return the side on which two tips lie, and where; None if on none, or not it alone.

        Nodes of the side, ascending, and fractions of it from the first. One of the tips may be at
        its end; no third crack may cross it between them.
        """
        if tip.flank is not None or other.flank is not None or (tip.at_node and other.at_node):
            return None
        side = other.ends if tip.at_node else tip.ends
        places = []
        for one in (tip, other):
            if one.at_node and one.ends[0] in side:
                places.append(float(side.index(one.ends[0])))
            elif one.ends == side:
                places.append(one.s)
        if len(places) < 2:
            return None
        low, high = min(places) + AWAY, max(places) - AWAY
        if any(low < s < high for s in self.topology.crossings(*side)):
            return None
        return side, places[0], places[1]

    def tip_at(self, end: Segment, heading: Floats, length: float) -> Tip | None:
        """Return the tip at the end of a segment that has just been cut; None at a rim.

        Where that has come to an earlier crack :mod:`.tip_across` finds it.
        """
        ring, quad = self.ring(end.row), self.topology.parent(end.row)
        if end.corner >= 0:
            node = ring[end.corner]
            tip = Tip((node, node), 0.0, quad, heading, length)
        else:
            tip = Tip(*end.on_side_of(ring), quad, heading, length)
        return tip if self.rows_ahead(tip) else None
