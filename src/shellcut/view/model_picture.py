"""Picture of a model before its run: film, supports, worst quads, tool and cutting edges."""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from shellcut.arrays import Floats, Ints, norm, unit
from shellcut.formats.errors import counted
from shellcut.unit import in_unit, shown

from ._figure import new_figure, save
from ._panel import mesh_edges

_FILM_COLOR = "0.55"
_HELD_COLOR = "#1d3557"
_WORST_COLOR = "#f4a259"
_TOOL_COLOR = "#a8b0ba"
_WAY_COLOR = "#2a9d8f"
_TRACK_COLOR = "#3d3d3d"
_NOTCH_COLOR = "#111111"
_PULL_COLOR = "#d1495b"
_ARROW = 0.12  # length over the film's extent


@dataclass(frozen=True, eq=False)
class EdgeGroup:
    """Cutting segments drawn in the same style."""

    label: str
    """Label in the legend."""
    segments: Ints
    """Vertex ids of the tool, shape (n, 2)."""
    color: str
    dashed: bool = False


@dataclass(frozen=True, kw_only=True, eq=False)
class ModelView:
    """Parts to draw, all in one coordinate system [mm]."""

    nodes: Floats
    """Reference positions, shape (n_node, 3)."""
    quads: Ints
    """Node ids, shape (n_quad, 4)."""
    held: Ints
    """Supported nodes."""
    worst: Ints
    """Quads to mark."""
    tool: Sequence[Floats]
    """Vertices of the tool in every pose shown, shape (n_vertex, 3) each."""
    triangles: Ints
    """Vertex ids of the tool, shape (n_triangle, 3)."""
    edges: Sequence[EdgeGroup]
    """Cutting segments of the tool."""
    way: Floats
    """Points where they pass through the film, shape (n, 3)."""
    titles: Sequence[str]
    """Title of each pose."""
    track: Floats
    """How a point of the tool moves from the start to the end, shape (n, 3)."""
    pulls: Sequence[tuple[Floats, Floats]]
    """Place and direction of arrows, shape (3,) each."""
    notch: Floats
    """Ends of the edges at which the film is cut, shape (n, 2, 3)."""


def draw_model(
    model: ModelView,
    path: str | os.PathLike[str],
    *,
    title: str,
    caption: str = "",
    size: tuple[float, float] = (13.0, 8.6),
    dpi: float = 110.0,
) -> None:
    """Draw every pose seen along the film's normal and, below, from the side.

    Parameters
    ----------
    model : ModelView
        The film's two longest axes span the picture, the third one points upwards.
    path : path-like
        File to write; the suffix sets the format.
    title, caption : str
    size : (float, float)
        Width and height [inch].
    dpi : float
        Pixels per inch.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    figure = new_figure(size, dpi)
    figure.suptitle(title, fontsize=13)
    figure.text(0.06, 0.01, caption, va="bottom", fontsize=9, family="monospace")
    unit, factor = shown("mm")
    lengths = {name: factor * getattr(model, name) for name in ("nodes", "way", "track", "notch")}
    pulls = [(factor * at, toward) for at, toward in model.pulls]
    model = replace(model, **lengths, tool=[factor * pose for pose in model.tool], pulls=pulls)
    # A refused model may lack its film.
    extent = np.ptp(model.nodes if len(model.nodes) else model.tool[0], axis=0)
    across = np.argsort(-extent, kind="stable")
    n_pose, drawn = len(model.titles), None
    for k in range(n_pose):
        left, width = 0.06 + 0.94 / n_pose * k, 0.94 / n_pose - 0.07
        for axes_ids, bottom, height in (
            ((across[0], across[1]), 0.41, 0.49),
            ((across[0], across[2]), 0.17, 0.18),
        ):
            axes = figure.add_axes((left, bottom, width, height))
            _draw_pose(axes, model, k, axes_ids)
            axes.set_aspect("equal", adjustable="datalim")
            axes.autoscale_view()
            axes.set_xlabel(in_unit("xyz"[axes_ids[0]], unit), fontsize=8)
            axes.set_ylabel(in_unit("xyz"[axes_ids[1]], unit), fontsize=8)
            axes.tick_params(labelsize=8)
            if bottom > 0.3:
                axes.set_title(model.titles[k], fontsize=10)
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


def _draw_pose(axes: Any, model: ModelView, pose: int, axes_ids: tuple[int, int]) -> None:
    from matplotlib.collections import LineCollection, PolyCollection

    i, j = axes_ids
    x = model.nodes[:, [i, j]]
    add = axes.add_collection
    if len(model.quads):
        add(LineCollection(list(x[mesh_edges(model.quads)]), colors=_FILM_COLOR, linewidths=0.4))
    if len(model.worst):
        worst = PolyCollection(list(x[model.quads[model.worst]]), facecolors=_WORST_COLOR)
        worst.set_label(f"{len(model.worst)} quads with the shortest steps")
        add(worst)
    if len(model.held):
        label = f"{len(model.held)} held nodes"
        axes.plot(*x[model.held].T, ".", ms=3, color=_HELD_COLOR, label=label)
    if len(model.tool):
        tool = model.tool[pose][:, [i, j]]
        add(PolyCollection(list(tool[model.triangles]), facecolors=_TOOL_COLOR, alpha=0.25))
        for group in model.edges:
            style = "dashed" if group.dashed else "solid"
            lines = list(tool[group.segments])
            edges = LineCollection(lines, colors=group.color, linewidths=1.8, linestyles=style)
            edges.set_zorder(3)  # above their path
            edges.set_label(group.label)
            add(edges)
    if len(model.way):
        label = "path of the edges through the film"
        axes.plot(*model.way[:, [i, j]].T, ".", ms=1.2, color=_WAY_COLOR, label=label)
    if len(model.notch):
        cut = LineCollection(list(model.notch[..., [i, j]]), colors=_NOTCH_COLOR, linewidths=2.0)
        cut.set_label("notch")
        add(cut)
    for k, (at, toward) in enumerate(model.pulls):
        _draw_pull(axes, at, _ARROW * np.ptp(model.nodes, axis=0).max() * unit(toward), i, j)
        if k == 0:
            label = counted(len(model.pulls), "support that moves", "supports that move")
            axes.plot([], [], color=_PULL_COLOR, marker=">", label=label)
    if pose == 0 and len(model.track):
        track, color = model.track[:, [i, j]], _TRACK_COLOR
        label = "way of an end of the tool's edge"
        axes.plot(*track.T, color=color, lw=1.2, zorder=4, label=label)
        arrow = {"arrowstyle": "-|>", "color": color}
        axes.annotate("", track[-1], track[-2], arrowprops=arrow, zorder=4)


def _draw_pull(axes: Any, at: Floats, way: Floats, i: int, j: int) -> None:
    """Draw an arrow from a point; one along the line of sight is a circle with a dot or a cross."""
    start, end = at[[i, j]], (at + way)[[i, j]]
    if norm(end - start) > 0.1 * norm(way):
        arrow = {"arrowstyle": "-|>", "color": _PULL_COLOR, "lw": 1.8}
        axes.annotate("", end, start, arrowprops=arrow, zorder=5)
        axes.update_datalim([end])
        return
    toward_viewer = np.cross(np.eye(3)[i], np.eye(3)[j]) @ way > 0.0
    mark = r"$\odot$" if toward_viewer else r"$\otimes$"
    axes.plot(*start, marker=mark, ms=13, mew=0.4, color=_PULL_COLOR, zorder=5)
