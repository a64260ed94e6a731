"""The border of a film that is cut: outer sides, flanks of cracks, and sides that are broken.

The border is made of straight *edges*. From a tip the crack's own flanks lead back
(:meth:`FilmBorder.path_back`), as far as no other edge of the film touches them: not the outer
border at which it began, nor the other branch, nor its own path where it has crossed that. How far
back along this path cables carry is the length of its process zone.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from shellcut.arrays import Bools, Floats, Ints, norm, off_segments, product
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import BROKEN, State

from .cut_topology import CutTopology
from .open_edges import of_one_polygon
from .quad_polygon import FLANK, Point, beyond, edges, on_side

SAME = 1e-5
"""Of a length of several edges: ends of edges that are nearer are one place, far above
round-off."""

GAP = 1.5
"""Local edge lengths: cables that are farther apart along the crack do not belong to one process
zone."""

# Of the local edge length: cables lie so near to their segment or nearer.
_BESIDE = 0.05


class FilmBorder:
    """The border of the film, as long as its topology stays.

    Parameters
    ----------
    shell : MITC4Shell
        Gives the reference film.
    topology : CutTopology
        How it is cut.
    """

    def __init__(self, shell: MITC4Shell, topology: CutTopology) -> None:
        self._shell, self._topology = shell, topology
        _, self._is_outer = of_one_polygon(shell.mesh_quads, len(shell.reference.x))
        self._same = SAME * float(np.sqrt(shell.area.min()))
        self.find()

    def find(self) -> None:
        """Find the border of the film as it is cut now."""
        topology, film, mesh = self._topology, self._shell.reference, self._shell.mesh_quads
        opened = topology.opened_rows()
        whole = self._is_outer.copy()
        whole[[row for row in opened if row < len(whole)]] = False
        row, first = np.nonzero(whole)
        corners = np.stack([first, (first + 1) % 4], axis=1)
        rows: list[int] = []
        places: list[tuple[Point, Point]] = []
        outside: list[list[int]] = []
        for cut in opened:
            quad = topology.parent(cut)
            polygon, outer, ring = topology.polygon(cut), self._is_outer[quad], mesh[quad].tolist()
            for a, b, side in edges(polygon):
                parts = [(a, b)]
                if side != FLANK and not outer[side]:
                    broken = topology.broken_parts(ring[side], ring[(side + 1) % 4])
                    parts = [(on_side(side, start), on_side(side, stop)) for start, stop in broken]
                rows += [cut] * len(parts)
                places += parts
                outside += [beyond(*part) if side == FLANK else [] for part in parts]
        xi, eta = np.array(places).reshape(-1, 2, 2).transpose(2, 0, 1)
        weights: Floats = np.stack(shape_functions(xi, eta), axis=-1)
        self.row: Ints = np.concatenate([row, np.array(rows, np.int64)])
        """Of which row each is an edge, shape (n,)."""
        X = film.x[film.quads[self.row]]
        n = len(row)
        at_corners = np.take_along_axis(X[:n], corners[:, :, None], axis=1)
        self.ends: Floats = np.concatenate([at_corners, product(weights, X[n:])])
        """In the reference film [mm], shape (n, 2, 3)."""
        self.beyond: Bools = np.zeros((len(self.row), 4), np.bool_)
        """Which corners of that row lie outside the film because of it, shape (n, 4)."""
        for i, found in enumerate(outside, start=n):
            self.beyond[i, found] = True

    def path_back(self, place: Floats) -> Iterator[tuple[Ints, Floats, float]]:
        """Yield the edges of the flanks of the crack that ends at a place, from there on back.

        Those between two places of the path, the two places, shape (2, 3), and how long the path
        from the tip then is [mm].
        """
        own, distance = np.zeros(len(self.row), np.bool_), 0.0
        while True:
            at = np.linalg.norm(self.ends - place, axis=2) < self._same
            here = np.flatnonzero(at.any(axis=1) & ~own)
            others = self.ends[here, np.where(at[here, 0], 1, 0)]
            if not here.size or (np.linalg.norm(others - others[0], axis=1) > self._same).any():
                return
            own[here], distance = True, distance + float(norm(others[0] - place))
            yield here, np.stack([place, others[0]]), distance
            place = others[0]

    def cables_behind(self, state: State, place: Floats, size: float) -> tuple[Ints, Floats]:
        """Return the cables across the flanks of the crack that ends at a place.

        As far back as they carry, and how far that is in local edge lengths, shape (n,) each,
        ascending.

        size : local edge length [mm].
        """
        c = state.cable
        intact = np.flatnonzero(c.status[: state.n_cable] != BROKEN)
        X, back = c.at_ends(state.node.X)[intact, 0], np.full(len(intact), np.inf)
        last = 0.0
        for _, (start, stop), distance in self.path_back(place):
            length = float(norm(stop - start))
            gap, along = off_segments(X, start, stop - start)
            on = norm(gap) < _BESIDE * size
            back[on] = np.minimum(back[on], distance + (along[on] - 1.0) * length)
            last = back[on].max(initial=last)
            if distance - last > GAP * size:
                break
        order = np.argsort(back, kind="stable")[: np.isfinite(back).sum()]
        return intact[order], back[order] / size
