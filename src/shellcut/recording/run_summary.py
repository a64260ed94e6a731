"""The figures of ``summary.json``, with the unit in each name."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np

from shellcut.arrays import Floats
from shellcut.contact.edge_contact import EdgeContact
from shellcut.results.energy_account import energy_figures, largest_shares, trusted_rows
from shellcut.results.steady_window import steady_figures
from shellcut.state.pieces import Pieces

from .resistance import AnyResistance
from .run_digest import run_digest
from .unfelt_penetration import Unfelt

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation


def run_summary(
    sim: Simulation,
    resistance: AnyResistance,
    history: Mapping[str, Floats],
    *,
    stepping: float,
    drawing: float,
    unfelt: Unfelt,
) -> dict[str, Any]:
    """Return the figures by name; counts are integers, reasons are texts.

    Figures that are not finite (a film that blew up) are left out: JSON cannot express them.

    Parameters
    ----------
    sim : Simulation
        At its end.
    resistance : Resistance or SupportPull
        To the motion of its tool or supports.
    history : mapping of ndarray, shape (n_row,)
        Its history.
    stepping, drawing : float
        Wall time without and for the pictures [s].
    unfelt : Unfelt
        Largest penetration that no contact feels.
    """
    s, r = sim.state, resistance
    figures = {
        "n_quad": sim.mesh.n_quad,
        "n_step": s.step,
        "dt_s": s.time / max(s.step, 1),
        "wall_s": stepping,
        "ns_per_quad_step": 1e9 * stepping / sim.mesh.n_quad / max(s.step, 1),
        "pictures_s": drawing,
        f"{r.coordinate_name}_end_{r.coordinate_unit}": r.coordinate(s.time),
        **_of_energies(sim, history),
        **largest_shares(history, trusted_rows(history)),
        "n_cable_created": s.n_cable,
        "n_cable_broken": sim.cables.n_broken,
        "crack_length_mm": s.crack_length,
        **_of_the_tool(sim, unfelt),
        **_of_self_contact(sim),
        **_of_pieces(sim),
        "added_inertia_factor": sim.shell.added_inertia_factor,
        "n_imperfection": sim.imperfection.number,
        "imperfection_mm": sim.imperfection.amplitude,
        **_peaks(history, r),
    }
    if sim.cracks is not None:
        figures["n_copy"] = s.n_quad - sim.mesh.n_quad
        if sim.cracks.free.stress is not None:
            figures["n_recovery_borrowed"] = sim.cracks.free.stress.n_borrowed
    finite: dict[str, Any] = {
        name: int(value) if name.startswith("n_") else float(value)
        for name, value in figures.items()
        if isfinite(value)
    }
    coordinate = r.coordinate_name, r.coordinate_unit
    finite |= steady_figures(history, coordinate, r.columns[0])
    if sim.cracks is not None:
        finite["crack_path"] = sim.fracture.path
    if sim.between_steps:
        finite["digest"] = run_digest(sim.saved(), history)
    return finite | {"resistance": r.meaning, "options": _options(sim)}


def _of_energies(sim: Simulation, history: Mapping[str, Floats]) -> dict[str, float]:
    """Return the account of the work, and what makes up that of the cables [N·mm].

    Of a run that broke off within a step it is that of the last row: its state means nothing.
    """
    entries = vars(sim.close_ledger())
    if not sim.between_steps:
        entries = {name: float(history[name][-1]) for name in entries if name in history}
    of_cables = ("cohesive_work", "cohesive_dissipated", "cohesive_stored")
    return energy_figures(entries) | {f"{name}_Nmm": entries[name] for name in of_cables}


def _options(sim: Simulation) -> dict[str, Any]:
    """Return the options on which it depends what may be done about a doubt."""
    return {
        "path": None if sim.cracks is None else sim.fracture.path,
        "only_along_edges": bool(sim.fracture.only_along_edges),
        "check_every": sim.fracture.check_every,
        "film_edges": any(isinstance(term, EdgeContact) for term in sim.tool_terms),
        "fixed_step": sim.time_step.stepping.fixed is not None,
        "opening_u_mm": None if sim.law is None else sim.law.opening_u,
    }


def _of_the_tool(sim: Simulation, unfelt: Unfelt) -> dict[str, float]:
    """Return the figures of contact and of cables that meet the tool, none without a tool."""
    s = sim.state
    if sim.contact is None:
        return {}
    return {
        "n_cable_jointed": sim.cables.n_joint_made,
        "deepest_penetration_mm": sim.contact.deepest,
        "tool_half_thickness_mm": sim.contact.law.tool_half_thickness,
        "unfelt_penetration_mm": unfelt.quads,
        "unfelt_film_edge_mm": unfelt.film_edges,
        "film_half_thickness_mm": 0.5 * sim.material.thickness,
        "largest_overshoot_mm": s.cable.overshoot[: s.n_cable].max(initial=0.0),
    }


def _of_self_contact(sim: Simulation) -> dict[str, float]:
    """Return the figures of the film's contact with itself, none without it."""
    if sim.self_contact is None:
        return {}
    return {
        "self_contact_deepest_mm": sim.self_contact.deepest,
        "n_self_contact_looked": sim.self_contact.n_looked,
    }


def _of_pieces(sim: Simulation) -> dict[str, float]:
    """Return how many pieces of the film are loose, and what was taken out; none without cracks."""
    if sim.cracks is None:
        return {}
    figures: dict[str, float] = {"n_loose": Pieces.of(sim.state).n_loose}
    if sim.state.n_dropped:
        figures["n_dropped"] = sim.state.n_dropped
    return figures


def _peaks(history: Mapping[str, Floats], r: AnyResistance) -> dict[str, float]:
    """Return the value of largest magnitude, with its sign, and where it occurred."""
    name, unit = r.columns[0]
    values = history[name]
    finite = np.flatnonzero(np.isfinite(values))
    if not finite.size:
        return {}
    k = int(finite[np.argmax(np.abs(values[finite]))])
    return {
        f"{name}_peak_{unit.replace('*', '')}": float(values[k]),
        f"{name}_peak_at_{r.coordinate_unit}": float(history[r.coordinate_name][k]),
    }
