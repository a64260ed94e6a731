"""Whether a chord through a whole quad would part it: for the kernel that looks where edges pierce.

The same rules as :meth:`.crack_path.CrackPath.segment`, both ways from a place inside, and as those
of :meth:`.free_cracks.FreeCracks` that refuse a chord along a side; a test compares the two.
"""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import combine, cross, dot, load, norm, scale, sub

from .crack_path import SNAP
from .tip_places import AWAY

_NOWHERE = -1


@inline
def parts_quad(
    x: Floats, t: Floats, quads: Ints, e: int, xi: float, eta: float, normal: Vec3, size: float
) -> bool:
    """Return whether the trace of a plane at a place of quad e leaves it by two sides.

    x, t : (n_node, 3).  quads : (n_quad, 4).  normal : of the plane.  size : edge length [mm].
    """
    if abs(xi) > 1.0 - 2.0 * AWAY or abs(eta) > 1.0 - 2.0 * AWAY:
        return True  # on a side to within round-off: the rules themselves decide
    director = at_place(t, quads, e, xi, eta)
    trace = cross(director, normal)
    trace = scale(1.0 / norm(trace), trace)
    back = _leaves_by(x, director, quads, e, xi, eta, scale(-1.0, trace), size)
    ahead = _leaves_by(x, director, quads, e, xi, eta, trace, size)
    if back == _NOWHERE or ahead == _NOWHERE:
        return False
    together = False
    for side in range(4):
        together = together or (_is_on_side(back, side) and _is_on_side(ahead, side))
    return not together


@inline
def _leaves_by(
    x: Floats, director: Vec3, quads: Ints, e: int, xi: float, eta: float, way: Vec3, size: float
) -> int:
    """Return by which side (0 to 3) or corner (4 to 7) a ray leaves a quad."""
    here = at_place(x, quads, e, xi, eta)
    normal = cross(director, way)
    normal = scale(1.0 / norm(normal), normal)
    hit, best = _NOWHERE, np.inf
    for side in range(4):
        a = sub(load(x, quads[e, side]), here)
        b = sub(load(x, quads[e, (side + 1) % 4]), here)
        off_a, off_b = dot(a, normal), dot(b, normal)
        if off_a * off_b > 0.0 or off_a == off_b:
            continue
        along = off_a / (off_a - off_b)
        far = dot(a, way) + along * (dot(b, way) - dot(a, way))
        if 0.0 < far < best:
            best, hit = far, side
    if hit == _NOWHERE:
        return hit
    for corner in (hit, (hit + 1) % 4):
        if abs(dot(sub(load(x, quads[e, corner]), here), normal)) < SNAP * size:
            return 4 + corner
    return hit


@inline
def _is_on_side(end: int, side: int) -> bool:
    """Return whether a side or corner is on a side."""
    return end == side or (end >= 4 and (end - 4 == side or end - 4 == (side + 1) % 4))


@inline
def at_place(rows: Floats, quads: Ints, e: int, xi: float, eta: float) -> Vec3:
    """Return what rows : (n_node, 3) are at a place of quad e."""
    one = combine(
        0.25 * (1.0 - xi) * (1.0 - eta),
        load(rows, quads[e, 0]),
        0.25 * (1.0 + xi) * (1.0 - eta),
        load(rows, quads[e, 1]),
    )
    other = combine(
        0.25 * (1.0 + xi) * (1.0 + eta),
        load(rows, quads[e, 2]),
        0.25 * (1.0 - xi) * (1.0 + eta),
        load(rows, quads[e, 3]),
    )
    return combine(1.0, one, 1.0, other)
