"""Preview of a model before its run, also of an incomplete one: a picture and a report."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from shellcut.arguments import checked
from shellcut.arrays import Floats, Ints, norm, product, unit
from shellcut.checks import ModelCheck, Sweep, check_model
from shellcut.formats.errors import counted
from shellcut.loads.film_motion import SeenFromFilm
from shellcut.loads.supports import Support, choose_nodes
from shellcut.mesh.mesh import Mesh
from shellcut.mitc4.mesh_quality import MeshQuality, mesh_quality
from shellcut.numerics.connected_parts import connected_parts
from shellcut.recording.frame_capture import frame_of
from shellcut.recording.status_line import crack_line, how_long, part_lines
from shellcut.simulation.simulation import Simulation
from shellcut.tool.coordinate import HasCoordinate
from shellcut.tool.motion import Motion
from shellcut.tool.pose_of_motion import pose_at
from shellcut.tool.tool import Tool
from shellcut.unit import in_unit, shown, with_unit
from shellcut.view import add_lines, mesh_edges, new_figure, save

_FILM_COLOR = "0.55"
_SUPPORTED_COLOR = "#1d3557"
_WORST_COLOR = "#f4a259"
_TOOL_COLOR = "#a8b0ba"
_PATH_COLOR = "#2a9d8f"
_TRACK_COLOR = "#3d3d3d"
_NOTCH_COLOR = "#111111"
_PULL_COLOR = "#d1495b"
_STAYS, _LEAVES, _NEVER = "#c1121f", "#9d4edd", "#0077b6"
"""Colours of the cutting edges: in the film until the end, leaving it, never in it."""

_ARROW = 0.12  # length over the film's extent
_N_POSE = 60  # poses on the path of the tool that is drawn

# Memory of the program and of each quad (docs/performance.md) [MB].
_PROGRAM_MB, _QUAD_MB = 200.0, 1e-3

_N_TIME = 60  # at which the fastest moment of a support is searched


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelParts:
    """Parts of a model; None for a part that could not be built."""

    mesh: Mesh | None = None
    supported: Ints = field(default_factory=lambda: np.zeros(0, np.int64))
    """Supported nodes."""
    tool: Tool | None = None
    motion: Motion | None = None
    duration: float | None = None
    """[s]"""
    pulls: Sequence[tuple[Floats, Floats]] = ()
    """Middle [mm] and direction of every support that moves."""
    notch: Floats = field(default_factory=lambda: np.zeros((0, 2, 3)))
    """Where the film is cut, shape (n, 2, 3) [mm]."""

    def sweep(self) -> Sweep | None:
        """Return the path of the cutting edges, if all parts for it exist."""
        if self.mesh is None or self.tool is None or self.motion is None or self.duration is None:
            return None
        if not self.tool.n_edge:
            return None
        return Sweep.of(self.mesh, self.tool, self.motion, self.duration)


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
    film_now = frame_of(sim, coordinate=0.0, coordinate_name="path", coordinate_unit="mm")
    parts = ModelParts(
        mesh=mesh,
        supported=supported,
        tool=sim.tool,
        motion=sim.motion_in_film,
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


# --- the picture ----------------------------------------------------------------------------------


def draw_model(
    parts: ModelParts,
    path: str | os.PathLike[str],
    sweep: Sweep | None,
    worst: Ints,
    *,
    title: str,
    caption: str = "",
) -> None:
    """Draw every pose seen along the film's normal and, below, from the side.

    The film's two longest axes span the picture, the third one points upwards.

    Parameters
    ----------
    path : path-like
        File to write; the suffix sets the format.
    sweep : Sweep or None
        Path of the cutting edges.
    worst : ndarray of int
        Quads to mark.
    title, caption : str

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    figure = new_figure((13.0, 8.6), 110.0)
    figure.suptitle(title, fontsize=13)
    figure.text(0.06, 0.01, caption, va="bottom", fontsize=9, family="monospace")
    unit, factor = shown("mm")
    poses, titles = _poses(parts)
    # A refused model may lack its film.
    points = poses[0] if parts.mesh is None else parts.mesh.nodes
    across = np.argsort(-np.ptp(points, axis=0), kind="stable")
    views = ((across[0], across[1], 0.41, 0.49), (across[0], across[2], 0.17, 0.18))
    n_pose, drawn = len(titles), None
    for k in range(n_pose):
        left, width = 0.06 + 0.94 / n_pose * k, 0.94 / n_pose - 0.07
        for i, j, bottom, height in views:
            axes = figure.add_axes((left, bottom, width, height))
            view = _View(axes, i, j, factor)
            if parts.mesh is not None:
                nodes, supported = parts.mesh.nodes, parts.supported
                view.lines(nodes[mesh_edges(parts.mesh.quads)], _FILM_COLOR, 0.4)
                if len(worst):
                    label = f"{len(worst)} quads with the smallest stable step"
                    view.faces(nodes[parts.mesh.quads[worst]], _WORST_COLOR, label=label)
                if len(supported):
                    view.dots(
                        nodes[supported], 3.0, _SUPPORTED_COLOR, f"{len(supported)} supported nodes"
                    )
            if parts.tool is not None:
                view.faces(poses[k][parts.tool.triangles], _TOOL_COLOR, alpha=0.25)
                for label, color, edges in edge_groups(parts.tool, sweep):
                    style = "solid" if color == _STAYS else "dashed"
                    ends = poses[k][edges]  # above their path
                    view.lines(ends, color, 1.8, linestyles=style, zorder=3, label=label)
            _draw_motions(view, parts, sweep, with_track=k == 0)
            axes.set_aspect("equal", adjustable="datalim")
            axes.autoscale_view()
            axes.set_xlabel(in_unit("xyz"[i], unit), fontsize=8)
            axes.set_ylabel(in_unit("xyz"[j], unit), fontsize=8)
            axes.tick_params(labelsize=8)
            if bottom > 0.3:
                axes.set_title(titles[k], fontsize=10)
                drawn = drawn or axes.get_legend_handles_labels()
    # All of it is in the first pose: one legend, where it hides nothing.
    figure.legend(
        *(drawn or ()),
        loc="center",
        bbox_to_anchor=(0.5, 0.945),
        fontsize=8,
        ncols=6,
        frameon=False,
    )
    save(figure, path)


@dataclass(frozen=True)
class _View:
    """Axes with a view along a coordinate axis."""

    axes: Any
    i: int
    j: int
    """Coordinates to the right and up."""
    factor: float
    """From mm to the unit shown."""

    def flat(self, points: Floats) -> Floats:
        """Return what is drawn of points [mm], shape (..., 2)."""
        return self.factor * points[..., [self.i, self.j]]

    def dots(self, points: Floats, size: float, color: str, label: str) -> None:
        """Draw points, shape (n, 3) [mm]."""
        self.axes.plot(*self.flat(points).T, ".", ms=size, color=color, label=label)

    def lines(self, ends: Floats, color: str, width: float, **style: Any) -> None:
        """Draw segments, shape (n, 2, 3) [mm]."""
        add_lines(self.axes, self.flat(ends), colors=color, linewidths=width, **style)

    def faces(self, corners: Floats, color: str, **style: Any) -> None:
        """Fill polygons, shape (n, n_corner, 3) [mm]."""
        add_lines(self.axes, self.flat(corners), kind="PolyCollection", facecolors=color, **style)


def _draw_motions(view: _View, parts: ModelParts, sweep: Sweep | None, *, with_track: bool) -> None:
    """Draw the paths of cutting edges in the film, the notch, moving supports, the tool's path."""
    axes = view.axes
    if sweep is not None and len(sweep.place):
        view.dots(sweep.place, 1.2, _PATH_COLOR, "path of the cutting edges through the film")
    if len(parts.notch):
        view.lines(parts.notch, _NOTCH_COLOR, 2.0, label="notch")
    extent = 0.0 if parts.mesh is None else float(np.ptp(parts.mesh.nodes, axis=0).max())
    for at, toward in parts.pulls:
        _draw_pull(view, at, _ARROW * extent * unit(toward))
    if parts.pulls:
        label = counted(len(parts.pulls), "support that moves", "supports that move")
        axes.plot([], [], color=_PULL_COLOR, marker=">", label=label)
    track = view.flat(_track(parts))
    if with_track and len(track):
        label = "path of an end of the cutting edge"
        axes.plot(*track.T, color=_TRACK_COLOR, lw=1.2, zorder=4, label=label)
        arrow = {"arrowstyle": "-|>", "color": _TRACK_COLOR}
        axes.annotate("", track[-1], track[-2], arrowprops=arrow, zorder=4)


def _draw_pull(view: _View, at: Floats, direction: Floats) -> None:
    """Draw an arrow from a point; one along the line of sight is a circle with a dot or a cross."""
    axes, start, end = view.axes, view.flat(at), view.flat(at + direction)
    if norm(end - start) > 0.1 * view.factor * norm(direction):
        arrow = {"arrowstyle": "-|>", "color": _PULL_COLOR, "lw": 1.8}
        axes.annotate("", end, start, arrowprops=arrow, zorder=5)
        axes.update_datalim([end])
        return
    toward_viewer = product(np.cross(np.eye(3)[view.i], np.eye(3)[view.j]), direction) > 0.0
    mark = r"$\odot$" if toward_viewer else r"$\otimes$"
    axes.plot(*start, marker=mark, ms=13, mew=0.4, color=_PULL_COLOR, zorder=5)


def edge_groups(tool: Tool, sweep: Sweep | None) -> Iterator[tuple[str, str, Ints]]:
    """Yield label, colour and segments of the cutting edges, by whether they stay in the film."""
    if sweep is None:
        yield counted(tool.n_chain, "cutting edge"), _STAYS, tool.edges
        return
    groups = (
        ("stay{} in the film to the end", _STAYS, [f.chain for f in sweep.fates if f.stays]),
        ("leave{} the film", _LEAVES, [f.chain for f in sweep.fates if f.meets and not f.stays]),
        ("never meet{} the film", _NEVER, [f.chain for f in sweep.fates if not f.meets]),
    )
    for what, color, chains in groups:
        if chains:
            does = what.format("s" if len(chains) == 1 else "")
            mine = np.isin(tool.edge_chain, chains)
            yield f"{counted(len(chains), 'cutting edge')} {does}", color, tool.edges[mine]


def _poses(parts: ModelParts) -> tuple[list[Floats], list[str]]:
    """Return the tool's vertices at the start and, if there is one, at the end, and titles."""
    tool, motion = parts.tool, parts.motion
    if tool is None:
        return [], ["t = 0 ms"]
    if motion is None:
        return [tool.vertices], ["the tool as given"]
    poses, titles = [], []
    for at in [0.0] if parts.duration is None else [0.0, parts.duration]:
        poses.append(pose_at(motion, at).to_space(tool.vertices))
        where = ""
        if isinstance(motion, HasCoordinate):
            place, unit = motion.coordinate(at), motion.coordinate_unit
            turned = f"{np.degrees(place):.4g}°"
            where = f", {turned if unit == 'rad' else with_unit(place, unit)}"
        seen = " as seen from the film" if isinstance(motion, SeenFromFilm) else ""
        titles.append(f"t = {1e3 * at:.4g} ms{where}{seen}")
    return poses, titles


def _track(parts: ModelParts) -> Floats:
    """Return how the lowest end of the first cutting edge moves, shape (n, 3) [mm].

    For a tool without cutting edges, how its first vertex moves.
    """
    tool, motion = parts.tool, parts.motion
    if tool is None or motion is None or not parts.duration:
        return np.zeros((0, 3))
    poses = [pose_at(motion, at) for at in np.linspace(0.0, parts.duration, _N_POSE)]
    ids = np.unique(tool.edges[tool.edge_chain == 0]) if tool.n_edge else np.zeros(1, np.int64)
    lowest = tool.vertices[[ids[np.argmin(poses[0].to_space(tool.vertices[ids])[:, 2])]]]
    return np.concatenate([pose.to_space(lowest) for pose in poses])
