"""Create and save Matplotlib figures, without a window or global state; only this imports it."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

from shellcut.files.whole_file import atomic_write
from shellcut.unit import after

_INCHES = 13.0


def new_figure(size: tuple[float, float], dpi: float) -> Any:
    """Return an empty Matplotlib figure of ``size`` [inch] that draws off-screen (Agg).

    Raises
    ------
    ImportError
        If Matplotlib is not installed, with the command that installs it.
    """
    try:
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure
    except ImportError as error:
        raise ImportError(
            "pictures need Matplotlib, which is not installed: pip install shellcut[plot]"
        ) from error
    figure = Figure(figsize=size, dpi=dpi, facecolor="white")
    FigureCanvasAgg(figure)
    return figure


def inches_of(size: tuple[int, int]) -> tuple[tuple[float, float], float]:
    """Return size [inch] and dots per inch of a figure with this width and height [pixel].

    Text keeps its size in inches: a width of 13 inches has room for the text of a snapshot.
    """
    dpi = size[0] / _INCHES
    # Half a pixel more, because the canvas rounds down and round-off could lose a whole pixel.
    return ((size[0] + 0.5) / dpi, (size[1] + 0.5) / dpi), dpi


def save(figure: Any, path: str | os.PathLike[str]) -> None:
    """Write the figure to ``path``; the suffix sets the format. An existing file is replaced.

    The file appears only when it is complete.
    """
    with atomic_write(Path(path)) as temporary:
        figure.savefig(temporary)


def with_unit(value: float, unit: str) -> str:
    """Return a number with four significant digits and its unit."""
    value += 0.0  # no "-0"
    return (f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}") + after(unit)
