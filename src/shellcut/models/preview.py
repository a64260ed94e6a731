"""Preview of a model before its run, also of an incomplete one."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence

import numpy as np

from shellcut.arguments import checked
from shellcut.arrays import Floats, Ints, norm
from shellcut.checks import ModelCheck, Sweep, check_model
from shellcut.loads.supports import Support, choose_nodes
from shellcut.mesh.mesh import Mesh
from shellcut.mitc4.mesh_quality import MeshQuality, mesh_quality
from shellcut.numerics.connected_parts import connected_parts
from shellcut.recording.frame_capture import Exposure
from shellcut.recording.status_line import crack_line, how_long, part_lines
from shellcut.simulation.simulation import Simulation
from shellcut.unit import shown

from .model_picture import ModelParts, draw_model

__all__ = ["ModelParts", "preview", "preview_parts"]

# Memory of the program and of each quad (docs/performance.md) [MB].
_PROGRAM_MB, _QUAD_MB = 200.0, 1e-3

_N_TIME = 60  # at which the fastest moment of a support is searched


@checked
def preview(
    simulation: Simulation,
    path: str | os.PathLike[str],
    *,
    time: float | None = None,
    check: ModelCheck | None = None,
) -> str:
    """Draw film, supported nodes, the quads that set the step, and the tool; return a report.

    Parameters
    ----------
    simulation : Simulation
        Not changed.
    path : path-like
        Picture to write; its suffix gives the format.
    time : float, optional
        End of the run [s]: the tool is also drawn at this time, cutting edges that never meet the
        film or leave it before then get their own colours, and the model is checked.
    check : ModelCheck, optional
        Check of this model up to ``time``, if already made.

    Returns
    -------
    str
        One line each: parts of the model, sizes of its sets, the first time step and its cause,
        what the run will cost, where cracks will run, the quads with the shortest steps, and the
        findings of the checks.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If ``time`` is negative or not finite.

    Examples
    --------
    >>> from shellcut import opening_test
    >>> case = opening_test("quick")
    >>> print(preview(case.simulation, "model.png", time=case.duration))  # doctest: +SKIP
    """
    if time is not None and not 0.0 <= time < np.inf:
        raise ValueError(f"time must be finite and not negative in s, got {time!r}")
    sim, mesh = simulation, simulation.mesh
    quality = mesh_quality(mesh, sim.material, damping_beta=sim.shell.damping_beta)
    step_lines = list(_step_lines(sim, quality))
    if check is None and time:
        check = check_model(sim, time)
    sweep = check.sweep if check is not None else None
    supported = np.flatnonzero(sim.state.node.supported[: mesh.n_node])
    film_now = Exposure.of(
        sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm"
    ).frame()
    parts = ModelParts(
        mesh=mesh,
        supported=supported,
        tool=sim.tool,
        motion=sim.motion_in_film(time or 0.0),
        duration=time,
        pulls=list(_pulls(sim, time)) if time else (),
        notch=film_now.reference[film_now.crack_edges[:, 0]],
    )
    cost = [_run_line(sim, time)] if time else []
    more = [*cost, crack_line(sim)]
    film, *others = _draw(parts, path, sweep, quality.worst.astype(np.int64), more=more)
    found = [f"{one.word}: {one}" for one in (check.findings if check is not None else ())]
    said = [film, *_film_lines(mesh), *step_lines, *cost, *others, crack_line(sim)]
    return "\n".join([*said, *_worst_lines(quality), *found])


def preview_parts(parts: ModelParts, path: str | os.PathLike[str]) -> str:
    """Draw the valid film and tool of a model that cannot run; return a list, one part a line."""
    if parts.mesh is None and parts.tool is None:
        raise ValueError("there is neither film nor tool to draw")
    title = "the valid parts of a refused model"
    return "\n".join(_draw(parts, path, parts.sweep(), np.zeros(0, np.int64), title))


def _draw(
    parts: ModelParts,
    path: str | os.PathLike[str],
    sweep: Sweep | None,
    worst: Ints,
    title: str = "the model before its run",
    more: Sequence[str] = (),
) -> list[str]:
    """Draw the parts with more lines below them; return a list of the parts, one per line."""
    lines = list(part_lines(parts.mesh, parts.supported.size, parts.tool, sweep))
    draw_model(parts, path, sweep, worst, title=title, caption="\n".join([*lines, *more]))
    return lines


def _pulls(sim: Simulation, time: float) -> Iterator[tuple[Floats, Floats]]:
    """Yield the middle of each support that moves, and the velocity of its fastest moment."""
    supports: Sequence[Support] = sim.inputs["supports"]  # type: ignore[assignment]
    times = np.linspace(0.0, time, _N_TIME).tolist()
    for support in supports:
        rates = [support.velocity.get(axis) for axis in "xyz"]
        each = np.array([[rate(at) if rate else 0.0 for rate in rates] for at in times])
        fastest = each[np.argmax(norm(each))]
        if fastest.any():
            yield sim.mesh.nodes[choose_nodes(sim.mesh, support.nodes)].mean(axis=0), fastest


def _film_lines(mesh: Mesh) -> Iterator[str]:
    """Yield the sizes of the sets."""
    for kind, sets, joined in (
        ("nodes", mesh.node_sets, mesh.edges().nodes),
        ("quads", mesh.quad_sets, mesh.edges().quads),
    ):
        if sets:
            n = mesh.n_node if kind == "nodes" else mesh.n_quad
            counts = (f"{name} {_extent(ids, joined, n)}" for name, ids in sets.items())
            yield f"sets   of {kind}: {', '.join(counts)}"


def _extent(ids: Ints, joined: Ints, n: int) -> str:
    """Return the size of a set and its number of pieces; ``joined`` are pairs of neighbours."""
    is_member = np.zeros(n, np.bool_)
    is_member[ids] = True
    first, second = joined[is_member[joined].all(axis=1)].T
    pieces = len(np.unique(connected_parts(first, second, n)[ids]))
    return f"{len(ids)} in {pieces} pieces" if pieces > 1 else f"{len(ids)}"


def _worst_lines(quality: MeshQuality) -> Iterator[str]:
    """Say where the quad of the smallest step is, if it is clearly below the median."""
    unit, factor = shown("mm")
    for e in quality.worst[:1].tolist():
        x, y, z = factor * quality.centre[e]
        yield (
            f"worst  quad {e} at ({x:.4g}, {y:.4g}, {z:.4g}) {unit}: "
            f"{quality.step[e] / quality.median_step:.2f} of the median step"
        )


def _run_line(sim: Simulation, time: float) -> str:
    """Say how many steps the run takes, how long, and in how much memory."""
    steps = float(f"{time / sim.dt:.2g}")
    megabytes = _PROGRAM_MB + sim.mesh.n_quad * _QUAD_MB
    return (
        f"run    at least {steps:,.0f} steps to {1e3 * time:.4g} ms, {how_long(sim, time)}; "
        f"{megabytes:.0f} MB"
    )


def _step_lines(sim: Simulation, quality: MeshQuality) -> Iterator[str]:
    """Explain the first step of the run by the stable steps of the film."""
    stepping, allowed = sim.time_step.stepping, sim.time_step.bound(sim.state)
    safe = stepping.safety * allowed
    if stepping.fixed is None:
        yield f"step   {sim.dt:.4g} s at first, {stepping.safety:g} (time.safety) of the stable"
    else:
        times = f"{stepping.fixed / allowed:.2g} times the stable one; without it {safe:.4g} s"
        yield f"step   {sim.dt:.4g} s, because time.fixed is given: {times}"
    yield (
        f"       stable: {allowed:.4g} s with contact and cables, {quality.stable_step:.4g} s for "
        f"the worst quad alone, {quality.median_step:.4g} s for the median quad"
    )
