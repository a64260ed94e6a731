"""Where a crack goes next: from its tip through the quad ahead to a place on its boundary.

A tip lies on a side of the mesh, at a node of it, or on the flank of an earlier cut that the crack
has run into. From there a ray goes through the polygon of the row ahead. Where its segment ends
([METHOD2] 12, rule 8, each line the cure of a failure), in this order:

1. where a crack that comes towards it ends, within ``JOIN`` edge lengths, measured across the ray;
2. on a crossing of another crack within ``MERGE``; if that crack leads there from the tip, there is
   nothing left to cut;
3. at a corner within ``SNAP``, if it is not on the side where the segment begins; from a
   node, a side that the ray leaves by less than that is broken as a side;
4. on the side itself, at least ``SNAP`` of it from its corners.

A crack whose new tip lies on the very side on which an oncoming one ends, nearer than ``JOIN``
across its way, has no row left to go through: the part of the side between them is torn.

Distances across the ray are those in the sheet: out of it, folds under a blade do not count.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import hypot
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, norm, product, unit
from shellcut.numerics.small_matrices import least_squares
from shellcut.state import State

from .quad_fans import boundary_edges
from .quad_polygon import (
    CORNERS,
    FLANK,
    Point,
    Polygon,
    along_side,
    corner_at,
    holds,
    on_side,
    shape_functions,
)
from .segment import Segment
from .tip import Tip
from .tip_places import AWAY, TipPlaces

JOIN = 0.3
"""Ends of cracks that come towards a tip are met if nearer than this, in edge lengths across the
ray: the two would run past each other with a strip between them that no mesh resolves."""

ONCOMING = -0.7
"""Cosine of the headings of two cracks below which they come towards each other."""

MERGE = 0.15
"""Crossings of another crack that are nearer than this are met."""

SNAP = 0.05
"""Corners that are nearer than this are met; crossings keep this part of the side away from
them."""

ALONG = 1.0 / 3.0
"""Of the way ahead: a flank that leads to such a point no farther beside the ray is a crack along
it."""

GRAZE = 0.2
"""Of the way ahead: a ray that misses a corner at the end of the tip's own side by less, on the far
side of it, runs along that side, and the segment passes the corner on the near side."""


class End(NamedTuple):
    """Where a crack ends at the boundary of a row."""

    place: Point
    edge: int
    """Edge of the polygon on which it lies, or point at which it is."""
    at_point: bool


class CrackPath(TipPlaces):
    """Finds the segments through the rows ahead of tips."""

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

        lean : of the plane in which it lies, see :meth:`segment`.  others : tips that it may join.
        """
        ahead = self.rows_ahead(tip)
        for row, entry in ahead:
            ends = self.oncoming(row, entry, tip.heading, others)
            joined = self.to_an_end(state, row, entry, direction, lean, ends) if ends else None
            if joined is not None:
                return joined
        found = (self.segment(state, row, entry, direction, lean) for row, entry in ahead)
        return next((one for one in found if one is not None), None)

    def oncoming(self, row: int, entry: Point, heading: Floats, others: Sequence[Tip]) -> list[End]:
        """Return where cracks that come towards another end at the boundary of a row ahead of it.

        heading : (3,), of the other in the reference film; ``entry`` is its place in the row.
        """
        polygon, found = self._topology.polygon(row), []
        points = polygon.points
        for other in others:
            if product(other.heading, heading) > ONCOMING or row in other.behind:
                continue
            place = self._place_at(row, other)
            if place is None or common_side(polygon, entry, place) is not None:
                continue
            for i, point in enumerate(points):
                if hypot(point[0] - place[0], point[1] - place[1]) < AWAY:
                    found.append(End(point, i, at_point=True))
                    break
                if is_between(place, point, points[i + 1 - len(points)]):
                    found.append(End(place, i, at_point=False))
                    break
        return found

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
        if any(low < s < high for s in self._topology.crossings(*side)):
            return None
        return side, places[0], places[1]

    def _place_at(self, row: int, tip: Tip) -> Point | None:
        """Return where a tip lies in the quad of a row, None if it does not touch that."""
        ring = self.ring(row)
        if tip.flank is not None:
            return tip.flank if self._topology.parent(row) == tip.quad else None
        a, b = tip.ends
        if a not in ring or b not in ring:
            return None
        if tip.at_node:
            return CORNERS[ring.index(a)]
        side = next((k for k in range(4) if {ring[k], ring[(k + 1) % 4]} == {a, b}), None)
        if side is None:
            return None
        s = tip.s if ring[side] == a else 1.0 - tip.s
        known = self._topology.crossings(ring[side], ring[(side + 1) % 4])
        return on_side(side, next((one for one in known if abs(one - s) < AWAY), s))

    def may_break(self, row: int, start: int, end: int) -> bool:
        """Return whether a crack may run along a side: whole film on both sides of it."""
        ring = self.ring(row)
        a, b = ring[start], ring[end]
        beside = [r for r, _ in self._topology.corners_at(a) if b in self.ring(r)]
        return (
            len({self._topology.parent(r) for r in beside}) == 2
            and not self._topology.is_broken(a, b)
            and not self._topology.crossings(a, b)
        )

    def tip_at(self, end: Segment, heading: Floats, length: float) -> Tip | None:
        """Return the tip at the end of a segment that has just been cut; None at a rim.

        Where that has come to an earlier crack :mod:`.tip_across` finds it.
        """
        ring, quad = self.ring(end.row), self._topology.parent(end.row)
        if end.corner >= 0:
            node = ring[end.corner]
            tip = Tip((node, node), 0.0, quad, heading, length)
        else:
            tip = Tip(*end.on_side_of(ring), quad, heading, length)
        return tip if self.rows_ahead(tip) else None

    def segment(
        self,
        state: State,
        row: int,
        entry: Point,
        direction: Floats,
        lean: Floats | None = None,
    ) -> Segment | None:
        """Return the segment through a row from a place in it in a direction in space.

        It ends where a plane through that place meets the boundary of the row's polygon: sides are
        straight in space, chords of the parametric square are not. The plane lies along the
        direction and the director, from which it leans by ``lean``, shape (3,). None where the
        direction leads out of the polygon, unless it grazes the side on which it begins.
        """
        polygon = self._topology.polygon(row)
        ray = self._ray(state, row, entry, polygon.points, direction, lean)
        if ray is None:
            return None
        off, ahead = ray
        hit = _first_edge(polygon, entry, off, ahead)
        if hit is None:
            return self._past_a_corner(row, entry, off, ahead)
        i, along = hit
        j = (i + 1) % len(polygon.points)
        side, a, b = polygon.sides[i], polygon.points[i], polygon.points[j]
        size = self.size(row)
        for k in (i, j) if abs(off[i]) <= abs(off[j]) else (j, i):
            end = polygon.points[k]
            corner = corner_at(end)
            if abs(off[k]) >= (SNAP if corner >= 0 else MERGE) * size:
                continue
            on = common_side(polygon, entry, end)
            if on is None:
                return Segment(row, entry, end, side, corner)
            if on == FLANK and abs(off[k]) < ALONG * ahead[k]:
                return None  # there is a crack already
            start = corner_at(entry)
            if corner >= 0 and start >= 0 and on != FLANK and self.may_break(row, start, corner):
                return Segment(row, entry, CORNERS[corner], on, corner, along_side=True)
        if side == FLANK:
            exit_ = a[0] + along * (b[0] - a[0]), a[1] + along * (b[1] - a[1])
            return Segment(row, entry, exit_, FLANK, -1)
        s_a, s_b = along_side(side, a), along_side(side, b)
        s = s_a + min(max(along, SNAP), 1.0 - SNAP) * (s_b - s_a)
        places = [on_side(side, s)]
        ring = self.ring(row)
        x = state.node.x[state.quads[row]]
        reach = MERGE * size / float(norm(x[(side + 1) % 4] - x[side]))
        for known in self._topology.crossings(ring[side], ring[(side + 1) % 4]):
            if abs(known - s) < reach and holds(polygon, on_side(side, known)):
                places.insert(0, on_side(side, known))
        for place in places:
            if common_side(polygon, entry, place) is None:
                return Segment(row, entry, place, side, -1)
        return None

    def _ray(
        self,
        state: State,
        row: int,
        entry: Point,
        places: Sequence[Point],
        direction: Floats,
        lean: Floats | None,
    ) -> tuple[Floats, Floats] | None:
        """Return where places in a row lie from a ray, shape (n_place,) each [mm].

        Beside the plane of the ray (:meth:`segment`), and along it from the entry; None if the
        direction is none in the sheet.
        """
        nodes, weights = state.quads[row], np.array(shape_functions(entry))
        t = unit(product(weights, state.node.t[nodes]))
        normal = np.cross(t if lean is None else t - lean, direction)
        if (size := float(norm(normal))) < AWAY:
            return None
        gaps = product(
            np.array([shape_functions(p) for p in places]) - weights, state.node.x[nodes]
        )
        return product(gaps, normal / size), product(gaps, direction)

    def to_an_end(
        self,
        state: State,
        row: int,
        entry: Point,
        direction: Floats,
        lean: Floats | None,
        ends: Sequence[End],
    ) -> Segment | None:
        """Return the segment through a row to the one of some ends that is nearest to the ray.

        None if there is none ahead within ``JOIN``.
        """
        polygon = self._topology.polygon(row)
        ray = self._ray(state, row, entry, [end.place for end in ends], direction, lean)
        if ray is None:
            return None
        nearest, found = JOIN * self.size(row), None
        for end, off, ahead in zip(ends, *ray, strict=True):
            if abs(off) < nearest and ahead > 0.0:
                side = polygon.sides[end.edge]
                if side == FLANK and end.at_point:
                    side = polygon.sides[end.edge - 1]
                nearest = abs(off)
                found = Segment(row, entry, end.place, side, corner_at(end.place))
        return found

    def _past_a_corner(self, row: int, entry: Point, off: Floats, ahead: Floats) -> Segment | None:
        """Return the segment that passes a corner which a ray along a side just misses.

        off, ahead : (n_point,), of the polygon's points from the entry: beside the ray and along it
        [mm].
        """
        polygon, ring = self._topology.polygon(row), self.ring(row)
        points, n = polygon.points, len(polygon.points)
        on = [i for i in range(n) if is_on(entry, points[i], points[(i + 1) % n])]
        if len(on) != 1 or polygon.sides[on[0]] == FLANK:
            return None
        for k, edge, along in (
            ((on[0] + 1) % n, (on[0] + 1) % n, SNAP),
            (on[0], on[0] - 1, 1 - SNAP),
        ):
            side = polygon.sides[edge]
            if corner_at(points[k]) < 0 or side == FLANK or not abs(off[k]) < GRAZE * ahead[k]:
                continue
            s_a, s_b = (along_side(side, points[i % n]) for i in (edge, edge + 1))
            s = s_a + along * (s_b - s_a)
            known = self._topology.crossings(ring[side], ring[(side + 1) % 4])
            if all(abs(one - s) >= SNAP for one in known):
                return Segment(row, entry, on_side(side, s), side, -1)
        return None


def common_side(polygon: Polygon, one: Point, other: Point) -> int | None:
    """Return on which side of the quad two points of a polygon lie, None if on no common edge."""
    points = polygon.points
    for a, b, side in zip(points, (*points[1:], points[0]), polygon.sides, strict=True):
        if is_on(one, a, b) and is_on(other, a, b):
            return side
    return None


def _first_edge(
    polygon: Polygon, entry: Point, off: Floats, ahead: Floats
) -> tuple[int, float] | None:
    """Return which edge of a polygon a ray leaves by, and how far along it.

    off, ahead : (n_point,), of its points from the entry: beside the ray and along it [mm].
    """
    best, found = np.inf, None
    n = len(polygon.points)
    for i in range(n):
        j = (i + 1) % n
        a, b = polygon.points[i], polygon.points[j]
        if off[i] * off[j] > 0.0 or off[i] == off[j] or is_on(entry, a, b):
            continue
        along = float(off[i] / (off[i] - off[j]))
        way = float(ahead[i] + along * (ahead[j] - ahead[i]))
        if 0.0 < way < best:
            best, found = way, (i, along)
    return found


def is_between(point: Point, a: Point, b: Point) -> bool:
    """Return whether a point lies on the way from a to b."""
    d = b[0] - a[0], b[1] - a[1]
    part = (point[0] - a[0]) * d[0] + (point[1] - a[1]) * d[1]
    return is_on(point, a, b) and 0.0 < part < d[0] ** 2 + d[1] ** 2


def is_on(point: Point, a: Point, b: Point) -> bool:
    """Return whether a point lies on the line through a and b."""
    d = b[0] - a[0], b[1] - a[1]
    height = abs((point[0] - a[0]) * d[1] - (point[1] - a[1]) * d[0])
    return height < AWAY * hypot(*d)
