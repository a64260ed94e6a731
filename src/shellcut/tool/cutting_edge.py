"""Position of a point relative to a cutting edge; shared by cables, contact and criterion.

A segment of the cutting edge starts at a and has unit vector e and length L; b is the normal of the
blade's mid-plane there (the plane that bisects the two faces) and k = the direction into the blade,
in that plane and normal to e. A point p has

    along = (p - a) · e,    lateral = (p - a) · b,    depth = (p - a) · k,

and the segment *owns* it when 0 <= along <= L and 0 <= depth < ``CUT_DEPTH`` side lengths of the
film: the point then lies in the strip of the mid-plane behind the segment, ``lateral`` to one side
of it. All in the body frame of the tool.

Behind a concave corner, as of a hook, the strips of its two segments leave a wedge between them:
k turns there by an angle phi. Each strip widens by tan(phi/2) times the depth at that end, so that
they meet at the bisector.

The edge may not yet have passed a point in the strip. At the end of an edge the body ends too,
with an end face: below the tip of a tooth the relief rises backwards, and under a steep edge the
strip reaches far below the blade. If the edge has passed a point, the blade is at the point or
beside it: the point's *foot* on the mid-plane, p - lateral b, is inside the solid
(:func:`in_the_blade`). The faces may have pushed the point aside, but not its foot. Contact yields
a little, so film pressed by an end face is also inside the solid, by some thousandths of a
millimetre; but there the nearest exit from the solid leads back through that face, along the
mid-plane, whereas behind the edge it leads sideways, through a flank.
"""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, Vec3, unit
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.boxes import are_near, around_runs, box_around
from shellcut.numerics.jit import inline
from shellcut.numerics.vec3 import combine, dot, load, norm, sub

from .closest_triangles import ClosestTriangleGrid
from .signed_distance import TriangleGrid, signed_distance
from .tool import Tool

CUT_DEPTH = 4.0
"""Points farther behind the edge, in local side lengths of the film, were passed by another part of
the tool. Nodes and cables are checked before the edge has moved by a third of a side
(:mod:`shellcut.checks.plausible`), so film that is dragged along is still found."""

_STRIP_SLOPE = 0.2
"""Share of the depth by which a strip widens at each end at least, also where the edge is twisted
or ends."""

# Least 1 + cos phi of a corner: the two segments of a deeper one nearly touch each other.
_SLIT = 1e-3

# Segments that have a box together.
_RUN = 8

# Least sine of the angle between the mid-plane and a sideways exit from the solid: flanks are at
# less than 60 degrees to the mid-plane, blunt ones at 40; an end face is across it.
_ASIDE = 0.5

# Depth over the radius of the edge at which the nearest exit from the blade leads sideways: the
# middle of the round is at 1.
_BEHIND_ROUND = 1.25

START, VECTOR, NORMAL, BACK, SPREAD = 0, 1, 2, 3, 4
"""Rows of :attr:`CuttingEdges.segments`."""


class CuttingEdges(NamedTuple):
    """The cutting-edge segments of a tool, for kernels."""

    segments: Annotated[Floats, "(n_edge, 5, 3)"]
    """a [mm], L e [mm], b and k of each segment, and by which shares of the depth its strip widens
    at its start and its end."""
    tooth: Annotated[Ints, "(n_edge,)"]
    """Tooth of each segment."""
    solid: TriangleGrid
    """Finds the tool's surface, for :func:`in_the_blade`."""
    radius: float
    """Radius of the edges, whose segments are then their nose lines; 0 if sharp [mm]."""
    first: Annotated[Ints, "(n_run_1,)"]
    """First segment of each run of a few that follow one another, and the end."""
    low: Annotated[Floats, "(n_run, 3)"]
    """Corners of the box around each run [mm]."""
    high: Annotated[Floats, "(n_run, 3)"]
    widest: float
    """Largest share of the depth by which a strip widens."""

    @classmethod
    def of(cls, tool: Tool | None) -> CuttingEdges:
        """Collect the segments of a tool; without a tool there are none."""
        solid = ClosestTriangleGrid.of(tool).arrays
        if tool is None:
            # Read-only, as those of a tool: for another type the cables' kernel is compiled again.
            none = np.zeros(0, np.int64)
            none.flags.writeable = False
            low, high = np.zeros((2, 0, 3))
            return cls(np.zeros((0, 5, 3)), none, solid, 0.0, np.zeros(1, np.int64), low, high, 0.0)
        start, end = tool.vertices[tool.edges[:, 0]], tool.vertices[tool.edges[:, 1]]
        spread = _spread(tool, unit(end - start))
        rows = [start, end - start, tool.edge_normal, tool.edge_back, spread]
        every = np.arange(tool.n_edge)
        of_chain = every - np.searchsorted(tool.edge_chain, tool.edge_chain)
        first = np.append(np.flatnonzero(of_chain % _RUN == 0), tool.n_edge)
        low, high = around_runs(np.stack([start, end], axis=1), first)
        segments = np.stack(rows, axis=1)
        widest = float(spread.max(initial=0.0))
        return cls(segments, tool.edge_tooth, solid, tool.edge_radius, first, low, high, widest)


def _spread(tool: Tool, e: Floats) -> Floats:
    """Return by which shares of the depth strips widen at start and end, shape (n_edge, 3).

    e : (n_edge, 3), unit vectors of the segments.  The third column is zero.
    """
    found = np.zeros((tool.n_edge, 3))
    found[:, :2] = _STRIP_SLOPE
    starts, ends = tool.edges.T
    order = np.argsort(starts, kind="stable")
    after = order[np.searchsorted(starts[order], ends) % max(tool.n_edge, 1)]
    one = np.flatnonzero((starts[after] == ends) & (tool.edge_chain[after] == tool.edge_chain))
    k, two = tool.edge_back, after[one]
    # tan(phi/2) = sin phi / (1 + cos phi), negative at a convex corner.
    spread = np.maximum(1.0 + (k[one] * k[two]).sum(axis=1), _SLIT)
    found[one, 1] = np.maximum(_STRIP_SLOPE, (k[two] * e[one]).sum(axis=1) / spread)
    found[two, 0] = np.maximum(_STRIP_SLOPE, -(k[one] * e[two]).sum(axis=1) / spread)
    return found


@inline
def segment_part(segments: Floats, k: int, part: int) -> Vec3:
    """Return a (``START``), L e (``VECTOR``), b (``NORMAL``) or k (``BACK``) of segment k."""
    return segments[k, part, 0], segments[k, part, 1], segments[k, part, 2]


@inline
def may_own(a: Vec3, b: Vec3, reach: float, deepest: float, run: int, edges: CuttingEdges) -> bool:
    """Return whether segments of a run may own a point between two, by the box around them.

    reach : of the point beside the mid-plane, at most [mm].  deepest : of
    :func:`strip_coordinates`; the strip is wider than the segment by a part of that.
    """
    low, high = box_around(a, b, a, b)
    far = reach + (1.0 + edges.widest) * deepest
    return are_near(low, high, load(edges.low, run), load(edges.high, run), far)


@inline
def strip_coordinates(
    p: Vec3, k: int, segments: Floats, deepest: float
) -> tuple[float, float, float, bool]:
    """Return along, lateral, depth [mm] of a point, and whether segment k owns it.

    It owns what lies behind it, by less than ``deepest`` [mm], and beside it not farther than its
    ends, widened by a part of the depth. Of a point before it or farther behind, along is 0.
    """
    d = sub(p, segment_part(segments, k, START))
    lateral = dot(d, segment_part(segments, k, NORMAL))
    depth = dot(d, segment_part(segments, k, BACK))
    if not 0.0 <= depth < deepest:
        return 0.0, lateral, depth, False
    v, spread = segment_part(segments, k, VECTOR), segment_part(segments, k, SPREAD)
    length = norm(v)
    along = dot(d, v) / length
    beside = -spread[0] * depth <= along <= length + spread[1] * depth
    return along, lateral, depth, beside


@inline
def in_the_blade(p: Vec3, lateral: float, k: int, edges: CuttingEdges) -> bool:
    """Return whether the blade is at a point behind segment k, or beside it.

    p : point in the body frame, [mm].  lateral : its coordinate, from :func:`strip_coordinates`.
    """
    edges = borrowed(edges)
    aside = segment_part(edges.segments, k, NORMAL)
    foot = combine(1.0, p, -lateral, aside)
    if edges.radius > 0.0:
        # Within the round the exit leads forward: a place behind it is used instead.
        back = segment_part(edges.segments, k, BACK)
        depth = dot(sub(p, segment_part(edges.segments, k, START)), back)
        foot = combine(1.0, foot, max(0.0, _BEHIND_ROUND * edges.radius - depth), back)
    _, inside, _, nearest, _ = signed_distance(foot, 0, edges.solid)
    if not inside:
        return False
    # Behind the edge the nearest exit leads sideways, through a flank; at an end face it does not.
    outward = sub(nearest, foot)
    sideways = dot(outward, aside)
    return sideways * sideways >= _ASIDE * _ASIDE * dot(outward, outward)


@inline
def edge_point(along: float, k: int, segments: Floats) -> Vec3:
    """Return the point of segment k at ``along``, clipped to the segment [mm]."""
    v = segment_part(segments, k, VECTOR)
    s = min(max(along / norm(v), 0.0), 1.0)
    return combine(1.0, segment_part(segments, k, START), s, v)
