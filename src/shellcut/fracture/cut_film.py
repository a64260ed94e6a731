"""The film as cuts have left it: where crack tips lie in it, and which rows touch a place.

A tip lies on a side of the mesh, at a node of it, or on the flank of an earlier cut that the crack
has run into. Rows touch a place whose polygon has it on its boundary.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import hypot
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, product, unit
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.small_matrices import least_squares
from shellcut.state import OncePerTopology, State

from .cut_topology import CutTopology
from .film_around import film_around
from .quad_polygon import (
    AWAY,
    CORNERS,
    FLANK,
    Point,
    along_side,
    common_side,
    corner_at,
    edge_at,
    edges,
    fraction_between,
    has_corner,
    on_side,
    shape_slopes,
    side_at,
    span,
)
from .tip import Place, Segment, Tip

ONCOMING = -0.7
"""Cosine of the headings of two cracks below which they run towards each other."""


class End(NamedTuple):
    """Where a crack ends at the boundary of a row."""

    place: Point
    edge: int
    """Edge of the polygon on which it lies, or point at which it is."""
    side: int
    """Side of the quad on which it lies, FLANK if on none."""


class CutFilm:
    """Tells of the film at crack tips and at places of its rows.

    Parameters
    ----------
    topology : CutTopology
        How the film is cut.
    shell : MITC4Shell
        Gives the nodes of the mesh at the corners of rows, and their sizes.
    sides_only : bool
        Whether cracks run along sides of the mesh only.
    """

    def __init__(
        self, topology: CutTopology, shell: MITC4Shell, *, sides_only: bool = False
    ) -> None:
        self.topology, self._shell, self.sides_only = topology, shell, sides_only
        # It depends on the mesh alone, and rows are searched anew after every cut.
        self._parts_of = lru_cache(maxsize=1024)(self._heading_in)
        self._around = OncePerTopology[dict[tuple[int, float], Ints]](lambda _: {})

    def ring(self, row: int) -> list[int]:
        """Return the nodes of the mesh at the corners of a row."""
        ring: list[int] = self._shell.mesh_quads[row].tolist()
        return ring

    def size(self, row: int) -> float:
        """Return the local edge length, sqrt(quad area) [mm]."""
        return float(np.sqrt(self._shell.area[row]))

    def around(self, state: State, row: int, reach: float) -> Ints:
        """Return the rows with film within a reach [mm] of a place of a row, connected with it.

        Their middles and the place are within an edge length of those of the rows.
        """
        known, film = self._around.of(state), self._shell.reference
        if (row, reach) not in known:
            nodes, radius = film.quads[row], reach + 2.0 * self.size(row)
            place, T = film.x[nodes].mean(axis=0), film.t[nodes].sum(axis=0)
            known[row, reach] = film_around(state, self._shell, place, T, radius, [row])
        return known[row, reach]

    def rows_ahead(self, tip: Tip) -> list[tuple[int, Point]]:
        """Return the rows into which a crack may run from its tip, and the tip's place in each.

        At a node those are first into whose corner the crack's heading points, or nearly: where a
        blade folds film at the tip, a row beside the crack says nothing of the direction ahead.
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
            s, interval = tip.s if up else 1.0 - tip.s, span(topology.polygon(row), side)
            if interval is not None and interval[0] < s - AWAY and interval[1] > s + AWAY:
                found.append((row, on_side(side, s)))
        return found

    def rows_at(self, quad: int, place: Point) -> list[tuple[int, Point]]:
        """Return the rows whose film touches a place on the boundary of a row, and where it is.

        The place is one of a quad of the mesh, whose own rows are first; at a corner and on a side
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
        return [(row, at) for row, at in mine if edge_at(topology.polygon(row), at) >= 0]

    def _rows_at_node(self, node: int) -> list[tuple[int, Point]]:
        """Return the rows whose film reaches a node of the mesh, and the corner there."""
        topology = self.topology
        return [
            (row, CORNERS[corner])
            for row, corner in topology.corners_at(node)
            if has_corner(topology.polygon(row), corner)
        ]

    def oncoming(self, row: int, entry: Point, heading: Floats, others: Sequence[Tip]) -> list[End]:
        """Return where cracks that run towards another end at the boundary of a row ahead of it.

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
        return on_side(side, next((crossing for crossing in known if abs(crossing - s) < AWAY), s))

    def may_break(self, row: int, start: int, end: int) -> bool:
        """Return whether a crack may run along a side: whole film on both sides of it."""
        topology, ring = self.topology, self.ring(row)
        a, b = ring[start], ring[end]
        quads = {topology.parent(beside) for beside, _, _ in topology.rows_beside(a, b)}
        if len(quads) < 2 or topology.is_broken(a, b):
            return False
        return self.sides_only or not topology.crossings(a, b)

    def between(self, tip: Tip, other: Tip) -> Segment | None:
        """Return the segment along a side from a tip to another; None if on no common side.

        One of the tips may be at its end; no third crack may cross it between them.
        """
        if tip.flank is not None or other.flank is not None or (tip.at_node and other.at_node):
            return None
        side = other.ends if tip.at_node else tip.ends
        places = []
        for end in (tip, other):
            if end.at_node and end.ends[0] in side:
                places.append(float(side.index(end.ends[0])))
            elif end.ends == side:
                places.append(end.s)
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

    def place_in(self, state: State, row: int, place: Point) -> Place:
        """Return where a place of a row is now."""
        weights, nodes = np.array(shape_functions(*place)), state.quads[row]
        return Place(
            product(weights, state.node.x[nodes]),
            unit(product(weights, state.node.t[nodes])),
            self.size(row),
            self.reference_director(row, place),
        )

    def depth_at(self, state: State, row: int, place: Point) -> float:
        """Return how far a place of a row has been pushed out of the reference film [mm]."""
        at = self.place_in(state, row, place)
        before = product(np.array(shape_functions(*place)), state.node.X[state.quads[row]])
        return abs(float(product(at.x - before, at.T)))

    def reference_director(self, row: int, place: Point) -> Floats:
        """Return the unit director at a place of a row in the reference film, shape (3,)."""
        film = self._shell.reference
        return unit(product(shape_functions(*place), film.t[film.quads[row]]))

    def heading_weights(self, row: int, place: Point, heading: Floats) -> Floats:
        """Return weights of a row's nodes that give, of their positions, a heading, shape (4,).

        The heading is a direction in the reference film behind a tip. It continues into the tangent
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
