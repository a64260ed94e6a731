"""Which edge drives a tip, and where to, tip by tip: the rules of ``fracture/blade_drive.py``."""

import numpy as np

from shellcut.fracture.blade_drive import LEAST, LOOK_AHEAD, NEAR, TANGENT, TURNS
from shellcut.tool.cutting_edge import (
    BACK,
    CUT_DEPTH,
    NORMAL,
    START,
    in_the_blade,
    strip_coordinates,
)
from shellcut.tool.pose_of_motion import pose_at


def nearest_edge(edges, motion, x, size, time):
    """Return which segment of the edge a point has passed, or will meet first, -1 if none.

    And whether it has passed it.

    x : (3,), [mm].  size : local edge length there [mm].
    """
    pose, nearest, found, passed = pose_at(motion, time), np.inf, -1, False
    p, deepest = pose.to_body(x[None])[0], CUT_DEPTH * size
    spin, velocity = motion.twist(time)
    velocity = pose.rotation.T @ (velocity + np.cross(spin, x - pose.translation))
    spin = pose.rotation.T @ spin
    for k, segment in enumerate(edges.segments):
        _, lateral, depth, owns = strip_coordinates(tuple(p), k, edges.segments, deepest)
        if owns and abs(lateral) <= 0.5 * size and in_the_blade(tuple(p), lateral, k, edges):
            if not passed or depth < nearest:
                nearest, found, passed = depth, k, True
        elif not passed and -20.0 * size < depth < 0.0 and -depth < nearest:
            back, met = segment[BACK], p
            if velocity @ back < 0.0:  # it comes towards the point
                t = depth / (velocity @ back)
                if t * np.linalg.norm(spin) > 0.5:
                    continue
                met = p - t * velocity + 0.5 * t * t * np.cross(spin, velocity)
            met = met - ((met - segment[START]) @ back - 1e-6 * size) * back
            _, aside, _, beside = strip_coordinates(tuple(met), k, edges.segments, deepest)
            if beside and abs(aside) <= 0.5 * size:
                nearest, found = -depth, k
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
