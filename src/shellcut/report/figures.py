"""Names and units of the figures in ``summary.json``, for people."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

# Endings of the names tell the unit; longer ones first.
_UNITS = {"ns_per_quad_step": "ns", "_Nmm": "N·mm", "_deg": "°", "_mm": "mm", "_N": "N", "_s": "s"}

_LABELS = {
    "torque_plateau_Nmm": "torque, mean over 30-70°",
    "torque_peak_Nmm": "torque, peak",
    "axial_force_plateau_N": "axial force, mean over 30-70°",
    "force_plateau_N": "force, mean over the last 60 % of the way",
    "force_peak_N": "force, peak",
    "crack_length_mm": "crack length",
    "angle_end_deg": "angle at the end",
    "path_end_mm": "path at the end",
    "tool_work_Nmm": "work of the tool",
    "cohesive_work_Nmm": "work of the cables",
    "cohesive_dissipated_Nmm": "dissipated by the cables",
    "cohesive_stored_Nmm": "stored in the cables",
    "strain_Nmm": "strain energy at the end",
    "kinetic_Nmm": "kinetic energy at the end",
    "damping_Nmm": "damping",
    "contact_Nmm": "contact",
    "dWcoh_dtheta_Nmm": "cables' work per radian",
    "dW_dtheta_Nmm": "tool's work per radian",
    "dWcoh_ds_N": "cables' work per mm",
    "dW_ds_N": "tool's work per mm",
    "n_cable_created": "cables created",
    "n_cable_jointed": "cables bent around the edge",
    "n_cable_broken": "cables broken",
    "n_quad": "quads",
    "n_step": "steps",
    "ns_per_quad_step": "time of computing per quad and step",
    "wall_s": "time of computing",
    "pictures_s": "time of drawing",
    "added_inertia_factor": "scale of the rotary inertia",
    "unfelt_penetration_mm": "tool between nodes, unfelt, at most",
    "largest_overshoot_mm": "edge past a cable before it was met, at most",
    "n_recovery_borrowed": "stresses from a neighbour's patch",
}

# Judged or shown elsewhere in the report.
_ELSEWHERE = {"imbalance_rel", "kinetic_rel", "dt_s"}


def key_figures(summary: Mapping[str, Any]) -> list[tuple[str, str]]:
    """Return label and value with its unit: the known ones in order, then the others by name.

    Examples
    --------
    >>> key_figures({"n_step": 39194, "torque_peak_Nmm": 208.17})
    [('torque, peak', '208.2 N·mm'), ('steps', '39,194')]
    """
    known = [key for key in _LABELS if key in summary]
    others = [key for key in summary if key not in _LABELS and key not in _ELSEWHERE]
    return [(_label(key), with_unit(key, summary[key])) for key in [*known, *others]]


def with_unit(key: str, value: Any) -> str:
    """Return a figure of ``summary.json`` with the unit that its name ends with."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    unit = next((unit for ending, unit in _UNITS.items() if key.endswith(ending)), "")
    number = f"{value:,}" if isinstance(value, int) else f"{value:.4g}"
    return f"{number}{'' if unit in ('', '°') else ' '}{unit}"


def _label(key: str) -> str:
    if key in _LABELS:
        return _LABELS[key]
    ending = next((ending for ending in _UNITS if key.endswith(ending)), "")
    return key.removesuffix(ending).removeprefix("n_").replace("_", " ")
