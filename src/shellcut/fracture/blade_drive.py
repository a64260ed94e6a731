"""Which crack tips a cutting edge drives, and in which direction.

A tip belongs to the segment of an edge that will meet it, near the mid-plane, or that has passed
it. It runs to where the edge will be when it is beyond the tip by one side of a quad (``size``). A
tip that the edge has passed advances whatever the force there: the blade already fills that place.

The motion is prescribed, so that this pose is known. A film that its supports move is met where it
will be then: poses are as seen from the film (:class:`.SeenFromFilm`), and then moved with the film
to its present place.

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
    CuttingEdges,
    in_the_blade,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.motion import Motion
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

# Behind the edge, where a segment owns what it meets; far above round-off.
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
    """Segment of the edge, -1 if none."""
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
        tried = x, size, self._edges_address, self._driven_address, reach
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
    edges, found = borrowed(edges), borrowed(found)
    count = 0
    for i in range(size.shape[0]):
        if not found.has_next[i]:
            continue
        found.has_next[i] = False
        pose = Pose(found.rotation[i], found.translation[i])
        p, depth = to_body(load(x, i), pose), 0.0
        turning = cross(load(found.spin, i), sub(load(x, i), load(found.translation, i)))
        velocity = turn_back(add(load(found.velocity, i), turning), pose)
        if choose_edge:
            found.edge_of[i], found.off[i], depth, found.passed[i] = _nearest_edge(
                p, size[i], edges, velocity, turn_back(load(found.spin, i), pose)
            )
        edge = found.edge_of[i]
        if edge < 0:
            continue
        k = segment_part(edges.segments, edge, BACK)
        if not choose_edge:
            d = sub(p, segment_part(edges.segments, edge, START))
            found.off[i], depth = dot(d, segment_part(edges.segments, edge, NORMAL)), dot(d, k)
        left, speed = reach * size[i] - depth, dot(velocity, k)
        if more and abs(left) > NEAR * size[i] and speed < 0.0:
            found.time[i] -= left / speed  # to first order, the edge is beyond by ``reach`` then
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
    p: Vec3, size: float, edges: CuttingEdges, velocity: Vec3, spin: Vec3
) -> tuple[int, float, float, bool]:
    """Return which segment of the edge a point is before or has passed, -1 if none.

    With it, how far beside its mid-plane and behind it the point lies, and whether it has passed.

    In the frame of a tool that moves on as now the point is at p - t v + t²/2 w x v after a time t.

    p : [mm].  size : side of the quads there [mm].  velocity, spin : of the tool at the point,
    v [mm/s] and w [rad/s], in the body frame like p.
    """
    segments = edges.segments
    nearest, edge, off, behind, passed = np.inf, -1, 0.0, 0.0, False
    for k in range(segments.shape[0]):
        _, lateral, depth, owns = strip_coordinates(p, k, segments, CUT_DEPTH * size)
        if owns and abs(lateral) <= _REACH * size and in_the_blade(p, lateral, k, edges):
            # A segment that has passed the point goes before any that is still ahead; of several
            # the one that has passed it least.
            if not passed or depth < nearest:
                nearest = depth
                edge, off, behind, passed = k, lateral, depth, True
        elif not passed and -_AHEAD * size < depth < 0.0 and -depth < nearest:
            back = segment_part(segments, k, BACK)
            approach = -dot(velocity, back)
            # An edge that rests or moves away is taken to move along its mid-plane.
            t = -depth / approach if approach > 0.0 else 0.0
            if t * norm(spin) > _MOST_TURN:
                continue
            met = combine(0.5 * t * t, cross(spin, velocity), 1.0, combine(1.0, p, -t, velocity))
            ahead = dot(sub(met, segment_part(segments, k, START)), back)
            met = combine(1.0, met, _ON_EDGE * size - ahead, back)
            _, aside, _, beside = strip_coordinates(met, k, segments, CUT_DEPTH * size)
            if beside and abs(aside) <= _REACH * size:
                nearest = -depth
                edge, off, behind = k, lateral, depth
    return edge, off, behind, passed
