"""Pictures of all runs: curves coloured by a chosen factor, and values over factors."""

from __future__ import annotations

import itertools
from dataclasses import dataclass, replace
from html import escape

import numpy as np

from shellcut.arrays import Bools, Ints
from shellcut.files.run_folder import HISTORY
from shellcut.formats.errors import counted
from shellcut.report.chart import MOST_POINTS, Axis, ahead, chart, panel
from shellcut.report.page import missing
from shellcut.results.history import read_history
from shellcut.results.run_curves import resistance_diagram
from shellcut.scene_page.packed_run import as_json
from shellcut.unit import after
from shellcut.view.curves import PALETTE, Curve, Diagram, outline

from .studied import Studied, Study

_MOST = 100
"""Curves that are drawn; of more runs every second, third and so on."""

_COLUMNS = 150
"""In which a curve keeps its lowest and highest point."""


def curves(study: Study) -> str:
    """Return torque or force over angle or path, of all runs that are done."""
    done = np.flatnonzero(study.done)
    chosen = done[:: -(-len(done) // _MOST)] if len(done) else done
    found: list[tuple[int, Diagram]] = []
    n_lost = n_other = 0
    for row in chosen.tolist():
        one = _read(study, row)
        if one is None:
            n_lost += 1
        elif found and (one.x_name, one.name) != (found[0][1].x_name, found[0][1].name):
            n_other += 1
        else:
            found.append((row, one))
    if not found:
        return missing("No curves: no run that is done has a history that can be read.")
    said = []
    if len(chosen) < len(done):
        said.append(f"{len(chosen)} of {len(done)} runs are drawn, evenly chosen.")
    if n_lost:
        said.append(f"{counted(n_lost, 'run')} without a history that can be read left out.")
    if n_other:
        said.append(f"{counted(n_other, 'run')} with other columns left out.")
    rows = np.array([row for row, _ in found])
    if groups := [coloured_by(factor, rows) for factor in study.factors if factor.varies]:
        order = np.argsort(groups[0].group, kind="stable")
        found = [found[k] for k in order]
        groups = [replace(one, group=one.group[order]) for one in groups]
    diagrams = [one for _, one in found]
    longest = max(diagrams, key=lambda one: np.ptp(one.x))
    first = groups[0] if groups else Colouring("", ("all runs",), np.zeros(len(found), int))
    drawn = [
        replace(one.curves[0], name=first.names[k], style=first.style(k), x=one.x)
        for k, one in zip(first.group.tolist(), diagrams, strict=True)
    ]
    picture = chart(
        replace(longest, curves=drawn),
        f"Curves: {longest.name} over {longest.x_name} of {len(found)} runs.",
        380.0,
    )
    note = f'<p class="caption">{escape(" ".join(said))}</p>' if said else ""
    return f'<div class="coloured">{_chooser(groups)}{picture}</div>{note}'


def _chooser(groups: list[Colouring]) -> str:
    """Return the choice of a factor, and what each changes of the curves, for ``study.js``."""
    if len(groups) < 2:
        return ""
    options = "".join(f"<option>{escape(one.factor)}</option>" for one in groups)
    changes = [
        {
            "name": [escape(one.names[k]) for k in one.group],
            "legendgroup": [one.names[k] for k in one.group],
            "line.color": [one.color(int(k)) for k in one.group],
            "showlegend": [k not in one.group[:n] for n, k in enumerate(one.group)],
            "legendrank": [1000 + int(k) for k in one.group],
        }
        for one in groups
    ]
    return (
        f'<p class="by"><label>coloured by <select>{options}</select></label></p>'
        f'<script type="application/json" class="changes">{as_json(changes)}</script>'
    )


def _read(study: Study, row: int) -> Diagram | None:
    """Return torque or force of a run, its coordinate going ahead; None if it cannot be read."""
    try:
        found = resistance_diagram(*read_history(study.run_folder(row) / HISTORY))
    except (OSError, ValueError):
        return None
    x, y = np.asarray(found.x), np.asarray(found.curves[-1].values)
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    kept = ahead(x)
    if kept.sum() < 2:
        return None
    x, y = x[kept], y[kept]
    rows = outline(x, y, _COLUMNS)
    return replace(found, x=x[rows], curves=[Curve("", y[rows])])


@dataclass(frozen=True)
class Colouring:
    """Groups of runs by one factor."""

    factor: str
    """Its name."""
    names: tuple[str, ...]
    """Of the groups, in order."""
    group: Ints
    """Of each run, shape (n,)."""

    def style(self, group: int) -> str:
        """Return the style of a group's lines, from the first to the last of the palette."""
        n = len(PALETTE)
        if len(self.names) > n:
            return f"c{group % n}"
        return f"c{round(group * (n - 1) / max(1, len(self.names) - 1))}"

    def color(self, group: int) -> str:
        """Return the colour of a group."""
        return PALETTE[int(self.style(group)[1:])]


def coloured_by(factor: Studied, rows: Bools | Ints) -> Colouring:
    """Return groups by the values of a factor, or by even parts of its range."""
    values, unit = factor.values[rows], after(factor.unit)
    if factor.names:
        linked = ", " in factor.key  # whose values need the names of the keys
        names = tuple(f"{factor.name}: {n}" if linked else n for n in factor.names)
        return Colouring(factor.name, names, values.astype(int))
    levels = np.unique(values)
    if len(levels) <= len(PALETTE):
        names = tuple(f"{factor.name} {level:.5g}{unit}" for level in levels)
        return Colouring(factor.name, names, np.searchsorted(levels, values))
    low, high = factor.ends
    bounds = np.linspace(low, high, len(PALETTE))  # one colour less: bounds that are easier to read
    group = np.clip(np.searchsorted(bounds, values, side="right") - 1, 0, len(PALETTE) - 2)
    names = tuple(
        f"{factor.name} {a:.4g} to {b:.4g}{unit}" for a, b in itertools.pairwise(bounds.tolist())
    )
    return Colouring(factor.name, names, group)


def scatter(study: Study) -> str:
    """Return a row of pictures for each value."""
    parts, most = [], 0
    for figure in study.figures:
        rows = study.done & np.isfinite(figure.values)
        factors = [one for one in study.factors if rows.any() and np.ptp(one.values[rows]) > 0.0]
        if not factors:
            parts.append(missing(f"{figure.name}: no factor varies over the runs that have it."))
            continue
        most, said = max(most, int(rows.sum())), said_of(study, rows)
        y = Axis(figure.name, figure.unit, figure.values[rows])
        pictures = [
            panel(
                Axis(one.name, one.unit, one.values[rows], one.names),
                y,
                said,
                hollow=study.doubted[rows],
            )
            for one in factors
        ]
        parts.append(f'<div class="panels">{"".join(pictures)}</div>')
    if not most:
        return "".join(parts)
    told = "Each point is a run; point at it to read its number and inputs."
    if most > MOST_POINTS:
        told += f" Of so many runs, up to {MOST_POINTS} are drawn, evenly chosen."
    return "".join(parts) + f'<p class="caption">{escape(told)}</p>'


def said_of(study: Study, rows: Bools) -> list[str]:
    """Return what pointing at each of some runs says: its number and inputs."""
    said = []
    for row in np.flatnonzero(rows).tolist():
        inputs = []
        for f in study.inputs:
            text = f.texts[row] if f.names else f"{f.values[row]:.5g}{after(f.unit)}"
            inputs.append(f"{f.name} {text}")
        doubted = ", distrusted" if study.doubted[row] else ""
        said.append(f"run {study.numbers[row]}{doubted}: {', '.join(inputs)}")
    return said
