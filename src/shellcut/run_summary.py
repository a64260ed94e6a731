"""The figures of ``summary.json``: what a run came to, in numbers whose names carry the units."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite

import numpy as np

from ._jit import Floats
from .energy_balance import largest_shares, trusted_rows
from .resistance import Resistance
from .simulation import Simulation
from .trapezoid import integral


def run_summary(
    sim: Simulation,
    resistance: Resistance,
    history: Mapping[str, Floats],
    *,
    until: float,
    stepping: float,
    drawing: float,
    unfelt: float,
) -> dict[str, float]:
    """Return the figures by name; counts are whole numbers.

    A figure that is not finite, of a film that blew up, is left out: JSON has no word for it.

    Parameters
    ----------
    sim : Simulation
        At its end, with a tool.
    resistance : Resistance
        Of its motion.
    history : mapping of ndarray, shape (n_row,)
        Its history.
    until : float
        When it was to end [s].
    stepping, drawing : float
        Wall time without and for the pictures [s].
    unfelt : float
        How deep the tool was between nodes at most without being felt [mm].
    """
    s, r = sim.state, resistance
    book = sim.close_ledger()
    x = history[r.coordinate_name]
    figures = {
        "n_quad": sim.mesh.n_quad,
        "n_step": s.step,
        "dt_s": s.time / max(s.step, 1),
        "wall_s": stepping,
        "ns_per_quad_step": 1e9 * stepping / sim.mesh.n_quad / max(s.step, 1),
        "pictures_s": drawing,
        f"{r.coordinate_name}_end_{r.coordinate_unit}": r.coordinate(s.time),
        "tool_work_Nmm": book.tool_work,
        "kinetic_Nmm": book.kinetic,
        "strain_Nmm": book.strain,
        "cohesive_work_Nmm": book.cohesive_work,
        "cohesive_dissipated_Nmm": book.cohesive_dissipated,
        "cohesive_stored_Nmm": book.cohesive_stored,
        "contact_Nmm": book.contact_work,
        "damping_Nmm": book.damping,
        **largest_shares(history, trusted_rows(x, r.coordinate_unit, r.coordinate(until))),
        "n_cable_created": s.n_cable,
        "n_cable_jointed": sim.n_joint_made,
        "n_cable_broken": sim.n_cable_broken,
        "crack_length_mm": s.crack_length,
        "n_recovery_borrowed": sim.criterion.n_borrowed if sim.criterion else 0,
        "unfelt_penetration_mm": unfelt,
        "largest_overshoot_mm": s.cable.overshoot[: s.n_cable].max(initial=0.0),
        "added_inertia_factor": sim.shell.added_inertia_factor,
        **_plateau(history, r),
    }
    return {
        name: int(value) if name.startswith("n_") else float(value)
        for name, value in figures.items()
        if isfinite(value)
    }


def _plateau(history: Mapping[str, Floats], r: Resistance) -> dict[str, float]:
    """Return mean, peak and slopes of the resistance: over 30 to 70 degrees, or the last 60 %."""
    x = history[r.coordinate_name]
    if not len(x):
        return {}
    first, unit = r.columns[0]
    turns = r.coordinate_unit == "deg"
    low, high = (30.0, 70.0) if turns else (0.4 * x[-1], x[-1])
    window = (x >= low) & (x <= high)
    if window.sum() < 3 or x[window][-1] <= x[window][0]:
        return {}
    way = x[window] / r.coordinate_scale

    def mean(name: str) -> float:
        return integral(way, history[name][window]) / float(way[-1] - way[0])

    def slope(name: str) -> float:
        return float(np.polyfit(way, history[name][window], 1)[0])

    per = "dtheta_Nmm" if turns else "ds_N"
    figures = {
        f"{first}_plateau_{unit.replace('*', '')}": mean(first),
        f"{first}_peak_{unit.replace('*', '')}": float(history[first].max()),
        f"dWcoh_{per}": slope("cohesive_work"),
        f"dW_{per}": slope("tool_work"),
    }
    if "axial_force" in history:
        figures["axial_force_plateau_N"] = mean("axial_force")
    return figures
