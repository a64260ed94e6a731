"""Repair surfaces from other programs where the repair is unambiguous.

Coinciding vertices are merged; degenerate and repeated triangles are removed; the triangles of a
connected part are oriented consistently, with normals outwards. Holes are left: only the user knows
what belongs there.

Faces of a CAD surface are triangulated apart. Neighbours follow their common edge within the file's
tolerance, but may put vertices on it at different places. Each vertex on one side is put into the
edge of the other side as well: no vertex moves, and thin gaps close. Wider ones stay for the checks
of the tool.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints, norm, product
from shellcut.formats.errors import counted, point_text
from shellcut.numerics.consistent_winding import common_winding

from .surface import DEGENERATE_HEIGHT, Surface, merge_vertices, normals_and_heights

_MOST_ROUNDS = 6  # a triangle with several open edges needs a round for each; then few are left
_MOST_SWAPS = 50  # rounds of swaps; each leaves fewer flat triangles, more rounds mean a tangle


@dataclass
class Repaired:
    """A repaired surface and notes on the repairs."""

    vertices: Floats
    triangles: Ints
    notes: list[str] = field(default_factory=list)
    problems: list[str] = field(default_factory=list)
    """Why it cannot be repaired."""


def repaired(vertices: Floats, triangles: Ints, *, tolerance: float | None = None) -> Repaired:
    """Return the repaired surface.

    Vertices nearer than the tolerance [mm] become one; by default it is the round-off of single
    precision.

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> inside_out = np.array([[0, 1, 2], [0, 3, 1], [0, 2, 3], [1, 3, 2]])
    >>> done = repaired(corners, inside_out)
    >>> done.notes, done.triangles[0].tolist()
    (['1 of 1 bodies was inside out and is turned'], [2, 1, 0])
    """
    merged, ids, _ = merge_vertices(vertices, triangles, None, tolerance)
    done = Repaired(merged, ids)
    _remove_flat(done)
    _remove_repeated(done)
    if len(done.triangles):
        _turn(done)
    return done


def _remove_flat(done: Repaired) -> None:
    # A triangle with two coinciding corners is removed: its neighbours meet there. One with a
    # corner on its longest side is swapped with the neighbour there, so that both get an area.
    n = len(done.triangles)
    collapsed = (done.triangles == np.roll(done.triangles, 1, axis=1)).any(axis=1)
    done.triangles = done.triangles[~collapsed]
    for _ in range(_MOST_SWAPS):
        _, height = normals_and_heights(done.vertices, done.triangles)
        flat = height < DEGENERATE_HEIGHT
        if not flat.any() or not _swap(done, flat):
            break
    if n_removed := n - len(done.triangles):
        done.notes.append(f"{n_removed} triangles without an area are removed")


def _swap(done: Repaired, flat: Bools) -> bool:
    # the flat triangle (a, b, c) with c on the side a b, and its neighbour (b, a, d) across that
    # side, become (b, c, d) and (c, a, d) when the neighbour has an area; of two flat triangles
    # that are neighbours across their longest sides one is removed
    rows: list[list[int]] = done.triangles.tolist()
    beside: dict[tuple[int, int], int] = {}
    for t, (i, j, k) in enumerate(rows):
        beside |= {(i, j): t, (j, k): t, (k, i): t}
    touched: set[int] = set()
    removed: set[int] = set()
    for t in np.flatnonzero(flat).tolist():
        points = done.vertices[rows[t]]
        longest = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1).argmax()
        a, b, c = np.roll(rows[t], -longest).tolist()  # the longest side first
        other = beside.get((b, a))
        if other is None or {t, other} & touched:
            continue
        d = next(v for v in rows[other] if v not in (a, b)) if other != t else c
        touched |= {t, other}
        if d == c:  # two copies of one flat triangle, back to back
            removed |= {t, other}
            continue
        rows[t], rows[other] = [b, c, d], [c, a, d]
        # the other neighbours are found again in the next round
        touched |= {beside[side] for side in ((c, b), (a, c)) if side in beside}
    kept = [row for t, row in enumerate(rows) if t not in removed]
    done.triangles = np.array(kept, dtype=np.int64).reshape(-1, 3)
    return bool(touched)


def _remove_repeated(done: Repaired) -> None:
    # the same three corners in the same sense; in opposite senses they are a fin, reported later
    first = np.argmin(done.triangles, axis=1)
    order = (first[:, None] + np.arange(3)) % 3
    turned = np.take_along_axis(done.triangles, order, axis=1)
    _, kept = np.unique(turned, axis=0, return_index=True)
    if n_removed := len(turned) - len(kept):
        done.triangles = done.triangles[np.sort(kept)]
        done.notes.append(f"{n_removed} repeated triangles are removed")


def _turn(done: Repaired) -> None:
    winding = common_winding(done.triangles, len(done.vertices))
    if len(winding.one_sided):
        at = done.vertices[done.triangles[winding.one_sided]].mean(axis=(0, 1))
        done.problems.append(
            f"{counted(len(winding.one_sided), 'triangle')} around {point_text(at)} form a "
            "surface with one side only, like a Möbius strip: it has no inside"
        )
        return
    done.triangles[winding.turned] = done.triangles[winding.turned][:, ::-1]
    if n := int(winding.turned.sum()):
        done.notes.append(f"{n} triangles were oriented against their neighbours and are turned")
    surface = Surface(done.vertices, done.triangles)
    open_bodies = np.unique(surface.body[surface.forward[surface.uses != 2]])
    inverted = surface.body_volumes() < 0.0
    inverted[open_bodies] = False  # the volume of an open surface is meaningless
    if n := int(inverted.sum()):
        back = inverted[surface.body]
        done.triangles[back] = done.triangles[back][:, ::-1]
        were = "was inside out and is" if n == 1 else "were inside out and are"
        done.notes.append(f"{n} of {len(inverted)} bodies {were} turned")


def closed_seams(
    vertices: Floats, triangles: Ints, *, merge: float, reach: float
) -> tuple[Floats, Ints]:
    """Return the surface with vertices of either side in both sides of each seam.

    Vertices closer than ``merge`` become one, those farther than ``reach`` from an edge are not put
    into it [mm].
    """
    vertices, triangles, _ = merge_vertices(vertices, triangles, None, merge)
    collapsed = (triangles == np.roll(triangles, 1, axis=1)).any(axis=1)
    triangles = triangles[~collapsed]
    for _ in range(_MOST_ROUNDS):
        n_before = len(triangles)
        triangles = _round(vertices, triangles, reach)
        if len(triangles) == n_before:
            break
    return vertices, triangles


def _round(vertices: Floats, triangles: Ints, reach: float) -> Ints:
    sides = np.concatenate([triangles[:, [k, (k + 1) % 3]] for k in range(3)])
    key = product(np.sort(sides, axis=1), np.array([len(vertices), 1]))
    _, first, uses = np.unique(key, return_index=True, return_counts=True)
    alone = first[uses == 1]
    if not len(alone):
        return triangles
    border = np.unique(sides[alone])
    tree = scipy.spatial.cKDTree(vertices[border])
    fans: dict[int, list[list[int]]] = {}
    for side in alone.tolist():
        t, corner = side % len(triangles), side // len(triangles)
        if t in fans:
            continue
        a, b, c = np.roll(triangles[t], -corner).tolist()
        half = 0.5 * float(norm(vertices[b] - vertices[a]))
        near = tree.query_ball_point(0.5 * (vertices[a] + vertices[b]), half + reach)
        between = _between(vertices, a, b, [int(v) for v in border[near] if v != c], reach)
        if between:
            row = [a, *between, b]
            fans[t] = [[p, q, c] for p, q in pairwise(row)]
    kept = np.ones(len(triangles), dtype=bool)
    kept[list(fans)] = False
    new = np.array([row for rows in fans.values() for row in rows], dtype=np.int64)
    return np.concatenate([triangles[kept], new.reshape(-1, 3)])


def _between(vertices: Floats, a: int, b: int, candidates: list[int], reach: float) -> list[int]:
    # the candidates beside the inside of an edge a-b, in order along it
    start, along = vertices[a], vertices[b] - vertices[a]
    others = np.array([v for v in candidates if v not in (a, b)], dtype=np.int64)
    if not len(others):
        return []
    away = vertices[others] - start
    share = product(away, along) / (product(along, along))
    off = np.linalg.norm(away - share[:, None] * along, axis=1)
    fits = (share > 0.0) & (share < 1.0) & (off <= reach)
    return [int(v) for v in others[fits][np.argsort(share[fits], kind="stable")]]
