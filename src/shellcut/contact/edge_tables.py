"""Tables of the contact of the film's edges with the tool's."""

from __future__ import annotations

from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, SmallInts, unit
from shellcut.tool.rounded_depth import ConvexNeighbours
from shellcut.tool.signed_distance import TriangleGrid
from shellcut.tool.surface import Surface
from shellcut.tool.tool import Tool

from .contact_points import LEAST_TURN, is_cutting
from .contact_tables import Carriers, ContactNodes, Lookups
from .settings import PenaltyLaw

# Over the rounding radius: the line that the round of an edge is centred on is taken no farther
# inside than this. In a solid sharper than 29 deg it lies deeper.
_DEEPEST = 4.0


# Likewise: flat edges between facets count where a chord of the film may lie so deep under them.
_NOTICED = 0.25


def _depth_of_chords(surface: Surface, length: float) -> Floats:
    """Return how deep chords of a length may lie under each edge of a surface, (n_edge,) [mm].

    Under one edge that turns by theta, length theta / 4; under facets of the width w, which turn by
    theta from one to the next, length² theta / (8 w).
    """
    along = surface.vertices[surface.hi] - surface.vertices[surface.lo]
    corners = surface.vertices[surface.triangles]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    twice_area = np.linalg.norm(normal, axis=1)
    both = twice_area[surface.forward] + twice_area[surface.backward]
    width = 0.5 * both / np.linalg.norm(along, axis=1)
    return np.asarray(0.25 * length * surface.turn * np.minimum(1.0, 0.5 * length / width))


class ToolEdges(NamedTuple):
    """Convex edges of the tool that do not cut, in its body frame."""

    start: Annotated[Floats, "(n_edge, 3)"]
    """One end of the line on which the round of the edge is centred [mm]."""
    way: Annotated[Floats, "(n_edge, 3)"]
    """From there to its other end [mm]."""
    reach: Annotated[Floats, "(n_edge,)"]
    """Film that is farther than this from that line is not within the round of the edge [mm]."""
    corner: Annotated[Floats, "(n_edge, 3)"]
    """One end of the edge itself [mm]."""
    along: Annotated[Floats, "(n_edge, 3)"]
    """From there to the other [mm]."""
    normal: Annotated[Floats, "(n_edge, 2, 3)"]
    """Of the faces on both sides, outward."""
    level: Annotated[Floats, "(n_edge, 2)"]
    """Its product with points of the faces [mm]."""
    flank: Annotated[SmallInts, "(n_edge, 2)"]
    """The tool's flank labels on both sides."""
    body: Annotated[Ints, "(n_edge,)"]
    """Tooth."""

    @classmethod
    def of(cls, tool: Tool, rounding: float, film_edge: float) -> ToolEdges:
        """Return the edges of a tool whose convex edges are rounded by a radius [mm].

        film_edge : length of a typical edge of the film [mm].
        """
        surface = Surface(tool.vertices, tool.triangles)
        felt = surface.turn > LEAST_TURN
        felt |= _depth_of_chords(surface, film_edge) > _NOTICED * rounding
        rows = np.flatnonzero(felt & ~is_cutting(tool, surface))
        one, two = surface.forward[rows], surface.backward[rows]
        start, end = tool.vertices[surface.lo[rows]], tool.vertices[surface.hi[rows]]
        normal = np.stack([surface.normals[one], surface.normals[two]], axis=1)
        middle = normal.sum(axis=1)
        # |n_1 + n_2|² = 2 (1 + n_1 n_2): the line that is r deep under both faces.
        middle /= np.maximum(0.5 * (middle**2).sum(axis=1, keepdims=True), 1e-12)
        deep = np.linalg.norm(middle, axis=1)
        taken = np.minimum(deep, _DEEPEST)
        inward = -rounding * middle * (taken / deep)[:, None]
        # At a corner the faces beyond may lie so much farther out.
        along = end - start
        beyond = rounding * unit(along)
        return cls(
            start=np.ascontiguousarray(start + inward - beyond),
            way=np.ascontiguousarray(along + 2.0 * beyond),
            reach=rounding * (1.0 + deep - taken),
            corner=start,
            along=end - start,
            normal=np.ascontiguousarray(normal),
            level=np.einsum("eki,ei->ek", normal, start),
            flank=np.ascontiguousarray(np.column_stack([tool.flank[one], tool.flank[two]])),
            body=tool.triangle_body[one],
        )


class EdgePairs(NamedTuple):
    """Which edges of the tool are near which edge of the film."""

    node: Annotated[Ints, "(n_film, 2)"]
    """Ends of the film's edge."""
    listed: Annotated[Ints, "(n_film, 2)"]
    """Their rows among the nodes near the tool, -1 for none."""
    first: Annotated[Ints, "(n_first,)"]
    """First pair of each, and the end."""
    edge: Annotated[Ints, "(n_pair,)"]
    """Edge of the tool."""
    until: Annotated[Floats, "(n_pair,)"]
    """Way walked from which on the pair may touch [mm]."""
    moving: Annotated[Ints, "(n_moving,)"]
    """Nodes at the ends, ascending."""


class EdgeMemory(NamedTuple):
    """What is kept of each edge of the film."""

    until: Annotated[Floats, "(n_film,)"]
    """Way walked from which on it may touch, and is looked at again [mm]."""
    side: Annotated[Ints, "(n_film,)"]
    """Side of the blade that it keeps while it is deeper than its chord."""
    depth: Annotated[Floats, "(n_film,)"]
    """How much deeper than its chord it goes into the tool [mm]."""
    place: Annotated[Floats, "(n_film,)"]
    """Where that is, from 0 at one end to 1 at the other."""
    offset: Annotated[Floats, "(n_film,)"]
    """Part of that which does not press [mm]."""
    stored: Annotated[Floats, "(n_film,)"]
    """Penalty energy [N·mm]."""
    force: Annotated[Floats, "(n_film, 2, 3)"]
    """On its ends [N]."""
    put_in: Annotated[Floats, "(n_film,)"]
    """Work that its contact has got since it presses, see :mod:`.edge_rebound` [N·mm]."""
    follows: Annotated[Ints, "(n_film,)"]
    """What its hill is followed in until all of the tool is searched again, see
    :mod:`.followed_edge`."""
    then: Annotated[Floats, "(n_film, 2, 3)"]
    """Its ends when that was done, in the body frame [mm]."""
    reach: Annotated[Floats, "(n_film,)"]
    """Way of an end from there for which its hill may be followed [mm]."""
    press_place: Annotated[Floats, "(n_film,)"]
    """Where it presses, if it does, from 0 at one end to 1 at the other."""
    drift: Annotated[Floats, "(n_film,)"]
    """By how much that has changed over the last step, 0 if it was looked for anew."""
    body: Annotated[Ints, "(n_film,)"]
    """Tooth on which it presses."""
    normal: Annotated[Floats, "(n_film, 2, 3)"]
    """Outward normals of the faces whose wedge is followed, in the body frame."""
    level: Annotated[Floats, "(n_film, 2)"]
    """Their product with points of the faces [mm]."""
    across: Annotated[Ints, "(n_film,)"]
    """Face beyond the edge around which a place of it was rounded last, -1 for none."""

    @classmethod
    def blank(cls, n: int) -> EdgeMemory:
        """Return that of n edges that touch nothing."""
        return cls(
            until=np.zeros(n),
            side=np.zeros(n, np.int64),
            depth=np.zeros(n),
            place=np.zeros(n),
            offset=np.zeros(n),
            stored=np.zeros(n),
            force=np.zeros((n, 2, 3)),
            put_in=np.zeros(n),
            follows=np.zeros(n, np.int64),
            then=np.zeros((n, 2, 3)),
            reach=np.zeros(n),
            press_place=np.zeros(n),
            drift=np.zeros(n),
            body=np.zeros(n, np.int64),
            normal=np.zeros((n, 2, 3)),
            level=np.zeros((n, 2)),
            across=np.full(n, -1),
        )


class EdgeTables(NamedTuple):
    """Kernel arguments that stay valid until the list is made anew."""

    edges: ToolEdges
    radius: float
    """Of the tool's farthest point, around the body's origin [mm]."""
    grid: TriangleGrid
    around: ConvexNeighbours
    law: PenaltyLaw
    pairs: EdgePairs
    memory: EdgeMemory
    carriers: Carriers
    near: Lookups
    """Of the nodes near the tool."""
    captured: Annotated[Ints, "(n_edge,)"]
    """Room for the tool's edges that one of the film's may touch."""
    across: Annotated[Ints, "(1,)"]
    """``EdgeMemory.across`` of the edge that is looked at."""
    nodes: ContactNodes
