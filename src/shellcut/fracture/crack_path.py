"""Where a crack goes next: from its tip through the quad ahead to a place on its boundary.

A tip lies on a side of the mesh, at a node of it, or on the flank of an earlier cut that the crack
has run into. From there a ray goes through the polygon of the row ahead. Where its segment ends
([METHOD2] 12, rule 8, each line the cure of a failure), in this order:

1. on a crossing of another crack within ``MERGE`` edge lengths, measured across the ray; if that
   crack leads there from the tip, there is nothing left to cut;
2. at a corner within ``SNAP`` edge lengths across the ray, if it is not on the side where the
   segment begins; from a node, a side that the ray leaves by less than that is broken as a side;
3. on the side itself, at least ``SNAP`` of it from its corners.

Distances across the ray are those in the sheet: out of it, folds under a blade do not count.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import hypot

import numpy as np

from shellcut.arrays import Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .cut_topology import CutTopology
from .quad_fans import boundary_edges
from .quad_polygon import (
    CORNERS,
    FLANK,
    Point,
    Polygon,
    along_side,
    corner_at,
    has_corner,
    holds,
    on_side,
    shape_functions,
    side_at,
    side_of,
    span,
)
from .tip import Place, Tip

MERGE = 0.15
"""Crossings of another crack nearer than this, in edge lengths across the ray, are met."""

SNAP = 0.05
"""Corners nearer than this, in edge lengths across the ray, are met; crossings keep this part of
the side away from them."""

ALONG = 1.0 / 3.0
"""Of the way ahead: a flank that leads to such a point no farther beside the ray is a crack along
it."""

GRAZE = 0.2
"""Of the way ahead: a ray that misses a corner at the end of the tip's own side by less, on the far
side of it, runs along that side, and the segment passes the corner on the near side."""

# Of the parametric square: far above round-off.
AWAY = 1e-6


@dataclass(frozen=True)
class Segment:
    """A straight way of a crack through a row."""

    row: int
    entry: Point
    exit: Point
    side: int
    """Side of the quad on which the exit lies, FLANK on an earlier cut."""
    corner: int
    """Corner of the quad at the exit, -1 if it is none."""
    along_side: bool = False
    """Whether it runs from corner to corner along a side of the quad."""


class CrackPath:
    """Finds the rows ahead of tips and the segments through them.

    Parameters
    ----------
    topology : CutTopology
        Which rows there are.
    shell : MITC4Shell
        Gives the nodes of the mesh at their corners and their sizes.
    """

    def __init__(self, topology: CutTopology, shell: MITC4Shell) -> None:
        self._topology, self._shell = topology, shell

    def ring(self, row: int) -> list[int]:
        """Return the nodes of the mesh at the corners of a row."""
        return [int(n) for n in self._shell.mesh_quads[row]]

    def size(self, row: int) -> float:
        """Return the local edge length, sqrt(quad area) [mm]."""
        return float(np.sqrt(self._shell.area[row]))

    def rows_ahead(self, tip: Tip) -> list[tuple[int, Point]]:
        """Return the rows into which a crack may run from its tip, and the tip's place in each."""
        topology = self._topology
        if tip.flank is not None:
            touching = self.rows_at(tip.quad, tip.flank)
            return [(row, place) for row, place in touching if row not in tip.behind]
        if tip.at_node:
            return self._rows_at_node(tip.ends[0])
        found = []
        a, b = tip.ends
        for row, corner in topology.corners_at(a):
            quad, ring = topology.parent(row), self.ring(row)
            if quad == tip.quad or b not in ring:
                continue
            goes_up = ring[(corner + 1) % 4] == b
            side, s = (corner, tip.s) if goes_up else ((corner - 1) % 4, 1.0 - tip.s)
            held = span(topology.polygon(row), side)
            if held is not None and held[0] < s - AWAY and held[1] > s + AWAY:
                found.append((row, on_side(side, s)))
        return found

    def node_of(self, tip: Tip) -> int:
        """Return the node of the mesh at which a tip lies, -1 if at none."""
        if tip.flank is None:
            return tip.ends[0] if tip.at_node else -1
        corner = corner_at(tip.flank)
        return self.ring(tip.quad)[corner] if corner >= 0 else -1

    def rows_at(self, quad: int, place: Point) -> list[tuple[int, Point]]:
        """Return the rows whose film touches a place on the boundary of a row, and where it is.

        The place is one of a quad of the mesh, whose own rows come first; at a corner and on a side
        those of its neighbours touch it too.
        """
        topology, ring = self._topology, self.ring(quad)
        corner, side = corner_at(place), side_at(place)
        if corner >= 0:
            every = self._rows_at_node(ring[corner])
            return sorted(every, key=lambda at: topology.parent(at[0]) != quad)
        mine = [(row, place) for row in topology.rows_of(quad)]
        if side >= 0:
            a, b, s = ring[side], ring[(side + 1) % 4], along_side(side, place)
            mine += [
                (row, on_side((at - 1) % 4, 1.0 - s))
                for row, at in topology.corners_at(a)
                if topology.parent(row) != quad and self.ring(row)[(at - 1) % 4] == b
            ]
        return [(row, at) for row, at in mine if side_of(topology.polygon(row), at) is not None]

    def _rows_at_node(self, node: int) -> list[tuple[int, Point]]:
        """Return the rows whose film reaches a node of the mesh, and the corner there."""
        topology = self._topology
        return [
            (row, CORNERS[corner])
            for row, corner in topology.corners_at(node)
            if has_corner(topology.polygon(row), corner)
        ]

    def place_of(self, state: State, tip: Tip) -> Place | None:
        """Return where a tip is now.

        None where no film is ahead: at a rim, and where another crack has come across.
        """
        ahead = self.rows_ahead(tip)
        if not ahead:
            return None
        (row, place), *_ = ahead
        forward = self.carried_on(row, place, tip.heading)
        at = self.place_in(state, row, place)
        return at._replace(heading=forward @ state.node.x[state.quads[row]])

    def place_in(self, state: State, row: int, place: Point) -> Place:
        """Return a place of a row now, its heading still zero."""
        weights, nodes = np.array(shape_functions(place)), state.quads[row]
        t = weights @ state.node.t[nodes]
        return Place(
            weights @ state.node.x[nodes],
            t / np.linalg.norm(t),
            self.size(row),
            self.reference_director(row, place),
            np.zeros(3),
        )

    def reference_director(self, row: int, place: Point) -> Floats:
        """Return the unit director at a place of a row in the reference film, shape (3,)."""
        film = self._shell.reference
        T = np.array(shape_functions(place)) @ film.t[film.quads[row]]
        return np.asarray(T / np.linalg.norm(T))

    def carried_on(self, row: int, place: Point, heading: Floats) -> Floats:
        """Return weights of a row's nodes that give, of their positions, a heading, shape (4,).

        The heading is a direction in the reference film behind a tip. It goes on into the tangent
        plane of the row ahead, by projection, and moves with that row: as the line of film ahead of
        the tip that lay in its direction.
        """
        (xi, eta), film = place, self._shell.reference
        gradients = 0.25 * np.array(
            [
                [eta - 1.0, 1.0 - eta, 1.0 + eta, -1.0 - eta],
                [xi - 1.0, -1.0 - xi, 1.0 + xi, 1.0 - xi],
            ]
        )
        along, *_ = np.linalg.lstsq((gradients @ film.x[film.quads[row]]).T, heading, rcond=None)
        return np.asarray(along @ gradients)

    def reference_of(self, state: State, tip: Tip) -> Floats:
        """Return where a tip lies in the reference film [mm], shape (3,)."""
        if tip.flank is not None:
            X = state.node.X[self._shell.mesh_quads[tip.quad]]
            return np.asarray(np.array(shape_functions(tip.flank)) @ X)
        a, b = state.node.X[list(tip.ends)]
        return np.asarray(a + tip.s * (b - a))

    def rim_tip(self, state: State, start: Floats, end: Floats) -> Tip | None:
        """Return a tip on the rim where a line between two points first crosses it.

        Seen along the film's normal there: on a curved film the line leaves the sheet, and a side
        of the rim is crossed from which it is nearer than the side is long.
        """
        way = end - start
        best, found = np.inf, None
        for a, b in boundary_edges(state).tolist():
            A, B = state.node.X[[a, b]]
            size, n = float(np.linalg.norm(A - B)), state.node.t[a] + state.node.t[b]
            n /= np.linalg.norm(n)
            in_sheet = np.stack([way, A - B, A - start], axis=1)
            in_sheet -= np.outer(n, n @ in_sheet)
            base, gap = in_sheet[:, :2], in_sheet[:, 2]
            (ahead, s), *_ = np.linalg.lstsq(base, gap, rcond=None)
            miss = np.linalg.norm(base @ (ahead, s) - gap)
            on_it = miss < AWAY * size and -AWAY < s < 1.0 + AWAY
            height = abs((A + s * (B - A) - start - ahead * way) @ n)
            if on_it and height < size and -AWAY < ahead < min(best, 1.0):
                best, unit = ahead, way / np.linalg.norm(way)
                at_end = next((n for n, at in ((a, 0.0), (b, 1.0)) if abs(s - at) < SNAP), None)
                if at_end is not None:
                    found = Tip((at_end, at_end), 0.0, -1, unit, 0.0)
                else:
                    ends, s = ((a, b), s) if a < b else ((b, a), 1.0 - s)
                    found = Tip(ends, float(s), -1, unit, 0.0)
        return found

    def segment_from(
        self, state: State, tip: Tip, direction: Floats, lean: Floats | None = None
    ) -> Segment | None:
        """Return the segment from a tip in a direction in space, None if no row lies there.

        lean : of the plane in which it lies, see :meth:`segment`.
        """
        ahead = self.rows_ahead(tip)
        found = (self.segment(state, row, entry, direction, lean) for row, entry in ahead)
        return next((one for one in found if one is not None), None)

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
            a, b = ring[end.side], ring[(end.side + 1) % 4]
            s = along_side(end.side, end.exit)
            ends, s = ((a, b), s) if a < b else ((b, a), 1.0 - s)
            tip = Tip(ends, s, quad, heading, length)
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
        polygon, nodes = self._topology.polygon(row), state.quads[row]
        weights = np.array(shape_functions(entry))
        x, t = state.node.x[nodes], weights @ state.node.t[nodes]
        gaps = np.array([shape_functions(p) for p in polygon.points]) @ x - weights @ x
        t = t / np.linalg.norm(t)
        normal = np.cross(t if lean is None else t - lean, direction)
        if (size := float(np.linalg.norm(normal))) < AWAY:
            return None  # no direction in the sheet
        off = gaps @ (normal / size)
        hit = _first_edge(polygon, entry, off, gaps @ direction)
        if hit is None:
            return self._past_a_corner(row, entry, off, gaps @ direction)
        i, along = hit
        j = (i + 1) % len(polygon.points)
        side, a, b = polygon.sides[i], polygon.points[i], polygon.points[j]
        size = self.size(row)
        for k in (i, j):
            end = polygon.points[k]
            corner = corner_at(end)
            if abs(off[k]) >= (SNAP if corner >= 0 else MERGE) * size:
                continue
            on = common_side(polygon, entry, end)
            if on is None:
                return Segment(row, entry, end, side, corner)
            if on == FLANK and abs(off[k]) < ALONG * (gaps[k] @ direction):
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
        reach = MERGE * size / float(np.linalg.norm(x[(side + 1) % 4] - x[side]))
        for known in self._topology.crossings(ring[side], ring[(side + 1) % 4]):
            if abs(known - s) < reach and holds(polygon, on_side(side, known)):
                places.insert(0, on_side(side, known))
        for place in places:
            if common_side(polygon, entry, place) is None:
                return Segment(row, entry, place, side, -1)
        return None

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


def is_on(point: Point, a: Point, b: Point) -> bool:
    """Return whether a point lies on the line through a and b."""
    d = b[0] - a[0], b[1] - a[1]
    height = abs((point[0] - a[0]) * d[1] - (point[1] - a[1]) * d[0])
    return height < AWAY * hypot(*d)
