"""The curves of a run: reaction on the tool, and energies."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._figure import new_figure, pretty, save, with_unit

_TOTAL_COLOR = "#b2182b"
_JOINTS_COLOR = "#ef8a62"
_CONTACT_COLOR = "#2166ac"
_TOOTH_COLOR = "0.7"
_SECOND_COLOR = "0.25"
# Distinguishable for colour-blind readers (Okabe and Ito), calm enough for areas.
_AREA_COLORS = (
    "#e69f00",
    "#56b4e9",
    "#009e73",
    "#f0e442",
    "#0072b2",
    "#d55e00",
    "#cc79a7",
    "#999999",
    "#8c6d31",
    "#5e3c99",
)
# A negative share up to this part of the largest is still drawn as an area: round-off and the half
# step between work and energy cause it.
_NEGATIVE_SHARE = 0.01


def draw_torque(
    path: str | os.PathLike[str],
    coordinate: npt.ArrayLike,
    total: npt.ArrayLike,
    *,
    contact: npt.ArrayLike | None = None,
    joints: npt.ArrayLike | None = None,
    teeth: npt.ArrayLike | None = None,
    second: tuple[npt.ArrayLike, npt.ArrayLike] | None = None,
    second_label: str = "classical cables",
    levels: Mapping[str, float] | None = None,
    plateau: tuple[float, float, float] | None = None,
    coordinate_name: str = "angle",
    coordinate_unit: str = "deg",
    name: str = "torque",
    unit: str = "N*mm",
    title: str | None = None,
    size: tuple[float, float] = (9.0, 5.4),
    dpi: float = 110.0,
) -> None:
    """Draw the tool's torque (or force) over its coordinate, in total and in parts.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    coordinate : array_like, shape (n,)
        The tool's angle or path, in ``coordinate_unit``.
    total, contact, joints : array_like, shape (n,)
        Torque on the tool, and its parts from the contact of the faces and from the cables
        jointed to the edges, in ``unit``.
    teeth : array_like, shape (n, n_tooth), optional
        The total of each tooth, drawn faintly, in ``unit``.
    second : (array_like, array_like), optional
        Coordinate and total of another run, e.g. the same with classical cables.
    second_label : str
        Label of the other run.
    levels : mapping of str to float, optional
        Horizontal lines to compare with, by label, in ``unit``.
    plateau : (float, float, float), optional
        Steady window, from and to in ``coordinate_unit``, and the mean, in ``unit``.
    coordinate_name, coordinate_unit, name, unit : str
        Labels of the axes.
    title, size, dpi
        Of the figure; the size in inches.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If the columns differ in length.
    """
    x = np.asarray(coordinate, dtype=float)
    figure = new_figure(size, dpi)
    axes = figure.add_axes((0.09, 0.22, 0.88, 0.70))
    if teeth is not None:
        _add_teeth(axes, x, _column("teeth", teeth, x))
    if second is not None:
        second_x = np.asarray(second[0], dtype=float)
        second_total = _column("second", second[1], second_x)
        axes.plot(second_x, second_total, color=_SECOND_COLOR, lw=1.6, ls="--", label=second_label)
    if contact is not None:
        y = _column("contact", contact, x)
        axes.plot(x, y, color=_CONTACT_COLOR, lw=1.2, label="from contact")
    if joints is not None:
        y = _column("joints", joints, x)
        axes.plot(x, y, color=_JOINTS_COLOR, lw=1.2, label="from cables at the edge")
    axes.plot(x, _column("total", total, x), color=_TOTAL_COLOR, lw=2.2, label="total")
    for k, (label, level) in enumerate((levels or {}).items()):
        text = f"{label}: {level:.4g} {pretty(unit)}"
        axes.axhline(level, color="black", lw=1.0, ls=(":", "-.")[k % 2], label=text)
    if plateau is not None:
        low, high, mean = plateau
        window = f"{low:.3g}-{with_unit(float(f'{high:.3g}'), coordinate_unit)}"
        text = f"mean over {window}: {with_unit(mean, unit)}"
        axes.plot((low, high), (mean, mean), color="black", lw=1.6, label=text)
    dress(axes, f"{name} [{pretty(unit)}]")
    axes.set_xlabel(f"{coordinate_name} [{pretty(coordinate_unit)}]")
    _add_legend_below(axes, first="total")
    if title is not None:
        axes.set_title(title, y=1.0)  # without y, Matplotlib searches for room: a fifth of the time
    save(figure, path)


def _add_teeth(axes: Any, x: Any, each: Any) -> None:
    if each.ndim != 2:
        raise ValueError(f"teeth must have shape (n, n_tooth), got {each.shape}")
    for k in range(each.shape[1]):
        label = f"each of {each.shape[1]} teeth" if k == 0 else None
        axes.plot(x, each[:, k], color=_TOOTH_COLOR, lw=0.9, label=label)


def _add_legend_below(axes: Any, *, first: str) -> None:
    """Name the curves below the axes, because a curve may fill all corners.

    The one named first is drawn over all others.
    """
    handles, labels = axes.get_legend_handles_labels()
    top = labels.index(first)
    order = [top, *(k for k in range(len(labels)) if k != top)]
    axes.legend(
        [handles[k] for k in order],
        [labels[k] for k in order],
        frameon=False,
        loc="upper center",
        bbox_to_anchor=(0.5, -0.13),
        ncols=3,
    )


def draw_energy(
    path: str | os.PathLike[str],
    coordinate: npt.ArrayLike,
    work: npt.ArrayLike,
    shares: Mapping[str, npt.ArrayLike],
    imbalance: npt.ArrayLike,
    *,
    coordinate_name: str = "angle",
    coordinate_unit: str = "deg",
    unit: str = "N*mm",
    title: str | None = None,
    size: tuple[float, float] = (9.0, 6.6),
    dpi: float = 110.0,
) -> None:
    """Draw the energy ledger: the work put in, the energies, and the imbalance.

    The energies are stacked, so that their upper rim meets the line of the work if the ledger
    closes. If one of them is clearly negative they are drawn as lines instead.

    Parameters
    ----------
    path : str or Path
        The picture, ``.png`` or another suffix that Matplotlib knows; replaced if it exists.
    coordinate : array_like, shape (n,)
        The tool's angle or path, in ``coordinate_unit``.
    work : array_like, shape (n,)
        Work of the tool and the loads, in ``unit``.
    shares : mapping of str to array_like, shape (n,)
        Stored and dissipated energies, in ``unit``; the first is at the bottom of the stack.
    imbalance : array_like, shape (n,)
        Imbalance of the ledger, relative to the work, [%].
    coordinate_name, coordinate_unit, unit : str
        Labels of the axes.
    title, size, dpi
        Of the figure; the size in inches.

    Raises
    ------
    ImportError
        If Matplotlib is not installed.
    ValueError
        If the columns differ in length.
    """
    x = np.asarray(coordinate, dtype=float)
    columns = {name: _column(name, share, x) for name, share in shares.items()}
    put_in = _column("work", work, x)
    missing = _column("imbalance", imbalance, x)
    figure = new_figure(size, dpi)
    upper = figure.add_axes((0.10, 0.34, 0.87, 0.60))
    lower = figure.add_axes((0.10, 0.09, 0.87, 0.20), sharex=upper)

    largest = max((np.abs(y).max(initial=0.0) for y in columns.values()), default=0.0)
    colors = [_AREA_COLORS[k % len(_AREA_COLORS)] for k in range(len(columns))]
    if all((y >= -_NEGATIVE_SHARE * largest).all() for y in columns.values()):
        if columns:
            upper.stackplot(x, *columns.values(), labels=list(columns), colors=colors, alpha=0.85)
    else:
        for color, (label, y) in zip(colors, columns.items(), strict=True):
            upper.plot(x, y, color=color, lw=1.8, label=label)
    upper.plot(x, put_in, color="black", lw=1.8, ls="--", label="work put in")
    dress(upper, f"energy [{pretty(unit)}]")
    upper.tick_params(labelbottom=False)
    handles, labels = upper.get_legend_handles_labels()
    upper.legend(handles[::-1], labels[::-1], loc="upper left", frameon=False)
    if title is not None:
        upper.set_title(title, y=1.0)

    lower.axhline(0.0, color="0.6", lw=0.8)
    lower.plot(x, missing, color=_TOTAL_COLOR, lw=1.5)
    dress(lower, "imbalance [%]")
    lower.set_xlabel(f"{coordinate_name} [{pretty(coordinate_unit)}]")
    save(figure, path)


def _column(name: str, values: npt.ArrayLike, x: Any) -> Any:
    array = np.asarray(values, dtype=float)
    if array.shape[:1] != x.shape:
        raise ValueError(
            f"{name} must have as many rows as the coordinate, {len(x)}, got {array.shape}"
        )
    return array


def dress(axes: Any, label: str) -> None:
    """Set label and grid of the axes as in all pictures of curves."""
    axes.set_ylabel(label)
    axes.margins(x=0.0)
    axes.grid(color="0.9", lw=0.8)
    axes.set_axisbelow(True)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)
