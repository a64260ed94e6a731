"""The curves of the runs over each other, coloured by a factor that the reader chooses."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from dataclasses import dataclass
from html import escape

import numpy as np

from shellcut.arrays import Floats
from shellcut.files.regular_file import read_regular
from shellcut.files.run_folder import HISTORY
from shellcut.report.chart import Curve, chart
from shellcut.report.markup import missing, pretty

from .colouring import Colouring, coloured_by
from .studied import Study

_MOST = 100
"""Curves that are drawn; of more runs every second, third and so on."""

_COLUMNS = 150
"""In which a curve keeps its lowest and highest point."""


@dataclass(frozen=True)
class _OfRun:
    row: int
    x: Floats
    y: Floats
    names: tuple[str, str]
    units: tuple[str, str]


def curves(study: Study) -> str:
    """Return torque or force over angle or path, of all runs that are done."""
    done = np.flatnonzero(study.done)
    chosen = done[:: -(-len(done) // _MOST)] if len(done) else done
    found: list[_OfRun] = []
    lost = 0
    for row in chosen.tolist():
        one = _read(study, row)
        lost += one is None
        if one is not None and (not found or one.names == found[0].names):
            found.append(one)
    if not found:
        return missing("No curves: no run that is done has a history that can be read.")
    said = []
    if len(chosen) < len(done):
        said.append(f"{len(chosen)} of {len(done)} runs are drawn, evenly chosen.")
    if lost:
        said.append(f"The history of {lost} runs is missing.")
    groups = _groups(study, found)
    if groups:  # in the order of the legend
        found = [found[k] for k in np.argsort(groups[0].group, kind="stable")]
        groups = _groups(study, found)
    longest = max(found, key=lambda one: one.x[-1] - one.x[0])
    (x_name, y_name), (x_unit, y_unit) = found[0].names, found[0].units
    first = groups[0] if groups else Colouring("", ("all runs",), np.zeros(len(found), int))
    picture = chart(
        longest.x,
        [_curve(one, first, k) for k, one in enumerate(found)],
        x_name=x_name,
        x_unit=pretty(x_unit),
        name=y_name,
        unit=pretty(y_unit),
        described=f"Curves: {y_name} over {x_name} of {len(found)} runs.",
        height=380.0,
    )
    note = f'<p class="caption">{escape(" ".join(said))}</p>' if said else ""
    return f'<div class="coloured">{_chooser(groups)}{picture}</div>{note}'


def _groups(study: Study, found: Sequence[_OfRun]) -> list[Colouring]:
    rows = np.array([one.row for one in found])
    return [coloured_by(factor, rows) for factor in study.factors if factor.varies]


def _curve(one: _OfRun, by: Colouring, k: int) -> Curve:
    group = int(by.group[k])
    return Curve(by.names[group], one.y, f"run {by.style(group)}", x=one.x)


def _chooser(groups: list[Colouring]) -> str:
    """Return the choice of a factor, and the colours by each for ``study.js``."""
    if len(groups) < 2:
        return ""
    options = "".join(f"<option>{escape(one.factor)}</option>" for one in groups)
    data = [
        {
            "names": one.names,
            "styles": [f"run {one.style(k)}" for k in range(len(one.names))],
            "group": one.group.tolist(),
        }
        for one in groups
    ]
    text = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    return (
        f'<p class="by"><label>coloured by <select>{options}</select></label></p>'
        f'<script type="application/json" class="groups">{text}</script>'
    )


def _read(study: Study, row: int) -> _OfRun | None:
    """Return the second and third column of a history, the coordinate going ahead."""
    try:
        text = read_regular(study.run_folder(row) / HISTORY).decode()
        whole = text[: text.rfind("\n") + 1]  # a run that was killed leaves part of a line
        heads = [cell.partition(" [") for cell in whole.partition("\n")[0].split(",")[1:3]]
        x, y = np.loadtxt(io.StringIO(whole), delimiter=",", skiprows=1, usecols=(1, 2), ndmin=2).T
    except (OSError, ValueError, IndexError):
        return None
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    ahead = np.concatenate(([True], x[1:] > np.maximum.accumulate(x)[:-1])) if len(x) else good
    if len(heads) != 2 or ahead.sum() < 2:
        return None
    kept = _outline(x[ahead], y[ahead])
    names, units = zip(*((name, rest.rstrip("]\r")) for name, _, rest in heads), strict=True)
    return _OfRun(row, x[ahead][kept], y[ahead][kept], names, units)


def _outline(x: Floats, y: Floats) -> np.ndarray[tuple[int], np.dtype[np.int64]]:
    """Return the rows of the lowest and the highest point in each column: no peak is lost."""
    if len(x) <= 2 * _COLUMNS:
        return np.arange(len(x))
    column = ((x - x[0]) / (x[-1] - x[0]) * (_COLUMNS - 1)).astype(int)
    order = np.lexsort((y, column))
    bounds = np.flatnonzero(np.diff(column[order])) + 1
    first, last = np.concatenate(([0], bounds)), np.concatenate((bounds, [len(x)])) - 1
    return np.unique(np.concatenate((order[first], order[last], [0, len(x) - 1])))
