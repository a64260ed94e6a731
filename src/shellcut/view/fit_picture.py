"""The picture of a fit: each measured curve, and the run at the start and at the fitted values."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import NamedTuple

from shellcut.arrays import Floats

from ._figure import new_figure, pretty, save
from .curves import dress

_WIDTH, _HEIGHT = 9.0, 4.0  # of a panel [in]


class FittedCurve(NamedTuple):
    """A curve of a fit; each line is a pair of coordinate and value, shape (n,) each."""

    measured: tuple[Floats, Floats]
    start: tuple[Floats, Floats]
    fitted: tuple[Floats, Floats]
    x: tuple[str, str]
    """Name and unit of the coordinate."""
    y: tuple[str, str]
    """Name and unit of the value."""
    title: str = ""
    """What its experiment had otherwise."""


def draw_fit(
    path: str | os.PathLike[str], curves: Sequence[FittedCurve], *, dpi: float = 110.0
) -> None:
    """Draw a panel for each curve.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    n = len(curves)
    figure = new_figure((_WIDTH, _HEIGHT * n), dpi)
    for k, curve in enumerate(curves):
        axes = figure.add_subplot(n, 1, k + 1)
        axes.plot(*curve.measured, color="0.15", lw=1.2, label="measured")
        axes.plot(*curve.start, color="#92c5de", lw=1.2, label="at the start")
        axes.plot(*curve.fitted, color="#b2182b", lw=1.6, label="fitted")
        axes.set_xlabel(f"{curve.x[0]} [{pretty(curve.x[1])}]")
        axes.set_title(curve.title, fontsize="medium")
        axes.legend(frameon=False)
        dress(axes, f"{curve.y[0]} [{pretty(curve.y[1])}]")
    figure.tight_layout()
    save(figure, path)
