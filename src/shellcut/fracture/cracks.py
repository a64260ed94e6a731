"""The cracks of a film: where they end, and the splits by which they grow."""

from __future__ import annotations

from typing import Any

import numpy as np

from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State
from shellcut.tool.motion import Motion
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .criterion import Fracture, SplitCriterion
from .free_cracks import FreeCracks
from .quad_fans import boundary_edges, crack_tips, is_tip, open_edges
from .split_node import split_node


class Cracks:
    """All cracks of a film, notches included.

    Parameters
    ----------
    state : State
        Before the first split.
    fracture : Fracture
        How cracks start and run.
    law : CohesiveLaw
        Of the cables that join the two sides of a split.
    shell, loads : MITC4Shell, LoadSet
        Give the forces that part a node.
    tool : Tool, optional
        For the blade-cut rule.
    motion : Motion, optional
        Of the tool, for cracks through quads.
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
    ) -> None:
        self._fracture, self._law, self._shell = fracture, law, shell
        self.criterion = SplitCriterion(
            fracture,
            law.strength,
            shell,
            loads,
            tool,
            free_edges=frozenset(open_edges(state)),
            rim=np.unique(boundary_edges(state)),
        )
        """Finds the nodes that must split."""
        self.free: FreeCracks | None = None
        """Cracks through the quads, instead of along their edges."""
        if fracture is not None and fracture.path == "free":
            self.free = FreeCracks(state, shell, loads, law, fracture, tool, motion)
        self.tips = crack_tips(state)
        """Nodes at which a crack or notch ends, ascending."""

    def split_due(self, state: State, pose: Pose) -> None:
        """Split the nodes that must split now, in every ``check_every``-th step.

        Parameters
        ----------
        state : State
            Positions at t_{n+1} and the length of the step there, strains and cable forces of t_n.
        pose : Pose
            Of the tool at t_{n+1}.
        """
        if state.step % self._fracture.check_every:
            return
        if self.free is not None:
            self.free.run(state, pose)
            return
        start = self._fracture.equilibrium_start
        for split in self.criterion.due(state, self.tips, pose):
            touched = np.unique(state.quads[[*split.minus, *split.plus]]).tolist()
            twin = split_node(state, split, self._shell, self._law, equilibrium_start=start)
            tips = {n for n in self.tips if n not in touched}
            tips |= {n for n in (*touched, twin) if is_tip(state, n)}
            self.tips = sorted(tips)

    def saved(self) -> dict[str, Any]:
        """Return the tips, and what the criterion keeps."""
        saved = {"tips": np.array(self.tips, np.int64), "criterion": self.criterion.saved()}
        if self.free is not None:
            saved["free"] = self.free.saved()
        return saved

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        self.tips = saved["tips"].tolist()
        self.criterion.restore(state, saved["criterion"])
        if self.free is not None:
            self.free.restore(saved["free"])
