"""Which copies of cut quads share nodes: the whole topology of cracks that cross quads.

A quad of the mesh that a crack crosses is replaced by two copies, each with a polygon of it
(:mod:`shellcut.fracture.quad_polygon`). A copy has four nodes like any quad; those on its own side
of the crack are real, the others *virtual*: they carry on the copy's motion beyond the crack. There
is one rule ([Molino2004], with the scaled copies of [Song2006]):

    two copies in neighbouring quads share a node of the common side if and only if their polygons
    overlap on that side by some length and it is not broken.

The nodes around a node of the mesh are then the classes of (copy, corner) that are joined by a
chain of such sides. Closed tips, borders, splits at nodes, T-junctions and cuts of what is cut
already all follow from it:

* at a tip on a side, the neighbour ahead is whole and overlaps both copies: they share the two
  nodes of that side, and the crack is closed there;
* a crack along a side of the mesh breaks that side, and cuts no quad. The node at its far end
  stays connected: its other sides keep its quads together until one of these breaks, too;
* so does a part of a side between two cracks that end on it: no polygons overlap there.

Nothing else records the crack. A cut only ever divides classes, it never joins them.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache
from typing import Any

import numpy as np

from shellcut.arrays import Ints, SmallIds

from .quad_polygon import WHOLE, Point, Polygon, divide, has_corner, span

Corner = tuple[int, int]
"""Row of a copy and which of its corners."""

# Two polygons overlap on a side if it is by more than this fraction of the side: above round-off.
_OVERLAP = 1e-9


class CutTopology:
    """The copies of all quads, and the classes of their corners.

    Parameters
    ----------
    quads : ndarray of int, shape (n_quad, 4)
        Node ids of the mesh.
    quads_at, n_quad_at : ndarray of int, shapes (n_node, max_valence) and (n_node,)
        Quads at every node of the mesh.
    """

    def __init__(self, quads: Ints, quads_at: SmallIds, n_quad_at: SmallIds) -> None:
        self._quads = quads
        self._quads_at, self._n_quad_at = quads_at.copy(), n_quad_at.copy()
        # The mesh alone decides.
        self._quads_around = lru_cache(maxsize=1024)(self._found_around)
        self._rows: dict[int, list[int]] = {}
        self._polygons: dict[int, Polygon] = {}
        self._parents: list[int] = []
        # Of sides by their nodes, ascending: from where to where they are broken.
        self._broken: dict[tuple[int, int], list[tuple[float, float]]] = {}

    @property
    def n_row(self) -> int:
        """Number of rows: whole quads and copies."""
        return len(self._quads) + len(self._parents)

    def parent(self, row: int) -> int:
        """Return the quad of the mesh that a row is, or is a copy of."""
        n = len(self._quads)
        return row if row < n else self._parents[row - n]

    def rows_of(self, quad: int) -> list[int]:
        """Return the rows that carry the film of a quad of the mesh, ascending."""
        return self._rows.get(quad, [quad])

    def polygon(self, row: int) -> Polygon:
        """Return which part of its quad a row carries."""
        return self._polygons.get(row, WHOLE)

    def cut_rows(self) -> list[int]:
        """Return the rows that carry a part of their quad only, ascending."""
        return sorted(self._polygons)

    def opened_rows(self) -> list[int]:
        """Return the rows that are cut or touch a broken side, ascending."""
        nodes = {node for side in self._broken for node in side}
        rows = {row for node in nodes for row, _ in self.corners_at(node)}
        return sorted(rows.union(self._polygons))

    def cut(self, row: int, start: Point, end: Point) -> int:
        """Cut a row along a chord: it keeps what lies to the right, a new row gets the left.

        Parameters
        ----------
        row : int
            Which.
        start, end : Point
            Ends of the chord, on the boundary of the row's polygon.

        Returns
        -------
        int
            The new row. The nodes of the four corners are to be assigned anew
            (:meth:`classes`).
        """
        right, left = divide(self.polygon(row), start, end)
        quad, new = self.parent(row), self.n_row
        self._parents.append(quad)
        self._rows[quad] = [*self.rows_of(quad), new]
        self._polygons[row], self._polygons[new] = right, left
        return new

    def crossings(self, a: int, b: int) -> list[float]:
        """Return where cracks cross the side between two nodes of the mesh, as fractions of it."""
        found = set()
        for row, side, up in self.rows_beside(a, b):
            # A whole quad lies on all of its sides.
            if row in self._polygons and (interval := span(self.polygon(row), side)) is not None:
                found |= {s if up else 1.0 - s for s in interval}
        return sorted(s for s in found if _OVERLAP < s < 1.0 - _OVERLAP)

    def mend(self, row: int, new: int, polygon: Polygon) -> None:
        """Undo the last cut, which has made the row ``new`` of a polygon of ``row``."""
        quad = self._parents.pop()
        self._rows[quad].remove(new)
        del self._polygons[new]
        self._polygons[row] = polygon
        if polygon == WHOLE:
            del self._polygons[row], self._rows[quad]

    def break_side(self, a: int, b: int, start: float = 0.0, stop: float = 1.0) -> None:
        """Break the side between two nodes of the mesh, or a part of it between two cracks' ends.

        start < stop : fractions of it from a.
        """
        if a > b:
            a, b, start, stop = b, a, 1.0 - stop, 1.0 - start
        self._broken.setdefault((a, b), []).append((start, stop))

    def mend_side(self, a: int, b: int) -> None:
        """Undo the last :meth:`break_side` of a side."""
        side = min(a, b), max(a, b)
        self._broken[side].pop()
        if not self._broken[side]:
            del self._broken[side]

    def broken_parts(self, a: int, b: int) -> list[tuple[float, float]]:
        """Return from where to where the side between two nodes is broken, as fractions from a."""
        parts = self._broken.get((min(a, b), max(a, b)), [])
        return parts if a < b else [(1.0 - stop, 1.0 - start) for start, stop in parts]

    def is_broken(self, a: int, b: int) -> bool:
        """Return whether the whole side between two nodes of the mesh is broken."""
        return (0.0, 1.0) in self._broken.get((min(a, b), max(a, b)), ())

    def corners_at(self, node: int) -> list[Corner]:
        """Return all copies around a node of the mesh with their corner there, by quad and row."""
        around = self._quads_around(node)
        return [(row, ring.index(node)) for quad, ring in around for row in self.rows_of(quad)]

    def rows_beside(self, a: int, b: int) -> list[tuple[int, int, bool]]:
        """Return all copies on the side between two nodes of the mesh, by quad and row.

        With each which of its sides that is, and whether it leads from a to b.
        """
        found = []
        for quad, ring in self._quads_around(a):
            if b in ring:
                corner = ring.index(a)
                up = ring[(corner + 1) % 4] == b
                side = corner if up else (corner - 1) % 4
                found += [(row, side, up) for row in self.rows_of(quad)]
        return found

    def _found_around(self, node: int) -> list[tuple[int, list[int]]]:
        """Return the quads of the mesh at a node of it, and the nodes of each."""
        quads = self._quads_at[node, : self._n_quad_at[node]].tolist()
        return [(quad, self._quads[quad].tolist()) for quad in quads]

    def classes(self, node: int) -> list[list[Corner]]:
        """Return the classes of corners around a node of the mesh, each ascending."""
        corners = self.corners_at(node)
        place = {row: i for i, (row, _) in enumerate(corners)}
        group = list(range(len(corners)))
        ends: dict[int, list[tuple[int, int]]] = {}  # far node -> (quad, side) that lead there
        for quad, ring in self._quads_around(node):
            a = ring.index(node)
            ends.setdefault(ring[(a + 1) % 4], []).append((quad, a))
            ends.setdefault(ring[a - 1], []).append((quad, (a - 1) % 4))
        for far, sides in ends.items():
            if len(sides) < 2 or self.is_broken(node, far):
                continue
            (own, side), (other, other_side) = sides
            for row in self.rows_of(own):
                for beside in self.rows_of(other):
                    if self._overlap(row, side, beside, other_side):
                        mine, yours = group[place[row]], group[place[beside]]
                        group = [mine if of == yours else of for of in group]
        found: dict[int, list[Corner]] = {}
        for of, corner in zip(group, corners, strict=True):
            found.setdefault(of, []).append(corner)
        return [sorted(members) for members in found.values()]

    def is_real(self, members: Iterable[Corner]) -> bool:
        """Return whether the film of a class reaches its node."""
        return any(has_corner(self.polygon(row), corner) for row, corner in members)

    def _overlap(self, row: int, side: int, beside: int, other_side: int) -> bool:
        """Return whether two rows in neighbouring quads overlap on their common side."""
        mine, yours = self.polygon(row), self.polygon(beside)
        if mine is WHOLE and yours is WHOLE:
            return True
        own, opposite = span(mine, side), span(yours, other_side)
        if own is None or opposite is None:
            return False
        # Both quads are counter-clockwise: a side that one runs up the other runs down.
        low, high = max(own[0], 1.0 - opposite[1]), min(own[1], 1.0 - opposite[0])
        overlap = high - low
        if self._broken and overlap > _OVERLAP:
            ring = self._quads[self.parent(row)].tolist()
            for start, stop in self.broken_parts(ring[side], ring[(side + 1) % 4]):
                overlap -= max(0.0, min(high, stop) - max(low, start))
        return overlap > _OVERLAP

    def saved(self) -> dict[str, Any]:
        """Return polygons, parents and broken sides as arrays."""
        broken = [(*side, *part) for side, parts in sorted(self._broken.items()) for part in parts]
        rows = sorted(self._polygons)
        polygons = [self._polygons[row] for row in rows]
        return {
            "parents": np.array(self._parents, np.int64),
            "cut_rows": np.array(rows, np.int64),
            "n_point": np.array([len(p.points) for p in polygons], np.int64),
            "points": np.array([q for p in polygons for q in p.points]).reshape(-1, 2),
            "sides": np.array([side for p in polygons for side in p.sides], np.int64),
            "broken_sides": np.array([entry[:2] for entry in broken], np.int64).reshape(-1, 2),
            "broken_parts": np.array([entry[2:] for entry in broken], float).reshape(-1, 2),
        }

    def restore(self, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self._parents = saved["parents"].tolist()
        self._broken = {}
        for side, part in zip(saved["broken_sides"], saved["broken_parts"], strict=True):
            self.break_side(*side.tolist(), *part.tolist())
        self._rows, self._polygons = {}, {}
        n = len(self._quads)
        for i, quad in enumerate(self._parents):
            self._rows[quad] = [*self.rows_of(quad), n + i]
        stop = 0
        for row, count in zip(saved["cut_rows"].tolist(), saved["n_point"].tolist(), strict=True):
            start, stop = stop, stop + count
            points = tuple((xi, eta) for xi, eta in saved["points"][start:stop].tolist())
            self._polygons[row] = Polygon(points, tuple(saved["sides"][start:stop].tolist()))
