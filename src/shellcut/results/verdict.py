"""The verdict: what of a run may be trusted, judged by the figures of its summary.

Report, ``run.log``, ``summary.json`` and the end of the terminal's output all carry these lines. A
new figure to judge is a function that yields its line, and a place in ``_JUDGES``.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

LOGGER = logging.getLogger("shellcut.verdict")
"""Takes the lines at the end of a run: doubts as warnings, the others as information."""
LOGGER.setLevel(logging.INFO)

IMBALANCE_LIMIT = 0.01
"""Energy that the ledger may miss, relative to the tool's work."""
KINETIC_LIMIT = 0.05
"""Kinetic energy that slow cutting may have, relative to the tool's work."""
DAMPING_LIMIT = 0.10
"""Share of the tool's work that damping may take."""
CONTACT_LIMIT = 0.05
"""Share of the tool's work that frictionless contact may hold."""
GIVEN_LIMIT = 0.01
"""Energy that contact may give the film, or its absorbed jumps give or take, relative to the tool's
work: as wrong as energy that the ledger misses, so it has the same limit."""
PENETRATION_LIMIT = 0.25
"""Depth of a node in the tool relative to the tool's half thickness. The film is pushed aside by
that much less than the tool is thick; at the whole of it a node is as near to the other flank."""
UNFELT_LIMIT = 0.5
"""Depth of the tool between nodes that may pass unfelt, relative to the quads' edge length."""
OVERSHOOT_LIMIT = 0.02
"""How far the edge may have passed the cables in the mean when it meets them, relative to the way
on which it drags them; that share of their work is missed."""
CABLES_LIMIT = 0.85
"""Share of the work spent that cables should have taken: all but what damping and contact may."""
INERTIA_NOTE = 100.0
"""Scale of the rotary inertia from which on it is mentioned."""


@dataclass(frozen=True)
class Line:
    """One sentence: ``good``, ``doubt`` (outside its band) or ``note``."""

    kind: str
    text: str

    @property
    def word(self) -> str:
        """What is said before the sentence."""
        return {"good": "holds", "doubt": "distrust", "note": "note"}[self.kind]

    def __str__(self) -> str:
        return f"{self.word}: {self.text}"


Figures = Mapping[str, Any]
"""Of ``summary.json``, by their names there."""


def verdict(figures: Figures, doubts: Iterable[str] = ()) -> list[Line]:
    """Return a sentence for every figure that tells how far a run may be trusted, doubts first.

    Parameters
    ----------
    figures : mapping
        Of ``summary.json``; what it lacks is left out.
    doubts : iterable of str
        Those of the model before the run.

    Examples
    --------
    >>> print(verdict({"imbalance_rel": 0.0002})[0])
    holds: The energy ledger closes within 0.02 % of the tool's work (limit 1 %).
    """
    lines = [Line("doubt", f"Before the run: {text}") for text in doubts]
    lines += [line for judge in _JUDGES for line in judge(figures)]
    if lines:
        lines.append(
            Line(
                "note",
                "A closed ledger is no proof of a right crack path: the crack follows the edges of "
                "the mesh (docs/limits.md).",
            )
        )
    order = {"doubt": 0, "good": 1, "note": 2}
    return sorted(lines, key=lambda line: order[line.kind])


def say(lines: Iterable[Line]) -> None:
    """Log the lines of a verdict."""
    for line in lines:
        LOGGER.log(logging.WARNING if line.kind == "doubt" else logging.INFO, "%s", line)


def _judged(within: bool, good: str, bad: str) -> Line:
    return Line("good", good) if within else Line("doubt", bad)


def _percent(share: float) -> str:
    # three digits near the whole: 97.5 %, not 98 %
    return f"{100.0 * share:.{2 if abs(share) < 0.095 else 3}g} %"


def _share_of_work(figures: Figures, name: str) -> float | None:
    work = abs(figures.get("tool_work_Nmm", 0.0))
    return figures[name] / work if work > 0.0 and name in figures else None


def _ledger(figures: Figures) -> Iterator[Line]:
    if "imbalance_rel" not in figures:
        return
    missed = figures["imbalance_rel"]
    share, limit = _percent(missed), _percent(IMBALANCE_LIMIT)
    yield _judged(
        abs(missed) <= IMBALANCE_LIMIT,
        f"The energy ledger closes within {share} of the tool's work (limit {limit}).",
        f"The energy ledger misses up to {share} of the tool's work; it should miss less than "
        f"{limit}. Torque and energies are not to be trusted: take a smaller time step.",
    )


def _not_come_far(figures: Figures) -> bool:
    """Whether a run was stopped before any cable broke: at first touch all is vibration."""
    stopped = figures.get("share_done", 1.0) < 1.0
    return bool(stopped and figures.get("n_cable_broken", 1) == 0)


def _stopped(figures: Figures) -> Iterator[Line]:
    share = figures.get("share_done", 1.0)
    if share >= 1.0:
        return
    at = f"{_percent(share)} of its time"
    if figures.get("broke_off", False):
        yield Line(
            "doubt",
            f"The run broke off within a step, at {at}: what is judged here is what there was "
            "before; the message at its end says why.",
        )
    else:
        yield Line("note", f"The run was stopped at {at}: judged is what there is of it.")
    if _not_come_far(figures):
        yield Line(
            "note", "No cable had broken by then: kinetic energy and damping are not judged yet."
        )


def _inertia(figures: Figures) -> Iterator[Line]:
    if "kinetic_rel" not in figures or _not_come_far(figures):
        return
    kinetic = figures["kinetic_rel"]
    share, limit = _percent(kinetic), _percent(KINETIC_LIMIT)
    yield _judged(
        abs(kinetic) <= KINETIC_LIMIT,
        f"Kinetic energy stays below {share} of the tool's work (limit {limit}): inertia does "
        "not carry the load.",
        f"Kinetic energy reaches {share} of the tool's work; slow cutting has less than "
        f"{limit}. Inertia carries part of the load: take a slower motion.",
    )


def _damping(figures: Figures) -> Iterator[Line]:
    damping = _share_of_work(figures, "damping_Nmm")
    if damping is None or _not_come_far(figures):
        return
    share, limit = _percent(damping), _percent(DAMPING_LIMIT)
    yield _judged(
        abs(damping) <= DAMPING_LIMIT,
        f"Damping takes {share} of the tool's work (limit {limit}).",
        f"Damping takes {share} of the tool's work, more than {limit}: the torque is that much "
        "too high. Film that springs open feeds it: take edges shorter than half of opening_u, a "
        "slower motion, or less damping.",
    )


def _contact(figures: Figures) -> Iterator[Line]:
    contact = _share_of_work(figures, "contact_Nmm")
    if contact is None:
        return
    share, limit = _percent(contact), _percent(CONTACT_LIMIT)
    if contact < -GIVEN_LIMIT:
        yield Line(
            "doubt",
            f"Contact gave the film {_percent(-contact)} of the tool's work, more than "
            f"{_percent(GIVEN_LIMIT)}, and it has none to give: jumps were absorbed, or nodes hit "
            "the tool so fast that a step is too long for it (Stepping.safety).",
        )
        return
    yield _judged(
        contact <= CONTACT_LIMIT,
        f"Contact holds {share} of the tool's work (limit {limit}); without friction it should "
        "hold next to none.",
        f"Contact holds {share} of the tool's work, more than {limit}, though it has no friction: "
        "penetrations are large or their changes between steps are.",
    )


def _absorbed(figures: Figures) -> Iterator[Line]:
    absorbed = _share_of_work(figures, "contact_absorbed_Nmm")
    if absorbed is None:
        return
    if absorbed == 0.0:
        yield Line("good", "No node was set to the other flank of the blade: no jump was absorbed.")
        return
    did = "took" if absorbed > 0.0 else "gave the film"
    share, limit = _percent(abs(absorbed)), _percent(GIVEN_LIMIT)
    yield _judged(
        abs(absorbed) <= GIVEN_LIMIT,
        f"Absorbed jumps of nodes in the tool {did} {share} of the tool's work (limit {limit}).",
        f"Absorbed jumps of nodes in the tool {did} {share} of the tool's work, more than {limit}: "
        "nodes are set to the other flank of the blade. Put the blade's path into the mesh "
        "(imprint), or take a finer film near the tool.",
    )


def _penetration(figures: Figures) -> Iterator[Line]:
    depth = figures.get("deepest_penetration_mm")
    half = figures.get("tool_half_thickness_mm")
    if depth is None or half is None:
        return
    limit = PENETRATION_LIMIT * half
    yield _judged(
        depth <= limit,
        f"Nodes go at most {depth:.3g} mm deep into the tool (limit {limit:.3g} mm, a quarter of "
        "its half thickness).",
        f"Nodes go {depth:.3g} mm deep into the tool, more than a quarter of its half thickness "
        f"({limit:.3g} mm): the film is not pushed aside as far as the tool is thick. Put the "
        "blade's path into the mesh (imprint), take a finer film near the tool, or a larger "
        "Contact.penalty.",
    )


def _unfelt(figures: Figures) -> Iterator[Line]:
    if "unfelt_penetration_mm" not in figures or "edge_length_mm" not in figures:
        return
    depth = figures["unfelt_penetration_mm"]
    limit = UNFELT_LIMIT * figures["edge_length_mm"]
    yield _judged(
        abs(depth) <= limit,
        f"The tool goes at most {depth:.3g} mm deep between nodes unfelt (limit {limit:.3g} mm, "
        "half a quad's edge).",
        f"The tool goes {depth:.3g} mm deep between nodes without being felt, more than half a "
        f"quad's edge ({limit:.3g} mm): take a finer film near the tool.",
    )


def _nothing_cut(figures: Figures) -> Iterator[Line]:
    if figures.get("n_cable_created") == 0:
        yield Line(
            "doubt",
            "Nothing was cut: no cable was created. Put a row of edges under the path of the "
            "cutting edges (imprint); shellcut preview draws where they go.",
        )


def _off_path(figures: Figures) -> Iterator[Line]:
    n, off = figures.get("n_split", 0), figures.get("n_split_off_path", 0)
    if not n:
        return
    far = figures.get("off_path_mm", float("nan"))
    yield _judged(
        off == 0,
        f"All {n:,} splits lie on the path of the cutting edges, at most {far:.2g} mm beside it "
        "(limit a fifth of an edge of the film).",
        f"{off:,} of {n:,} splits lie more than a fifth of an edge of the film beside the path of "
        f"the cutting edges, up to {far:.3g} mm: cracks left it. Put it into the mesh (imprint); "
        "the crack map shows where.",
    )


def _overshoot(figures: Figures) -> Iterator[Line]:
    if "overshoot_rel" not in figures:
        return
    missed = figures["overshoot_rel"]
    share, limit = _percent(missed), _percent(OVERSHOOT_LIMIT)
    yield _judged(
        missed <= OVERSHOOT_LIMIT,
        f"Cables are met in time: the edge misses {share} of the way on which it drags them "
        f"(limit {limit}).",
        f"Cables are met late: the edge misses {share} of the way on which it drags them, more "
        f"than {limit}, and that share of their work. Either it does not move to where it points "
        "(reverse the motion), or too fast (look more often, fracture.check_every).",
    )


def _cables(figures: Figures) -> Iterator[Line]:
    if "cables_rel" not in figures:
        return
    taken = figures["cables_rel"]
    share, limit = _percent(taken), _percent(CABLES_LIMIT)
    yield _judged(
        taken >= CABLES_LIMIT,
        f"Cables took {share} of the work that was spent (at least {limit}).",
        f"Cables took {share} of the work that was spent, less than {limit}: the tool presses on "
        "film that does not part. Put a row of edges under its path (imprint), keep held nodes "
        "out of its way, and take edges shorter than half of opening_u.",
    )


def _rotary_inertia(figures: Figures) -> Iterator[Line]:
    factor = figures.get("added_inertia_factor", 0.0)
    if factor > INERTIA_NOTE:
        yield Line(
            "note",
            f"Rotary inertia is scaled by {factor:.3g}: bending waves shorter than a few quads are "
            "too slow.",
        )


def _borrowed_stress(figures: Figures) -> Iterator[Line]:
    n = figures.get("n_recovery_borrowed", 0)
    if n > 0:
        yield Line(
            "note",
            f"The stress at a node was taken from a neighbour's patch {n} times, where its own was "
            "too small.",
        )


_JUDGES: tuple[Callable[[Figures], Iterator[Line]], ...] = (
    _stopped,
    _ledger,
    _inertia,
    _damping,
    _contact,
    _absorbed,
    _penetration,
    _unfelt,
    _nothing_cut,
    _off_path,
    _overshoot,
    _cables,
    _rotary_inertia,
    _borrowed_stress,
)
