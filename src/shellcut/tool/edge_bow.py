"""How a cutting edge is bowed in its own plane: its tips, its arcs and what is straight.

Film that an edge moves down on meets first what protrudes from the tool: an end of the edge, the
apex where two straight parts meet, the lowest place of an arc. The turn of the edge about the
normal of its mid-plane distinguishes them, towards the solid where the edge protrudes.

A *tip* is a vertex where the edge ends, or where it turns at once. An *arc* is a run of segments
with facets for a curve: at its vertices the edge turns by ``FACET`` at most, and as much, within a
factor of three, as at the next vertex. A single turn of less than ``LEAST_TURN`` is no tip either.
A chord of the length l, at whose ends the edge turns by the mean angle t, is one of a circle of
the radius l / 2 sin(t/2), however fine the facets are.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, each, norm, unit

from .tool import Tool

LEAST_TURN = np.radians(10.0)
"""Edges of a surface, and vertices of a cutting edge, that turn by less lie between facets."""

FACET = np.radians(30.0)
"""Largest turn between two facets of a curve: of twelve for a full circle."""

# Turn below which two segments are one straight line; round-off of single precision is less.
_STRAIGHT = 1e-3

# A vertex whose turn is less than this part of another's is no vertex of the same curve.
_ALIKE = 1.0 / 3.0


class EdgeBow(NamedTuple):
    """Tips and arcs of the cutting edges of a tool."""

    tip: Bools
    """Whether each vertex is a tip, shape (n_vertex,)."""
    radius: Floats
    """Radius of the arc of each segment, inf where it is straight, shape (n_edge,) [mm]."""
    arc: Ints
    """Number of that arc, -1 where it is straight, shape (n_edge,)."""

    @classmethod
    def of(cls, tool: Tool) -> EdgeBow:
        """Return those of a tool.

        Examples
        --------
        >>> from shellcut.tool.shapes import straight_blade
        >>> bow = EdgeBow.of(straight_blade())
        >>> int(bow.tip.sum()), bow.radius.tolist()
        (2, [inf])
        """
        meeting = np.bincount(tool.edges.ravel(), minlength=tool.n_vertex)
        straight, none = np.full(tool.n_edge, np.inf), np.full(tool.n_edge, -1)
        bow = cls((meeting > 0) & (meeting != 2), straight, none)
        for chain in range(tool.n_chain):
            _follow(tool, np.flatnonzero(tool.edge_chain == chain), bow)
        return bow


def _follow(tool: Tool, rows: Ints, bow: EdgeBow) -> None:
    """Write the tips and arcs of one chain.

    rows : its segments, in order.
    """
    ends, normal = tool.edges[rows], tool.edge_normal[rows]
    vector = tool.vertices[ends[:, 1]] - tool.vertices[ends[:, 0]]
    after = np.roll(np.arange(len(rows)), -1)
    closed = len(rows) > 2 and ends[0, 0] == ends[-1, 1]
    along, about = unit(vector), unit(normal + normal[after])
    sine = (np.cross(along, along[after]) * about).sum(axis=1)
    turn = each(math.atan2, sine, (along * along[after]).sum(axis=1))  # at the end of each segment
    bends = np.abs(turn) > _STRAIGHT
    bends[-1] &= closed
    at = np.flatnonzero(bends)  # last segment of every straight part
    if not len(at):
        return
    part = np.searchsorted(at, np.arange(len(rows)))  # of each segment
    n_part = len(at) if closed else len(at) + 1
    part %= n_part
    turn, length = turn[at], np.bincount(part, norm(vector), n_part)
    curved = np.array([_is_facet(turn, k, closed) for k in range(len(at))])
    bow.tip[ends[at[(turn > LEAST_TURN) & ~curved], 1]] = True
    # Vertex k lies between the parts k and k + 1.
    total, count = np.zeros(n_part), np.zeros(n_part)
    joined = np.arange(n_part)
    for k in np.flatnonzero(curved).tolist():
        both = [k, (k + 1) % n_part]
        total[both] += turn[k]
        count[both] += 1.0
        joined[joined == joined[both[1]]] = joined[k]
    mean = total / np.maximum(count, 1.0)
    bowed = (count > 0.0)[part]
    bow.radius[rows[bowed]] = (length / (2.0 * each(math.sin, 0.5 * np.maximum(mean, _STRAIGHT))))[
        part[bowed]
    ]
    bow.arc[rows[bowed]] = rows[0] + joined[part[bowed]]


def _is_facet(turn: Floats, k: int, closed: bool) -> bool:
    """Return whether the vertex k of a chain lies between two facets of a curve.

    turn : at the vertices where the chain turns at all, in order.
    """
    if not 0.0 < turn[k] <= FACET:
        return False
    if turn[k] <= LEAST_TURN:
        return True
    n = len(turn)
    for step in (-1, 1):
        others = range(k + step, k + step * n, step)
        around = (i % n for i in others if closed or 0 <= i < n)
        like = next((i for i in around if abs(turn[i]) > _ALIKE * turn[k]), None)
        if like is not None and 0.0 < turn[like] <= FACET:
            return True
    return False
