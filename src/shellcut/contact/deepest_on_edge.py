"""How much deeper than its chord an edge of the film goes into the tool, for kernels.

Let D be the depth below the tool's rounded surface (:mod:`shellcut.tool.rounded_depth`), and p(s)
the places of an edge of the film between its ends a and b. The ends are points of the film that
feel their own depth. What they do not feel is

    g = max over s of  D(p(s)) - (1 - s) D_a - s D_b,     D_a = max(D(a), 0),  D_b likewise:

nothing on a flat face, however deep; all of D where only the middle is in the tool. Around a convex
edge of the tool D is concave along p (it is r minus the distance from a convex set), so the largest
value is where the slope -n · (b - a), n being the way out, equals D_b - D_a. It is found from a
place in the tool near that edge by bisection and secants. Deeper than r the slope may jump there;
then n is the mean of the ways out on both sides whose slope is right: the gradient of g in either
case, with s held.
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add_scaled, combine, dot, norm, sub
from shellcut.tool.rounded_depth import rounded_depth
from shellcut.tool.signed_distance import signed_distance

from .edge_tables import EdgeTables

_MOST_STEPS = 60

# Of the edge's length: slopes below it, and brackets shorter than it, are the end of the search.
_FLAT, _CLOSE = 1e-10, 1e-9


class Place(NamedTuple):
    """A place in the tool."""

    inside: bool
    """Whether it is, with a depth that presses; the rest holds only then."""
    depth: float
    """D [mm]."""
    out: Vec3
    """Unit vector out, in the body frame."""


class Deepest(NamedTuple):
    """Where an edge of the film is deepest, compared with its chord."""

    depth: float
    """g [mm], 0 if it is no deeper anywhere."""
    s: float
    """Where, from 0 at a to 1 at b."""
    on_a: Vec3
    """Slope of g with a, minus its sign: the force on a is k f(g) times this."""
    on_b: Vec3
    out: Vec3
    """Way out there, in the body frame; a unit vector, shorter where the slope jumps."""
    more: float
    """Part of the force there that does not come from the ends: k f(g) times this is what the edge
    adds to the pressures of all."""


@inline
def pressing_nowhere(s: float) -> Deepest:
    """Return that of an edge that is nowhere deeper than its chord."""
    return Deepest(0.0, s, (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), (0.0, 0.0, 0.0), 0.0)


@inline
def place_at(p: Vec3, side: int, tables: EdgeTables) -> Place:
    """Return how deep a point of the body frame is below the rounded surface of a side."""
    tables = borrowed(tables)
    found, inside, triangle, q, _, _ = signed_distance(p, side, tables.grid)
    if not (found and inside):
        return Place(False, 0.0, p)
    radius = tables.law.rounding
    depth, out = rounded_depth(p, q, triangle, side, radius, tables.grid, tables.around)
    return Place(depth > 0.0, depth, out)


@always_inline
def closest_along(a: Vec3, u: Vec3, c: Vec3, w: Vec3) -> tuple[float, float]:
    """Return where on a + s u, s in [0, 1], it is closest to c + t w, and how far [mm]."""
    r = sub(a, c)
    uu, ww, uw, ur, wr = dot(u, u), dot(w, w), dot(u, w), dot(u, r), dot(w, r)
    whole = uu * ww - uw * uw
    s = 0.5
    if whole > 1e-12 * uu * ww:
        s = min(max((uw * wr - ww * ur) / whole, 0.0), 1.0)
    t = min(max((wr + s * uw) / ww, 0.0), 1.0)
    s = min(max((t * uw - ur) / uu, 0.0), 1.0)
    t = min(max((wr + s * uw) / ww, 0.0), 1.0)
    return s, norm(sub(add_scaled(r, s, u), (t * w[0], t * w[1], t * w[2])))


@inline
def deepest_on(
    a: Vec3, u: Vec3, at: float, end_a: Place, end_b: Place, side: int, tables: EdgeTables
) -> Deepest:
    """Return the deepest place of an edge a + s u around one of its places in the tool.

    at : that place, between 0 and 1.  end_a, end_b : the ends.
    """
    tables = borrowed(tables)
    length = norm(u)
    none = pressing_nowhere(at)
    here = place_at(add_scaled(a, at, u), side, tables)
    if not here.inside:
        return none
    deep_a, deep_b = end_a.depth, end_b.depth
    rise = deep_b - deep_a
    slope = -dot(here.out, u) - rise
    # The largest value lies between lo and hi; what is known of both of them: depth, slope, way.
    lo, hi, s = 0.0, 1.0, at
    at_lo, at_hi = end_a, end_b
    slope_lo = -dot(end_a.out, u) - rise if end_a.inside else 0.0
    slope_hi = -dot(end_b.out, u) - rise if end_b.inside else 0.0
    kept = 0
    for _ in range(_MOST_STEPS):
        if here.inside and abs(slope) <= _FLAT * length:
            lo = hi = s
            at_lo = at_hi = here
            break
        if here.inside and slope > 0.0:
            lo, at_lo, slope_lo = s, here, slope
            if kept > 0:
                slope_hi *= 0.5  # Illinois: an end that stays counts half
            kept = 1
        elif here.inside:
            hi, at_hi, slope_hi = s, here, slope
            if kept < 0:
                slope_lo *= 0.5
            kept = -1
        elif s > at:
            hi, at_hi = s, here
        else:
            lo, at_lo = s, here
        if hi - lo <= _CLOSE:
            break
        s = 0.5 * (lo + hi)
        if at_lo.inside and at_hi.inside and slope_lo > 0.0 > slope_hi:
            s = lo + (hi - lo) * slope_lo / (slope_lo - slope_hi)
        here = place_at(add_scaled(a, s, u), side, tables)
        slope = -dot(here.out, u) - rise
    best, other = at_lo, at_hi
    s = lo
    if not best.inside or (other.inside and other.depth - rise * hi > best.depth - rise * lo):
        best, other, s = at_hi, at_lo, hi
    out = best.out
    if other.inside and hi > lo:
        one, two = -dot(best.out, u) - rise, -dot(other.out, u) - rise
        if one * two < 0.0:
            out = combine(two / (two - one), best.out, -one / (two - one), other.out)
    g = best.depth - (1.0 - s) * deep_a - s * deep_b
    if g <= 0.0 or not best.inside:
        return none
    on_a, on_b = (1.0 - s, s)
    from_a, from_b = on_a if end_a.inside else 0.0, on_b if end_b.inside else 0.0
    of_a = combine(on_a, out, -from_a, end_a.out)
    of_b = combine(on_b, out, -from_b, end_b.out)
    return Deepest(g, s, of_a, of_b, out, norm(out) - from_a - from_b)
