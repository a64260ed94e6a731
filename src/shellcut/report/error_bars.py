"""Section of the error bars: the table, and each value over the size of the mesh."""

from __future__ import annotations

from html import escape

import numpy as np

from shellcut.results.error_bars import COLOURS, PARTS, SIZE, WORDS, ErrorBars
from shellcut.results.summary_figures import with_unit
from shellcut.unit import in_unit
from shellcut.view.curves import PALETTE

from .chart import Axis, panel
from .markup import legend, sentences, table


def error_bars(found: ErrorBars | None) -> str:
    """Return values with error bars, their runs, and what is said about them; "" without any."""
    if found is None:
        return ""
    head = ("result", "value", "±", *(f"± {WORDS[part]}" for part in PARTS), "as given")
    rows, pictures = [], []
    for bar in found.bars:
        had = [(run, v) for run, v in zip(found.runs, bar.values, strict=True) if v is not None]
        band, (unit, factor) = found.diagram(bar).shown().curves[0], bar.shown
        as_given = f"{factor * had[0][1]:.5g}"
        rows.append((in_unit(bar.name, unit), *found.cells(bar), as_given))
        pictures.append(
            panel(
                Axis(SIZE, "", np.array([run.size for run, _ in had])),
                Axis(bar.name, unit, factor * np.array([v for _, v in had])),
                [f"{run.name}: {with_unit(bar.figure, v)}" for run, v in had],
                colors=[PALETTE[COLOURS[run.part]] for run, _ in had],
                lines=[(np.asarray(band.x, float), np.asarray(band.values, float), band.style)],
            )
        )
    named = [(WORDS[part], PALETTE[colour]) for part, colour in COLOURS.items()]
    return (
        table(rows, head)
        + legend(named)
        + f'<div class="panels">{"".join(pictures)}</div>'
        + sentences(("note", "note", text) for text in found.said())
        + f'<p class="caption">{escape(_HOW)}</p>'
    )


_HOW = (
    "95 % of fine answers lie within ±, the root of the sum of the squares of its parts. Each "
    "point is a run; the bar at 0 is the value on an infinitely fine mesh."
)
