"""Teeth whose cutting edges are lines in their own plane, pressed into whole film."""

import numpy as np

from shellcut import Tool


def tooth(line, *, height=4.0, half_thickness=0.3, named=None, turn_deg=0.0, at=(0.0, 0.0)):
    """Return vertices, triangles and edges of a wedge on a line (n, 2) of the plane y = 0.

    named : which segments cut; all by default.  turn_deg : about the vertical.
    """
    line = np.asarray(line, float)
    n, zero = len(line), np.zeros(len(line))
    edge = np.column_stack([line[:, 0], zero, line[:, 1]])
    plus = np.column_stack([line[:, 0], zero + half_thickness, zero + height])
    c, s = np.cos(np.radians(turn_deg)), np.sin(np.radians(turn_deg))
    turned = np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])
    vertices = np.vstack([edge, plus, plus * [1.0, -1.0, 1.0]]) @ turned
    triangles = []
    for k in range(n - 1):
        a, b, c, d, e, f = k, k + 1, n + k, n + k + 1, 2 * n + k, 2 * n + k + 1
        triangles += [(a, d, c), (a, b, d), (a, e, f), (a, f, b), (c, d, f), (c, f, e)]
    triangles += [(0, n, 2 * n), (n - 1, 3 * n - 1, 2 * n - 1)]
    segments = range(n - 1) if named is None else named
    return vertices + np.array([*at, 0.0]), triangles, [(k, k + 1) for k in segments]


def tool_of(*teeth):
    """Return the tool of some teeth."""
    vertices, triangles, edges, first = [], [], [], 0
    for v, t, e in teeth:
        vertices.append(v)
        a, b, c = (v[np.array(t)[:, k]] for k in range(3))
        outward = (a * np.cross(b, c)).sum() > 0.0
        triangles.append((np.array(t) if outward else np.array(t)[:, ::-1]) + first)
        edges.append(np.array(e) + first)
        first += len(v)
    return Tool.from_triangles(
        np.vstack(vertices), np.vstack(triangles), edges=np.vstack(edges), flank_angle_deg=45.0
    )


def vee(rise_deg, reach=1.5):
    """Return the line of a V whose edges rise from the film by an angle."""
    z = reach * np.tan(np.radians(rise_deg))
    return [(-reach, z), (0.0, 0.0), (reach, z)]


def saw(rise_deg, pitch, n):
    """Return the line of n such teeth side by side."""
    z, start = 0.5 * pitch * np.tan(np.radians(rise_deg)), -0.5 * pitch * n
    points = [(start + 0.5 * k * pitch, 0.0 if k % 2 else z) for k in range(2 * n + 1)]
    return points


def arc(radius, facet_deg, most_deg=30.0, phase=0.0):
    """Return the chords of an arc, its lowest place at the origin; phase : of a vertex, 0 to 1."""
    n = int(most_deg / facet_deg)
    angle = np.radians(facet_deg * (np.arange(-n, n + 1) + phase))
    return np.column_stack([radius * np.sin(angle), radius - radius * np.cos(angle)])


def rounded(radius, rise_deg, facet_deg, reach=1.5):
    """Return the line of a V with a round nose."""
    nose = arc(radius, facet_deg, rise_deg)
    way = reach * np.array([np.cos(np.radians(rise_deg)), np.sin(np.radians(rise_deg))])
    return np.vstack([nose[0] + way * [-1.0, 1.0], nose, nose[-1] + way])


def disc(radius, n, half_thickness=0.25):
    """Return a disc of n facets whose whole rim cuts, its lowest vertex at the origin."""
    angle = 2.0 * np.pi * np.arange(n) / n
    rim = np.column_stack([radius * np.sin(angle), 0.0 * angle, radius * (1.0 - np.cos(angle))])
    hub = [(0.0, half_thickness, radius), (0.0, -half_thickness, radius)]
    sides = [(k, (k + 1) % n) for k in range(n)]
    triangles = [t for k, j in sides for t in ((j, k, n), (k, j, n + 1))]
    return np.vstack([rim, hub]), triangles, sides
