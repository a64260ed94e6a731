"""How much deeper than its chord an edge of the film goes into the tool, for kernels.

Let D be the depth below the tool's rounded surface (:mod:`shellcut.tool.rounded_depth`), and p(s)
the places of an edge of the film between its ends a and b. The ends are points of the film that
feel their own depth. What they do not feel is

    g = max over s of  D(p(s)) - (1 - s) D_a - s D_b,     D_a = max(D(a), 0),  D_b likewise:

nothing on a flat face, however deep; all of D where only the middle is in the tool. Around a convex
edge of the tool D is concave along p (it is r minus the distance from a convex set), so the largest
value is where the slope -n · (b - a), n being the way out, equals D_b - D_a. It is found from a
place in the tool near that edge by tangents and secants.

What the edge presses with follows in the same way from the energy Phi = ∫f of a place over that of
its ends,

    max over s of  Phi(D(p(s))) - (1 - s) Phi(D_a) - s Phi(D_b),

whose slope along s is - f(D) n · (b - a) - (Phi(D_b) - Phi(D_a)). It is found uphill from the
deepest place. Deeper than r the slope may jump there; then n is the mean of the ways out on both
sides whose slope is right: the gradient in either case, with s held.
"""

from __future__ import annotations

from typing import NamedTuple

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import combine, dot, norm

from .captured_edges import place_on
from .edge_tables import EdgeTables
from .settings import smoothed, smoothed_integral
from .tool_wedge import Beside, Deepest, Place, Wedge, place_in_wedge

_MOST_STEPS = 60

# Of the edge's length, and for a slope of the depth at which the force has set in: slopes below it,
# and brackets shorter than it, are the end of the search.
FLAT, _CLOSE = 1e-8, 1e-9

# Likewise, where only the depth and a place to begin are wanted: an error of 1e-3 in the slope is
# one of 1e-6 in the depth over the radius of the round.
LEVEL, _NEAR = 1e-3, 1e-5

# Of the rounding radius: the first step uphill; the next are twice as long each.
FIRST_STEP = 0.1

# Of the edge's length: closer to an end the end feels it all.
_AT_END = 1e-6


class Press(NamedTuple):
    """What an edge of the film presses with, over its stiffness k."""

    stored: float
    """Energy [mm²], 0 if it does not press."""
    s: float
    """Where, from 0 at a to 1 at b."""
    depth: float
    """D there [mm]."""
    out: Vec3
    """Way out there, in the body frame; a unit vector, shorter where the slope jumps."""
    pressure: float
    """f(D) there [mm]."""
    from_a: float
    """What it takes from the pressure of a, (1 - s) f(D_a) [mm]."""
    from_b: float
    """What it takes from that of b, s f(D_b) [mm]."""


@inline
def no_press(found: Deepest) -> Press:
    """Return that of an edge that does not press."""
    return Press(0.0, found.s, 0.0, found.here.out, 0.0, 0.0, 0.0)


@inline
def hill_around(
    at: float,
    so_far: Deepest,
    beside: Beside,
    held: EdgeTables,
    first_step: float = 0.0,
    level: float = LEVEL,
) -> Deepest:
    """Return the deepest place of an edge, beside its chord, around one of its places.

    at : that place, between 0 and 1.  so_far : the deepest of other searches.  first_step : uphill
    from there, over the rounding radius, if the deepest place is close; the next are four times as
    long each.  level : slope that ends the search.  The result has no depth where that place is not
    in the tool, or on the hill of the one that is known.
    """
    tables = borrowed(held)
    none = Deepest(0.0, at, beside.end_a)
    u, end_a, end_b = beside.u, beside.end_a, beside.end_b
    here = place_on(at, beside, held)
    if not here.inside:
        return none
    rise = end_b.depth - end_a.depth
    flat = level * norm(u)
    # The largest value lies between lo and hi; what is known of both of them: depth, slope, way.
    lo, hi, s = 0.0, 1.0, at
    at_lo, at_hi = end_a, end_b
    slope = -dot(here.out, u) - rise
    # Around one convex edge the depth is concave: from here it rises to the place that is known.
    lower = here.depth - end_a.depth - at * rise <= so_far.depth
    if so_far.depth > 0.0 and lower and slope * (so_far.s - at) >= 0.0:
        return none
    slope_lo = -dot(end_a.out, u) - rise if end_a.inside else 0.0
    slope_hi = -dot(end_b.out, u) - rise if end_b.inside else 0.0
    step = first_step * tables.law.rounding / norm(u)
    step, uphill = step if slope > 0.0 else -step, step > 0.0
    for turn in range(_MOST_STEPS):
        if here.inside and abs(slope) <= flat:
            lo = hi = s
            at_lo = at_hi = here
            break
        if here.inside and slope > 0.0:
            lo, at_lo, slope_lo = s, here, slope
        elif here.inside:
            hi, at_hi, slope_hi = s, here, slope
        elif s > at:
            hi, at_hi = s, here
        else:
            lo, at_lo = s, here
        if hi - lo <= _NEAR or _falls_from_end(lo, hi, at_lo, at_hi, slope_lo, slope_hi):
            break
        uphill = uphill and here.inside and slope * step > 0.0 and lo < s + step < hi
        if uphill:
            s += step
            step *= 4.0
            here = place_on(s, beside, held)
            slope = -dot(here.out, u) - rise
            continue
        s = 0.5 * (lo + hi)
        if at_lo.inside and at_hi.inside and slope_lo > 0.0 > slope_hi:
            # Where both tangents meet, the place of a kink; and by turns where the slope is zero.
            s = lo + (hi - lo) * slope_lo / (slope_lo - slope_hi)
            if turn % 2 == 0:
                over = at_hi.depth - at_lo.depth - rise * (hi - lo) - slope_hi * (hi - lo)
                s = lo + over / (slope_lo - slope_hi)
            s = min(max(s, lo + 0.5 * _NEAR), hi - 0.5 * _NEAR)
        here = place_on(s, beside, held)
        slope = -dot(here.out, u) - rise
    best, other, s = at_lo, at_hi, lo
    if not best.inside or (other.inside and other.depth - rise * hi > best.depth - rise * lo):
        best, s = at_hi, hi
    g = best.depth - (1.0 - s) * end_a.depth - s * end_b.depth
    if g <= 0.0 or not best.inside:
        return none
    return Deepest(g, s, best)


@inline
def _falls_from_end(
    lo: float, hi: float, at_lo: Place, at_hi: Place, slope_lo: float, slope_hi: float
) -> bool:
    """Return whether a concave depth that is largest between lo and hi is so at an end of the edge.

    Beside a hollow flank it may rise again: other places are asked for that.
    """
    at_a = lo == 0.0 and at_lo.inside and slope_lo <= 0.0 and at_hi.inside
    at_b = hi == 1.0 and at_hi.inside and slope_hi >= 0.0 and at_lo.inside
    return at_a or at_b


@inline
def place_along(s: float, beside: Beside, wedge: Wedge, held: EdgeTables) -> Place:
    """Return how deep the place s of an edge is, in the wedge if that stands for the tool."""
    tables = borrowed(held)
    if wedge.known:
        return place_in_wedge(s, wedge, tables.law.rounding)
    return place_on(s, beside, held)


@inline
def _slope(here: Place, u: Vec3, offset: float, rise: float, g_m: float) -> tuple[bool, float]:
    """Return whether a place presses, and the slope of its energy over the ends' [mm²]."""
    loaded = here.depth - offset
    if not here.inside or loaded <= 0.0:
        return False, 0.0
    return True, -smoothed(loaded, g_m) * dot(here.out, u) - rise


@inline
def press_on(
    found: Deepest,
    offset: float,
    beside: Beside,
    wedge: Wedge,
    held: EdgeTables,
    first_step: float = FIRST_STEP,
    flat: float = FLAT,
) -> Press:
    """Return what an edge presses with where its energy over that of its ends is largest.

    found : its deepest place, where the search begins.  offset : what does not press there [mm].
    wedge : stands for the tool if it is known.  first_step : uphill, over the rounding radius.
    flat : slope that ends the search, of the energy over g_M and the edge's length.
    """
    tables = borrowed(held)
    u, end_a, end_b = beside.u, beside.end_a, beside.end_b
    g_m = tables.law.smoothing_depth
    of_a = smoothed_integral(end_a.depth, g_m)
    of_b = smoothed_integral(end_b.depth, g_m)
    rise, level = of_b - of_a, flat * norm(u) * g_m
    s = s_up = found.s
    here = up = found.here
    presses, slope = _slope(here, u, offset, rise, g_m)
    slope_up = slope
    none = no_press(found)
    if not presses:
        return none
    # Uphill until it falls again; where it does not before the edge ends, the ends feel it all.
    step = first_step * tables.law.rounding / norm(u)
    step = step if slope > 0.0 else -step
    while presses and slope * step > 0.0 and abs(slope) > level:
        s_up, up, slope_up = s, here, slope
        left = 1.0 - s if step > 0.0 else s
        if left <= _AT_END:
            return none
        s += min(abs(step), 0.5 * left) * (1.0 if step > 0.0 else -1.0)
        step *= 2.0
        here = place_along(s, beside, wedge, held)
        presses, slope = _slope(here, u, offset, rise, g_m)
    s_down, down, slope_down = s, here, slope
    beyond = not presses
    if presses and abs(slope) <= level:
        s_up, up, slope_up = s, here, slope
    kept = 0
    for _ in range(_MOST_STEPS):
        if abs(s_up - s_down) <= _CLOSE * (flat / FLAT):
            break
        s = 0.5 * (s_up + s_down)
        if not beyond:
            s = s_up + (s_down - s_up) * slope_up / (slope_up - slope_down)
        here = place_along(s, beside, wedge, held)
        presses, slope = _slope(here, u, offset, rise, g_m)
        if presses and abs(slope) <= level:
            s_up = s_down = s
            up = down = here
            break
        if presses and slope * step > 0.0:
            s_up, up, slope_up = s, here, slope
            if kept > 0:
                slope_down *= 0.5  # Illinois: an end that stays counts half
            kept = 1
        else:
            s_down, down, slope_down, beyond = s, here, slope, not presses
            if kept < 0:
                slope_up *= 0.5
            kept = -1
    out, loaded = up.out, up.depth - offset
    _, one = _slope(up, u, offset, rise, g_m)
    presses, two = _slope(down, u, offset, rise, g_m)
    if presses and one * two < 0.0:  # deeper than r the way out may jump
        out = combine(two / (two - one), up.out, -one / (two - one), down.out)
    stored = smoothed_integral(loaded, g_m) - of_a - s_up * rise
    if stored <= 0.0:
        return none
    from_a = (1.0 - s_up) * smoothed(end_a.depth, g_m)
    from_b = s_up * smoothed(end_b.depth, g_m)
    return Press(stored, s_up, up.depth, out, smoothed(loaded, g_m), from_a, from_b)
