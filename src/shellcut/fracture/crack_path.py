"""Where crack tips lie, and where a crack goes next: through the quad ahead to its boundary.

A tip lies on a side of the mesh, at a node of it, or on the flank of an earlier cut that the crack
has run into. From there a ray goes through the polygon of the row ahead, and :mod:`.ray_ahead` says
where it leaves that.

A crack whose new tip lies on the very side on which an oncoming one ends, nearer than ``JOIN``
across its way, has no row left to go through: the part of the side between them is broken.

A crack that has come to an earlier one goes on from the other flank of that. Several rows touch the
place where the two meet. Film hangs together there where rows have the same nodes: the row into
which the crack would go on, and those that hang together with it, are the other flank; all others
lie behind.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import hypot

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, norm, product, unit
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.held_table import Holder
from shellcut.numerics.jit import BoundOnce
from shellcut.numerics.small_matrices import least_squares
from shellcut.state import KnownTopology, State

from .cut_state import nodes_at
from .cut_topology import CutTopology
from .open_edges import boundary_edges
from .quad_polygon import (
    AWAY,
    CORNERS,
    FLANK,
    Point,
    along_side,
    common_side,
    corner_at,
    edges,
    fraction_between,
    has_corner,
    on_side,
    shape_slopes,
    side_at,
    side_of,
    span,
)
from .ray_ahead import ALONG_SIDE, AT_CROSSING, AT_END, AT_POINT, SNAP, Aimed, leave
from .rows_ahead import End, RowsAhead, table_of
from .tip import Place, Segment, Tip

NEAR = 0.5
"""Of the local edge length: nodes that are nearer to the mid-plane of a blade are on its way."""

ONCOMING = -0.7
"""Cosine of the headings of two cracks below which they come towards each other."""


_STRAIGHT_UP = np.zeros((1, 3))


class CrackPath:
    """Finds where tips lie, the rows ahead of them, and the segments through these.

    The shell gives the nodes of the mesh at the corners of rows, and their sizes.  sides_only :
    whether cracks go along sides of the mesh only.
    """

    def __init__(
        self, topology: CutTopology, shell: MITC4Shell, *, sides_only: bool = False
    ) -> None:
        self.topology, self._shell, self.sides_only = topology, shell, sides_only
        self._leave, self._known = BoundOnce(leave), KnownTopology()
        self._tables: dict[tuple[Tip, ...], tuple[RowsAhead, RowsAhead] | None] = {}
        self._hold, self._aimed = Holder(), Aimed.of(1)
        self._held_aimed = Holder()(self._aimed)
        # The mesh alone decides, and rows are asked about anew after every cut.
        self._parts_of = lru_cache(maxsize=1024)(self._heading_in)

    def ring(self, row: int) -> list[int]:
        """Return the nodes of the mesh at the corners of a row."""
        ring: list[int] = self._shell.mesh_quads[row].tolist()
        return ring

    def size(self, row: int) -> float:
        """Return the local edge length, sqrt(quad area) [mm]."""
        return float(np.sqrt(self._shell.area[row]))

    def rows_ahead(self, tip: Tip) -> list[tuple[int, Point]]:
        """Return the rows into which a crack may run from its tip, and the tip's place in each.

        At a node those come first into whose corner the crack's heading points, or nearly: where a
        blade folds film at the tip, a row beside the crack says nothing of the way ahead.
        """
        rows = self.rows_at_tip(tip)
        if tip.flank is None and tip.at_node:
            rows.sort(key=lambda at: self._past_a_row(at, tip))
        return rows

    def rows_at_tip(self, tip: Tip) -> list[tuple[int, Point]]:
        """Return the same in the order of the mesh; at a node all rows that it belongs to."""
        topology = self.topology
        if tip.flank is not None:
            touching = self.rows_at(tip.quad, tip.flank)
            return [(row, place) for row, place in touching if row not in tip.behind]
        if tip.at_node:
            return self._rows_at_node(tip.ends[0])
        found = []
        for row, side, up in topology.rows_beside(*tip.ends):
            if topology.parent(row) == tip.quad:
                continue
            s, held = tip.s if up else 1.0 - tip.s, span(topology.polygon(row), side)
            if held is not None and held[0] < s - AWAY and held[1] > s + AWAY:
                found.append((row, on_side(side, s)))
        return found

    def rows_at(self, quad: int, place: Point) -> list[tuple[int, Point]]:
        """Return the rows whose film touches a place on the boundary of a row, and where it is.

        The place is one of a quad of the mesh, whose own rows come first; at a corner and on a side
        those of its neighbours touch it too.
        """
        topology, ring = self.topology, self.ring(quad)
        corner, side = corner_at(place), side_at(place)
        if corner >= 0:
            every = self._rows_at_node(ring[corner])
            return sorted(every, key=lambda at: topology.parent(at[0]) != quad)
        mine = [(row, place) for row in topology.rows_of(quad)]
        if side >= 0:
            a, b, s = ring[side], ring[(side + 1) % 4], along_side(side, place)
            mine += [
                (row, on_side(at, 1.0 - s))
                for row, at, up in topology.rows_beside(a, b)
                if topology.parent(row) != quad and not up
            ]
        return [(row, at) for row, at in mine if side_of(topology.polygon(row), at) is not None]

    def _rows_at_node(self, node: int) -> list[tuple[int, Point]]:
        """Return the rows whose film reaches a node of the mesh, and the corner there."""
        topology = self.topology
        return [
            (row, CORNERS[corner])
            for row, corner in topology.corners_at(node)
            if has_corner(topology.polygon(row), corner)
        ]

    def oncoming(self, row: int, entry: Point, heading: Floats, others: Sequence[Tip]) -> list[End]:
        """Return where cracks that come towards another end at the boundary of a row ahead of it.

        heading : (3,), of the other in the reference film; ``entry`` is its place in the row.
        """
        found: list[End] = []
        if self.sides_only:
            return found  # it meets them at nodes
        polygon = self.topology.polygon(row)
        for other in others:
            if product(other.heading, heading) > ONCOMING or row in other.behind:
                continue
            place = self._place_at(row, other)
            if place is None or common_side(polygon, entry, place) is not None:
                continue
            for i, (point, after, side) in enumerate(edges(polygon)):
                if hypot(point[0] - place[0], point[1] - place[1]) < AWAY:
                    on = polygon.sides[i - 1] if side == FLANK else side
                    found.append(End(point, i, on))
                    break
                if fraction_between(point, after, place) is not None:
                    found.append(End(place, i, side))
                    break
        return found

    def _place_at(self, row: int, tip: Tip) -> Point | None:
        """Return where a tip lies in the quad of a row, None if it does not touch that."""
        ring = self.ring(row)
        if tip.flank is not None:
            return tip.flank if self.topology.parent(row) == tip.quad else None
        a, b = tip.ends
        if a not in ring or b not in ring:
            return None
        if tip.at_node:
            return CORNERS[ring.index(a)]
        side = next((k for k in range(4) if {ring[k], ring[(k + 1) % 4]} == {a, b}), None)
        if side is None:
            return None
        s = tip.s if ring[side] == a else 1.0 - tip.s
        known = self.topology.crossings(ring[side], ring[(side + 1) % 4])
        return on_side(side, next((one for one in known if abs(one - s) < AWAY), s))

    def may_break(self, row: int, start: int, end: int) -> bool:
        """Return whether a crack may run along a side: whole film on both sides of it."""
        topology, ring = self.topology, self.ring(row)
        a, b = ring[start], ring[end]
        quads = {topology.parent(one) for one, _, _ in topology.rows_beside(a, b)}
        if len(quads) < 2 or topology.is_broken(a, b):
            return False
        return self.sides_only or not topology.crossings(a, b)

    def place_in(self, state: State, row: int, place: Point) -> Place:
        """Return where a place of a row is now."""
        weights, nodes = np.array(shape_functions(*place)), state.quads[row]
        t = product(weights, state.node.t[nodes])
        return Place(
            product(weights, state.node.x[nodes]),
            unit(t),
            self.size(row),
            self.reference_director(row, place),
        )

    def way_of(self, state: State, segment: Segment) -> Floats:
        """Return the unit direction of a segment in space, shape (3,)."""
        gap = np.array(shape_functions(*segment.exit)) - np.array(shape_functions(*segment.entry))
        return unit(product(gap, state.node.x[state.quads[segment.row]]))

    def reference_director(self, row: int, place: Point) -> Floats:
        """Return the unit director at a place of a row in the reference film, shape (3,)."""
        film = self._shell.reference
        return unit(product(shape_functions(*place), film.t[film.quads[row]]))

    def carried_on(self, row: int, place: Point, heading: Floats) -> Floats:
        """Return weights of a row's nodes that give, of their positions, a heading, shape (4,).

        The heading is a direction in the reference film behind a tip. It goes on into the tangent
        plane of the row ahead, by projection, and moves with that row: as the line of film ahead of
        the tip that lay in its direction.
        """
        quad = self.topology.parent(row)
        along, slopes = self._parts_of(quad, place, tuple(heading.tolist()))
        return np.asarray(product(along, slopes))

    def _past_a_row(self, at: tuple[int, Point], tip: Tip) -> float:
        """Return how far a heading points past a row at a corner, 0 or less into it, 1 backwards.

        To so many digits that rows on either side of a straight crack are equal.

        at : row and corner.  tip : whose heading.
        """
        row, (xi, eta) = at
        along, _ = self._parts_of(self.topology.parent(row), at[1], tuple(tip.heading.tolist()))
        a, b = along.tolist()
        past: float = round(max(a * xi, b * eta) / max(abs(a), abs(b)), 6)
        return past

    def _heading_in(self, quad: int, place: Point, heading: Vec3) -> tuple[Floats, Floats]:
        """Return a heading in (xi, eta) of a quad, and the slopes of shape functions, (2, 4)."""
        slopes, film = shape_slopes(place), self._shell.reference
        along = least_squares(product(slopes, film.x[film.quads[quad]]).T, np.array(heading))
        return along, slopes

    def at_tip(self, tip: Tip, rows: Floats) -> Floats:
        """Return rows : (n_node, k) of the mesh's nodes at a tip, shape (k,)."""
        if tip.flank is not None:
            corners = self._shell.mesh_quads[tip.quad]
            return np.asarray(product(shape_functions(*tip.flank), rows[corners]))
        a, b = rows[list(tip.ends)]
        return np.asarray(a + tip.s * (b - a))

    def nodes_of(self, state: State, tips: Sequence[Tip]) -> Ints:
        """Return the nodes of tips with film ahead that lie at nodes, shape (n_tip,)."""
        first = [rows[0] for tip in tips if (rows := self.rows_ahead(tip))]
        return np.array([state.quads[row, corner_at(place)] for row, place in first], np.int64)

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
            if on_it and height < size and -AWAY < ahead < min(best, 1.0 + AWAY):
                best, direction = ahead, unit(way)
                at_end = next((n for n, at in ((a, 0.0), (b, 1.0)) if abs(s - at) < SNAP), None)
                if at_end is not None:
                    found = Tip((at_end, at_end), 0.0, -1, direction)
                else:
                    ends, s = ((a, b), s) if a < b else ((b, a), 1.0 - s)
                    found = Tip(ends, float(s), -1, direction)
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
            self._tables[of] = self._both(table_of(state, self, ahead, ends)) if ahead else None
        tables = self._tables[of]
        return tables and self._segment(state, tables, direction, lean)

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
        tables = self._both(table_of(state, self, [(row, entry)], [ends]))
        return self._segment(state, tables, direction, lean)

    def _both(self, table: RowsAhead) -> tuple[RowsAhead, RowsAhead]:
        """Return a table as it is, and laid out for the kernel."""
        return table, self._hold(table)

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
        self,
        state: State,
        tables: tuple[RowsAhead, RowsAhead],
        direction: Floats,
        lean: Floats | None,
    ) -> Segment | None:
        """Return the segment through the first row of a table into which a direction leads."""
        table, held = tables
        self._leave(
            held,
            np.array([0, len(table.row)]),
            np.ascontiguousarray(direction).reshape(1, 1, 3),
            _STRAIGHT_UP if lean is None else np.ascontiguousarray(lean).reshape(1, 3),
            state.node.x,
            state.node.t,
            self._held_aimed,
        )
        return self.segment_of(table, self._aimed, 0)

    def segment_of(self, ahead: RowsAhead, aimed: Aimed, i: int) -> Segment | None:
        """Return the segment that the kernel has found from tip i, None if it has none."""
        k, kind, j, nth = aimed.way[i].tolist()
        if k < 0:
            return None
        row, (xi, eta), right = int(ahead.row[k]), ahead.entry[k].tolist(), float(aimed.right[i])
        side, (to_xi, to_eta) = self.topology.polygon(row).sides[j], aimed.exit[i].tolist()
        end = to_xi, to_eta
        if kind in (AT_POINT, ALONG_SIDE, AT_END):
            side = nth
        elif kind == AT_CROSSING:
            end = on_side(side, float(ahead.known[ahead.crossing[k, j, 0] + nth]))
        elif side != FLANK:
            end = on_side(side, along_side(side, end))
        return Segment(row, (xi, eta), end, side, corner_at(end), kind == ALONG_SIDE, right)

    def between(self, tip: Tip, other: Tip) -> Segment | None:
        """Return the segment along a side from a tip to another; None if they do not lie on one.

        One of the tips may be at its end; no third crack may cross it between them.
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
        low, high = min(places), max(places)
        if any(low + AWAY < s < high - AWAY for s in self.topology.crossings(*side)):
            return None
        for row, k, up in self.topology.rows_beside(*side):
            start, stop = (on_side(k, s if up else 1.0 - s) for s in places)
            if common_side(self.topology.polygon(row), start, stop) == k:
                return Segment(row, start, stop, k, corner_at(stop), along_side=True)
        return None

    def tip_at(self, end: Segment, heading: Floats) -> Tip | None:
        """Return the tip at the end of a segment that has just been cut; None at a rim.

        Where that has come to an earlier crack :meth:`tip_across` finds it.
        """
        ring, quad = self.ring(end.row), self.topology.parent(end.row)
        if end.corner >= 0:
            node = ring[end.corner]
            tip = Tip((node, node), 0.0, quad, heading)
        else:
            tip = Tip(*end.on_side_of(ring), quad, heading)
        return tip if self.rows_ahead(tip) else None

    def tip_across(self, state: State, end: Segment, heading: Floats) -> Tip | None:
        """Return the tip on the other flank of the crack at which a segment has ended.

        None where there is no film beyond, at a rim.

        heading : (3,), direction of the segment in the reference film.
        """
        way = self.way_of(state, end)
        touching = self.rows_at(self.topology.parent(end.row), end.exit)
        ahead = next((at for at in touching if self.segment(state, *at, way) is not None), None)
        if ahead is None:
            return None
        row, place = ahead
        nodes = nodes_at(state, row, place)
        behind = tuple(other for other, at in touching if nodes_at(state, other, at) != nodes)
        return Tip((-1, -1), 0.0, self.topology.parent(row), heading, place, behind)
