"""Tips and the rows ahead of them as tables for kernels: what lasts as long as the topology."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .crack_path import CrackPath, common_side, is_on
from .cut_topology import CutTopology
from .quad_polygon import (
    FLANK,
    Point,
    along_side,
    corner_at,
    density,
    holds,
    on_side,
    shape_functions,
    share_of,
)
from .tip import Tip
from .tip_places import AWAY

AT_END_POINT, AT_END_ON_FLANK = -1, -2
"""Of ``end_nth``: the other crack ends at a point of the polygon, or on a flank."""

NO_SIDE = -2
"""Of ``common``: two points of a polygon are on no common edge."""


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
    first_end: Annotated[Ints, "(n_ahead + 1,)"]
    """First end of a crack that comes towards the tip of each row, and the end of them."""
    end: Annotated[Floats, "(n_end, 2)"]
    """Their places."""
    end_edge: Annotated[Ints, "(n_end,)"]
    """Edge of the polygon on which one lies, or point at which it is ..."""
    end_nth: Annotated[Ints, "(n_end,)"]
    """... and which crossing of that edge it is, -1 at a point, -2 on a flank."""


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
        first_end=np.zeros(n + 1, np.int64),
        end=np.zeros((0, 2)),
        end_edge=np.zeros(0, np.int64),
        end_nth=np.zeros(0, np.int64),
    )
    known: list[tuple[float, bool]] = []
    ends: list[tuple[Point, int, int]] = []
    of = np.repeat(np.arange(len(tips)), np.diff(table.start)).tolist()
    for k, (row, entry) in enumerate(every):
        _fill(found, k, topology, path, row, entry, known)
        for place, edge, at_point in path.oncoming(row, entry, tips[of[k]].heading, tips):
            side, nth = int(found.side[k, edge]), AT_END_POINT if at_point else AT_END_ON_FLANK
            if side != FLANK and not at_point:
                s = along_side(side, place)
                crossings = known[found.crossing[k, edge, 0] : found.crossing[k, edge, 1]]
                nth = int(np.argmin([abs(one - s) for one, _ in crossings]))
            ends.append((place, edge, nth))
        found.first_end[k + 1] = len(ends)
    return table, found._replace(
        known=np.array([s for s, _ in known]),
        can_meet=np.array([can for _, can in known], np.bool_),
        end=np.array([place for place, _, _ in ends]).reshape(-1, 2),
        end_edge=np.array([edge for _, edge, _ in ends], np.int64),
        end_nth=np.array([nth for _, _, nth in ends], np.int64),
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
        table.common[k, j] = NO_SIDE if common is None else common
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
