"""Which crack tips a cutting edge drives, and in which direction.

A tip belongs to the segment of an edge that will meet it, near the mid-plane, or that has passed
it. It runs to where the edge will be when it is beyond the tip by one side of a quad (``size``). A
tip that the edge has passed advances whatever the force there: the blade already fills that place.

The motion is prescribed, so that this pose is known. A film that its supports move is met where it
will be then: poses are as seen from the film (:class:`.SeenFromFilm`), and then moved with the film
to its present place.

What counts is the motion of the edge as a curve. In the frame of a tool that moves on as now, with
the velocity v and the spin w at the tip, this is after a time t at

    p - t v + t²/2 w x v,

and is met by the segment there. Of a wheel that turns by more than some tenths of a radian until
then this is another segment than is found so. But an arc does not notice the turn about its own
axis (:mod:`.edge_curves`): with v and w of the arc the same says where the arc meets the tip, and
the tool must have its edge at that place of the arc then. An edge drives the tip if either says so:
the first is exact for straight edges and on screws, the second for wheels. The later poses are
exact. In each the segment is the one at the tip then, and the edge comes to the tip at -v · k, for
the direction k into the blade. Sliding along the edge has no part in that: a straight edge that is
drawn along itself keeps its mid-plane, and drives what its ends will not have left.

On a circle of radius R the present mid-plane would lead a tip that lies a distance a ahead of the
edge off by a²/2R, 0.2 mm for 2 mm on 9.4 mm, and the mid-plane at the tip still by L²/2R in a
segment of length L. Aimed at a point of the path, a segment ends within L²/8R of it.

The direction is that to the trace of the mid-plane in the sheet, one side of a quad ahead. Where
that leads back out of the film ahead, because the film has been pushed far aside, places farther
ahead on the trace are tried, and last the direction of the trace itself (``AIM_AHEAD``). The plane
of the segment (:mod:`.ray_ahead`) leans from the director as the mid-plane leans from that of the
reference film, not from that of the film now, which the blade folds.
"""

from __future__ import annotations

import math
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3, product
from shellcut.loads.film_motion import FilmMotion, SeenFromFilm
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import add, combine, cross, dot, load, norm, scale, store, sub
from shellcut.tool.cutting_edge import (
    BACK,
    CUT_DEPTH,
    NORMAL,
    START,
    VECTOR,
    CuttingEdges,
    edge_point,
    in_the_blade,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.edge_curves import EdgeCurves
from shellcut.tool.motion import Motion, rotation_rows, turned
from shellcut.tool.pose import Pose, to_body, turn, turn_back
from shellcut.tool.pose_of_motion import pose_at

# Lengths in sides of the quads at the tip, ``size``.
# How far beside the mid-plane a tip may lie when an edge that drives it meets it.
_REACH = 0.5

# How far ahead of the edge such a tip may be.
_AHEAD = 20.0

# Of the squared sine of the angle between mid-plane and sheet: below it the direction in the sheet
# to the mid-plane counts as that of a plane that leans by this, some 18 degrees from the sheet.
LEAST = 0.1

# Below this a vector has no direction: the mid-plane lies in the sheet to within round-off.
TANGENT = 1e-12

# How far the tool may turn until the edge meets the tip [rad]. Where it does, to second order, is
# off by a sixth of this angle cubed times the radius of the path: 0.02 of the radius.
_MOST_TURN = 0.5

# How far beyond its ends a segment meets what comes to it; far above round-off.
_ON_EDGE = 1e-6

# Where the trace of the mid-plane is aimed at, ahead of the tip.
AIM_AHEAD = (1.0, 2.0, 4.0)

# Ticks of the motion of a film up to which it is followed for an edge that approaches slowly.
_FORESEEN = 256

# Newton iterations for the time at which an edge is AIM_AHEAD[0] beyond the tip, and the distance
# from there, over the size, at which they end.
ITERATIONS = 3
NEAR = 0.05


class Driven(NamedTuple):
    """Tips and the edges that drive them, now and when these will be beyond them."""

    edge_of: Annotated[Ints, "(n_tip,)"]
    """Segment of the edge, -1 if none; the one at the tip then."""
    off: Annotated[Floats, "(n_tip,)"]
    """Signed distance of the tip from its mid-plane then [mm]."""
    passed: Annotated[Bools, "(n_tip,)"]
    """Whether the edge has passed the tip already."""
    rotation: Annotated[Floats, "(n_tip, 3, 3)"]
    """Of the tool then, at the pose that was tried last ..."""
    translation: Annotated[Floats, "(n_tip, 3)"]
    spin: Annotated[Floats, "(n_tip, 3)"]
    velocity: Annotated[Floats, "(n_tip, 3)"]
    """... with its twist."""
    time: Annotated[Floats, "(n_tip,)"]
    """Of the pose that is to be tried next [s]."""
    has_next: Annotated[Bools, "(n_tip,)"]
    """Whether there is such a pose."""
    directions: Annotated[Floats, "(n_tip, n_direction, 3)"]
    """Unit directions in space in which the edge drives the tip, the best one first."""
    lean: Annotated[Floats, "(n_tip, 3)"]
    """Of the plane of the segment from the director."""


class BladeDrive:
    """Finds the tips that the cutting edges of a tool drive in its motion, and where to."""

    def __init__(self, edges: CuttingEdges, motion: Motion, film: FilmMotion | None = None) -> None:
        self.edges, self._film = edges, film
        curves = EdgeCurves.of(edges.segments[:, START], edges.segments[:, VECTOR])
        self._curves_address = TableWriter()(curves)
        self._seen = motion if film is None else SeenFromFilm(film, motion)
        self._try_poses, self._direct = BoundOnce(_try_poses), BoundOnce(_direct)
        self._edges_address, self._address_of = TableWriter()(edges), TableWriter()
        self._allocate(0)

    def _allocate(self, n: int) -> None:
        self.driven = Driven(
            edge_of=np.full(n, -1),
            off=np.zeros(n),
            passed=np.zeros(n, np.bool_),
            rotation=np.zeros((n, 3, 3)),
            translation=np.zeros((n, 3)),
            spin=np.zeros((n, 3)),
            velocity=np.zeros((n, 3)),
            time=np.zeros(n),
            has_next=np.zeros(n, np.bool_),
            directions=np.zeros((n, len(AIM_AHEAD) + 1, 3)),
            lean=np.zeros((n, 3)),
        )
        self._driven_address = self._address_of(self.driven)

    def _seen_from_film(self, later: float, now: float) -> tuple[Floats, Floats, Floats, Floats]:
        """Return pose and twist of the tool at a time [s] as seen from the film.

        now : time at whose place the film is put [s].
        """
        R, r = pose_at(self._seen, later)
        spin, velocity = self._seen.twist(later)
        if self._film is None:
            return R, r, spin, velocity
        Q, q = self._film.pose(now)
        return product(Q, R), product(Q, r) + q, product(Q, spin), product(Q, velocity)

    def find(
        self,
        x: Floats,
        size: Floats,
        time: float,
        edge: int = -1,
        reach: float = AIM_AHEAD[0],
    ) -> Driven:
        """Return which edge drives each tip, and its pose when it is beyond it.

        The next call overwrites what is returned.

        x, size : (n_tip, 3), (n_tip,), where the tips are and the sides of quads there [mm].  time
        : now [s].  edge : segment that drives them all, if it is known.  reach : how far beyond, in
        sizes; negative: the earlier pose, in which the edge was still so far before the tip. The
        present pose where the edge rests or moves away from it.
        """
        if len(x) != len(self.driven.time):
            self._allocate(len(x))
        found = self.driven
        R, r, spin, velocity = self._seen_from_film(time, time)
        found.rotation[:], found.translation[:] = R, r
        found.spin[:], found.velocity[:] = spin, velocity
        found.time[:], found.has_next[:] = time, True
        # Up to which a film that moves is followed.
        latest = np.inf if self._film is None else time + _FORESEEN * self._film.tick
        if edge >= 0:
            found.edge_of[:], found.passed[:] = edge, False
        tried = (
            x,
            size,
            self._edges_address,
            self._curves_address,
            self._driven_address,
            reach,
        )
        count = self._try_poses(*tried, edge < 0, True)
        for k in range(ITERATIONS):
            if not count:
                break
            for i in np.flatnonzero(found.has_next).tolist():
                later = found.time[i] = min(float(found.time[i]), latest)
                R, r, spin, velocity = self._seen_from_film(later, time)
                found.rotation[i], found.translation[i] = R, r
                found.spin[i], found.velocity[i] = spin, velocity
            more = k < ITERATIONS - 1
            count = self._try_poses(*tried, False, more)
        return found

    def direct(self, director: Floats, heading: Floats, reference: Floats, size: Floats) -> Driven:
        """Return in which directions edges drive the tips of the last call of :meth:`find`.

        One that no edge drives is led straight on.

        director, reference : (n_tip, 3), unit directors there, now and in the reference film.
        heading : (n_tip, 3), in which direction they ran, of any length.  size : (n_tip,), [mm].
        """
        self._direct(director, heading, reference, size, self.edges.segments, self._driven_address)
        return self.driven


@kernel
def _try_poses(
    x: Floats,
    size: Floats,
    edges: CuttingEdges,
    curves: EdgeCurves,
    found: Driven,
    reach: float,
    choose_edge: bool,
    more: bool,
) -> int:
    """Find the edges at the poses tried, and the times to try next; return for how many tips.

    x : (n_tip, 3), [mm].  size : (n_tip,), [mm].  reach : see :meth:`BladeDrive.find`.
    choose_edge : whether the edge of each tip is found here, at the present pose.  more : whether
    another time may be tried.
    """
    edges, curves, found = borrowed(edges), borrowed(curves), borrowed(found)
    segments, count = edges.segments, 0
    for i in range(size.shape[0]):
        if not found.has_next[i]:
            continue
        found.has_next[i] = False
        pose = Pose(found.rotation[i], found.translation[i])
        p = to_body(load(x, i), pose)
        turning = cross(load(found.spin, i), sub(load(x, i), load(found.translation, i)))
        velocity = turn_back(add(load(found.velocity, i), turning), pose)
        if choose_edge:
            spin = turn_back(load(found.spin, i), pose)
            edge, off, depth, approach, found.passed[i] = _nearest_edge(
                p, size[i], edges, curves, velocity, spin
            )
        else:
            edge = _at_point(p, size[i], found.edge_of[i], segments, curves)
            off, depth = _beside_and_behind(p, edge, segments)
            approach = -dot(velocity, segment_part(segments, edge, BACK))
        found.edge_of[i], found.off[i] = edge, off
        if edge < 0:
            continue
        left = reach * size[i] - depth
        if more and abs(left) > NEAR * size[i] and approach > 0.0:
            found.time[i] += left / approach  # to first order, the edge is beyond by ``reach`` then
            found.has_next[i] = True
            count += 1
    return count


@kernel
def _direct(
    director: Floats,
    heading: Floats,
    reference: Floats,
    size: Floats,
    segments: Floats,
    found: Driven,
) -> None:
    """Write in which directions edges drive tips.

    director, heading, reference : (n_tip, 3).  size : (n_tip,).  segments : of the edges.
    """
    found = borrowed(found)
    n_direction = found.directions.shape[1]
    for i in range(size.shape[0]):
        d, e = load(director, i), found.edge_of[i]
        if e < 0:
            along = load(heading, i)
            along = combine(1.0, along, -dot(along, d), d)
            for nth in range(n_direction):
                store(found.directions[i], nth, scale(1.0 / max(norm(along), TANGENT), along))
            store(found.lean, i, (0.0, 0.0, 0.0))
            continue
        pose = Pose(found.rotation[i], found.translation[i])
        b = turn(segment_part(segments, e, NORMAL), pose)
        trace = cross(d, b)
        # Of the two senses of the trace that in which the crack runs.
        sign = -1.0 if dot(trace, load(heading, i)) < 0.0 else 1.0
        trace = scale(sign / max(norm(trace), TANGENT), trace)
        sine = dot(b, load(reference, i))
        across = scale(1.0 / max(1.0 - sine * sine, LEAST), combine(1.0, b, -dot(b, d), d))
        store(found.lean, i, scale(sine, across))
        aside = scale(found.off[i], across)
        for nth in range(n_direction):
            along = trace
            if nth < n_direction - 1:
                along = combine(AIM_AHEAD[nth] * size[i], trace, -1.0, aside)
            store(found.directions[i], nth, scale(1.0 / max(norm(along), TANGENT), along))


@inline
def _nearest_edge(
    p: Vec3, size: float, edges: CuttingEdges, curves: EdgeCurves, velocity: Vec3, spin: Vec3
) -> tuple[int, float, float, float, bool]:
    """Return which segment of the edge a point is before or has passed, -1 if none.

    With it, how far beside its mid-plane and behind it the point lies, the speed at which the edge
    comes to the point, and whether it has passed.

    p : [mm].  size : side of the quads there [mm].  velocity, spin : of the tool at the point,
    v [mm/s] and w [rad/s], in the body frame like p.
    """
    segments = edges.segments
    nearest, edge, off, behind, speed, passed = np.inf, -1, 0.0, 0.0, 0.0, False
    for k in range(segments.shape[0]):
        _, lateral, depth, owns = strip_coordinates(p, k, segments, CUT_DEPTH * size)
        if owns and abs(lateral) <= _REACH * size and in_the_blade(p, lateral, k, edges):
            # A segment that has passed the point goes before any that is still ahead; of several
            # the one that has passed it least.
            if not passed or depth < nearest:
                nearest = depth
                edge, off, behind, passed = k, lateral, depth, True
                speed = -dot(velocity, segment_part(segments, k, BACK))
        elif not passed and -_AHEAD * size < depth < 0.0 and -depth < nearest:
            is_met, approach, _, _ = _met(p, size, k, segments, velocity, spin)
            if not is_met:
                is_met, approach = _arc_met(p, size, k, segments, curves, velocity, spin)
            if is_met:
                nearest = -depth
                edge, off, behind, speed = k, lateral, depth, approach
    return edge, off, behind, speed, passed


@inline
def _met(
    p: Vec3, size: float, k: int, segments: Floats, velocity: Vec3, spin: Vec3
) -> tuple[bool, float, float, Vec3]:
    """Return whether segment k will meet a point before it, at which speed, when and where.

    In a frame that moves on as now the point is at p - t v + t²/2 w x v after a time t.

    velocity, spin : of the frame at the point, v [mm/s] and w [rad/s].
    """
    back, start = segment_part(segments, k, BACK), segment_part(segments, k, START)
    approach = -dot(velocity, back)
    # An edge that rests or moves away is taken to move along its mid-plane.
    t = -dot(sub(p, start), back) / approach if approach > 0.0 else 0.0
    if t * norm(spin) > _MOST_TURN:
        return False, approach, t, p
    # p - t v + t²/2 w x v, from there along k onto the line of the edge, and beside it
    met = combine(0.5 * t * t, cross(spin, velocity), 1.0, combine(1.0, p, -t, velocity))
    met = combine(1.0, met, -dot(sub(met, start), back), back)
    vector, normal = segment_part(segments, k, VECTOR), segment_part(segments, k, NORMAL)
    along, aside, length = dot(sub(met, start), vector), dot(sub(met, start), normal), norm(vector)
    is_beside = abs(along / length - 0.5 * length) <= 0.5 * length + _ON_EDGE * size
    return is_beside and abs(aside) <= _REACH * size, approach, t, combine(1.0, met, -aside, normal)


@inline
def _arc_met(
    p: Vec3,
    size: float,
    k: int,
    segments: Floats,
    curves: EdgeCurves,
    velocity: Vec3,
    spin: Vec3,
) -> tuple[bool, float]:
    """Return whether the arc of segment k will meet a point before it, and at which speed.

    The tool turns in the arc (:mod:`.edge_curves`) by w_n t, where w_n = w · n: what is at a place
    c + r of it then is now at c + Q r, turned back by that about n. There the tool must have the
    edge.

    velocity, spin : of the tool at the point, v [mm/s] and w [rad/s].
    """
    axis, centre = load(curves.axis, k), load(curves.centre, k)
    if dot(axis, axis) == 0.0:
        return False, 0.0
    # v - w_n n x (p - c), w - w_n n
    rate = dot(spin, axis)
    slides = cross(axis, sub(p, centre))
    velocity, spin = combine(1.0, velocity, -rate, slides), combine(1.0, spin, -rate, axis)
    is_met, approach, t, met = _met(p, size, k, segments, velocity, spin)
    if not is_met:
        return False, approach
    # Q = cos a 1 + sin a n~ + (1 - cos a) n n^T, a = -w_n t
    angle = -rate * t
    c = math.cos(angle)
    arm = turned(rotation_rows(axis, math.sin(angle), 1.0 - c, c), sub(met, centre))
    _, gap = _nearest_of_chain(add(centre, arm), k, segments, curves)
    return gap <= _REACH * size, approach


@inline
def _at_point(p: Vec3, size: float, k: int, segments: Floats, curves: EdgeCurves) -> int:
    """Return the segment of the chain of k that is at a point: k while its line is the edge there.

    p : [mm].  size : side of the quads there [mm].
    """
    there, _ = _nearest_of_chain(p, k, segments, curves)
    off, depth = _beside_and_behind(p, k, segments)
    off_there, depth_there = _beside_and_behind(p, there, segments)
    is_line = max(abs(off - off_there), abs(depth - depth_there)) <= NEAR * size
    return k if is_line else there


@inline
def _nearest_of_chain(p: Vec3, k: int, segments: Floats, curves: EdgeCurves) -> tuple[int, float]:
    """Return the segment of the chain of k that is nearest to a point, and its distance [mm]."""
    nearest, distance = k, np.inf
    for i in range(segments.shape[0]):
        if curves.chain[i] != curves.chain[k]:
            continue
        v = segment_part(segments, i, VECTOR)
        along = dot(sub(p, segment_part(segments, i, START)), v) / norm(v)
        gap = norm(sub(p, edge_point(along, i, segments)))
        if gap < distance:
            nearest, distance = i, gap
    return nearest, distance


@inline
def _beside_and_behind(p: Vec3, k: int, segments: Floats) -> tuple[float, float]:
    """Return how far beside the mid-plane of segment k a point lies, and how far behind it [mm]."""
    d = sub(p, segment_part(segments, k, START))
    return dot(d, segment_part(segments, k, NORMAL)), dot(d, segment_part(segments, k, BACK))
