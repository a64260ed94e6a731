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
from shellcut.numerics.boxes import are_near, around_runs, box_around
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

# Weight of a corner of half a quad below which a crossing counts as lying on its border.
_BORDER = 1e-9


class _Wires(NamedTuple):
    """Wires of a tool in its body frame, and boxes around bundles of them."""

    ends: Annotated[Floats, "(n_wire, 2, 3)"]
    """Both ends [mm]."""
    first: Annotated[Ints, "(n_bundle + 1,)"]
    """First wire of each bundle, and the end."""
    low: Annotated[Floats, "(n_bundle, 3)"]
    """Corners of the boxes around the bundles [mm]."""
    high: Annotated[Floats, "(n_bundle, 3)"]


class ToolWires:
    """Edges of the tool's triangles, tested for crossings with quads."""

    def __init__(self, tool: Tool) -> None:
        sides = tool.triangles[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        wires, first = np.unique(np.sort(sides, axis=1), axis=0, return_index=True)
        body = tool.triangle_body[first // 3]
        ends = tool.vertices[wires[np.argsort(body, kind="stable")]]
        first = np.append(np.arange(0, len(ends), _BUNDLE), len(ends))
        self._wires = _Wires(ends, first, *around_runs(ends, first))
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
        rows = contact.near.within(0.0, segments.node, state, pose)
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
            D, _, _ = rounded_depth(p, q, triangle, side[i], law.rounding, tool.grid)
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
        low, high = box_around(x0, x1, x2, x3)
        for b in range(wires.low.shape[0]):
            if not are_near(low, high, load(wires.low, b), load(wires.high, b), 0.0):
                continue
            for k in range(wires.first[b], wires.first[b + 1]):
                start = (wires.ends[k, 0, 0], wires.ends[k, 0, 1], wires.ends[k, 0, 2])
                end = (wires.ends[k, 1, 0], wires.ends[k, 1, 1], wires.ends[k, 1, 2])
                least, most = box_around(start, end, start, end)
                if not are_near(low, high, least, most, 0.0):
                    continue
                for third, fourth in ((x1, x2), (x2, x3)):
                    through, _, w_b, w_c = crossing(start, end, x0, third, fourth)
                    if min(w_b, w_c, 1.0 - w_b - w_c) > _BORDER:
                        depth[e] = max(depth[e], through)


@inline
def crossing(
    start: Vec3, end: Vec3, a: Vec3, b: Vec3, c: Vec3
) -> tuple[float, float, float, float]:
    """Return where a segment crosses the plane of a triangle, by the weights of b and c there.

    Before these the distance of its nearer end from the plane [mm] and the sine of its angle with
    the plane; zeros, and weights of -1, if both ends are on one side of it.
    """
    normal, vector = cross(sub(b, a), sub(c, a)), sub(end, start)
    d0, d1 = dot(sub(start, a), normal), dot(sub(end, a), normal)
    if d0 * d1 >= 0.0:
        return 0.0, 0.0, -1.0, -1.0
    p = combine(1.0, start, d0 / (d0 - d1), vector)
    area = dot(normal, normal)
    w_b = dot(cross(sub(a, c), sub(p, c)), normal) / area
    w_c = dot(cross(sub(b, a), sub(p, a)), normal) / area
    sine = abs(d0 - d1) / (norm(normal) * norm(vector))
    return min(abs(d0), abs(d1)) / norm(normal), sine, w_b, w_c
