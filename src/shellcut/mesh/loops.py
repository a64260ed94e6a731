"""Closed polygons in the plane: area, what lies within them, and where their sides meet."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, norm, off_segments, product
from shellcut.formats.errors import point_text

from .checks import MeshError

_ROUND_OFF = 1e-12  # over the extent: sides of one polygon meet if they are closer
_NAMED = 4
_MOST_PAIRS = 10_000_000
_CHUNK = 500_000  # pairs of sides whose distance is taken at once


class Meeting(NamedTuple):
    """Two polygons that cross or touch, or one that meets itself."""

    one: int
    other: int
    place: Floats
    """One of the places, shape (2,)."""
    crosses: bool
    """Whether a side crosses one of the other there, and does not only touch it."""
    whole: bool
    """Whether each side of both meets the other polygon: the same loop, twice."""


def area_of(polygon: Floats) -> float:
    """Return the area within a polygon, shape (n, 2)."""
    x, y = (polygon - polygon[0]).T
    return 0.5 * abs(float(product(x, np.roll(y, -1)) - product(y, np.roll(x, -1))))


def levels(loops: Sequence[Floats]) -> Ints:
    """Return in how many of the others each polygon lies, if none meets another, shape (n_loop,).

    Examples
    --------
    >>> square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    >>> levels([square, 3.0 * square, square + 9.0, 0.5 * square])
    array([1, 0, 0, 2])
    """
    low = np.array([loop.min(axis=0) for loop in loops])
    high = np.array([loop.max(axis=0) for loop in loops])
    found = np.zeros(len(loops), np.int64)
    for k, loop in enumerate(loops):
        around = ((low < loop[0]) & (loop[0] < high)).all(axis=1)
        others = (i for i in np.flatnonzero(around).tolist() if i != k)
        found[k] = sum(bool(within(loop[:1], loops[i])[0]) for i in others)
    return found


def within(points: Floats, polygon: Floats) -> Bools:
    """Return which points, shape (n, 2), lie in a polygon: odd crossings of a ray along +x."""
    x, y = points.T[:, :, None]
    (x1, y1), (x2, y2) = polygon.T, np.roll(polygon, -1, axis=0).T
    spans = (y1 > y) != (y2 > y)
    rise = np.where(y1 == y2, 1.0, y2 - y1)
    crossed = spans & (x < x1 + (y - y1) * (x2 - x1) / rise)
    return np.asarray(crossed.sum(axis=1) % 2 == 1)


def meetings(loops: Sequence[Floats], reach: float = 0.0) -> list[Meeting]:
    """Return the first few polygons that cross, touch, come closer than ``reach``, meet themselves.

    Vertices are in order, the first is not repeated. The reach is of two polygons; of one only
    sides that are not neighbours count, and only round-off.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> [found] = meetings([square, square + 1.0])
    >>> found.crosses, found.whole
    (True, False)
    >>> [found.whole for found in meetings([square, square[::-1]])]
    [True]
    """
    a = np.concatenate(loops)
    b = np.concatenate([np.roll(loop, -1, axis=0) for loop in loops])
    n = np.array([len(loop) for loop in loops])
    loop_of = np.repeat(np.arange(len(loops)), n)
    first = np.repeat(np.cumsum(n) - n, n)
    after = first + (np.arange(len(a)) - first + 1) % n[loop_of]
    tiny = _ROUND_OFF * float(np.ptp(a, axis=0).max())
    i, j = _close_boxes(np.minimum(a, b), np.maximum(a, b), max(reach, tiny))
    meets, crosses = np.zeros(len(i), np.bool_), np.zeros(len(i), np.bool_)
    for at in range(0, len(i), _CHUNK):
        part = slice(at, at + _CHUNK)
        p, q = i[part], j[part]
        crosses[part] = _cross(a[p], b[p], a[q], b[q])
        # of neighbours, which share a point, the other two points count: sides folded back
        gaps = _gaps(a[p], b[p], a[q], b[q])
        gaps[np.ix_((0, 3), after[q] == p)] = np.inf
        gaps[np.ix_((1, 2), after[p] == q)] = np.inf
        far = np.where(loop_of[p] == loop_of[q], tiny, max(reach, tiny))
        meets[part] = crosses[part] | (gaps.min(axis=0) <= far)
    i, j, crosses = i[meets], j[meets], crosses[meets]
    found = []
    for one, other in np.unique(np.stack([loop_of[i], loop_of[j]], axis=1), axis=0)[:_NAMED]:
        rows = np.flatnonzero((loop_of[i] == one) & (loop_of[j] == other))
        at = rows[np.argmax(crosses[rows])]
        met = np.unique(np.concatenate([i[rows], j[rows]]))
        whole = one != other and len(met) == n[one] + n[other]
        ends = a[i[at]], b[i[at]], a[j[at]], b[j[at]]
        place = _place(*(point[None] for point in ends))
        found.append(Meeting(int(one), int(other), place, bool(crosses[at]), bool(whole)))
    return found


def not_one_film(
    loops: Sequence[Floats], names: Sequence[str], *, outer: int = 0, apart: float = 0.0
) -> list[str]:
    """Return why loops are not an outline, that of number ``outer``, with holes inside.

    Loops have names in the sentences; they are ``apart`` at least.

    Examples
    --------
    >>> square = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
    >>> not_one_film([square, square + 4.0, square + 1.0], ["outline", "hole_1", "hole_2"])
    ['outline crosses hole_2 at (2, 1)']
    """
    if problems := [_told(found, names, apart) for found in meetings(loops, apart)]:
        return problems
    level = levels(loops)
    problems = [
        f"{names[k]} lies outside" for k in np.flatnonzero(level == 0).tolist() if k != outer
    ]
    return problems + [f"{names[k]} lies in a hole" for k in np.flatnonzero(level > 1).tolist()]


def _told(found: Meeting, names: Sequence[str], apart: float) -> str:
    one, other = names[found.one], names[found.other]
    if found.whole:
        return f"{one} is drawn twice"
    how = "crosses" if found.crosses else "touches"
    if found.one == found.other:
        other = "itself"
    elif apart and not found.crosses:
        how += f" (or comes closer than {apart:.2g} mm to)"
    return f"{one} {how} {other} at {point_text(found.place)}"


def _close_boxes(low: Floats, high: Floats, reach: float) -> tuple[Ints, Ints]:
    # the pairs i < j of boxes closer than `reach`: from a box around all down to single ones, each
    # around two of the next level, which follow each other along the polygon
    tree = [(low, high)]
    while len(tree[-1][0]) > 1:
        lows, highs = tree[-1]
        if len(lows) % 2:
            lows, highs = np.vstack([lows, lows[-1:]]), np.vstack([highs, highs[-1:]])
        tree.append((np.minimum(lows[::2], lows[1::2]), np.maximum(highs[::2], highs[1::2])))
    i = j = np.zeros(1, np.int64)
    for lows, highs in tree[-2::-1]:
        i, j = np.concatenate([2 * i, 2 * i, 2 * i + 1, 2 * i + 1]), np.tile(2 * j, 4)
        j += np.repeat([0, 1, 0, 1], len(j) // 4)
        kept = (i <= j) & (j < len(lows))
        i, j = i[kept], j[kept]
        near = ((lows[i] <= highs[j] + reach) & (lows[j] <= highs[i] + reach)).all(axis=1)
        i, j = i[near], j[near]
        if len(i) > _MOST_PAIRS:
            raise MeshError(
                f"at most {_MOST_PAIRS:,} pairs of sides may lie beside each other, got "
                f"{len(i):,} and more: draw longer sides, or fewer beside each other"
            )
    different = i < j
    return i[different], j[different]


def _side(a: Floats, b: Floats, p: Floats) -> Floats:
    # twice the area of the triangles a, b, p: its sign is the side of a-b on which p lies
    (dx, dy), (x, y) = (b - a).T, (p - a).T
    turn: Floats = dx * y - dy * x
    return turn


def _cross(a: Floats, b: Floats, c: Floats, d: Floats) -> Bools:
    found: Bools = _side(a, b, c) * _side(a, b, d) < 0.0
    found &= _side(c, d, a) * _side(c, d, b) < 0.0
    return found


def _off(p: Floats, a: Floats, b: Floats) -> Floats:
    # distance of points from sides a-b
    return np.asarray(norm(off_segments(p, a, b - a)[0]))


def _gaps(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    # distances of a and b from the sides c-d, of c and d from a-b, shape (4, n)
    return np.stack([_off(a, c, d), _off(b, c, d), _off(c, a, b), _off(d, a, b)])


def _place(a: Floats, b: Floats, c: Floats, d: Floats) -> Floats:
    # where one side crosses the other, or the end that is nearest to it
    if _cross(a, b, c, d)[0]:
        share = _side(c, d, a) / (_side(c, d, a) - _side(c, d, b))
        crossing: Floats = (a + share[:, None] * (b - a))[0]
        return crossing
    nearest: Floats = (a, b, c, d)[int(_gaps(a, b, c, d)[:, 0].argmin())][0]
    return nearest
