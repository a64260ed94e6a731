"""Which crack tips a cutting edge drives, and in which direction.

A tip belongs to the segment of an edge before which it lies, near the mid-plane, or that has passed
it. It runs to where the edge will be when it has come an edge length beyond the tip. A tip that the
edge has passed goes on whatever the force there ([METHOD2] 12, rule 6).

The motion is prescribed, so that this pose is known. On a circle of radius R the present mid-plane
would lead a tip that lies a way a ahead of the edge off by a²/2R, 0.2 mm for 2 mm on 9.4 mm, and
the mid-plane at the tip still by L²/2R in a segment of length L. Aimed at a point of the path, a
segment ends within L²/8R of it.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3, norm, product
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.vec3 import combine, load
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
from shellcut.tool.pose import Pose, to_body
from shellcut.tool.pose_of_motion import pose_at

from .tip import Place

# How far beside the mid-plane a tip may lie that an edge drives, in local edge lengths.
_REACH = 0.5

# How far ahead of the edge such a tip may be, likewise.
_AHEAD = 20.0


# Of the squared sine of the angle between mid-plane and sheet: below it the way in the sheet to the
# mid-plane counts as that of a plane that leans by this, some 18 degrees from the sheet.
LEAST = 0.1

# Below this a vector has no direction: the mid-plane lies in the sheet to within round-off.
TANGENT = 1e-12

# Where the trace of the mid-plane is aimed at, in local edge lengths ahead.
LOOK_AHEAD = (1.0, 2.0, 4.0)

# Turns in finding when an edge will be at the first of these, and how near is near enough.
TURNS = 3
NEAR = 0.05


class Driven(NamedTuple):
    """Tips and the edges that drive them."""

    edge_of: Ints
    """Segment of the edge, -1 if none, shape (n_tip,)."""
    off: Floats
    """Signed distance of the tip from the mid-plane [mm], shape (n_tip,)."""
    passed: Bools
    """Whether the edge has passed it, shape (n_tip,)."""


class BladeDrive:
    """Finds the tips that cutting edges drive.

    Parameters
    ----------
    edges : CuttingEdges
        Of the tool.
    """

    def __init__(self, edges: CuttingEdges) -> None:
        self.edges = edges
        self._near_edge = BoundOnce(_near_edge)

    def of(self, x: Floats, size: Floats, pose: Pose) -> Driven:
        """Return which segments drive tips at x : (n_tip, 3) [mm]; size : (n_tip,) [mm]."""
        n = len(x)
        found = Driven(np.full(n, -1), np.zeros(n), np.zeros(n, np.bool_))
        self._near_edge(x, size, pose, self.edges, *found)
        return found

    def beyond(
        self,
        x: Floats,
        size: float,
        edge: int,
        motion: Motion,
        time: float,
        reach: float = LOOK_AHEAD[0],
    ) -> tuple[float, Pose]:
        """Return how far off the mid-plane a point lies when an edge is beyond it, and the pose.

        Parameters
        ----------
        x : ndarray, shape (3,)
            The point [mm].
        size : float
            Local edge length there [mm].
        edge : int
            Segment of the edge that is before the point or has passed it.
        motion : Motion
            Of the tool.
        time : float
            Now [s].
        reach : float
            How far beyond, in local edge lengths; negative: the earlier pose, in which the edge was
            still so far before the point.

        Returns
        -------
        off : float
            Signed distance [mm].
        pose : Pose
            The present one where the edge rests or goes away from the point.
        """
        pose, later = pose_at(motion, time), time
        segment = self.edges.segments[edge]
        for _ in range(TURNS):
            gap = pose.to_body(x[None])[0] - segment[START]
            left = reach * size - float(product(gap, segment[BACK]))
            if abs(left) <= NEAR * size:
                break
            spin, velocity = motion.twist(later)
            speed = product(
                velocity + np.cross(spin, x - pose.translation),
                product(pose.rotation, segment[BACK]),
            )
            if speed >= 0.0:  # the edge goes away from it, or rests
                break
            later -= left / speed
            pose = pose_at(motion, later)
        return float(product(pose.to_body(x[None])[0] - segment[START], segment[NORMAL])), pose

    def directions(
        self, segment: int, off: float, place: Place, pose: Pose
    ) -> tuple[list[Floats], Floats]:
        """Return the unit directions in space in which a blade drives a tip, the best one first.

        Towards the trace of its mid-plane, one edge length ahead; where that leads back out of the
        film ahead, because the film has been pushed far aside, less and less towards it. With them
        how the mid-plane leans from the director, for :meth:`.crack_path.CrackPath.segment`: by as
        much as from that of the reference film, for folds under the blade do not count.

        Parameters
        ----------
        segment : int
            That drives it.
        off : float
            Signed distance of the tip from its mid-plane [mm].
        place : Place
            Of the tip.
        pose : Pose
            Of the tool.
        """
        t, size = place.t, place.size
        b = product(pose.rotation, self.edges.segments[segment, NORMAL])
        trace = np.cross(t, b)
        trace /= max(float(norm(trace)), TANGENT)
        if product(trace, place.heading) < 0.0:
            trace = -trace
        sine = float(product(b, place.T))
        across = (b - product(b, t) * t) / max(1.0 - sine * sine, LEAST)
        ways = [reach * size * trace - off * across for reach in LOOK_AHEAD]
        return [way / max(float(norm(way)), TANGENT) for way in [*ways, trace]], (sine * across)


@kernel
def _near_edge(
    x: Floats,
    size: Floats,
    pose: Pose,
    edges: CuttingEdges,
    edge_of: Ints,
    off: Floats,
    passed: Bools,
) -> None:
    """Write which segment of the edge a point is before or has passed, and how far beside it is.

    x : (n, 3), [mm].  size : (n,), local edge lengths [mm].  edge_of, off, passed : (n,).
    """
    pose, edges = borrowed(pose), borrowed(edges)
    for i in range(x.shape[0]):
        found = nearest_edge(to_body(load(x, i), pose), size[i], edges)
        edge_of[i], off[i], _, passed[i] = found


@inline
def nearest_edge(p: Vec3, size: float, edges: CuttingEdges) -> tuple[int, float, float, bool]:
    """Return which segment of the edge a point is before or has passed, -1 if none.

    With it, how far beside its mid-plane and behind it the point lies, and whether it has passed.

    p : in the body frame [mm].  size : local edge length [mm].
    """
    segments = edges.segments
    nearest, edge, off, behind, passed = np.inf, -1, 0.0, 0.0, False
    for k in range(segments.shape[0]):
        _, lateral, depth, owns = strip_coordinates(p, k, segments, CUT_DEPTH * size)
        if abs(lateral) > _REACH * size:
            continue
        if owns and in_the_blade(p, lateral, k, edges):
            if not passed or depth < nearest:
                nearest = depth
                edge, off, behind, passed = k, lateral, depth, True
        elif not passed and -_AHEAD * size < depth < 0.0 and -depth < nearest:
            # Shifted forward onto the edge, the point would lie beside this segment.
            back = segment_part(segments, k, BACK)
            on_edge = combine(1.0, p, 1e-6 * size - depth, back)
            _, _, _, beside = strip_coordinates(on_edge, k, segments, CUT_DEPTH * size)
            if beside:
                nearest = -depth
                edge, off, behind = k, lateral, depth
    return edge, off, behind, passed
