"""Where a cutting edge enters film that nothing supports against it.

At the border of the film, or at the flank of another cut, an edge cuts the film that it enters. So
it does everywhere if the tool's points do not press. Film at a flank is left alone, for the edge
runs between the flanks of its own cut; a blade that crosses an earlier cut begins anew in the row
behind it.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, norm
from shellcut.contact.near_nodes import NearNodes
from shellcut.contact.unfelt_depth import crossing
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.boxes import in_box
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.kept import Kept
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import add, cross, load, scale
from shellcut.numerics.vec3 import norm as length
from shellcut.state import State
from shellcut.tool.cutting_edge import NORMAL, START, VECTOR, CuttingEdges, segment_part
from shellcut.tool.pose import Pose, to_body, turn

from .cut_film import CutFilm
from .open_edges import boundary_edges
from .quad_polygon import AWAY
from .ray_ahead import AT_POINT, KIND, PLACE, Aimed, at, through
from .rows_ahead import RowsAhead, table_of
from .tip import Begun, Segment

# Sine of the angle to the film up to which an edge lies on it, and enters over no border.
_FLAT = 0.1

# Coordinate in a quad that is clearly within: places nearer than 2 AWAY to a side count as on it.
_WITHIN = 1.0 - 4.0 * AWAY

# Rows that are tested, for each tooth.
_CANDIDATES = 16


class EnteredFilm(Kept):
    """Finds whole rows that cutting edges enter.

    Parameters
    ----------
    state : State
        At the start.
    film : CutFilm
        How it is cut.
    shell : MITC4Shell
        Gives the sizes of rows.
    edges : CuttingEdges
        Of the tool.
    chain : ndarray, shape (n_edge,)
        Which edge each segment belongs to.
    everywhere : bool
        Whether no point of the tool presses on the film, whose face then gives no support.
    """

    kept_names = ("_near",)

    def __init__(
        self,
        state: State,
        film: CutFilm,
        shell: MITC4Shell,
        edges: CuttingEdges,
        chain: Ints,
        *,
        everywhere: bool,
    ) -> None:
        self._area, self._chain, self._everywhere = shell.area, chain, everywhere
        # From the first node of a row to the others, twice as far where the film is stretched.
        corners = state.node.X[state.quads]
        reach = 2.0 * float(norm(corners[:, 1:] - corners[:, :1]).max())
        self._at_border, self._open = np.unique(boundary_edges(state)), np.zeros(0, np.bool_)
        quad = table_of(state, film, [(0, (0.0, 0.0))], [()])  # of any whole quad
        start = edges.segments[:, START]
        both = np.stack([start, start + edges.segments[:, VECTOR]], axis=1)
        ends = [both[chain == c] for c in range(int(chain.max()) + 1)]
        self._low = np.array([chain_ends.min(axis=(0, 1)) - reach for chain_ends in ends])
        self._high = np.array([chain_ends.max(axis=(0, 1)) + reach for chain_ends in ends])
        n_most = len(ends) * _CANDIDATES
        self._row, self._segment = np.full(n_most, -1), np.full(n_most, -1)
        self._place = np.zeros((n_most, 2))
        self._first: Ints = np.zeros(0, np.int64)
        self._rows = self._first
        self._listed = -1  # search whose nodes the rows are of
        self._near = NearNodes(self._low, self._high, reach)
        self._addresses = TableWriter()(edges), TableWriter()(quad), TableWriter()(Aimed.of(2))
        self._find = BoundOnce(_entered)

    def entered_rows(self, state: State, pose: Pose) -> list[Begun]:
        """Return where edges enter whole rows that their mid-planes would part."""
        self._near.renew(state, pose)
        if self._listed != self._near.n_search:
            self._listed = self._near.n_search
            self._rows = self._rows_near(state)
            self._first = state.quads[self._rows, 0].astype(np.int64)
        row, segment, place = self._row, self._segment, self._place
        edges, quad, chord = self._addresses
        n_found = self._find(
            state.node.x,
            state.node.t,
            state.quads,
            self._rows,
            self._first,
            self._area,
            pose,
            edges,
            self._chain,
            self._low,
            self._high,
            quad,
            chord,
            row,
            segment,
            place,
        )
        return [
            Begun(int(row[k]), (float(place[k, 0]), float(place[k, 1])), int(segment[k]))
            for k in range(n_found)
        ]

    def leads_out(self, state: State, back: Segment) -> bool:
        """Return whether an edge has entered a row over the border, or over a flank next to it.

        back : leads to where it was.
        """
        side = (back.side, (back.side + 1) % 4) if back.corner < 0 else (back.corner,)
        return bool(self._open[state.quads[back.row, list(side)]].all())

    def restore(self, saved: Mapping[str, Any]) -> None:
        """Take over :meth:`saved`; rows are listed when they are needed."""
        super().restore(saved)
        self._listed = -1

    def _rows_near(self, state: State) -> Ints:
        """Return the whole rows near the tool without a node at a flank.

        Those at the border and next to rows at a flank; all of them if the tool's points do not
        press.
        """
        quads, near = state.quads, np.zeros(state.n_node, np.bool_)
        near[self._near.ids] = True
        at_flank = state.node.halved[quads].any(axis=1)
        may = near[quads[:, 0]] & (state.quad.share[: state.n_quad] >= 1.0) & ~at_flank
        self._open = np.full(state.n_node, self._everywhere)
        self._open[self._at_border] = self._open[quads[at_flank]] = True
        return np.flatnonzero(may & self._open[quads].any(axis=1))


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
    if quad.sides_only:
        return True  # sides are broken from nodes: the rule of cracks along sides decides
    quad.size[0], quad.entry[0, 0], quad.entry[0, 1] = size, xi, eta
    for a in range(4):
        quad.nodes[0, a] = quads[e, a]
    upright = (0.0, 0.0, 0.0)
    trace = cross(at(quad, 0, xi, eta, t), normal)
    trace = scale(1.0 / length(trace), trace)
    for i in range(2):
        along = scale(2.0 * i - 1.0, trace)
        if not through(quad, 0, i, x, t, along, upright, False, chord):
            return False
    together = False
    for side in range(4):
        together = together or (_is_on(chord, 0, side) and _is_on(chord, 1, side))
    at_corners = chord.target[0, KIND] == AT_POINT and chord.target[1, KIND] == AT_POINT
    return not together or (at_corners and chord.target[0, PLACE] != chord.target[1, PLACE])


@inline
def _off_sides(coordinate: float) -> float:
    """Return a coordinate in a quad, of a place on a side that of one just beside it.

    Of an edge that runs along a side of the mesh round-off decides on which side of it the place
    lies. Beside it the chord leads to the corners of this side, which is broken.
    """
    return min(max(coordinate, -_WITHIN), _WITHIN)


@inline
def _is_on(chord: Aimed, i: int, side: int) -> bool:
    """Return whether a ray ends on a side of a whole quad."""
    end: int = chord.target[i, PLACE]
    return end == side or (bool(chord.target[i, KIND] == AT_POINT) and end == (side + 1) % 4)


@kernel
def _entered(
    x: Floats,
    t: Floats,
    quads: Ints,
    whole: Ints,
    first: Ints,
    area: Floats,
    pose: Pose,
    edges: CuttingEdges,
    chain: Ints,
    low: Floats,
    high: Floats,
    quad: RowsAhead,
    chord: Aimed,
    row: Ints,
    segment: Ints,
    place: Floats,
) -> int:
    """Write the rows that edges enter, their segments and the places in them; return how many.

    whole, first : (n,), rows and their first nodes.  chain : (n_edge,), of each segment.  low,
    high : (n_chain, 3), boxes around the chains.  quad, chord : tables of one row and two rays,
    written.  row, segment : (n_most,).  place : (n_most, 2), xi and eta.
    """
    pose, edges = borrowed(pose), borrowed(edges)
    quad, chord = borrowed(quad), borrowed(chord)
    segments = edges.segments
    n_found = 0
    for i in range(whole.shape[0]):
        e = whole[i]
        corner = to_body(load(x, first[i]), pose)
        for c in range(low.shape[0]):
            if not in_box(corner, low, high, c):
                continue
            second = to_body(load(x, quads[e, 1]), pose)
            third = to_body(load(x, quads[e, 2]), pose)
            fourth = to_body(load(x, quads[e, 3]), pose)
            for k in range(segments.shape[0]):
                if chain[k] != c or n_found == row.shape[0]:
                    continue
                start = segment_part(segments, k, START)
                end = add(start, segment_part(segments, k, VECTOR))
                # The quad as two triangles, whose weights give its xi and eta.
                _, sine, w1, w2 = crossing(start, end, corner, second, third)
                xi, eta = 2.0 * (w1 + w2) - 1.0, 2.0 * w2 - 1.0
                if sine < _FLAT or min(w1, w2, 1.0 - w1 - w2) < 0.0:
                    _, sine, w1, w2 = crossing(start, end, corner, third, fourth)
                    xi, eta = 2.0 * w1 - 1.0, 2.0 * (w1 + w2) - 1.0
                if sine < _FLAT or min(w1, w2, 1.0 - w1 - w2) < 0.0:
                    continue
                xi, eta = _off_sides(xi), _off_sides(eta)
                plane = turn(segment_part(segments, k, NORMAL), pose)
                if parts_quad(quad, chord, x, t, quads, e, xi, eta, plane, math.sqrt(area[e])):
                    row[n_found], segment[n_found] = e, k
                    place[n_found, 0], place[n_found, 1] = xi, eta
                    n_found += 1
    return n_found
