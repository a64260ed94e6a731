"""Curves of tensile tests, and proposed cohesive laws over their falling parts."""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from ._figure import new_figure, save
from .curves import dress

Curve = tuple[npt.ArrayLike, npt.ArrayLike]

_COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#8c6d31", "#5e3c99")


class FallingCurves(NamedTuple):
    """Openings [mm] and stresses [MPa] of one direction."""

    measured: Sequence[Curve]
    law: Curve
    said: str
    """Fracture energy and gauge length, for the legend."""


def draw_tensile(
    path: str | os.PathLike[str],
    curves: Mapping[str, Sequence[Curve]],
    falls: Mapping[str, FallingCurves],
    *,
    size: tuple[float, float] = (11.0, 5.0),
    dpi: float = 110.0,
) -> None:
    """Draw stress over strain, and stress over opening with the laws.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    curves : mapping of str to curves
        Nominal strain [-] and stress [MPa] of the specimens of each direction.
    falls : mapping of str to FallingCurves
        Of the directions that have a law; the right diagram stays empty without any.
    size, dpi
        Of the figure; the size in inches.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    figure = new_figure(size, dpi)
    left = figure.add_axes((0.07, 0.12, 0.41, 0.80))
    right = figure.add_axes((0.56, 0.12, 0.41, 0.80))
    color = {name: _COLORS[k % len(_COLORS)] for k, name in enumerate(curves)}
    for name, specimens in curves.items():
        for k, (strain, stress) in enumerate(specimens):
            label = f"{name}, {len(specimens)} specimens" if k == 0 else None
            left.plot(100.0 * np.asarray(strain), stress, color=color[name], lw=1.0, label=label)
    for name, fall in falls.items():
        for opening, stress in fall.measured:
            right.plot(opening, stress, color=color[name], lw=0.8, alpha=0.6)
        right.plot(*fall.law, color=color[name], lw=2.2, label=f"law {name}: {fall.said}")
    dress(left, "nominal stress [MPa]")
    dress(right, "nominal stress [MPa]")
    left.set_xlabel("strain [%]")
    right.set_xlabel("opening [mm]")
    for axes in (left, right):
        axes.set_ylim(bottom=0.0)
        if axes.get_legend_handles_labels()[0]:
            axes.legend(frameon=False, loc="best", fontsize=8.5)
    if not falls:
        right.text(0.5, 0.5, "no fall recorded: no law", transform=right.transAxes, ha="center")
    save(figure, path)
