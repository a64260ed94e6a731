"""The curves of a run: resistance, energies and imbalance, for pictures and pages."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from shellcut.arrays import Floats
from shellcut.view.curves import Curve, Diagram

from .energy_account import PUT_IN, TAKEN_UP, energy_put_in, energy_shares, total, trusted_rows
from .summary_figures import said_of, window_of

# A negative share up to this part of the largest is still drawn as an area: round-off and the half
# step between work and energy cause it.
_NEGATIVE_SHARE = 0.01

# Parts of the energy balance, each with a colour that is the same in all pictures.
_COLOURS = {part.name: f"a{k}" for k, part in enumerate(TAKEN_UP)}

# Teeth whose curves differ by less than this part of the largest value are drawn as one.
_ALIKE = 0.01


def resistance_diagram(
    history: Mapping[str, Floats],
    units: Mapping[str, str],
    figures: Mapping[str, Any] | None = None,
) -> Diagram:
    """Return torque or force over the coordinate: in total, in parts and of each tooth.

    With the values of the run its mean over the steady window is drawn, if there is one.
    """
    _, x, name, *_ = history
    teeth = [column for column in history if column.startswith(f"{name}_tooth_")]
    each = {f"tooth {c.rpartition('_')[2]}": history[c] for c in teeth if len(teeth) > 1}
    values = np.array(list(each.values()))
    if len(each) and np.ptp(values, axis=0).max() <= _ALIKE * np.abs(values).max():
        each = {f"each of {len(teeth)} teeth, all alike": values.mean(axis=0)}
    curves = [
        Curve(said, numbers, f"tooth{k % 8}", group="teeth")
        for k, (said, numbers) in enumerate(each.items())
    ]
    joints = history.get(f"{name}_joints")
    if joints is not None:
        curves += [
            Curve("from contact", history[name] - joints, "contact"),  # friction, too
            Curve("from cables at the edge", joints, "joints"),
        ]
    curves.append(Curve("total", history[name]))
    mean = f"{name}_plateau_{units[name].replace('*', '')}"
    if figures is not None and mean in figures:
        label = f"mean over {window_of(figures)}: {said_of(mean, figures)}"
        ends = [figures[f"window_{end}_{units[x]}"] for end in ("from", "to")]
        curves.append(Curve(label, [figures[mean]] * 2, "mean", x=ends))
    return Diagram(history[x], curves, x, units[x], name, units[name])


def energy_diagram(history: Mapping[str, Floats], units: Mapping[str, str]) -> Diagram:
    """Return what the work put in has become.

    The energies are stacked, so that their upper border meets the line of the work if the
    energies balance. If one of them is clearly negative they are lines instead.
    """
    x = list(history)[1]
    shares = energy_shares(history)
    largest = max((float(np.abs(share).max()) for share in shares.values()), default=0.0)
    stacked = all(share.min() >= -_NEGATIVE_SHARE * largest for share in shares.values())
    curves = [
        Curve(part.words, shares[part.words], _COLOURS[part.name], area=stacked)
        for part in TAKEN_UP
        if part.words in shares
    ]
    curves.append(Curve("work put in", total(PUT_IN, history), "work"))
    return Diagram(history[x], curves, x, units[x], "energy", "N*mm", height=3.0)


def imbalance_diagram(history: Mapping[str, Floats], units: Mapping[str, str]) -> Diagram:
    """Return the imbalance over the energy put in [%], from a tenth of its largest value on."""
    x = list(history)[1]
    put_in = energy_put_in(history)
    missed = 100.0 * history["imbalance"] / np.where(trusted_rows(put_in), put_in, np.nan)
    return Diagram(history[x], [Curve("imbalance", missed)], x, units[x], "imbalance", "%")
