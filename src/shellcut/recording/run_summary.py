"""The values of ``summary.json``, with the unit in each name; docs/howto/read-results.md."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from math import isfinite
from typing import TYPE_CHECKING, Any

import numpy as np
import scipy

from shellcut.arrays import Floats, Ints, Numbers, norm, off_segments
from shellcut.checks import Sweep
from shellcut.checks.hold import check_hold
from shellcut.checks.model_check import support_of
from shellcut.contact.border_contact import BorderContact
from shellcut.numerics.connected_parts import connected_parts
from shellcut.results.summary_figures import run_figures
from shellcut.state import NOTCH, TEAR, SplitRecord
from shellcut.state.pieces import Pieces

from .resistance import AnyResistance
from .unfelt_penetration import Unfelt

if TYPE_CHECKING:
    from shellcut.simulation.simulation import Simulation

_COMMON = 1e-6  # edge lengths by which ends of cuts that go on from each other may lie apart

_DECIMALS = 9  # of a centre in mm: further ones are round-off

OFF_PATH = 0.2
"""In edge lengths: a row of nodes under the path lies within 0.03, including chord error."""


def run_summary(
    sim: Simulation,
    resistance: AnyResistance,
    history: Mapping[str, Floats],
    end: Mapping[str, float] | None = None,
    *,
    wall: float,
    unfelt: Unfelt,
) -> dict[str, Any]:
    """Return the values by name; counts are integers, reasons are texts.

    Values that are not finite (a film that blew up) are left out: JSON cannot express them.
    ``end`` are the columns of the history at its end, by default its last row: the state of a run
    that broke off within a step means nothing. ``wall`` is the time of the run [s].
    """
    s, r = sim.state, resistance
    figures = {
        "n_quad": sim.mesh.n_quad,
        "n_step": s.step,
        "dt_s": s.time / max(s.step, 1),
        "wall_s": wall,
        "ns_per_quad_step": 1e9 * wall / sim.mesh.n_quad / max(s.step, 1),
        **_of_the_tool(sim, unfelt),
        **sim.terms.summary(),
    }
    if sim.self_contact is not None:
        figures["self_contact_deepest_mm"] = sim.self_contact.deepest
        figures["n_self_contact_looked"] = sim.self_contact.n_looked
    if sim.cracks is not None:
        figures |= _loose_pieces(sim)
    figures |= {
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
    finite |= run_figures(
        history, (r.coordinate_name, r.coordinate_unit), r.columns[0], end, s.splits
    )
    if sim.cracks is not None:
        finite["crack_path"] = sim.fracture.path
    if sim.between_steps:
        finite["digest"] = _run_digest(sim.saved(), history)
    options = {  # on which it depends what may be done about a doubt
        "path": None if sim.cracks is None else sim.fracture.path,
        "only_along_edges": bool(sim.fracture.only_along_edges),
        "check_every": sim.fracture.check_every,
        "film_edges": any(isinstance(term, BorderContact) for term in sim.terms),
        "fixed_step": sim.time_step.stepping.fixed is not None,
        "opening_u_mm": None if sim.law is None else sim.cables.at_edge.opening_u,
        "unheld": bool([*check_hold(sim.mesh, support_of(sim))]),
    }
    return finite | {"resistance": r.meaning, "options": options}


def _loose_pieces(sim: Simulation) -> dict[str, float]:
    """Return their number; of the largest one area and centre in the reference, if there is one."""
    s, pieces = sim.state, Pieces.of(sim.state, sim.terms.fixed_nodes(sim.state))
    parent = s.quad.parent[: s.n_quad]
    area = sim.mesh.quad_areas()[parent] * s.quad.share[: s.n_quad]
    of_piece = np.bincount(pieces.of_row, area, len(pieces.loose))
    found: dict[str, float] = {"n_loose": pieces.n_loose}
    if pieces.n_loose:
        largest = int(np.argmax(np.where(pieces.loose, of_piece, -1.0)))
        mine = pieces.of_row == largest
        centres = sim.mesh.nodes[sim.mesh.quads[parent[mine]]].mean(axis=1)
        centre = np.average(centres, axis=0, weights=area[mine]).round(_DECIMALS) + 0.0
        found["loose_area_mm2"] = float(of_piece[largest])
        found |= {f"loose_{axis}_mm": x for axis, x in zip("xyz", centre.tolist(), strict=True)}
    return found


def _run_digest(saved: Mapping[str, Any], history: Mapping[str, Floats]) -> str:
    """Return 64 hexadecimal digits that stand for every bit of a state and of a history.

    The SHA-256 of all tables in the order of their names; of each its name, shape and numbers, as
    little-endian doubles or 64-bit integers, or its texts. All that is not a number counts as the
    same. The state is that of :meth:`Simulation.saved`.
    """
    digest = hashlib.sha256()
    for name, rows in _tables("", {"history": history, "run": saved}):
        digest.update(f"{name} {rows.shape}\n".encode())
        if rows.dtype.kind == "f":
            rows = rows.astype("<f8")
            rows[np.isnan(rows)] = np.nan  # its sign has no meaning
            digest.update(rows.tobytes())
        elif rows.dtype.kind in "biu":
            digest.update(rows.astype("<i8").tobytes())
        else:
            digest.update("\n".join(map(str, rows.ravel())).encode())
    return digest.hexdigest()


def _tables(name: str, content: Any) -> Iterator[tuple[str, Numbers]]:
    if not isinstance(content, Mapping):
        yield name, np.asarray(content)
        return
    for key in sorted(content):
        yield from _tables(f"{name}/{key}", content[key])


def _of_the_tool(sim: Simulation, unfelt: Unfelt) -> dict[str, float]:
    """Return the values of contact and of cables that meet the tool, none without a tool."""
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


def cut_evidence(sim: Simulation, sweep: Sweep | None) -> dict[str, float]:
    """Return the values that are finite, by name, up to the present step."""
    s = sim.state
    sides = sim.mesh.edge_lengths()
    figures: dict[str, float] = {"edge_length_mm": float(np.median(sides))}
    if sim.law is None:
        return figures
    if sim.cracks is not None and (idle := sim.cracks.idle_edge(s))[0] >= 0:
        figures["idle_edge"], figures["idle_edge_load_rel"] = idle[0] + 1, idle[1]
    splits = [record for record in s.splits if record.kind != TEAR]
    tears = [(record.reference, record.end) for record in s.splits if record.kind == TEAR]
    if sweep is not None and len(sweep.place) and tears:
        figures["n_tear"] = len(tears)
        figures["tear_off_path_mm"] = float(sweep.distance(np.array(tears)[:, 1]).max())
    if sweep is not None and len(sweep.place) and splits:
        places = np.array([record.reference for record in splits])
        size = np.sqrt(sim.mesh.quad_areas())[[_quad_at(sim, record) for record in splits]]
        start, end = np.array(tears).reshape(-1, 2, 3).swapaxes(0, 1)
        from_tears, _ = off_segments(places[:, None], start, end - start)
        off = np.minimum(norm(from_tears).min(axis=1, initial=np.inf), sweep.distance(places))
        on_it = off <= OFF_PATH * size
        figures |= {
            "n_split": len(places),
            "n_split_off_path": int((~on_it).sum()),
            "off_path_mm": float(off.max()),
            "path_edge_mm": float(np.median(sweep.edge_length)),
            "bending_length_mm": np.nan if sim.cracks is None else sim.cracks.bending_length,
            "crack_lead_mm": float(sweep.lead(places[on_it], _cracks(sim)[on_it]).max(initial=0.0)),
        }
    if sim.cables.n_joint_made:
        missed = float(s.cable.overshoot[: s.n_cable].sum()) / sim.cables.n_joint_made
        figures["overshoot_rel"] = missed / (0.5 * sim.cables.at_edge.opening_u)
    return {name: value for name, value in figures.items() if isfinite(value)}


def _cracks(sim: Simulation) -> Ints:
    """Return which crack each split other than tears belongs to: cuts with one end in common."""
    log = sim.state.split_log
    ends = np.array([place for record in log for place in (record.reference, record.end)])
    same = scipy.spatial.cKDTree(ends).query_pairs(
        _COMMON * float(np.median(sim.mesh.edge_lengths()))
    )
    one, two = np.array([*same], np.int64).reshape(-1, 2).T
    cut = connected_parts(one // 2, two // 2, len(log))
    return cut[[k for k, record in enumerate(log) if record.kind not in (TEAR, NOTCH)]]


def _quad_at(sim: Simulation, record: SplitRecord) -> int:
    s = sim.state
    row = max(record.rows) if record.node < 0 else s.node.quads[record.node, 0]
    return int(s.quad.parent[row])
