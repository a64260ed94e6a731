"""Cuts of a film: what every crack does, along sides of the mesh or through its quads.

A cut along a segment divides a quad or breaks a side, gives the flanks nodes of their own where
they part (:mod:`.cut_state`), lays cables across it (:mod:`.segment_cables`) and writes it down.
Where a crack runs, and when, is decided elsewhere: :mod:`.cracks`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from shellcut.arrays import Floats, norm, product
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.numerics.small_matrices import pseudo_inverse
from shellcut.state import NOTCH, SplitRecord, State

from .anisotropy import Anisotropy
from .cut_state import cut_row, nodes_at, parted, renew_nodes, rows_along, side_under
from .cut_topology import CutTopology
from .quad_polygon import Point, corner_at, film_moments, spans
from .segment_cables import SegmentCables
from .tip import Segment

# A single cable in the middle of a segment hands as much on to its start as to its stop.
_ALIKE = 1e-9


class Cut(NamedTuple):
    """A segment that has been cut."""

    rows: list[int]
    """To its right and left."""
    chords: list[tuple[Point, Point]]
    """Its ends in the quad of each."""
    heading: Floats
    """Unit direction in the reference film, shape (3,)."""
    length: float
    """[mm]"""
    kind: str
    """As in :class:`shellcut.state.SplitRecord`."""

    def is_open(self, state: State, end: int) -> bool:
        """Return whether the flanks part where it starts, end 0, or stops, end 1."""
        return parted(state, self.rows, (chord[end] for chord in self.chords))


class Cuts:
    """Cuts a film and joins the flanks by cables, so many across each segment.

    The loads learn which part of a quad each copy carries.
    """

    def __init__(
        self,
        state: State,
        shell: MITC4Shell,
        law: CohesiveTable,
        anisotropy: Anisotropy | None = None,
        *,
        loads: LoadSet | None = None,
        fibres: int,
    ) -> None:
        n = state.node
        self._shell, self._loads, self._strength = shell, loads, law.strength
        self._cables = SegmentCables(law, shell.material, fibres, anisotropy)
        self.topology = CutTopology(shell.mesh_quads.copy(), n.quads, n.n_quad_at)
        """Which corners of quads and copies share a node."""

    @property
    def along_sides_only(self) -> bool:
        """Whether no quad has been cut."""
        return not self.topology.cut_rows()

    def along(
        self, state: State, segment: Segment, kind: str, measure: float, edge: int = -1
    ) -> Cut:
        """Cut a row along a segment, or break a side or a part of it.

        Nodes and flank points are to be brought up to date then (:meth:`renew`).

        kind, measure, edge : as in :class:`shellcut.state.SplitRecord`; a notch has no cables.
        """
        topology, shell, nodes = self.topology, self._shell, state.quads[segment.row]
        X = state.node.X[nodes]
        length = float(norm(product(segment.weights, X)))
        if segment.along_side:
            side, part = side_under(shell, segment)
            rows, chords = rows_along(topology, side, part)
            topology.break_side(*side, *part)
            corners = [*side]
        else:
            rows = [segment.row, cut_row(state, shell, topology, segment)]
            self._share_loads(rows)
            chords = [(segment.entry, segment.exit)] * 2
            corners = shell.mesh_quads[segment.row].tolist()
            self._cables.follow(state, topology, *rows)
        entry, exit_ = shape_functions(*segment.entry), shape_functions(*segment.exit)
        start, stop = product(entry, X), product(exit_, X)
        state.split_log.append(
            SplitRecord(
                time=state.time,
                node=-1,
                twin=-1,
                place=tuple(product(entry, state.node.x[nodes]).tolist()),
                reference=tuple(start.tolist()),
                end=tuple(stop.tolist()),
                kind=kind,
                measure=measure,
                force_jump=0.0,
                rows=tuple(rows),
                edge=edge,
            )
        )
        state.revision += 1
        renew_nodes(state, shell, topology, corners)
        minus, plus = (
            nodes_at(state, row, chord[0]) for row, chord in zip(rows, chords, strict=True)
        )
        # Which node has parted at the start of a side that has been broken.
        if segment.along_side and minus != plus and corner_at(chords[0][0]) >= 0:
            node, duplicate = sorted(minus | plus)
            state.split_log[-1] = replace(state.split_log[-1], node=node, twin=duplicate)
        if kind != NOTCH:
            self._cables.lay(state, rows, chords, length)
            state.crack_length += length
        return Cut(rows, chords, (stop - start) / length, length, kind)

    def renew(self, state: State) -> None:
        """Bring cables and flank points to the nodes that the last cuts have made."""
        self._cables.renew(state, self._shell.area)

    def hand_over(
        self, state: State, cut: Cut, forces: Sequence[Floats], first: int, *, exactly: bool
    ) -> None:
        """Let new cables take over the forces between the nodes that have parted.

        The difference of their pull is written to the record of the cut, the last one, along a
        side.

        forces : (3,) each, what the plus side pulled the minus side with at start and stop [N].
        first : of the new cables.  exactly : whether they begin with that force, whatever their law
        says.
        """
        c, new = state.cable, slice(first, state.n_cable)
        # The parts of each cable's force at the start and at the stop.
        part = np.stack([1.0 - c.share[new], c.share[new]])
        pull, more = self._strength * c.area[new, None] * c.m[new], np.zeros((2, 3))
        for end, force in enumerate(forces):
            if cut.is_open(state, end):
                more[end] = force - product(part[end], pull)
        if exactly:
            # A closed end gets the same: it is the next tip.
            more = np.stack([more[k] if more[k].any() else more[1 - k] for k in (0, 1)])
            at_ends = product(pseudo_inverse(product(part, part.T), _ALIKE), more)
            c.start_force[new] = product(part.T, at_ends)
            c.force[new, 0] += c.start_force[new]
            c.force[new, 1] -= c.start_force[new]
            more = np.zeros((2, 3))
        jump = float(norm(more).max())
        state.split_log[-1] = replace(state.split_log[-1], force_jump=jump)

    def _share_loads(self, rows: list[int]) -> None:
        """Tell the loads which part of their quad some rows carry."""
        if self._loads is None:
            return
        for row in rows:
            polygon = self.topology.polygon(row)
            self._loads.cut.take(row, film_moments(polygon), spans(polygon))

    def saved(self) -> dict[str, Any]:
        """Return the topology; the cables are in the state."""
        return {"topology": self.topology.saved()}

    def restore(self, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`."""
        self.topology.restore(saved["topology"])
        self._share_loads(self.topology.cut_rows())
        self._cables.restore()
