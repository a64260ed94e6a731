"""Points of the tool that push the film between its nodes: corners, edges and rounds.

The nodes of the film feel the faces of the tool. What protrudes from these between the nodes would
pass through the film. So points of the tool push:

- the convex corners of the surface, also those of a ball with wide facets;
- points along convex edges that turn by more than ``LEAST_TURN``, no farther apart than half an
  edge length of the film. Such an edge protrudes by ``LEAST_TURN`` / 4 of the nodes' distance;
- points between the facets of a round that protrudes as much (:mod:`shellcut.tool.surface_bend`),
  however little it turns from facet to facet: wires, balls, rounded edges.

Where they are closer than 0.4 of an edge length some are left out; the sharper points stay. On a
round none is left out that protrudes by as much between those that stay.

*Cutting edges* push like all others: the film on whose face they come down carries them until it
is pierced (:mod:`shellcut.fracture.pierce`). Their tips (:mod:`shellcut.tool.edge_bow`) are never
left out. On an arc the points are so close that none of the arc protrudes between two of them by
more than the depth over which the contact sets in.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
import scipy

from shellcut.arrays import Bools, Floats, Ints, angles, norm, unit
from shellcut.tool.closest_triangles import ClosestTriangleGrid
from shellcut.tool.edge_bow import FACET, LEAST_TURN, EdgeBow
from shellcut.tool.surface import Surface
from shellcut.tool.surface_bend import bends
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

# Turn of an edge below which it lies in a plane face; round-off of single precision is less.
_FLAT = 1e-3

# Largest turn between facets of a round. Round-off does not decide of 12 or 36 facets around a bar.
_ROUND_OFF = 1e-6
_ROUND = FACET + _ROUND_OFF

# Where the bend at an end of an edge is evaluated, over its length.
_AT_END = 0.01


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
    bow = EdgeBow.of(tool)
    found = _candidates(tool, bow.tip, edge_length)
    on_edge, is_tip = found.segment >= 0, found.is_tip
    radius = np.append(bow.radius, np.inf)[found.segment]
    arc = np.append(bow.arc, -1)[found.segment]
    radius[is_tip] = 0.0
    # Cutting edges turn the most; of these the more the more they are bowed.
    sharpness = found.turn.copy()
    with np.errstate(divide="ignore"):
        sharpness[on_edge] = np.pi + 1.0 / radius[on_edge]
    closest = np.full(len(radius), CLOSEST * edge_length)
    bowed = np.isfinite(radius) & ~is_tip
    closest[bowed] = np.minimum(closest[bowed], np.sqrt(2.0 * radius[bowed] * depth))
    kept = _spread(found, sharpness, closest, edge_length)
    place, outward = found.place[kept], found.outward[kept]
    return ToolPoints(
        place=place,
        outward=outward,
        tooth=found.tooth[kept],
        segment=found.segment[kept],
        radius=radius[kept],
        arc=arc[kept],
        share=_shares(place, outward, edge_length),
    )


class _Candidates(NamedTuple):
    """Points of a tool of which those push that are not too close to others."""

    place: Floats
    """Shape (n, 3) [mm]."""
    outward: Floats
    """Unit vectors, shape (n, 3)."""
    tooth: Ints
    """Shape (n,)."""
    segment: Ints
    """Cutting segment, -1 for none, shape (n,)."""
    turn: Floats
    """Largest turn of an edge there, or bend of the surface, pi on cutting edges [rad]."""
    is_tip: Bools
    """Whether it is a tip of a cutting edge."""
    on_round: Bools
    """Whether it is between facets of a round."""


def _candidates(tool: Tool, tip: Bools, edge_length: float) -> _Candidates:
    """Return the corners that push, and points along the edges that do.

    tip : (n_vertex,), whether a tip of a cutting edge.
    """
    surface = Surface(tool.vertices, tool.triangles)
    cut = np.sort(tool.edges, axis=1)
    segment_of = np.full(len(surface.keys), -1)
    rows = np.searchsorted(surface.keys, cut[:, 0] * tool.n_vertex + cut[:, 1])
    segment_of[rows] = np.arange(tool.n_edge)
    turn = np.where(segment_of >= 0, np.pi, surface.turn)
    edge, share, places, turns = _along_edges(surface, turn, SPACING * edge_length)
    vertex = np.where(share == 0.0, surface.lo[edge], np.where(share == 1.0, surface.hi[edge], -1))
    most = np.zeros(tool.n_vertex)
    np.maximum.at(most, vertex[vertex >= 0], turns[vertex >= 0])
    on_cut = np.zeros(tool.n_vertex, np.bool_)
    on_cut[tool.edges] = True
    corner, largest = _corners(tool, surface, tip, on_cut, most)
    # Of other edges not the ends that lie on a cutting edge.
    inner = (segment_of[edge] >= 0) | (vertex < 0) | ~on_cut[vertex]
    edge = edge[inner]
    at_vertex = np.zeros_like(tool.vertices)
    at_vertex[tool.triangles] = ClosestTriangleGrid.of(tool).arrays.surface.pseudo_normals[:, 1:4]
    tooth_of, at_end = np.zeros(tool.n_vertex, np.int64), np.full(tool.n_vertex, -1)
    tooth_of[tool.triangles] = tool.triangle_tooth[:, None]
    at_end[tool.edges] = np.arange(tool.n_edge)[:, None]
    outward = surface.normals[surface.forward[edge]] + surface.normals[surface.backward[edge]]
    corners = (
        tool.vertices[corner],
        unit(at_vertex[corner]),
        tooth_of[corner],
        np.where(tip[corner], at_end[corner], -1),
        np.maximum(most[corner], largest),
        tip[corner],
        ~tip[corner] & (largest <= _ROUND),
    )
    on_edges = (
        places[inner],
        unit(outward),
        tool.triangle_tooth[surface.forward[edge]],
        segment_of[edge],
        turns[inner],
        np.zeros(len(edge), np.bool_),
        turn[edge] <= _ROUND,
    )
    return _Candidates(*(np.concatenate(parts) for parts in zip(corners, on_edges, strict=True)))


def _corners(
    tool: Tool, surface: Surface, tip: Bools, on_cut: Bools, most: Floats
) -> tuple[Ints, Floats]:
    """Return the vertices that push, and their largest turn of an edge.

    tip, on_cut : (n_vertex,), whether a tip of a cutting edge, or on one.  most : (n_vertex,),
    largest turn or bend of the edges that push there, 0 where none does [rad].
    """
    least, largest = np.full(tool.n_vertex, np.inf), np.full(tool.n_vertex, -np.inf)
    for ends in (surface.lo, surface.hi):
        np.minimum.at(least, ends, surface.turn)
        np.maximum.at(largest, ends, surface.turn)
    corners = tool.vertices[tool.triangles]
    to_next, to_last = (np.roll(corners, -k, axis=1) - corners for k in (1, 2))
    around = np.zeros(tool.n_vertex)
    np.add.at(around, tool.triangles, angles(to_next, to_last))
    convex = (least > _CONCAVE - _HOLLOW * largest) & (2.0 * np.pi - around > _PEAKED)
    pushes = np.flatnonzero((convex & ~on_cut) | tip)
    return pushes, largest[pushes]


class _OnEdges(NamedTuple):
    """Places along edges of the tool's surface, both ends included."""

    edge: Ints
    """Row of the edge, shape (n,)."""
    share: Floats
    """Of its length, shape (n,)."""
    place: Floats
    """Shape (n, 3) [mm]."""
    turn: Floats
    """Of the edge, or the bend of the surface there, shape (n,) [rad]."""


def _along_edges(surface: Surface, turn: Floats, spacing: float) -> _OnEdges:
    """Return places that push along convex edges.

    turn : (n_row,), of the surface's edges, pi at cutting edges [rad].
    """
    start, end = surface.vertices[surface.lo], surface.vertices[surface.hi]
    lengths, sharp = norm(end - start), turn > LEAST_TURN + _ROUND_OFF

    def bend(rows: Ints, share: Floats) -> Floats:
        at = start[rows] + share[:, None] * (end - start)[rows]
        return bends(surface, rows, at, spacing, sharp)

    facets = np.flatnonzero(~sharp & (turn > _FLAT))
    at_ends = np.stack([turn, turn])
    for end_turn, part in zip(at_ends, (_AT_END, 1.0 - _AT_END), strict=True):
        # Beside the end, at which several edges meet.
        end_turn[facets] = bend(facets, np.full(len(facets), part))
    # Of a long edge between plane facets, as on a cone, the surface bends most at one of its ends.
    rows = np.flatnonzero(at_ends.max(axis=0) > LEAST_TURN)
    if not lengths[rows].sum() / spacing <= _MOST_POINTS:
        raise ValueError(
            f"the edges of the tool must need {_MOST_POINTS:,} contact points at most, got "
            f"{lengths[rows].sum():.4g} mm of edges with a point every {spacing:.3g} mm, which "
            "follows from the size of the quads: is the unit of film or tool wrong? Enlarge the "
            "quads, or shorten the tool"
        )
    pieces = np.maximum(np.ceil(lengths[rows] / spacing), 1).astype(int)
    of = np.repeat(np.arange(len(rows)), pieces + 1)
    first = np.cumsum(pieces + 1) - (pieces + 1)
    share = (np.arange(len(of)) - first[of]) / pieces[of]
    edge, to = rows[of], share[:, None]
    place = (1.0 - to) * start[edge] + to * end[edge]
    bent = np.where(share < 1.0, at_ends[0, edge], at_ends[1, edge])
    within = np.flatnonzero(~sharp[edge] & (share > 0.0) & (share < 1.0))
    bent[within] = bend(edge[within], share[within])
    found = _OnEdges(edge, share, place, bent)
    pushes = found.turn > LEAST_TURN
    return _OnEdges(*(rows[pushes] for rows in found))


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


def _spread(found: _Candidates, sharpness: Floats, closest: Floats, edge_length: float) -> Ints:
    """Return which points to keep: the sharper first, and none close to a point kept before it.

    closest : (n,), how far each must be from those [mm].
    """
    if not len(closest):
        return np.zeros(0, np.int64)
    place, outward, on_round = found.place, found.outward, found.on_round
    tree = scipy.spatial.cKDTree(place)
    kept, hidden = np.zeros((2, len(place)), np.bool_)
    farthest, between = float(closest.max()), 0.5 * LEAST_TURN * edge_length
    # Rounded, so that round-off does not choose between equal points.
    for k in np.lexsort((np.arange(len(place)), -np.round(sharpness, 6))).tolist():
        if hidden[k]:
            continue
        kept[k] = True
        near = np.array(tree.query_ball_point(place[k], farthest))
        away = norm(place[near] - place[k])
        hides = away <= closest[near]
        # An arc of the chord d on which the normal turns by a is d a / 8 high. The next point may
        # be twice as far, and four times as high.
        apart = away * norm(outward[near] - outward[k]) > between
        hidden[near[hides & ~(apart & on_round[near] & on_round[k])]] = True
    return np.flatnonzero(kept)
