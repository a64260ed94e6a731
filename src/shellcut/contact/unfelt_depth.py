"""Penetration that no contact feels: the tool in quads, the film's border in the tool.

Nodes feel the faces of the tool, and quads its corners and edges, at points (:mod:`.tool_points`).
A tool part that passes through a quad between these, or without them, is measured during a run and
reported.

A border or a flank whose nodes lie beside a tooth may cross it between them. That is felt by places
on the border (:mod:`.border_contact`), if these touch; depth beyond that is measured, too.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.kernel_tables import check_tables
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, sub
from shellcut.state import State
from shellcut.tool.pose import Pose, to_body
from shellcut.tool.rounded_depth import rounded_depth
from shellcut.tool.signed_distance import signed_distance
from shellcut.tool.tool import Tool

from .border_contact import BorderContact
from .contact_tables import ContactTool
from .film_outline import FilmBorderSegments, Part
from .penalty_contact import PenaltyContact
from .settings import PenaltyLaw

# Wires in a bundle; all of a bundle are skipped together.
_BUNDLE = 64

_PARTS = 16
"""Of a segment of the film's border; its depth is evaluated where these meet."""

# Fraction of half a quad below which a crossing counts as lying on its border.
_BORDER = 1e-9


class _Wires(NamedTuple):
    """Wires of a tool in its body frame, and boxes around bundles of them."""

    ends: Annotated[Floats, "(n_wire, 2, 3)"]
    """Both ends [mm]."""
    first: Annotated[Ints, "(n_bundle + 1,)"]
    """First wire of each bundle, and the end."""
    bundles: Annotated[Floats, "(n_bundle, 2, 3)"]
    """Low and high corners of the boxes around the bundles [mm]."""


class ToolWires:
    """Edges of the tool's triangles, tested for crossings with quads."""

    def __init__(self, tool: Tool) -> None:
        sides = tool.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        wires, first = np.unique(np.sort(sides, axis=1), axis=0, return_index=True)
        body = tool.triangle_body[first // 3]
        ends = tool.vertices[wires[np.argsort(body, kind="stable")]]
        first = np.append(np.arange(0, len(ends), _BUNDLE), len(ends))
        low = np.minimum.reduceat(ends.min(axis=1), first[:-1])
        high = np.maximum.reduceat(ends.max(axis=1), first[:-1])
        self._wires = _Wires(ends, first, np.stack([low, high], axis=1))
        check_tables([self._wires])

    def crossed_quads(
        self,
        x: Floats,
        quads: Ints,
        noticed: Bools,
        pose: Pose,
    ) -> tuple[Ints, Floats]:
        """Return the quads that the tool passes through, and the depths.

        Parameters
        ----------
        x : ndarray, shape (n_node, 3)
            Positions [mm].
        quads : ndarray of int, shape (n_quad, 4)
            Node ids.
        noticed : ndarray of bool, shape (n_node,)
            Nodes whose quads are left out, such as those in contact.
        pose : Pose
            Of the tool.

        Returns
        -------
        quads : ndarray of int, shape (n,)
        depth : ndarray, shape (n,)
            Distance of the nearer end of the deepest wire from the quad's plane [mm].
        """
        depth = np.zeros(quads.shape[0])
        _deepest_crossings(
            x=x, quads=quads, noticed=noticed, pose=pose, wires=self._wires, depth=depth
        )
        crossed = np.flatnonzero(depth > 0.0)
        return crossed, depth[crossed]


def missed_penetration(
    wires: ToolWires,
    state: State,
    pose: Pose,
    felt: Ints | None = None,
    rows: Ints | None = None,
) -> tuple[int, float]:
    """Return the number of quads that the tool passes through, and the largest depth [mm].

    Quads with a node in contact or with a split node are left out, and those with a node in
    ``felt``, of quads that a point of the tool presses on.  rows : those that may be, by default
    all.
    """
    n = state.node
    noticed = n.halved | (n.contact_depth > 0.0)
    if felt is not None:
        noticed[felt] = True
    searched = state.quads if rows is None else state.quads[rows]
    quads, depth = wires.crossed_quads(n.x, searched, noticed, pose)
    return quads.size, float(depth.max(initial=0.0))


class FlankPenetration:
    """Measures how deep the film's border lies in the tool unfelt.

    Parameters
    ----------
    contact : PenaltyContact
        Of the nodes.
    border : BorderContact or None
        Of the film's border, if that is switched on.
    part_of : Callable
        Returns the polygon of a row that is cut.
    """

    def __init__(
        self, contact: PenaltyContact, border: BorderContact | None, part_of: Callable[[int], Part]
    ) -> None:
        self._contact, self._border = contact, border
        self._film = contact.film_edges or FilmBorderSegments(contact.law, part_of)
        self._deepest = BoundOnce(_deepest_unfelt)

    def largest(self, state: State, pose: Pose) -> float:
        """Return by how much the border is deeper between the points that touch than is felt [mm].

        What is felt is interpolated between its ends and its places, if these touch. Sides that the
        blade passes through are left out: those with ends on both sides of it, or deeper below
        their own side than half of the tool's thickness, and closer to the other.
        """
        contact, segments = self._contact, self._film.of(state)
        rows = segments.near(contact.near.ids)
        side, depth = state.node.contact_side, state.node.contact_depth
        at = side[segments.node[rows]]
        rows, at = rows[at[:, 0] * at[:, 1] >= 0], at[at[:, 0] * at[:, 1] >= 0]
        first: Ints = np.zeros(rows.size + 1, np.int64)
        felt: Floats = np.zeros(0)
        if self._border is not None:
            first, felt = self._border.felt(segments.key[rows])
        return float(
            self._deepest(
                segments.node[rows],
                np.where(at[:, 0] != 0, at[:, 0], at[:, 1]).astype(np.int64),
                np.maximum(depth[segments.node[rows]], 0.0),
                first,
                felt,
                state.node.x,
                pose,
                contact.solid,
                contact.law,
            )
        )


@kernel
def _deepest_unfelt(
    ends: Ints,
    side: Ints,
    depth: Floats,
    first: Ints,
    felt: Floats,
    x: Floats,
    pose: Pose,
    tool: ContactTool,
    law: PenaltyLaw,
) -> float:
    """Return how much deeper than felt the deepest of some border segments is in the tool [mm].

    ends : (n, 2), nodes of all in x : (n_node, 3).  side : (n,), of the blade.  depth : (n, 2), of
    the ends [mm].  first, felt : (n + 1,), (n_place,), of the places on each segment [mm].
    """
    pose, tool, law = borrowed(pose), borrowed(tool), borrowed(law)
    surface, deepest = tool.grid.surface, 0.0
    for i in range(ends.shape[0]):
        a, b = to_body(load(x, ends[i, 0]), pose), to_body(load(x, ends[i, 1]), pose)
        m = first[i + 1] - first[i]
        for k in range(1, _PARTS):
            s = k / _PARTS
            p = combine(1.0 - s, a, s, b)
            found, inside, triangle, q, whole = signed_distance(p, side[i], tool.grid)
            if not (found and inside):
                continue
            D, _, _ = rounded_depth(p, q, triangle, side[i], law.rounding, tool.grid, tool.around)
            if side[i] * surface.flank[whole] < 0 and law.tool_half_thickness < D:
                continue
            # Places lie at (j + 1/2) / m; before the first and behind the last are the ends.
            at = s * m - 0.5
            j = int(np.floor(at))
            part = at - j
            before = felt[first[i] + j] if j >= 0 else depth[i, 0]
            behind = felt[first[i] + j + 1] if j + 1 < m else depth[i, 1]
            if j < 0:
                part = s * m / 0.5
            elif j + 1 >= m:
                part = (s * m - (m - 0.5)) / 0.5
            if m == 0:
                before, behind, part = depth[i, 0], depth[i, 1], s
            deepest = max(deepest, D - (1.0 - part) * before - part * behind)
    return deepest


@kernel
def _deepest_crossings(
    x: Floats,
    quads: Ints,
    noticed: Bools,
    pose: Pose,
    wires: _Wires,
    depth: Floats,
) -> None:
    """Write the largest depth of wires through each quad to depth : (n_quad,), where there are any.

    noticed : (n_node,), nodes whose quads are left out.
    """
    pose, wires = borrowed(pose), borrowed(wires)
    for e in range(quads.shape[0]):
        n0, n1, n2, n3 = quads[e, 0], quads[e, 1], quads[e, 2], quads[e, 3]
        if noticed[n0] or noticed[n1] or noticed[n2] or noticed[n3]:
            continue
        x0, x1 = to_body(load(x, n0), pose), to_body(load(x, n1), pose)
        x2, x3 = to_body(load(x, n2), pose), to_body(load(x, n3), pose)
        low, high = _box(x0, x1, x2, x3)
        for b in range(wires.bundles.shape[0]):
            if _apart(low, high, wires.bundles, b):
                continue
            for k in range(wires.first[b], wires.first[b + 1]):
                start = (wires.ends[k, 0, 0], wires.ends[k, 0, 1], wires.ends[k, 0, 2])
                end = (wires.ends[k, 1, 0], wires.ends[k, 1, 1], wires.ends[k, 1, 2])
                apart = False
                for c in range(3):
                    p, q = start[c], end[c]
                    apart = apart or max(p, q) < low[c] or min(p, q) > high[c]
                if apart:
                    continue
                depth[e] = max(
                    depth[e],
                    _crossing_depth(start, end, x0, x1, x2),
                    _crossing_depth(start, end, x0, x2, x3),
                )


@inline
def _box(a: Vec3, b: Vec3, c: Vec3, d: Vec3) -> tuple[Vec3, Vec3]:
    """Return the low and the high corner of the box around four points."""
    return (
        (
            min(min(a[0], b[0]), min(c[0], d[0])),
            min(min(a[1], b[1]), min(c[1], d[1])),
            min(min(a[2], b[2]), min(c[2], d[2])),
        ),
        (
            max(max(a[0], b[0]), max(c[0], d[0])),
            max(max(a[1], b[1]), max(c[1], d[1])),
            max(max(a[2], b[2]), max(c[2], d[2])),
        ),
    )


@inline
def _apart(low: Vec3, high: Vec3, boxes: Floats, b: int) -> bool:
    """Return whether a box has no point in common with box b of boxes : (n_box, 2, 3)."""
    # Branch-free, as in near_nodes.
    return bool(
        (high[0] < boxes[b, 0, 0])
        | (low[0] > boxes[b, 1, 0])
        | (high[1] < boxes[b, 0, 1])
        | (low[1] > boxes[b, 1, 1])
        | (high[2] < boxes[b, 0, 2])
        | (low[2] > boxes[b, 1, 2])
    )


@inline
def _crossing_depth(start: Vec3, end: Vec3, a: Vec3, b: Vec3, c: Vec3) -> float:
    """Return the depth of a segment through the triangle (a, b, c), 0 if it does not cross."""
    normal = cross(sub(b, a), sub(c, a))
    d0, d1 = dot(sub(start, a), normal), dot(sub(end, a), normal)
    if d0 * d1 >= 0.0:
        return 0.0
    p = combine(1.0, start, d0 / (d0 - d1), sub(end, start))
    border = _BORDER * dot(normal, normal)
    if (
        dot(cross(sub(b, a), sub(p, a)), normal) <= border
        or dot(cross(sub(c, b), sub(p, b)), normal) <= border
        or dot(cross(sub(a, c), sub(p, c)), normal) <= border
    ):
        return 0.0
    return min(abs(d0), abs(d1)) / norm(normal)
