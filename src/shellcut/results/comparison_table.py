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
    c, x, y = found, found.x_unit, found.y_unit
    shift = f"{c.peak_at_simulated - c.peak_at_measured:+.4g}"
    both = [
        (f"peak {c.y_name}", y, c.peak_measured, c.peak_simulated, _percent(c.peak_error)),
        (f"{c.x_name} of the peak", x, c.peak_at_measured, c.peak_at_simulated, shift),
        ("work", c.work_unit, c.work_measured, c.work_simulated, _percent(c.work_error)),
    ]
    if c.steady_range is not None:
        low, high = c.steady_range
        name = f"mean over {low:.3g}-{high:.3g}{_shown(x)}"
        both.insert(2, (name, y, c.mean_measured, c.mean_simulated, _percent(c.mean_error)))
    if np.isfinite(c.pierced_at):
        name = f"at first piercing, {c.pierced_at:.3g}{_shown(x)}"
        change = f"{c.pierced_simulated - c.pierced_measured:+.4g}"
        both.append((name, y, c.pierced_measured, c.pierced_simulated, change))
    correlation = f"{c.correlation:.4f}" if np.isfinite(c.correlation) else "-"
    return [
        *(Row(name, unit, f"{m:.4g}", f"{s:.4g}", off) for name, unit, m, s, off in both),
        Row("RMS difference", y, "", "", f"{c.rms:.4g}"),
        Row("RMS difference over the peak", "-", "", "", _percent(c.rms_relative, sign="")),
        Row("correlation", "-", "", "", correlation),
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
