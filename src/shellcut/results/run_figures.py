"""The values of a run that its history holds: the same for summary, verdict and report."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import isfinite
from typing import TYPE_CHECKING

import numpy as np

from shellcut.arrays import Floats

from .energy_account import energy_figures, largest_shares, trusted_rows
from .steady_window import steady_figures

if TYPE_CHECKING:
    from shellcut.state import SplitRecord

_OF_CABLES = "cohesive_work", "cohesive_dissipated", "cohesive_stored"


def run_figures(
    history: Mapping[str, Floats],
    coordinate: tuple[str, str],
    resistance: tuple[str, str],
    end: Mapping[str, float] | None = None,
    splits: Iterable[SplitRecord] = (),
) -> dict[str, float | str]:
    """Return the values by their names in ``summary.json``; those not finite are left out.

    Coordinate and resistance are name and unit; ``end`` has the history's columns at the end of the
    run, by default its last row.
    """
    end = end or {name: float(column[-1]) for name, column in history.items()}
    x, x_unit = coordinate
    figures = {
        f"{x}_end_{x_unit}": end[x],
        **energy_figures(end),
        **{f"{name}_Nmm": end[name] for name in _OF_CABLES if name in end},
        **largest_shares(history, trusted_rows(history)),
        "crack_length_mm": end["crack_length"],
        **_peak(history, coordinate, resistance),
        **_peak(history, coordinate, ("axial_force", "N")),
        **_piercing(splits),
    }
    counts = {
        f"n_cable_{what}": int(end[f"cables_{what}"])
        for what in ("created", "broken")
        if f"cables_{what}" in end
    }
    finite = {name: value for name, value in figures.items() if isfinite(value)}
    return {**finite, **counts, **steady_figures(history, coordinate, resistance)}


def _piercing(splits: Iterable[SplitRecord]) -> dict[str, float]:
    """Return force, depth and work of the tool as each cutting edge first pierces whole film.

    And the largest delay of these forces, where tips pierce.
    """
    first: dict[int, SplitRecord] = {}
    for record in splits:
        if record.edge >= 0:
            first.setdefault(record.edge + 1, record)
    figures = (("force", "N"), ("depth", "mm"), ("work", "Nmm"))
    told = {
        f"piercing_{what}_{edge}_{unit}": getattr(record, what)
        for edge, record in sorted(first.items())
        for what, unit in figures
    }
    delay = max((record.delay for record in first.values()), default=0.0)
    return told | ({"piercing_delay_rel": delay} if delay else {})


def _peak(
    history: Mapping[str, Floats], coordinate: tuple[str, str], resistance: tuple[str, str]
) -> dict[str, float]:
    """Return the value of largest magnitude, with its sign, and where it occurred.

    Nothing if the history has no such column.
    """
    name, unit = resistance
    if name not in history:
        return {}
    values = history[name]
    finite = np.flatnonzero(np.isfinite(values))
    if not finite.size:
        return {}
    k = int(finite[np.argmax(np.abs(values[finite]))])
    return {
        f"{name}_peak_{unit.replace('*', '')}": float(values[k]),
        f"{name}_peak_at_{coordinate[1]}": float(history[coordinate[0]][k]),
    }
