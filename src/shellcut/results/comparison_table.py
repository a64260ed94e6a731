"""The figures of a comparison: rows for a page, a table for a terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from shellcut.unit import after, shown

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
    shift = c.peak_at_simulated - c.peak_at_measured
    both: list[tuple[str, str, float, float, str | float]] = [
        (f"peak {c.y_name}", y, c.peak_measured, c.peak_simulated, _percent(c.peak_error)),
        (f"{c.x_name} of the peak", x, c.peak_at_measured, c.peak_at_simulated, shift),
        ("work", c.work_unit, c.work_measured, c.work_simulated, _percent(c.work_error)),
    ]
    if c.steady_range is not None:
        unit, factor = shown(x)
        low, high = (factor * end for end in c.steady_range)
        name = f"mean over {low:.3g}-{high:.3g}{after(unit)}"
        both.insert(2, (name, y, c.mean_measured, c.mean_simulated, _percent(c.mean_error)))
    if np.isfinite(c.pierced_at):
        unit, factor = shown(x)
        name = f"at first piercing, {factor * c.pierced_at:.3g}{after(unit)}"
        change = c.pierced_simulated - c.pierced_measured
        both.append((name, y, c.pierced_measured, c.pierced_simulated, change))
    correlation = f"{c.correlation:.4f}" if np.isfinite(c.correlation) else "-"
    return [
        *(_row(*cells) for cells in both),
        _row("RMS difference", y, None, None, c.rms, sign=""),
        Row("RMS difference over the peak", "-", "", "", _percent(c.rms_relative, sign="")),
        Row("correlation", "-", "", "", correlation),
    ]


def _row(
    name: str, unit: str, m: float | None, s: float | None, off: str | float, sign: str = "+"
) -> Row:
    """Return numbers as text in the unit in which they are shown; ``off`` may be text already."""
    unit, factor = shown(unit)
    measured, simulated = ("" if value is None else f"{factor * value:.4g}" for value in (m, s))
    difference = off if isinstance(off, str) else f"{factor * off:{sign}.4g}"
    return Row(name, unit, measured, simulated, difference)


def scope_of(found: Comparison) -> str:
    """Return the scope of a comparison: common range, number of points, smoothing."""
    unit, factor = shown(found.x_unit)
    a, b, width = (factor * along for along in (*found.range, found.window or 0.0))
    x = after(unit)
    smoothed = f", simulated mean over {width:.4g}{x}" if width else ""
    return f"{found.x_name} {a:.4g} to {b:.4g}{x}, {len(found.x)} points{smoothed}"


def table_of(found: Comparison) -> str:
    """Return a small table with its scope above it and the notes below."""
    table = [("", "measured", "simulated", "difference")]
    for row in rows_of(found):
        unit = after(row.unit)
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


def _percent(fraction: float, sign: str = "+") -> str:
    return f"{100.0 * fraction:{sign}.1f} %" if np.isfinite(fraction) else "-"
