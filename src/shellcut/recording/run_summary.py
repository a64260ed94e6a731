"""The figures of ``summary.json``, with the unit in each name."""

from __future__ import annotations

from collections.abc import Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

from shellcut.arrays import Floats
from shellcut.contact.edge_contact import EdgeContact
from shellcut.results.run_figures import run_figures
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
    end: Mapping[str, float] | None = None,
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
    end : mapping of str to float or None
        The columns of the history at its end, by default its last row: the state of a run that
        broke off within a step means nothing.
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
        **_of_the_tool(sim, unfelt),
        **_of_self_contact(sim),
        **_of_pieces(sim),
        "added_inertia_factor": sim.shell.added_inertia_factor,
        "n_imperfection": sim.imperfection.number,
        "imperfection_mm": sim.imperfection.amplitude,
    }
    if sim.pace.share is not None:
        figures |= {"quasi_static": sim.pace.share, "n_stop": sim.pace.n_stop}
    if sim.cracks is not None:
        figures["n_copy"] = s.n_quad - sim.mesh.n_quad
        if sim.cracks.stress is not None:
            figures["n_recovery_borrowed"] = sim.cracks.stress.n_borrowed
    finite: dict[str, Any] = {
        name: int(value) if name.startswith("n_") else float(value)
        for name, value in figures.items()
        if isfinite(value)
    }
    coordinate = r.coordinate_name, r.coordinate_unit
    finite |= run_figures(history, coordinate, r.columns[0], end, s.splits)
    if sim.cracks is not None:
        finite["crack_path"] = sim.fracture.path
    if sim.between_steps:
        finite["digest"] = run_digest(sim.saved(), history)
    return finite | {"resistance": r.meaning, "options": _options(sim)}


def _options(sim: Simulation) -> dict[str, Any]:
    """Return the options on which it depends what may be done about a doubt."""
    return {
        "path": None if sim.cracks is None else sim.fracture.path,
        "only_along_edges": bool(sim.fracture.only_along_edges),
        "check_every": sim.fracture.check_every,
        "film_edges": any(isinstance(term, EdgeContact) for term in sim.terms),
        "fixed_step": sim.time_step.stepping.fixed is not None,
        "opening_u_mm": None if sim.law is None else sim.cables.at_edge.opening_u,
    }


def _of_the_tool(sim: Simulation, unfelt: Unfelt) -> dict[str, float]:
    """Return the figures of contact and of cables that meet the tool, none without a tool."""
    s = sim.state
    if sim.contact is None:
        return {}
    figures = {
        "n_cable_jointed": sim.cables.n_joint_made,
        "deepest_penetration_mm": sim.contact.deepest,
        "tool_half_thickness_mm": sim.contact.law.tool_half_thickness,
        "unfelt_penetration_mm": unfelt.quads,
        "unfelt_film_edge_mm": unfelt.film_edges,
        "film_half_thickness_mm": 0.5 * sim.material.thickness,
        "largest_overshoot_mm": s.cable.overshoot[: s.n_cable].max(initial=0.0),
    }
    if sim.law is not None and sim.law.cutting_energy is not None:
        figures |= {
            "edge_radius_mm": sim.contact.tool.edge_radius,
            "severing_energy_N_per_mm": sim.cables.at_edge.fracture_energy,
            "severing_opening_mm": sim.cables.at_edge.opening_u,
            "blunt_radius_mm": sim.law.blunt_radius,
        }
    return figures


def _of_self_contact(sim: Simulation) -> dict[str, float]:
    """Return the figures of the film's contact with itself, none without it."""
    if sim.self_contact is None:
        return {}
    return {
        "self_contact_deepest_mm": sim.self_contact.deepest,
        "n_self_contact_looked": sim.self_contact.n_looked,
    }


def _of_pieces(sim: Simulation) -> dict[str, float]:
    """Return how many pieces of the film are loose; nothing without cracks."""
    if sim.cracks is None:
        return {}
    return {"n_loose": Pieces.of(sim.state).n_loose}
