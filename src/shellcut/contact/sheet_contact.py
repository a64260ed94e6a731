"""Contact of a point with a sheet close to it, for kernels: how deep, and which way out.

A *sheet* is film of thickness h with flat cut edges, and the point stands for film as thick as
that. In the sheet's frame at the closest place c, with the distance d from the mid-surface on the
side s where the point is, and the distance e to the nearest edge inside the sheet's outline, the
depth is

    D = min(h - s d, e)   over the film,   D <= 0 beside it,

the shorter of the two ways out: through the face, or through the edge. D is continuous, so the
energy k F(D) is, and forces are its gradient: through the face along r = p - c, shared by the shape
functions at c; through the edge along m, the normal of the edge in the tangent plane, with the
couple that turns m with the film (:func:`slopes_along`). Both leave momentum and angular momentum
as they are, to round-off.

Flanks that are born together lie edge to edge: e = 0, so D = 0 whatever h is. They part freely,
meet again at e = 0 in the plane, and pass over each other as soon as they are h apart. Nothing has
to grow, and nothing sticks.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add_scaled, dot, scale, sub

from .close_pairs import Pairs
from .film_outline import Outline
from .quad_distance import (
    Closest,
    Corners,
    closest_on_edge,
    closest_place,
    corners_of,
    normal_at,
    place_in,
    tangents_at,
)

# Cosine of the largest angle between the normal of a quad and the way to a point over it: beyond a
# closed side in the plane of the quad a point is over film that is no partner of it.
_OVER = 0.5

# Of the thickness: closer to the mid-surface the way to a point does not tell the normal.
_ON_SURFACE = 1e-3


class Nearest(NamedTuple):
    """The place of a sheet that is closest to a point."""

    row: int
    """-1 if no quad of the sheet is near."""
    place: Closest
    free: float
    """Way that the point and the other quads may go before one of these is near [mm]."""


class Way(NamedTuple):
    """The way out of a sheet."""

    depth: float
    """D [mm], at most 0 outside."""
    row: int
    """Quad that takes the force."""
    xi: float
    eta: float
    """Where."""
    direction: Vec3
    """Unit vector that the point is pushed along."""
    lifted: float
    """Distance of the point from the tangent plane, for the couple of an edge; 0 at a face [mm]."""
    side: int
    """Of the sheet that the point is on."""


@always_inline
def nearest_on(
    p: Vec3,
    sheet: int,
    band: float,
    walked: float,
    until: Floats,
    x: Floats,
    quads: Ints,
    pairs: Pairs,
    outline: Outline,
) -> Nearest:
    """Return the place of a sheet closest to p, of its quads whose box is nearer than ``band``.

    until : (n_pair,), the way walked up to which a pair is not near, written for those farther off.
    """
    best, free = Closest(1e300, 0.0, 0.0, True), 1e300
    found = -1
    for j in range(pairs.first_pair[sheet], pairs.first_pair[sheet + 1]):
        if walked < until[j]:
            free = min(free, until[j] - walked)
            continue
        row = pairs.row[j]
        q = corners_of(x, quads, row)
        off = _off_box(p, q) - band
        if off > 0.0:
            until[j] = walked + off
            free = min(free, off)
            continue
        place = closest_place(p, q, row, outline)
        if place.square < best.square:
            best, found = place, row
    return Nearest(found, best, free)


@always_inline
def _off_box(p: Vec3, q: Corners) -> float:
    """Return the distance of p from the box around a quad [mm]."""
    square = 0.0
    for c in range(3):
        low = min(min(q.x0[c], q.x1[c]), min(q.x2[c], q.x3[c]))
        high = max(max(q.x0[c], q.x1[c]), max(q.x2[c], q.x3[c]))
        off = max(max(low - p[c], p[c] - high), 0.0)
        square += off * off
    return sqrt(square)


@always_inline
def way_out(
    p: Vec3,
    sheet: int,
    side: int,
    thickness: float,
    near: Nearest,
    x: Floats,
    quads: Ints,
    pairs: Pairs,
    outline: Outline,
) -> tuple[Way, float]:
    """Return the way out of a sheet, and how far the point may go before it is within [mm]."""
    row, place = near.row, near.place
    q = corners_of(x, quads, row)
    n = normal_at(q, place.xi, place.eta)
    r = sub(p, place_in(q, place.xi, place.eta))
    distance, above = sqrt(dot(r, r)), dot(r, n)
    none = Way(0.0, row, place.xi, place.eta, n, 0.0, 0)
    if place.beside:
        within = sqrt(max(distance * distance - above * above, 0.0))
        over = max(abs(above) - thickness, 0.0)
        if over > 0.0:
            none = Way(0.0, row, place.xi, place.eta, n, 0.0, 1 if above > 0.0 else -1)
        return none, sqrt(within * within + over * over)
    on_surface = distance <= _ON_SURFACE * thickness  # where the way to the point tells nothing
    if abs(above) < _OVER * distance and not on_surface:  # beyond a closed side
        return none, max(distance - thickness, 0.0)
    now = 1 if above > 0.0 else -1
    if distance >= thickness and side * now >= 0:
        return Way(0.0, row, place.xi, place.eta, n, 0.0, now), distance - thickness
    known = side if side != 0 else now
    through_face = thickness - known * now * distance
    edge = _way_to_edge(p, sheet, through_face, x, quads, pairs, outline)
    if edge.depth < through_face:
        # It came through the edge unless its side is known.
        return Way(*edge[:6], side), 0.0
    out = scale(float(known), n)
    if not on_surface:
        out = scale(known * now / distance, r)
    return Way(through_face, row, place.xi, place.eta, out, 0.0, known), 0.0


@inline
def _way_to_edge(
    p: Vec3, sheet: int, most: float, x: Floats, quads: Ints, pairs: Pairs, outline: Outline
) -> Way:
    """Return the way to the nearest open edge of a sheet, if it is shorter than ``most``."""
    pairs, outline = borrowed(pairs), borrowed(outline)
    x, quads = borrowed(x), borrowed(quads)
    best = Way(most, 0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.0, 0)
    for j in range(pairs.first_pair[sheet], pairs.first_pair[sheet + 1]):
        row = pairs.row[j]
        for k in range(outline.n_edge[row]):
            if not outline.open[row, k]:
                continue
            q = corners_of(x, quads, row)
            _, _, xi, eta = closest_on_edge(p, q, row, k, outline)
            n = normal_at(q, xi, eta)
            r = sub(p, place_in(q, xi, eta))
            above = dot(r, n)
            in_plane = add_scaled(r, -above, n)
            depth = sqrt(dot(in_plane, in_plane))
            if depth < best.depth:
                # On the edge itself there is no direction, and no force.
                out = scale(-1.0 / depth, in_plane) if depth > 0.0 else (0.0, 0.0, 0.0)
                best = Way(depth, row, xi, eta, out, above, 0)
    return best


@inline
def slopes_along(m: Vec3, xi: float, eta: float, q: Corners) -> tuple[float, float, float, float]:
    """Return the slopes of the shape functions along m, over its length [1/mm].

    They are linear in m; its part across the quad does not count.

    A force F along m on a point at the distance d above the tangent plane has the moment d F (n x
    m) about the closest place. Forces F d N_b,m n at the nodes take it up, N_b,m being the slopes
    along m: their sum is zero, and sum N_b,m x_b = m. They are the part of the gradient of the
    depth that comes from the turning of the tangent plane.
    """
    a1, a2 = tangents_at(q, xi, eta)
    g11, g12, g22 = dot(a1, a1), dot(a1, a2), dot(a2, a2)
    b1, b2 = dot(m, a1), dot(m, a2)
    det = g11 * g22 - g12 * g12
    m1, m2 = (g22 * b1 - g12 * b2) / det, (g11 * b2 - g12 * b1) / det
    return (
        0.25 * (-(1.0 - eta) * m1 - (1.0 - xi) * m2),
        0.25 * ((1.0 - eta) * m1 - (1.0 + xi) * m2),
        0.25 * ((1.0 + eta) * m1 + (1.0 + xi) * m2),
        0.25 * (-(1.0 + eta) * m1 + (1.0 - xi) * m2),
    )
