"""Consistent orientation of the cells of a surface: triangles of a tool, quads of a film.

Two neighbours agree if they run along their common edge in opposite senses. Take every cell twice,
as it is and reversed, and connect the copies that agree: each connected part of the surface then
splits into two mirror images, its two consistent orientations. If both copies of a cell are in one
image, the part has no orientation (a Möbius strip).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Bools, Ints

from .connected_parts import connected_parts


class Winding(NamedTuple):
    """Cells to reverse for a consistent orientation."""

    turned: Bools
    """Cells to reverse so that each part has the orientation of most of its cells; (n_cell,)."""
    part: Ints
    """Connected part of each cell, shape (n_cell,)."""
    one_sided: Ints
    """Cells of parts that have no orientation."""


def common_winding(cells: Ints, n_node: int) -> Winding:
    """Return which cells to reverse.

    Parameters
    ----------
    cells : ndarray of int, shape (n_cell, n_corner)
        Corner node ids in order around each cell.
    n_node : int
        Ids are below it.

    Notes
    -----
    Only edges of exactly two cells connect them; other edges are left to the checks of the mesh.

    Examples
    --------
    >>> common_winding(np.array([[0, 1, 2], [0, 3, 2], [3, 0, 4]]), 5).turned.tolist()
    [True, False, False]
    >>> common_winding(np.array([[0, 1, 2], [0, 2, 3], [0, 4, 3]]), 5).turned.tolist()
    [False, False, True]
    """
    n_cell, n_corner = cells.shape
    start = cells.ravel()
    end = np.roll(cells, -1, axis=1).ravel()
    key = np.minimum(start, end) * n_node + np.maximum(start, end)
    order = np.argsort(key, kind="stable")
    key = key[order]
    first = np.flatnonzero(np.concatenate([[True], key[1:] != key[:-1]]))
    pairs = first[np.diff(np.append(first, key.size)) == 2]
    earlier, later = order[pairs], order[pairs + 1]
    agree = start[earlier] != start[later]
    a, b = earlier // n_corner, later // n_corner

    # copy 2 c is cell c as it is, copy 2 c + 1 reversed
    rows = np.concatenate([2 * a, 2 * a + 1])
    columns = np.concatenate([2 * b + ~agree, 2 * b + agree])
    image = connected_parts(rows, columns, 2 * n_cell)
    as_is, reverse = image[0::2], image[1::2]
    _, part = np.unique(np.minimum(as_is, reverse), return_inverse=True)
    votes = np.bincount(as_is, minlength=2 * n_cell)
    turned = votes[reverse] > votes[as_is]
    # of two images with equal votes that in which the first cell of the part is unreversed
    _, first_cell = np.unique(part, return_index=True)
    tie = votes[reverse] == votes[as_is]
    turned |= tie & (as_is != as_is[first_cell][part])
    one_sided = np.flatnonzero(as_is == reverse)
    turned[one_sided] = False
    return Winding(turned, part.astype(np.int64), one_sided)
