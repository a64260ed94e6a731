"""Which edge drives a tip, and where to, tip by tip: the rules of ``fracture/blade_drive.py``."""

import numpy as np

from shellcut.fracture.blade_drive import LEAST, LOOK_AHEAD, NEAR, TANGENT, TURNS
from shellcut.tool.cutting_edge import (
    BACK,
    CUT_DEPTH,
    NORMAL,
    START,
    STRIP_SLOPE,
    VECTOR,
    in_the_blade,
    strip_coordinates,
)
from shellcut.tool.pose_of_motion import pose_at


def nearest_edge(edges, x, size, pose):
    """Return which segment of the edge a point is before or has passed, -1 if none, and which.

    x : (3,), [mm].  size : local edge length there [mm].
    """
    p, nearest, found, passed = pose.to_body(x[None])[0], np.inf, -1, False
    in_gap = []
    deepest = CUT_DEPTH * size
    for k, segment in enumerate(edges.segments):
        _, lateral, depth, owns = strip_coordinates(tuple(p), k, edges.segments, deepest)
        if abs(lateral) > 0.5 * size:
            continue
        if owns and in_the_blade(tuple(p), lateral, k, edges):
            if not passed or depth < nearest:
                nearest, found, passed = depth, k, True
        elif not passed and -20.0 * size < depth < 0.0:
            on_edge = tuple(p + (1e-6 * size - depth) * segment[BACK])
            along, _, _, beside = strip_coordinates(on_edge, k, edges.segments, deepest)
            length = np.linalg.norm(segment[VECTOR])
            if beside and -depth < nearest:
                nearest, found = -depth, k
            elif not beside and max(-along, along - length) <= -STRIP_SLOPE * depth:
                pair = edges.segments[k - 1 : k + 1] if along < 0.0 else edges.segments[k : k + 2]
                if len(pair) == 2 and np.allclose(pair[0, :2].sum(axis=0), pair[1, START]):
                    in_gap.append(k)
    if found < 0 and in_gap:
        found = in_gap[0]
    return found, passed


def beyond(edges, motion, x, size, edge, time, reach=LOOK_AHEAD[0]):
    """Return how far off the mid-plane a point lies when an edge is beyond it, and the pose.

    x : (3,), [mm].  size : local edge length there [mm].  reach : in these.
    """
    pose, later, segment = pose_at(motion, time), time, edges.segments[edge]
    for _ in range(TURNS):
        gap = pose.to_body(x[None])[0] - segment[START]
        left = reach * size - float(gap @ segment[BACK])
        if abs(left) <= NEAR * size:
            break
        spin, velocity = motion.twist(later)
        back = pose.rotation @ segment[BACK]
        speed = (velocity + np.cross(spin, x - pose.translation)) @ back
        if speed >= 0.0:  # the edge goes away from it, or rests
            break
        later -= left / speed
        pose = pose_at(motion, later)
    return float((pose.to_body(x[None])[0] - segment[START]) @ segment[NORMAL]), pose


def directions(edges, edge, off, place, heading, pose):
    """Return the unit directions in which a blade drives a tip, and how their plane leans."""
    t, b = place.t, pose.rotation @ edges.segments[edge, NORMAL]
    trace = np.cross(t, b)
    trace /= max(float(np.linalg.norm(trace)), TANGENT)
    if trace @ heading < 0.0:
        trace = -trace
    sine = float(b @ place.T)
    across = (b - (b @ t) * t) / max(1.0 - sine * sine, LEAST)
    ways = [reach * place.size * trace - off * across for reach in LOOK_AHEAD]
    return [way / max(float(np.linalg.norm(way)), TANGENT) for way in [*ways, trace]], (
        sine * across
    )
