"""Build the constant tables of the quads in blocks: products, stiffness, frames."""

from __future__ import annotations

import numpy as np

from shellcut.arrays import Floats
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.lanes import aligned_zeros

from .blocks import QuadBlocks
from .element import N_FLAT, N_FLAT_PRODUCT, N_FULL, N_STRAIN, FlatModuli
from .film_axes import N_AXES, film_axes
from .quad_strains import LinearTables
from .section import flat_moduli, flat_stiffness, full_stiffness
from .tangent import quad_products
from .thickness_points import (
    N_FLAT_FRAME,
    N_FULL_FRAME,
    PointTables,
    build_rule,
    flat_frames,
    full_frames,
)

BLOCKS_AT_A_TIME = 512
"""Number of blocks whose tables are built at a time: temporaries stay small beside the film's
tables."""


def build_tables(
    mesh: Mesh, material: ShellMaterial, blocks: QuadBlocks
) -> tuple[LinearTables, PointTables]:
    """Build the constant tables of the quads in blocks."""
    n_flat, n_block = blocks.n_flat, blocks.quad.shape[0]
    n_full = n_block - n_flat
    rule = build_rule(material)
    n_point = rule.place.size

    def table(n_block: int, n: int) -> Floats:
        return np.asarray(aligned_zeros((n_block, n, blocks.width)))

    linear = LinearTables(
        n_flat,
        table(n_flat, N_FLAT),
        flat_moduli(material) if n_flat else FlatModuli(0.0, 0.0, 0.0),
        table(n_full, N_STRAIN),
        table(n_full, N_FULL),
    )
    points = PointTables(
        table(n_flat if n_point else 0, 4 * N_FLAT_FRAME),
        table(n_full if n_point else 0, 4 * n_point * N_FULL_FRAME),
        table(n_block if material.has_axes else 0, N_AXES),
        rule,
    )
    for first in range(0, n_block, BLOCKS_AT_A_TIME):
        for start, stop, flat in (
            (first, min(first + BLOCKS_AT_A_TIME, n_flat), True),
            (max(first, n_flat), min(first + BLOCKS_AT_A_TIME, n_block), False),
        ):
            if start >= stop:
                continue
            quads = mesh.quads[blocks.quad[start:stop].ravel()]
            X, T = mesh.nodes[quads], mesh.directors[quads]

            def fill(
                table: Floats,
                rows: Floats,
                start: int = start,
                stop: int = stop,
                first: int = 0 if flat else n_flat,
            ) -> None:
                some = slice(start - first, stop - first)
                table[some] = rows.reshape(stop - start, blocks.width, -1).transpose(0, 2, 1)

            products = quad_products(X, T)
            # Places that repeat a quad get zero stiffness.
            filled = blocks.filled[start:stop].reshape(-1, 1)
            if flat:
                fill(linear.flat[:, :N_FLAT_PRODUCT], products[:, :N_FLAT_PRODUCT])
                fill(linear.flat[:, N_FLAT_PRODUCT:], filled * flat_stiffness(X, T, material))
            else:
                fill(linear.full_reference, products)
                fill(linear.full_stiffness, filled * full_stiffness(X, T, material))
            if n_point:
                frames = flat_frames(X, T) if flat else full_frames(X, T, rule)
                fill(points.flat_frame if flat else points.full_frame, filled * frames)
            if material.has_axes:
                fill(points.axes, film_axes(X, T, material), first=0)
    return linear, points
