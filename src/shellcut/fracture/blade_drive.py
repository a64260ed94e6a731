"""Which crack tips a cutting edge drives, and in which direction.

A tip belongs to the segment of an edge before which it lies, near the mid-plane, or that has passed
it. It runs towards the trace of that blade's mid-plane in the sheet, a little ahead. A tip that the
edge has passed goes on whatever the force there ([METHOD2] 12, rule 6).

A crack may open some edge lengths ahead of the edge, and a blade that turns has turned by the time
it gets there: a tip 2 mm ahead on a circle of 9.4 mm would leave it by 0.2 mm. The mid-plane is
therefore that of the pose in which the edge will meet the tip; the motion is prescribed.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, Vec3
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import bound_once, inline, kernel
from shellcut.numerics.vec3 import combine, load
from shellcut.tool.cutting_edge import (
    BACK,
    CUT_DEPTH,
    NORMAL,
    CuttingEdges,
    in_the_blade,
    segment_part,
    strip_coordinates,
)
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose, to_body

# How far beside the mid-plane a tip may lie that an edge drives, in local edge lengths.
_REACH = 0.5

# How far ahead of the edge such a tip may be, likewise.
_AHEAD = 20.0


# Turns in finding when an edge meets a tip, and how near is near enough, in local edge lengths.
MEETINGS = 3
MET = 0.05

# Where the trace of the mid-plane is aimed at, in local edge lengths ahead.
LOOK_AHEAD = (1.0, 2.0, 4.0)


class Driven(NamedTuple):
    """Tips and the edges that drive them."""

    edge_of: Ints
    """Segment of the edge, -1 if none, shape (n_tip,)."""
    off: Floats
    """Signed distance of the tip from the mid-plane [mm], shape (n_tip,)."""
    depth: Floats
    """How far the edge has passed it, negative ahead of the edge [mm], shape (n_tip,)."""
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
        self._near_edge = bound_once(_near_edge)

    def of(self, x: Floats, size: Floats, pose: Pose) -> Driven:
        """Return which segments drive tips at x : (n_tip, 3) [mm]; size : (n_tip,) [mm]."""
        n = len(x)
        found = Driven(np.full(n, -1), np.zeros(n), np.zeros(n), np.zeros(n, np.bool_))
        self._near_edge(x, size, pose, self.edges, *found)
        return found

    def at_meeting(
        self, x: Floats, size: float, driven: Driven, i: int, motion: Motion, time: float
    ) -> tuple[int, float, Pose]:
        """Return segment, distance off the mid-plane and pose when the edge will meet a tip.

        Parameters
        ----------
        x : ndarray, shape (3,)
            Of the tip [mm].
        size : float
            Local edge length there [mm].
        driven : Driven
            At the present pose.
        i : int
            Which of its tips.
        motion : Motion
            Of the tool.
        time : float
            Now [s].
        """
        pose = Pose.of(*motion.pose(time))
        edge, off, depth = int(driven.edge_of[i]), float(driven.off[i]), float(driven.depth[i])
        later = time
        for _ in range(MEETINGS):
            if depth >= -MET * size:
                break
            spin, velocity = motion.twist(later)
            speed = (velocity + np.cross(spin, x - pose.translation)) @ (
                pose.rotation @ self.edges.segments[edge, BACK]
            )
            if speed >= 0.0:  # the edge goes away from it, or rests
                break
            later += depth / speed
            then = Pose.of(*motion.pose(later))
            found = self.of(x[None], np.array([size]), then)
            if found.edge_of[0] < 0:
                break
            pose, edge = then, int(found.edge_of[0])
            off, depth = float(found.off[0]), float(found.depth[0])
        return edge, off, pose

    def directions(
        self, segment: int, off: float, t: Floats, size: float, heading: Floats, pose: Pose
    ) -> list[Floats]:
        """Return the unit directions in space in which a blade drives a tip, the best one first.

        Towards the trace of its mid-plane, one edge length ahead; where that leads back out of the
        film ahead, because the film has been pushed far aside, less and less towards it.

        Parameters
        ----------
        segment, off : int, float
            Of :class:`Driven`.
        t : ndarray, shape (3,)
            Director at the tip.
        size : float
            Local edge length [mm].
        heading : ndarray, shape (3,)
            In which the tip came.
        pose : Pose
            Of the tool.
        """
        b = pose.rotation @ self.edges.segments[segment, NORMAL]
        trace = np.cross(t, b)
        trace /= np.linalg.norm(trace)
        if trace @ heading < 0.0:
            trace = -trace
        aside = off * (b - (b @ t) * t)
        ways = [reach * size * trace - aside for reach in LOOK_AHEAD]
        return [way / np.linalg.norm(way) for way in [*ways, trace]]


@kernel
def _near_edge(
    x: Floats,
    size: Floats,
    pose: Pose,
    edges: CuttingEdges,
    edge_of: Ints,
    off: Floats,
    depth_of: Floats,
    passed: Bools,
) -> None:
    """Write which segment of the edge a point is before or has passed, and how far beside it is.

    x : (n, 3), [mm].  size : (n,), local edge lengths [mm].  edge_of, off, passed : (n,).
    """
    pose, edges = borrowed(pose), borrowed(edges)
    for i in range(x.shape[0]):
        found = nearest_edge(to_body(load(x, i), pose), size[i], edges)
        edge_of[i], off[i], depth_of[i], passed[i] = found


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
