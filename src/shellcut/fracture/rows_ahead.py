"""Tips and the rows ahead of them as tables for kernels: what lasts as long as the topology."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from math import hypot
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import State

from .cut_film import CutFilm, End
from .quad_polygon import (
    AWAY,
    FLANK,
    Point,
    Polygon,
    common_side,
    contains,
    corner_at,
    density,
    edges,
    is_on,
    on_side,
    share_of,
)
from .tip import Tip

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
    """Weights that give of their positions in which direction it ran."""
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
    """First end of a crack that runs towards the tip of each row, and the end of them."""
    end: Annotated[Floats, "(n_end, 2)"]
    """Their film."""
    end_edge: Annotated[Ints, "(n_end,)"]
    """Edge of the polygon on which one lies, or point at which it is."""
    end_side: Annotated[Ints, "(n_end,)"]
    """Side of the quad on which it lies, or FLANK."""
    sides_only: bool
    """Whether cracks run along sides of the mesh only."""


def tips_of(
    state: State, film: CutFilm, tips: Sequence[Tip], others: Sequence[Tip] = ()
) -> tuple[Tips, RowsAhead]:
    """Return the tables of some tips, and of others that they may join.

    There must be rows ahead of each.
    """
    ahead = [film.rows_ahead(tip) for tip in tips]
    ends = [
        film.oncoming(row, entry, tip.heading, [*tips, *others])
        for rows, tip in zip(ahead, tips, strict=True)
        for row, entry in rows
    ]
    first = [rows[0] for rows in ahead]
    table = Tips(
        nodes=state.quads[[row for row, _ in first]].astype(np.int64),
        weight=np.array([shape_functions(*entry) for _, entry in first]),
        size=np.array([film.size(row) for row, _ in first]),
        forward=np.array(
            [film.heading_weights(*at, tip.heading) for at, tip in zip(first, tips, strict=True)]
        ),
        reference=np.array([film.reference_director(*at) for at in first]),
        start=np.cumsum([0, *map(len, ahead)]),
    )
    return table, table_of(state, film, [at for rows in ahead for at in rows], ends)


def table_of(
    state: State,
    film: CutFilm,
    every: Sequence[tuple[int, Point]],
    ends: Sequence[Sequence[End]],
) -> RowsAhead:
    """Return the table of some rows and the place of a tip in each.

    ends : of the cracks that run towards the tip, row by row.
    """
    rows = [row for row, _ in every]
    X = state.node.X[state.quads[rows]]
    polygons = [film.topology.polygon(row) for row in rows]
    n, most = len(every), max(len(polygon.points) for polygon in polygons)
    oncoming = [end for some in ends for end in some]
    found = RowsAhead(
        row=np.array(rows, np.int64),
        nodes=state.quads[rows].astype(np.int64),
        size=np.array([film.size(row) for row in rows]),
        entry=np.array([entry for _, entry in every]),
        first=np.zeros(n, np.int64),
        J=np.array([*map(_relative_density, polygons, map(bytes, X))]),
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
        first_end=np.cumsum([0, *map(len, ends)]),
        end=np.array([end.place for end in oncoming]).reshape(-1, 2),
        end_edge=np.array([end.edge for end in oncoming], np.int64),
        end_side=np.array([end.side for end in oncoming], np.int64),
        sides_only=film.sides_only,
    )
    known: list[tuple[float, bool]] = []
    for k, (row, entry) in enumerate(every):
        _fill(found, k, polygons[k], film, row, entry, known)
    return found._replace(
        known=np.array([s for s, _ in known]),
        can_meet=np.array([can for _, can in known], np.bool_),
    )


@lru_cache(maxsize=1024)
def _relative_density(polygon: Polygon, X: bytes) -> Floats:
    J = density(np.frombuffer(X).reshape(4, 3))
    return np.array(J) / (4.0 * J[0] * share_of(polygon, J))


def _fill(
    table: RowsAhead,
    k: int,
    polygon: Polygon,
    film: CutFilm,
    row: int,
    entry: Point,
    known: list[tuple[float, bool]],
) -> None:
    """Write the polygon of row k of the table; append the crossings on it to ``known``."""
    ring, start, n = film.ring(row), corner_at(entry), len(polygon.points)
    table.n_point[k], table.point[k, :n], table.side[k, :n] = n, polygon.points, polygon.sides
    table.first[k], corners, common, table.on_edge[k, :n] = _outline(polygon, entry)
    table.corner[k, :n], table.common[k, :n] = corners, common
    for j, side in enumerate(polygon.sides):
        if common[j] not in (NO_SIDE, FLANK) and start >= 0 and corners[j] not in (-1, start):
            table.breaks[k, j] = film.may_break(row, start, corners[j])
        table.crossing[k, j, 0] = len(known)
        if side != FLANK and not film.sides_only:
            for s in reversed(film.topology.crossings(ring[side], ring[(side + 1) % 4])):
                place = on_side(side, s)
                can_meet = contains(polygon, place) and common_side(polygon, entry, place) is None
                known.append((s, can_meet))
        table.crossing[k, j, 1] = len(known)


@lru_cache(maxsize=1024)
def _outline(polygon: Polygon, entry: Point) -> tuple[int, list[int], list[int], list[bool]]:
    """Return ``first`` of a polygon, and ``corner``, ``common`` and ``on_edge`` of its points."""
    points, first = polygon.points, 0
    common = (common_side(polygon, entry, point) for point in points)
    on_edge = []
    for j, (before, after, _) in enumerate(edges(polygon), 1):
        on_edge.append(is_on(entry, before, after))
        if on_edge[-1] and hypot(after[0] - entry[0], after[1] - entry[1]) > AWAY:
            first = j % len(points)
    sides = [NO_SIDE if side is None else side for side in common]
    return first, [corner_at(point) for point in points], sides, on_edge
