"""The cracks of a film: along the sides of the mesh or through its quads."""

from __future__ import annotations

from typing import Any

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.contact.sheet_contact import PointContact
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .cuts import Cuts
from .free_cracks import FreeCracks
from .options import Fracture


class Cracks:
    """All cracks of a film, notches included.

    Parameters
    ----------
    state : State
        Before the first cut.
    fracture : Fracture
        How cracks start and run.
    law : CohesiveLaw
        Of the cables that join the two sides of a cut.
    shell, loads : MITC4Shell, LoadSet
        Give the forces that hold a film together.
    tool : Tool, optional
        Whose edges cut.
    motion : Motion, optional
        Of the tool, for cracks through quads.
    points : PointContact, optional
        By which the tool presses on whole film.
    """

    def __init__(
        self,
        state: State,
        fracture: Fracture,
        law: CohesiveLaw,
        shell: MITC4Shell,
        loads: LoadSet,
        tool: Tool | None,
        motion: Motion | None = None,
        points: PointContact | None = None,
    ) -> None:
        if tool is not None and not tool.n_edge:
            tool = None  # a blunt tool cuts nothing: it only pushes
        self._check_every = fracture.check_every
        self.cuts = Cuts(
            state,
            shell,
            law,
            fracture.anisotropy,
            loads=loads,
            at_gauss_points=fracture.cable_places == "gauss",
        )
        """Carries them out."""
        self.free = FreeCracks(state, self.cuts, fracture, law, shell, loads, tool, motion, points)

    def cut_due(self, state: State, pose: Pose) -> None:
        """Cut what must be cut now, in every ``check_every``-th step.

        Parameters
        ----------
        state : State
            Positions at t_{n+1} and the length of the step there, strains and cable forces of t_n.
        pose : Pose
            Of the tool at t_{n+1}.
        """
        if state.step % self._check_every:
            return
        self.free.run(state, pose)

    def forget(self, state: State) -> None:
        """Give up the tips in film that has been taken out."""
        self.free.forget(state)

    def saved(self) -> dict[str, Any]:
        """Return what has been cut, and where the cracks end."""
        return {"cuts": self.cuts.saved(), "free": self.free.saved()}

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        self.cuts.restore(saved["cuts"])
        self.free.restore(state, saved["free"])
