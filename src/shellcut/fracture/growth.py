"""How a crack grows by one quad or side: the cut along a segment, and the tips that it leaves."""

from __future__ import annotations

from shellcut.arrays import Floats, norm, product
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import TEAR, State

from .crack_path import CrackPath
from .cut_film import ONCOMING
from .cuts import Cut, Cuts
from .quad_polygon import FLANK, WHOLE, common_side
from .ray_ahead import JOIN
from .tip import Segment, Tip, tips_of_notches
from .trial_cut import TrialSums

_SAME_PLACE = 1e-6
"""Of the local edge length: tips that are no farther from each other are at one place."""


class Growth:
    """Cuts along segments, and the tips of all cracks.

    Parameters
    ----------
    state : State
        Before the first cut.
    cuts : Cuts
        Carries the cuts out.
    path : CrackPath
        Where cracks run.
    sums : TrialSums
        The force that holds together what is cut along a side.
    exactly : bool
        Whether the first cables of a cut along a side take over all of that force.
    """

    def __init__(
        self, state: State, cuts: Cuts, path: CrackPath, sums: TrialSums, *, exactly: bool
    ) -> None:
        self.cuts, self.path = cuts, path
        self.tips = tips_of_notches(state)
        """Where cracks end and may run on."""
        self._sums, self._exactly = sums, exactly

    def along(
        self,
        state: State,
        tip: Tip,
        segment: Segment,
        kind: str,
        measure: float,
        force: Floats | None = None,
        edge: int = -1,
    ) -> None:
        """Run a crack on along a segment.

        force : F_c of a crack along a side, which its first cables take over.  edge : chain of the
        cutting edge that drives it.
        """
        n_cable, forces = state.n_cable, [] if force is None else [force.copy()]
        if self._exactly:
            forces.append(-self._sums.at_start(state, segment.reversed()))
        self.tips.remove(tip)
        cut = self.cut(state, segment, kind, measure, edge)
        self.end_at(state, segment, cut, 1, tip.heading)
        self.cuts.renew(state)
        if segment.along_side:
            self.cuts.hand_over(state, cut, forces, n_cable, exactly=self._exactly)

    def cut(self, state: State, segment: Segment, kind: str, measure: float, edge: int = -1) -> Cut:
        """Cut along a segment; tips that lie on it keep what is behind them."""
        cut = self.cuts.along(state, segment, kind, measure, edge)
        for tip in self.tips:
            if segment.row in tip.behind and not segment.along_side:
                tip.behind = (*tip.behind, cut.rows[1])
        return cut

    def through(
        self,
        state: State,
        back: Segment,
        ahead: Segment,
        kind: str,
        measure: float = 0.0,
        edge: int = -1,
    ) -> Cut | None:
        """Cut a whole quad from where one ray from within leaves it to where the other does.

        If these are the ends of one side, that is broken.
        """
        row, start, stop, end = ahead.row, back.exit, ahead.exit, ahead.corner
        if start == stop:
            return None
        side = common_side(WHOLE, start, stop)
        if side is None:
            chord = Segment(row, start, stop, ahead.side, end)
        elif min(back.corner, end) < 0 or not self.path.film.may_break(row, back.corner, end):
            return None
        else:
            chord = Segment(row, start, stop, side, end, along_side=True)
        return self.cut(state, chord, kind, measure, edge)

    def end_at(self, state: State, segment: Segment, cut: Cut, end: int, ran_along: Floats) -> None:
        """Put a tip where the crack continues from an end of what has been cut."""
        tip = self.tip_after(state, segment, cut, end, ran_along)
        if tip is not None:
            self.tips.append(tip)

    def tip_after(
        self, state: State, segment: Segment, cut: Cut, end: int, ran_along: Floats
    ) -> Tip | None:
        """Return the tip at an end of what has been cut, None at a border.

        Where the crack is open there it has reached a border or another crack, whose tip there is a
        tip no more: it continues from the other flank, unless that crack ran towards it; the two
        are the same crack then. Tips of other cracks at that place stay.

        segment : leads to that end.  end : 0 where the cut starts, 1 where it stops.  ran_along :
        (3,), heading before the cut.
        """
        heading = cut.heading if end else -cut.heading
        if segment.side != FLANK and not cut.is_open(state, end):
            tip = self.path.tip_at(segment, heading, cut.length)
            if tip is None or self._joins_along_a_side(state, tip, cut.kind):
                return None
            tip.torn = state.step if cut.kind == TEAR else -1
            return tip
        here = product(shape_functions(*segment.exit), state.node.X[state.quads[segment.row]])
        near = _SAME_PLACE * self.path.film.size(segment.row)
        gaps = [norm(self.path.film.at_tip(tip, state.node.X) - here) for tip in self.tips]
        there = [tip for tip, gap in zip(self.tips, gaps, strict=True) if gap < near]
        joined = min(there, key=lambda tip: float(product(tip.heading, ran_along)), default=None)
        if joined is not None and product(joined.heading, ran_along) < ONCOMING:
            self.tips.remove(joined)
            return None
        if cut.kind == TEAR:
            return None  # it ends at the border of the film
        self.tips = [tip for tip, gap in zip(self.tips, gaps, strict=True) if gap >= near]
        return self.path.tip_across(state, segment, heading)

    def _joins_along_a_side(self, state: State, tip: Tip, kind: str) -> bool:
        """Tear a side from a new tip to an oncoming crack that ends on it; return whether one does.

        kind : of the cut.
        """
        here = self.path.film.at_tip(tip, state.node.X)
        for other in self.tips:
            between = self.path.film.between(tip, other)
            if between is None or product(other.heading, tip.heading) > ONCOMING:
                continue
            gap = self.path.film.at_tip(other, state.node.X) - here
            across = norm(gap - product(gap, tip.heading) * tip.heading)
            if across < JOIN * self.path.film.size(tip.quad):
                self.cuts.along(state, between, kind, 0.0)
                self.tips.remove(other)
                return True
        return False
