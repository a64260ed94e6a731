"""Points of the tool that push the film between its nodes: corners and points along edges.

The nodes of the film feel the faces of the tool. A corner or an edge of the tool that comes down
between nodes would pass through the film. So these points push: the convex corners of the surface,
also those of a smooth surface (a ball), and points along convex edges that turn by more than
``LEAST_TURN``. They are no farther apart than half an edge length of the film. Where they are
closer than 0.4 of an edge length, as on a surface finer than the film, some are left out; the
sharper points stay.

*Cutting edges* push like all others: the film on whose face they come down carries them until it
is pierced (:mod:`shellcut.fracture.pierce`). Their tips (:mod:`shellcut.tool.edge_bow`) are never
left out. On an arc the points are so close that none of the arc protrudes between two of them by
more than the depth over which the contact sets in.
"""

from __future__ import annotations

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints, angles, unit
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.edge_bow import LEAST_TURN, EdgeBow
from shellcut.tool.surface import Surface
from shellcut.tool.tool import Tool

from .contact_tables import ToolPoints

SPACING, CLOSEST = 0.5, 0.4
"""Largest and least distance of points along edges, over an edge length of the film."""

_MOST_POINTS = 1_000_000

# Turn of an edge from which on it counts as concave; at the corner of a flank that is hollow, of
# facets, besides a part of the largest turn there.
_CONCAVE, _HOLLOW = np.radians(-0.5), 0.05

# Cosine of the angle between the normals of points that may press on the film together.
_SAME_DIRECTION = 0.5

# Missing to 2 pi in the angles around a convex corner, at least.
_PEAKED = 1e-4


def tool_points(tool: Tool, edge_length: float, depth: float = np.inf) -> ToolPoints:
    """Return the points of a tool that push a film.

    Parameters
    ----------
    tool : Tool
    edge_length : float
        Of the film's smaller quads [mm].
    depth : float
        By which an arc of a cutting edge may stand out between two of its points [mm].
    """
    surface, bow = Surface(tool.vertices, tool.triangles), EdgeBow.of(tool)
    on_cut = np.zeros(tool.n_vertex, np.bool_)
    on_cut[tool.edges] = True
    vertex, turn_at_vertex = _corners(tool, surface, bow.tip, on_cut)
    spacing = SPACING * edge_length
    places, normals, turns, teeth, segments = _along_edges(tool, surface, on_cut, spacing)
    at_vertex = np.zeros_like(tool.vertices)
    at_vertex[tool.triangles] = ClosestTriangleGrid.of(tool).arrays.surface.pseudo_normals[:, 1:4]
    tooth_of = np.zeros(tool.n_vertex, np.int64)
    tooth_of[tool.triangles] = tool.triangle_tooth[:, None]
    place = np.concatenate([tool.vertices[vertex], places])
    outward = np.concatenate([unit(at_vertex[vertex]), normals])
    tooth = np.concatenate([tooth_of[vertex], teeth])
    is_tip = np.concatenate([bow.tip[vertex], np.zeros(len(turns), np.bool_)])
    at_end = np.full(tool.n_vertex, -1)
    at_end[tool.edges] = np.arange(tool.n_edge)[:, None]
    segment = np.concatenate([np.where(bow.tip[vertex], at_end[vertex], -1), segments])
    on_edge = segment >= 0
    radius, arc = np.append(bow.radius, np.inf)[segment], np.append(bow.arc, -1)[segment]
    radius[is_tip] = 0.0
    # Cutting edges turn the most; of these the more the more they are bowed.
    sharpness = np.concatenate([turn_at_vertex, turns])
    with np.errstate(divide="ignore"):
        sharpness[on_edge] = np.pi + 1.0 / radius[on_edge]
    closest = np.full(len(place), CLOSEST * edge_length)
    bowed = np.isfinite(radius) & ~is_tip
    closest[bowed] = np.minimum(closest[bowed], np.sqrt(2.0 * radius[bowed] * depth))
    kept = _spread(place, sharpness, closest)
    return ToolPoints(
        place=np.ascontiguousarray(place[kept]),
        outward=np.ascontiguousarray(outward[kept]),
        tooth=np.ascontiguousarray(tooth[kept]),
        segment=np.ascontiguousarray(segment[kept]),
        radius=np.ascontiguousarray(radius[kept]),
        arc=np.ascontiguousarray(arc[kept]),
        share=_shares(place[kept], outward[kept], edge_length),
    )


def _corners(tool: Tool, surface: Surface, tip: Bools, on_cut: Bools) -> tuple[Ints, Floats]:
    """Return the vertices that push, and their largest turn of an edge.

    tip, on_cut : (n_vertex,), whether a tip of a cutting edge, or on one.
    """
    lo, hi, turn = surface.lo, surface.hi, surface.turn
    least, most = np.full(tool.n_vertex, np.inf), np.full(tool.n_vertex, -np.inf)
    for ends in (lo, hi):
        np.minimum.at(least, ends, turn)
        np.maximum.at(most, ends, turn)
    corners = tool.vertices[tool.triangles]
    to_next, to_last = (np.roll(corners, -k, axis=1) - corners for k in (1, 2))
    around = np.zeros(tool.n_vertex)
    np.add.at(around, tool.triangles, angles(to_next, to_last))
    convex = (least > _CONCAVE - _HOLLOW * most) & (2.0 * np.pi - around > _PEAKED)
    pushes = np.flatnonzero((convex & ~on_cut) | tip)
    return pushes, most[pushes]


def _along_edges(
    tool: Tool, surface: Surface, on_cut: Bools, spacing: float
) -> tuple[Floats, Floats, Floats, Ints, Ints]:
    """Return points along the cutting edges and the other convex edges, both ends included.

    Their places, normals, turns (pi at cutting edges), teeth and segments.
    """
    cut = np.sort(tool.edges, axis=1)
    segment_of = np.full(len(surface.keys), -1)
    segment_of[np.searchsorted(surface.keys, cut[:, 0] * tool.n_vertex + cut[:, 1])] = np.arange(
        tool.n_edge
    )
    turn = np.where(segment_of >= 0, np.pi, surface.turn)
    rows = np.flatnonzero(turn > LEAST_TURN)
    start, end = tool.vertices[surface.lo[rows]], tool.vertices[surface.hi[rows]]
    lengths = np.linalg.norm(end - start, axis=1)
    if not lengths.sum() / spacing <= _MOST_POINTS:
        raise ValueError(
            f"the edges of the tool must need {_MOST_POINTS:,} contact points at most, got "
            f"{lengths.sum():.4g} mm of edges with a point every {spacing:.3g} mm, which follows "
            "from the size of the quads: is the unit of film or tool wrong? Enlarge the quads, or "
            "shorten the tool"
        )
    pieces = np.maximum(np.ceil(lengths / spacing), 1).astype(int)
    of = np.repeat(np.arange(len(rows)), pieces + 1)
    first = np.cumsum(pieces + 1) - (pieces + 1)
    share = (np.arange(len(of)) - first[of]) / pieces[of]
    # Of other edges not the ends that lie on a cutting edge.
    other = segment_of[rows][of] < 0
    inner = ~((share == 0.0) & on_cut[surface.lo[rows]][of] & other)
    inner &= ~((share == 1.0) & on_cut[surface.hi[rows]][of] & other)
    of, share = of[inner], share[inner, None]
    normal = unit(surface.normals[surface.forward[rows]] + surface.normals[surface.backward[rows]])
    return (
        (1.0 - share) * start[of] + share * end[of],
        normal[of],
        turn[rows][of],
        tool.triangle_tooth[surface.forward[rows]][of],
        segment_of[rows][of],
    )


def _shares(place: Floats, outward: Floats, reach: float) -> Floats:
    """Return one over the number of points at each that may press on a node of the film together.

    A point at a distance counts 1 - distance / reach, as the shape function of the node between
    them decreases; points that face another direction press on other film, or not at all.
    """
    crowd = np.ones(len(place))
    if len(place) > 1:
        pairs = scipy.spatial.cKDTree(place).query_pairs(reach, output_type="ndarray")
        a, b = pairs[np.lexsort(pairs.T[::-1])].T
        weight = 1.0 - np.linalg.norm(place[a] - place[b], axis=1) / reach
        weight *= (outward[a] * outward[b]).sum(axis=1) > _SAME_DIRECTION
        np.add.at(crowd, a, weight)
        np.add.at(crowd, b, weight)
    return np.asarray(1.0 / crowd)


def _spread(place: Floats, sharpness: Floats, closest: Floats) -> Ints:
    """Return which points to keep: the sharper first, and none close to a point kept before it.

    place : (n, 3).  closest : (n,), how far each must be from those [mm].
    """
    if not len(place):
        return np.zeros(0, np.int64)
    tree = scipy.spatial.cKDTree(place)
    kept = np.zeros(len(place), np.bool_)
    # Rounded, so that round-off does not choose between equal points.
    for k in np.lexsort((np.arange(len(place)), -np.round(sharpness, 6))).tolist():
        kept[k] = not kept[tree.query_ball_point(place[k], closest[k])].any()
    return np.flatnonzero(kept)
