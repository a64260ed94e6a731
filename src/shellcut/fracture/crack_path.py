"""Where a crack runs next: the segment through the row ahead to its boundary, and the tip there.

From a tip a ray runs through the polygon of the row ahead, and :mod:`.ray_ahead` finds where it
leaves that.

A crack that has reached an earlier one continues from the other flank of that. Several rows touch
the place where the two meet. Film is connected there where rows have the same nodes: the row into
which the crack would run, and those connected with it, are the other flank; all others lie behind.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from shellcut.arrays import Floats, product, unit
from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.table_address import TableWriter
from shellcut.state import OncePerTopology, State

from .cut_film import CutFilm, End
from .cut_state import nodes_at
from .quad_polygon import CORNERS, FLANK, Point, along_side, ascending, corner_at, on_side
from .ray_ahead import ALONG_SIDE, AT_CROSSING, AT_END, AT_POINT, Aimed, leave
from .rows_ahead import RowsAhead, table_of
from .tip import Segment, Tip

NEAR = 0.5
"""Of the local edge length: nodes that are nearer to the mid-plane of a blade are on its path."""

_STRAIGHT_UP = np.zeros((1, 3))


class CrackPath:
    """Finds the segments through the rows ahead of tips, and the tips at their ends."""

    def __init__(self, film: CutFilm) -> None:
        self.film = film
        self._leave = BoundOnce(leave)
        # Rows ahead, laid out for the kernel.
        self._tables = OncePerTopology[dict[tuple[Tip, ...], Any]](lambda _: {})
        self._address_of, self._aimed = TableWriter(), Aimed.of(1)
        self._aimed_address = TableWriter()(self._aimed)

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
        tables, of = self._tables.of(state), (tip, *others)
        if of not in tables:
            ahead = self.film.rows_ahead(tip)
            ends = [self.film.oncoming(row, entry, tip.heading, others) for row, entry in ahead]
            found = self._address_of(table_of(state, self.film, ahead, ends)) if ahead else None
            tables[of] = found
        table = tables[of]
        return None if table is None else self._segment(state, table, direction, lean)

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
        table = table_of(state, self.film, [(row, entry)], [ends])
        return self._segment(state, self._address_of(table), direction, lean)

    def _segment(
        self,
        state: State,
        address: Any,
        direction: Floats,
        lean: Floats | None,
    ) -> Segment | None:
        """Return the segment through the first row of a table into which a direction leads.

        address : of the table of the rows ahead.
        """
        table: RowsAhead = address.table
        self._leave(
            address,
            np.array([0, len(table.row)]),
            np.ascontiguousarray(direction).reshape(1, 1, 3),
            _STRAIGHT_UP if lean is None else np.ascontiguousarray(lean).reshape(1, 3),
            state.node.x,
            state.node.t,
            self._aimed_address,
        )
        return self.segment_of(table, self._aimed, 0)

    def segment_of(self, ahead: RowsAhead, aimed: Aimed, i: int) -> Segment | None:
        """Return the segment that the kernel has found from tip i, None if it has none."""
        k, kind, j, nth = aimed.target[i].tolist()
        if k < 0:
            return None
        row, (xi, eta), right = int(ahead.row[k]), ahead.entry[k].tolist(), float(aimed.right[i])
        side, (to_xi, to_eta) = self.film.topology.polygon(row).sides[j], aimed.exit[i].tolist()
        end = to_xi, to_eta
        if kind in (AT_POINT, ALONG_SIDE, AT_END):
            side = nth
        elif kind == AT_CROSSING:
            end = on_side(side, float(ahead.known[ahead.crossing[k, j, 0] + nth]))
        elif side != FLANK:
            end = on_side(side, along_side(side, end))
        return Segment(row, (xi, eta), end, side, corner_at(end), kind == ALONG_SIDE, right)

    def side_near(
        self,
        state: State,
        row: int,
        place: Point,
        along: Floats,
        lean: Floats,
        within: float = NEAR,
    ) -> Segment | None:
        """Return the side of a row along which a plane through a place of it is best followed.

        Both its ends lie within so many local edge lengths of the plane; the segment leads in the
        direction of ``along``. None if no side does that can be broken.

        along, lean : as of :meth:`segment_from`.
        """
        at = self.film.place_in(state, row, place)
        normal = unit(np.cross(at.t - lean, along))
        gaps = state.node.x[state.quads[row]] - at.x
        off, far = np.abs(product(gaps, normal)), product(gaps, along)
        found, least = None, within * at.size
        for a in range(4):
            b = (a + 1) % 4
            if max(off[a], off[b]) < least and self.film.may_break(row, a, b):
                least = float(max(off[a], off[b]))
                start, stop = (a, b) if far[a] < far[b] else (b, a)
                found = Segment(row, CORNERS[start], CORNERS[stop], a, stop, along_side=True)
        return found

    def tip_at(self, end: Segment, heading: Floats, length: float = 0.0) -> Tip | None:
        """Return the tip at the end of a segment that has just been cut; None at a border.

        Where the segment has reached an earlier crack :meth:`tip_across` finds it.

        length : of what has been cut [mm].
        """
        ring, quad = self.film.ring(end.row), self.film.topology.parent(end.row)
        if end.corner >= 0:
            node = ring[end.corner]
            tip = Tip((node, node), 0.0, quad, heading, length)
        else:
            a, b, s = ring[end.side], ring[(end.side + 1) % 4], along_side(end.side, end.exit)
            a, b, s = ascending(a, b, s)
            tip = Tip((a, b), s, quad, heading, length)
        return tip if self.film.rows_ahead(tip) else None

    def tip_across(self, state: State, end: Segment, heading: Floats) -> Tip | None:
        """Return the tip on the other flank of the crack at which a segment has ended.

        None where there is no film beyond, at a border.

        heading : (3,), direction of the segment in the reference film.
        """
        along = unit(product(end.weights, state.node.x[state.quads[end.row]]))
        touching = self.film.rows_at(self.film.topology.parent(end.row), end.exit)
        ahead = next((at for at in touching if self.segment(state, *at, along) is not None), None)
        if ahead is None:
            return None
        row, place = ahead
        nodes = nodes_at(state, row, place)
        behind = tuple(other for other, at in touching if nodes_at(state, other, at) != nodes)
        return Tip((-1, -1), 0.0, self.film.topology.parent(row), heading, 0.0, place, behind)
