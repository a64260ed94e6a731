"""Whether any crack through quads may be due: asked often, and nearly always answered no.

A few kernels find where all driven tips would go and what their trial cuts measure. Only if one of
them is due, to within round-off, do the rules themselves (:mod:`.free_cracks`) look at the
tips and decide. The kernels compute the same numbers as the rules, so nothing due is missed.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import is_

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.jit import BoundOnce
from shellcut.state import KnownTopology, State
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.motion import Motion

from .crack_path import CrackPath
from .cut_topology import CutTopology
from .poses_beyond import PosesBeyond
from .quad_polygon import FLANK, along_side, on_side
from .ray_ahead import ALONG_SIDE, AT_CROSSING, AT_POINT, Aimed, aim, place_tips
from .rows_ahead import RowsAhead, Tips, rows_ahead
from .segment import Segment
from .tip import Tip
from .trial_cut import Pair, TrialCut
from .trial_sums import Trial, TrialSums


class TipWatch:
    """Watches the tips of cracks.

    Parameters
    ----------
    topology, path, trial_cut, shell : CutTopology, CrackPath, TrialCut, MITC4Shell
        The rules, for what lasts as long as a topology.
    edges, motion : CuttingEdges, Motion
        Of the tool.
    """

    def __init__(
        self,
        topology: CutTopology,
        path: CrackPath,
        trial_cut: TrialCut,
        shell: MITC4Shell,
        edges: CuttingEdges,
        motion: Motion,
    ) -> None:
        self._topology, self._path, self._trial_cut = topology, path, trial_cut
        self._shell = shell
        self._known = KnownTopology()
        self._count = (-1, -1)
        self._table: Tips
        self._ahead: RowsAhead
        self._director: Floats
        self._aimed: Aimed
        self._tips: list[Tip] = []
        self._beyond = PosesBeyond(edges, motion)
        self._sums = TrialSums(trial_cut)
        self._place_tips, self._aim = BoundOnce(place_tips), BoundOnce(aim)
        self._pairs: dict[tuple[int, bytes], list[Pair]] = {}
        self._way = b""
        self.x: Floats = np.zeros((0, 3))
        """Where the tips are [mm], written by :meth:`places`, shape (n_tip, 3)."""
        self.measure: Floats = np.zeros(0)
        """What the trial cuts of those with a segment measure, written by :meth:`due`."""
        self._due: Bools = np.zeros(0, np.bool_)

    def alive(self, state: State, tips: list[Tip]) -> list[Tip]:
        """Return the tips with film ahead: not at a rim, nor where another crack came across."""
        if self._is_of(state, tips):
            return tips
        return [tip for tip in tips if self._path.rows_ahead(tip)]

    def places(self, state: State, tips: Sequence[Tip]) -> Floats:
        """Return where tips are [mm], shape (n_tip, 3): one at least, with film ahead of each."""
        self._follow(state, tips)
        n = state.node
        self._place_tips(self._table, n.x, n.t, self.x, self._director)
        return self.x

    def driven_places(self) -> Floats:
        """Return where tips were that an edge drives, at the last question [mm], shape (n, 3)."""
        return self.x[self._beyond.found.edge_of >= 0] if len(self.x) else self.x

    def due(self, state: State, tips: Sequence[Tip]) -> Bools:
        """Return which tips may be due: no means no, shape (n_tip,).

        Parameters
        ----------
        state : State
            Present positions.
        tips : sequence of Tip
            With film ahead of each.
        """
        if not len(tips):
            self.x, self._tips = np.zeros((0, 3)), []
            return self._due[:0]
        self.places(state, tips)
        self._due[:] = False
        n, found = state.node, self._beyond.find(self.x, self._table.size, state.time)
        if self._aim(
            self._table,
            self._ahead,
            n.x,
            n.t,
            self._director,
            found.rotation,
            self._beyond.edges.segments,
            found.edge_of,
            found.off,
            self._aimed,
        ):
            way = self._aimed.way.tobytes()
            if way != self._way:
                self._way = way
                self._sums.take(self._trials(state))
            self._sums.weigh(state, self._ahead, self._aimed, found.passed, self.measure, self._due)
        return self._due

    def _is_of(self, state: State, tips: Sequence[Tip]) -> bool:
        """Return whether the tables are those of some tips in the present topology."""
        return (
            self._known.is_of(state)
            and (state.n_cable, state.flank.count) == self._count
            and len(tips) == len(self._tips)
            and all(map(is_, tips, self._tips))
        )

    def _follow(self, state: State, tips: Sequence[Tip]) -> None:
        """Build the tables anew where the topology or the tips are others."""
        if self._is_of(state, tips):
            return
        n = len(tips)
        self._tips, self._count = list(tips), (state.n_cable, state.flank.count)
        self._known.take(state)
        self._table, self._ahead = rows_ahead(
            state, self._topology, self._path, self._shell, self._tips
        )
        self.x, self._director = np.zeros((n, 3)), np.zeros((n, 3))
        self.measure, self._due = np.zeros(n), np.zeros(n, np.bool_)
        self._aimed = Aimed(np.full((n, 4), -1), np.zeros((n, 2)), np.zeros(n))
        self._pairs.clear()
        self._way = b""

    def _trials(self, state: State) -> list[Trial]:
        """Return the trial cuts of the tips that have a segment."""
        trials = []
        for i, way in enumerate(self._aimed.way):
            segment = self.segment(i)
            if segment is None:
                continue
            key = i, way.tobytes()
            if key not in self._pairs:
                self._pairs[key] = self._trial_cut.pairs(state, segment)
            trials.append(Trial(i, self._trial_cut.behind(self._tips[i]), self._pairs[key]))
        return trials

    def segment(self, i: int) -> Segment | None:
        """Return the segment of a tip at the last question, None if it had none."""
        k, kind, j, nth = self._aimed.way[i].tolist()
        if k < 0:
            return None
        row = int(self._ahead.row[k])
        entry, end = tuple(self._ahead.entry[k].tolist()), tuple(self._aimed.exit[i].tolist())
        polygon = self._topology.polygon(row)
        if kind in (AT_POINT, ALONG_SIDE):
            corner = int(self._ahead.corner[k, j])
            end = polygon.points[j]
            return Segment(row, entry, end, polygon.sides[j], corner, kind == ALONG_SIDE)
        side = polygon.sides[j]
        if kind == AT_CROSSING:
            end = on_side(side, float(self._ahead.known[self._ahead.crossing[k, j, 0] + nth]))
        elif side != FLANK:
            end = on_side(side, along_side(side, end))
        return Segment(row, entry, end, side, -1)
