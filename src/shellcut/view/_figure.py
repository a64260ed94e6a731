"""Create and save Matplotlib figures, without a window or global state; only this imports it."""

from __future__ import annotations

import importlib.util
import os
from pathlib import Path
from typing import Any

from shellcut.files.distribution import optional
from shellcut.files.whole_file import atomic_write


def can_draw() -> bool:
    """Whether Matplotlib is installed."""
    return importlib.util.find_spec("matplotlib") is not None


def new_figure(size: tuple[float, float], dpi: float) -> Any:
    """Return an empty Matplotlib picture of ``size`` [inch] that draws off-screen (Agg)."""
    needed = "pictures need Matplotlib, which is not installed"
    of_figure = optional("matplotlib.figure", needed, "plot")
    figure = of_figure.Figure(figsize=size, dpi=dpi, facecolor="white")
    optional("matplotlib.backends.backend_agg", needed, "plot").FigureCanvasAgg(figure)
    return figure


def add_lines(axes: Any, points: Any, *, kind: str = "LineCollection", **style: Any) -> Any:
    """Add a collection of lines, or of another ``kind``, through points (n, n_point, 2)."""
    import matplotlib.collections

    return axes.add_collection(getattr(matplotlib.collections, kind)(list(points), **style))


def save(figure: Any, path: str | os.PathLike[str]) -> None:
    """Write the picture to ``path``; the suffix sets the format. An existing file is replaced.

    The file appears only when it is complete.
    """
    with atomic_write(Path(path)) as temporary:
        if temporary.suffix.lower() == ".png":
            figure.canvas.print_png(temporary)  # savefig draws everything twice
        else:
            figure.savefig(temporary)
