"""Where a point lies as seen from a cutting edge; shared by cables, contact and criterion.

A segment of the cutting edge runs from a with unit vector e over the length L; b is the normal of
the blade's mid-plane there (the plane that bisects the two faces) and k = the direction into the
blade, in that plane and normal to e. A point p has

    along = (p - a) · e,    lateral = (p - a) · b,    depth = (p - a) · k,

and the segment *owns* it when 0 <= along <= L and 0 <= depth < CUT_DEPTH: the edge has reached or
passed the point, which then lies in the strip of the mid-plane behind the segment, ``lateral`` to
one side of it. All in the body frame of the tool.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ._jit import Floats, Ints, Vec3, inline
from ._vec3 import combine, dot, load, norm, sub
from .tool import Tool

CUT_DEPTH = 1.5
"""Points farther behind the edge were passed by some other part of the tool [mm]."""

# Neighbouring segments of a curved edge leave wedge-shaped gaps between their strips; each strip
# widens by this fraction of the depth at its ends, more than the edge turns at any vertex.
_STRIP_SLOPE = 0.2


@dataclass(frozen=True, eq=False)
class CuttingEdges:
    """The cutting-edge segments of a tool as kernels take them, shape (n_edge, 3) each."""

    start: Floats
    """a [mm]"""
    vector: Floats
    """L e [mm]"""
    normal: Floats
    """b"""
    back: Floats
    """k"""
    body: Ints
    """Tooth of each segment, shape (n_edge,)."""

    @classmethod
    def of(cls, tool: Tool | None) -> CuttingEdges:
        """Collect the segments of a tool; none of no tool."""
        if tool is None:
            none = np.zeros((0, 3))
            return cls(none, none, none, none, np.zeros(0, np.int64))
        start = np.ascontiguousarray(tool.vertices[tool.edges[:, 0]])
        vector = tool.vertices[tool.edges[:, 1]] - start
        return cls(start, vector, tool.edge_normal, tool.edge_back, tool.edge_body)


@inline
def strip_coordinates(
    p: Vec3, k: int, start: Floats, vector: Floats, normal: Floats, back: Floats
) -> tuple[float, float, float, bool]:
    """Return along, lateral, depth [mm] of a point, and whether segment k owns it."""
    d = sub(p, load(start, k))
    v = load(vector, k)
    length = norm(v)
    along = dot(d, v) / length
    lateral = dot(d, load(normal, k))
    depth = dot(d, load(back, k))
    slack = _STRIP_SLOPE * depth
    owns = 0.0 <= depth < CUT_DEPTH and -slack <= along <= length + slack
    return along, lateral, depth, owns


@inline
def edge_point(along: float, k: int, start: Floats, vector: Floats) -> Vec3:
    """Return the point of segment k at ``along``, clipped to the segment [mm]."""
    v = load(vector, k)
    s = min(max(along / norm(v), 0.0), 1.0)
    return combine(1.0, load(start, k), s, v)


@inline
def to_body(p: Vec3, rotation: Floats, translation: Floats) -> Vec3:
    """Return Rᵀ (p - r)."""
    return turn_back(
        (p[0] - translation[0], p[1] - translation[1], p[2] - translation[2]), rotation
    )


@inline
def turn_back(d: Vec3, rotation: Floats) -> Vec3:
    """Return Rᵀ d."""
    return (
        rotation[0, 0] * d[0] + rotation[1, 0] * d[1] + rotation[2, 0] * d[2],
        rotation[0, 1] * d[0] + rotation[1, 1] * d[1] + rotation[2, 1] * d[2],
        rotation[0, 2] * d[0] + rotation[1, 2] * d[1] + rotation[2, 2] * d[2],
    )


@inline
def turn(p: Vec3, rotation: Floats) -> Vec3:
    """Return R p."""
    return (
        rotation[0, 0] * p[0] + rotation[0, 1] * p[1] + rotation[0, 2] * p[2],
        rotation[1, 0] * p[0] + rotation[1, 1] * p[1] + rotation[1, 2] * p[2],
        rotation[2, 0] * p[0] + rotation[2, 1] * p[1] + rotation[2, 2] * p[2],
    )


@inline
def to_space(p: Vec3, rotation: Floats, translation: Floats) -> Vec3:
    """Return R p + r."""
    q = turn(p, rotation)
    return q[0] + translation[0], q[1] + translation[1], q[2] + translation[2]
