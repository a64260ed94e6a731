"""Through which side or corner a driven crack would leave the row ahead: all tips in one kernel.

The same rules as :meth:`.blade_drive.BladeDrive.directions` and
:meth:`.crack_path.CrackPath.segment`, which a test compares with this. What lasts as long as the
topology is found once (:func:`rows_ahead`); with every step only the ray turns.
"""

from __future__ import annotations

from collections.abc import Sequence
from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline, kernel
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, scale, sub
from shellcut.state import State
from shellcut.tool.cutting_edge import NORMAL

from .blade_drive import LEAST, LOOK_AHEAD, TANGENT
from .crack_path import ALONG, AWAY, GRAZE, MERGE, SNAP, CrackPath, common_side, is_on
from .cut_topology import CutTopology
from .quad_polygon import (
    FLANK,
    Point,
    corner_at,
    density,
    holds,
    on_side,
    shape_functions,
    share_of,
)
from .tip import Tip

AT_POINT, ALONG_SIDE, AT_CROSSING, ON_SIDE, ON_FLANK = range(5)
"""Where a segment ends: at a point of the polygon, the same along a side of the mesh, on a crossing
of another crack, on a side between crossings, on a flank."""

# Of ``common``: two points of a polygon are on no common edge.
_NO_SIDE = -2


class Tips(NamedTuple):
    """Crack tips as kernels take them: what lasts as long as the topology."""

    nodes: Annotated[Ints, "(n_tip, 4)"]
    """Of the first row ahead."""
    weight: Annotated[Floats, "(n_tip, 4)"]
    """Their shape functions at the tip."""
    size: Annotated[Floats, "(n_tip,)"]
    """Local edge length [mm]."""
    forward: Annotated[Floats, "(n_tip, 4)"]
    """Weights that give of their positions in which direction it came."""
    reference: Annotated[Floats, "(n_tip, 3)"]
    """Unit director there in the reference film."""
    start: Annotated[Ints, "(n_tip + 1,)"]
    """First of its rows ahead, and the end."""


class RowsAhead(NamedTuple):
    """Rows ahead of tips and their polygons, likewise."""

    row: Annotated[Ints, "(n_ahead,)"]
    nodes: Annotated[Ints, "(n_ahead, 4)"]
    size: Annotated[Floats, "(n_ahead,)"]
    """sqrt(quad area) [mm]."""
    entry: Annotated[Floats, "(n_ahead, 2)"]
    """Place of the tip."""
    first: Annotated[Ints, "(n_ahead,)"]
    """First point of the polygon after the entry, counter-clockwise."""
    J: Annotated[Floats, "(n_ahead, 3)"]
    """Density, see :mod:`.quad_polygon`, over that of the whole polygon."""
    n_point: Annotated[Ints, "(n_ahead,)"]
    point: Annotated[Floats, "(n_ahead, most, 2)"]
    """Points of the polygon."""
    side: Annotated[Ints, "(n_ahead, most)"]
    """Side of the quad of the edge from each point to the next, or FLANK."""
    corner: Annotated[Ints, "(n_ahead, most)"]
    """Corner of the quad at each point, -1 if none."""
    common: Annotated[Ints, "(n_ahead, most)"]
    """On which side both entry and point are, -2 if on no common edge."""
    breaks: Annotated[Bools, "(n_ahead, most)"]
    """Whether a crack may run to that point along a side."""
    on_edge: Annotated[Bools, "(n_ahead, most)"]
    """Whether the entry is on the edge from each point to the next."""
    crossing: Annotated[Ints, "(n_ahead, most, 2)"]
    """First crossing on each edge, and the end."""
    known: Annotated[Floats, "(n_crossing,)"]
    """Crossings of other cracks, as fractions of the side, from the last to the first."""
    can_meet: Annotated[Bools, "(n_crossing,)"]
    """Whether a segment may end there."""


class Aimed(NamedTuple):
    """Where the segments from tips would lead, written by :func:`aim`."""

    way: Annotated[Ints, "(n_tip, 4)"]
    """Which row ahead, -1 if the tip has none; where it ends (AT_POINT to ON_FLANK); at which point
    or edge; and at or after how many crossings from the last one."""
    exit: Annotated[Floats, "(n_tip, 2)"]
    right: Annotated[Floats, "(n_tip,)"]
    """Share of the row to the right of the segment."""


def rows_ahead(
    state: State, topology: CutTopology, path: CrackPath, shell: MITC4Shell, tips: Sequence[Tip]
) -> tuple[Tips, RowsAhead]:
    """Return the tables of some tips; there must be rows ahead of each."""
    ahead = [path.rows_ahead(tip) for tip in tips]
    every = [(row, entry) for rows in ahead for row, entry in rows]
    rows = np.array([row for row, _ in every], np.int64)
    first = np.array([rows[0][0] for rows in ahead], np.int64)
    sizes = np.sqrt(shell.area)
    table = Tips(
        nodes=state.quads[first].astype(np.int64),
        weight=np.array([shape_functions(rows[0][1]) for rows in ahead]),
        size=sizes[first],
        forward=np.array(
            [path.carried_on(*rows[0], tip.heading) for rows, tip in zip(ahead, tips, strict=True)]
        ),
        reference=np.array([path.reference_director(*rows[0]) for rows in ahead]),
        start=np.cumsum([0, *map(len, ahead)]),
    )
    n, most = len(every), max(len(topology.polygon(row).points) for row, _ in every)
    found = RowsAhead(
        row=rows,
        nodes=state.quads[rows].astype(np.int64),
        size=sizes[rows],
        entry=np.array([entry for _, entry in every]),
        first=np.zeros(n, np.int64),
        J=np.array([_relative_density(state, topology, row) for row in rows.tolist()]),
        n_point=np.zeros(n, np.int64),
        point=np.zeros((n, most, 2)),
        side=np.zeros((n, most), np.int64),
        corner=np.zeros((n, most), np.int64),
        common=np.zeros((n, most), np.int64),
        breaks=np.zeros((n, most), np.bool_),
        on_edge=np.zeros((n, most), np.bool_),
        crossing=np.zeros((n, most, 2), np.int64),
        known=np.zeros(0),
        can_meet=np.zeros(0, np.bool_),
    )
    known: list[tuple[float, bool]] = []
    for k, (row, entry) in enumerate(every):
        _fill(found, k, topology, path, row, entry, known)
    return table, found._replace(
        known=np.array([s for s, _ in known]),
        can_meet=np.array([can for _, can in known], np.bool_),
    )


def _relative_density(state: State, topology: CutTopology, row: int) -> Floats:
    J = density(state.node.X[state.quads[row]])
    return np.array(J) / (4.0 * J[0] * share_of(topology.polygon(row), J))


def _fill(
    table: RowsAhead,
    k: int,
    topology: CutTopology,
    path: CrackPath,
    row: int,
    entry: Point,
    known: list[tuple[float, bool]],
) -> None:
    """Write the polygon of row k of the table; append the crossings on it to ``known``."""
    polygon, ring, start = topology.polygon(row), path.ring(row), corner_at(entry)
    points, n = polygon.points, len(polygon.points)
    table.n_point[k] = n
    for j in range(n):
        side, after = polygon.sides[j], points[(j + 1) % n]
        common = common_side(polygon, entry, points[j])
        table.point[k, j], table.side[k, j] = points[j], side
        table.corner[k, j] = corner_at(points[j])
        table.common[k, j] = _NO_SIDE if common is None else common
        if common not in (None, FLANK) and start >= 0 and table.corner[k, j] not in (-1, start):
            table.breaks[k, j] = path.may_break(row, start, int(table.corner[k, j]))
        table.on_edge[k, j] = is_on(entry, points[j], after)
        if table.on_edge[k, j] and np.hypot(*np.subtract(after, entry)) > AWAY:
            table.first[k] = (j + 1) % n
        table.crossing[k, j, 0] = len(known)
        if side != FLANK:
            for s in reversed(topology.crossings(ring[side], ring[(side + 1) % 4])):
                place = on_side(side, s)
                can_meet = holds(polygon, place) and common_side(polygon, entry, place) is None
                known.append((s, can_meet))
        table.crossing[k, j, 1] = len(known)


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
            for k in range(tips.start[i], tips.start[i + 1]):
                if aimed.way[i, 0] < 0 and _through(ahead, k, i, x, t, way, lean, aimed):
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
    aimed: Aimed,
) -> bool:
    """Write the segment through row k of the table for tip i; return whether there is one."""
    here = _at(ahead, k, ahead.entry[k, 0], ahead.entry[k, 1], x)
    director = _at(ahead, k, ahead.entry[k, 0], ahead.entry[k, 1], t)
    normal = cross(sub(scale(1.0 / norm(director), director), lean), way)
    if norm(normal) < AWAY:
        return False
    normal = scale(1.0 / norm(normal), normal)
    n, hit, along, best = ahead.n_point[k], -1, 0.0, np.inf
    for j in range(n):
        if ahead.on_edge[k, j]:
            continue
        start = sub(_at(ahead, k, ahead.point[k, j, 0], ahead.point[k, j, 1], x), here)
        b = (j + 1) % n
        stop = sub(_at(ahead, k, ahead.point[k, b, 0], ahead.point[k, b, 1], x), here)
        off_a, off_b = dot(start, normal), dot(stop, normal)
        if off_a * off_b > 0.0 or off_a == off_b:
            continue
        s = off_a / (off_a - off_b)
        far = dot(start, way) + s * (dot(stop, way) - dot(start, way))
        if 0.0 < far < best:
            best, hit, along = far, j, s
    if hit < 0:
        return _past_a_corner(ahead, k, i, here, normal, way, x, aimed)
    for end in range(2):
        j = (hit + end) % n
        gap = sub(_at(ahead, k, ahead.point[k, j, 0], ahead.point[k, j, 1], x), here)
        reach = SNAP if ahead.corner[k, j] >= 0 else MERGE
        if abs(dot(gap, normal)) >= reach * ahead.size[k]:
            continue
        through = ahead.common[k, j] == _NO_SIDE
        if through or ahead.breaks[k, j]:
            aimed.way[i, 1] = AT_POINT if through else ALONG_SIDE
            aimed.way[i, 2], aimed.way[i, 3] = j, 0
            aimed.exit[i, 0], aimed.exit[i, 1] = ahead.point[k, j, 0], ahead.point[k, j, 1]
            return True
        if ahead.common[k, j] == FLANK and abs(dot(gap, normal)) < ALONG * dot(gap, way):
            return False
    return _onto_edge(ahead, k, i, hit, along, x, aimed)


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
        gap = sub(_at(ahead, k, ahead.point[k, j, 0], ahead.point[k, j, 1], x), here)
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
def _at(ahead: RowsAhead, k: int, xi: float, eta: float, rows: Floats) -> Vec3:
    """Return what rows : (n_node, 3) are at a place of row k of the table."""
    one = combine(
        0.25 * (1.0 - xi) * (1.0 - eta),
        load(rows, ahead.nodes[k, 0]),
        0.25 * (1.0 + xi) * (1.0 - eta),
        load(rows, ahead.nodes[k, 1]),
    )
    other = combine(
        0.25 * (1.0 + xi) * (1.0 + eta),
        load(rows, ahead.nodes[k, 2]),
        0.25 * (1.0 - xi) * (1.0 + eta),
        load(rows, ahead.nodes[k, 3]),
    )
    return combine(1.0, one, 1.0, other)


@inline
def _along(side: int, xi: float, eta: float) -> float:
    """Return the fraction of the way along a side at which a point of it lies."""
    c = xi if side % 2 == 0 else eta
    return 0.5 * (1.0 + (c if side < 2 else -c))
