"""Which edge drives a tip, and where to, tip by tip: the rules of ``fracture/blade_drive.py``."""

from itertools import count

import numpy as np

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


def nearest_edge(tool, motion, x, size, time):
    """Return which segment of the edge a point has passed or will meet first, and whether passed.

    -1 if none.  x : (3,), [mm].  size : local edge length there [mm].
    """
    p, _, spin, velocity = in_tool(motion, time, x)
    nearest, found, passed = np.inf, -1, False
    for k in range(tool.n_edge):
        edge = Segment(tool, k)
        depth, lateral = (p - edge.start) @ edge.back, (p - edge.start) @ edge.normal
        if edge.owns(p, size) and abs(lateral) <= 0.5 * size and edge.in_blade(p, tool):
            if not passed or depth < nearest:
                nearest, found, passed = depth, k, True
        elif not passed and -20.0 * size < depth < 0.0 and -depth < nearest:
            met = p
            if velocity @ edge.back < 0.0:  # it moves towards the point
                t = depth / (velocity @ edge.back)
                if t * np.linalg.norm(spin) > 0.5:
                    continue
                met = p - t * velocity + 0.5 * t * t * np.cross(spin, velocity)
            met = met - ((met - edge.start) @ edge.back - 1e-6 * size) * edge.back
            if edge.owns(met, size) and abs((met - edge.start) @ edge.normal) <= 0.5 * size:
                nearest, found = -depth, k
    return found, passed


def beyond(tool, motion, x, size, edge, time, reach=AHEAD[0]):
    """Return how far off the mid-plane a point lies when an edge is ``reach`` beyond it, and when.

    Three steps of Newton's method, or until it is within a twentieth of an edge.
    """
    later, segment = time, Segment(tool, edge)
    for turn in count():
        p, _, _, velocity = in_tool(motion, later, x)
        left = reach * size - (p - segment.start) @ segment.back
        if turn == 3 or abs(left) <= 0.05 * size or velocity @ segment.back >= 0.0:
            break  # the edge may go away from it, or rest
        later -= left / (velocity @ segment.back)
    return float((p - segment.start) @ segment.normal), later


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
