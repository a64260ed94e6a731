"""Sections with pictures: curves, error bars, crack map, snapshots, the run in three dimensions."""

from __future__ import annotations

import shlex
import tempfile
from dataclasses import replace
from html import escape
from pathlib import Path

import numpy as np

from shellcut.arrays import Bools
from shellcut.card import image
from shellcut.files import run_folder
from shellcut.files.distribution import pip_install
from shellcut.results.energy_account import account, energy_put_in, trusted_rows
from shellcut.results.error_bars import COLOURS, PARTS, SIZE, WORDS, ErrorBars
from shellcut.results.run_curves import energy_diagram, imbalance_diagram, resistance_diagram
from shellcut.results.summary_figures import said_of, window_of
from shellcut.results.summary_figures import with_unit as figure_with_unit
from shellcut.scene_page import packed_scene
from shellcut.unit import in_unit, pretty, with_unit
from shellcut.view import Curve, Diagram, draw_crack_map
from shellcut.view.curves import PALETTE

from .chart import Axis, ahead, chart, panel
from .gathered import Gathered
from .page import legend, missing, sentences, table

_LARGEST = 15_000_000  # bytes that the scene may add to a report
_N_MAP = 100  # frames read for the crack map
_HOW = (
    "95 % of fine answers lie within ±, the root of the sum of the squares of its parts. Each "
    "point is a run; the bar at 0 is the value on an infinitely fine mesh."
)


def crack_map(run: Gathered) -> str:
    """Return the crack on the uncut film."""
    frames = run.frames(_N_MAP)
    if not frames:
        return missing("No crack map: there are no frames.")
    places = {}
    if splits := run.results.splits:
        where = np.stack([splits[axis] for axis in "XYZ"], axis=1)
        kinds = splits["kind"]
        places = {str(kind): where[kinds == kind] for kind in np.unique(kinds)}

    try:
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder) / "map.png"
            draw_crack_map(path, frames, splits=places, width=6.5, dpi=130.0)
            png = path.read_bytes()
    except ImportError:
        return missing(f"Not drawn: pictures need Matplotlib ({pip_install('plot')}).")
    name = frames[-1].coordinate_name
    alt = f"Plan of the film with the crack coloured by the {name} at which it opened"
    caption = (
        f"The crack on the uncut film. The colour of each part is that of the first frame in which "
        f"it is open; {len(frames)} of {run.results.n_frame} frames were read."
    )
    return (
        f'<figure>{image(png, alt)}<figcaption class="caption">{escape(caption)}</figcaption>'
        "</figure>"
    )


def snapshots(run: Gathered) -> str:
    """Return the pictures that the run has drawn, side by side, large enough to be read."""
    pictures = [path.read_bytes() for path in run_folder.snapshots(run.results.folder)]
    if not pictures:
        return missing("No pictures: the run has drawn none. shellcut view draws them.")
    shown = "".join(
        f"<figure>{image(png, f'Film and tool, picture {k} of {len(pictures)}')}</figure>"
        for k, png in enumerate(pictures, 1)
    )
    said = f"{len(pictures)} pictures, side by side: scroll to the right for the next."
    return f'<div class="strip" tabindex="0">{shown}</div><p class="caption">{said}</p>'


def scene(run: Gathered) -> str:
    """Return the scene, of fewer frames if all are too large, or why there is none."""
    if not run.results.n_frame:
        return missing("No scene: there are no frames.")
    folder = escape(shlex.quote(str(run.results.folder)))
    command = f"<code>shellcut view {folder} -o FILE.html</code>"
    try:
        html, _, dropped = packed_scene(run.results, None, _LARGEST)
    except ValueError as error:
        return missing(f"No scene: {error}.") + f"<p>{command} writes a page with it alone.</p>"
    said = f"<p>Every frame is in the page that {command} writes.</p>" if dropped else ""
    return html + said


def resistance(run: Gathered) -> str:
    """Return torque (or force) over the coordinate of the motion."""
    if not run.results.history:
        return missing("No curve: the history is missing.")
    diagram = resistance_diagram(run.results.history, run.results.units, run.figures)
    found = run.measured
    if found is not None and (found.x_name, found.y_name) == (diagram.x_name, diagram.name):
        x, y = found.measured_curve
        measured = Curve("measured", y, "measured", x=x)
        diagram = replace(diagram, curves=[*diagram.curves, measured])
    drawn = _chart(diagram, f"{diagram.name} over {diagram.x_name}")
    return f'{drawn}<p class="caption">{escape(_said_of(run))}</p>'


def _said_of(run: Gathered) -> str:
    """Return the meaning of the resistance, and its steady mean."""
    first, unit = run.results.resistance_name, run.results.resistance_unit
    figures = run.figures
    said = []
    if "resistance" in figures:
        resists = "the tool" if "tool_work_Nmm" in figures else "the motion"
        said.append(f"The curve is the {figures['resistance']}. Positive values resist {resists}.")
    mean = f"{first}_plateau_{unit.replace('*', '')}"
    if mean in figures:
        shown = said_of(mean, figures)
        said.append(f"The mean over the steady window, {window_of(figures)}, is {shown}.")
    elif "no_window" in figures:
        said.append(f"There is no steady window, so there is no mean: {figures['no_window']}.")
    return " ".join(said)


def measured(run: Gathered) -> str:
    """Return the run compared with the measured curve; "" without one."""
    found = run.measured
    if found is None:
        return ""
    both, gap = found.diagrams()
    drawn = chart(
        both,
        f"Curves: {found.y_name} over {found.x_name}, measured and simulated; "
        f"their root-mean-square difference is {with_unit(found.rms, found.y_unit)}.",
    ) + chart(gap, f"Curve: difference of simulated and measured {found.y_name}.", 170.0)
    head = ("", "measured", "simulated", "difference")
    return (
        f'{drawn}<p class="caption">{escape(found.scope())}.</p>'
        + table([(in_unit(name, unit), *cells) for name, unit, *cells in found.rows()], head)
        + sentences(("note", "note", note) for note in found.notes)
    )


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
                [f"{run.name}: {figure_with_unit(bar.figure, v)}" for run, v in had],
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


def energy(run: Gathered) -> str:
    """Return the energy balance: work put in, energies, and imbalance."""
    h = run.results.history
    if "tool_work" not in h:
        return missing("No energy balance: the history is missing.")
    rows = [
        (words, with_unit(energy, "N*mm"), f"{100.0 * share:.1f} %")
        for lines in account(run.figures)
        for words, energy, share in lines
    ]
    at_end = table(rows, ("at the end", "energy", "of all put in")) if rows else ""
    ledger = at_end + _chart(energy_diagram(h, run.results.units), "energies and the work put in")
    trusted = trusted_rows(energy_put_in(h))
    if trusted.sum() < 2:
        return ledger
    missed = imbalance_diagram(h, run.results.units)
    start = with_unit(h[missed.x_name][trusted][0], run.results.coordinate_unit)
    missed = replace(missed, name=f"imbalance of the energies from {start} on")
    return ledger + _chart(missed, "imbalance of the energies", 170.0, trusted)


def _chart(
    diagram: Diagram, of: str, height: float = 300.0, rows: Bools | slice = slice(None)
) -> str:
    diagram = diagram.shown()
    x = np.asarray(diagram.x)[rows]
    kept = ahead(x)
    if kept.sum() < 2:
        return missing(f"No curve of {diagram.name}: nothing has moved.")
    unit = pretty(diagram.unit)
    ends = [(curve.name, np.asarray(curve.values)[-1]) for curve in diagram.curves[-3:]]
    last = ", ".join(f"{name} {end:.4g} {unit}" for name, end in ends)
    curves = [
        replace(c, values=np.nan_to_num(c.values, posinf=0.0, neginf=0.0)[rows][kept])
        if c.x is None
        else c
        for c in diagram.curves
    ]
    shown = replace(diagram, x=x[kept], curves=curves)
    return chart(shown, f"Curve: {of}; at the end {last}.", height)
