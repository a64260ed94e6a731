"""Places of all quads and copies in the blocks, and what stands there.

The blocks of the mesh are built once; copies of cut quads (:mod:`.copies`) take places after them,
in the order in which they are made. Which place a copy has is part of the state of a run: the
order of a sum follows from it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shellcut.arrays import Floats, SmallIds
from shellcut.material.shell_material import ShellMaterial
from shellcut.mesh.mesh import Mesh
from shellcut.state import State

from .blocks import QuadBlocks
from .copies import MORE_BLOCKS, empty_place, fill_place, grow_blocks, grow_tables, with_more_blocks
from .film_axes import film_axes
from .quad_strains import LinearTables
from .section import full_stiffness
from .thickness_points import PointTables

# Quads whose stiffness is computed at a time.
_PATCH = 32


class Places:
    """Blocks and tables of a film, with room for copies that grows.

    Parameters
    ----------
    mesh, material : Mesh, ShellMaterial
        Reference surface and layers.
    blocks, tables, points : QuadBlocks, LinearTables, PointTables
        Of the whole quads.
    mass : ndarray, shape (n_quad, 4)
        Of the corners of whole quads [t].
    """

    def __init__(
        self,
        mesh: Mesh,
        material: ShellMaterial,
        blocks: QuadBlocks,
        tables: LinearTables,
        points: PointTables,
        mass: Floats,
    ) -> None:
        self._mesh, self._material = mesh, material
        self._mass = mass.copy()
        self._stiffness: dict[int, Floats] = {}
        self.blocks, self.tables, self.points = blocks, tables, points
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
            empty_place(before, self.blocks, self.tables, self.points)
            self._place(state, row, before)
        self._place(state, new, before)
        for copy in (row, new):
            self._fill(state, copy)

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
        end = self.n_whole * self.blocks.width
        rows = np.flatnonzero(slot >= end)
        if not rows.size:
            return
        for quad in np.intersect1d(rows, np.flatnonzero(self.blocks.slot < end)).tolist():
            empty_place(int(self.blocks.slot[quad]), self.blocks, self.tables, self.points)
        self._grow(state.strain.shape[0] - self.blocks.quad.shape[0])
        self.blocks = replace(self.blocks, slot=slot.copy())
        self._count_copies(rows.size)
        for row in rows[np.argsort(slot[rows], kind="stable")].tolist():
            b, lane = divmod(int(slot[row]), self.blocks.width)
            self.blocks.quad[b, lane:] = row
            self._fill(state, row)

    def _stiffness_of(self, quad: int) -> Floats:
        """Return the stiffness of a whole quad of the mesh, shape (136,).

        That of some quads takes no longer than that of one, and a crack goes on to neighbours.
        They are always the same ones: a sum may depend on their number in its last bit.
        """
        patch = quad // _PATCH
        if patch not in self._stiffness:
            nodes = self._mesh.quads[patch * _PATCH : (patch + 1) * _PATCH]
            X, T = self._mesh.nodes[nodes], self._mesh.directors[nodes]
            self._stiffness[patch] = full_stiffness(X, T, self._material)
        return np.asarray(self._stiffness[patch][quad % _PATCH])

    def _fill(self, state: State, row: int) -> None:
        parent = int(state.quad.parent[row])
        fill_place(
            int(self.blocks.slot[row]),
            parent,
            float(state.quad.share[row]),
            self._stiffness_of(parent),
            self._mesh,
            self.blocks,
            self.tables,
            self.points,
        )
        if self._material.has_axes:
            b, lane = divmod(int(self.blocks.slot[row]), self.blocks.width)
            nodes = self._mesh.quads[parent][None]
            X, T = self._mesh.nodes[nodes], self._mesh.directors[nodes]
            self.points.axes[b, :, lane] = film_axes(X, T, self._material)[0]

    def _place(self, state: State, row: int, before: int) -> None:
        """Give a copy the next place; its strains and history are those of the place before."""
        width = self.blocks.width
        slot = self.n_whole * width + self._n_copy
        self._count_copies(self._n_copy + 1)
        if slot >= self.blocks.quad.size:
            n = max(MORE_BLOCKS, (self.blocks.quad.shape[0] - self.n_whole) // 2)
            self._grow(n)
            for name in ("strain", "strain_before", "history"):
                setattr(state, name, with_more_blocks(getattr(state, name), n))
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
        if n > 0:
            self.blocks = grow_blocks(self.blocks, n)
            self.tables, self.points = grow_tables(self.tables, self.points, n)
