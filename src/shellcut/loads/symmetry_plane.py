"""Put the directors of nodes on a symmetry plane into it.

The film of a half model continues beyond its symmetry plane, mirrored. The director of a node on
the plane is the mean normal of the quads on both sides; the mean over one side only leans out of
the plane by half the angle between the two. That lean is an artefact: it vanishes with the quads'
size, but until then the film has a crease along the plane.

A sum of vectors and their mirror images is twice their part in the plane. So the director projected
onto the plane and normalised is that of the whole model, and the half model gives the results of
the whole, to round-off. Where two planes meet, both normal parts are removed.

A support represents a symmetry plane if it supports exactly the components of
:meth:`Support.symmetry` and the film ends there: at a border node whose quads all lie on one side.
Nodes with other supports, clamped or hinged, keep their directors. So do those whose director leans
by more than 30°: mirrored, the film would have a fold of more than 60°, which a mesh of the whole
may not have (``max_fold_deg``). Such a support is a guide, or the film lies in the plane.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from shellcut.arrays import Bools, unit
from shellcut.mesh.mesh import Mesh

from .supports import Support, choose_nodes

_LARGEST_LEAN = math.sin(math.radians(30.0))

# Fraction of their size by which a node's quads may reach across the plane: coordinates in text
# files have seven digits.
_ACROSS = 1e-6


def put_directors_into_planes(mesh: Mesh, supports: Sequence[Support]) -> Mesh:
    """Return the mesh with the directors of nodes on symmetry planes in these planes.

    The mesh itself, if they already are; ValueError if a set of nodes is unknown.
    """
    leaning = np.zeros((mesh.n_node, 3), np.bool_)
    for support in supports:
        if support.mirror is not None:
            leaning[choose_nodes(mesh, support.nodes), support.mirror] = True
    leaning &= (mesh.directors != 0.0) & (np.abs(mesh.directors) <= _LARGEST_LEAN)
    if leaning.any():
        leaning &= _ends_at_node(mesh)
    if not leaning.any():
        return mesh
    nodes = leaning.any(axis=1)
    directors = mesh.directors.copy()
    inside = np.where(leaning[nodes], 0.0, directors[nodes])
    directors[nodes] = unit(inside)
    return replace(mesh, directors=directors)


def _ends_at_node(mesh: Mesh) -> Bools:
    """Return whether a node's quads lie on one side of the plane normal to an axis, (n_node, 3)."""
    corners = mesh.nodes[mesh.quads]
    low, high = np.full((2, mesh.n_node, 3), mesh.nodes)
    for a in range(4):
        np.minimum.at(low, mesh.quads[:, a], corners.min(axis=1))
        np.maximum.at(high, mesh.quads[:, a], corners.max(axis=1))
    across = _ACROSS * (high - low).max(axis=1, keepdims=True)
    ends: Bools = (low >= mesh.nodes - across) | (high <= mesh.nodes + across)
    inner = np.ones(mesh.n_node, np.bool_)
    inner[mesh.boundary_nodes()] = False
    ends[inner] = False
    return ends
