"""Capture one :class:`Frame` of a simulation at t_n: its stresses, cracks and cable branches."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from shellcut.arrays import unit
from shellcut.fracture.drawn_film import DrawnFilm
from shellcut.fracture.open_edges import crack_edges
from shellcut.frame import Frame
from shellcut.state import BROKEN, JOINTED, State
from shellcut.tool.pose import Pose
from shellcut.tool.tool import Tool

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation


def frame_of(sim: Simulation, **figures: Any) -> Frame:
    """Return the present frame; ``figures`` are further fields of it.

    Raises ValueError like :class:`Frame`.
    """
    s, cuts = sim.state, None if sim.cracks is None else sim.cracks.cuts
    n, faces = s.node, sim.shell.face_stresses(s)
    supported = n.supported[: s.n_node].copy()
    supported[sim.terms.fixed_nodes(s)] = True
    if cuts is None or cuts.along_sides_only:
        quads, own = s.quads.astype(np.int64), slice(s.n_node)
        flanks = crack_edges(quads, n.origin[own])
        film: dict[str, Any] = {
            "points": n.x[own],
            "reference": n.X[own],
            "director": n.t[own],
            "velocity": n.velocity_half[own],
            "quads": quads,
            "held": supported,
            "crack_edges": flanks[n.real[flanks].all(axis=(1, 2))],
        }
    else:  # its cut quads as polygons; virtual nodes and flank points are none
        drawn = DrawnFilm.of(s, cuts.topology)
        film = {
            "points": drawn.at_points(n.x),
            "reference": drawn.at_points(n.X),
            "director": unit(drawn.at_points(n.t)),
            "velocity": drawn.at_points(n.velocity_half),
            "quads": drawn.polygons,
            "held": drawn.all_at_points(supported),
            "crack_edges": drawn.crack_edges,
        }
    return Frame(
        time=s.time,
        **film,
        quad_stress=faces.stress[:, 0],
        quad_stress_top=faces.stress[:, 1],
        quad_stress_bottom=faces.stress[:, 2],
        quad_principal=faces.principal[:, 0],
        quad_principal_top=faces.principal[:, 1],
        quad_principal_bottom=faces.principal[:, 2],
        quad_thickness=faces.thickness,
        quad_history={**sim.shell.history_means(s), **sim.terms.by_row(s)},
        **_cables(s),
        **_placed(sim.tool, sim.pose),
        **figures,
    )


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
