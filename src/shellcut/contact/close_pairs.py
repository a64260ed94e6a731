"""Search for the quads close to some points of the film: pairs for its contact with itself.

Quads are sorted into the cells of a grid around the points, each into every cell with a point that
its box, wider by the reach, touches; a point then looks into its own cell. Most quads are far from
all points: one question to the cells next to those with a point leaves them out. What hangs
together with a point is no partner of it: quads with a node that is within ``rings`` sides of the
point, counted along the film and not across cracks.

The partners of a point fall into *sheets*: quads that hang together by common nodes. A point
between two flaps has two sheets as partners, and touches each by itself.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.numerics.jit import BoundOnce, inline, kernel

# Cells over points, above which the cells are made larger: points that fly apart need few.
_MOST_CELLS = 64

# Pairs that room is made for at first, over the points.
_ROOM = 16


class Pairs(NamedTuple):
    """Points and the quads close to them, sheet by sheet."""

    node: Annotated[Ints, "(n_point,)"]
    """Those of the points that have partners, ascending."""
    first_sheet: Annotated[Ints, "(n_point_1,)"]
    """First sheet of every point, and the end."""
    first_pair: Annotated[Ints, "(n_sheet_1,)"]
    """First pair of every sheet, and the end."""
    row: Annotated[Ints, "(n_pair,)"]
    """Quad or copy of every pair, ascending within a sheet."""

    @property
    def sheet_of_pair(self) -> Ints:
        """Sheet of every pair, shape (n_pair,)."""
        return np.repeat(np.arange(len(self.first_pair) - 1), np.diff(self.first_pair))

    @property
    def node_of_sheet(self) -> Ints:
        """Point of every sheet, shape (n_sheet,)."""
        return np.repeat(self.node, np.diff(self.first_sheet))


class Film(NamedTuple):
    """Positions and connectivity of the film, as the search takes them."""

    x: Annotated[Floats, "(n_node, 3)"]
    quads: Annotated[Ints, "(n_row, 4)"]
    at: Annotated[Ints, "(n_node, n_most)"]
    """Rows at every node."""
    absent: Annotated[Bools, "(n_row,)"]
    """Rows that are no partners."""
    n_at: Annotated[Ints, "(n_node,)"]


class Own(NamedTuple):
    """The rows that hang together with each of some points, which are no partners of it."""

    first: Annotated[Ints, "(n_point_1,)"]
    """First row of every point, and the end."""
    row: Annotated[Ints, "(n_own,)"]


class _Boxes(NamedTuple):
    """Around the nodes of each row."""

    low: Annotated[Floats, "(n_used, 3)"]
    high: Annotated[Floats, "(n_used, 3)"]


class CloseQuads:
    """Finds the quads close to points."""

    def __init__(self) -> None:
        self._sort = BoundOnce(_sort_into_cells)
        self._find = BoundOnce(_find)
        self._mark, self._boxes = BoundOnce(_mark_cells), BoundOnce(_write_boxes)
        self._own = BoundOnce(_own_rows)
        self._found: Ints = np.empty((0, 3), np.int64)

    def own(self, points: Ints, rings: Ints, film: Film) -> Own:
        """Return the rows with a node within so many sides of each point; good until the next cut.

        Parameters
        ----------
        points : ndarray of int, shape (n,)
            Nodes, ascending.
        rings : ndarray of int, shape (n,)
            Sides along the film within which nothing is a partner, at least 1.
        film : Film
            Of a state.
        """
        first, room = np.zeros(points.size + 1, np.int64), _ROOM * points.size
        while True:
            row = np.empty(room, np.int64)
            count = self._own(points, rings, film, first, row)
            if count <= room:
                return Own(first, row[:count].copy())
            room = count

    def find(self, points: Ints, own: Own, film: Film, n_row: int, reach: float) -> Pairs:
        """Return the pairs of points and quads closer than ``reach`` by their boxes.

        Parameters
        ----------
        points : ndarray of int, shape (n,)
            Nodes, ascending.
        own : Own
            Of these points, see :meth:`own`.
        film : Film
            Of a state.
        n_row : int
            Rows in use.
        reach : float
            [mm]
        """
        places = film.x.T[:, points]  # rows of numbers that lie side by side
        if not points.size or not np.isfinite(places).all():
            return _NONE
        low = places.min(axis=1)
        extent = places.max(axis=1) - low
        size = 2.0 * reach
        while np.prod(extent // size + 1.0) > _MOST_CELLS * (points.size + 16):
            size *= 1.5
        shape = (extent // size).astype(np.int64) + 1
        grid = low, size, shape
        n_cell = int(shape.prod())
        first, near = np.zeros(n_cell + 1, np.int64), np.zeros((2, n_cell), np.bool_)
        self._mark(points, film.x, *grid, near)
        boxes = _Boxes(np.empty((n_row, 3)), np.empty((n_row, 3)))
        self._boxes(film.x, film.quads, reach, boxes)
        close, none = np.flatnonzero(~film.absent[:n_row]), np.zeros(0, np.int64)
        n_close, count = self._sort(boxes, close, *grid, near, first, none)
        rows = np.empty(count, np.int64)
        self._sort(boxes, close[:n_close], *grid, near, first, rows)
        room = _ROOM * points.size
        while True:
            if len(self._found) < room:
                self._found = np.empty((room, 3), np.int64)
            n = self._find(points, own, film, boxes, *grid, first, rows, self._found)
            if n <= len(self._found):
                return _in_sheets(points, self._found[:n])
            room = 2 * n


_NONE = Pairs(np.zeros(0, np.int64), *(np.zeros(1, np.int64),) * 2, np.zeros(0, np.int64))


def _in_sheets(points: Ints, found: Ints) -> Pairs:
    """Return pairs from rows (place of the point, sheet, row), which ascend."""
    point, sheet, row = found.T
    new = np.flatnonzero(np.diff(point, prepend=-1) | np.diff(sheet, prepend=-1))
    at = point[new]
    first_sheet = np.flatnonzero(np.diff(at, prepend=-1))
    return Pairs(
        node=points[at[first_sheet]],
        first_sheet=np.append(first_sheet, at.size),
        first_pair=np.append(new, point.size),
        row=np.ascontiguousarray(row),
    )


@kernel
def _write_boxes(x: Floats, quads: Ints, reach: float, boxes: _Boxes) -> None:
    """Write the boxes around the first rows, wider by the reach [mm]."""
    low, high = boxes
    for row in range(low.shape[0]):
        for c in range(3):
            lowest = highest = x[quads[row, 0], c]
            for a in range(1, 4):
                here = x[quads[row, a], c]
                lowest, highest = min(lowest, here), max(highest, here)
            low[row, c], high[row, c] = lowest - reach, highest + reach


@kernel
def _mark_cells(
    points: Ints, x: Floats, low: Floats, size: float, shape: Ints, near: Bools
) -> None:
    """Mark the cells with a point, and those next to one: near : (2, n_cell)."""
    for n in points:
        i, j, k = _cell_of(x, n, low, size, shape)
        if near[0, (i * shape[1] + j) * shape[2] + k]:
            continue
        near[0, (i * shape[1] + j) * shape[2] + k] = True
        for u in range(max(i - 1, 0), min(i + 2, shape[0])):
            for v in range(max(j - 1, 0), min(j + 2, shape[1])):
                for w in range(max(k - 1, 0), min(k + 2, shape[2])):
                    near[1, (u * shape[1] + v) * shape[2] + w] = True


@inline
def _cell_of(x: Floats, n: int, low: Floats, size: float, shape: Ints) -> tuple[int, int, int]:
    """Return the cell of a node."""
    i = min(max(int((x[n, 0] - low[0]) / size), 0), shape[0] - 1)
    j = min(max(int((x[n, 1] - low[1]) / size), 0), shape[1] - 1)
    return i, j, min(max(int((x[n, 2] - low[2]) / size), 0), shape[2] - 1)


@kernel
def _sort_into_cells(
    boxes: _Boxes,
    close: Ints,
    low: Floats,
    size: float,
    shape: Ints,
    near: Bools,
    first: Ints,
    rows: Ints,
) -> tuple[int, int]:
    """Return how many of some rows go into cells with a point, and how often.

    Those that do are moved to the front of close : (n,); how often, is counted in first :
    (n_cell + 1,). With room for them, rows : (n,), write them there cell by cell, ascending.
    near : (2, n_cell), the cells with a point, and those next to one.
    """
    fill = rows.shape[0] > 0
    if not fill:
        first[:] = 0
    begin, stop = np.zeros(3, np.int64), np.zeros(3, np.int64)
    place, n_close = first.copy(), 0
    for one_of in range(close.shape[0]):
        row = close[one_of]
        outside = False
        for c in range(3):
            one = (boxes.low[row, c] - low[c]) / size
            two = (boxes.high[row, c] - low[c]) / size
            if not (one < shape[c] and two >= 0.0):  # nor if it is not finite
                outside = True
                break
            begin[c] = int(max(one, 0.0))
            stop[c] = int(min(two, shape[c] - 1.0)) + 1
        if outside:
            continue
        # Of three cells one after the other, the one in the middle is next to the others.
        if max(stop[0] - begin[0], max(stop[1] - begin[1], stop[2] - begin[2])) <= 3:
            i, j = min(begin[0] + 1, shape[0] - 1), min(begin[1] + 1, shape[1] - 1)
            k = min(begin[2] + 1, shape[2] - 1)
            if not near[1, (i * shape[1] + j) * shape[2] + k]:
                continue
        goes = False
        for i in range(begin[0], stop[0]):
            for j in range(begin[1], stop[1]):
                for k in range(begin[2], stop[2]):
                    cell = (i * shape[1] + j) * shape[2] + k
                    if not near[0, cell]:
                        continue
                    goes = True
                    if fill:
                        rows[place[cell]] = row
                        place[cell] += 1
                    else:
                        first[cell + 1] += 1
        if goes:
            close[n_close] = row
            n_close += 1
    if not fill:
        for cell in range(first.shape[0] - 1):
            first[cell + 1] += first[cell]
    return n_close, int(first[first.shape[0] - 1])


@kernel
def _own_rows(points: Ints, rings: Ints, film: Film, first: Ints, rows: Ints) -> int:
    """Write the rows with a node within the rings of each point; return how many there are.

    first : (n_point + 1,), written.  rows : written as far as there is room.
    """
    quads, at, n_at = film.quads, film.at, film.n_at
    node_of = np.full(film.x.shape[0], -1, np.int64)  # point whose rings a node is in
    row_of = np.full(quads.shape[0], -1, np.int64)
    near = np.empty(film.x.shape[0], np.int64)
    count = 0
    for i in range(points.shape[0]):
        near[0], n_near, begin = points[i], 1, 0
        node_of[points[i]] = i
        # The rows at the nodes of a ring hold the next one.
        for _ in range(rings[i] + 1):
            end = n_near
            for k in range(begin, end):
                for j in range(n_at[near[k]]):
                    row = at[near[k], j]
                    if row_of[row] == i:
                        continue
                    row_of[row] = i
                    if count < rows.shape[0]:
                        rows[count] = row
                    count += 1
                    for a in range(4):
                        node = quads[row, a]
                        if node_of[node] != i:
                            node_of[node] = i
                            near[n_near] = node
                            n_near += 1
            begin = end
        first[i + 1] = count
    return count


@kernel
def _find(
    points: Ints,
    own: Own,
    film: Film,
    boxes: _Boxes,
    low: Floats,
    size: float,
    shape: Ints,
    first: Ints,
    rows: Ints,
    found: Ints,
) -> int:
    """Write (place of the point, sheet, row) of every pair to found : (n, 3); return their number.

    They ascend. The number is right also where there is no room for all.  first, rows : of the
    cells.
    """
    x, quads = film.x, film.quads
    is_own = np.full(quads.shape[0], -1, np.int64)  # point that a row hangs together with
    owner = np.full(x.shape[0], -1, np.int64)  # pair that a node was met by ...
    of_point = np.full(x.shape[0], -1, np.int64)  # ... of this point
    leader = np.empty(4096, np.int64)
    partner = np.empty(4096, np.int64)
    count = 0
    for i in range(points.shape[0]):
        n = points[i]
        for j in range(own.first[i], own.first[i + 1]):
            is_own[own.row[j]] = i
        u, v, w = _cell_of(x, n, low, size, shape)
        cell = (u * shape[1] + v) * shape[2] + w
        n_pair = 0
        for j in range(first[cell], first[cell + 1]):
            row = rows[j]
            if is_own[row] == i:
                continue
            apart = False
            for c in range(3):
                apart |= (x[n, c] < boxes.low[row, c]) | (x[n, c] > boxes.high[row, c])
            if apart or n_pair == partner.shape[0]:
                continue
            # Pairs with a common node are of one sheet: the first of them leads it.
            partner[n_pair], leader[n_pair] = row, n_pair
            for a in range(4):
                node = quads[row, a]
                if of_point[node] != i:
                    of_point[node], owner[node] = i, n_pair
                one, two = n_pair, owner[node]
                while leader[one] != one:
                    one = leader[one]
                while leader[two] != two:
                    two = leader[two]
                leader[max(one, two)] = min(one, two)
            n_pair += 1
        for k in range(n_pair):
            one = k
            while leader[one] != one:
                one = leader[one]
            if count < found.shape[0]:
                _insert(found, count, i, one, partner[k])
            count += 1
    return count


@inline
def _insert(found: Ints, count: int, point: int, sheet: int, row: int) -> None:
    """Put a pair behind the others of its point and sheet; rows come in ascending order."""
    place = count
    while place > 0 and found[place - 1, 0] == point and found[place - 1, 1] > sheet:
        for c in range(3):
            found[place, c] = found[place - 1, c]
        place -= 1
    found[place, 0], found[place, 1], found[place, 2] = point, sheet, row
