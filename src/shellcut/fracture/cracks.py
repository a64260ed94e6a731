"""Cracks of a film: which of them are due in a step.

Read :meth:`Cracks.cut_due` first. Each stage has its file:

1. :mod:`.tip_watch`: which tips have film ahead, which of them an edge drives
   (:mod:`.blade_drive`), and which of these are due: the edge has passed them, or the force at the
   tip (:mod:`.trial_cut`) has reached what cables carry, :data:`.tip.DUE`;
2. where the others run, and whether they are due: through quads (:mod:`.free_direction`), or along
   sides (:mod:`.side_tears`);
3. the segment through the row ahead, and the tip at its end: :mod:`.crack_path`, which queries the
   film as it is cut (:mod:`.cut_film`);
4. how a crack grows along a segment, and where tips are then (:mod:`.growth`), by a cut of the mesh
   (:mod:`.cuts`);
5. where a cut begins in whole film: :mod:`.pierce`.

Notches before a run are cut by :mod:`.notch`.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.cables.cohesive_law import CohesiveTable
from shellcut.contact.sheet_contact import PointContact
from shellcut.loads.film_motion import FilmMotion
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import TEAR, KnownTopology, State
from shellcut.tool.cutting_edge import CuttingEdges
from shellcut.tool.force_term import ForceTerm
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .blade_drive import BladeDrive
from .crack_path import CrackPath
from .cut_film import CutFilm
from .cuts import Cuts
from .free_direction import FreeDirection
from .growth import Growth
from .options import Fracture
from .pierce import Pierce
from .puncture import PierceLimits, Puncture
from .quad_polygon import corner_at
from .segment_cables import AT_ENDS, BEFORE_AN_EDGE
from .side_tears import LargestStress, SideTears
from .tip import DUE, Candidate, Segment, Tip, restored_tips, saved_tips
from .tip_watch import TipWatch
from .trial_cut import TrialCut, TrialSums

_LOOKS = 10
"""How often a tip is looked at in the time that a crack takes for a quad, so that it waits for no
more than a tenth of that time."""


class Cracks:
    """All cracks of a film, notches included: through its quads, or along its sides only.

    Parameters
    ----------
    state : State
        Before the first cut.
    fracture : Fracture
        How cracks start and run.
    law : CohesiveTable
        Law of the cables that join the two flanks of a cut.
    shell, loads : MITC4Shell, LoadSet
        Give the forces that hold a film together.
    tool, motion : Tool, Motion, optional
        Whose edges cut, and how they move.
    points : PointContact, optional
        Points by which the tool presses on the sheet.
    moved : FilmMotion, optional
        Motion of a film that its supports move.
    terms : sequence of ForceTerm
        Those that may put forces on the nodes from single rows.
    """

    def __init__(
        self,
        state: State,
        fracture: Fracture,
        law: CohesiveTable,
        shell: MITC4Shell,
        loads: LoadSet,
        tool: Tool | None = None,
        motion: Motion | None = None,
        points: PointContact | None = None,
        moved: FilmMotion | None = None,
        terms: Sequence[ForceTerm] = (),
    ) -> None:
        anisotropy, fibres = fracture.anisotropy, fracture.fibres
        if fibres is None:
            fibres = BEFORE_AN_EDGE if tool is not None and tool.n_edge else AT_ENDS
        self.cuts = Cuts(state, shell, law, anisotropy, loads=loads, fibres=fibres)
        """Carries out the cuts."""
        self._check_every = fracture.check_every
        self._tearing_until = 0
        """Step from which on no tip is looked at between two checks."""
        self._shell, self._loads = shell, loads
        self._known = KnownTopology()
        topology = self.cuts.topology
        self._film = CutFilm(topology, shell, sides_only=fracture.path == "edges")
        self._path = CrackPath(self._film)
        self._trial = TrialCut(topology, shell, loads, law.strength, anisotropy, terms)
        self._sums = TrialSums(self._trial)
        self.growth = Growth(
            state, self.cuts, self._path, self._sums, exactly=fracture.equilibrium_start
        )
        """Cuts the film, and knows the tips."""
        self._sides: SideTears | None = None
        self.stress: LargestStress | None = None
        """Decides when cracks run, instead of the nodal force."""
        if self._film.sides_only:
            self._sides = SideTears(shell, self._film, self._trial, law.strength, fracture)
            self.stress = self._sides.stress
        self._direction = FreeDirection(shell, self._film, law, anisotropy)
        puncture = Puncture.of(shell.material, law)
        self.bending_length = puncture.length
        """Length over which the film bends where its tension is the strength [mm]."""
        has_edge = tool is not None and tool.n_edge > 0 and motion is not None
        self._blade_cuts = has_edge and fracture.blade_cut
        """Whether cutting edges drive cracks and begin cuts; if not, all cracks are tears."""
        if tool is not None and motion is not None and self._blade_cuts:
            drive = BladeDrive(CuttingEdges.of(tool), motion, moved)
            self._chain = tool.edge_chain
            self._watch = TipWatch(self._path, self._trial, drive, self.stress)
            limits = PierceLimits(puncture, law.strength, fracture.puncture_force)
            self._pierce = Pierce(state, self.growth, drive, shell, limits, points, tool, motion)

    def cut_due(self, state: State, pose: Pose, work: float = 0.0) -> None:
        """Advance every crack that is due, and begin cuts where blades enter.

        In every ``check_every``-th step. After a tear the next one may be due sooner: its tip is
        looked at again each time when a tenth more steps have passed.

        Parameters
        ----------
        state : State
            Positions at t_{n+1} and the length of the step there, strains and cable forces of t_n.
        pose : Pose
            Of the tool at t_{n+1}.
        work : float
            Of the tool up to t_n [N·mm], noted in the log where a cut begins.
        """
        if state.step % self._check_every:
            if state.step < self._tearing_until:
                self._advance_running(state)
            return
        if not self._blade_cuts:
            self._advance_torn(state, list(self.growth.tips))
            return
        # An edge may pass several quads between two checks: again until no tip is due.
        while self._advance_driven(state):
            pass
        # The watch has looked at all tips. First the tips that no blade drives may tear, then cuts
        # may begin where an edge drives none.
        self._advance_torn(state, self._watch.may_tear(state.step // self._check_every))
        self._pierce.begin_cuts(state, pose, self._watch.driven(), work)

    def _may_run(self, state: State, tip: Tip) -> bool:
        """Whether to look at a tip between two checks."""
        if tip.torn < 0:
            return False
        since = state.step - tip.torn
        wait = max(since // _LOOKS, 1)
        return wait < self._check_every and since % wait == 0

    def _note_tear(self, step: int) -> None:
        """Note the step of a tear, -1 of none: for a while tips are looked at between checks."""
        if step >= 0:
            self._tearing_until = max(self._tearing_until, step + _LOOKS * self._check_every)

    def _advance_running(self, state: State) -> None:
        """Advance the cracks that have just torn, are due again, and that no edge drives."""
        running = [tip for tip in self.growth.tips if self._may_run(state, tip)]
        if self._blade_cuts and running:
            alive = [tip for tip in running if self._film.rows_ahead(tip)]
            self._watch.due(state, alive, self.growth.tips)
            running = self._watch.may_tear()
        self._advance_torn(state, running)

    def _advance_torn(self, state: State, tips: Sequence[Tip]) -> None:
        """Advance those of some cracks that are due without a blade, by one quad at most.

        A crack then runs no faster than an edge length in a step.
        """
        for tip in tips:
            if not self._known.is_of(state):
                self.growth.tips = [
                    alive for alive in self.growth.tips if self._film.rows_ahead(alive)
                ]
                self._known.take(state)
            if tip not in self.growth.tips:
                continue  # another crack has just joined it
            find = self._through_quads if self._sides is None else self._sides.best
            found = find(state, tip, self.growth.tips)
            if found is None or found.measure < DUE or self._is_supported(state, found.segment):
                continue
            self.growth.along(state, tip, found.segment, TEAR, found.measure, found.force)
            self._note_tear(state.step)

    def _through_quads(self, state: State, tip: Tip, tips: Sequence[Tip]) -> Candidate | None:
        """Return along which segment a crack would run that no blade drives."""
        directions = self._direction.directions(state, tip, tips)
        found = (self._path.segment_from(state, tip, along, others=tips) for along in directions)
        segment = next((segment for segment in found if segment is not None), None)
        if segment is None:
            return None
        return Candidate(segment, self._sums.of_tear(state, tip, segment))

    def _is_supported(self, state: State, segment: Segment) -> bool:
        """Whether moving supports keep the film together through which a segment would run."""
        nodes = state.quads[segment.row]
        if self._film.sides_only:
            nodes = nodes[[corner_at(segment.entry)]]
        return bool(state.node.support_rate[nodes].any())

    def _advance_driven(self, state: State) -> bool:
        """Advance the cracks that a blade drives and that are due; return whether there are any."""
        watch, advanced = self._watch, False
        self.growth.tips = watch.alive(state, self.growth.tips)
        due = watch.due(state, self.growth.tips)
        for i, tip in [(i, tip) for i, tip in enumerate(self.growth.tips) if due[i]]:
            if advanced:  # a cut may change what the next tip has ahead: it is watched alone, anew
                there = watch.alive(state, [tip]) if tip in self.growth.tips else []
                if not watch.due(state, there, self.growth.tips).any():
                    continue
                i = 0  # the watch now has this tip only
            if segment := watch.segment(i):
                measure = float(watch.weighed.measure[i])
                kind = "criterion" if measure >= DUE else "blade"
                force, edge = watch.weighed.force[i], int(self._chain[watch.edge_of(i)])
                self.growth.along(state, tip, segment, kind, measure, force, edge)
                advanced = True
        return advanced

    @property
    def tips(self) -> list[Tip]:
        """Where cracks end and may run on."""
        return self.growth.tips

    def tip_nodes(self, state: State) -> Ints:
        """Return the nodes where cracks along sides end."""
        return self._film.nodes_of(state, self.growth.tips)

    def nodes_at_tips(self, state: State) -> Ints:
        """Return the nodes of the quads at all tips."""
        rows = [row for tip in self.growth.tips for row, _ in self._film.rows_at_tip(tip)]
        return np.unique(state.quads[rows]).astype(np.int64)

    def at_tips(self, rows: Floats) -> Floats:
        """Return rows : (n_node, k) of the mesh's nodes at all tips, shape (n_tip, k)."""
        at = [self._film.at_tip(tip, rows) for tip in self.growth.tips]
        return np.array(at).reshape(-1, rows.shape[1])

    def idle_edge(self, state: State) -> tuple[int, float]:
        """Return :meth:`.Pierce.idle_edge`, -1 if no edge cuts."""
        return self._pierce.idle_edge(state) if self._blade_cuts else (-1, 0.0)

    @property
    def flat_pressure(self) -> float:
        """Pressure up to which a film counts as flat where tips press it [MPa], inf if none do."""
        return self._pierce.flat_pressure if self._blade_cuts else np.inf

    def saved(self) -> dict[str, Any]:
        """Return what has been cut, the tips, what is known of the edges, and a count."""
        return {
            "cuts": self.cuts.saved(),
            "tips": saved_tips(self.growth.tips),
            "near": self._pierce.saved() if self._blade_cuts else {},
            "n_borrowed": 0 if self.stress is None else self.stress.n_borrowed,
        }

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        self.cuts.restore(saved["cuts"])
        self.growth.tips = restored_tips(saved["tips"])
        for tip in self.growth.tips:
            self._note_tear(tip.torn)
        if self._blade_cuts:
            self._pierce.restore(saved["near"])
        if self.stress is not None:
            self.stress.n_borrowed = saved["n_borrowed"]
