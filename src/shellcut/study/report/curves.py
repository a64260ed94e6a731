"""The curves of the runs over each other, coloured by a factor that the reader chooses."""

from __future__ import annotations

from dataclasses import replace
from html import escape

import numpy as np

from shellcut.files.run_folder import HISTORY
from shellcut.formats.errors import counted
from shellcut.report.chart import chart
from shellcut.report.markup import missing
from shellcut.results.history import read_history
from shellcut.scene_page.packed_run import as_json
from shellcut.view.curves import Curve, Diagram, outline

from .colouring import Colouring, coloured_by
from .studied import Study

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
        elif found and _axes(one) != _axes(found[0][1]):
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
    groups = [coloured_by(factor, rows) for factor in study.factors if factor.varies]
    if groups:  # in the order of the legend
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


def _axes(one: Diagram) -> tuple[str, str]:
    return one.x_name, one.name


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
    """Return the second and third column of a history, the coordinate going ahead."""
    try:
        columns, units = read_history(study.run_folder(row) / HISTORY)
        _, x_name, y_name, *_ = columns
    except (OSError, ValueError):
        return None
    x, y = columns[x_name], columns[y_name]
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    ahead = x > np.maximum.accumulate(np.append(-np.inf, x))[:-1]
    if ahead.sum() < 2:
        return None
    kept = outline(x[ahead], y[ahead], _COLUMNS)
    curve = Curve("", y[ahead][kept])
    return Diagram(x[ahead][kept], [curve], x_name, units[x_name], y_name, units[y_name])
