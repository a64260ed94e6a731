"""Take one :class:`Frame`, a picture of the run at t_n, from a simulation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ._jit import Floats
from .fan import open_edges
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
    components, principal = _lamina_stress(sim)
    segments, jointed, traction = _cable_segments(sim)
    crack = [list(copies) for copies in open_edges(s).values()]
    tool_points, tool_triangles, edges = np.zeros((0, 3)), np.zeros((0, 3), np.int64), None
    if sim.tool is not None:
        tool_points = sim.tool.vertices @ sim.rotation.T + sim.translation
        tool_triangles = sim.tool.triangles
        edges = tool_points[sim.tool.edges]
    return Frame(
        time=s.time,
        coordinate=coordinate,
        coordinate_name=coordinate_name,
        coordinate_unit=coordinate_unit,
        points=s.node.x[:n],
        reference=s.node.X[:n],
        director=s.node.t[:n],
        velocity=s.node.velocity_half[:n],
        quads=s.quads,
        quad_stress=components,
        quad_principal=principal,
        crack_edges=np.array(crack, np.int64).reshape(-1, 2, 2),
        cable_segments=segments,
        cable_state=jointed,
        cable_traction=traction,
        tool_points=tool_points,
        tool_triangles=tool_triangles,
        edge_points=np.zeros((0, 2, 3)) if edges is None else edges,
        scalars=dict(scalars or {}),
        scalar_units=dict(scalar_units or {}),
    )


def _lamina_stress(sim: Simulation) -> tuple[Floats, Floats]:
    """Return s11, s22, s12 in the frame of each quad's first edge, and the principal stresses."""
    s = sim.state
    tensor = sim.shell.stress(s, np.arange(s.quads.shape[0]))
    x = s.node.x[s.quads]
    a1 = x[:, 1] + x[:, 2] - x[:, 0] - x[:, 3]
    a2 = x[:, 2] + x[:, 3] - x[:, 0] - x[:, 1]
    normal = np.cross(a1, a2)
    e1 = a1 / np.linalg.norm(a1, axis=1, keepdims=True)
    e2 = np.cross(normal, e1)
    e2 /= np.linalg.norm(e2, axis=1, keepdims=True)

    def component(a: Floats, b: Floats) -> Floats:
        return np.asarray(np.einsum("ei,eij,ej->e", a, tensor, b))

    s11, s22, s12 = component(e1, e1), component(e2, e2), component(e1, e2)
    mean, radius = 0.5 * (s11 + s22), np.hypot(0.5 * (s11 - s22), s12)
    return np.stack([s11, s22, s12], axis=1), np.stack([mean + radius, mean - radius], axis=1)


def _cable_segments(
    sim: Simulation,
) -> tuple[Floats, np.ndarray[tuple[int, ...], np.dtype[np.int8]], Floats]:
    c, x = sim.state.cable, sim.state.node.x
    live = np.flatnonzero(c.status[: c.count] != BROKEN)
    bent = c.status[live] == JOINTED
    straight, jointed = live[~bent], live[bent]
    minus, plus = x[c.ends[:, 0]], x[c.ends[:, 1]]
    parts = [
        np.stack([minus[straight], plus[straight]], axis=1),
        np.stack([minus[jointed], c.joint[jointed]], axis=1),
        np.stack([c.joint[jointed], plus[jointed]], axis=1),
    ]
    order = np.concatenate([straight, jointed, jointed])
    state = np.repeat(np.array([0, 1], np.int8), [straight.size, 2 * jointed.size])
    return np.concatenate(parts), state, c.traction[order]
