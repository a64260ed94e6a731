"""Where a crack leaves the row ahead of it: the rules of ``fracture/ray_ahead.py``, one ray.

Rows ahead, ends of other cracks and the polygons of rows are those of ``CrackPath`` and
``CutTopology``; what a ray does in them is found here.
"""

from typing import NamedTuple

import numpy as np

from .shell import CORNERS, shape

JOIN, MERGE, CORNER, GRAZE = 0.3, 0.15, 0.05, 0.2
"""Of an edge: how near to a ray ends of oncoming cracks, crossings and corners are met; and of the
distance ahead, how near a ray passes the corner at the end of its own side that it turns around."""
FLAT = 1.0 / 3.0
"""Of the distance to a corner: a ray to a flank end that is flatter runs along the crack there."""
FLANK = -1
"""Of a polygon's edge that lies on a crack."""
SAME, AWAY = 1e-9, 1e-6
"""Of the parametric square: distances of what is one place, and of what is on a line."""


class Segment(NamedTuple):
    """A piece of a path through a row, by the names of the code's."""

    row: int
    entry: tuple
    exit: tuple
    side: int
    corner: int
    along_side: bool = False


def shape_functions(place):
    return shape(*place)[0]


def on_side(side, s):
    """The place at a fraction of a side, from its first corner."""
    a, b = np.array(CORNERS[side]), np.array(CORNERS[(side + 1) % 4])
    return tuple((a + s * (b - a)).tolist())


def along_side(side, place):
    """The fraction of a side at which a place on it lies."""
    a, b = np.array(CORNERS[side]), np.array(CORNERS[(side + 1) % 4])
    return float((np.array(place) - a) @ (b - a)) / 4.0


def corner_at(place):
    """The corner at a place, -1 if there is none."""
    return next((c for c in range(4) if np.hypot(*np.subtract(place, CORNERS[c])) < SAME), -1)


def height(place, a, b):
    """How far a place lies to the left of the line from a to b."""
    (dx, dy), (x, y) = np.subtract(b, a), np.subtract(place, a)
    return (dx * y - dy * x) / np.hypot(dx, dy)


def is_on(place, a, b):
    """Whether a place lies on the line through a and b."""
    return abs(height(place, a, b)) < AWAY


def edges(polygon):
    """Both points of each edge of a polygon, and the side of the quad on which it lies."""
    return zip(polygon.points, np.roll(polygon.points, -1, axis=0), polygon.sides, strict=True)


def common_side(polygon, first, second):
    """On which side two places of a polygon lie, None if on no common edge."""
    on = (side for a, b, side in edges(polygon) if is_on(first, a, b) and is_on(second, a, b))
    return next(on, None)


def contains(polygon, place):
    """Whether a place lies in a polygon or on its boundary."""
    return all(height(place, a, b) > -SAME for a, b, _ in edges(polygon))


def segment_from(path, state, tip, direction, lean=None, others=()):
    """Return the segment from a tip in a direction in space, None if no row lies there.

    lean : see :func:`segment`.  others : tips that it may join.
    """
    ahead = path.film.rows_ahead(tip)
    for row, entry in ahead:
        ends = path.film.oncoming(row, entry, tip.heading, others)
        joined = to_an_end(path, state, row, entry, direction, lean, ends) if ends else None
        if joined is not None:
            return joined
    found = (segment(path, state, row, entry, direction, lean) for row, entry in ahead)
    return next((segment for segment in found if segment is not None), None)


def segment(path, state, row, entry, direction, lean=None):
    """Return the segment through a row from a place in it in a direction in space.

    It ends where a plane through that place meets the boundary of the row's polygon: along the
    direction and the director, from which it leans by ``lean``, shape (3,). None where the
    direction leads out of the polygon, unless it grazes the side on which it begins.
    """
    polygon = path.film.topology.polygon(row)
    ray = _ray(path, state, row, entry, polygon.points, direction, lean)
    if ray is None:
        return None
    off, ahead = ray
    hit = _first_edge(polygon, entry, off, ahead)
    if hit is None:
        return _past_a_corner(path, row, entry, off, ahead)
    i, along = hit
    j = (i + 1) % len(polygon.points)
    side, a, b = polygon.sides[i], polygon.points[i], polygon.points[j]
    size = path.film.size(row)
    for k in (i, j) if abs(off[i]) <= abs(off[j]) else (j, i):
        end = polygon.points[k]
        corner = corner_at(end)
        if abs(off[k]) >= (CORNER if corner >= 0 else MERGE) * size:
            continue
        on = common_side(polygon, entry, end)
        if on is None:
            return Segment(row, entry, end, side, corner)
        if on == FLANK and abs(off[k]) < FLAT * ahead[k]:
            return None  # there is a crack already
        start = corner_at(entry)
        if corner >= 0 and start >= 0 and on != FLANK and path.film.may_break(row, start, corner):
            return Segment(row, entry, CORNERS[corner], on, corner, along_side=True)
    if side == FLANK:
        exit_ = tuple(np.add(a, along * np.subtract(b, a)).tolist())
        return Segment(row, entry, exit_, FLANK, -1)
    s_a, s_b = along_side(side, a), along_side(side, b)
    s = s_a + min(max(along, CORNER), 1.0 - CORNER) * (s_b - s_a)
    places = [on_side(side, s)]
    ring = path.film.ring(row)
    x = state.node.x[state.quads[row]]
    reach = MERGE * size / float(np.linalg.norm(x[(side + 1) % 4] - x[side]))
    for known in path.film.topology.crossings(ring[side], ring[(side + 1) % 4]):
        if abs(known - s) < reach and contains(polygon, on_side(side, known)):
            places.insert(0, on_side(side, known))
    for place in places:
        if common_side(polygon, entry, place) is None:
            return Segment(row, entry, place, side, -1)
    return None


def _ray(path, state, row, entry, places, direction, lean):
    """Return where places in a row lie beside the plane of a ray and along it, (n_place,) [mm]."""
    nodes, weights = state.quads[row], np.array(shape_functions(entry))
    t = weights @ state.node.t[nodes]
    t = t / np.linalg.norm(t)
    normal = np.cross(t if lean is None else t - lean, direction)
    if (size := float(np.linalg.norm(normal))) < AWAY:
        return None
    gaps = (np.array([shape_functions(p) for p in places]) - weights) @ state.node.x[nodes]
    return gaps @ (normal / size), gaps @ direction


def to_an_end(path, state, row, entry, direction, lean, ends):
    """Return the segment to that of some ends that is nearest to the ray, ahead in ``JOIN``."""
    polygon = path.film.topology.polygon(row)
    ray = _ray(path, state, row, entry, [end.place for end in ends], direction, lean)
    if ray is None:
        return None
    nearest, found = JOIN * path.film.size(row), None
    for end, off, ahead in zip(ends, *ray, strict=True):
        if abs(off) < nearest and ahead > 0.0:
            side = polygon.sides[end.edge]
            if side == FLANK and end.at_point:
                side = polygon.sides[end.edge - 1]
            nearest = abs(off)
            found = Segment(row, entry, end.place, side, corner_at(end.place))
    return found


def _past_a_corner(path, row, entry, off, ahead):
    """Return the segment that passes a corner which a ray along a side just misses; see _ray."""
    polygon, ring = path.film.topology.polygon(row), path.film.ring(row)
    points, n = polygon.points, len(polygon.points)
    on = [i for i in range(n) if is_on(entry, points[i], points[(i + 1) % n])]
    if len(on) != 1 or polygon.sides[on[0]] == FLANK:
        return None
    after = (on[0] + 1) % n
    for k, edge, along in ((after, after, CORNER), (on[0], on[0] - 1, 1 - CORNER)):
        side = polygon.sides[edge]
        if corner_at(points[k]) < 0 or side == FLANK or not abs(off[k]) < GRAZE * ahead[k]:
            continue
        s_a, s_b = (along_side(side, points[i % n]) for i in (edge, edge + 1))
        s = s_a + along * (s_b - s_a)
        known = path.film.topology.crossings(ring[side], ring[(side + 1) % 4])
        if all(abs(crossing - s) >= CORNER for crossing in known):
            return Segment(row, entry, on_side(side, s), side, -1)
    return None


def _first_edge(polygon, entry, off, ahead):
    """Return which edge of a polygon a ray leaves by, and how far along it; see :func:`_ray`."""
    best, found = np.inf, None
    n = len(polygon.points)
    for i in range(n):
        j = (i + 1) % n
        a, b = polygon.points[i], polygon.points[j]
        if off[i] * off[j] > 0.0 or off[i] == off[j] or is_on(entry, a, b):
            continue
        along = float(off[i] / (off[i] - off[j]))
        far = float(ahead[i] + along * (ahead[j] - ahead[i]))
        if 0.0 < far < best:
            best, found = far, (i, along)
    return found


def place_of(path, state, tip):
    """Return where a tip is, and in which direction it ran, of any length."""
    (row, entry), *_ = path.film.rows_ahead(tip)
    forward = path.film.heading_weights(row, entry, tip.heading)
    return path.film.place_in(state, row, entry), forward @ state.node.x[state.quads[row]]
