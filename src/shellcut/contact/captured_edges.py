"""The tool at those of its edges that an edge of the film may touch, for kernels.

Their wedges (:mod:`.tool_wedge`) are looked at first. One look at the whole tool shows whether it
is as deep as the wedge at a place: if the ball that rounds it there touches both faces and no other
comes closer.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add_scaled, dot, load, norm, scale, sub
from shellcut.tool.rounded_depth import face_depth, rounded_depth
from shellcut.tool.signed_distance import closest_of_side, signed_distance

from .edge_tables import EdgeTables
from .tool_wedge import (
    AGREES,
    Beside,
    Deepest,
    Place,
    Wedge,
    deepest_in_wedge,
    exchanged,
    place_in_wedge,
    wedge_along,
)

# Of a product of unit vectors: they are one.
_SAME = 1.0 - 1e-12

_MOST_FACES = 4


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
def closest_edge(s: float, beside: Beside, held: EdgeTables) -> int:
    """Return which captured edge of the tool is closest to the place s of an edge of the film."""
    tables = borrowed(held)
    edges, p, closest, least = tables.edges, add_scaled(beside.a, s, beside.u), -1, np.inf
    for i in range(beside.n_captured):
        e = tables.captured[i]
        along, way = load(edges.along, e), sub(p, load(edges.corner, e))
        t = min(max(dot(way, along) / dot(along, along), 0.0), 1.0)
        away = sub(way, scale(t, along))
        if dot(away, away) < least:
            closest, least = e, dot(away, away)
    return closest


@inline
def wedge_at(e: int, beside: Beside, held: EdgeTables) -> Wedge:
    """Return the wedge of the two faces at an edge of the tool along an edge of the film."""
    tables = borrowed(held)
    edges = tables.edges
    one, two = load(edges.normal[e], 0), load(edges.normal[e], 1)
    return wedge_along(beside.a, beside.u, one, two, edges.level[e, 0], edges.level[e, 1])


@inline
def is_tool(s: float, here: Place, beside: Beside, held: EdgeTables) -> tuple[bool, int]:
    """Return whether the tool is as deep at the place s of an edge of the film as a wedge says.

    here : what that says, both faces of the wedge bounding the depth.  The second result is the
    closest triangle.
    """
    tables = borrowed(held)
    radius, grid = tables.law.rounding, tables.grid
    z = add_scaled(add_scaled(beside.a, s, beside.u), min(here.depth - radius, 0.0), here.out)
    found, t, _, q, ahead = closest_of_side(z, beside.side, grid)
    depth, _ = face_depth(z, q, load(grid.surface.pseudo_normals[t], 0))
    touches = found and abs(depth - max(here.depth, radius)) <= AGREES * radius
    return touches and ahead <= AGREES * radius, t


@inline
def place_at(p: Vec3, side: int, held: EdgeTables) -> Place:
    """Return how deep a point of the body frame is below the rounded surface of a side."""
    tables = borrowed(held)
    found, inside, triangle, q, _, _ = signed_distance(p, side, tables.grid)
    if not (found and inside):
        return Place(False, 0.0, p)
    radius, across = tables.law.rounding, tables.across
    depth, out, across[0] = rounded_depth(
        p, q, triangle, side, radius, tables.grid, tables.around, across[0]
    )
    return Place(depth > 0.0, max(depth, 0.0), out)


@inline
def place_on(s: float, beside: Beside, held: EdgeTables) -> Place:
    """Return how deep the place s of an edge of the film is below the rounded surface.

    As :func:`place_at`; the wedge that is closest saves most of the search.
    """
    tables = borrowed(held)
    if beside.n_captured > 0:
        wedge = wedge_at(closest_edge(s, beside, held), beside, held)
        here = place_in_wedge(s, wedge, tables.law.rounding)
        both = max(dot(here.out, wedge.one), dot(here.out, wedge.two)) < _SAME
        if wedge.known and here.inside and both and is_tool(s, here, beside, held)[0]:
            return here
    return place_at(add_scaled(beside.a, s, beside.u), beside.side, held)


@inline
def with_faces_there(
    found: Deepest, wedge: Wedge, beside: Beside, held: EdgeTables
) -> tuple[bool, Deepest, Wedge]:
    """Return the deepest place of a wedge whose faces are those of the tool at that place.

    found : deepest place of a wedge, one face of which is exchanged for that of the tool until they
    agree.  The first result says whether they do.
    """
    tables = borrowed(held)
    surface = tables.grid.surface
    for _ in range(_MOST_FACES):
        agrees, t = is_tool(found.s, found.here, beside, held)
        if agrees:
            return True, found, wedge
        normal = load(surface.pseudo_normals[t], 0)
        level = dot(normal, load(surface.corners[t], 0))
        wedge = exchanged(wedge, normal, level, beside)
        says, found = deepest_in_wedge(wedge, beside.end_a, beside.end_b, tables.law.rounding)
        if not says or found.depth == 0.0:
            break
    return False, found, wedge
