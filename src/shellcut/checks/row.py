"""The row of mesh edges under the path of the cutting edges.

A row lies under a path if its nodes do, to ``ON_ROW`` edge lengths. Between two nodes the path
bulges off the edge: by k t (l - t) / 2 at t from an end of an edge of length l, if it turns by k l
along it. That turn is the one of the row at the edge's ends. Where the path ends, the row goes on
along the edge that turns least, so that a path of one edge is judged as the longer one.
"""

from __future__ import annotations

import math
from functools import cached_property

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, norm, off_segments, product, unit
from shellcut.mesh.mesh import Mesh
from shellcut.mesh.quad_geometry import corner_normals, first_at_place

from .sweep import Sweep

ALONG_ROW = math.cos(math.radians(30.0))
"""Least cosine between the path and a side that runs along it."""
AT_ROW = 0.5
"""A side farther off than this, in edge lengths, is not the one that the blade follows."""
ON_ROW = 5e-3
"""Largest distance of a row that lies under the path, in edge lengths: 0.05 of them raise the
force by 3.5 %."""


class Rows:
    """Sides of the crossed quads along the blade's path, one per place of a sweep."""

    def __init__(self, sweep: Sweep) -> None:
        self._mesh = mesh = sweep.mesh
        corner = mesh.nodes[mesh.quads[sweep.quad]]
        side = np.roll(corner, -1, axis=1) - corner
        length = np.linalg.norm(side, axis=2)
        trace = np.cross(corner_normals(corner), sweep.normal)
        trace /= np.maximum(np.linalg.norm(trace, axis=1, keepdims=True), 1e-12)
        along = np.abs((side * trace[:, None]).sum(axis=2)) / length >= ALONG_ROW
        gap, share = off_segments(sweep.place[:, None], corner, side)
        off = np.where(along, norm(gap), np.inf)
        best = off.argmin(axis=1)
        at = np.arange(len(best))
        self.off: Floats = off[at, best] / sweep.edge_length
        """Distance of the nearest row, in edge lengths; infinite if none runs along the blade,
        shape (n_place,)."""
        ends = mesh.quads[sweep.quad]
        self.ends: Ints = np.stack([ends[at, best], ends[at, (best + 1) % 4]], axis=1)
        """Nodes of the side, shape (n_place, 2)."""
        self.share: Floats = share[at, best]
        """Where the place is along the side, from 0 to 1, shape (n_place,)."""
        edges = mesh.edges()  # flanks: two sides of the rim at one place, as a cut leaves them
        single = edges.nodes[edges.n_quad == 1]
        spot = first_at_place(mesh.nodes, np.unique(single))
        keys, count = np.unique(_keys(mesh, spot[single]), return_counts=True)
        of_cut = np.isin(_keys(mesh, spot[self.ends]), keys[count > 1])
        self.open: Bools = of_cut & (self.off <= AT_ROW)
        """Whether the side was cut before the run, or joins doubled nodes, shape (n_place,)."""
        found = length[at, best][np.isfinite(self.off)]
        self.spacing = float(np.median(found if len(found) else sweep.edge_length))
        """Node spacing along the path [mm]."""

    @cached_property
    def bulge(self) -> Floats:
        """How far a path through the row's nodes lies off its sides, in edges, shape (n_place,)."""
        sides = np.unique(np.sort(self.ends, axis=1), axis=0)
        away = unit(np.diff(self._mesh.nodes[sides], axis=1)[:, 0])
        total = np.zeros((self._mesh.n_node, 3))
        np.add.at(total, sides[:, 0], away)
        np.add.at(total, sides[:, 1], -away)
        within = np.bincount(sides.ravel(), minlength=self._mesh.n_node) % 2 == 0
        turn = np.where(within, np.linalg.norm(total, axis=1), 0.0)
        ends = np.flatnonzero(~within)
        turn[ends] = self._turn_beyond(ends, unit(total[ends]))
        return np.asarray(0.5 * turn[self.ends].max(axis=1) * self.share * (1.0 - self.share))

    def _turn_beyond(self, ends: Ints, inward: Floats) -> Floats:
        """Return by how much the row turns at its end nodes, 0 where no edge goes on, shape (n,).

        inward : unit vectors from there along the last edge, shape (n, 3).
        """
        pairs = self._mesh.edges().nodes
        pairs = np.concatenate([pairs, pairs[:, ::-1]])
        row = np.full(self._mesh.n_node, -1)
        row[ends] = np.arange(len(ends))
        pairs = pairs[row[pairs[:, 0]] >= 0]
        at, way = row[pairs[:, 0]], unit(np.diff(self._mesh.nodes[pairs], axis=1)[:, 0])
        goes_on = -(way * inward[at]).sum(axis=1) >= ALONG_ROW
        least = np.full(len(ends), np.inf)
        np.minimum.at(least, at[goes_on], norm(way + inward[at])[goes_on])
        return np.where(np.isinf(least), 0.0, least)


def lies_under(sweep: Sweep) -> bool:
    """Return whether a row of inner edges lies under the whole path, in a flat film."""
    if not (sweep.flat and len(sweep.place)):
        return False
    rows = Rows(sweep)
    edges = sweep.mesh.edges()
    inner = edges.nodes[edges.n_quad == 2]
    keys = _keys(sweep.mesh, rows.ends)
    return bool(
        (rows.off <= ON_ROW + rows.bulge).all() and np.isin(keys, _keys(sweep.mesh, inner)).all()
    )


def row_of(sweep: Sweep, chain: int) -> Ints:
    """Return the nodes of the row under one cutting edge, in the order it meets them, shape (n,).

    The edges of the tool follow a row, :func:`lies_under`.
    """
    mine = sweep.chain == chain
    ends = Rows(sweep).ends[mine]
    _, first = np.unique(_keys(sweep.mesh, ends), return_index=True)
    sides = ends[np.sort(first)]
    if len(sides) == 1:
        way = sweep.place[mine][-1] - sweep.place[mine][0]
        tail, head = sides[0]
        forward = product(sweep.mesh.nodes[head] - sweep.mesh.nodes[tail], way) >= 0.0
        return np.asarray(sides[0] if forward else sides[0, ::-1])
    start = sides[0, 0] if sides[0, 0] not in sides[1] else sides[0, 1]
    row = [int(start)]
    for side in sides.tolist():
        if row[-1] not in side:
            break
        row.append(side[1] if side[0] == row[-1] else side[0])
    return np.array(row)


def _keys(mesh: Mesh, ends: Ints) -> Ints:
    """Return one number per pair of nodes, shape (n,), in whichever order they stand."""
    return np.asarray(product(np.sort(ends, axis=1), [mesh.n_node, 1]))
