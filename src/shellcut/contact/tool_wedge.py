"""How deep an edge of the film lies in the wedge of two faces that meet at an edge of the tool.

Where no other face of the tool is near, its rounded depth D (:mod:`shellcut.tool.rounded_depth`)
has a closed form. Let n_i be the outward normals of both faces, c = n_1 · n_2, g_i the depths under
them and a_i = r - g_i. Then D = r - |w|, where w is the shortest way to the points deeper than r:

    one face     D = g_i                                             if c a_i >= a_j, a_i >= 0
    deeper       D = min(g_1, g_2)                                   if neither a_i > 0
    the round    |w|² = (a_1² + a_2² - 2 c a_1 a_2) / (1 - c²)       otherwise.

Along a straight edge p(s) = a + s u of the film both g_i are linear, g_i' = h_i = -n_i · u, and D
is concave, its slope falling from the larger h to the smaller. So D is most above a chord of slope
rho, h_1 > rho > h_2, on the round. There, t away from the place closest to the round's centre,

    |w|² = A t² + E,   A = (h_1² + h_2² - 2 c h_1 h_2) / (1 - c²),   t = -rho √(E / (A (A - rho²))),

E being the squared distance between p and the line on which the round is centred. If g > r there D
has a kink instead, and is most above the chord at that.

The faces end, and others may cut the wedge off. A convex tool is then no deeper than its wedge
says, so a place that is deepest in the wedge, and as deep in the tool, is deepest in the tool: one
look at the whole tool shows whether the wedge may be taken for it (:mod:`.captured_edges`).
"""

from __future__ import annotations

from math import sqrt
from typing import NamedTuple

from shellcut.arrays import Vec3
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import combine, dot

AGREES = 1e-6
"""Of the rounding radius: depths that are so close agree."""

# Of the sine between two faces, squared: less is one face.
_FLAT = 1e-9


class Place(NamedTuple):
    """A place in the tool."""

    inside: bool
    """Whether it is, with a depth that presses; the rest holds only then."""
    depth: float
    """D [mm]."""
    out: Vec3
    """Unit vector out, in the body frame."""


class Beside(NamedTuple):
    """An edge of the film beside the tool, in the body frame."""

    a: Vec3
    """One end [mm]."""
    u: Vec3
    """Way to the other [mm]."""
    side: int
    """Of the blade."""
    end_a: Place
    end_b: Place
    n_captured: int
    """Number of edges of the tool that it may touch, see ``EdgeTables.captured``; 0 where they are
    not asked for."""


class Deepest(NamedTuple):
    """Where an edge of the film is deepest, compared with its chord."""

    depth: float
    """g [mm], 0 if it is no deeper anywhere."""
    s: float
    """Where, from 0 at a to 1 at b."""
    here: Place
    """Of that place."""


class Wedge(NamedTuple):
    """Two faces of the tool along an edge a + s u of the film, in the body frame."""

    known: bool
    """Whether it stands for the tool; the rest holds only then."""
    one: Vec3
    """Outward normal of the face on which the depth rises faster."""
    two: Vec3
    """Of the other."""
    cosine: float
    """Of the angle between them."""
    depth_one: float
    """Depth of a under the first face [mm]."""
    depth_two: float
    rise_one: float
    """How much deeper b is [mm]."""
    rise_two: float


@inline
def no_wedge() -> Wedge:
    """Return one that stands for nothing."""
    zero = (0.0, 0.0, 0.0)
    return Wedge(False, zero, zero, 0.0, 0.0, 0.0, 0.0, 0.0)


@inline
def wedge_along(
    a: Vec3, u: Vec3, one: Vec3, two: Vec3, level_one: float, level_two: float
) -> Wedge:
    """Return the wedge of two faces along an edge a + s u of the film.

    one, two : outward normals.  level_one, level_two : their product with points of the faces [mm].
    """
    depth_one, depth_two = level_one - dot(one, a), level_two - dot(two, a)
    rise_one, rise_two = -dot(one, u), -dot(two, u)
    if rise_one < rise_two:
        one, two = two, one
        depth_one, depth_two, rise_one, rise_two = depth_two, depth_one, rise_two, rise_one
    c = dot(one, two)
    known = 1.0 - c * c > _FLAT
    return Wedge(known, one, two, c, depth_one, depth_two, rise_one, rise_two)


@inline
def exchanged(wedge: Wedge, normal: Vec3, level: float, beside: Beside) -> Wedge:
    """Return a wedge in which the face whose normal is closer to a given one gives way to that."""
    a, u, kept = beside.a, beside.u, wedge.one
    level_kept = wedge.depth_one + dot(wedge.one, a)
    if dot(normal, wedge.one) > dot(normal, wedge.two):
        kept, level_kept = wedge.two, wedge.depth_two + dot(wedge.two, a)
    return wedge_along(a, u, kept, normal, level_kept, level)


@inline
def place_in_wedge(s: float, wedge: Wedge, radius: float) -> Place:
    """Return how deep the place s of the film's edge is below the wedge, rounded by a radius."""
    g_one = wedge.depth_one + s * wedge.rise_one
    g_two = wedge.depth_two + s * wedge.rise_two
    a_one, a_two, c = radius - g_one, radius - g_two, wedge.cosine
    if a_one <= 0.0 and a_two <= 0.0:
        first = g_one <= g_two
    elif a_one >= 0.0 and c * a_one >= a_two:
        first = True
    elif a_two >= 0.0 and c * a_two >= a_one:
        first = False
    else:
        whole = 1.0 - c * c
        of_one, of_two = (a_one - c * a_two) / whole, (a_two - c * a_one) / whole
        away = sqrt(max(a_one * of_one + a_two * of_two, 0.0))
        depth = radius - away
        if away == 0.0:
            return Place(True, radius, wedge.one)
        out = combine(of_one / away, wedge.one, of_two / away, wedge.two)
        return Place(depth > 0.0, max(depth, 0.0), out)
    if first:
        return Place(g_one > 0.0, max(g_one, 0.0), wedge.one)
    return Place(g_two > 0.0, max(g_two, 0.0), wedge.two)


@inline
def deepest_in_wedge(
    wedge: Wedge, end_a: Place, end_b: Place, radius: float
) -> tuple[bool, Deepest]:
    """Return where an edge of the film is deepest in a wedge, compared with the chord of its ends.

    end_a, end_b : of the whole tool.  The first result is False where the wedge says nothing, as it
    is deeper than the tool at an end, that of the place.
    """
    nowhere = Deepest(0.0, 0.0, end_a)
    h_one, h_two, rho = wedge.rise_one, wedge.rise_two, end_b.depth - end_a.depth
    if not wedge.known:
        return False, nowhere
    s = 0.0 if rho >= h_one else 1.0
    if h_one > rho > h_two:
        s = (wedge.depth_two - wedge.depth_one) / (h_one - h_two)
        a, c = radius - wedge.depth_one - s * h_one, wedge.cosine
        if a > 0.0:
            whole = 1.0 - c * c
            A = (h_one * h_one + h_two * h_two - 2.0 * c * h_one * h_two) / whole
            if rho * rho >= A:
                return False, nowhere
            to_middle = a * (1.0 - c) * (h_one + h_two) / (whole * A)
            E = max(2.0 * a * a * (1.0 - c) / whole - A * to_middle * to_middle, 0.0)
            s += to_middle - rho * sqrt(E / (A * (A - rho * rho)))
    s = min(max(s, 0.0), 1.0)
    here = place_in_wedge(s, wedge, radius)
    g = here.depth - end_a.depth - s * rho
    if s == 0.0 or s == 1.0:
        return g <= AGREES * radius, Deepest(0.0, s, here)
    if not here.inside or g <= 0.0:
        return True, nowhere
    return True, Deepest(g, s, here)
