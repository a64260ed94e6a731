"""The figures of a comparison: rows for a page, a table for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

if TYPE_CHECKING:
    from .comparison import Comparison


class Row(NamedTuple):
    """A figure as text; cells are empty if a curve has no such figure."""

    name: str
    unit: str
    """Unit of the three values, except for a difference in per cent."""
    measured: str
    simulated: str
    difference: str


def rows_of(found: Comparison) -> list[Row]:
    """Return the figures."""
    x, y, work = found.x_unit, found.y_unit, found.work_unit
    shift = f"{found.peak_at_simulated - found.peak_at_measured:+.4g}"
    relative, known = _percent(found.rms_relative, sign=""), np.isfinite(found.correlation)

    def row(name: str, unit: str, measured: float, simulated: float, difference: str) -> Row:
        return Row(name, unit, f"{measured:.4g}", f"{simulated:.4g}", difference)

    mean = []
    if found.steady_range is not None:
        low, high = found.steady_range
        mean = [
            row(
                f"mean over {low:.3g}-{high:.3g}{_shown(x)}",
                y,
                found.mean_measured,
                found.mean_simulated,
                _percent(found.mean_error),
            )
        ]
    return [
        row(
            f"peak {found.y_name}",
            y,
            found.peak_measured,
            found.peak_simulated,
            _percent(found.peak_error),
        ),
        row(
            f"{found.x_name} of the peak",
            x,
            found.peak_at_measured,
            found.peak_at_simulated,
            shift,
        ),
        *mean,
        row("work", work, found.work_measured, found.work_simulated, _percent(found.work_error)),
        Row("RMS difference", y, "", "", f"{found.rms:.4g}"),
        Row("RMS difference over the peak", "-", "", "", relative),
        Row("correlation", "-", "", "", f"{found.correlation:.4f}" if known else "-"),
    ]


def scope_of(found: Comparison) -> str:
    """Return the scope of a comparison: common range, number of points, smoothing."""
    x = _shown(found.x_unit)
    a, b = found.range
    smoothed = "" if found.window is None else f", simulated mean over {found.window:g}{x}"
    return f"{found.x_name} {a:.4g} to {b:.4g}{x}, {len(found.x)} points{smoothed}"


def table_of(found: Comparison) -> str:
    """Return a small table with its scope above it and the notes below."""
    table = [("", "measured", "simulated", "difference")]
    for row in rows_of(found):
        unit = _shown(row.unit)
        both = [f"{cell}{unit}" if cell else "" for cell in (row.measured, row.simulated)]
        own = "" if row.difference.endswith(("%", "-")) else unit
        table.append((row.name, both[0], both[1], f"{row.difference}{own}"))
    width = [max(len(cells[k]) for cells in table) for k in range(4)]
    lines = [
        cells[0].ljust(width[0])
        + "".join(f"  {cell.rjust(w)}" for cell, w in zip(cells[1:], width[1:], strict=True))
        for cells in table
    ]
    notes = [f"note: {note}" for note in found.notes]
    return "\n".join([f"{found.name}: {scope_of(found)}", *lines, *notes])


def _shown(unit: str) -> str:
    return "" if unit == "-" else f" {unit}"


def _percent(fraction: float, sign: str = "+") -> str:
    return f"{100.0 * fraction:{sign}.1f} %" if np.isfinite(fraction) else "-"
