"""The cables across the segments of a crack: fibres, evenly along each of them.

A segment of length L is joined by n fibres, the k-th at s_k = (k + 1/2)/n of its length, each with
the area h L/n. On either flank the segment runs straight between two points a and b, where it
begins and where it ends: a node where the crack runs through a corner, else a flank point
(:mod:`shellcut.fracture.flank_points`). The end of a fibre follows them, and hands its force on,

    x = (1 - s) x_a + s x_b,    v = (1 - s) v_a + s v_b,    F_a = (1 - s) F,    F_b = s F,

so that F · v is the power at a and b, and sum and moment of the forces are those of F.

All fibres of a segment are made as soon as it is cut, closed as the crack still is at its tip, and
take up force along all of it while it opens. Where the blade arrives before the flanks part, as on
the chord through a quad in which a cut begins, its edge bends them one after the other. Their m is
the normal to the segment in the sheet at that moment.

Midpoints sum up the work of an opening that is linear along the segment but for 1/(4 n²) of what
it is at the middle.

When a copy is cut again, the ends of a fibre belong to the part that contains its place; a flank
point that belongs to the other part gets a *stand-in* there for these fibres, which touches
nothing.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, unit
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.material.shell_material import ShellMaterial
from shellcut.state import NOT_MET, KnownTopology, State

from .anisotropy import Anisotropy, factor_along
from .cut_topology import CutTopology
from .flank_points import add_flank_point, tie
from .quad_polygon import UNUSED, Point, between, contains, corner_at

BEFORE_AN_EDGE = 6
"""Cables of a segment where an edge reaches them one after the other."""

AT_ENDS = 0
"""Cables of a segment, one at each end, where nothing passes along it."""

# Of the segment: where a flank point belongs when its copy is cut again.
_INWARD = 0.15

# A fibre may lie on the new cut; a hair further shows to which part it belongs.
_HAIR = 1e-3


class SegmentCables:
    """Lays cables across segments, and keeps them at their nodes.

    count : fibres of a segment, evenly along it; 0: two cables at its ends.  anisotropy : of the
    film; a cable's area is that of the film it replaces times f.
    """

    def __init__(
        self,
        law: CohesiveTable,
        material: ShellMaterial,
        count: int,
        anisotropy: Anisotropy | None = None,
    ) -> None:
        self._law, self._material, self._anisotropy = law, material, anisotropy
        self._shares = (np.arange(count) + 0.5) / count if count else np.array([0.0, 1.0])
        self._known = KnownTopology()

    def lay(
        self,
        state: State,
        rows: Sequence[int],
        chords: Sequence[tuple[Point, Point]],
        length: float,
    ) -> None:
        """Lay the fibres of a new segment, which has its nodes.

        rows : to its right and left.  chords : where it starts and stops, in the quad of each.
        length : in the reference film [mm].
        """
        n, f = state.node, state.flank
        # Of start and stop: the node on the minus and on the plus flank.
        ends = [
            [
                _node_at(state, row, chord[end], between(chord[end], chord[1 - end], _INWARD))
                for row, chord in zip(rows, chords, strict=True)
            ]
            for end in (0, 1)
        ]
        for end, pair in enumerate(ends):
            if corner_at(chords[0][end]) < 0:
                minus, plus = (int(np.flatnonzero(f.node[: f.count] == k)[-1]) for k in pair)
                f.twin[minus], f.twin[plus] = plus, minus
        (start, _), (stop, _) = ends
        along = n.x[stop] - n.x[start]
        area = self._material.thickness * length
        area *= factor_along(self._anisotropy, n.X[state.quads[rows[0]]], chords[0])
        count, share = len(self._shares), self._shares[:, None]
        new, c = slice(state.cable.append_blank(count), state.n_cable), state.cable
        c.row[new], c.chord[new], c.share[new] = rows, chords, self._shares
        c.ends[new], c.far[new] = ends
        c.length[new], c.area[new] = length / count, area / count
        c.edge[new], c.birth[new] = NOT_MET, state.time
        m = unit(np.cross((1.0 - share) * n.t[start] + share * n.t[stop], along))
        c.m[new], c.branch[new, 0], c.branch[new, 1] = m, m, -m
        # What they are about to exert, which the next trial cut may count. Both ends of each move
        # alike yet: no work is done.
        c.traction[new] = self._law.strength
        c.force[new] = self._law.strength * area / count * c.branch[new]

    def follow(self, state: State, topology: CutTopology, row: int, new: int) -> None:
        """Give what is on a row that has been cut to the part that it belongs to."""
        part, f, c = topology.polygon(new), state.flank, state.cable
        for k in np.flatnonzero(f.row[: f.count] == row).tolist():
            xi, eta = f.inward[k].tolist()
            if contains(part, (xi, eta)):
                f.row[k] = new
        for k, side in np.argwhere(c.row[: c.count] == row).tolist():
            start, stop = c.chord[k, side].tolist()
            if contains(part, between(start, stop, float(c.share[k]) + _HAIR)):
                c.row[k, side] = new
        self._stand_in(state, (row, new))

    def _stand_in(self, state: State, rows: tuple[int, int]) -> None:
        """Give fibres on some rows flank points of their own where theirs are tied elsewhere."""
        f, c = state.flank, state.cable
        of = np.full(state.n_node, -1)
        of[f.node[: f.count]] = np.arange(f.count)
        made: dict[tuple[int, int], int] = {}
        for k, side in np.argwhere(np.isin(c.row[: c.count], rows)).tolist():
            row = int(c.row[k, side])
            for nodes in (c.ends, c.far):
                node = int(nodes[k, side])
                point = int(of[node])
                if point < 0 or f.row[point] == row:
                    continue
                if (node, row) not in made:
                    place, inward = map(tuple, (f.place[point].tolist(), f.inward[point].tolist()))
                    made[node, row] = add_flank_point(state, row, place, inward)
                nodes[k, side] = made[node, row]

    def renew(self, state: State, areas: Floats) -> None:
        """Bring all ends to their nodes, and the flank points to theirs.

        areas : (n_row,), of the whole quads [mm²].
        """
        c = state.cable
        for end, nodes in enumerate((c.ends, c.far)):
            place = c.chord[: c.count, :, end]
            k, side = np.nonzero(np.abs(place).min(axis=2) > 1.0 - UNUSED)
            right, up = (place[k, side] > 0.0).T
            nodes[k, side] = state.quads[c.row[k, side], np.where(up, 3 - right, right)]
        if state.flank.count:
            changed = self._known.changed_quads(state)
            tie(state, changed, areas, self._material.area_density)
        self._known.take(state)

    def restore(self) -> None:
        """Take a state from a checkpoint."""
        self._known = KnownTopology()


def _node_at(state: State, row: int, place: Point, inward: Point) -> int:
    """Return the node at a corner of a row, or a new flank point elsewhere."""
    corner = corner_at(place)
    if corner >= 0:
        return int(state.quads[row, corner])
    return add_flank_point(state, row, place, inward)
