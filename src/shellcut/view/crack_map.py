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

from ._figure import add_lines, new_figure, save

_MESH_COLOR = "0.80"
_RIM_COLOR = "0.35"
_PATH_COLOR = "#d62728"
_BEFORE_COLOR = "black"
_MARKERS = ("o", "^", "s", "D", "v")
_COLORMAP = "viridis"
# A film is flat if its extent across is smaller than this part of its largest extent.
_FLAT = 1e-3
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
    across, extent = width - _LEFT - _RIGHT, np.ptp(flat, axis=0)
    tall = float(np.clip(across * extent[1] / extent[0], 0.3 * across, 1.2 * across))
    height = tall + foot + _HEAD  # as the film needs
    figure = new_figure((width, height), dpi)
    axes = figure.add_axes((_LEFT / width, foot / height, across / width, tall / height))
    _draw_film(axes, last, flat)
    for k, way in enumerate(ways):
        label = "path of the cutting edges" if k == 0 else None
        axes.plot(
            *factor * way[:, ij].T, color=_PATH_COLOR, lw=1.0, ls="--", zorder=3.5, label=label
        )
    if before.any():
        add_lines(
            axes, factor * segments[before][..., ij], colors=_BEFORE_COLOR, label="open before"
        )
    if len(segments[~before]):
        along_unit, along = shown(last.coordinate_unit)
        scale = add_lines(
            axes,
            factor * segments[~before][..., ij],
            cmap=_COLORMAP,
            clim=(along * frames[0].coordinate, along * last.coordinate),
            array=along * opened[~before],
            linewidths=4.0,
            capstyle="round",
            zorder=3,
        )
        beside = (width - 0.8 * _RIGHT) / width, foot / height, 0.2 / width, tall / height
        figure.colorbar(
            scale,
            cax=figure.add_axes(beside),
            label=in_unit(f"opened at {last.coordinate_name}", along_unit),
        )
    _mark_splits(axes, splits or {}, factor, ij)
    axes.set_aspect("equal", adjustable="datalim")
    axes.margins(0.02)
    length = np.linalg.norm(segments[:, 1] - segments[:, 0], axis=1).sum()
    axes.set(
        xlabel=in_unit("xyz"[i], unit),
        ylabel=in_unit("xyz"[j], unit),
        title=f"crack of {with_unit(length, 'mm')} in {len(segments)} edges",
    )
    _add_legend(figure, axes, columns)
    save(figure, path)


def _add_legend(figure: Any, axes: Any, columns: int) -> None:
    """Name below the picture what has a label."""
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


def _draw_film(axes: Any, frame: Frame, flat: Floats) -> None:
    """Draw the sides of all quads; flat : (n_point, 2), the reference in the plane."""
    # Every edge thin; edges of only one quad, on the boundary of film or crack, bolder.
    edges, count = np.unique(np.sort(sides_of(frame.quads), axis=1), axis=0, return_counts=True)
    add_lines(axes, flat[edges], colors=_MESH_COLOR, linewidths=0.4)
    add_lines(axes, flat[edges[count == 1]], colors=_RIM_COLOR, linewidths=0.9)


def _mark_splits(
    axes: Any, splits: Mapping[str, npt.ArrayLike], factor: float, ij: list[int]
) -> None:
    """Mark the nodes that have split, a sign for each cause."""
    for k, (kind, places) in enumerate(splits.items()):
        at = factor * np.reshape(places, (-1, 3))[:, ij]
        axes.plot(
            *at.T,
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


def plane_axes(reference: Floats) -> tuple[int, int, int]:
    """Return the two coordinate axes in which a film is drawn, in order, and the one across it."""
    wide = np.argsort(-np.ptp(reference, axis=0), kind="stable")
    i, j = sorted(wide[:2].tolist())
    return i, j, int(wide[2])


def tooth_paths(frames: Sequence[Frame]) -> list[Floats]:
    """Return where each tooth's edge passes through the plane of a flat film, shape (n_frame, 3).

    Positions are nan where it does not meet the plane [mm]. There is none for a curved film, or if
    the teeth of the frames differ.
    """
    reference = frames[0].reference
    across = plane_axes(reference)[2]
    if np.ptp(reference[:, across]) > _FLAT * np.ptp(reference, axis=0).max():
        return []
    if len({len(f.edge_points) for f in frames}) != 1:
        return []
    numbers, tooth = np.unique(frames[0].edge_tooth, return_inverse=True)
    level = reference[:, across].mean()
    paths = np.full((len(numbers), len(frames), 3), np.nan)
    for k, frame in enumerate(frames):
        a, b = frame.edge_points[:, 0], frame.edge_points[:, 1]
        height_a, height_b = a[:, across] - level, b[:, across] - level
        for e in np.flatnonzero((height_a <= 0.0) != (height_b <= 0.0))[::-1]:
            s = height_a[e] / (height_a[e] - height_b[e])
            paths[tooth[e], k] = a[e] + s * (b[e] - a[e])
    return list(paths)
