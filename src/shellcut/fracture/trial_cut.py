"""A cut that is tried: which corners and cables are on either side of it, around its tip.

That is a matter of the topology and of which side or corner of the row the segment leads to: the
cut is tried on the topology, its classes of corners are read off, and it is mended again. Forces,
positions and the shares of the two parts change with every step (:mod:`.trial_sums`).
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints, product
from shellcut.loads.loads import LoadSet
from shellcut.mesh.quad_geometry import corner_normals
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State

from .anisotropy import Anisotropy
from .cut_state import rows_along, side_under
from .cut_topology import Corner, CutTopology
from .quad_polygon import UNUSED, Polygon, divide, holds, shape_functions
from .segment import Segment
from .tip import Tip

UNCUT, RIGHT, LEFT = 0, 1, 2
"""What a side of a trial cut has of a row: all of it, or what lies to one side of the segment."""


class Side(NamedTuple):
    """A class of corners of a trial cut, on one side of it."""

    rows: Ints
    """Present rows, shape (n,)."""
    corner: Ints
    """Which of its corners, shape (n,)."""
    nodes: Ints
    """The node there now, shape (n,)."""
    part: Ints
    """UNCUT, RIGHT or LEFT: what of the row belongs to it, shape (n,)."""
    cables: tuple[tuple[int, int, float], ...]
    """Cable, its end, and how much of its force goes with the class."""


class Pair(NamedTuple):
    """The classes that a trial cut makes at a corner of the row ahead."""

    weight: float
    """Shape function of the corner at the tip."""
    sides: tuple[Side, Side]
    """Minus and plus."""


class TrialCut:
    """Tries cuts.

    Parameters
    ----------
    topology : CutTopology
        As it was when a trial is over.
    shell, loads : MITC4Shell, LoadSet
        Give the nodal forces.
    strength : float
        sigma_F [MPa].
    anisotropy : Anisotropy, optional
        Of the film.
    held_behind : bool
        Whether the segment behind a tip has all its cables already, at its Gauss points: L_in is
        0 then, for the new cables only hold what is ahead.
    """

    def __init__(
        self,
        topology: CutTopology,
        shell: MITC4Shell,
        loads: LoadSet,
        strength: float,
        anisotropy: Anisotropy | None = None,
        *,
        held_behind: bool = False,
    ) -> None:
        self.topology, self._shell, self._loads = topology, shell, loads
        self._anisotropy, self._held_behind = anisotropy, held_behind
        self.carried = strength * shell.material.thickness
        """What cables carry, sigma_F h [N/mm]."""

    def behind(self, tip: Tip) -> float:
        """Return L_in, of the segment behind a tip that has a cable to come [mm]."""
        return 0.0 if self._held_behind else tip.length

    def factors(self, state: State, tip: Tip, segment: Segment) -> tuple[float, float]:
        """Return the factors on the strength before and behind a tip, of the way there and on."""
        if self._anisotropy is None:
            return 1.0, 1.0
        X = state.node.X[state.quads[segment.row]]
        start, stop = (product(shape_functions(p), X) for p in (segment.entry, segment.exit))
        ways = np.stack([tip.heading, stop - start])
        before, after = self._anisotropy.factors(ways, corner_normals(X)).tolist()
        return before, after

    def corner_mass(self, side: Side) -> Floats:
        """Return the masses of the corners of a class, of whole rows [t], shape (n,)."""
        return np.asarray(self._shell.mass[side.rows, side.corner])

    def corner_forces(self, state: State, rows: Ints, nodes: Ints) -> Floats:
        """Return the forces of whole rows on one of their nodes each [N], shape (n, 3)."""
        force = self._shell.corner_forces(state, rows, nodes)
        self._loads.add_corner_forces(state, rows, nodes, force)
        return force

    def pairs(self, state: State, segment: Segment) -> list[Pair]:
        """Return the classes on both sides of a trial cut, at the corners that hold its tip."""
        ring = self._shell.mesh_quads[segment.row].tolist()
        weights = shape_functions(segment.entry)
        corners = [c for c in range(4) if weights[c] > UNUSED]
        rows, classes = self._tried(segment, [ring[c] for c in corners])
        pairs = []
        for c, groups in zip(corners, classes, strict=True):
            minus, plus = (
                next((g for g in groups if any(r == row for r, _ in g)), None) for row in rows
            )
            if minus is not None and plus is not None and minus is not plus:
                sides = self._side(state, minus, segment), self._side(state, plus, segment)
                pairs.append(Pair(weights[c], sides))
        return pairs

    def _parts(self, segment: Segment) -> dict[int, Polygon]:
        """Return the parts of a row on the right and left of a segment, by the trial's rows."""
        whole = self.topology.polygon(segment.row)
        right, left = divide(whole, segment.entry, segment.exit)
        return {segment.row: right, self.topology.n_row: left}

    def _tried(
        self, segment: Segment, nodes: list[int]
    ) -> tuple[list[int], list[list[list[Corner]]]]:
        """Return the rows on both sides of a trial cut, and classes around nodes of the mesh."""
        topology = self.topology
        if segment.along_side:
            side, part = side_under(self._shell, segment)
            rows, _ = rows_along(topology, side, part)
            topology.break_side(*side, *part)
            classes = [topology.classes(node) for node in nodes]
            topology.mend_side(*side)
            return rows, classes
        whole = topology.polygon(segment.row)
        new = topology.cut(segment.row, segment.entry, segment.exit)
        classes = [topology.classes(node) for node in nodes]
        topology.mend(segment.row, new, whole)
        return [segment.row, new], classes

    def _side(self, state: State, members: list[Corner], segment: Segment) -> Side:
        """Return a class of a trial cut; the row that is only tried is part of the row cut."""
        new = state.n_quad
        parts = {} if segment.along_side else {segment.row: RIGHT, new: LEFT}
        rows = np.array([row if row < new else segment.row for row, _ in members])
        corner = np.array([corner for _, corner in members])
        tried = {} if segment.along_side else self._parts(segment)
        part = {row: tried[row] for row, _ in members if row in tried}

        def holds_end(row: int, inward: Floats) -> bool:
            """Return whether the side has an end: of the row that is tried it is one part."""
            return row != segment.row or all(holds(p, tuple(inward)) for p in part.values())

        f, c = state.flank, state.cable
        at = c.row[: c.count] * 4 + c.corner[: c.count]
        at_corner = (at[..., None] == rows * 4 + corner).any(axis=2)
        cables = [
            (k, end, 1.0)
            for k, end in np.argwhere(at_corner).tolist()
            if holds_end(c.row[k, end], c.inward[k, end])
        ]
        for k in np.flatnonzero((f.row[: f.count, None] == rows).any(axis=1)).tolist():
            weight = float(f.weight[k, corner[rows == f.row[k]][0]])
            if weight > UNUSED and holds_end(f.row[k], f.inward[k]):
                for cable, end in np.argwhere(c.ends[: c.count] == f.node[k]).tolist():
                    cables.append((cable, end, weight))
        return Side(
            rows=rows,
            corner=corner,
            nodes=state.quads[rows, corner].astype(np.int64),
            part=np.array([parts.get(row, UNCUT) for row, _ in members]),
            cables=tuple(cables),
        )
