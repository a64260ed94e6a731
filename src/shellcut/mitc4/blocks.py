"""Quads in blocks of eight, in the order of the force kernels.

A block fills the lanes of one vector (:mod:`shellcut.numerics.lanes`). Quads of one block are
neighbours, so their nodes lie in few cache lines; flat quads have separate blocks, before the
others, because they need less data. Within each kind the quads form *strips* across the film,
ordered along its longest side, each wide enough that only neighbouring strips share nodes. So two
strips of even number, or two of odd number, may add their forces at the same time on two threads;
and the order in which a node receives its quads' forces depends only on the strips, not on the
number of threads.

Unused places repeat the last quad of the strip, with zero stiffness.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, SmallIds
from shellcut.numerics.lane_instructions import WIDTH
from shellcut.numerics.lanes import aligned_zeros

# One strip below the size at which a second thread helps; then two for every this many quads, at
# most this many strips.
_ONE_STRIP_BELOW = 20_000
_QUADS_PER_STRIP = 5_000
_MOST_STRIPS = 64

# Width of a lane of quads within a strip, in median diagonals of a quad.
_LANE = 2.5


@dataclass(frozen=True)
class QuadBlocks:
    """Places of the quads in blocks.

    Attributes
    ----------
    quad : ndarray of int32, shape (n_block, width)
        Quad at each place.
    filled : ndarray of bool, shape (n_block, width)
        False at places that repeat a quad.
    slot : ndarray of int32, shape (n_quad,)
        Place of each quad and copy, width block + lane.
    home : ndarray of int32, shape (n_whole,)
        Place of each quad of the mesh as long as nothing has cut it.
    corner : ndarray of int32, shape (n_block, 4, width)
        Node ids, a copy of ``State.quads``; the shell keeps it up to date by :meth:`rewire`.
    chain : ndarray of bool, shape (n_block,)
        Whether the node ids at every corner are consecutive; also kept up to date.
    flat_start, full_start : ndarray of int, shape (n_strip + 1,)
        First block of each strip, of flat quads and of the others.
    """

    quad: SmallIds
    filled: Bools
    slot: SmallIds
    home: SmallIds
    corner: SmallIds
    chain: Bools
    flat_start: Ints
    full_start: Ints

    @cached_property
    def n_flat(self) -> int:
        """Number of blocks of flat quads, the first ones."""
        return int(self.flat_start[-1])

    @cached_property
    def n_strip(self) -> int:
        """Number of strips."""
        return int(self.flat_start.size - 1)

    @property
    def width(self) -> int:
        """Number of quads in a block."""
        return int(self.quad.shape[1])

    def rewire(self, quads: Ints, which: Ints) -> None:
        """Copy the nodes of the quads ``which`` from quads : (n_quad, 4).

        Also to the places that repeat them, among these the ones that cut quads have left.
        """
        block, lane = np.divmod(self.slot[which], self.width)
        self.corner[block, :, lane] = quads[which]
        left = self.home[which[which < self.home.size]] // self.width
        blocks = np.unique(np.concatenate([block, left]))
        for b in blocks:
            repeats = np.flatnonzero(~self.filled[b])
            self.corner[b][:, repeats] = quads[self.quad[b, repeats]].T
        self.chain[blocks] = _is_chain(self.corner[blocks])


def build_blocks(nodes: Floats, quads: Ints, flat: Bools) -> QuadBlocks:
    """Order quads into strips and blocks.

    Parameters
    ----------
    nodes : ndarray, shape (n_node, 3)
        Reference positions [mm].
    quads : ndarray, shape (n_quad, 4)
        Node ids.
    flat : ndarray of bool, shape (n_quad,)
        Quads placed in the first blocks.
    """
    centre = nodes[quads].mean(axis=1)
    axes = np.argsort(-np.ptp(nodes, axis=0), kind="stable")
    along, across = centre[:, axes[0]], centre[:, axes[1]]
    strip = _strips(along, quads, nodes.shape[0])
    n_strip = int(strip.max(initial=0)) + 1
    part = strip + n_strip * ~flat
    # Within a strip up and down narrow lanes: the nodes in use stay in the nearest cache.
    diagonal = np.linalg.norm(nodes[quads[:, 2]] - nodes[quads[:, 0]], axis=1)
    lane = np.floor((along - along.min()) / (_LANE * np.median(diagonal)))
    order = np.lexsort((across, lane, part))
    rank = np.empty(order.size, np.int64)
    rank[order] = np.arange(order.size)

    chained = _chained(quads, part, WIDTH)
    others = order[~np.isin(order, chained)]
    quad = np.vstack([chained, _in_rows(others, part[others], 2 * n_strip, WIDTH)])
    quad = quad[np.argsort(rank[quad[:, 0]], kind="stable")]
    filled = quad >= 0
    # The last quad of the block (its first place is always filled).
    quad = np.take_along_axis(
        quad, np.maximum.accumulate(np.where(filled, np.arange(WIDTH), 0), axis=1), axis=1
    )
    start = np.cumsum([0, *np.bincount(part[quad[:, 0]], minlength=2 * n_strip)])
    slot = np.empty(order.size, np.int32)
    slot[quad[filled]] = np.flatnonzero(filled)
    corner: SmallIds = aligned_zeros((quad.shape[0], 4, WIDTH), np.int32)
    corner[:] = quads[quad].transpose(0, 2, 1)
    return QuadBlocks(
        quad.astype(np.int32),
        filled,
        slot,
        slot.copy(),
        corner,
        _is_chain(corner),
        start[: n_strip + 1],
        start[n_strip:],
    )


def _is_chain(corner: SmallIds) -> Bools:
    """Return which blocks have consecutive node ids at every corner."""
    return np.asarray((np.diff(corner, axis=2) == 1).all(axis=(1, 2)))


def _chained(quads: Ints, part: Ints, width: int) -> Ints:
    """Return quads of one part whose four node ids each grow by one along a row : (n, width)."""
    offset = quads - quads[:, :1]
    order = np.lexsort((quads[:, 0], *offset[:, 1:].T, part))
    grows = (np.diff(quads[order], axis=0) == 1).all(axis=1) & (np.diff(part[order]) == 0)
    first = np.flatnonzero(np.concatenate([[True], ~grows]))
    length = np.diff(first, append=order.size)
    place = np.arange(order.size) - np.repeat(first, length)
    return order[place < np.repeat(length // width * width, length)].reshape(-1, width)


def _in_rows(quads: Ints, part: Ints, n_part: int, width: int) -> Ints:
    """Return quads, sorted by part, in rows of one part each, padded with -1."""
    size = np.bincount(part, minlength=n_part)
    n_row = -(-size // width)
    begins = width * np.cumsum([0, *n_row[:-1]]) - np.cumsum([0, *size[:-1]])
    rows = np.full(width * int(n_row.sum()), -1)
    rows[np.arange(quads.size) + np.repeat(begins, size)] = quads
    return rows.reshape(-1, width)


def _strips(along: Floats, quads: Ints, n_node: int) -> Ints:
    """Return the strip of each quad; only neighbouring strips share nodes, as many as possible."""
    n_quad = along.size
    if n_quad < _ONE_STRIP_BELOW:
        return np.zeros(n_quad, np.int64)
    rank = np.empty(n_quad, np.int64)
    rank[np.argsort(along, kind="stable")] = np.arange(n_quad)
    n_strip = min(_MOST_STRIPS, 2 * (n_quad // (2 * _QUADS_PER_STRIP)))
    while n_strip > 1:
        strip = rank * n_strip // n_quad
        first, last = np.full(n_node, n_strip), np.zeros(n_node, np.int64)
        for a in range(4):
            np.minimum.at(first, quads[:, a], strip)
            np.maximum.at(last, quads[:, a], strip)
        if (last - first <= 1).all():
            return np.asarray(strip)
        n_strip //= 2
    return np.zeros(n_quad, np.int64)
