"""Sections with curves: resistance, measured curve, energy ledger, time step."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from html import escape

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.results.comparison_table import rows_of, scope_of
from shellcut.results.energy_account import PUT_IN, account, energy_shares, is_pulled, total
from shellcut.results.summary_figures import window_of

from .chart import Curve, chart
from .gathered import Gathered
from .markup import figure_of, in_unit, missing, pretty, table


def resistance(run: Gathered) -> str:
    """Return torque (or force) over the coordinate of the motion."""
    if not run.history:
        return missing("No curve: the history is missing.")
    first, unit = run.resistance
    teeth = [name for name in run.history if name.startswith(f"{first}_tooth_")]
    curves = []
    if len(teeth) > 1:
        label = f"each of {len(teeth)} teeth"
        curves += [Curve(label, run.history[name], "tooth") for name in teeth]
    if not is_pulled(run.history):
        curves += [
            Curve("from contact", run.history[f"{first}_contact"], "contact"),
            Curve("from cables at the edge", run.history[f"{first}_joints"], "joints"),
        ]
    curves.append(Curve("total", run.history[first], "total"))
    found = run.measured
    if found is not None and (found.x_name, found.y_name) == (run.coordinate[0], first):
        x, y = found.measured_curve
        curves.append(Curve("measured", y, "measured", x=x))
    chart_of_it = _chart(run, curves, first, pretty(unit), f"{first} over {run.coordinate[0]}")
    return f'{chart_of_it}<p class="caption">{escape(_said_of(run))}</p>'


def _said_of(run: Gathered) -> str:
    """Return the meaning of the resistance, and its steady mean."""
    first, unit = run.resistance
    figures = run.figures
    said = []
    if "resistance" in figures:
        resists = "the tool" if "tool_work_Nmm" in figures else "the motion"
        said.append(f"Shown is the {figures['resistance']}; positive resists {resists}.")
    mean = figures.get(f"{first}_plateau_{unit.replace('*', '')}")
    if mean is not None:
        said.append(
            f"The mean over the steady window, {window_of(figures)}, is {mean:.4g} {pretty(unit)}."
        )
    elif "no_window" in figures:
        said.append(f"There is no steady window, so there is no mean: {figures['no_window']}.")
    return " ".join(said)


def measured(run: Gathered) -> str:
    """Return the run compared with the measured curve; "" without one."""
    found = run.measured
    if found is None:
        return ""
    x, simulated = found.simulated_curve
    drawn = chart(
        x,
        [
            Curve("measured", found.measured_curve[1], "measured", x=found.measured_curve[0]),
            Curve("simulated", simulated, "total"),
            Curve("difference", found.simulated - found.measured, "contact", x=found.x),
        ],
        x_name=found.x_name,
        x_unit=pretty(found.x_unit),
        name=found.y_name,
        unit=pretty(found.y_unit),
        described=f"Curves: {found.y_name} over {found.x_name}, measured and simulated; "
        f"their root-mean-square difference is {found.rms:.4g} {found.y_unit}.",
    )
    head = ("", "measured", "simulated", "difference")
    notes = "".join(f'<li class="note"><b>note</b>{escape(note)}</li>' for note in found.notes)
    return (
        f'{drawn}<p class="caption">{escape(pretty(scope_of(found)).replace(" °", "°"))}.</p>'
        + table([(in_unit(row.name, row.unit), *row[2:]) for row in rows_of(found)], head)
        + (f'<ul class="verdict">{notes}</ul>' if notes else "")
    )


def energy(run: Gathered) -> str:
    """Return the energy ledger: work put in, energies, and imbalance."""
    h = run.history
    if "tool_work" not in h:
        return missing("No ledger: the history is missing.")
    shares = energy_shares(h)
    largest = max(float(np.abs(share).max()) for share in shares.values())
    stacked = all(share.min() >= -0.01 * largest for share in shares.values())
    curves = [
        Curve(name, share, f"a{k}", area=stacked) for k, (name, share) in enumerate(shares.items())
    ]
    curves.append(Curve("work put in", total(PUT_IN, h), "work"))
    rows = [
        (words, f"{energy:.4g} N·mm", f"{100.0 * share:.1f} %")
        for lines in account(run.figures)
        for words, energy, share in lines
    ]
    at_end = table(rows, ("at the end", "energy", "of all put in")) if rows else ""
    ledger = at_end + _chart(run, curves, "energy", "N·mm", "energies and the work put in")
    trusted = run.trusted
    if trusted.sum() < 2:
        return ledger
    missed = [Curve("imbalance", 100.0 * h["imbalance_rel"][trusted], "total")]
    name, unit = run.coordinate
    start = figure_of(h[name][trusted][0], unit)
    return ledger + _chart(
        run,
        missed,
        f"imbalance of the ledger from {start} on",
        "%",
        "imbalance of the ledger",
        height=170.0,
        rows=trusted,
    )


def step(run: Gathered) -> str:
    """Return the time step, in numbers and over the tool's coordinate."""
    if "dt" not in run.history:
        return ""
    steps = 1e9 * run.history["dt"][1:]  # the first row is before the first step
    rows = [("smallest", f"{steps.min():.4g} ns"), ("largest", f"{steps.max():.4g} ns")]
    if "n_step" in run.summary:
        rows.append(("steps", f"{run.summary['n_step']:,}"))
        rows.append(("mean", f"{1e9 * run.summary['dt_s']:.4g} ns"))
    step = np.concatenate((steps[:1], steps))
    return table(rows) + _chart(
        run, [Curve("step", step, "contact")], "time step", "ns", "the time step", height=190.0
    )


def _chart(
    run: Gathered,
    curves: Sequence[Curve],
    name: str,
    unit: str,
    of: str,
    height: float = 300.0,
    rows: Bools | slice = slice(None),
) -> str:
    coordinate, coordinate_unit = run.coordinate
    x = run.history[coordinate][rows]
    # A motion may rest or reverse; a curve over its coordinate needs ascending values.
    ahead = np.concatenate(([True], x[1:] > np.maximum.accumulate(x)[:-1]))
    if ahead.sum() < 2:
        return missing(f"No curve of {name}: nothing has moved.")
    last = ", ".join(f"{curve.name} {curve.values[-1]:.4g} {unit}" for curve in curves[-3:])
    shown = [c if c.x is not None else replace(c, values=_finite(c.values[ahead])) for c in curves]
    return chart(
        x[ahead],
        shown,
        x_name=coordinate,
        x_unit=pretty(coordinate_unit),
        name=name,
        unit=unit,
        described=f"Curve: {of}; at the end {last}.",
        height=height,
    )


def _finite(values: Floats) -> Floats:
    return np.nan_to_num(values, posinf=0.0, neginf=0.0)
