"""Take one :class:`Frame`, a picture of the run at t_n, from a simulation."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from .fan import open_edge_copies
from .frame import Frame
from .simulation import Simulation
from .state import BROKEN, JOINTED


def capture(
    sim: Simulation,
    *,
    coordinate: float,
    coordinate_name: str,
    coordinate_unit: str,
    scalars: Mapping[str, float] | None = None,
    scalar_units: Mapping[str, str] | None = None,
) -> Frame:
    """Return the present state as plain arrays, with stresses, crack, cables and tool.

    Parameters
    ----------
    sim : Simulation
        What to look at.
    coordinate, coordinate_name, coordinate_unit : float, str, str
        What curves are drawn over, as :class:`Frame`.
    scalars, scalar_units : mapping, optional
        Figures to go with the picture.
    """
    s, n = sim.state, sim.state.n_node
    faces = sim.shell.face_stresses(s)
    return Frame(
        time=s.time,
        coordinate=coordinate,
        coordinate_name=coordinate_name,
        coordinate_unit=coordinate_unit,
        points=s.node.x[:n],
        reference=s.node.X[:n],
        director=s.node.t[:n],
        velocity=s.node.velocity_half[:n],
        quads=s.quads.astype(np.int64),
        held=s.node.supported[:n],
        quad_stress=faces.stress[:, 0],
        quad_stress_top=faces.stress[:, 1],
        quad_stress_bottom=faces.stress[:, 2],
        quad_principal=faces.principal[:, 0],
        quad_principal_top=faces.principal[:, 1],
        quad_principal_bottom=faces.principal[:, 2],
        quad_thickness=faces.thickness,
        crack_edges=open_edge_copies(s).astype(np.int64),
        **_cables(sim),
        **_tool(sim),
        scalars=dict(scalars or {}),
        scalar_units=dict(scalar_units or {}),
    )


def _tool(sim: Simulation) -> dict[str, Any]:
    tool = sim.tool
    if tool is None:
        return {}
    points = tool.vertices @ sim.rotation.T + sim.translation
    return {
        "tool_points": points,
        "tool_triangles": tool.triangles,
        "tool_tooth": tool.triangle_body + 1,
        "tool_rotation": sim.rotation,
        "tool_translation": sim.translation,
        "edge_points": points[tool.edges],
        "edge_tooth": tool.edge_body + 1,
    }


def _cables(sim: Simulation) -> dict[str, Any]:
    c, x = sim.state.cable, sim.state.node.x
    live = np.flatnonzero(c.status[: c.count] != BROKEN)
    bent = c.status[live] == JOINTED
    straight, jointed = live[~bent], live[bent]
    minus, plus = x[c.ends[:, 0]], x[c.ends[:, 1]]
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
