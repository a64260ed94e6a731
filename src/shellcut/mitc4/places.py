"""Places of all quads and copies in the blocks, and their contents: what the kernels take.

A crack that crosses a quad replaces it by copies that carry a share w of it each. Energy, forces,
damping, mass and inertia of a copy are those of the *whole* quad, at the copy's own nodes, times w
([Song2006]). At the cut all copies move as the quad did, and the shares sum to 1, so that
nothing changes: neither strain energy nor forces, nor mass, momentum or angular momentum of the
film. Where stiffness and mass of a copy scale alike, its largest frequency is that of the quad,
however small the share; a sliver gets more mass than that (:mod:`shellcut.fracture.cut_state`).

For the kernels a copy is one more quad of the general kind, with a stiffness times w, also where
the whole quad was flat. Copies stand in blocks of their own after all others; they are taken last,
in one strip on one thread, so that a node receives its forces in an order that does not depend on
the number of threads. The place of the whole quad is left empty: it repeats the quad with a
stiffness of zero.

Which place a copy has is part of the state of a run: the order of a sum follows from it.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Numbers, SmallIds
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.numerics.lanes import aligned_zeros
from shellcut.numerics.table_address import TableWriter
from shellcut.state import KnownTopology, State

from .blocks import QuadBlocks
from .element import N_FLAT, N_FLAT_PRODUCT, N_FULL, N_STRAIN, FlatModuli
from .quad_strains import LinearTables, PointQuads, Quads
from .section import N_AXES, film_axes, flat_moduli, flat_stiffness, full_stiffness
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

# Quads whose stiffness is computed at a time.
_PATCH = 32

# Blocks by which the place for copies grows at least; it grows by half, too.
_MORE_BLOCKS = 8


class Places:
    """Blocks and tables of a film, with space for copies that grows.

    Parameters
    ----------
    mesh, material : Mesh, ShellMaterial
        Reference surface and layers.
    blocks : QuadBlocks
        Of the whole quads.
    mass : ndarray, shape (n_quad, 4)
        Of the corners of whole quads [t].
    """

    def __init__(
        self, mesh: Mesh, material: ShellMaterial, blocks: QuadBlocks, mass: Floats
    ) -> None:
        self._mesh, self._material = mesh, material
        self._mass = mass.copy()
        self._stiffness: dict[int, Floats] = {}
        self.blocks = blocks
        self.tables, self.points = build_tables(mesh, material, blocks)
        self._address_of = TableWriter()
        self._known = KnownTopology()
        self._present: PointQuads | None = None
        self._address: PointQuads
        self.n_whole = blocks.quad.shape[0]
        """Number of blocks before those of copies."""
        self.copy_start = np.array([self.n_whole, self.n_whole])
        """First block of copies, and the end of those in use, shape (2,)."""
        self._n_copy = 0

    def cut(self, state: State, row: int, new: int) -> None:
        """Give the two parts of a row that has just been cut their places, and fill them.

        Strains and history of both are those of the place where the row was.
        """
        before = int(self.blocks.slot[row])
        if before < self.n_whole * self.blocks.width:
            self._empty(before)
            self._place(state, row, before)
        self._place(state, new, before)
        for copy in (row, new):
            self._fill(state, copy)

    def present(self, state: State) -> PointQuads:
        """Return the quads at the positions and directors of a state, the same until the next cut.

        ``State.quads`` says which nodes a quad has; the blocks follow it here.
        """
        if self._present is None or not self._known.is_of(state):
            self.blocks.rewire(state.quads, self._known.changed_quads(state))
            self._present = self.at(state.node.x, state.node.t)
            self._address = self._address_of(self._present)
            self._known.take(state)
        return self._present

    def address(self, state: State) -> PointQuads:
        """Return the address of the quads, for the kernels of the forces."""
        self.present(state)
        return self._address

    def at(self, x: Floats, t: Floats) -> PointQuads:
        """Return the quads as they are placed in the blocks, their nodes at any place.

        x, t : (n_node, 3), positions [mm] and directors.
        """
        blocks = self.blocks
        return PointQuads(Quads(x, t, blocks.corner, blocks.chain, self.tables), self.points)

    @property
    def has_copies(self) -> bool:
        """Whether a quad has been cut."""
        return self._n_copy > 0

    def _count_copies(self, n: int) -> None:
        """Take the number of places that copies have."""
        self._n_copy = n
        self.copy_start[1] = self.n_whole + -(-n // self.blocks.width)

    def mass_of(self, state: State, row: int) -> Floats:
        """Return the corners' shares in the mass of a copy [t], shape (4,)."""
        return np.asarray(state.quad.mass_share[row] * self._mass[state.quad.parent[row]])

    def restore(self, state: State, slot: SmallIds) -> None:
        """Take the places of a run that has made copies, for its ``state``.

        Parameters
        ----------
        state : State
            Of that run, strains and history included.
        slot : ndarray of int32, shape (n_quad,)
            Place of every quad and copy.
        """
        self._known, self._present = KnownTopology(), None
        end = self.n_whole * self.blocks.width
        rows = np.flatnonzero(slot >= end)
        if not rows.size:
            return
        for quad in np.intersect1d(rows, np.flatnonzero(self.blocks.slot < end)).tolist():
            self._empty(int(self.blocks.slot[quad]))
        self._grow(state.strain.shape[0] - self.blocks.quad.shape[0])
        self.blocks = replace(self.blocks, slot=slot.copy())
        self._count_copies(rows.size)
        for row in rows[np.argsort(slot[rows], kind="stable")].tolist():
            b, lane = divmod(int(slot[row]), self.blocks.width)
            self.blocks.quad[b, lane:] = row
            self._fill(state, row)

    def _stiffness_of(self, quad: int) -> Floats:
        """Return the stiffness of a whole quad of the mesh, shape (136,).

        That of some quads costs no more than that of a single quad, and a crack runs on to
        neighbours. They are always the same ones: a sum may depend on their number in its last bit.
        """
        patch = quad // _PATCH
        if patch not in self._stiffness:
            nodes = self._mesh.quads[patch * _PATCH : (patch + 1) * _PATCH]
            X, T = self._mesh.nodes[nodes], self._mesh.directors[nodes]
            self._stiffness[patch] = full_stiffness(X, T, self._material)
        return np.asarray(self._stiffness[patch][quad % _PATCH])

    def _fill(self, state: State, row: int) -> None:
        """Put a copy at its place: of its quad what does not change, and the stiffness times w."""
        parent, share = int(state.quad.parent[row]), float(state.quad.share[row])
        linear, points = self.tables, self.points
        b, lane = divmod(int(self.blocks.slot[row]), self.blocks.width)
        at = b - linear.n_flat
        nodes = self._mesh.quads[parent][None]
        X, T = self._mesh.nodes[nodes], self._mesh.directors[nodes]
        self.blocks.filled[b, lane] = True
        linear.full_reference[at, :, lane] = quad_products(X, T)[0]
        linear.full_stiffness[at, :, lane] = share * self._stiffness_of(parent)
        if points.rule.place.size:
            frames = full_frames(X, T, points.rule).reshape(4, points.rule.place.size, -1).copy()
            frames[..., -1] *= share  # the volume that a point represents
            points.full_frame[at, :, lane] = frames.ravel()
        if self._material.has_axes:
            points.axes[b, :, lane] = film_axes(X, T, self._material)[0]

    def _empty(self, slot: int) -> None:
        """Take the stiffness from the quad at a place; it continues to repeat a quad."""
        linear, points = self.tables, self.points
        b, lane = divmod(slot, self.blocks.width)
        self.blocks.filled[b, lane] = False
        frames, at = points.full_frame, b - linear.n_flat
        if b < linear.n_flat:
            frames, at = points.flat_frame, b
            linear.flat[b, N_FLAT_PRODUCT:, lane] = 0.0
        else:
            linear.full_stiffness[at, :, lane] = 0.0
        if points.rule.place.size:
            frames[at, :, lane] = 0.0

    def _place(self, state: State, row: int, before: int) -> None:
        """Give a copy the next place; its strains and history are those of the place before."""
        width = self.blocks.width
        slot = self.n_whole * width + self._n_copy
        self._count_copies(self._n_copy + 1)
        if slot >= self.blocks.quad.size:
            n = max(_MORE_BLOCKS, (self.blocks.quad.shape[0] - self.n_whole) // 2)
            self._grow(n)
            for name in ("strain", "strain_before", "history"):
                setattr(state, name, _with_more_blocks(getattr(state, name), n))
        places = self.blocks.slot
        if row >= places.size:
            places = np.append(places, np.int32(0))
        places[row] = slot
        self.blocks = replace(self.blocks, slot=places)
        (b, lane), (b_before, lane_before) = divmod(slot, width), divmod(before, width)
        # Places that no copy fills yet repeat the one before.
        self.blocks.quad[b, lane:] = row
        for rows in (state.strain, state.strain_before, state.history):
            rows[b, :, lane:] = rows[b_before, :, lane_before, None]

    def _grow(self, n: int) -> None:
        """Add n blocks of quads of the general kind, without stiffness, that nothing fills yet."""
        if n <= 0:
            return

        def grown(table: Any, *names: str) -> dict[str, Any]:
            return {name: _with_more_blocks(getattr(table, name), n) for name in names}

        blocks, points = self.blocks, self.points
        self.blocks = replace(blocks, **grown(blocks, "quad", "filled", "corner", "chain"))
        self.tables = self.tables._replace(**grown(self.tables, "full_reference", "full_stiffness"))
        names = ["full_frame"] * bool(points.rule.place.size) + ["axes"] * bool(points.axes.size)
        self.points = points._replace(**grown(points, *names))


def _with_more_blocks(array: Numbers, n: int) -> Numbers:
    """Return an array of blocks with n blocks of zeros after them."""
    more: Numbers = aligned_zeros((array.shape[0] + n, *array.shape[1:]), array.dtype)
    more[: array.shape[0]] = array
    return more


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

    def in_blocks(rows: Floats) -> Floats:
        return rows.reshape(-1, blocks.width, rows.shape[1]).transpose(0, 2, 1)

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
            some = slice(start, stop) if flat else slice(start - n_flat, stop - n_flat)
            products = quad_products(X, T)
            # Places that repeat a quad get zero stiffness.
            filled = blocks.filled[start:stop].reshape(-1, 1)
            if flat:
                linear.flat[some, :N_FLAT_PRODUCT] = in_blocks(products[:, :N_FLAT_PRODUCT])
                stiffness = filled * flat_stiffness(X, T, material)
                linear.flat[some, N_FLAT_PRODUCT:] = in_blocks(stiffness)
            else:
                linear.full_reference[some] = in_blocks(products)
                linear.full_stiffness[some] = in_blocks(filled * full_stiffness(X, T, material))
            if n_point:
                frames = flat_frames(X, T) if flat else full_frames(X, T, rule)
                table_of_frames = points.flat_frame if flat else points.full_frame
                table_of_frames[some] = in_blocks(filled * frames)
            if material.has_axes:
                points.axes[start:stop] = in_blocks(film_axes(X, T, material))
    return linear, points
