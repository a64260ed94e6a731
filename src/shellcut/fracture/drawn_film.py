"""The film as it is drawn: polygons of quads and copies, and the flanks of cracks between them.

Pictures and result files show of a copy the film that it carries, not its virtual nodes. A corner
of its polygon at a corner of the quad is the node there; any other is a point of its own,
interpolated from the copy's nodes. Two copies in neighbouring quads share a point on their common
side if they share both its nodes: where a crack is closed the drawing is, too. Where one of two
neighbours has a point on their side that the other has not, the other gets one there, and so do the
two flanks of a crack: outlines meet point by point.

Crack edges are found as along edges of the mesh: two edges with one polygon each that were one
before the cut.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, product
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import State

from .cut_topology import CutTopology
from .open_edges import crack_edges
from .quad_polygon import (
    FLANK,
    Point,
    along_side,
    ascending,
    corner_at,
    edges,
    fraction_between,
    on_side,
    side_at,
)

# Places on one side, or in one quad, that agree so far in its parametric length are the same.
_DIGITS = 6
_SAME = 1e-6


class DrawnFilm(NamedTuple):
    """Points, polygons and crack flanks of a film."""

    nodes: Ints
    """Nodes that each point is interpolated from, shape (n_point, 4)."""
    weight: Floats
    """And their weights; a node that is drawn itself has the weight 1, shape (n_point, 4)."""
    polygons: Ints
    """Points of every row, counter-clockwise, shape (n_row, n_corner), n_corner >= 4; one with
    fewer corners repeats its last point."""
    crack_edges: Ints
    """Points of both flanks of every crack edge, shape (n, 2, 2)."""

    @classmethod
    def of(cls, state: State, topology: CutTopology) -> DrawnFilm:
        """Return what there is to draw; good for this topology."""
        return _Outlines(state, topology).film()

    def at_points(self, rows: Floats) -> Floats:
        """Return rows : (n_node, k) of the nodes at the points, (n_point, k)."""
        at: Floats = np.einsum("pa,pak->pk", self.weight, rows[self.nodes])
        return at

    def all_at_points(self, flags: Bools) -> Bools:
        """Return where all nodes of a point have a flag : (n_node,)."""
        return np.asarray((flags[self.nodes] | (self.weight == 0.0)).all(axis=1))


class _Outlines:
    """Builds a :class:`DrawnFilm`."""

    def __init__(self, state: State, topology: CutTopology) -> None:
        self._state, self._topology = state, topology
        flank = state.flank
        drawn = state.node.real[: state.n_node].copy()
        drawn[flank.node[: flank.count]] = False
        self._drawn = np.flatnonzero(drawn)
        self._id = np.cumsum(drawn) - 1
        self._nodes: list[list[int]] = []
        self._weight: list[tuple[float, ...]] = []
        self._reference: list[int] = []
        # Points by where they are: in a quad, or on a side between two nodes; and by where they
        # were in the film before it was cut.
        self._points: dict[tuple[float, ...], int] = {}
        self._references: dict[tuple[float, ...], int] = {}
        # Places on sides of the mesh, as fractions of the distance from the lower origin of its
        # nodes.
        self._on: dict[tuple[int, int], list[float]] = {}
        self._in_quad: dict[int, list[Point]] = {}

    def film(self) -> DrawnFilm:
        """Return it."""
        state, topology = self._state, self._topology
        cut = topology.cut_rows()
        for row in cut:
            for place in topology.polygon(row).points:
                self._point(row, place)
                self._in_quad.setdefault(topology.parent(row), []).append(place)
        outlines = {row: self._outline(row) for row in self._touched() | set(cut)}
        width = max([4, *map(len, outlines.values())])
        polygons = np.repeat(self._id[state.quads], [1, 1, 1, width - 3], axis=1)
        for row, outline in outlines.items():
            polygons[row] = outline + outline[-1:] * (width - len(outline))
        own = self._drawn[:, None]
        nodes, weight = [np.repeat(own, 4, axis=1)], [np.eye(1, 4).repeat(own.size, axis=0)]
        if self._nodes:
            nodes.append(np.array(self._nodes))
            weight.append(np.array(self._weight))
        reference = np.concatenate([state.node.origin[self._drawn], self._reference]).astype(int)
        return DrawnFilm(
            np.concatenate(nodes),
            np.concatenate(weight),
            polygons,
            crack_edges(polygons, reference),
        )

    def _touched(self) -> set[int]:
        """Return the rows that have a side with places on it."""
        n = self._state.n_node
        ends = self._state.node.origin[self._state.quads]
        sides = np.sort(np.stack([ends, np.roll(ends, -1, axis=1)], axis=2), axis=2)
        keys = [i * n + j for i, j in self._on]
        touched = np.isin(product(sides, np.array([n, 1])), keys).any(axis=1)
        return set(np.flatnonzero(touched).tolist())

    def _outline(self, row: int) -> list[int]:
        """Return the points around a row, those that its neighbours have on its sides too."""
        polygon, ring = self._topology.polygon(row), self._state.quads[row].tolist()
        outline = []
        for start, end, side in edges(polygon):
            between: list[tuple[float, int]] = []
            if side == FLANK:
                for place in self._in_quad.get(self._topology.parent(row), ()):
                    if (s := fraction_between(start, end, place)) is not None:
                        between.append((s, self._point(row, place)))
            else:
                a, b = (int(self._state.node.origin[ring[k % 4]]) for k in (side, side + 1))
                low, high = along_side(side, start), along_side(side, end)
                for s in self._on.get((min(a, b), max(a, b)), ()):
                    along = s if a < b else 1.0 - s
                    if low + _SAME < along < high - _SAME:
                        between.append((along, self._point(row, on_side(side, along))))
            outline += [self._point(row, start), *(point for _, point in sorted(set(between)))]
        return list(dict.fromkeys(outline))

    def _point(self, row: int, place: Point) -> int:
        """Return the point at a place of a row."""
        ring = self._state.quads[row].tolist()
        corner = corner_at(place)
        if corner >= 0:
            return int(self._id[ring[corner]])
        side = side_at(place)
        if side < 0:
            at = tuple(round(coordinate, _DIGITS) for coordinate in place)
            parent = self._topology.parent(row)
            weight = shape_functions(*place)
            return self._numbered((row, *at), ring, weight, (parent, *at))
        a, b, s = ascending(ring[side], ring[(side + 1) % 4], along_side(side, place))
        origin = self._state.node.origin
        i, j, of_reference = ascending(int(origin[a]), int(origin[b]), s)
        reference = i, j, -1, round(of_reference, _DIGITS)
        if reference not in self._references:
            self._on.setdefault((i, j), []).append(of_reference)
        at_side = a, b, -1, round(s, _DIGITS)
        return self._numbered(at_side, [a, b, a, a], (1.0 - s, s, 0.0, 0.0), reference)

    def _numbered(
        self,
        place: tuple[float, ...],
        nodes: list[int],
        weight: tuple[float, ...],
        reference: tuple[float, ...],
    ) -> int:
        """Return the point at a place, a new one at first."""
        if place not in self._points:
            self._points[place] = self._drawn.size + len(self._nodes)
            self._nodes.append(nodes)
            self._weight.append(weight)
            new = self._state.n_node + len(self._references)
            self._reference.append(self._references.setdefault(reference, new))
        return self._points[place]
