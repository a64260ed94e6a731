"""Which edge drives a tip, and where to, tip by tip: the rules of ``fracture/blade_drive.py``."""

from itertools import count

import numpy as np
from scipy.spatial.transform import Rotation

from .contact import closest_point, winding_number

AHEAD = (1.0, 2.0, 4.0)
"""Where tips aim at the mid-plane: where they meet it when it has come so many edges past them."""


class Segment:
    """A segment of a tool's cutting edge, in the tool's frame."""

    def __init__(self, tool, k):
        self.start, stop = tool.vertices[tool.edges[k]]
        self.length = np.linalg.norm(stop - self.start)
        self.along = (stop - self.start) / self.length
        self.normal, self.back = tool.edge_normal[k], tool.edge_back[k]

    def owns(self, p, size):
        """Whether a point is in the strip behind it, up to four edges of the film deep.

        The strip widens by a fifth of the depth at its ends.
        """
        d = p - self.start
        along, depth = d @ self.along, d @ self.back
        slack = 0.2 * depth
        return 0.0 <= depth < 4.0 * size and -slack <= along <= self.length + slack

    def in_blade(self, p, tool):
        """Whether the blade is beside a point: its foot is inside, and the exit leads sideways.

        On a round edge a foot in the round counts as one behind it, by a quarter of the radius.
        """
        d = p - self.start
        foot = p - (d @ self.normal) * self.normal
        foot = foot + max(0.0, 1.25 * tool.edge_radius - d @ self.back) * self.back
        if winding_number(foot, tool) < 0.5:
            return False
        places = [closest_point(foot, triangle) for triangle in tool.vertices[tool.triangles]]
        out = min(places, key=lambda q: np.linalg.norm(q - foot)) - foot
        return abs(out @ self.normal) >= 0.5 * np.linalg.norm(out)


def in_tool(motion, time, x):
    """Return a point in the tool's frame, the rotation of that, and spin and velocity there."""
    rotation, translation = map(np.asarray, motion.pose(time))
    spin, velocity = motion.twist(time)
    velocity = velocity + np.cross(spin, x - translation)
    return rotation.T @ (x - translation), rotation, rotation.T @ spin, rotation.T @ velocity


def is_met(edge, p, velocity, spin, size):
    """Whether a segment meets a point before it, at which speed and when, and where on its line."""
    depth, speed, t = (p - edge.start) @ edge.back, -velocity @ edge.back, 0.0
    if speed > 0.0:  # it moves towards the point
        t = -depth / speed
        if t * np.linalg.norm(spin) > 0.5:
            return False, speed, t, p
    met = p - t * velocity + 0.5 * t * t * np.cross(spin, velocity) - edge.start
    along, aside = met @ edge.along, met @ edge.normal
    beside = -1e-6 * size <= along <= edge.length + 1e-6 * size
    return beside and abs(aside) <= 0.5 * size, speed, t, edge.start + along * edge.along


def arc_of(tool, k):
    """Return centre and axis of the circle on which the chain of a segment lies, None if on none.

    It has at least three segments. By least squares: 2 c · x + d = x · x in its plane.
    """
    points = tool.vertices[np.unique(tool.edges[tool.edge_chain == tool.edge_chain[k]])]
    if np.count_nonzero(tool.edge_chain == tool.edge_chain[k]) < 3:
        return None
    d = points - points.mean(axis=0)
    first, second, axis = np.linalg.svd(d)[2]
    flat = np.stack([d @ first, d @ second, np.ones(len(d))], axis=1)
    c0, c1, _ = 0.5 * np.linalg.lstsq(flat, (d * d).sum(axis=1), rcond=None)[0]
    arm = d - c0 * first - c1 * second
    radius = np.linalg.norm(arm, axis=1)
    if np.ptp(d @ second) < 1e-4 or max(np.ptp(radius), np.ptp(d @ axis)) > 1e-3 * np.ptp(
        d @ second
    ):
        return None
    return points.mean(axis=0) + c0 * first + c1 * second, axis


def nearest_of_chain(tool, k, p):
    """Return the segment of the chain of k that is nearest to a point, and how far it is."""
    gaps = {}
    for i in np.flatnonzero(tool.edge_chain == tool.edge_chain[k]).tolist():
        edge = Segment(tool, i)
        along = np.clip((p - edge.start) @ edge.along, 0.0, edge.length)
        gaps[i] = np.linalg.norm(p - edge.start - along * edge.along)
    nearest = min(gaps, key=gaps.get)
    return nearest, gaps[nearest]


def nearest_edge(tool, motion, x, size, time):
    """Return which segment of the edge a point has passed or will meet first, and whether passed.

    And the speed at which it comes; -1 if none.  x : (3,), [mm].  size : edge length there [mm].
    """
    p, _, spin, velocity = in_tool(motion, time, x)
    nearest, found, passed, speed = np.inf, -1, False, 0.0
    for k in range(tool.n_edge):
        edge = Segment(tool, k)
        depth, lateral = (p - edge.start) @ edge.back, (p - edge.start) @ edge.normal
        if edge.owns(p, size) and abs(lateral) <= 0.5 * size and edge.in_blade(p, tool):
            if not passed or depth < nearest:
                nearest, found, passed, speed = depth, k, True, -velocity @ edge.back
        elif not passed and -20.0 * size < depth < 0.0 and -depth < nearest:
            meets, comes, _, _ = is_met(edge, p, velocity, spin, size)
            if not meets and (arc := arc_of(tool, k)):
                # The arc does not turn about its axis, the tool turns in it.
                centre, axis = arc
                own = (spin @ axis) * axis
                slower = velocity - np.cross(own, p - centre)
                meets, comes, t, place = is_met(edge, p, slower, spin - own, size)
                back = Rotation.from_rotvec(-t * own).apply(place - centre)
                meets = meets and nearest_of_chain(tool, k, centre + back)[1] <= 0.5 * size
            if meets:
                nearest, found, speed = -depth, k, comes
    return found, passed, speed


def beyond(tool, motion, x, size, edge, time, speed=None, reach=AHEAD[0]):
    """Return how far off the mid-plane a point lies when an edge is ``reach`` beyond it.

    With the segment that is there then, and the time.

    Three steps of Newton's method, or until it is within a twentieth of an edge.

    speed : at which the edge comes to the point now, if that is known.
    """
    later = time
    for turn in count():
        p, _, _, velocity = in_tool(motion, later, x)
        segment = Segment(tool, edge)
        if turn > 0 or speed is None:
            there = nearest_of_chain(tool, edge, p)[0]
            other = Segment(tool, there)
            off, its_off = ((p - e.start) @ e.normal for e in (segment, other))
            depth, its_depth = ((p - e.start) @ e.back for e in (segment, other))
            if max(abs(off - its_off), abs(depth - its_depth)) > 0.05 * size:
                edge, segment = there, other
            speed = -velocity @ segment.back
        left = reach * size - (p - segment.start) @ segment.back
        if turn == 3 or abs(left) <= 0.05 * size or speed <= 0.0:
            break  # the edge may go away from it, or rest
        later += left / speed
    return float((p - segment.start) @ segment.normal), edge, later


def directions(tool, motion, edge, off, place, heading, time):
    """Return the unit directions in which a blade drives a tip, and how their plane leans."""
    rotation = np.asarray(motion.pose(time)[0])
    t, b = place.t, rotation @ Segment(tool, edge).normal
    trace = np.cross(t, b)
    trace /= np.linalg.norm(trace)
    if trace @ heading < 0.0:
        trace = -trace
    sine = float(b @ place.T)
    # The mid-plane is met the farther off the flatter it lies, at most tenfold.
    across = (b - (b @ t) * t) / max(1.0 - sine * sine, 0.1)
    directions = [reach * place.size * trace - off * across for reach in AHEAD]
    return [d / np.linalg.norm(d) for d in [*directions, trace]], sine * across
