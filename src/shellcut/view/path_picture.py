"""Picture of a path in a mesh: film, line of edges, worst quads."""

from __future__ import annotations

import os
from collections.abc import Sequence

import numpy as np

from shellcut.arrays import Floats, Ints

from ._figure import new_figure, save

_PATH_COLOR = "#c1121f"
_WORST_COLOR = "#f4a259"
_CLOSE_EDGES = 9.0  # half width of the close-up in edge lengths


def draw_path(
    x: Floats,
    quads: Ints,
    chains: Sequence[Ints],
    worst: Ints,
    path: str | os.PathLike[str],
    *,
    title: str,
    caption: str = "",
    size: tuple[float, float] = (13.0, 7.2),
    dpi: float = 110.0,
) -> None:
    """Draw the whole film and, beside it, the surroundings of the worst quad.

    Parameters
    ----------
    x : ndarray, shape (n_node, 2)
        Positions in the film's plane [mm].
    quads : ndarray, shape (n_quad, 4)
    chains : sequence of ndarray of int
        Nodes along the path; a closed path repeats its first node.
    worst : ndarray of int
        Quads to mark, worst first.
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
    from matplotlib.collections import LineCollection, PolyCollection

    figure.suptitle(title, fontsize=13)
    figure.text(0.5, 0.02, caption, ha="center", va="bottom", fontsize=10)
    sides = np.stack([quads, np.roll(quads, -1, axis=1)], axis=2).reshape(-1, 2)
    edges = x[np.unique(np.sort(sides, axis=1), axis=0)]
    length = float(np.median(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)))
    for k in (0, 1):
        axes = figure.add_axes((0.04 + 0.49 * k, 0.12, 0.45, 0.80))
        axes.add_collection(LineCollection(edges, colors="0.45", linewidths=0.35 + 0.5 * k))
        marked = PolyCollection(
            list(x[quads[worst]]), facecolors=_WORST_COLOR, edgecolors="0.2", linewidths=0.6
        )
        marked.set_label(f"{len(worst)} worst quads near the path")
        axes.add_collection(marked)
        for chain in chains:
            (line,) = axes.plot(*x[chain].T, color=_PATH_COLOR, lw=1.4 + 0.8 * k, label="path")
            if k:
                line.set_marker("o")
                line.set_markersize(3.5)
        axes.set_aspect("equal")
        if k and len(worst):
            centre = x[quads[worst[0]]].mean(axis=0)
            half = _CLOSE_EDGES * length
            axes.set_xlim(centre[0] - half, centre[0] + half)
            axes.set_ylim(centre[1] - half, centre[1] + half)
        else:
            axes.autoscale_view()
        axes.set_xlabel("mm")
        handles, labels = axes.get_legend_handles_labels()
        unique = dict(zip(labels, handles, strict=True))
        axes.legend(unique.values(), unique.keys(), loc="upper right", fontsize=9)
    save(figure, path)
