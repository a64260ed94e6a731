"""Where a cut begins in film that no crack has reached, and the first quad of it.

*On its face* the film parts where a tool presses hard enough (:mod:`.pressed_film`), *at its
border* and at the flank of another cut where an edge enters it (:mod:`.entered_film`).

The quad is cut along the trace of the mid-plane of the blade (:mod:`.blade_chords`): a short crack
with a closed tip at either end.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from shellcut.contact.sheet_contact import PointContact
from shellcut.mitc4.shell import MITC4Shell
from shellcut.numerics.kept import Kept
from shellcut.state import PUNCTURE, State
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .blade_chords import BladeChords
from .blade_drive import BladeDrive
from .entered_film import EnteredFilm
from .growth import Growth
from .own_cuts import OwnCuts
from .pressed_film import PressedFilm
from .puncture import PierceLimits
from .quad_polygon import WHOLE
from .tip import Begun, DrivenTips


class Pierce(Kept):
    """Begins cuts in whole quads.

    Parameters
    ----------
    state : State
        At the start.
    growth : Growth
        Cuts the film.
    drive : BladeDrive
        Where edges move.
    shell : MITC4Shell
        The film.
    limits : PierceLimits
        The load that the film carries on its face.
    points : PointContact, optional
        By which the tool presses on the film.
    tool, motion : Tool, Motion
        Whose cutting edges these are, and how they move.
    """

    kept_names = "_entered", "_pressed"

    def __init__(
        self,
        state: State,
        growth: Growth,
        drive: BladeDrive,
        shell: MITC4Shell,
        limits: PierceLimits,
        points: PointContact | None,
        tool: Tool,
        motion: Motion,
    ) -> None:
        self._growth, self._chain = growth, tool.edge_chain
        film, edges = growth.path.film, drive.edges
        self._own = own = OwnCuts(state, tool, limits.puncture.length, film, shell.mesh_quads)
        self._chords = BladeChords(growth.path, drive)
        self._entered = EnteredFilm(
            state, film, shell, edges, tool.edge_chain, everywhere=points is None
        )
        self._pressed: PressedFilm | None = None
        if points is not None:
            self._pressed = PressedFilm(film, shell, edges, limits, points, tool, motion, own)

    def begin_cuts(self, state: State, pose: Pose, driven: DrivenTips, work: float) -> None:
        """Cut the film that an edge enters away from the tips that its blade drives.

        Parameters
        ----------
        state : State
            Present positions; cut.
        pose : Pose
            Of the tool.
        driven : DrivenTips
            Where the cracks end that an edge drives.
        work : float
            Of the tool so far [N·mm].
        """
        every = []
        for begun in self._entered.entered_rows(state, pose):
            at = self._growth.path.film.place_in(state, begun.row, begun.place).x
            if not self._own.at_own_tip(state, begun.row, at, begun.segment, driven):
                every.append(begun)
        if self._pressed is not None:
            entered = self._pressed.not_on_face(state, pose, every)
            every = [*self._pressed.pierced_rows(state, pose, driven), *entered]
        for begun in every:
            whole = self._growth.cuts.topology.polygon(begun.row) == WHOLE
            if whole and not self._own.at_own_flank(state, begun.row, begun.segment):
                self._cut(state, begun, work)

    def idle_edge(self, state: State) -> tuple[int, float]:
        """Return which edge of a blade that has cut nothing pressed the hardest, and its load.

        Over F_p; -1 if none has pressed.
        """
        if self._pressed is None:
            return -1, 0.0
        loads = self._pressed.largest_loads()
        cut = [record.edge for record in state.split_log if record.edge >= 0]
        loads[np.isin(self._own.of_chain, self._own.of_chain[cut])] = 0.0
        edge = int(np.argmax(loads))
        return (edge, float(loads[edge])) if loads[edge] > 0.0 else (-1, 0.0)

    @property
    def flat_pressure(self) -> float:
        """Pressure up to which a film counts as flat where tips press it [MPa], inf if none do."""
        return np.inf if self._pressed is None else self._pressed.flat_pressure()

    def _cut(self, state: State, begun: Begun, work: float) -> None:
        """Cut a quad along the first chord that does so, and note how whole film was pierced."""
        growth, pierced = self._growth, begun.pierced
        kind, measure = ("blade", 0.0) if pierced is None else (PUNCTURE, pierced.measure)
        for back, ahead in self._chords.chords(state, begun, growth.tips):
            # Unsupported film is cut only from where the edge has entered.
            if pierced is None and not self._entered.leads_out(state, back):
                continue
            edge = int(self._chain[begun.segment])
            cut = growth.through(state, back, ahead, kind, measure, edge)
            if cut is None:
                continue
            if pierced is not None:
                state.split_log[-1] = replace(
                    state.split_log[-1],
                    force=pierced.force,
                    delay=pierced.delay,
                    depth=pierced.depth,
                    work=work,
                )
            growth.end_at(state, back, cut, 0, -cut.heading)
            growth.end_at(state, ahead, cut, 1, cut.heading)
            growth.cuts.renew(state)
            return
