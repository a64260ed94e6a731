"""Through which side or corner a crack leaves the row ahead: one ray, or those of many tips.

A ray lies in the plane along its direction and the director at the tip, from which the plane may
lean: sides are straight in space, chords of the parametric square are not. Its segment ends, in
this order (without any of these rules some cuts failed):

1. where a crack that runs towards it ends, within ``JOIN`` edge lengths, measured across the ray;
2. on a crossing of another crack within ``MERGE``; if that crack leads there from the tip, there is
   nothing left to cut;
3. at a corner within ``SNAP``, if it is not on the side where the segment begins; from a
   node, a side that the ray leaves by less than that is broken as a side;
4. on the side itself, at least ``SNAP`` of it from its corners.

Cracks along sides only know one rule: of the two sides at its node that bound the row into which
the ray leads, the one at the smaller angle to it that can be broken.

There is no segment where the direction leads out of the polygon, unless it grazes the side on which
it begins. Distances across the ray are those in the sheet: out of it, folds under a blade do not
count. What lasts as long as the topology is found once (:mod:`.rows_ahead`); with every step only
the ray turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple, TypeAlias

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.contact.quad_distance import corners_of, place_in
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import cross, dot, load, norm, scale, sub
from shellcut.state import State

from .quad_polygon import AWAY, FLANK, Point, along_side, is_on
from .rows_ahead import NO_SIDE, RowsAhead
from .tip import Segment

JOIN = 0.3
"""Ends of cracks that run towards a tip are met if nearer than this, in edge lengths across the
ray: the two would run past each other with a strip between them that no mesh resolves."""

MERGE = 0.15
"""Crossings of another crack that are nearer than this are met."""

SNAP = 0.05
"""Corners that are nearer than this are met; crossings keep this part of the side away from
them."""

ALONG = 1.0 / 3.0
"""Of the distance ahead: a flank that leads to such a point no farther beside the ray is a crack
along it."""

GRAZE = 0.2
"""Of the distance ahead: a ray that misses a corner at the end of the tip's own side by less, on
the far side of it, runs along that side, and the segment passes the corner on the near side."""

AT_POINT, ALONG_SIDE, AT_END, AT_CROSSING, ON_SIDE, ON_FLANK = range(6)
"""Where a segment ends: at a point of the polygon, the same along a side of the mesh, where an
oncoming crack does, on a crossing of another crack, on a side between crossings, on a flank."""

AHEAD, KIND, PLACE, NTH = range(4)
"""Columns of :attr:`Aimed.target`."""


Ray: TypeAlias = tuple[Vec3, Vec3, Vec3]
"""Where a ray begins, the unit normal to its plane, and its unit direction."""


class Aimed(NamedTuple):
    """Where the segments from tips lead, written by :func:`leave`."""

    target: Annotated[Ints, "(n_tip, 4)"]
    """AHEAD: which row, -1 if the tip has none. KIND: where it ends, AT_POINT to ON_FLANK. PLACE:
    at which point or edge. NTH: on which side of the quad at a point or end, else at or after how
    many crossings of the edge from the last one."""
    nodes: Annotated[Ints, "(n_tip, 4)"]
    """Of that row."""
    entry: Annotated[Floats, "(n_tip, 2)"]
    exit: Annotated[Floats, "(n_tip, 2)"]
    right: Annotated[Floats, "(n_tip,)"]
    """Share of the row to the right of the segment."""

    @classmethod
    def of(cls, n: int) -> Aimed:
        """Return the table of n tips without segments."""
        target, nodes = np.full((n, 4), -1), np.zeros((n, 4), np.int64)
        return cls(target, nodes, np.zeros((n, 2)), np.zeros((n, 2)), np.zeros(n))

    @classmethod
    def along(cls, state: State, segments: Sequence[Segment]) -> Aimed:
        """Return the table of some segments, whose targets are not needed."""
        found = cls.of(len(segments))
        for i, segment in enumerate(segments):
            found.nodes[i], found.right[i] = state.quads[segment.row], segment.right
            found.entry[i], found.exit[i] = segment.entry, segment.exit
        return found


@kernel
def leave(
    ahead: RowsAhead,
    start: Ints,
    directions: Floats,
    lean: Floats,
    x: Floats,
    t: Floats,
    aimed: Aimed,
) -> int:
    """Write the segments from all tips; return how many there are.

    start : (n_tip + 1,), first row ahead of each tip, and the end.  directions : (n_tip,
    n_direction, 3), unit directions, the best first.  lean : (n_tip, 3), of the planes from the
    director.  x, t : (n_node, 3).
    """
    ahead, aimed = borrowed(ahead), borrowed(aimed)
    count = 0
    for i in range(lean.shape[0]):
        _end_at(aimed, i, 0, 0, 0, 0.0, 0.0)
        aimed.target[i, AHEAD] = -1
        for turn in range(directions.shape[1]):
            heading = directions[i, turn, 0], directions[i, turn, 1], directions[i, turn, 2]
            # Ends of oncoming cracks are the first rule, in all rows ahead.
            for joining in (True, False):
                for k in range(start[i], start[i + 1]):
                    if aimed.target[i, AHEAD] < 0 and through(
                        ahead, k, i, x, t, heading, load(lean, i), joining, aimed
                    ):
                        aimed.target[i, AHEAD] = k
        k = aimed.target[i, AHEAD]
        if k >= 0:
            for a in range(4):
                aimed.nodes[i, a] = ahead.nodes[k, a]
            aimed.entry[i, 0], aimed.entry[i, 1] = ahead.entry[k, 0], ahead.entry[k, 1]
            aimed.right[i] = _share_to_the_right(ahead, aimed, i)
            count += 1
    return count


@inline
def through(
    ahead: RowsAhead,
    k: int,
    i: int,
    x: Floats,
    t: Floats,
    heading: Vec3,
    lean: Vec3,
    joining: bool,
    aimed: Aimed,
) -> bool:
    """Write the segment through row k of the table for tip i; return whether there is one.

    joining : whether it must lead to where another crack ends.
    """
    here = at(ahead, k, ahead.entry[k, 0], ahead.entry[k, 1], x)
    director = at(ahead, k, ahead.entry[k, 0], ahead.entry[k, 1], t)
    normal = cross(sub(scale(1.0 / norm(director), director), lean), heading)
    if norm(normal) < AWAY:
        return False
    normal = scale(1.0 / norm(normal), normal)
    if joining:
        return _to_an_end(ahead, k, i, (here, normal, heading), x, aimed)
    n, hit, along, best, first_is_nearer = ahead.n_point[k], -1, 0.0, np.inf, True
    for j in range(n):
        if ahead.on_edge[k, j]:  # the ray begins on it
            continue
        start = _gap(ahead, k, j, x, here)
        b = (j + 1) % n
        stop = _gap(ahead, k, b, x, here)
        off_a, off_b = dot(start, normal), dot(stop, normal)
        if off_a * off_b > 0.0 or off_a == off_b:
            continue
        s = off_a / (off_a - off_b)
        far = dot(start, heading) + s * (dot(stop, heading) - dot(start, heading))
        if 0.0 < far < best:
            best, hit, along, first_is_nearer = far, j, s, abs(off_a) <= abs(off_b)
    if ahead.sides_only:
        return hit >= 0 and _along_a_side(ahead, k, i, (here, normal, heading), x, aimed)
    if hit < 0:
        return _past_a_corner(ahead, k, i, (here, normal, heading), x, aimed)
    for end in range(2):
        j = (hit + (end if first_is_nearer else 1 - end)) % n
        gap = _gap(ahead, k, j, x, here)
        # Other points than corners are crossings of another crack.
        reach = SNAP if ahead.corner[k, j] >= 0 else MERGE
        if abs(dot(gap, normal)) >= reach * ahead.size[k]:
            continue
        through = ahead.common[k, j] == NO_SIDE
        if through or ahead.breaks[k, j]:
            kind = AT_POINT if through else ALONG_SIDE
            side = ahead.side[k, hit] if through else ahead.common[k, j]
            _end_at(aimed, i, kind, j, side, ahead.point[k, j, 0], ahead.point[k, j, 1])
            return True
        # The crack that leads there runs along the ray: there is nothing left to cut.
        if ahead.common[k, j] == FLANK and abs(dot(gap, normal)) < ALONG * dot(gap, heading):
            return False
    return _onto_edge(ahead, k, i, hit, along, x, aimed)


@inline
def _end_at(aimed: Aimed, i: int, kind: int, place: int, nth: int, xi: float, eta: float) -> None:
    """Write where the segment of tip i ends."""
    aimed.target[i, KIND], aimed.target[i, PLACE], aimed.target[i, NTH] = kind, place, nth
    aimed.exit[i, 0], aimed.exit[i, 1] = xi, eta


@inline
def _along_a_side(ahead: RowsAhead, k: int, i: int, ray: Ray, x: Floats, aimed: Aimed) -> bool:
    """Write the segment of tip i along the side of row k at the least angle to the ray."""
    here, normal, heading = ray
    least, found = np.inf, False
    for j in range(ahead.n_point[k]):
        if not ahead.breaks[k, j]:
            continue
        gap = _gap(ahead, k, j, x, here)
        off, far = abs(dot(gap, normal)), dot(gap, heading)
        if far > 0.0 and off < least * far:
            least, found = off / far, True
            xi, eta = ahead.point[k, j, 0], ahead.point[k, j, 1]
            _end_at(aimed, i, ALONG_SIDE, j, ahead.common[k, j], xi, eta)
    return found


@inline
def _to_an_end(ahead: RowsAhead, k: int, i: int, ray: Ray, x: Floats, aimed: Aimed) -> bool:
    """Write the segment of tip i through row k to where an oncoming crack ends near the ray."""
    here, normal, heading = ray
    nearest, found = JOIN * ahead.size[k], False
    for c in range(ahead.first_end[k], ahead.first_end[k + 1]):
        gap = sub(at(ahead, k, ahead.end[c, 0], ahead.end[c, 1], x), here)
        off = abs(dot(gap, normal))
        if off < nearest and dot(gap, heading) > 0.0:
            nearest, found = off, True
            xi, eta = ahead.end[c, 0], ahead.end[c, 1]
            _end_at(aimed, i, AT_END, ahead.end_edge[c], ahead.end_side[c], xi, eta)
    return found


@inline
def _past_a_corner(ahead: RowsAhead, k: int, i: int, ray: Ray, x: Floats, aimed: Aimed) -> bool:
    """Write the segment of tip i that passes a corner of row k along whose side the ray runs."""
    here, normal, heading = ray
    n, on, count = ahead.n_point[k], -1, 0
    for j in range(n):
        if ahead.on_edge[k, j]:
            on, count = j, count + 1
    if count != 1 or ahead.side[k, on] == FLANK:
        return False
    for end in range(2):
        j = on if end else (on + 1) % n
        edge = (on + n - 1) % n if end else j
        side = ahead.side[k, edge]
        gap = _gap(ahead, k, j, x, here)
        off, far = abs(dot(gap, normal)), dot(gap, heading)
        if ahead.corner[k, j] < 0 or side == FLANK or not off < GRAZE * far:
            continue
        a, b = _point(ahead, k, edge), _point(ahead, k, (edge + 1) % n)
        along = 1.0 - SNAP if end else SNAP
        s_a, s_b = along_side(side, a), along_side(side, b)
        own, which, clear = s_a + along * (s_b - s_a), 0, True
        for c in range(ahead.crossing[k, edge, 0], ahead.crossing[k, edge, 1]):
            clear = clear and abs(ahead.known[c] - own) >= SNAP
            if ahead.known[c] > own:
                which = c + 1 - ahead.crossing[k, edge, 0]
        if clear:
            xi, eta = a[0] + along * (b[0] - a[0]), a[1] + along * (b[1] - a[1])
            _end_at(aimed, i, ON_SIDE, edge, which, xi, eta)
            return True
    return False


@inline
def _onto_edge(
    ahead: RowsAhead, k: int, i: int, hit: int, along: float, x: Floats, aimed: Aimed
) -> bool:
    """Write where on an edge of row k the segment of tip i ends; return whether it may."""
    side, after = ahead.side[k, hit], (hit + 1) % ahead.n_point[k]
    a, b = _point(ahead, k, hit), _point(ahead, k, after)
    kind, which, s = ON_FLANK, 0, along
    if side != FLANK:
        s_a, s_b = along_side(side, a), along_side(side, b)
        s = s_a + min(max(along, SNAP), 1.0 - SNAP) * (s_b - s_a)
        first, second = load(x, ahead.nodes[k, side]), load(x, ahead.nodes[k, (side + 1) % 4])
        reach = MERGE * ahead.size[k] / norm(sub(second, first))
        kind, own = ON_SIDE, s
        for c in range(ahead.crossing[k, hit, 0], ahead.crossing[k, hit, 1]):
            known = ahead.known[c]
            if kind == ON_SIDE and ahead.can_meet[c] and abs(known - own) < reach:
                kind, s, which = AT_CROSSING, known, c - ahead.crossing[k, hit, 0]
            elif kind == ON_SIDE and known > own:
                which = c + 1 - ahead.crossing[k, hit, 0]
        s = (s - s_a) / (s_b - s_a)
    xi, eta = a[0] + s * (b[0] - a[0]), a[1] + s * (b[1] - a[1])
    _end_at(aimed, i, kind, hit, which, xi, eta)
    return not _on_edge_of_entry(ahead, k, xi, eta)


@inline
def _on_edge_of_entry(ahead: RowsAhead, k: int, xi: float, eta: float) -> bool:
    """Return whether a place lies on an edge of row k's polygon on which the entry lies."""
    n, on = ahead.n_point[k], False
    for j in range(n):
        a, b = _point(ahead, k, j), _point(ahead, k, (j + 1) % n)
        on = on or (ahead.on_edge[k, j] and is_on((xi, eta), a, b))
    return on


@inline
def _share_to_the_right(ahead: RowsAhead, aimed: Aimed, i: int) -> float:
    """Return which part of its row lies to the right of the segment of tip i."""
    k, kind, last = aimed.target[i, AHEAD], aimed.target[i, KIND], aimed.target[i, PLACE]
    n = ahead.n_point[k]
    if kind == ALONG_SIDE:
        return 1.0
    stop = last if kind == AT_POINT else (last + 1) % n
    ax, ay = ahead.entry[k, 0], ahead.entry[k, 1]
    j, total = ahead.first[k], 0.0
    while j != stop:
        after = (j + 1) % n
        bx, by = ahead.point[k, j, 0], ahead.point[k, j, 1]
        cx, cy = ahead.point[k, after, 0], ahead.point[k, after, 1]
        if after == stop:
            cx, cy = aimed.exit[i, 0], aimed.exit[i, 1]
        area = 0.5 * ((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
        slope = ahead.J[k, 1] * (ax + bx + cx) + ahead.J[k, 2] * (ay + by + cy)
        total += area * (ahead.J[k, 0] + slope / 3.0)
        j = after
    return total


@inline
def _gap(ahead: RowsAhead, k: int, j: int, x: Floats, here: Vec3) -> Vec3:
    """Return the vector from a place to point j of the polygon of row k."""
    return sub(at(ahead, k, ahead.point[k, j, 0], ahead.point[k, j, 1], x), here)


@inline
def _point(ahead: RowsAhead, k: int, j: int) -> Point:
    return ahead.point[k, j, 0], ahead.point[k, j, 1]


@inline
def at(ahead: RowsAhead, k: int, xi: float, eta: float, rows: Floats) -> Vec3:
    """Return what rows : (n_node, 3) are at a place of row k of the table."""
    return place_in(corners_of(rows, ahead.nodes, k), xi, eta)
