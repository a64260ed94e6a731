"""The cables across the segments of a crack through quads: one for either half of each.

Across a segment of length L the film is held by two cables of the area h L/2, at its two ends, or
at its two Gauss points, (1 ± 1/√3)/2 of the way along it. An end of a cable is a node where the
crack runs through a corner, else a flank point (:mod:`shellcut.fracture.flank_points`). As long as
the crack is closed there, both its ends are at the same nodes: the cable *sleeps*, and is made when
they part. Its m is the normal to the segment in the sheet at that moment.

Cables at Gauss points sum up the work of an opening that is linear along the segment exactly to the
third power, those at the ends to the first. They are made as soon as their segment is cut, and take
up force along all of it while it opens. The blade touches the flanks at the ends of segments as
before: there are then flank points without a cable, and those of the cables touch nothing.

When a copy is cut again, the end of a cable goes with the part that holds the film a little further
along its segment; the place itself may lie on the new cut.
"""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any, ClassVar

import numpy as np

from shellcut.arrays import Floats, product, unit
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.quad_geometry import corner_normals
from shellcut.state import NOT_MET, KnownTopology, State

from .anisotropy import Anisotropy
from .cut_state import nodes_at
from .cut_topology import CutTopology
from .flank_points import add_flank_point, tie
from .quad_polygon import Point, corner_at, holds, shape_functions

# Of the segment: where a flank point belongs when its copy is cut again.
_INWARD = 0.15

GAUSS = 0.5 * (1.0 - 3.0**-0.5)
"""Of the segment, where its two Gauss points are from its ends."""

# The film around a Gauss point is where it is; a hair further shows the way of the segment.
_HAIR = 1e-3


@dataclass
class _Sleeping:
    """A cable both ends of which are at the same nodes."""

    rows: list[int]
    """Copies to the right of the crack and to its left."""
    places: tuple[Point, Point]
    """Its place in the quad of either."""
    inward: tuple[Point, Point]
    """A little further along the segment."""
    far: Point
    """Other end of the segment, in the quad of the first."""
    way: float
    """1 if that lies in the way of the crack, -1 against it."""
    length: float
    """That it holds [mm]; zero of a pair of flank points that only touch the blade."""

    N_NUMBER: ClassVar[int] = 14

    @classmethod
    def of(cls, row: list[float]) -> _Sleeping:
        """Return a cable from its numbers in the order of the fields."""
        a, b, c, d, far = [(row[k], row[k + 1]) for k in range(2, 12, 2)]
        return cls([int(row[0]), int(row[1])], (a, b), (c, d), far, row[12], row[13])


class SegmentCables:
    """Lays cables across segments, and makes them when the crack opens there.

    Parameters
    ----------
    law : CohesiveLaw
        Whose strength they begin with.
    material : ShellMaterial
        Of the film.
    anisotropy : Anisotropy, optional
        Of the film; a cable's area is that of the film it holds times f.
    at_gauss_points : bool
        Where the cables are, else at the ends of segments.
    """

    def __init__(
        self,
        law: CohesiveLaw,
        material: ShellMaterial,
        anisotropy: Anisotropy | None = None,
        *,
        at_gauss_points: bool = False,
    ) -> None:
        self._law, self._material, self._anisotropy = law, material, anisotropy
        self._at_gauss_points = at_gauss_points
        self._sleeping: list[_Sleeping] = []
        self._known = KnownTopology()

    def lay(
        self,
        rows: list[int],
        chords: list[tuple[Point, Point]],
        length: float,
    ) -> None:
        """Lay a cable across either half of a new segment; they sleep.

        Parameters
        ----------
        rows : list of int
            To its right and left.
        chords : list of (Point, Point)
            Its two ends in the quad of each.
        length : float
            In the reference film [mm].
        """
        for end in (0, 1):
            minus, plus = (chord[::-1] if end else chord for chord in chords)
            way = -1.0 if end else 1.0
            if not self._at_gauss_points:
                self._put(rows, minus, plus, 0.0, way, 0.5 * length)
                continue
            self._put(rows, minus, plus, GAUSS, way, 0.5 * length)
            if corner_at(minus[0]) < 0 or corner_at(plus[0]) < 0:
                self._put(rows, minus, plus, 0.0, way, 0.0)

    def _put(
        self,
        rows: list[int],
        minus: tuple[Point, Point],
        plus: tuple[Point, Point],
        at: float,
        way: float,
        length: float,
    ) -> None:
        """Lay a cable at a part ``at`` of the chord in either row."""
        inward = at + _HAIR if at else _INWARD
        places = _between(*minus, at), _between(*plus, at)
        ahead = _between(*minus, inward), _between(*plus, inward)
        self._sleeping.append(_Sleeping([*rows], places, ahead, minus[1], way, length))

    def follow(self, state: State, topology: CutTopology, row: int, new: int) -> None:
        """Give the ends of cables on a row that has been cut to the part that they belong to."""
        part, f, c = topology.polygon(new), state.flank, state.cable
        for one in self._sleeping:
            for end in (0, 1):
                if one.rows[end] == row and holds(part, one.inward[end]):
                    one.rows[end] = new
        for k in np.flatnonzero(f.row[: f.count] == row).tolist():
            xi, eta = f.inward[k].tolist()
            if holds(part, (xi, eta)):
                f.row[k] = new
        for k, end in np.argwhere(c.row[: c.count] == row).tolist():
            xi, eta = c.inward[k, end].tolist()
            if holds(part, (xi, eta)):
                c.row[k, end] = new

    def wake(self, state: State, areas: Any) -> None:
        """Make the cables whose ends have come apart; bring all ends to their nodes.

        areas : (n_row,), of the whole quads [mm²].
        """
        asleep = []
        for one in self._sleeping:
            minus, plus = map(nodes_at, (state, state), one.rows, one.places)
            if minus == plus:
                asleep.append(one)
            else:
                self._make(state, one)
        self._sleeping = asleep
        c = state.cable
        at_corner = c.row[: c.count] >= 0
        row, corner = c.row[: c.count][at_corner], c.corner[: c.count][at_corner]
        c.ends[: c.count][at_corner] = state.quads[row, corner]
        untouched = c.ends[: c.count][~at_corner] if self._at_gauss_points else c.ends[:0]
        if state.flank.count:
            changed, density = self._known.changed_quads(state), self._material.area_density
            tie(state, changed, areas, density, untouched.ravel())
        self._known.take(state)

    def _make(self, state: State, one: _Sleeping) -> None:
        ends = list(zip(one.rows, one.places, one.inward, strict=True))
        if one.length == 0.0:
            for row, place, inward in ends:
                if corner_at(place) < 0:
                    add_flank_point(state, row, place, inward)
            return
        k = state.cable.append_blank()
        c = state.cable
        for end, (row, place, inward) in enumerate(ends):
            corner = corner_at(place)
            c.row[k, end], c.corner[k, end] = (row, corner) if corner >= 0 else (-1, -1)
            c.inward[k, end] = inward
            if corner >= 0:
                c.ends[k, end] = state.quads[row, corner]
            else:
                c.ends[k, end] = add_flank_point(state, row, place, inward)
        n = state.node
        corners = n.x[state.quads[one.rows[0]]]
        here, far = (product(shape_functions(p), corners) for p in (one.places[0], one.far))
        m = unit(one.way * np.cross(n.t[c.ends[k, 0]], far - here))
        c.edge[k] = NOT_MET
        c.length[k] = one.length
        c.area[k] = self._material.thickness * one.length * self._factor(state, one)
        c.m[k] = m
        c.branch[k] = m, -m
        c.birth[k] = state.time
        # The force that a new cable is about to exert: at zero opening it has done no work yet.
        c.traction[k] = self._law.strength

    def _factor(self, state: State, one: _Sleeping) -> float:
        """Return f for the segment of a cable."""
        if self._anisotropy is None:
            return 1.0
        X = state.node.X[state.quads[one.rows[0]]]
        start, stop = (product(shape_functions(p), X) for p in (one.places[0], one.far))
        return self._anisotropy.factor(stop - start, corner_normals(X))

    def saved(self) -> Floats:
        """Return the sleeping cables as rows of numbers."""
        rows = [np.hstack([np.ravel(value) for value in astuple(one)]) for one in self._sleeping]
        return np.array(rows, float).reshape(-1, _Sleeping.N_NUMBER)

    def restore(self, saved: Floats) -> None:
        """Take over :meth:`saved`."""
        self._sleeping = [_Sleeping.of(row) for row in saved.tolist()]
        self._known = KnownTopology()


def _between(start: Point, end: Point, at: float) -> Point:
    if at == 0.0:
        return start
    return start[0] + at * (end[0] - start[0]), start[1] + at * (end[1] - start[1])
