"""The steady opening test beside its theory: n G h (r + (p/2 pi) cot eta) per radian."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from shellcut.arrays import Bools, Floats
from shellcut.files.regular_file import read_regular
from shellcut.model_file import ModelFileError
from shellcut.model_file.reader import model_of_text
from shellcut.models.opening import steady_work_per_radian
from shellcut.report.chart import Axis, panel
from shellcut.report.markup import missing, table
from shellcut.study.one_run import USED

from .effects import said_of_row
from .studied import Study

_MOST = 400
"""Runs whose models are read; of more every second, third and so on."""

_SHOWN = (
    ("dWcoh_dtheta_Nmm", "cables' work per radian"),
    ("dW_dtheta_Nmm", "tool's work per radian"),
    ("torque_plateau_Nmm", "torque, mean"),
)
"""Figures over the steady window that are compared, the one the theory is about first."""


def theory(study: Study) -> str:
    """Return the runs beside the theory of the plateau; "" if the model is not the opening test."""
    there = [(name, label) for name, label in _SHOWN if name in study.all_figures]
    found = _theory_of(study) if there else None
    if found is None:
        return ""
    pictures, rows = [], []
    for name, label in there:
        figure = study.all_figures[name]
        chosen = np.isfinite(found) & np.isfinite(figure) & study.done
        if not chosen.any():
            continue
        pictures.append(_picture(study, found, figure, label, chosen))
        rows.append((label, *_off(figure[chosen] / found[chosen])))
    pictures += _over_factors(study, found)
    if not rows:
        return missing("No run has a steady window, which the theory is about.")
    head = ("figure over the theory", "runs", "mean", "least", "largest", "standard deviation")
    return (
        "<p>In steady cutting the cables take n G h (r + (p/2π) cot η) per radian: n teeth, "
        "fracture energy G (or that at which the edge severs), thickness h, radius r, pitch p, "
        "inclination η of the edge.</p>"
        f'<div class="panels">{"".join(pictures)}</div>{table(rows, head)}'
        f'<p class="caption">{escape(_SAID)}</p>'
    )


_SAID = (
    "The lines and the crosses are the theory. It is about the work that goes into the cables. "
    "The tool also bends and stretches the film and pays for damping, and the torque is what it "
    "does in turning only: the axial force does F p/2π per radian of the rest. So torque and "
    "theory need not agree."
)


def _picture(study: Study, found: Floats, figure: Floats, label: str, chosen: Bools) -> str:
    ends = np.array([found[chosen].min(), found[chosen].max()])
    return panel(
        Axis("theory", "N·mm", found[chosen]),
        Axis(label, "N·mm", figure[chosen]),
        [said_of_row(study, row) for row in np.flatnonzero(chosen).tolist()],
        lines=[(ends, ends, "same")],
    )


def _over_factors(study: Study, found: Floats) -> list[str]:
    """Return the torque over each factor, with a cross for the theory of each run."""
    torque = study.all_figures.get("torque_plateau_Nmm")
    if torque is None:
        return []
    chosen = np.isfinite(found) & np.isfinite(torque) & study.done
    said = [said_of_row(study, row) for row in np.flatnonzero(chosen).tolist()]
    factors = [one for one in study.factors if chosen.any() and np.ptp(one.values[chosen]) > 0.0]
    return [
        panel(
            Axis(factor.name, factor.unit, factor.values[chosen], factor.names),
            Axis("torque, mean; crosses: theory", "N·mm", torque[chosen]),
            said,
            crosses=(factor.values[chosen], found[chosen]),
        )
        for factor in factors
    ]


def _off(ratio: Floats) -> Sequence[str]:
    spread = f"{ratio.std(ddof=1):.3f}" if len(ratio) > 1 else "–"
    return (
        str(len(ratio)),
        f"{ratio.mean():.3f}",
        f"{ratio.min():.3f}",
        f"{ratio.max():.3f}",
        spread,
    )


def _theory_of(study: Study) -> Floats | None:
    """Return the theory of each run from its own model [N·mm], None of other models."""
    found = np.full(len(study.status), np.nan)
    done = np.flatnonzero(study.done)
    for row in done[:: max(1, -(-len(done) // _MOST))].tolist():
        try:
            text = read_regular(study.run_folder(row) / USED).decode()
            model = model_of_text(text, USED)
        except (OSError, ValueError, ModelFileError):
            continue
        tool, motion = model.sections.get("tool"), model.sections.get("motion")
        if getattr(tool, "kind", "") != "teeth" or getattr(motion, "kind", "") != "screw":
            return None
        found[row] = _per_radian(model.sections)
    return found if np.isfinite(found).any() else None


def _per_radian(sections: Mapping[str, Any]) -> float:
    """Return the theory of one model [N·mm]."""
    tool = sections["tool"]
    return steady_work_per_radian(
        n_teeth=tool.teeth,
        radius=tool.radius,
        edge_inclination_deg=tool.edge_inclination_deg,
        pitch=sections["motion"].pitch,
        thickness=sections["material"].made().thickness,
        law=sections["cohesive"].made().at_edge(tool.edge_radius),
    )
