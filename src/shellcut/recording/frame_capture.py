"""Capture one :class:`Frame` of a simulation at t_n.

Most of the work is deriving stresses, crack and cable branches from the state. If the run continues
meanwhile, it only waits for an :class:`Exposure`, which copies the arrays that change.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, TypeVar

import numpy as np

from shellcut.arrays import Floats, unit
from shellcut.fracture.drawn_film import DrawnFilm
from shellcut.fracture.open_edges import crack_edges
from shellcut.frame import Frame
from shellcut.mitc4.centre_stress import FaceStresses
from shellcut.mitc4.shell import MITC4Shell
from shellcut.state import BROKEN, JOINTED, CableTable, NodeTable, QuadTable, State
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

# Node arrays that a frame needs and that change during the run; only these are copied.
_OF_NODES = (
    *("x", "t", "velocity_half", "supported", "halved", "real", "origin"),
    *("quads", "n_quad_at"),
)
_OF_CABLES = ("ends", "far", "share", "status", "joint", "traction", "opening")

_Table = TypeVar("_Table", NodeTable, CableTable, QuadTable)


@dataclass(frozen=True)
class Exposure:
    """Copies of everything a frame needs at t_n, so that the simulation can continue."""

    _shell: MITC4Shell
    _tool: Tool | None
    _pose: Pose
    _state: State
    _drawn: DrawnFilm | None
    _stresses: tuple[FaceStresses, dict[str, Floats]] | None
    """Of a film that is not linear. They take the shell's blocks, which follow the state they are
    asked for: in another thread they would take them away from the forces."""
    _shown: Mapping[str, Floats]
    """Of force terms."""
    _figures: Mapping[str, Any]

    @classmethod
    def of(cls, sim: Simulation, **figures: Any) -> Exposure:
        """Copy the arrays that change; ``figures`` are further fields of :class:`Frame`."""
        s = sim.state
        state = replace(
            s,
            node=_copied(s.node, _OF_NODES),
            cable=_copied(s.cable, _OF_CABLES),
            quad=_copied(s.quad, ("nodes",)),
        )
        cuts = None if sim.cracks is None else sim.cracks.cuts
        drawn = None if cuts is None or cuts.along_sides_only else DrawnFilm.of(s, cuts.topology)
        state.node.supported[sim.terms.fixed_nodes(s)] = True  # of the copy
        stresses = None
        if not sim.material.is_linear:
            stresses = sim.shell.face_stresses(s), sim.shell.history_means(s)
        shown = sim.terms.by_row(s)
        return cls(sim.shell, sim.tool, sim.pose.copied(), state, drawn, stresses, shown, figures)

    def frame(self) -> Frame:
        """Return the frame; raises ValueError like :class:`Frame`."""
        s = self._state
        faces, history = self._stresses or (
            self._shell.face_stresses(s),
            self._shell.history_means(s),
        )
        stress, principal = faces.stress, faces.principal
        n, drawn = s.node, self._drawn
        if drawn is None:
            quads, own = s.quads.astype(np.int64), slice(s.n_node)
            flanks = crack_edges(quads, n.origin[own])
            film: dict[str, Any] = {
                "points": n.x[own],
                "reference": n.X[own],
                "director": n.t[own],
                "velocity": n.velocity_half[own],
                "quads": quads,
                "held": n.supported[own],
                "crack_edges": flanks[n.real[flanks].all(axis=(1, 2))],
            }
        else:  # its cut quads as polygons; virtual nodes and flank points are none
            film = {
                "points": drawn.at_points(n.x),
                "reference": drawn.at_points(n.X),
                "director": unit(drawn.at_points(n.t)),
                "velocity": drawn.at_points(n.velocity_half),
                "quads": drawn.polygons,
                "held": drawn.all_at_points(n.supported),
                "crack_edges": drawn.crack_edges,
            }
        return Frame(
            time=s.time,
            **film,
            quad_stress=stress[:, 0],
            quad_stress_top=stress[:, 1],
            quad_stress_bottom=stress[:, 2],
            quad_principal=principal[:, 0],
            quad_principal_top=principal[:, 1],
            quad_principal_bottom=principal[:, 2],
            quad_thickness=faces.thickness,
            quad_history={**history, **self._shown},
            **_cables(s),
            **_placed(self._tool, self._pose),
            **self._figures,
        )


def _copied(table: _Table, names: tuple[str, ...]) -> _Table:
    """Return a table with copies of the named arrays; it shares the others."""
    return replace(table, **{name: getattr(table, name).copy(order="K") for name in names})


def _placed(tool: Tool | None, pose: Pose) -> dict[str, Any]:
    if tool is None:
        return {}
    points = pose.to_space(tool.vertices)
    return {
        "tool_points": points,
        "tool_triangles": tool.triangles,
        "tool_tooth": tool.triangle_tooth + 1,
        "tool_rotation": pose.rotation,
        "tool_translation": pose.translation,
        "edge_points": points[tool.edges],
        "edge_tooth": tool.edge_tooth + 1,
    }


def _cables(state: State) -> dict[str, Any]:
    c = state.cable
    live = np.flatnonzero(c.status[: c.count] != BROKEN)
    bent = c.status[live] == JOINTED
    straight, jointed = live[~bent], live[bent]
    minus, plus = c.at_ends(state.node.x).transpose(1, 0, 2)
    branches = [
        np.stack([minus[straight], plus[straight]], axis=1),
        np.stack([minus[jointed], c.joint[jointed]], axis=1),
        np.stack([c.joint[jointed], plus[jointed]], axis=1),
    ]
    order = np.concatenate([straight, jointed, jointed])
    return {
        "cable_segments": np.concatenate(branches),
        "cable_state": np.repeat(np.array([0, 1], np.int8), [straight.size, 2 * jointed.size]),
        "cable_traction": c.traction[order],
        "cable_opening": c.opening[order],
    }
