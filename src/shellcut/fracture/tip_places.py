"""Where crack tips lie: in the mesh, in space and in the reference film; which rows are ahead."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .cut_topology import CutTopology
from .quad_polygon import (
    CORNERS,
    Point,
    along_side,
    corner_at,
    has_corner,
    on_side,
    shape_functions,
    shape_slopes,
    side_at,
    side_of,
    span,
)
from .segment import Segment
from .tip import Place, Tip

AWAY = 1e-6
"""Of the parametric square, or of a side of it: far above round-off."""


class TipPlaces:
    """Finds where tips lie, and the rows ahead of them.

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
        """Return the rows into which a crack may run from its tip, and the tip's place in each.

        At a node those come first into whose corner the crack's heading points, or nearly: where
        film is folded at the tip, a row beside the crack says nothing of the way ahead.
        """
        topology = self._topology
        if tip.flank is not None:
            touching = self.rows_at(tip.quad, tip.flank)
            return [(row, place) for row, place in touching if row not in tip.behind]
        if tip.at_node:
            every = self._rows_at_node(tip.ends[0])
            return sorted(every, key=lambda at: self._beside(at[0], at[1], tip.heading))
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

    def way_of(self, state: State, segment: Segment) -> Floats:
        """Return the unit direction of a segment in space, shape (3,)."""
        gap = np.array(shape_functions(segment.exit)) - np.array(shape_functions(segment.entry))
        way = gap @ state.node.x[state.quads[segment.row]]
        return np.asarray(way / np.linalg.norm(way))

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
        along, gradients = self._parts_of(row, place, heading)
        return np.asarray(along @ gradients)

    def _beside(self, row: int, corner: Point, heading: Floats) -> float:
        """Return how far a heading points past a row at a corner, at most 0 into it, 1 back."""
        along, _ = self._parts_of(
            row, corner, heading
        )  # rounded: rows beside a straight crack are equal
        return round(float((along * corner).max() / np.abs(along).max()), 6)

    def _parts_of(self, row: int, place: Point, heading: Floats) -> tuple[Floats, Floats]:
        """Return a heading in (xi, eta) of a row, shape (2,), and what gives gradients, (2, 4)."""
        film, gradients = self._shell.reference, shape_slopes(place)
        along, *_ = np.linalg.lstsq((gradients @ film.x[film.quads[row]]).T, heading, rcond=None)
        return np.asarray(along), gradients

    def reference_of(self, state: State, tip: Tip) -> Floats:
        """Return where a tip lies in the reference film [mm], shape (3,)."""
        if tip.flank is not None:
            X = state.node.X[self._shell.mesh_quads[tip.quad]]
            return np.asarray(np.array(shape_functions(tip.flank)) @ X)
        a, b = state.node.X[list(tip.ends)]
        return np.asarray(a + tip.s * (b - a))

    def nearest(self, state: State, tip: Tip, others: Sequence[Tip]) -> float:
        """Return how near the nearest other tip is in the reference film [mm], inf if none is."""
        here = self.reference_of(state, tip)
        gaps = [self.reference_of(state, one) - here for one in others if one is not tip]
        return min((float(np.linalg.norm(gap)) for gap in gaps), default=np.inf)
