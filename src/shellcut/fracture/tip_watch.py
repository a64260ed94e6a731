"""Which of the cracks that blades drive are due, and along which segments: a check that runs often.

What depends on the topology only is found once; a few kernels do the rest for all tips.

A tip that no edge drives is tried straight ahead. In which direction it would tear is searched now
and then, which costs as much as a hundred of these trials, whatever the force is straight ahead:
|F|, kappa and L_F of a trial cut change with the segment, so no measure in one direction bounds
that in another.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, kernel
from shellcut.numerics.table_address import TableWriter
from shellcut.numerics.vec3 import mean_of, norm, store
from shellcut.state import KnownTopology, State

from .blade_drive import BladeDrive
from .crack_path import CrackPath
from .ray_ahead import AHEAD, Aimed, leave
from .rows_ahead import RowsAhead, Tips, tips_of
from .side_tears import LargestStress
from .tip import DUE, DrivenTips, Segment, Tip
from .trial_cut import Pair, TrialCut, TrialSums, Weighed

_NONE = np.zeros(0, np.int64)

_SELDOM = 5
"""In every such check the directions of all tips are searched that no edge drives."""


class TipWatch:
    """Watches the tips of cracks.

    Parameters
    ----------
    path, trial_cut, drive : CrackPath, TrialCut, BladeDrive
        The rules.
    stress : LargestStress, optional
        Whose measure counts, if it does.
    """

    def __init__(
        self,
        path: CrackPath,
        trial_cut: TrialCut,
        drive: BladeDrive,
        stress: LargestStress | None = None,
    ) -> None:
        self._path, self._trial_cut, self._drive = path, trial_cut, drive
        self._stress = stress
        self._known = KnownTopology()
        self._table: Tips
        self._ahead: RowsAhead
        self._addresses: tuple[Tips, RowsAhead, Aimed]
        self._address_of = TableWriter(), TableWriter(), TableWriter()
        self._director: Floats
        self._heading: Floats
        self._behind: Floats
        self._aimed: Aimed
        self.weighed: Weighed
        """What the trial cuts of tips with a segment had at the last check."""
        self._tips: list[Tip] = []
        self._sums = TrialSums(trial_cut)
        self._place_tips, self._leave = BoundOnce(_place_tips), BoundOnce(leave)
        self._pairs: dict[tuple[int, bytes], list[Pair]] = {}
        self._targets = b""
        self.x: Floats = np.zeros((0, 3))
        """Where the tips were at the last check [mm], shape (n_tip, 3)."""
        self._due: Bools = np.zeros(0, np.bool_)

    def alive(self, state: State, tips: list[Tip]) -> list[Tip]:
        """Return the tips with film ahead: not at a border, nor where another crack crossed."""
        if self._is_of(state, tips):
            return tips
        return [tip for tip in tips if self._path.film.rows_ahead(tip)]

    def driven(self) -> DrivenTips:
        """Return the tips that an edge drives, at the last check."""
        if not len(self.x):
            return DrivenTips(self.x, _NONE, [])
        edge_of = self._drive.driven.edge_of
        driven = np.flatnonzero(edge_of >= 0)
        return DrivenTips(self.x[driven], edge_of[driven], [self._tips[i] for i in driven.tolist()])

    def edge_of(self, i: int) -> int:
        """Return the segment of an edge that drove a tip at the last check, -1 if none."""
        return int(self._drive.driven.edge_of[i])

    def may_tear(self, nth: int = 0) -> list[Tip]:
        """Return the tips to search in the n-th check.

        In every fifth all that no edge drives, or that an edge would lead back out of the film
        ahead; else those that no edge drives and that are due straight ahead.
        """
        if not self._tips:
            return []
        free = self._drive.driven.edge_of < 0
        if nth % _SELDOM:
            searched = free & (self.weighed.magnitude >= DUE)
        else:
            searched = free | (self._aimed.target[:, AHEAD] < 0)
        return [self._tips[i] for i in np.flatnonzero(searched).tolist()]

    def due(self, state: State, tips: Sequence[Tip], others: Sequence[Tip] = ()) -> Bools:
        """Return which tips are due of those that an edge drives, shape (n_tip,).

        Such a tip is due if the edge has passed it, whatever the force: the blade is already there.
        Else it is due if the trial cut's measure, F · m over what the cables would carry, is DUE.
        The next call overwrites what is returned.

        tips : with film ahead.  others : that they may join besides each other.
        """
        if not len(tips):
            self.x, self._tips = np.zeros((0, 3)), []
            return self._due[:0]
        self._follow(state, tips, others)
        n, table, drive = state.node, self._table, self._drive
        tips_table, ahead, aimed = self._addresses
        self._place_tips(tips_table, n.x, n.t, self.x, self._director, self._heading)
        self._due[:] = False
        driven = drive.find(self.x, table.size, state.time)
        drive.direct(self._director, self._heading, table.reference, table.size)
        if self._leave(ahead, table.start, driven.directions, driven.lean, n.x, n.t, aimed):
            targets = self._aimed.target.tobytes()
            if targets != self._targets:
                self._targets = targets
                self._sums.take(state, self._trials(state), self._behind, self._aimed, self.weighed)
            self._sums.weigh(state)
            if self._stress is not None:
                stress, _ = self._stress.at(state, tips, [*tips, *others])
                self.weighed.measure[:] = self.weighed.magnitude[:] = stress
            has_segment = self._aimed.target[:, AHEAD] >= 0
            is_driven = driven.edge_of >= 0
            reached = driven.passed | (self.weighed.measure >= DUE)
            self._due[:] = has_segment & is_driven & reached
        return self._due

    def _is_of(self, state: State, tips: Sequence[Tip]) -> bool:
        """Return whether the tables are those of some tips in the present topology."""
        return self._known.is_of(state) and list(tips) == self._tips

    def _follow(self, state: State, tips: Sequence[Tip], others: Sequence[Tip]) -> None:
        """Build the tables anew where the topology or the tips are others."""
        if self._is_of(state, tips):
            return
        n = len(tips)
        self._tips = list(tips)
        self._known.take(state)
        self._table, self._ahead = tips_of(state, self._path.film, self._tips, others)
        self.x, self._director, self._heading = (np.zeros((n, 3)) for _ in range(3))
        self._behind = np.array([tip.length * tip.heading for tip in tips])
        self._due, self._aimed, self.weighed = np.zeros(n, np.bool_), Aimed.of(n), Weighed.of(n)
        of_tips, of_ahead, of_aimed = self._address_of
        self._addresses = of_tips(self._table), of_ahead(self._ahead), of_aimed(self._aimed)
        self._pairs.clear()
        self._targets = b""

    def _trials(self, state: State) -> list[tuple[int, list[Pair]]]:
        """Return the trial cuts of the tips that have a segment, see :meth:`.TrialSums.take`."""
        trials = []
        for i, target in enumerate(self._aimed.target):
            segment = self.segment(i)
            if segment is None:
                continue
            key = i, target.tobytes()
            if key not in self._pairs:
                self._pairs[key] = self._trial_cut.pairs(state, segment)
            trials.append((i, self._pairs[key]))
        return trials

    def segment(self, i: int) -> Segment | None:
        """Return the segment of a tip at the last check, None if it had none."""
        return self._path.segment_of(self._ahead, self._aimed, i)


@kernel
def _place_tips(
    tips: Tips, x: Floats, t: Floats, place: Floats, director: Floats, heading: Floats
) -> None:
    """Write place, unit director and heading of tips : (n_tip, 3) from x, t : (n_node, 3)."""
    tips = borrowed(tips)
    for i in range(tips.size.shape[0]):
        d = mean_of(t, tips.nodes, tips.weight, i)
        length = norm(d)
        store(place, i, mean_of(x, tips.nodes, tips.weight, i))
        store(director, i, (d[0] / length, d[1] / length, d[2] / length))
        store(heading, i, mean_of(x, tips.nodes, tips.forward, i))
