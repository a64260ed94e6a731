"""The crack on the uncut film: its path, when each edge opened, cause of each split."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.frame import Frame, sides_of
from shellcut.unit import in_unit, shown, with_unit

from ._figure import new_figure, save
from ._panel import mesh_edges
from ._teeth import plane_axes, tooth_paths

_MESH_COLOR = "0.80"
_RIM_COLOR = "0.35"
_PATH_COLOR = "#d62728"
_BEFORE_COLOR = "black"
_MARKERS = ("o", "^", "s", "D", "v")
_COLORMAP = "viridis"
# Margins of the map [inch]: numbers and name of y, colour bar, title, numbers and name of x; height
# of a legend line, and width of a legend entry.
_LEFT, _RIGHT, _HEAD, _FOOT = 0.75, 1.1, 0.4, 0.62
_LINE, _NAME = 0.23, 2.6


def draw_crack_map(
    path: str | os.PathLike[str],
    frames: Sequence[Frame],
    *,
    splits: Mapping[str, npt.ArrayLike] | None = None,
    width: float = 9.0,
    dpi: float = 110.0,
) -> None:
    """Draw the crack's edges on the reference film, coloured by the time of opening.

    The time resolution is that of the frames: an edge gets the coordinate of the first frame in
    which it is open. Edges open in the first frame are black.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    frames : sequence of Frame
        Frames of one run, in order of time.
    splits : mapping of str to array_like, shape (n, 3), optional
        Reference positions of split nodes by cause, e.g. ``{"blade": ...}`` [mm].
    width : float
        Width of the picture [inch]; the height follows from the film.
    dpi : float
        Pixels per inch.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If there is no frame.
    """
    if not frames:
        raise ValueError("a crack map needs at least one frame, got none")
    last = frames[-1]
    i, j, _ = plane_axes(last.reference)
    (unit, factor), ij = shown("mm"), [i, j]
    flat = factor * last.reference[:, ij]
    segments, opened = crack_history(frames)
    before = opened == frames[0].coordinate

    ways = tooth_paths(frames)
    n_name = bool(ways) + bool(before.any()) + len(splits or {})
    columns = int(np.clip(width / _NAME, 1, 3))
    foot = _FOOT + _LINE * -(-n_name // columns)
    figure, axes, beside = _figure_of(flat, width, foot, dpi)
    _draw_film(axes, last, flat)
    for k, way in enumerate(ways):
        label = "path of the cutting edges" if k == 0 else None
        axes.plot(
            *factor * way[:, ij].T, color=_PATH_COLOR, lw=1.0, ls="--", zorder=3.5, label=label
        )
    if before.any():
        _add_lines(
            axes, factor * segments[before][..., ij], colors=_BEFORE_COLOR, label="open before"
        )
    scale = _add_opened(axes, factor * segments[~before][..., ij], opened[~before], frames)
    for k, (kind, places) in enumerate((splits or {}).items()):
        _add_splits(axes, factor * np.reshape(places, (-1, 3))[:, ij], kind, k)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.02)
    axes.set_xlabel(in_unit("xyz"[i], unit))
    axes.set_ylabel(in_unit("xyz"[j], unit))
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
    axes.set_title(f"crack of {with_unit(length, 'mm')} in {len(segments)} edges")
    if scale is not None:
        bar = figure.colorbar(scale, cax=figure.add_axes(beside))
        bar.set_label(in_unit(f"opened at {last.coordinate_name}", shown(last.coordinate_unit)[0]))
    handles, labels = axes.get_legend_handles_labels()
    if handles:
        figure.legend(
            handles,
            labels,
            loc="lower center",
            bbox_to_anchor=(0.5, 0.01),
            ncols=columns,
            frameon=False,
        )
    save(figure, path)


def _figure_of(
    flat: Floats, width: float, foot: float, dpi: float
) -> tuple[Any, Any, tuple[float, float, float, float]]:
    """Return a figure as tall as the film needs, its axes, and where a colour bar goes.

    flat : (n_node, 2), the film's nodes in the plane [mm].  width, foot : [inch].
    """
    across = width - _LEFT - _RIGHT
    extent = np.ptp(flat, axis=0)
    tall = float(np.clip(across * extent[1] / extent[0], 0.3 * across, 1.2 * across))
    height = tall + foot + _HEAD
    figure = new_figure((width, height), dpi)
    axes = figure.add_axes((_LEFT / width, foot / height, across / width, tall / height))
    beside = (width - 0.8 * _RIGHT) / width, foot / height, 0.2 / width, tall / height
    return figure, axes, beside


def _add_splits(axes: Any, at: Floats, kind: str, k: int) -> None:
    """Mark the places of the k-th kind of splits, at : (n, 2) [mm]."""
    axes.plot(
        at[:, 0],
        at[:, 1],
        _MARKERS[k % len(_MARKERS)],
        ms=4.5,
        mfc=("white", "#f4a259")[k % 2],
        mec="black",
        mew=0.8,
        zorder=4,
        label=f"split by {kind} ({len(at)})",
    )


def crack_history(frames: Sequence[Frame]) -> tuple[Floats, Floats]:
    """Return reference ends of every crack edge once, shape (n, 2, 3), [mm], and when it opened.

    That is the coordinate of the first frame that has the edge open.
    """
    from scipy.spatial import cKDTree

    last = frames[-1]  # contains all edges, because a crack does not heal
    segments = last.reference[last.crack_edges[:, 0]]
    opened = np.full(len(segments), last.coordinate)
    if not len(segments):
        return segments, opened
    # Node ids of an edge change when its ends split again; its reference midpoint does not, except
    # for rounding in files.
    tree = cKDTree(segments.mean(axis=1))
    for frame in reversed(frames):
        middles = frame.reference[frame.crack_edges[:, 0]].mean(axis=1)
        if len(middles):
            opened[tree.query(middles)[1]] = frame.coordinate
    return segments, opened


def _draw_film(axes: Any, frame: Frame, flat: Floats) -> None:
    # Every edge thin; edges of only one quad, on the boundary of film or crack, bolder.
    _add_lines(axes, flat[mesh_edges(frame.quads)], colors=_MESH_COLOR, linewidths=0.4)
    edges, count = np.unique(np.sort(sides_of(frame.quads), axis=1), axis=0, return_counts=True)
    _add_lines(axes, flat[edges[count == 1]], colors=_RIM_COLOR, linewidths=0.9)


def _add_opened(axes: Any, segments: Floats, opened: Floats, frames: Sequence[Frame]) -> Any:
    if not len(segments):
        return None
    from matplotlib.collections import LineCollection
    from matplotlib.colors import Normalize

    _, factor = shown(frames[0].coordinate_unit)
    limits = Normalize(factor * frames[0].coordinate, factor * frames[-1].coordinate)
    lines = LineCollection(
        list(segments), cmap=_COLORMAP, norm=limits, linewidths=4.0, capstyle="round", zorder=3
    )
    lines.set_array(factor * opened)
    axes.add_collection(lines)
    return lines


def _add_lines(axes: Any, segments: Floats, **style: Any) -> None:
    from matplotlib.collections import LineCollection

    axes.add_collection(LineCollection(list(segments), **style))
