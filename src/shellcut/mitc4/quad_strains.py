"""Tables of all quads for the kernels, and the sixteen strains of a block of quads."""

from __future__ import annotations

from typing import Annotated, NamedTuple

from shellcut.arrays import Bools, Floats, Number, SmallIds
from shellcut.numerics.jit import always_inline
from shellcut.numerics.lane_instructions import Lane
from shellcut.numerics.lanes import pick_all, scatter_add

from .element import (
    N_STRAIN,
    FlatModuli,
    Modes,
    Sixteen,
    chain_modes,
    flat_resultants,
    full_resultants,
    nodal_forces,
    products,
    quad_modes,
)
from .thickness_points import PointTables


class LinearTables(NamedTuple):
    """Constant data of the quads, in blocks: flat quads first."""

    n_flat: int
    """Number of blocks of flat quads."""
    flat: Annotated[Floats, "(n_flat, 10, width)"]
    """The first six products on the reference surface (the others vanish) and four stiffnesses, see
    :func:`shellcut.mitc4.element.flat_resultants`."""
    flat_moduli: FlatModuli
    """Constants shared by all flat quads."""
    full_reference: Annotated[Floats, "(n_full, 16, width)"]
    """The products on the reference surface."""
    full_stiffness: Annotated[Floats, "(n_full, 136, width)"]


class Quads(NamedTuple):
    """Nodes and tables of all quads, until the next split."""

    x: Annotated[Floats, "(n_node, 3)"]
    """Positions [mm]."""
    t: Annotated[Floats, "(n_node, 3)"]
    """Directors."""
    corner: Annotated[SmallIds, "(n_block, 4, width)"]
    """Node ids, and"""
    chain: Annotated[Bools, "(n_block,)"]
    """whether they follow each other, of :class:`shellcut.mitc4.blocks.QuadBlocks`."""
    tables: LinearTables


class PointQuads(NamedTuple):
    """The same for quads with thickness points."""

    quads: Quads
    points: PointTables


class QuadStep(NamedTuple):
    """Data of the step to t_n for the kernels."""

    damped: bool
    rho: float
    """beta / dt."""
    last: Annotated[Floats, "(n_block, 16, width)"]
    """s_{n-1}."""
    before: Annotated[Floats, "(n_block, 16, width)"]
    """s_{n-2}; the force kernels replace it by s_n."""
    history: Annotated[Floats, "(n_block, n_history, width)"]
    """History of the thickness points, 4 n_point numbers of each kind; updated from t_{n-1} to
    t_n."""
    dt: float
    """Length of the step [s]."""


@always_inline
def modes_of(quads: Quads, b: int, lane: Lane) -> tuple[Modes, Modes]:
    """Return the modes of positions and directors of a block."""
    if quads.chain[b]:
        return chain_modes(quads.x, quads.t, quads.corner, b, lane)
    return quad_modes(quads.x, quads.t, quads.corner, b, lane)


@always_inline
def one_quad(quads: Quads, slot: int) -> tuple[int, int, bool, tuple[Modes, Modes], Sixteen]:
    """Return block, lane, whether it is flat, modes and strains of the quad at a place."""
    width = quads.corner.shape[2]
    b, lane = slot // width, slot % width
    flat = b < quads.tables.n_flat
    modes = quad_modes(quads.x, quads.t, quads.corner, b, lane)
    return b, lane, flat, modes, strain_of(quads.tables, flat, b, lane, modes)


@always_inline
def strain_of(
    tables: LinearTables, flat: bool, b: int, lane: Lane, modes: tuple[Modes, Modes]
) -> Sixteen:
    """Return the strains of a block."""
    m = products(*modes)
    if flat:
        # Products with directors vanish on a flat reference: six of sixteen to subtract.
        ref = pick_all(tables.flat, b, 0, 6, lane)
        membrane = (
            m[0] - ref[0],
            m[1] - ref[1],
            m[2] - ref[2],
            m[3] - ref[3],
            m[4] - ref[4],
            m[5] - ref[5],
        )
        return membrane + m[6:16]
    return minus(m, pick_all(tables.full_reference, b - tables.n_flat, 0, N_STRAIN, lane))


@always_inline
def stiffness_product(
    tables: LinearTables, flat: bool, b: int, lane: Lane, u: Sixteen, work: Floats
) -> Sixteen:
    """Return H u; work : (2, 16, width) is overwritten."""
    if flat:
        return flat_resultants(tables.flat, tables.flat_moduli, b, lane, u)
    return full_resultants(tables.full_stiffness, b - tables.n_flat, lane, u, work)


@always_inline
def minus(a: Sixteen, b: Sixteen) -> Sixteen:
    """Return a - b."""
    return plus_scaled(a, -1.0, b)


@always_inline
def plus_scaled(a: Sixteen, k: float, b: Sixteen) -> Sixteen:
    """Return a + k b."""
    return (
        a[0] + k * b[0],
        a[1] + k * b[1],
        a[2] + k * b[2],
        a[3] + k * b[3],
        a[4] + k * b[4],
        a[5] + k * b[5],
        a[6] + k * b[6],
        a[7] + k * b[7],
        a[8] + k * b[8],
        a[9] + k * b[9],
        a[10] + k * b[10],
        a[11] + k * b[11],
        a[12] + k * b[12],
        a[13] + k * b[13],
        a[14] + k * b[14],
        a[15] + k * b[15],
    )


@always_inline
def dot16(a: Sixteen, b: Sixteen) -> Number:
    """Return a · b in four short sums: one long sum would be a chain of dependent additions."""
    return (
        (a[0] * b[0] + a[1] * b[1] + a[2] * b[2] + a[3] * b[3])
        + (a[4] * b[4] + a[5] * b[5] + a[6] * b[6] + a[7] * b[7])
    ) + (
        (a[8] * b[8] + a[9] * b[9] + a[10] * b[10] + a[11] * b[11])
        + (a[12] * b[12] + a[13] * b[13] + a[14] * b[14] + a[15] * b[15])
    )


@always_inline
def add_to_nodes(
    rows: Floats, corner: SmallIds, b: int, lane: Lane, modes: tuple[Modes, Modes], r: Sixteen
) -> None:
    """Add the nodal forces of the resultants r to the force rows."""
    f0, f1, f2, f3 = nodal_forces(modes[0], modes[1], r)
    scatter_add(rows, corner, b, 0, lane, f0)
    scatter_add(rows, corner, b, 1, lane, f1)
    scatter_add(rows, corner, b, 2, lane, f2)
    scatter_add(rows, corner, b, 3, lane, f3)
