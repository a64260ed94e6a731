"""What may be trusted: figures of a run against the bands they should lie in."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

IMBALANCE_LIMIT = 0.01
"""Energy that the ledger may miss, relative to the tool's work."""
KINETIC_LIMIT = 0.05
"""Kinetic energy that slow cutting may have, relative to the tool's work."""
DAMPING_LIMIT = 0.10
"""Share of the tool's work that damping may take."""
CONTACT_LIMIT = 0.05
"""Share of the tool's work that frictionless contact may keep or lose."""
UNFELT_LIMIT = 0.5
"""Depth of the tool between nodes that may pass unfelt, relative to the quads' edge length."""
INERTIA_NOTE = 100.0
"""Scale of the rotary inertia from which on it is mentioned."""


@dataclass(frozen=True)
class Line:
    """One sentence: ``good``, ``doubt`` (outside its band) or ``note``."""

    kind: str
    text: str


def verdict(summary: Mapping[str, Any], edge_length: float | None) -> list[Line]:
    """Return a sentence for every figure that tells how far a run may be trusted.

    Parameters
    ----------
    summary : mapping
        Of ``summary.json``; what it lacks is left out.
    edge_length : float or None
        Of the quads [mm].

    Examples
    --------
    >>> line = verdict({"imbalance_rel": 0.0002}, None)[0]
    >>> print(line.kind, line.text, sep=": ")
    good: The energy ledger closes within 0.02 % of the tool's work (limit 1 %).
    """
    lines = []
    work = abs(summary.get("tool_work_Nmm", 0.0))

    def judge(value: float, limit: float, good: str, bad: str) -> None:
        lines.append(Line("good", good) if abs(value) <= limit else Line("doubt", bad))

    if "imbalance_rel" in summary:
        share, limit = _percent(summary["imbalance_rel"]), _percent(IMBALANCE_LIMIT)
        judge(
            summary["imbalance_rel"],
            IMBALANCE_LIMIT,
            f"The energy ledger closes within {share} of the tool's work (limit {limit}).",
            f"The energy ledger misses up to {share} of the tool's work; it should miss less than "
            f"{limit}. Torque and energies are not to be trusted: take a smaller time step.",
        )
    if "kinetic_rel" in summary:
        share, limit = _percent(summary["kinetic_rel"]), _percent(KINETIC_LIMIT)
        judge(
            summary["kinetic_rel"],
            KINETIC_LIMIT,
            f"Kinetic energy stays below {share} of the tool's work (limit {limit}): inertia does "
            "not carry the load.",
            f"Kinetic energy reaches {share} of the tool's work; slow cutting has less than "
            f"{limit}. Inertia carries part of the load: take a slower motion.",
        )
    if work > 0.0 and "damping_Nmm" in summary:
        share = summary["damping_Nmm"] / work
        judge(
            share,
            DAMPING_LIMIT,
            f"Damping takes {_percent(share)} of the tool's work (limit "
            f"{_percent(DAMPING_LIMIT)}).",
            f"Damping takes {_percent(share)} of the tool's work, more than "
            f"{_percent(DAMPING_LIMIT)}: the torque is that much too high.",
        )
    if work > 0.0 and "contact_Nmm" in summary:
        share = summary["contact_Nmm"] / work
        judge(
            share,
            CONTACT_LIMIT,
            f"Contact holds {_percent(share)} of the tool's work (limit "
            f"{_percent(CONTACT_LIMIT)}); without friction it should hold next to none.",
            f"Contact holds {_percent(share)} of the tool's work, more than "
            f"{_percent(CONTACT_LIMIT)}, though it has no friction: penetrations are large or "
            "their changes between steps are.",
        )
    if "unfelt_penetration_mm" in summary and edge_length:
        depth = summary["unfelt_penetration_mm"]
        limit_mm = UNFELT_LIMIT * edge_length
        judge(
            depth,
            limit_mm,
            f"The tool goes at most {depth:.3g} mm deep between nodes unfelt (limit "
            f"{limit_mm:.3g} mm, half a quad's edge).",
            f"The tool goes {depth:.3g} mm deep between nodes without being felt, more than half a "
            f"quad's edge ({limit_mm:.3g} mm): take a finer film near the tool.",
        )
    if summary.get("n_cable_created") == 0:
        lines.append(Line("doubt", "Nothing was cut: no cable was created."))
    if summary.get("added_inertia_factor", 0.0) > INERTIA_NOTE:
        lines.append(
            Line(
                "note",
                f"Rotary inertia is scaled by {summary['added_inertia_factor']:.3g}: bending waves "
                "shorter than a few quads are too slow.",
            )
        )
    if summary.get("n_recovery_borrowed", 0) > 0:
        lines.append(
            Line(
                "note",
                f"The stress at a node was taken from a neighbour's patch "
                f"{summary['n_recovery_borrowed']} times, where its own was too small.",
            )
        )
    if lines:
        lines.append(
            Line(
                "note",
                "A closed ledger is no proof of a right crack path: the crack follows the edges of "
                "the mesh (docs/limits.md).",
            )
        )
    return lines


def _percent(share: float) -> str:
    return f"{100.0 * share:.2g} %"
