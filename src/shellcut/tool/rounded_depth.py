"""Depth of a point under a tool's surface whose convex edges and corners are rounded.

The depth d(p) of a point inside the solid, its distance from the surface, has a kink wherever the
closest face changes: a node that slides around a convex edge is thrown from the normal of one face
to that of the next. So the depth is measured from the surface that a ball of radius r touches as it
rolls on the inside (the solid opened by the ball). With S the points deeper than r,

    D(p) = r - dist(p, S) = d(p) on faces,  less at convex edges,          direction: grad of -D.

As S is locally convex at a convex edge, the distance from it and the foot on it are continuous, and
so is any force k f(D) along the gradient; the potential is the integral of k f. Deeper than r the
depth is d itself, kinks and all. An edge that turns by t loses a lip r (1 / cos(t/2) - 1) high:
0.0002 r at 2 deg, 0.4 r at 90 deg.

Near a point the faces of S are those of the surface, r farther in. With n_i the outward normals and
g_i the depths under the planes of the faces around,

    dist(p, S) = min |w|  for  n_i · w >= a_i = r - g_i,

the point p - w lying on S. The least w is spanned by one, two or three of the normals with positive
weights (face, edge, corner of S); they are found by adding the constraint that is violated most. So
they are added one after the other: p - w is moved away from the face that is closest to it, until
none is closer than r. Mostly the ball rolls along one face, or along the edge of two, for a while.
Then D follows from their planes alone (:func:`depth_under_faces`), as long as no other face can be
closer than r to its centre (:func:`.ball_clearance`). This changes D by round-off at most.

Where the surface is concave the closest point lies on an edge or vertex for a whole wedge of
points. There the direction is that to the closest point, the depth the distance: the gradient
again. Where such an edge runs into a convex one (a saddle), the two are combined as if planes: what
is left of a kink there is of second order in the angles.
"""

from __future__ import annotations

from math import sqrt

import numpy as np

from shellcut.arrays import Floats, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import always_inline, inline
from shellcut.numerics.vec3 import add_scaled, combine, cross, dot, load, norm, scale, sub

from .signed_distance import TriangleGrid, closest_of_side

# Of a dot product of normals: planes that agree so far are the same.
_PARALLEL = 1e-12

# Of the radius: constraints violated by less are met.
_MET = 1e-12

# Sum of squares of a small sine: the foot of a point lies beside the face, on an edge or vertex.
_BESIDE = 1e-12

_MOST_ROUNDS = 16


@inline
def face_depth(p: Vec3, q: Vec3, normal: Vec3) -> tuple[float, Vec3]:
    """Return the depth of a point inside and the direction out [mm], no edge rounded.

    q : closest point of the surface.  normal : of its triangle.
    """
    offset = sub(q, p)
    g, squared = dot(offset, normal), dot(offset, offset)
    if g > 0.0 and squared - g * g > _BESIDE * squared:
        g = sqrt(squared)
        return g, scale(1.0 / g, offset)
    return g, normal


@always_inline
def rounded_depth(
    p: Vec3,
    q: Vec3,
    triangle: int,
    side: int,
    radius: float,
    grid: TriangleGrid,
) -> tuple[float, Vec3, int]:
    """Return D of a point inside [mm], the unit direction out, and the other face that gives it.

    That is the face across a convex edge, ``triangle`` where this one gives it alone, and -1 where
    more than two do.

    p : in the body frame, [mm].  q : the closest point of the surface of its side, on triangle.
    side : +1, -1 or 0 for triangles of flank >= 0, <= 0, all.  radius : r [mm].
    """
    normals = grid.surface.pseudo_normals
    face = normals[triangle, 0, 0], normals[triangle, 0, 1], normals[triangle, 0, 2]
    g, out = face_depth(p, q, face)
    if not 0.0 <= g < radius:  # deeper than r, D is the depth below the face
        return g, out, triangle
    w, other = offset_from_opened(p, g, out, triangle, side, radius, grid)
    length = norm(w)
    return radius - length, scale(1.0 / length, w), other


@inline
def depth_under_faces(
    p: Vec3, one: int, two: int, radius: float, grid: TriangleGrid
) -> tuple[bool, float, Vec3]:
    """Return whether D < r of a point follows from one or two faces alone, D [mm], direction out.

    p : in the body frame, [mm].  one, two : triangles, which may be the same.  radius : r [mm].
    """
    planes = grid.surface.planes
    n = load(planes[one], 0)
    g = planes[one, 0, 3] - dot(n, p)
    if two == one:
        return 0.0 < g < radius, g, n
    other = load(planes[two], 0)
    beyond = planes[two, 0, 3] - dot(other, p)
    inside = min(g, beyond) > 0.0
    # The weights of both normals in the least w with n · w = r - g for each.
    a, b, c = radius - g, radius - beyond, dot(n, other)
    whole = 1.0 - c * c
    of_n, of_other = (a - c * b) / whole, (b - c * a) / whole
    if of_other <= 0.0:
        return inside and g < radius, g, n
    if of_n <= 0.0:
        return inside and beyond < radius, beyond, other
    w = combine(of_n, n, of_other, other)
    length = norm(w)
    return inside, radius - length, scale(1.0 / length, w)


@inline
def offset_from_opened(
    p: Vec3, g: float, out: Vec3, triangle: int, side: int, radius: float, grid: TriangleGrid
) -> tuple[Vec3, int]:
    """Return w, the shortest vector from S to a point inside that is less than r deep [mm].

    And the other face that it depends on: ``triangle`` if there is none, -1 if there are more.
    g, out : depth of p and outward direction from it to ``triangle``, the closest one.
    """
    grid = borrowed(grid)
    w = scale(radius - g, out)
    deep, across, normal, needed = _face_beyond(p, w, side, radius, grid)
    if deep:
        return w, triangle
    # Mostly the round of one edge: two faces, without a table of them.
    second = _least_of_two(out, radius - g, normal, needed, radius)
    deep, _, third, beyond = _face_beyond(p, second, side, radius, grid)
    if deep:
        return second, across
    n, a = np.empty((4, 3)), np.empty(4)
    _put(n, a, 0, out, radius - g)
    _put(n, a, 1, normal, needed)
    _, m = _least(n, a, 2, radius)
    _put(n, a, m, third, beyond)
    # Add the face that is closest to p - w, until none is closer than r.
    for _ in range(_MOST_ROUNDS):
        w, m = _least(n, a, m + 1, radius)
        deep, _, normal, needed = _face_beyond(p, w, side, radius, grid)
        if deep:
            break
        _put(n, a, m, normal, needed)
    return w, -1


@inline
def _face_beyond(
    p: Vec3, w: Vec3, side: int, radius: float, grid: TriangleGrid
) -> tuple[bool, int, Vec3, float]:
    """Return whether p - w is r deep, else the face it is too close to, and its outward normal n.

    And what n · w must be for that face [mm].
    """
    z = sub(p, w)
    found, t, _, q = closest_of_side(z, side, grid)
    normals = grid.surface.pseudo_normals
    depth, normal = face_depth(z, q, (normals[t, 0, 0], normals[t, 0, 1], normals[t, 0, 2]))
    deep = not found or depth >= radius * (1.0 - _MET)
    return deep, t, normal, radius - depth + dot(normal, w)


@inline
def _least_of_two(first: Vec3, a: float, second: Vec3, b: float, radius: float) -> Vec3:
    """Return the least w with first · w >= a, second · w >= b; the second one spans it."""
    c = dot(first, second)
    if b >= 0.0 and c * b >= a - _MET * radius:
        return scale(b, second)
    whole = 1.0 - c * c
    if whole < _PARALLEL or a < c * b or b < c * a:
        return scale(b, second)
    return combine((a - c * b) / whole, first, (b - c * a) / whole, second)


@inline
def _put(n: Floats, a: Floats, i: int, normal: Vec3, needed: float) -> None:
    n[i, 0], n[i, 1], n[i, 2] = normal
    a[i] = needed


@inline
def _least(n: Floats, a: Floats, m: int, radius: float) -> tuple[Vec3, int]:
    """Return the least w with n_i · w >= a_i for the first m of four, and how many span it.

    The last one is among those that span it; they are moved to the front of n and a.
    """
    chosen = 1 << (m - 1)
    w = scale(a[m - 1], load(n, m - 1))
    for mask in range(1 << (m - 1), 1 << m):
        i, j, k, count = -1, -1, -1, 0
        for b in range(m):
            if mask & (1 << b):
                i, j, k = j, k, b
                count += 1
        if count > 3:
            continue
        positive, tried = _spanned(n, a, i, j, k)
        met = positive
        for b in range(m):
            met = met and dot(load(n, b), tried) >= a[b] - _MET * radius
        if met:
            w, chosen = tried, mask
            break
    kept = 0
    for b in range(m):
        if chosen & (1 << b):
            _put(n, a, kept, load(n, b), a[b])
            kept += 1
    return w, kept


@inline
def _spanned(n: Floats, a: Floats, i: int, j: int, k: int) -> tuple[bool, Vec3]:
    """Return the w spanned by up to three normals with n · w = a, and whether weights are >= 0.

    An i, or i and j, below zero stand for none.
    """
    nk = load(n, k)
    if j < 0:
        return a[k] >= 0.0, scale(a[k], nk)
    nj = load(n, j)
    if i < 0:
        c = dot(nj, nk)
        whole = 1.0 - c * c
        if whole < _PARALLEL:
            return False, nk
        of_j, of_k = (a[j] - c * a[k]) / whole, (a[k] - c * a[j]) / whole
        return of_j >= 0.0 and of_k >= 0.0, combine(of_j, nj, of_k, nk)
    ni = load(n, i)
    jk, ki, ij = cross(nj, nk), cross(nk, ni), cross(ni, nj)
    volume = dot(ni, jk)
    if abs(volume) < _PARALLEL:
        return False, nk
    w = add_scaled(combine(a[i] / volume, jk, a[j] / volume, ki), a[k] / volume, ij)
    positive = min(dot(w, jk) / volume, min(dot(w, ki) / volume, dot(w, ij) / volume)) >= 0.0
    return positive, w
