"""Along which segments a blade cuts a row from a place within it, or on its boundary."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

import numpy as np

from shellcut.arrays import Floats, product, unit
from shellcut.state import State
from shellcut.tool.cutting_edge import BACK, VECTOR

from .blade_drive import BladeDrive
from .crack_path import NEAR, CrackPath
from .quad_polygon import WHOLE, Point, corner_at, onto_boundary, side_at
from .tip import Begun, Segment, Tip

# Of the parametric square: a ray from there leaves a quad by two sides.
_INNER = 0.75

# Part of its direction that counts in where an edge moves.
_ALONG = 1e-6


class BladeChords:
    """Finds the two segments from a place: to where an edge was, and to where it will be."""

    def __init__(self, path: CrackPath, drive: BladeDrive) -> None:
        self._path, self._film, self._drive = path, path.film, drive

    def chords(
        self, state: State, begun: Begun, tips: Sequence[Tip]
    ) -> Iterator[tuple[Segment, Segment]]:
        """Yield pairs of segments, the best first: to where the edge was and to where it will be.

        tips : of all cracks.
        """
        row, place, edge, pierced = begun
        starts = [(row, place)]
        if pierced is not None:
            # The whole rows that touch a place on the boundary: a ray from there leads through one
            # of them, and the opposite one through another.
            topology = self._film.topology
            starts += [
                at
                for at in self._film.rows_at(topology.parent(row), onto_boundary(place))
                if topology.polygon(at[0]) == WHOLE
                and not state.node.halved[state.quads[at[0]]].any()
            ]
        if self._film.sides_only:
            within = NEAR if pierced is None else np.inf
            yield from self._along_sides(state, starts, edge, within)
            return
        yield from self._through(state, row, place, edge, tips)
        if pierced is None:
            return
        # From a place on the boundary of rows, where the cut ends, one of the segments is that
        # place itself.
        for at in starts[1:]:
            here = Segment(*at, at[1], side_at(at[1]), corner_at(at[1]))
            for ahead in self._towards(state, *at, edge, tips, 1.0):
                yield here, ahead
            for back in self._towards(state, *at, edge, tips, -1.0):
                yield back, here
        # Near a side to which both directions lead.
        yield from self._along_sides(state, starts, edge, NEAR)
        # Beside a side that cannot be broken, at the border.
        for at_row, (xi, eta) in starts:
            inner = min(max(xi, -_INNER), _INNER), min(max(eta, -_INNER), _INNER)
            yield from self._through(state, at_row, inner, edge, tips)

    def _through(
        self, state: State, row: int, place: Point, edge: int, tips: Sequence[Tip]
    ) -> Iterator[tuple[Segment, Segment]]:
        """Yield pairs of segments through a row."""
        back, ahead = (self._towards(state, row, place, edge, tips, to) for to in (-1.0, 1.0))
        return itertools.product(back, ahead)

    def _along_sides(
        self, state: State, starts: Sequence[tuple[int, Point]], edge: int, within: float
    ) -> Iterator[tuple[Segment, Segment]]:
        """Yield the side of each row that an edge follows best: in one direction, and in the other.

        starts : rows, and the place in each.  within : as of :meth:`.CrackPath.side_near`.
        """
        along, lean = self._direction(state, *starts[0], edge)
        for row, place in starts:
            side = self._path.side_near(state, row, place, along, lean, within)
            if side is not None:
                yield side.reversed(), side

    def _towards(
        self,
        state: State,
        row: int,
        place: Point,
        edge: int,
        tips: Sequence[Tip],
        reach: float,
    ) -> list[Segment]:
        """Return segments from a place to where an edge was or will be.

        First one that leads to where an oncoming crack ends, if there is one.

        reach : as of :meth:`.BladeDrive.find`.
        """
        along, lean = self._direction(state, row, place, edge, reach)
        segment = self._path.segment(state, row, place, along, lean)
        if segment is None:
            return []
        heading = product(segment.weights, state.node.X[state.quads[row]])
        ends = self._film.oncoming(row, place, unit(heading), tips)
        joined = self._path.segment(state, row, place, along, lean, ends) if ends else None
        return [segment] if joined is None else [joined, segment]

    def _direction(
        self, state: State, row: int, place: Point, edge: int, reach: float = 1.0
    ) -> tuple[Floats, Floats]:
        """Return the direction to where an edge will be from a place, or was, and its lean, (3,).

        reach : as of :meth:`.BladeDrive.find`.
        """
        at, size = self._film.place_in(state, row, place), np.array([self._film.size(row)])
        then = self._drive.find(at.x[None], size, state.time, edge, reach)
        segments = self._drive.edges.segments
        # Of an edge that lies on the film, whose back is upright, its direction decides.
        there = int(then.edge_of[0])
        back = segments[there, BACK] + _ALONG * unit(segments[there, VECTOR])
        heading = product(then.rotation[0], back) * -reach
        self._drive.direct(at.t[None], heading[None], at.T[None], size)
        return then.directions[0, 0].copy(), then.lean[0].copy()
