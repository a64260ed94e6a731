"""Curves: what is drawn in a diagram and how it looks; as a picture, by Matplotlib.

The charts of the reports draw the same diagrams (``report/chart.py``).
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from shellcut.arrays import Floats
from shellcut.unit import in_unit, shown

from ._figure import new_figure, save

PALETTE = ("#3b6fd4", "#1592b4", "#2c9c62", "#8a9a1c", "#d08a10", "#dc5f2a", "#c22a4c")
"""Colours of groups, of about one lightness, which stand out on white and on black."""

INK = "#1b1f24"
"""Black; pages make it white in the dark."""

# Okabe and Ito: distinguishable for colour-blind readers, calm enough for areas.
_AREAS = ["e69f00", "56b4e9", "009e73", "f0e442", "0072b2", "d55e00", "cc79a7"]
_AREAS += ["999999", "7a5195", "8c6d31"]

# Thin lines below those of the sums, in none of their colours.
_TEETH = ("#2c9c62", "#8a63c9", "#a58a12", "#9c5a3c", "#159aa0", "#c565ae", "#5f6b78", "#a9b0b8")

STYLES: dict[str, dict[str, Any]] = {
    "total": {"color": "#cf3a44", "width": 2.2},
    "joints": {"color": "#e08030", "width": 1.4},
    "contact": {"color": "#3d83c8", "width": 1.4},
    **{f"tooth{k}": {"color": color, "width": 0.9} for k, color in enumerate(_TEETH)},
    "measured": {"color": INK, "width": 2.0, "dash": "dash"},
    "work": {"color": INK, "width": 1.8, "dash": "dash"},
    "mean": {"color": INK, "width": 1.6},
    **{f"law{k}": {"color": color, "width": 2.4} for k, color in enumerate(PALETTE)},
    **{f"c{k}": {"color": color, "width": 1.0} for k, color in enumerate(PALETTE)},
    **{f"a{k}": {"color": f"#{one}", "width": 1.6} for k, one in enumerate(_AREAS)},
    "doubt": {"color": PALETTE[6], "width": 0.0, "marker": "x"},
    **{f"p{k}": {"color": c, "width": 0.0, "marker": "o"} for k, c in enumerate(PALETTE)},
}
"""How lines look, by name."""


@dataclass(frozen=True, eq=False)
class Curve:
    """One line, or with ``area`` one layer of the stack; ``style`` is one of :data:`STYLES`.

    Curves of one name share an entry of the legend.
    """

    name: str
    values: npt.ArrayLike
    style: str = "total"
    area: bool = False
    group: str = ""
    """Curves of one group are switched together on a page; by default those of one name."""
    x: npt.ArrayLike | None = None
    """Its own abscissae; by default those of the diagram."""


@dataclass(frozen=True, eq=False)
class Diagram:
    """Curves over one coordinate."""

    x: npt.ArrayLike
    """Abscissae of the curves that have none of their own, shape (n,)."""
    curves: Sequence[Curve]
    """Areas are stacked in order, lines are drawn over them."""
    x_name: str
    x_unit: str
    name: str
    unit: str
    """Names and units of the axes."""
    title: str = ""
    height: float = 1.0
    """Relative to the other diagrams of a picture."""
    zero: bool = True
    """Whether the axis of the values reaches 0."""
    whole: bool = False
    """Whether the abscissae are whole numbers, such as those of runs."""

    def shown(self) -> Diagram:
        """Return it in the units in which values are shown."""
        (x_unit, along), (unit, up) = shown(self.x_unit), shown(self.unit)
        curves = [
            replace(
                c,
                values=up * np.asarray(c.values),
                x=None if c.x is None else along * np.asarray(c.x),
            )
            for c in self.curves
        ]
        x = along * np.asarray(self.x)
        return replace(self, x=x, curves=curves, x_unit=x_unit, unit=unit)


def draw_curves(
    path: str | os.PathLike[str],
    diagrams: Sequence[Diagram],
    *,
    columns: int = 1,
    size: tuple[float, float] = (9.0, 5.4),
    dpi: float = 110.0,
) -> None:
    """Draw diagrams below or beside each other.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    diagrams : sequence of Diagram
    columns : int
        Diagrams side by side; those of one column share the coordinate.
    size, dpi
        Of the picture; the size in inches.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If a curve has another number of rows than its coordinate.
    """
    rows = -(-len(diagrams) // columns)
    figure = new_figure(size, dpi)
    figure.set_layout_engine("constrained", w_pad=0.12, h_pad=0.08)
    heights = [one.height for one in diagrams[::columns]]
    alike = len({(one.x_name, one.x_unit) for one in diagrams}) == 1
    every = figure.subplots(
        rows,
        columns,
        sharex="col" if alike else "none",
        squeeze=False,
        height_ratios=heights,
    ).ravel()
    for axes, diagram in zip(every, diagrams, strict=False):
        _draw(axes, diagram.shown())
        if alike:
            axes.label_outer()
    for axes in every[len(diagrams) :]:
        axes.remove()
    save(figure, path)


def _draw(axes: Any, diagram: Diagram) -> None:
    x = np.asarray(diagram.x, float)
    floor = np.zeros_like(x)
    named = set[str]()
    for curve in diagram.curves:
        places = x if curve.x is None else np.asarray(curve.x, float)
        values = np.asarray(curve.values, float)
        look = STYLES[curve.style]
        label: dict[str, Any] = {} if curve.name in named else {"label": curve.name}
        if curve.area:
            top = floor + values
            axes.fill_between(places, floor, top, color=look["color"], alpha=0.85, lw=0.0, **label)
            floor = top
        else:
            line = "--" if "dash" in look else "-"
            label |= {"marker": look.get("marker"), "color": look["color"], "lw": look["width"]}
            axes.plot(places, values, ls=line, **label)
        named.add(curve.name)
    if diagram.zero:
        axes.axhline(0.0, color="0.6", lw=0.8)
    axes.set(
        xlabel=in_unit(diagram.x_name, diagram.x_unit),
        ylabel=in_unit(diagram.name, diagram.unit),
        axisbelow=True,
    )
    axes.xaxis.get_major_locator().set_params(**({"integer": True} if diagram.whole else {}))
    axes.margins(x=0.0 if diagram.zero else 0.05)
    axes.grid(color="0.9", lw=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    if len(named) > 1:  # above the diagram, because a curve may fill all its corners
        axes.legend(
            title=diagram.title,
            alignment="left",
            frameon=False,
            fontsize="small",
            loc="lower left",
            bbox_to_anchor=(0.0, 1.0),
            ncols=3,
        )
    else:
        axes.set_title(diagram.title, loc="left")


def outline(x: Floats, y: Floats, n: int) -> npt.NDArray[np.int64]:
    """Return the rows of the lowest and highest value in each of n columns: no peak is lost.

    Examples
    --------
    >>> outline(np.linspace(0.0, 1.0, 9), np.array([0, 1, 0, 0, 0, 7, 0, 0, 0.0]), 2).tolist()
    [0, 5, 7, 8]
    """
    if len(x) <= 2 * n:
        return np.arange(len(x))
    column = ((x - x[0]) / (x[-1] - x[0]) * (n - 1)).astype(int)
    order = np.lexsort((y, column))
    bounds = np.flatnonzero(np.diff(column[order])) + 1
    first, last = np.concatenate(([0], bounds)), np.concatenate((bounds, [len(x)])) - 1
    return np.unique(np.concatenate((order[first], order[last], [0, len(x) - 1])))
