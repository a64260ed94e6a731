"""Picture of a model before its run: film, supports, worst quads, tool and cutting edges."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, norm, product, unit
from shellcut.checks import Sweep
from shellcut.formats.errors import counted
from shellcut.loads.film_motion import SeenFromFilm
from shellcut.mesh.mesh import Mesh
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
        place, unit = motion.coordinate(at), motion.coordinate_unit
        where = f"{np.degrees(place):.4g}°" if unit == "rad" else with_unit(place, unit)
        seen = " as seen from the film" if isinstance(motion, SeenFromFilm) else ""
        titles.append(f"t = {1e3 * at:.4g} ms, {where}{seen}")
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
