"""A simulated and a measured curve in one diagram, and their difference."""

from __future__ import annotations

import os

import numpy as np
import numpy.typing as npt

from ._figure import new_figure, pretty, save, with_unit
from .curves import dress

_MEASURED_COLOR = "0.15"
_SIMULATED_COLOR = "#b2182b"
_OUTSIDE_COLOR = "0.95"


def draw_comparison(
    path: str | os.PathLike[str],
    measured: tuple[npt.ArrayLike, npt.ArrayLike],
    simulated: tuple[npt.ArrayLike, npt.ArrayLike],
    difference: tuple[npt.ArrayLike, npt.ArrayLike],
    *,
    peaks: tuple[tuple[float, float], tuple[float, float]] | None = None,
    coordinate_name: str = "angle",
    coordinate_unit: str = "deg",
    name: str = "torque",
    unit: str = "N*mm",
    title: str | None = None,
    size: tuple[float, float] = (9.0, 6.0),
    dpi: float = 110.0,
) -> None:
    """Draw both curves in one diagram, and their difference on the common range below it.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    measured, simulated : (array_like, array_like), shape (n,) each
        Coordinate and value of each complete curve at its own points; the range without difference
        is shaded.
    difference : (array_like, array_like), shape (n,) each
        Coordinate, and simulated minus measured.
    peaks : ((float, float), (float, float)), optional
        Position and value of the measured and of the simulated peak, marked by dots.
    coordinate_name, coordinate_unit, name, unit : str
        Labels of the axes.
    title, size, dpi
        Of the figure; the size in inches.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    """
    x, gap = (np.asarray(column, dtype=float) for column in difference)
    figure = new_figure(size, dpi)
    upper = figure.add_axes((0.10, 0.36, 0.87, 0.57))
    lower = figure.add_axes((0.10, 0.10, 0.87, 0.20), sharex=upper)
    curves = (
        ("measured", measured, _MEASURED_COLOR, "--"),
        ("simulated", simulated, _SIMULATED_COLOR, "-"),
    )
    for k, (label, curve, color, style) in enumerate(curves):
        if peaks is not None:
            place, value = peaks[k]
            label += f", peak {with_unit(value, unit)} at {with_unit(place, coordinate_unit)}"
            upper.plot(place, value, "o", color=color, ms=6, clip_on=False, zorder=3)
        upper.plot(*curve, color=color, lw=1.6, ls=style, label=label)
    dress(upper, f"{name} [{pretty(unit)}]")
    upper.tick_params(labelbottom=False)
    # Room above the curves for the legend, so that it covers none of them.
    low, high = upper.get_ylim()
    upper.set_ylim(low, high + 0.2 * (high - low))
    upper.legend(loc="upper left", frameon=False)
    left, right = upper.get_xlim()
    for axes in (upper, lower):
        for ends in ((left, x[0]), (x[-1], right)):
            axes.axvspan(*ends, color=_OUTSIDE_COLOR, lw=0.0, zorder=0)
    if title is not None:
        upper.set_title(title)
    lower.axhline(0.0, color="0.6", lw=0.8)
    lower.fill_between(x, gap, color=_SIMULATED_COLOR, alpha=0.25, lw=0.0)
    lower.plot(x, gap, color=_SIMULATED_COLOR, lw=1.2)
    dress(lower, f"difference [{pretty(unit)}]")
    lower.set_xlabel(f"{coordinate_name} [{pretty(coordinate_unit)}]")
    save(figure, path)
