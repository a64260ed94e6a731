"""Take one :class:`Frame`, a picture of the run at t_n, from a simulation."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from ._jit import Floats, Ints, kernel
from ._vec3 import add, cross, load, norm, scale, sub
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
    components, principal = _lamina_stress(sim)
    segments, jointed, traction = _cable_segments(sim)
    tool_points, tool_triangles, edges = np.zeros((0, 3)), np.zeros((0, 3), np.int64), None
    if sim.tool is not None:
        tool_points = sim.tool.vertices @ sim.rotation.T + sim.translation
        tool_triangles = sim.tool.triangles.astype(np.int64)
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
        quads=s.quads.astype(np.int64),
        quad_stress=components,
        quad_principal=principal,
        crack_edges=open_edge_copies(s).astype(np.int64),
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
    n = s.quads.shape[0]
    tensor = sim.shell.stress(s, np.arange(n))
    components, principal = np.empty((n, 3)), np.empty((n, 2))
    _lamina_components(
        x=s.node.x, quads=s.quads, tensor=tensor, components=components, principal=principal
    )
    return components, principal


@kernel
def _lamina_components(
    x: Floats, quads: Ints, tensor: Floats, components: Floats, principal: Floats
) -> None:
    """Write components : (n_quad, 3) and principal : (n_quad, 2) of tensor : (n_quad, 3, 3)."""
    for e in range(quads.shape[0]):
        x0, x1 = load(x, quads[e, 0]), load(x, quads[e, 1])
        x2, x3 = load(x, quads[e, 2]), load(x, quads[e, 3])
        a1 = sub(add(x1, x2), add(x0, x3))
        normal = cross(a1, sub(add(x2, x3), add(x0, x1)))
        e1 = scale(1.0 / norm(a1), a1)
        e2 = cross(normal, e1)
        e2 = scale(1.0 / norm(e2), e2)
        s11 = s22 = s12 = 0.0
        for i in range(3):
            for j in range(3):
                s11 += e1[i] * tensor[e, i, j] * e1[j]
                s22 += e2[i] * tensor[e, i, j] * e2[j]
                s12 += e1[i] * tensor[e, i, j] * e2[j]
        mean, radius = 0.5 * (s11 + s22), np.hypot(0.5 * (s11 - s22), s12)
        components[e, 0], components[e, 1], components[e, 2] = s11, s22, s12
        principal[e, 0], principal[e, 1] = mean + radius, mean - radius


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
