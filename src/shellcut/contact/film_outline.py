"""The film that each quad or copy carries, as a polygon, and the border at which that film ends.

Contact needs to know whether a point lies over the film of a quad, how far it is from there to the
border of the film, and where that touches the tool. A whole quad is the square of its four
sides; a copy of a cut quad carries a convex polygon of it (:mod:`shellcut.fracture.quad_polygon`),
some edges of which lie on flanks of the crack.

An edge on a side of the quad is *closed* if the film continues there, and *open* if it ends: at the
border, at a notch, at a flank. Quads connected along a side share both its nodes, so a side
is closed if and only if another row has both. Edges on flanks are open. A corner of the polygon is
open if an open edge ends there, of this quad or of another.

Slivers are left out, as is film that has been taken out of the run: for contact the film ends where
they begin. The nodes of a sliver swing by more than it is wide and turn it by any angle, so what
lies over it is not defined.

*Pairs of nodes.* A border segment is an open edge. It runs between two points of a row's polygon. A
corner is a node; another point is a flank point of that row, tied to its nodes. Where a crack
crosses a side, the copies on both sides of that have a point of their own at one place: the first
is used for all.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallIds, norm
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.state import KnownTopology, OncePerTopology, State

from .settings import PenaltyLaw

Part = tuple[tuple[tuple[float, float], ...], tuple[int, ...]]
"""Points (xi, eta) of a polygon, counter-clockwise, and the side of the quad on which the edge from
each to the next lies, -1 for a flank."""

_WHOLE: Part = (((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)), (0, 1, 2, 3))


SLIVER = 0.2
"""Part of a quad: rows with less film are left out."""

# Edges of a polygon, at most: a key is that of its row times this, and its place there.
_MOST_EDGES = 64

# Of xi and eta: places that agree so far are the same, as are weights on a side.
_SAME = 1e-9
_DIGITS = 9


class Outline(NamedTuple):
    """Polygons of all rows, as kernels take them; good for one topology."""

    n_edge: Annotated[Ints, "(n_quad,)"]
    """Number of points and edges of the polygon."""
    point: Annotated[Floats, "(n_quad, n_most, 2)"]
    """xi, eta of its points."""
    side: Annotated[Ints, "(n_quad, n_most)"]
    """Side of the quad on which the edge from a point lies, -1 for a flank."""
    open: Annotated[Bools, "(n_quad, n_most)"]
    """Whether the film ends at the edge."""
    open_at: Annotated[Bools, "(n_quad, n_most)"]
    """Whether the film ends at the point."""
    absent: Annotated[Bools, "(n_quad,)"]
    """Whether a row is left out."""


class FilmOutline:
    """Keeps the outline of a film up to date from cut to cut.

    Parameters
    ----------
    part_of : Callable, optional
        Returns the polygon of a row; without one no quad is ever cut.
    """

    def __init__(self, part_of: Callable[[int], Part] | None = None) -> None:
        self._part_of = part_of
        self._known = KnownTopology()
        self._outline = _of_whole_quads(0, 4)
        self._at_border = np.zeros(0, np.bool_)
        self._mark = BoundOnce(_mark_open)

    def of(self, state: State) -> Outline:
        """Return the outline of the film as it is now."""
        if self._known.is_of(state):
            return self._outline
        q, n, count, known = state.quad, state.node, state.n_quad, self._known
        changed = known.changed_quads(state) if known.revision >= 0 else np.arange(count)
        self._make_room(len(q.nodes), 0)
        more = len(n.x) - self._at_border.size
        if more > 0:
            self._at_border = np.append(self._at_border, np.zeros(more, np.bool_))
        cut = changed[q.share[changed] < 1.0]
        if self._part_of is not None:
            for row in cut.tolist():
                points, sides = self._part_of(row)
                n_point = len(points)
                self._make_room(0, n_point)
                self._outline.n_edge[row] = n_point
                self._outline.point[row, :n_point] = points
                self._outline.side[row, :n_point] = sides
        outline = self._outline
        outline.absent[:count] = q.share[:count] < SLIVER
        self._mark(
            changed.astype(np.int64), q.nodes, n.quads, n.n_quad_at, self._at_border, outline
        )
        self._known.take(state)
        return outline

    def _make_room(self, rows: int, points: int) -> None:
        """Give so many rows a place, and so many points in each; new rows are whole."""
        n_row, most = self._outline.side.shape
        if rows <= n_row and points <= most:
            return
        old, wider = self._outline, most if points <= most else 2 * most
        self._outline = _of_whole_quads(max(rows, n_row), wider)
        for new, before in zip(self._outline, old, strict=True):
            new[tuple(slice(0, length) for length in before.shape)] = before


def _of_whole_quads(n_row: int, n_most: int) -> Outline:
    points, sides = _WHOLE
    outline = Outline(
        n_edge=np.full(n_row, 4),
        point=np.zeros((n_row, n_most, 2)),
        side=np.full((n_row, n_most), -1),
        open=np.zeros((n_row, n_most), np.bool_),
        open_at=np.zeros((n_row, n_most), np.bool_),
        absent=np.zeros(n_row, np.bool_),
    )
    outline.point[:, :4] = points
    outline.side[:, :4] = sides
    return outline


@kernel
def _mark_open(
    rows: Ints, quads: Ints, at: Ints, n_at: Ints, at_border: Bools, outline: Outline
) -> None:
    """Write which edges and points of the polygons of some rows are open.

    rows : (n,), ascending.  quads : (n_row, 4), node ids.  at, n_at : rows at every node.

    at_border : (n_node,), whether the film ends at a node, written for the nodes of the rows.
    """
    point, side, is_open, open_at = outline.point, outline.side, outline.open, outline.open_at
    for i in range(rows.shape[0]):
        row = rows[i]
        for k in range(outline.n_edge[row]):
            on = side[row, k]
            is_open[row, k] = True
            if on >= 0:
                a, b = quads[row, on], quads[row, (on + 1) % 4]
                for j in range(n_at[a]):
                    other = at[a, j]
                    if other != row and not outline.absent[other]:
                        for c in range(4):
                            if quads[other, c] == b:
                                is_open[row, k] = False
    for i in range(rows.shape[0]):
        for a in range(4):
            at_border[quads[rows[i], a]] = False
    for i in range(rows.shape[0]):
        # The rows at these nodes that have not changed end where they did: they are tested, too.
        for a in range(4):
            node = quads[rows[i], a]
            for j in range(n_at[node]):
                other = at[node, j]
                for k in range(outline.n_edge[other]):
                    on = side[other, k]
                    if on >= 0 and is_open[other, k] and not outline.absent[other]:
                        ends = quads[other, on] == node or quads[other, (on + 1) % 4] == node
                        at_border[node] = at_border[node] or ends
    for i in range(rows.shape[0]):
        for k in range(outline.n_edge[rows[i]]):
            open_at[rows[i], k] = True  # an end of a flank, unless it is a corner
        for a in range(4):
            node = quads[rows[i], a]
            for j in range(n_at[node]):
                other = at[node, j]
                for k in range(outline.n_edge[other]):
                    corner = _corner_of(point[other, k, 0], point[other, k, 1])
                    if corner >= 0 and quads[other, corner] == node:
                        open_at[other, k] = at_border[node]


@inline
def _corner_of(xi: float, eta: float) -> int:
    """Return the corner of the parametric square at a point, -1 if there is none."""
    if abs(xi) < 1.0 - _SAME or abs(eta) < 1.0 - _SAME:
        return -1
    if eta < 0.0:
        return 0 if xi < 0.0 else 1
    return 3 if xi < 0.0 else 2


class BorderSegments(NamedTuple):
    """The segments of the film's border, and the part of the nodes' stiffness that they use."""

    node: Annotated[Ints, "(n_segment, 2)"]
    """Nodes at both ends."""
    key: Annotated[Ints, "(n_segment,)"]
    """Of row and edge of its polygon, ascending."""
    length: Annotated[Floats, "(n_segment,)"]
    """In the reference configuration [mm]."""
    stiffness: Annotated[Floats, "(n_segment,)"]
    """K of each, half of which either end gives up [N/mm]."""
    left: Annotated[Floats, "(n_node,)"]
    """What is left at each node [N/mm]."""


class FilmBorderSegments(OncePerTopology[BorderSegments]):
    """Keeps the border segments of a film up to date from cut to cut.

    Parameters
    ----------
    law : PenaltyLaw
    part_of : Callable
        Returns the polygon of a row that is cut.
    """

    def __init__(self, law: PenaltyLaw, part_of: Callable[[int], Part]) -> None:
        outline = FilmOutline(part_of)
        super().__init__(lambda state: border_segments(state, outline.of(state), law))


def border_segments(state: State, outline: Outline, law: PenaltyLaw) -> BorderSegments:
    """Return the segments of the film's border.

    Let k_a be the stiffness of a node and d_a the number of segments that end there: a segment gets
    K = 2 min(k_a / d_a, k_b / d_b), half of it from either end.

    Parameters
    ----------
    state : State
    outline : Outline
        Of its film.
    law : PenaltyLaw
    """
    f, n, n_row = state.flank, state.node, state.n_quad
    by_row = np.argsort(f.row[: f.count], kind="stable")
    first = np.searchsorted(f.row[: f.count][by_row], np.arange(n_row + 1))
    room = n_row * outline.point.shape[1]
    found, key = np.empty((room, 2), np.int64), np.empty(room, np.int64)
    count = _ends_of_border_segments(
        n_row, outline, state.quad.nodes, first, f.node[by_row], f.place[by_row], found, key
    )
    node, key = found[:count], key[:count]
    if f.count:
        same_place = np.arange(n.count)
        same_place[f.node[: f.count]] = f.node[
            first_at_places(f.nodes[: f.count], f.weight[: f.count])
        ]
        node = same_place[node]
        # At a tip, where the flanks have not parted, there is nothing to touch yet.
        touched = (node[:, 0] != node[:, 1]) & n.real[node].all(axis=1)
        node, key = node[touched], key[touched]
    own = n.contact_share[: n.count] * law.of_nodes(n.contact_area[: n.count])
    ending = np.bincount(node.ravel(), minlength=n.count)
    stiffness = 2.0 * (own[node] / ending[node]).min(axis=1)
    taken = np.bincount(node.ravel(), np.repeat(0.5 * stiffness, 2), minlength=n.count)
    return BorderSegments(
        node=np.ascontiguousarray(node),
        key=key.copy(),
        length=norm(n.X[node[:, 1]] - n.X[node[:, 0]]),
        stiffness=stiffness,
        left=np.maximum(own - taken, 0.0),
    )


def first_at_places(nodes: Ints, weight: Floats) -> Ints:
    """Return for each flank point the first of those at its place, tied to the same two nodes.

    Where a crack crosses a side, the copies of both quads have a point there. A point that is tied
    to more nodes, or to a single node, is the only one there.

    nodes, weight : (n_point, 4), what they are tied to and the shape functions.
    """
    first, used = np.arange(len(nodes)), weight > _SAME
    on_side = np.flatnonzero(used.sum(axis=1) == 2)
    ends = nodes[on_side][used[on_side]].reshape(-1, 2)
    at = weight[on_side][used[on_side]].reshape(-1, 2)
    low, every = np.argmin(ends, axis=1), np.arange(on_side.size)
    s = np.round(at[every, low], _DIGITS)
    order = np.lexsort((on_side, s, ends[every, 1 - low], ends[every, low]))
    a, b, s = ends[every, low][order], ends[every, 1 - low][order], s[order]
    new = np.ones(order.size, np.bool_)
    new[1:] = (a[1:] != a[:-1]) | (b[1:] != b[:-1]) | (s[1:] != s[:-1])
    first[on_side[order]] = on_side[order[np.flatnonzero(new)][np.cumsum(new) - 1]]
    return first


@kernel
def _ends_of_border_segments(
    n_row: int,
    outline: Outline,
    quads: SmallIds,
    first: Ints,
    node: Ints,
    place: Floats,
    found: Ints,
    key: Ints,
) -> int:
    """Write the ends of the border segments of all rows to found : (n, 2); return their number.

    key : (n,), written, ascending.  first : (n_row + 1,), of each row's flank points.  node,
    place : (n_flank,), (n_flank, 2), of these points row by row.
    """
    count = 0
    for row in range(n_row):
        if outline.absent[row]:
            continue
        n = outline.n_edge[row]
        for k in range(n):
            if not outline.open[row, k]:
                continue
            a = _node_at(row, k, outline, quads, first, node, place)
            b = _node_at(row, (k + 1) % n, outline, quads, first, node, place)
            if a >= 0 and b >= 0:
                found[count, 0], found[count, 1] = a, b
                key[count] = _MOST_EDGES * row + k
                count += 1
    return count


@inline
def _node_at(
    row: int,
    k: int,
    outline: Outline,
    quads: SmallIds,
    first: Ints,
    node: Ints,
    place: Floats,
) -> int:
    """Return the node or flank point at a point of a row's polygon, -1 if there is none."""
    xi, eta = outline.point[row, k, 0], outline.point[row, k, 1]
    corner = _corner_of(xi, eta)
    if corner >= 0:
        return int(quads[row, corner])
    for i in range(first[row], first[row + 1]):
        if abs(place[i, 0] - xi) < _SAME and abs(place[i, 1] - eta) < _SAME:
            return int(node[i])
    return -1
