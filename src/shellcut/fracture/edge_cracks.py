"""Cracks along the sides of the mesh: nodes that must split, and their splits.

[Frangi2010] splits a node along two of its edges and joins the halves by a cable. Here its quads
are parted into two groups and the sides between them break; the cables of the two half-edges are
those of the segments along these sides (:mod:`.cuts`). Which node, and along which sides, is the
question of :mod:`.criterion`.
"""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from shellcut.arrays import norm
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.loads.loads import LoadSet
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import State
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

from .criterion import Fracture, Split, SplitCriterion
from .cuts import Cuts
from .quad_fans import boundary_edges, crack_tips, is_tip, open_edges
from .quad_polygon import CORNERS
from .segment import Segment


class EdgeCracks:
    """All cracks along the sides of a mesh, notches included.

    Parameters
    ----------
    state : State
        Before the first split.
    cuts : Cuts
        Carries them out.
    fracture : Fracture
        How cracks start and run.
    law : CohesiveLaw
        Of the cables.
    shell, loads : MITC4Shell, LoadSet
        Give the forces that part a node.
    tool : Tool, optional
        For the blade-cut rule.
    """

    def __init__(
        self,
        state: State,
        cuts: Cuts,
        fracture: Fracture,
        law: CohesiveLaw,
        shell: MITC4Shell,
        loads: LoadSet,
        tool: Tool | None,
    ) -> None:
        self._cuts, self._law, self._shell = cuts, law, shell
        self._equilibrium_start = fracture.equilibrium_start
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
        self.tips = crack_tips(state)
        """Nodes at which a crack or notch ends, ascending."""

    def run(self, state: State, pose: Pose) -> None:
        """Split the nodes that are due."""
        for split in self.criterion.due(state, self.tips, pose):
            self.split(state, split)

    def split(self, state: State, split: Split) -> int:
        """Split a node; return its twin."""
        n_cable = state.n_cable
        sides = self._sides_between(state, split)
        kind = "blade" if split.blade else "criterion"
        twin = self._cuts.part(state, split.node, sides, kind, split.measure)
        self._cuts.wake(state)
        self._start_cables(state, split, twin, n_cable)
        touched = set(np.unique(state.quads[[*split.minus, *split.plus]]).tolist())
        still = [node for node in self.tips if node not in touched]
        self.tips = sorted([*still, *(node for node in touched if is_tip(state, node))])
        return twin

    def _sides_between(self, state: State, split: Split) -> list[Segment]:
        """Return the whole sides between the two groups, the minus group to their right."""
        rings = self._shell.mesh_quads
        after, before = {}, {}  # far node -> quad whose side at the node leads to it, or from it
        for quad in (*split.minus, *split.plus):
            at = int(np.flatnonzero(state.quads[quad] == split.node)[0])
            after[int(rings[quad, (at + 1) % 4])] = (quad, at)
            before[int(rings[quad, at - 1])] = quad
        sides = []
        for far, (quad, at) in after.items():
            beside = before.get(far)
            here = int(rings[quad, at])
            if beside is None or self._cuts.topology.is_broken(here, far):
                continue
            # The quad that is counter-clockwise of a side lies to its left.
            if (quad in split.minus) == (beside in split.minus):
                continue
            ahead = (at + 1) % 4
            start, stop = (ahead, at) if quad in split.minus else (at, ahead)
            sides.append(Segment(quad, CORNERS[start], CORNERS[stop], at, stop, along_side=True))
        return sides

    def _start_cables(self, state: State, split: Split, twin: int, first: int) -> None:
        """Give the new cables of a node the force that it held, if they begin with that.

        first : of the new cables.
        """
        c, strength = state.cable, self._law.strength
        new = np.arange(first, c.count)
        new = new[(np.sort(c.ends[new], axis=1) == sorted((split.node, twin))).all(axis=1)]
        pull = strength * c.area[new, None] * c.m[new]
        if self._equilibrium_start:
            part = c.area[new] / c.area[new].sum()
            c.start_force[new] = part[:, None] * split.force - pull
            return
        jump = float(norm(split.force - pull.sum(axis=0)))
        state.split_log[-1] = replace(state.split_log[-1], force_jump=jump)

    def saved(self) -> dict[str, Any]:
        """Return the tips, and what the criterion keeps."""
        return {"tips": np.array(self.tips, np.int64), "criterion": self.criterion.saved()}

    def restore(self, state: State, saved: dict[str, Any]) -> None:
        """Take over :meth:`saved`; ``state`` is restored already."""
        self.tips = saved["tips"].tolist()
        self.criterion.restore(state, saved["criterion"])
