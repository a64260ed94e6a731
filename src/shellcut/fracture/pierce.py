"""Where a cutting edge goes through film that no crack has reached: the start of a cut.

A tooth that comes down in the middle of the sheet finds no crack tip to drive. When a segment of
its edge passes through whole film away from the tips that it drives, the quad there is cut along
the trace of the mid-plane of the blade: a short crack with a closed tip at either end. Film at a
flank is left alone; a blade that crosses an earlier cut begins anew in the row behind it.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from math import sqrt
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, product, unit
from shellcut.contact.near_nodes import NearNodes, in_box
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import add, combine, cross, dot, load, norm, scale, sub
from shellcut.state import State
from shellcut.tool.cutting_edge import (
    BACK,
    NORMAL,
    START,
    VECTOR,
    CuttingEdges,
    segment_part,
)
from shellcut.tool.pose import Pose, to_body, turn

from .blade_drive import BladeDrive
from .crack_path import CrackPath
from .quad_polygon import AWAY, Point, shape_functions
from .ray_ahead import AT_POINT, Aimed, at, through
from .rows_ahead import RowsAhead, table_of
from .tip import Segment, Tip

# A quad is left alone that is nearer to a tip than this, in local edge lengths: the edge drives it.
_NEAR_A_TIP = 2.0

# Rows that are looked at, a tooth.
_CANDIDATES = 4


class Pierce:
    """Finds whole quads that a cutting edge goes through.

    Parameters
    ----------
    state : State
        At the start.
    path, drive : CrackPath, BladeDrive
        Where cracks go, and where edges do.
    size : float
        Largest edge length of the film [mm].
    """

    def __init__(self, state: State, path: CrackPath, drive: BladeDrive, size: float) -> None:
        self._path, self._drive = path, drive
        self._edges = edges = drive.edges
        quad = table_of(state, path, [(0, (0.0, 0.0))], [()])  # of any whole quad
        start = edges.segments[:, START]
        both = np.stack([start, start + edges.segments[:, VECTOR]], axis=1)
        ends = [both[edges.body == b] for b in range(int(edges.body.max()) + 1)]
        self._low = np.array([one.min(axis=(0, 1)) - size for one in ends])
        self._high = np.array([one.max(axis=(0, 1)) + size for one in ends])
        n_most = len(ends) * _CANDIDATES
        self._row, self._segment = np.full(n_most, -1), np.full(n_most, -1)
        self._place = np.zeros((n_most, 2))
        self._rows = self._first = np.zeros(0, np.int64)
        self._near = NearNodes(self._low, self._high, size)
        self._quad, self._chord = quad, Aimed.of(2)
        self._find = BoundOnce(_pierced)

    def found(
        self, state: State, pose: Pose, tips: Floats, area: Floats
    ) -> list[tuple[int, Point, int]]:
        """Return the whole rows that an edge goes through, where, and which segment.

        The edge runs between the flanks of its own cut: rows at a flank are left out, and those
        that its mid-plane would not part.

        Parameters
        ----------
        state : State
            Present positions.
        pose : Pose
            Of the tool.
        tips : ndarray, shape (n, 3)
            Where the cracks end that an edge drives [mm].
        area : ndarray, shape (n_row,)
            Of the quads [mm²].
        """
        if self._near.renew(state, pose):
            self._list(state)
        row, segment, place = self._row, self._segment, self._place
        n_found = self._find(
            state.node.x,
            state.node.t,
            state.quads,
            self._rows,
            self._first,
            area,
            tips,
            pose,
            self._edges,
            self._low,
            self._high,
            self._quad,
            self._chord,
            row,
            segment,
            place,
        )
        return [
            (int(row[k]), (float(place[k, 0]), float(place[k, 1])), int(segment[k]))
            for k in range(n_found)
        ]

    def ways(
        self, state: State, row: int, place: Point, edge: int, tips: Sequence[Tip]
    ) -> Iterator[tuple[Segment, Segment]]:
        """Yield segments from a place in a row to where an edge was and to where it will be.

        First those that lead to where an oncoming crack ends, if there are any. Cracks along sides
        only lead along the nearest side of the row, both ways.

        edge : segment of the cutting edge.  tips : of all cracks.
        """
        if not self._path.sides_only:
            both = (self._towards(state, row, place, edge, tips, end) for end in (-1.0, 1.0))
            yield from itertools.product(*both)
        elif side := self._path.side_near(state, row, place, *self._way(state, row, place, edge)):
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
        way, lean = self._way(state, row, place, edge, reach)
        segment = self._path.segment(state, row, place, way, lean)
        if segment is None:
            return []
        gap = np.array(shape_functions(segment.exit)) - np.array(shape_functions(place))
        heading = product(gap, state.node.X[state.quads[row]])
        ends = self._path.oncoming(row, place, unit(heading), tips)
        joined = self._path.segment(state, row, place, way, lean, ends) if ends else None
        return [segment] if joined is None else [joined, segment]

    def _way(
        self, state: State, row: int, place: Point, edge: int, reach: float = 1.0
    ) -> tuple[Floats, Floats]:
        """Return the direction to where an edge will be from a place, or was, and its lean, (3,).

        reach : as of :meth:`.BladeDrive.find`.
        """
        at, size = self._path.place_in(state, row, place), np.array([self._path.size(row)])
        then = self._drive.find(at.x[None], size, state.time, edge, reach)
        heading = product(then.rotation[0], self._edges.segments[edge, BACK]) * -reach
        self._drive.direct(at.t[None], heading[None], at.T[None], size)
        return then.ways[0, 0], then.lean[0]

    def saved(self) -> dict[str, Any]:
        """Return the list of nodes near the edges."""
        return self._near.saved()

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`, a list of the nodes of ``state``."""
        self._near.restore(state, saved)
        self._list(state)

    def _list(self, state: State) -> None:
        """List the whole rows near the tool without a node at a flank, by their first nodes."""
        quads, near = state.quads, np.zeros(state.n_node, np.bool_)
        near[self._near.ids] = True
        rows = np.flatnonzero(near[quads[:, 0]] & (state.quad.share[: state.n_quad] >= 1.0))
        self._rows = rows[~state.node.halved[quads[rows]].any(axis=1)]
        self._first = quads[self._rows, 0].astype(np.int64)


@inline
def _weights(start: Vec3, end: Vec3, a: Vec3, b: Vec3, c: Vec3) -> tuple[bool, float, float]:
    """Return whether a segment goes through a triangle, and the weights of b and c there."""
    normal = cross(sub(b, a), sub(c, a))
    d0, d1 = dot(sub(start, a), normal), dot(sub(end, a), normal)
    if d0 * d1 >= 0.0:
        return False, 0.0, 0.0
    p = combine(1.0, start, d0 / (d0 - d1), sub(end, start))
    area = dot(normal, normal)
    w_b = dot(cross(sub(a, c), sub(p, c)), normal) / area
    w_c = dot(cross(sub(b, a), sub(p, a)), normal) / area
    return w_b >= 0.0 and w_c >= 0.0 and w_b + w_c <= 1.0, w_b, w_c


@inline
def parts_quad(
    quad: RowsAhead,
    chord: Aimed,
    x: Floats,
    t: Floats,
    quads: Ints,
    e: int,
    xi: float,
    eta: float,
    normal: Vec3,
    size: float,
) -> bool:
    """Return whether the trace of a plane at a place of quad e leaves it by two sides.

    Or by both corners of one side, which is broken then.

    quad, chord : tables of one row and two rays, written.  x, t : (n_node, 3).  quads :
    (n_quad, 4).  normal : of the plane.  size : edge length [mm].
    """
    if quad.sides_only or abs(xi) > 1.0 - 2.0 * AWAY or abs(eta) > 1.0 - 2.0 * AWAY:
        return True  # on a side to within round-off: the rules themselves decide
    quad.size[0], quad.entry[0, 0], quad.entry[0, 1] = size, xi, eta
    for a in range(4):
        quad.nodes[0, a] = quads[e, a]
    upright = (0.0, 0.0, 0.0)
    trace = cross(at(quad, 0, xi, eta, t), normal)
    trace = scale(1.0 / norm(trace), trace)
    for i in range(2):
        way = scale(2.0 * i - 1.0, trace)
        if not through(quad, 0, i, x, t, way, upright, False, chord):
            return False
    together = False
    for side in range(4):
        together = together or (_is_on(chord, 0, side) and _is_on(chord, 1, side))
    at_corners = chord.way[0, 1] == AT_POINT and chord.way[1, 1] == AT_POINT
    return not together or (at_corners and chord.way[0, 2] != chord.way[1, 2])


@inline
def _is_on(chord: Aimed, i: int, side: int) -> bool:
    """Return whether a ray ends on a side of a whole quad."""
    end: int = chord.way[i, 2]
    return end == side or (bool(chord.way[i, 1] == AT_POINT) and end == (side + 1) % 4)


@kernel
def _pierced(
    x: Floats,
    t: Floats,
    quads: Ints,
    whole: Ints,
    first: Ints,
    area: Floats,
    tips: Floats,
    pose: Pose,
    edges: CuttingEdges,
    low: Floats,
    high: Floats,
    quad: RowsAhead,
    chord: Aimed,
    row: Ints,
    segment: Ints,
    place: Floats,
) -> int:
    """Write the rows that edges go through, their segments and the places in them; return how many.

    whole, first : (n,), rows and their first nodes.  low, high : (n_body, 3), boxes around the
    edges.  quad, chord : tables of one row and two rays, written.  row, segment : (n_most,).
    place : (n_most, 2), xi and eta.
    """
    pose, edges = borrowed(pose), borrowed(edges)
    quad, chord = borrowed(quad), borrowed(chord)
    segments, body = edges.segments, edges.body
    n_found = 0
    for i in range(whole.shape[0]):
        e, here, far = whole[i], load(x, first[i]), True
        for tip in range(tips.shape[0]):
            gap = sub(load(tips, tip), here)
            far = far and dot(gap, gap) > _NEAR_A_TIP**2 * area[e]
        if not far:
            continue
        corner = to_body(here, pose)
        for b in range(low.shape[0]):
            if not in_box(corner, low, high, b):
                continue
            second = to_body(load(x, quads[e, 1]), pose)
            third = to_body(load(x, quads[e, 2]), pose)
            fourth = to_body(load(x, quads[e, 3]), pose)
            for k in range(segments.shape[0]):
                if body[k] != b or n_found == row.shape[0]:
                    continue
                start = segment_part(segments, k, START)
                end = add(start, segment_part(segments, k, VECTOR))
                hit, w1, w2 = _weights(start, end, corner, second, third)
                xi, eta = 2.0 * (w1 + w2) - 1.0, 2.0 * w2 - 1.0
                if not hit:
                    hit, w1, w2 = _weights(start, end, corner, third, fourth)
                    xi, eta = 2.0 * w1 - 1.0, 2.0 * (w1 + w2) - 1.0
                if not hit:
                    continue
                plane = turn(segment_part(segments, k, NORMAL), pose)
                if parts_quad(quad, chord, x, t, quads, e, xi, eta, plane, sqrt(area[e])):
                    row[n_found], segment[n_found] = e, k
                    place[n_found, 0], place[n_found, 1] = xi, eta
                    n_found += 1
    return n_found
