"""The only place that asks for Matplotlib: a figure without a window and without global state."""

from __future__ import annotations

import os
from typing import IO, Any

import numpy as np
import numpy.typing as npt


def new_figure(size: tuple[float, float], dpi: float) -> Any:
    """Return an empty Matplotlib figure of ``size`` [inch] that draws by Agg, screen or no screen.

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
    figure = Figure(figsize=size, dpi=dpi)
    FigureCanvasAgg(figure)
    return figure


def save(figure: Any, path: str | os.PathLike[str] | IO[bytes]) -> None:
    """Write the figure to ``path``; the ending tells the format. An existing file is replaced."""
    figure.savefig(path, facecolor="white")


def pixels(figure: Any) -> npt.NDArray[np.uint8]:
    """Return the figure as an image, shape (height, width, 3)."""
    figure.patch.set_facecolor("white")
    figure.canvas.draw()
    return np.asarray(figure.canvas.buffer_rgba())[..., :3].copy()


def pretty(unit: str) -> str:
    """Return a unit as one prints it: "N*mm" becomes "N·mm"."""
    return unit.replace("*", "·").replace("deg", "°")


def with_unit(value: float, unit: str) -> str:
    """Return a number of four figures and its unit."""
    value += 0.0  # no "-0"
    number = f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    gap = "" if unit == "deg" else " "
    return number if unit in ("-", "") else f"{number}{gap}{pretty(unit)}"
