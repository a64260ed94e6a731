"""Through which side or corner a driven crack would leave the row ahead: all tips in one kernel.

The same rules as :meth:`.blade_drive.BladeDrive.directions` and
:meth:`.crack_path.CrackPath.segment_from`, which a test compares with this. What lasts as long as
the topology is found once (:mod:`.rows_ahead`); with every step only the ray turns.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, scale, sub
from shellcut.tool.cutting_edge import NORMAL

from .blade_drive import LEAST, LOOK_AHEAD, TANGENT
from .chord_ends import at_place
from .crack_path import ALONG, GRAZE, JOIN, MERGE, SNAP
from .quad_polygon import FLANK
from .rows_ahead import AT_END_ON_FLANK, AT_END_POINT, NO_SIDE, RowsAhead, Tips
from .tip_places import AWAY

AT_POINT, ALONG_SIDE, AT_CROSSING, ON_SIDE, ON_FLANK = range(5)
"""Where a segment ends: at a point of the polygon, the same along a side of the mesh, on a crossing
of another crack, on a side between crossings, on a flank."""


class Aimed(NamedTuple):
    """Where the segments from tips would lead, written by :func:`aim`."""

    way: Annotated[Ints, "(n_tip, 4)"]
    """Which row ahead, -1 if the tip has none; where it ends (AT_POINT to ON_FLANK); at which point
    or edge; and at or after how many crossings from the last one."""
    exit: Annotated[Floats, "(n_tip, 2)"]
    right: Annotated[Floats, "(n_tip,)"]
    """Share of the row to the right of the segment."""


@kernel
def place_tips(tips: Tips, x: Floats, t: Floats, place: Floats, director: Floats) -> None:
    """Write place and unit director of tips : (n_tip, 3) from x, t : (n_node, 3)."""
    tips = borrowed(tips)
    for i in range(tips.size.shape[0]):
        p, d = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
        for a in range(4):
            p = combine(1.0, p, tips.weight[i, a], load(x, tips.nodes[i, a]))
            d = combine(1.0, d, tips.weight[i, a], load(t, tips.nodes[i, a]))
        length = norm(d)
        for c in range(3):
            place[i, c], director[i, c] = p[c], d[c] / length


@kernel
def aim(
    tips: Tips,
    ahead: RowsAhead,
    x: Floats,
    t: Floats,
    director: Floats,
    rotation: Floats,
    segments: Floats,
    edge_of: Ints,
    off: Floats,
    aimed: Aimed,
) -> int:
    """Write the segments from all tips that an edge drives; return how many there are.

    x, t : (n_node, 3).  director : (n_tip, 3), unit.  rotation : (n_tip, 3, 3), of the tool when it
    is an edge length beyond them.  edge_of, off : (n_tip,), segment and distance from its mid-plane
    [mm] then.
    """
    tips, ahead, aimed = borrowed(tips), borrowed(ahead), borrowed(aimed)
    count = 0
    for i in range(tips.size.shape[0]):
        aimed.way[i, 0], aimed.way[i, 1], aimed.way[i, 2], aimed.way[i, 3] = -1, 0, 0, 0
        if edge_of[i] < 0:
            continue
        d, e = load(director, i), edge_of[i]
        normal = segments[e, NORMAL, 0], segments[e, NORMAL, 1], segments[e, NORMAL, 2]
        turned = load(rotation[i], 0), load(rotation[i], 1), load(rotation[i], 2)
        b = dot(turned[0], normal), dot(turned[1], normal), dot(turned[2], normal)
        trace, heading = cross(d, b), (0.0, 0.0, 0.0)
        for a in range(4):
            heading = combine(1.0, heading, tips.forward[i, a], load(x, tips.nodes[i, a]))
        sign = -1.0 if dot(trace, heading) < 0.0 else 1.0
        trace = scale(sign / max(norm(trace), TANGENT), trace)
        sine = dot(b, load(tips.reference, i))
        across = scale(1.0 / max(1.0 - sine * sine, LEAST), combine(1.0, b, -dot(b, d), d))
        aside, lean = scale(off[i], across), scale(sine, across)
        for turn in range(len(LOOK_AHEAD) + 1):
            way = trace
            if turn < len(LOOK_AHEAD):
                way = combine(LOOK_AHEAD[turn] * tips.size[i], trace, -1.0, aside)
            way = scale(1.0 / max(norm(way), TANGENT), way)
            for joining in (True, False):
                for k in range(tips.start[i], tips.start[i + 1]):
                    if aimed.way[i, 0] < 0 and _through(
                        ahead, k, i, x, t, way, lean, joining, aimed
                    ):
                        aimed.way[i, 0] = k
        if aimed.way[i, 0] >= 0:
            aimed.right[i] = _share_to_the_right(ahead, aimed, i)
            count += 1
    return count


@inline
def _through(
    ahead: RowsAhead,
    k: int,
    i: int,
    x: Floats,
    t: Floats,
    way: Vec3,
    lean: Vec3,
    joining: bool,
    aimed: Aimed,
) -> bool:
    """Write the segment through row k of the table for tip i; return whether there is one.

    joining : whether it must lead to where another crack ends.
    """
    here = at_place(x, ahead.nodes, k, ahead.entry[k, 0], ahead.entry[k, 1])
    director = at_place(t, ahead.nodes, k, ahead.entry[k, 0], ahead.entry[k, 1])
    normal = cross(sub(scale(1.0 / norm(director), director), lean), way)
    if norm(normal) < AWAY:
        return False
    normal = scale(1.0 / norm(normal), normal)
    if joining:
        return _to_an_end(ahead, k, i, here, normal, way, x, aimed)
    n, hit, along, best, first_is_nearer = ahead.n_point[k], -1, 0.0, np.inf, True
    for j in range(n):
        if ahead.on_edge[k, j]:
            continue
        start = sub(at_place(x, ahead.nodes, k, ahead.point[k, j, 0], ahead.point[k, j, 1]), here)
        b = (j + 1) % n
        stop = sub(at_place(x, ahead.nodes, k, ahead.point[k, b, 0], ahead.point[k, b, 1]), here)
        off_a, off_b = dot(start, normal), dot(stop, normal)
        if off_a * off_b > 0.0 or off_a == off_b:
            continue
        s = off_a / (off_a - off_b)
        far = dot(start, way) + s * (dot(stop, way) - dot(start, way))
        if 0.0 < far < best:
            best, hit, along, first_is_nearer = far, j, s, abs(off_a) <= abs(off_b)
    if hit < 0:
        return _past_a_corner(ahead, k, i, here, normal, way, x, aimed)
    for end in range(2):
        j = (hit + (end if first_is_nearer else 1 - end)) % n
        gap = sub(at_place(x, ahead.nodes, k, ahead.point[k, j, 0], ahead.point[k, j, 1]), here)
        reach = SNAP if ahead.corner[k, j] >= 0 else MERGE
        if abs(dot(gap, normal)) >= reach * ahead.size[k]:
            continue
        through = ahead.common[k, j] == NO_SIDE
        if through or ahead.breaks[k, j]:
            aimed.way[i, 1] = AT_POINT if through else ALONG_SIDE
            aimed.way[i, 2], aimed.way[i, 3] = j, 0
            aimed.exit[i, 0], aimed.exit[i, 1] = ahead.point[k, j, 0], ahead.point[k, j, 1]
            return True
        if ahead.common[k, j] == FLANK and abs(dot(gap, normal)) < ALONG * dot(gap, way):
            return False
    return _onto_edge(ahead, k, i, hit, along, x, aimed)


@inline
def _to_an_end(
    ahead: RowsAhead,
    k: int,
    i: int,
    here: Vec3,
    normal: Vec3,
    way: Vec3,
    x: Floats,
    aimed: Aimed,
) -> bool:
    """Write the segment of tip i through row k to where an oncoming crack ends near the ray."""
    nearest, found = JOIN * ahead.size[k], False
    for c in range(ahead.first_end[k], ahead.first_end[k + 1]):
        gap = sub(at_place(x, ahead.nodes, k, ahead.end[c, 0], ahead.end[c, 1]), here)
        off = abs(dot(gap, normal))
        if off < nearest and dot(gap, way) > 0.0:
            nearest, found = off, True
            nth, kind = ahead.end_nth[c], AT_CROSSING
            if nth == AT_END_POINT:
                kind = AT_POINT
            elif nth == AT_END_ON_FLANK:
                kind = ON_FLANK
            aimed.way[i, 1], aimed.way[i, 2] = kind, ahead.end_edge[c]
            aimed.way[i, 3] = max(nth, 0)
            aimed.exit[i, 0], aimed.exit[i, 1] = ahead.end[c, 0], ahead.end[c, 1]
    return found


@inline
def _past_a_corner(
    ahead: RowsAhead,
    k: int,
    i: int,
    here: Vec3,
    normal: Vec3,
    way: Vec3,
    x: Floats,
    aimed: Aimed,
) -> bool:
    """Write the segment of tip i that passes a corner of row k along whose side the ray runs."""
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
        gap = sub(at_place(x, ahead.nodes, k, ahead.point[k, j, 0], ahead.point[k, j, 1]), here)
        off, far = abs(dot(gap, normal)), dot(gap, way)
        if ahead.corner[k, j] < 0 or side == FLANK or not off < GRAZE * far:
            continue
        a, b = ahead.point[k, edge], ahead.point[k, (edge + 1) % n]
        along = 1.0 - SNAP if end else SNAP
        s_a, s_b = _along(side, a[0], a[1]), _along(side, b[0], b[1])
        own, which, clear = s_a + along * (s_b - s_a), 0, True
        for c in range(ahead.crossing[k, edge, 0], ahead.crossing[k, edge, 1]):
            clear = clear and abs(ahead.known[c] - own) >= SNAP
            if ahead.known[c] > own:
                which = c + 1 - ahead.crossing[k, edge, 0]
        if clear:
            aimed.way[i, 1], aimed.way[i, 2], aimed.way[i, 3] = ON_SIDE, edge, which
            for c in range(2):
                aimed.exit[i, c] = a[c] + along * (b[c] - a[c])
            return True
    return False


@inline
def _onto_edge(
    ahead: RowsAhead, k: int, i: int, hit: int, along: float, x: Floats, aimed: Aimed
) -> bool:
    """Write where on an edge of row k the segment of tip i ends; return whether it may."""
    side, after = ahead.side[k, hit], (hit + 1) % ahead.n_point[k]
    a, b = ahead.point[k, hit], ahead.point[k, after]
    kind, which, s = ON_FLANK, 0, along
    if side != FLANK:
        s_a, s_b = _along(side, a[0], a[1]), _along(side, b[0], b[1])
        s = s_a + min(max(along, SNAP), 1.0 - SNAP) * (s_b - s_a)
        one, other = load(x, ahead.nodes[k, side]), load(x, ahead.nodes[k, (side + 1) % 4])
        reach = MERGE * ahead.size[k] / norm(sub(other, one))
        kind, own = ON_SIDE, s
        for c in range(ahead.crossing[k, hit, 0], ahead.crossing[k, hit, 1]):
            known = ahead.known[c]
            if kind == ON_SIDE and ahead.can_meet[c] and abs(known - own) < reach:
                kind, s, which = AT_CROSSING, known, c - ahead.crossing[k, hit, 0]
            elif kind == ON_SIDE and known > own:
                which = c + 1 - ahead.crossing[k, hit, 0]
        s = (s - s_a) / (s_b - s_a)
    aimed.way[i, 1], aimed.way[i, 2], aimed.way[i, 3] = kind, hit, which
    for c in range(2):
        aimed.exit[i, c] = a[c] + s * (b[c] - a[c])
    return not _on_edge_of_entry(ahead, k, aimed.exit[i, 0], aimed.exit[i, 1])


@inline
def _on_edge_of_entry(ahead: RowsAhead, k: int, xi: float, eta: float) -> bool:
    """Return whether a place lies on an edge of row k's polygon on which the entry lies."""
    n = ahead.n_point[k]
    for j in range(n):
        if ahead.on_edge[k, j]:
            a, b = ahead.point[k, j], ahead.point[k, (j + 1) % n]
            dx, dy = b[0] - a[0], b[1] - a[1]
            if abs((xi - a[0]) * dy - (eta - a[1]) * dx) < AWAY * sqrt(dx * dx + dy * dy):
                return True
    return False


@inline
def _share_to_the_right(ahead: RowsAhead, aimed: Aimed, i: int) -> float:
    """Return which part of its row lies to the right of the segment of tip i."""
    k, kind, last = aimed.way[i, 0], aimed.way[i, 1], aimed.way[i, 2]
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
def _along(side: int, xi: float, eta: float) -> float:
    """Return the fraction of the way along a side at which a point of it lies."""
    c = xi if side % 2 == 0 else eta
    return 0.5 * (1.0 + (c if side < 2 else -c))
