"""Where a point is against film close to it, for kernels: how deep, and where it is pushed.

*Closest place.* The film of a row is a convex polygon of the parametric square
(:mod:`.film_outline`). The foot of the perpendicular from p on the bilinear surface is found by
Newton's method on

    r · a_1 = 0,   r · a_2 = 0,   r = p - x(xi, eta),

with the exact second derivatives. If it lies in the polygon, it is the closest place; else that
lies on an edge of the polygon, taken as a straight line between its ends. On sides of the quad that
is exact. A flank is a straight chord of the parametric square: on a quad that is no parallelogram
the two differ by a part of its twist.

*A node against a sheet.* A sheet is film of thickness h with flat cut faces, and a node stands for
film as thick as that. In the sheet's frame at the closest place c, with the distance d from the
mid-surface on the side s where the point is, and the distance e to the nearest edge inside the
sheet's outline, the depth is

    D = min(h - s d, e)   over the film,   D <= 0 beside it,

the shorter of the two distances to the outside: through the face, or through the edge. D is
continuous, so the energy k F(D) is, and forces are its gradient: through the face along r = p - c,
shared by the shape functions at c; through the edge along m, the normal of the edge in the tangent
plane, with the couple that turns m with the film (:func:`slopes_along`). Both leave momentum and
angular momentum as they are, to round-off.

Flanks that are born together lie edge to edge: e = 0, so D = 0 whatever h is. They part freely,
meet again at e = 0 in the plane, and pass over each other as soon as they are h apart. Nothing has
to grow, and nothing sticks.

*A point of the tool* is the same with h = 0, and is pushed out through the face only. It gets a
side where it faces the film, and has passed the film elsewhere (through a cut) where it is farther
from it than the capture.
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.bilinear import shape_functions, slopes_by_eta, slopes_by_xi
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.boxes import box_around
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add, add_scaled, combine, cross, dot, load, norm, scale, sub

from .contact_tables import SheetTables
from .film_outline import Outline
from .settings import NOTICED

# Newton's method converges quadratically; a foot that is not found by then lies far outside.
_MOST_STEPS = 12
_FOUND = 1e-13
_FAR_OUTSIDE = 4.0

# Of the second derivatives' determinant over that without the quad's twist: below it the twist is
# left out.
_CONVEX = 0.5

# A foot this little outside a polygon, in xi and eta, is on its edge: far above round-off.
_ON_EDGE = 1e-12

# Cosine of the largest angle between the normal of a quad and the vector to a point over it: beyond
# a closed side in the plane of the quad a point is over film that is no partner of it.
_OVER = 0.5

# Of the thickness: closer to the mid-surface the vector to a point does not give the normal.
_ON_SURFACE = 1e-3

# Cosine of the angle between the outward normal of a point and the film's, at least: a corner that
# passes the film edge-on does not push it.
_FACING = 0.3


class Corners(NamedTuple):
    """Positions of the nodes of a quad [mm]."""

    x0: Vec3
    x1: Vec3
    x2: Vec3
    x3: Vec3


class Closest(NamedTuple):
    """The place of a quad's film that is closest to a point."""

    square: float
    """Squared distance [mm²]."""
    xi: float
    """Where it is, as is eta."""
    eta: float
    beside: bool
    """Whether the film ends there: the point lies beyond its edge."""


@always_inline
def corners_of(x: Floats, quads: Ints, row: int) -> Corners:
    """Return the positions of the nodes of a row."""
    return Corners(
        load(x, quads[row, 0]),
        load(x, quads[row, 1]),
        load(x, quads[row, 2]),
        load(x, quads[row, 3]),
    )


@always_inline
def place_in(q: Corners, xi: float, eta: float) -> Vec3:
    """Return the position of a place of a quad [mm]."""
    n0, n1, n2, n3 = shape_functions(xi, eta)
    return add(combine(n0, q.x0, n1, q.x1), combine(n2, q.x2, n3, q.x3))


@always_inline
def tangents_at(q: Corners, xi: float, eta: float) -> tuple[Vec3, Vec3]:
    """Return the tangents a_1 and a_2 at a place of a quad [mm]."""
    low, high = sub(q.x1, q.x0), sub(q.x2, q.x3)
    left, right = sub(q.x3, q.x0), sub(q.x2, q.x1)
    a1 = combine(0.25 * (1.0 - eta), low, 0.25 * (1.0 + eta), high)
    a2 = combine(0.25 * (1.0 - xi), left, 0.25 * (1.0 + xi), right)
    return a1, a2


@always_inline
def normal_at(q: Corners, xi: float, eta: float) -> Vec3:
    """Return the unit normal at a place of a quad."""
    a1, a2 = tangents_at(q, xi, eta)
    n = cross(a1, a2)
    return scale(1.0 / norm(n), n)


@always_inline
def foot_on(p: Vec3, q: Corners) -> tuple[float, float, bool]:
    """Return where the foot of the perpendicular from p on a quad is, and whether there is one."""
    twist = scale(0.25, sub(add(q.x0, q.x2), add(q.x1, q.x3)))
    xi = eta = 0.0
    for _ in range(_MOST_STEPS):
        a1, a2 = tangents_at(q, xi, eta)
        r = sub(p, place_in(q, xi, eta))
        g1, g2 = dot(r, a1), dot(r, a2)
        h11, h22 = dot(a1, a1), dot(a2, a2)
        level = dot(a1, a2)
        h12 = level - dot(r, twist)
        det, flat = h11 * h22 - h12 * h12, h11 * h22 - level * level
        if not det > _CONVEX * flat:  # far from the foot in a skewed quad: Gauss-Newton
            h12, det = level, flat
        if not det > 0.0:  # it has no area, or is not finite
            return xi, eta, False
        step_xi, step_eta = (h22 * g1 - h12 * g2) / det, (h11 * g2 - h12 * g1) / det
        longest = max(abs(step_xi), abs(step_eta), 1.0)  # half a quad at most
        step_xi, step_eta = step_xi / longest, step_eta / longest
        xi += step_xi
        eta += step_eta
        if abs(xi) + abs(eta) > 2.0 * _FAR_OUTSIDE:
            return xi, eta, False
        if abs(step_xi) + abs(step_eta) < _FOUND:
            return xi, eta, True
    return xi, eta, False


@always_inline
def closest_place(p: Vec3, q: Corners, row: int, outline: Outline) -> Closest:
    """Return the place of a row's film that is closest to p."""
    n, point = outline.n_edge[row], outline.point
    xi, eta, found = foot_on(p, q)
    inside = found
    for k in range(n):
        end = (k + 1) % n
        x0, y0 = point[row, k, 0], point[row, k, 1]
        dx, dy = point[row, end, 0] - x0, point[row, end, 1] - y0
        inside = inside and dx * (eta - y0) - dy * (xi - x0) >= -_ON_EDGE
    if inside:
        r = sub(p, place_in(q, xi, eta))
        return Closest(dot(r, r), xi, eta, False)
    best = Closest(1e300, 0.0, 0.0, True)
    for k in range(n):
        s, square, xi, eta = closest_on_edge(p, q, row, k, outline)
        if square < best.square:
            beside = outline.open[row, k]
            if s <= 0.0:
                beside = outline.open_at[row, k]
            elif s >= 1.0:
                beside = outline.open_at[row, (k + 1) % n]
            best = Closest(square, xi, eta, beside)
    return best


@always_inline
def closest_on_edge(
    p: Vec3, q: Corners, row: int, k: int, outline: Outline
) -> tuple[float, float, float, float]:
    """Return the place of an edge closest to p: part of its length, distance² [mm²], xi, eta."""
    point, end = outline.point, (k + 1) % outline.n_edge[row]
    x0, y0, x1, y1 = point[row, k, 0], point[row, k, 1], point[row, end, 0], point[row, end, 1]
    start = place_in(q, x0, y0)
    along, r = sub(place_in(q, x1, y1), start), sub(p, start)
    s = min(max(dot(r, along) / dot(along, along), 0.0), 1.0)
    off = add_scaled(r, -s, along)
    return s, dot(off, off), x0 + s * (x1 - x0), y0 + s * (y1 - y0)


class Nearest(NamedTuple):
    """The place of a sheet that is closest to a point."""

    pair: int
    """Of the point and the quad it is in, -1 if no quad of the sheet is near."""
    place: Closest
    free: float
    """Distance that point and other quads may move together before one of these is near [mm]."""


class Exit(NamedTuple):
    """Where and in which direction a point is pushed out of a sheet."""

    depth: float
    """D [mm], at most 0 outside."""
    row: int
    """Quad that gets the force."""
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
def nearest_on(p: Vec3, sheet: int, band: float, walked: float, tables: SheetTables) -> Nearest:
    """Return the place of a sheet closest to p, of its quads whose box is nearer than ``band``.

    Writes the travelled distance up to which a pair is not near, for pairs farther apart.
    """
    pairs, x, quads, until = tables.pairs, tables.nodes.x, tables.quads, tables.waits.pair
    best, free = Closest(1e300, 0.0, 0.0, True), 1e300
    found = -1
    for j in range(pairs.first_pair[sheet], pairs.first_pair[sheet + 1]):
        if walked < until[j]:
            free = min(free, until[j] - walked)
            continue
        row = pairs.row[j]
        q = corners_of(x, quads, row)
        off = off_box(p, q) - band
        if off > 0.0:
            until[j] = walked + off
            free = min(free, off)
            continue
        place = closest_place(p, q, row, tables.outline)
        if place.square < best.square:
            best, found = place, j
    return Nearest(found, best, free)


@always_inline
def off_box(p: Vec3, q: Corners) -> float:
    """Return the distance of p from the box around a quad [mm]."""
    square = 0.0
    low, high = box_around(q.x0, q.x1, q.x2, q.x3)
    for c in range(3):
        off = max(max(low[c] - p[c], p[c] - high[c]), 0.0)
        square += off * off
    return sqrt(square)


@always_inline
def exit_from(
    p: Vec3, outward: Vec3, sheet: int, near: Nearest, tables: SheetTables
) -> tuple[Exit, float]:
    """Return the exit from a sheet, and how far the point may move before it is within [mm].

    outward : normal of the tool at one of its points, of a node not used.
    """
    law, side = tables.law, int(tables.memory.side[sheet]) + 0
    place, thickness = near.place, law.thickness
    row = int(tables.pairs.row[near.pair])
    q = corners_of(tables.nodes.x, tables.quads, row)
    n = normal_at(q, place.xi, place.eta)
    r = sub(p, place_in(q, place.xi, place.eta))
    distance, above = norm(r), dot(r, n)
    now = 1 if above > 0.0 else -1
    if tables.of_tool and side == 0 and abs(above) <= NOTICED * law.smoothing_depth:
        # A point in the film's plane, to round-off, comes from the side that it does not face.
        now = 1 if dot(outward, n) < 0.0 else -1
    none = Exit(0.0, row, place.xi, place.eta, n, 0.0, 0)
    if place.beside:
        within = sqrt(max(distance * distance - above * above, 0.0))
        over = max(abs(above) - thickness, 0.0)
        if over > 0.0 and not tables.of_tool:
            none = Exit(0.0, row, place.xi, place.eta, n, 0.0, now)
        return none, sqrt(within * within + over * over)
    on_surface = distance <= _ON_SURFACE * thickness  # r has no reliable direction there
    if abs(above) < _OVER * distance and not on_surface:  # beyond a closed side of the quad
        return none, max(distance - thickness, 0.0)
    if tables.of_tool:
        if distance > law.capture:
            return none, distance - law.capture
        if side == 0 and now * dot(outward, n) > -_FACING:
            return none, min(distance, law.undecided)
    if distance >= thickness and side * now >= 0:
        return Exit(0.0, row, place.xi, place.eta, n, 0.0, now), distance - thickness
    # A known side counts also past the mid-surface: a point comes out on the side where it entered.
    known = side if side != 0 else now
    through_face = thickness - known * now * distance
    if not tables.of_tool:
        border = _exit_through_border(p, sheet, through_face, tables)
        if border.depth < through_face:
            # It came in through the border unless its side is known.
            return Exit(*border[:6], side), 0.0
    push = scale(float(known), n)
    if not on_surface:
        push = scale(known * now / distance, r)
    return Exit(through_face, row, place.xi, place.eta, push, 0.0, known), 0.0


@inline
def _exit_through_border(p: Vec3, sheet: int, most: float, tables: SheetTables) -> Exit:
    """Return the exit through the nearest open edge of a sheet, if nearer than ``most`` [mm]."""
    tables = borrowed(tables)
    pairs, outline = tables.pairs, tables.outline
    best = Exit(most, 0, 0.0, 0.0, (0.0, 0.0, 0.0), 0.0, 0)
    for j in range(pairs.first_pair[sheet], pairs.first_pair[sheet + 1]):
        row = pairs.row[j]
        for k in range(outline.n_edge[row]):
            if not outline.open[row, k]:
                continue
            q = corners_of(tables.nodes.x, tables.quads, row)
            _, _, xi, eta = closest_on_edge(p, q, row, k, outline)
            n = normal_at(q, xi, eta)
            r = sub(p, place_in(q, xi, eta))
            above = dot(r, n)
            in_plane = add_scaled(r, -above, n)
            depth = norm(in_plane)
            if depth < best.depth:
                # On the edge itself there is no direction, hence no force.
                push = scale(-1.0 / depth, in_plane) if depth > 0.0 else (0.0, 0.0, 0.0)
                best = Exit(depth, row, xi, eta, push, above, 0)
    return best


@inline
def slopes_along(m: Vec3, xi: float, eta: float, q: Corners) -> tuple[float, float, float, float]:
    """Return the slopes of the shape functions along m, over its length [1/mm].

    They are linear in m; its part across the quad does not count.

    A force F along m on a point at the distance d above the tangent plane has the moment d F (n x
    m) about the closest place. Forces F d N_b,m n at the nodes take it up, N_b,m being the slopes
    along m: their sum is zero, and sum N_b,m x_b = m. They are the part of the gradient of the
    depth due to the turning of the tangent plane.
    """
    a1, a2 = tangents_at(q, xi, eta)
    g11, g12, g22 = dot(a1, a1), dot(a1, a2), dot(a2, a2)
    b1, b2 = dot(m, a1), dot(m, a2)
    det = g11 * g22 - g12 * g12
    m1, m2 = (g22 * b1 - g12 * b2) / det, (g11 * b2 - g12 * b1) / det
    (s0, s1, s2, s3), (r0, r1, r2, r3) = slopes_by_xi(eta), slopes_by_eta(xi)
    return s0 * m1 + r0 * m2, s1 * m1 + r1 * m2, s2 * m1 + r2 * m2, s3 * m1 + r3 * m2
