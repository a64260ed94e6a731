"""Copies of cut quads in the blocks: a copy is its whole quad times its share.

A crack that crosses a quad replaces it by copies that hold a share w of it each. Energy, forces,
damping, mass and inertia of a copy are those of the *whole* quad, at the copy's own nodes, times w
([Song2006]). At the cut all copies move as the quad did, and the shares sum to one, so that
nothing changes: neither strain energy nor forces, nor mass, momentum or angular momentum of the
film. Where stiffness and mass of a copy scale alike, its largest frequency is that of the quad,
however small the share; a sliver gets more mass than that (:mod:`shellcut.fracture.cut_state`).

For the kernels a copy is one more quad of the general kind, with a stiffness times w, also where
the whole quad was flat. Copies stand in blocks of their own after all others; they are taken last,
in one strip on one thread, so that a node receives its forces in an order that does not depend on
the number of threads. The place of the whole quad is left empty: it repeats the quad with a
stiffness of zero.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shellcut.arrays import Floats, Ints, Numbers
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.lanes import aligned_zeros

from .blocks import QuadBlocks
from .element import N_FLAT_PRODUCT
from .quad_strains import LinearTables
from .tangent import quad_products
from .thickness_points import PointTables, full_frames

MORE_BLOCKS = 8
"""Blocks by which the place for copies grows at least; it grows by half, too."""


def with_more_blocks(array: Numbers, n: int) -> Numbers:
    """Return an array of blocks with n blocks of zeros after them."""
    grown: Floats = aligned_zeros((array.shape[0] + n, *array.shape[1:]), array.dtype)
    grown[: array.shape[0]] = array
    return grown


def grow_blocks(blocks: QuadBlocks, n: int) -> QuadBlocks:
    """Return blocks with n more that nothing fills yet."""
    return replace(
        blocks,
        quad=with_more_blocks(blocks.quad, n),
        filled=with_more_blocks(blocks.filled, n),
        corner=with_more_blocks(blocks.corner, n),
        chain=with_more_blocks(blocks.chain, n),
    )


def grow_tables(
    linear: LinearTables, points: PointTables, n: int
) -> tuple[LinearTables, PointTables]:
    """Return tables with n more blocks of quads of the general kind, without stiffness."""
    linear = linear._replace(
        full_reference=with_more_blocks(linear.full_reference, n),
        full_stiffness=with_more_blocks(linear.full_stiffness, n),
    )
    if points.rule.place.size:
        points = points._replace(full_frame=with_more_blocks(points.full_frame, n))
    if points.axes.size:
        points = points._replace(axes=with_more_blocks(points.axes, n))
    return linear, points


def empty_place(slot: int, blocks: QuadBlocks, linear: LinearTables, points: PointTables) -> None:
    """Take the stiffness from the quad at a place; it goes on repeating a quad."""
    b, lane = divmod(slot, blocks.width)
    blocks.filled[b, lane] = False
    has_points = bool(points.rule.place.size)
    if b < linear.n_flat:
        linear.flat[b, N_FLAT_PRODUCT:, lane] = 0.0
        if has_points:
            points.flat_frame[b, :, lane] = 0.0
    else:
        linear.full_stiffness[b - linear.n_flat, :, lane] = 0.0
        if has_points:
            points.full_frame[b - linear.n_flat, :, lane] = 0.0


def fill_place(
    slot: int,
    parent: int,
    share: float,
    stiffness: Floats,
    mesh: Mesh,
    blocks: QuadBlocks,
    linear: LinearTables,
    points: PointTables,
) -> None:
    """Put a copy at a place: what does not change of its whole quad, the stiffness times w.

    Parameters
    ----------
    slot : int
        The place, width block + lane, among those for copies.
    parent : int
        Quad of the mesh.
    share : float
        w.
    stiffness : ndarray, shape (136,)
        Of the whole quad (:func:`.section.full_stiffness`).
    mesh : Mesh
        Reference surface.
    blocks, linear, points : QuadBlocks, LinearTables, PointTables
        Written.
    """
    b, lane = divmod(slot, blocks.width)
    at = b - linear.n_flat
    nodes = mesh.quads[parent]
    blocks.filled[b, lane] = True
    X, T = mesh.nodes[nodes][None], mesh.directors[nodes][None]
    linear.full_reference[at, :, lane] = quad_products(X, T)[0]
    linear.full_stiffness[at, :, lane] = share * stiffness
    if points.rule.place.size:
        frames = full_frames(X, T, points.rule).reshape(4, points.rule.place.size, -1).copy()
        frames[..., -1] *= share  # the volume that a point stands for
        points.full_frame[at, :, lane] = frames.ravel()
