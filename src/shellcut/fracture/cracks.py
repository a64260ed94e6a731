"""Cracks of a film: who is due, and how a crack advances by one quad or side.

Read :meth:`Cracks.cut_due` first. Each part has its file: where a crack goes (:mod:`.crack_path`),
when it is due (:mod:`.trial_cut`), which tips a blade drives (:mod:`.blade_drive`, all at once
:mod:`.tip_watch`), where the others run (:mod:`.free_direction`, along sides only
:mod:`.side_tears`), where a cut begins (:mod:`.pierce`), and the cut itself (:mod:`.cuts`).
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.contact.sheet_contact import PointContact
from shellcut.loads.film_motion import FilmMotion
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.bilinear import shape_functions
from shellcut.state import NOTCH, TEAR, KnownTopology, State
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .blade_drive import BladeDrive
from .crack_path import ONCOMING, CrackPath
from .cuts import Cut, Cuts
from .free_direction import FreeDirection
from .notch_line import NotchLine, row_at
from .options import Fracture
from .pierce import Begun, Pierce, PierceLimits
from .puncture import Puncture
from .quad_polygon import FLANK, WHOLE, common_side, corner_at
from .ray_ahead import JOIN
from .segment_cables import AT_ENDS, BEFORE_AN_EDGE
from .side_tears import Due, LargestStress, SideTears
from .tip import Place, Segment, Tip, restored_tips, saved_tips, tips_of_notches
from .tip_watch import TipWatch
from .trial_cut import TrialCut, TrialSums

_SAME_PLACE = 1e-6
"""Of the local edge length: tips that are no farther from each other are at one place."""


class Cracks:
    """All cracks of a film, notches included: through its quads, or along its sides only.

    Parameters
    ----------
    state : State
        Before the first cut.
    fracture : Fracture
        How they start and run.
    law : CohesiveLaw
        Of the cables that join the two sides of a cut.
    shell, loads : MITC4Shell, LoadSet
        Give the forces that hold a film together.
    tool, motion : Tool, Motion, optional
        Whose edges cut, and how they move.
    points : PointContact, optional
        By which the tool presses on the sheet.
    moved : FilmMotion, optional
        Of a film that its supports move.
    """

    def __init__(
        self,
        state: State,
        fracture: Fracture,
        law: CohesiveLaw,
        shell: MITC4Shell,
        loads: LoadSet,
        tool: Tool | None = None,
        motion: Motion | None = None,
        points: PointContact | None = None,
        moved: FilmMotion | None = None,
    ) -> None:
        film, fibres = fracture.anisotropy, fracture.fibres
        if fibres is None:
            fibres = BEFORE_AN_EDGE if tool is not None and tool.n_edge else AT_ENDS
        self.cuts = Cuts(state, shell, law, film, loads=loads, fibres=fibres)
        """Carries them out."""
        self.tips = tips_of_notches(state)
        self._check_every = fracture.check_every
        self._shell, self._loads = shell, loads
        self._known = KnownTopology()
        topology = self.cuts.topology
        self._path = CrackPath(topology, shell, sides_only=fracture.path == "edges")
        self._exactly = fracture.equilibrium_start
        self._trial = TrialCut(topology, shell, loads, law.strength, film)
        self._sums = TrialSums(self._trial)
        self._sides: SideTears | None = None
        self.stress: LargestStress | None = None
        """Decides when cracks run, instead of the nodal force."""
        if self._path.sides_only:
            self._sides = SideTears(shell, self._path, self._trial, law.strength, fracture)
            self.stress = self._sides.stress
        self._direction = FreeDirection(shell, topology, self._path, law, film)
        puncture = Puncture.of(shell.material, law)
        self.bending_length = puncture.length
        """Over which the film bends where its tension is the strength [mm]."""
        self._pierce: Pierce | None = None
        self._drive: BladeDrive
        self._watch: TipWatch
        # A blunt tool cuts nothing: it only pushes.
        if tool is not None and tool.n_edge and motion is not None and fracture.blade_cut:
            drive = BladeDrive(CuttingEdges.of(tool), motion, moved)
            self._drive = drive
            self._watch = TipWatch(self._path, self._trial, drive, self.stress)
            self._chain = tool.edge_chain
            limits = PierceLimits(puncture, law.strength, fracture.puncture_force)
            self._pierce = Pierce(state, self._path, drive, shell, limits, points, tool, motion)

    def cut_due(self, state: State, pose: Pose, work: float = 0.0) -> None:
        """Advance every crack that is due, and begin cuts where blades enter.

        In every ``check_every``-th step.

        Parameters
        ----------
        state : State
            Positions at t_{n+1} and the length of the step there, strains and cable forces of t_n.
        pose : Pose
            Of the tool at t_{n+1}.
        work : float
            Of the tool up to t_n [N·mm].
        """
        if state.step % self._check_every:
            return
        if self._pierce is None:
            self._advance_free(state, list(self.tips))
            return
        while self._advance_driven(state):
            pass
        self._advance_free(state, self._watch.may_tear(state.step // self._check_every))
        self._begin_cuts(state, pose, work)

    def _advance_free(self, state: State, tips: Sequence[Tip]) -> None:
        """Advance those of some cracks that are due without a blade, by one quad at most.

        A crack then runs no faster than an edge length in ``check_every`` steps.
        """
        for tip in tips:
            if not self._known.is_of(state):
                self.tips = [one for one in self.tips if self._path.rows_ahead(one)]
                self._known.take(state)
            if tip not in self.tips:
                continue  # another crack has just joined it
            find = self._through_quads if self._sides is None else self._sides.best
            due = find(state, tip, self.tips)
            if due is None or due.measure < 1.0 or self._is_held(state, due.segment):
                continue
            self._advance(state, tip, due.segment, TEAR, due.measure, due.force)

    def _through_quads(self, state: State, tip: Tip, tips: Sequence[Tip]) -> Due | None:
        """Return along which segment a crack would run that no blade drives."""
        ways = self._direction.ways(state, tip, tips)
        found = (self._path.segment_from(state, tip, way, others=tips) for way in ways)
        segment = next((one for one in found if one is not None), None)
        if segment is None:
            return None
        return Due(segment, self._sums.of_tear(state, segment))

    def _is_held(self, state: State, segment: Segment) -> bool:
        """Whether moving supports hold the film together through which a segment would go."""
        nodes = state.quads[segment.row]
        if self._path.sides_only:
            nodes = nodes[[corner_at(segment.entry)]]
        return bool(state.node.support_rate[nodes].any())

    def notch(self, state: State, points: Floats) -> None:
        """Cut the film along a line through points, see :meth:`.Simulation.notch`.

        points : (n, 3) [mm].
        """
        line, before = NotchLine(points), len(state.split_log)
        tip = self._slit(state, line)
        for start, stop in itertools.pairwise(points):
            # The line may have more than its first point before the rim.
            tip = tip or self._path.rim_tip(state, start, stop)
            if tip is not None or row_at(state, stop) is not None:
                break
        if tip is None:
            raise ValueError(
                f"a notch must begin within a quad or at the rim, but its line from "
                f"{points[0].tolist()} to {stop.tolist()} mm begins on a side of quads or crosses "
                "no side of the rim: move its first point"
            )
        going: Tip | None = tip
        at: Place | None = None
        while going is not None and (ahead := self._path.rows_ahead(going)):
            at = self._path.place_in(state, *ahead[0])
            here = self._path.at_tip(going, state.node.X)
            quads = state.node.X[state.quads[[row for row, _ in ahead]]]
            way, lean = line.direction(here, at, quads)
            segment = self._path.segment_from(state, going, way, lean, self.tips)
            if segment is None:
                break
            cut = self._cut(state, segment, NOTCH, 0.0)
            going = self._tip_after(state, segment, cut, 1, going.heading)
            if going is None:
                break
            there, at_cut = self._path.at_tip(going, state.node.X), going.flank is not None
            if line.ends(there, cut.length, at_cut=at_cut):
                self.tips.append(going)
                return
        if len(state.split_log) == before:
            raise ValueError(
                f"a notch must lead into the film, got one at {points[0].tolist()} mm that "
                "leaves it there: move its first point into the film, off the sides of quads"
            )
        further = None if at is None else line.point_ahead(at.size)
        if further is not None and row_at(state, further) is not None:
            raise ValueError(
                f"a notch must be a line that quads can follow, got one from {points[0].tolist()} "
                f"mm that ends after {here.tolist()} mm although its line goes on in the film: it "
                "turns too sharply there, or comes to a hole or a cut; take a finer mesh, round "
                "the corner, or notch the rest by itself"
            )

    def _slit(self, state: State, line: NotchLine) -> Tip | None:
        """Cut the quad in which a notch within the film begins; return the tip where it goes on."""
        found = row_at(state, line.start)
        if found is None or self.cuts.topology.polygon(found[0]) != WHOLE:
            return None
        row, place = found
        at = self._path.place_in(state, row, place)
        way, lean = line.direction(line.start, at, state.node.X[state.quads[[row]]])
        back, ahead = (self._path.segment(state, row, place, w, lean) for w in (-way, way))
        if back is None or ahead is None:
            return None
        cut = self._through(state, back, ahead, NOTCH)
        if cut is None:
            return None
        behind = self._tip_after(state, back, cut, 0, -cut.heading)
        if behind is not None:
            self.tips.append(behind)
        return self._tip_after(state, ahead, cut, 1, cut.heading)

    def _through(
        self, state: State, back: Segment, ahead: Segment, kind: str, measure: float = 0.0
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
        elif min(back.corner, end) < 0 or not self._path.may_break(row, back.corner, end):
            return None
        else:
            chord = Segment(row, start, stop, side, end, along_side=True)
        return self._cut(state, chord, kind, measure)

    def _advance_driven(self, state: State) -> bool:
        """Advance the cracks that a blade drives and that are due; return whether there are any."""
        watch, went_on = self._watch, False
        self.tips = watch.alive(state, self.tips)
        due = watch.due(state, self.tips)
        for i, tip in [one for one in enumerate(self.tips) if due[one[0]]]:
            if went_on:  # a cut may change what the next one has ahead
                there = watch.alive(state, [tip]) if tip in self.tips else []
                i, due = 0, watch.due(state, there, self.tips)
            if due[i:].any() and (segment := watch.segment(i)):
                measure = float(watch.weighed.measure[i])
                kind = "criterion" if measure >= 1.0 else "blade"
                self._advance(state, tip, segment, kind, measure, watch.weighed.force[i])
                went_on = True
        return went_on

    def _cut(self, state: State, segment: Segment, kind: str, measure: float) -> Cut:
        """Cut along a segment; tips that lie on it keep what is behind them."""
        cut = self.cuts.along(state, segment, kind, measure)
        for tip in self.tips:
            if segment.row in tip.behind and not segment.along_side:
                tip.behind = (*tip.behind, cut.rows[1])
        return cut

    def _advance(
        self,
        state: State,
        tip: Tip,
        segment: Segment,
        kind: str,
        measure: float,
        force: Floats | None = None,
    ) -> None:
        """Run a crack on along a segment.

        force : F_c of a crack along a side, which its first cables take over.
        """
        n_cable, forces = state.n_cable, [] if force is None else [force.copy()]
        if self._exactly:
            forces.append(-self._sums.at_start(state, segment.reversed()))
        self.tips.remove(tip)
        cut = self._cut(state, segment, kind, measure)
        self._end_at(state, segment, cut, 1, tip.heading)
        self.cuts.renew(state)
        if segment.along_side:
            self.cuts.hand_over(state, cut, forces, n_cable, exactly=self._exactly)

    def _end_at(self, state: State, segment: Segment, cut: Cut, end: int, came: Floats) -> None:
        """Put a tip where the crack goes on from an end of what has been cut."""
        tip = self._tip_after(state, segment, cut, end, came)
        if tip is not None:
            self.tips.append(tip)

    def _tip_after(
        self, state: State, segment: Segment, cut: Cut, end: int, came: Floats
    ) -> Tip | None:
        """Return the tip at an end of what has been cut, None at a rim.

        Where the crack is open there it has come to a rim or to another crack, whose tip there is
        one no more: it goes on from the other flank, unless that crack has come towards it; the two
        are one then. Tips of other cracks at that place stay.

        segment : leads to that end.  end : 0 where the cut starts, 1 where it stops.  came : (3,),
        heading before the cut.
        """
        heading = cut.heading if end else -cut.heading
        if segment.side != FLANK and not cut.is_open(state, end):
            tip = self._path.tip_at(segment, heading)
            return None if tip is None or self._joins_along_a_side(state, tip, cut.kind) else tip
        here = product(shape_functions(*segment.exit), state.node.X[state.quads[segment.row]])
        near = _SAME_PLACE * self._path.size(segment.row)
        gaps = [norm(self._path.at_tip(tip, state.node.X) - here) for tip in self.tips]
        there = [tip for tip, gap in zip(self.tips, gaps, strict=True) if gap < near]
        joined = min(there, key=lambda tip: float(product(tip.heading, came)), default=None)
        if joined is not None and product(joined.heading, came) < ONCOMING:
            self.tips.remove(joined)
            return None
        if cut.kind == TEAR:
            return None  # it ends at the edges of the film
        self.tips = [tip for tip, gap in zip(self.tips, gaps, strict=True) if gap >= near]
        return self._path.tip_across(state, segment, heading)

    def _joins_along_a_side(self, state: State, tip: Tip, kind: str) -> bool:
        """Tear a side from a new tip to an oncoming crack that ends on it; return whether one does.

        kind : of the cut.
        """
        here = self._path.at_tip(tip, state.node.X)
        for other in self.tips:
            between = self._path.between(tip, other)
            if between is None or product(other.heading, tip.heading) > ONCOMING:
                continue
            gap = self._path.at_tip(other, state.node.X) - here
            across = norm(gap - product(gap, tip.heading) * tip.heading)
            if across < JOIN * self._path.size(tip.quad):
                self.cuts.along(state, between, kind, 0.0)
                self.tips.remove(other)
                return True
        return False

    def _begin_cuts(self, state: State, pose: Pose, work: float) -> None:
        """Cut the film that an edge goes through away from the tips that it drives."""
        assert self._pierce is not None
        driven = self._watch.driven_places()
        for begun in self._pierce.found(state, pose, driven):
            whole = self.cuts.topology.polygon(begun.row)
            # The edge runs between the flanks of its own cut, which has halved nodes or quads.
            if state.node.halved[state.quads[begun.row]].any() or whole != WHOLE:
                continue
            pierced = self._pierced(state, begun) if begun.measure else None
            for back, ahead in self._pierce.ways(state, begun, self.tips):
                kind = "blade" if pierced is None else "puncture"
                cut = self._through(state, back, ahead, kind, begun.measure)
                if cut is not None:
                    break
            else:
                continue
            if pierced is not None:
                state.split_log[-1] = replace(state.split_log[-1], work=work, **pierced)
            self._end_at(state, back, cut, 0, -cut.heading)
            self._end_at(state, ahead, cut, 1, cut.heading)
            self.cuts.renew(state)

    def _pierced(self, state: State, begun: Begun) -> dict[str, Any]:
        """Return for the record of a cut how whole film is pierced."""
        at = self._path.place_in(state, begun.row, begun.place)
        weights = np.array(shape_functions(*begun.place))
        reference = product(weights, state.node.X[state.quads[begun.row]])
        return {
            "edge": int(self._chain[begun.segment]),
            "force": begun.force,
            "delay": begun.delay,
            "depth": abs(float(product(at.x - reference, at.T))),
        }

    def tip_nodes(self, state: State) -> Ints:
        """Return the nodes where cracks along sides end."""
        return self._path.nodes_of(state, self.tips)

    def at_tips(self, rows: Floats) -> Floats:
        """Return rows : (n_node, k) of the mesh's nodes at all tips, shape (n_tip, k)."""
        at = [self._path.at_tip(tip, rows) for tip in self.tips]
        return np.array(at).reshape(-1, rows.shape[1])

    def saved(self) -> dict[str, Any]:
        """Return what has been cut, the tips, what is known of the edges, and a count."""
        return {
            "cuts": self.cuts.saved(),
            "tips": saved_tips(self.tips),
            "near": {} if self._pierce is None else self._pierce.saved(),
            "n_borrowed": 0 if self.stress is None else self.stress.n_borrowed,
        }

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        self.cuts.restore(saved["cuts"])
        self.tips = restored_tips(saved["tips"])
        if self._pierce is not None:
            self._pierce.restore(state, saved["near"])
        if self.stress is not None:
            self.stress.n_borrowed = saved["n_borrowed"]
