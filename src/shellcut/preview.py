"""A look at a model before its run."""

from __future__ import annotations

import os

import numpy as np

from .quality import mesh_quality
from .simulation import Simulation
from .view.model_picture import ModelView, draw_model


def preview(
    simulation: Simulation, path: str | os.PathLike[str], *, time: float | None = None
) -> str:
    """Draw film, held nodes, the quads that set the step, tool and cutting edges; return a report.

    Parameters
    ----------
    simulation : Simulation
        Not changed.
    path : path-like
        Picture to write; the ending tells the format.
    time : float, optional
        A later pose of the tool that is drawn beside the first [s].

    Returns
    -------
    str
        What the model has, the step it starts with, and the quads that shorten it, a line each.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If ``time`` is not a finite number that is not negative.

    Examples
    --------
    >>> from shellcut import opening_test
    >>> case = opening_test("quick")
    >>> print(preview(case.simulation, "model.png", time=case.duration))  # doctest: +SKIP
    """
    if time is not None and not 0.0 <= time < np.inf:
        raise ValueError(f"time must be finite and not negative in s, got {time!r}")
    sim, mesh, tool = simulation, simulation.mesh, simulation.tool
    times = [0.0] if time is None or tool is None else [0.0, time]
    poses, titles = [], []
    for at in times:
        title = f"t = {1e3 * at:.4g} ms"
        if tool is not None and sim.motion is not None:
            rotation, translation = sim.motion.pose(at)
            poses.append(tool.vertices @ rotation.T + translation)
            unit = sim.motion.coordinate_unit
            place = sim.motion.coordinate(at)
            title += f", {np.degrees(place):.4g}°" if unit == "rad" else f", {place:.4g} {unit}"
        titles.append(title)
    quality = mesh_quality(mesh, sim.material, damping_beta=sim.shell.damping_beta)
    held = np.flatnonzero(sim.state.node.supported[: mesh.n_node])
    lines = [
        f"film   {mesh.n_node} nodes, {mesh.n_quad} quads, {mesh.quad_areas().sum():.5g} mm², "
        f"{held.size} nodes held",
        f"step   {sim.dt:.4g} s; the worst quad shortens the step to {quality.step_cost:.2f} of "
        "the median quad's",
    ]
    if tool is not None:
        lines.append(
            f"tool   {tool.n_body} bodies, {tool.n_triangle} triangles, "
            f"{tool.n_chain} cutting edges"
        )
    draw_model(
        ModelView(
            nodes=mesh.nodes,
            quads=np.asarray(mesh.quads, np.int64),
            held=held,
            worst=quality.worst.astype(np.int64),
            tool=poses,
            triangles=np.zeros((0, 3), np.int64) if tool is None else np.asarray(tool.triangles),
            edges=np.zeros((0, 2), np.int64) if tool is None else np.asarray(tool.edges),
            titles=titles,
        ),
        path,
        title="the model before its run",
        caption="\n".join(lines),
    )
    median = float(np.median(quality.step))
    for e in quality.worst.tolist():
        x, y, z = quality.centre[e]
        lines.append(
            f"       quad {e} at ({x:.4g}, {y:.4g}, {z:.4g}) mm: step {quality.step[e]:.3g} s, "
            f"{quality.step[e] / median:.2f} of the median"
        )
    return "\n".join(lines)
