"""The verdict: how far the results of a run can be trusted, from the figures of its summary.

Report, ``run.log``, ``summary.json`` and the end of the terminal's output all contain these lines.
To judge a new figure, write a function that yields its line and add it to ``_JUDGES``.
"""

from __future__ import annotations

import logging
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from .energy_account import account, dissipated, driver
from .remedies import SLOWER, SMALLER_STEP, remedies

LOGGER = logging.getLogger("shellcut.verdict")
"""Logs the lines at the end of a run: doubts as warnings, the others as information."""
LOGGER.setLevel(logging.INFO)

IMBALANCE_LIMIT = 0.01
"""Largest imbalance of the ledger, relative to the tool's work."""
KINETIC_LIMIT = 0.05
"""Largest kinetic energy in slow cutting, relative to the tool's work."""
QUASI_STATIC_LIMIT = 0.01
"""Largest kinetic energy of a quasi-static run, likewise."""
DAMPING_LIMIT = 0.10
"""Largest share of the tool's work dissipated by damping."""
CONTACT_LIMIT = 0.05
"""Largest share of the tool's work that contact takes, friction not counted."""
GIVEN_LIMIT = 0.01
"""Largest energy that contact gives to the film, or that its absorbed jumps give or take, relative
to the tool's work: as wrong as an imbalance of the ledger, so it has the same limit."""
PENETRATION_LIMIT = 0.25
"""Largest depth of a node in the tool relative to the tool's half thickness. The film is pushed
aside by that much less than the tool is thick; at 1 a node is as near to the other flank."""
UNFELT_LIMIT = 0.5
"""Largest penetration between nodes, which nodal contact misses, relative to the edge length."""
OVERSHOOT_LIMIT = 0.02
"""Largest mean overshoot of the edge past the cables it meets, relative to the distance over which
it drags them; that share of their work is missed."""
ASKED_LIMIT = 0.85
"""Smallest share of the dissipated work that goes where the laws of the run let it go: cables, film
and friction. The rest is for damping and contact."""
STORED_LIMIT = 0.10
"""Largest share of the tool's work that the film stores in steady cutting. Sound runs store up to
3 %; a flat film that does not buckle, pressed in its plane by the blade's thickness, half of it."""
INERTIA_NOTE = 100.0
"""Scale of the rotary inertia above which it is mentioned."""


@dataclass(frozen=True)
class Line:
    """One sentence: ``good``, ``doubt`` (outside its band) or ``note``."""

    kind: str
    text: str

    @property
    def word(self) -> str:
        """The word before the sentence."""
        return {"good": "holds", "doubt": "distrust", "note": "note"}[self.kind]

    def __str__(self) -> str:
        return f"{self.word}: {self.text}"


Figures = Mapping[str, Any]
"""Figures of ``summary.json``, by their names there."""


def verdict(figures: Figures, doubts: Iterable[str] = ()) -> list[Line]:
    """Return a sentence for every figure that bears on trust in the results, doubts first.

    Parameters
    ----------
    figures : mapping
        Figures of ``summary.json``; missing ones are skipped.
    doubts : iterable of str
        Doubts about the model before the run.

    Examples
    --------
    >>> print(verdict({"imbalance_rel": 0.0002})[0])
    holds: The energy ledger closes within 0.02 % of the tool's work (limit 1 %).
    """
    lines = [Line("doubt", f"Before the run: {text}") for text in doubts]
    lines += [_of_its_driver(figures, line) for judge in _JUDGES for line in judge(figures)]
    if lines:
        lines.append(
            Line(
                "note",
                "A closed ledger does not prove that the crack path is right"
                + ": the crack follows the edges of the mesh" * ("n_copy" not in figures)
                + " (docs/limits.md).",
            )
        )
    order = {"doubt": 0, "good": 1, "note": 2}
    return sorted(lines, key=lambda line: order[line.kind])


def say(lines: Iterable[Line]) -> None:
    """Log the lines of a verdict."""
    for line in lines:
        LOGGER.log(logging.WARNING if line.kind == "doubt" else logging.INFO, "%s", line)


def _of_its_driver(figures: Figures, line: Line) -> Line:
    """Return a line that compares with the tool's work in words that fit what does the work."""
    if driver(figures, "_Nmm") == "tool_work":
        return line
    return Line(line.kind, line.text.replace("the tool's work", "the supports' work"))


def _judged(within: bool, good: str, bad: str) -> Line:
    return Line("good", good) if within else Line("doubt", bad)


def _limited(said: str, share: float, limit: float, why: str) -> Line:
    """Return a line on a share that should keep to a limit; ``why`` tells what it means else."""
    most = _percent(limit)
    return _judged(
        abs(share) <= limit, f"{said} (limit {most}).", f"{said}, more than {most}: {why}"
    )


def _percent(share: float) -> str:
    # three digits near 100 %: 97.5 %, not 98 %
    return f"{100.0 * share:.{2 if abs(share) < 0.095 else 3}g} %"


def _share_of_work(figures: Figures, name: str) -> float | None:
    """Return an energy over the driving work, None without; an energy that is not there is zero."""
    work = abs(figures.get(f"{driver(figures, '_Nmm')}_Nmm", 0.0))
    return figures.get(name, 0.0) / work if work > 0.0 else None


def _is_of_a_tool(figures: Figures) -> bool:
    # a tool at rest, against which supports move the film, does no work
    return "tool_work_Nmm" in figures or "deepest_penetration_mm" in figures


def _ledger(figures: Figures) -> Iterator[Line]:
    if "imbalance_rel" not in figures:
        return
    missed = figures["imbalance_rel"]
    share, limit = _percent(missed), _percent(IMBALANCE_LIMIT)
    yield _judged(
        abs(missed) <= IMBALANCE_LIMIT,
        f"The energy ledger closes within {share} of the tool's work (limit {limit}).",
        f"The imbalance of the energy ledger reaches {share} of the tool's work; it should stay "
        f"below {limit}. Do not trust forces and energies." + remedies(figures, *SMALLER_STEP),
    )


def _not_come_far(figures: Figures) -> bool:
    """Whether a run was stopped before any cable broke: the first touch is all vibration."""
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
            f"The run broke off within a step, at {at}: the verdict is on the results before that; "
            "the message at its end gives the reason.",
        )
    else:
        yield Line("note", f"The run was stopped at {at}: the verdict is on its results so far.")
    if _not_come_far(figures):
        yield Line(
            "note", "No cable had broken by then: kinetic energy and damping are not judged yet."
        )


def _inertia(figures: Figures) -> Iterator[Line]:
    if "kinetic_rel" not in figures or _not_come_far(figures):
        return
    kinetic = figures["kinetic_rel"]
    most = QUASI_STATIC_LIMIT if "quasi_static" in figures else KINETIC_LIMIT
    share, limit = _percent(kinetic), _percent(most)
    yield _judged(
        abs(kinetic) <= most,
        f"Kinetic energy stays below {share} of the tool's work (limit {limit}): inertia does "
        "not carry the load.",
        f"Kinetic energy reaches {share} of the tool's work; slow cutting has less than "
        f"{limit}. Inertia carries part of the load." + remedies(figures, *SLOWER),
    )


def _damping(figures: Figures) -> Iterator[Line]:
    damping = _share_of_work(figures, "damping_Nmm")
    if damping is None or _not_come_far(figures):
        return
    yield _limited(
        f"Damping dissipates {_percent(damping)} of the tool's work",
        damping,
        DAMPING_LIMIT,
        "the resistance is that much too high. Film that springs open causes it."
        + remedies(figures, "shorter edges", *SLOWER, "damping"),
    )


def _contact(figures: Figures) -> Iterator[Line]:
    contact = _share_of_work(figures, "contact_Nmm")
    if contact is None or not _is_of_a_tool(figures):
        return
    did, limit, why = (
        "took",
        CONTACT_LIMIT,
        "penetrations or their changes between steps are large.",
    )
    if contact < 0.0:
        did, limit = "gave the film", GIVEN_LIMIT
        why = (
            "it is no source of energy: jumps were absorbed, or nodes hit the tool so fast that a "
            "step is too long for it."
        )
    yield _limited(
        f"Contact {did} {_percent(abs(contact))} of the tool's work, friction not counted",
        contact,
        limit,
        why + remedies(figures, "finer", *SMALLER_STEP),
    )


def _absorbed(figures: Figures) -> Iterator[Line]:
    absorbed = _share_of_work(figures, "contact_absorbed_Nmm")
    if absorbed is None or not _is_of_a_tool(figures):
        return
    if absorbed == 0.0:
        yield Line("good", "No node was set to the other flank of the blade: no jump was absorbed.")
        return
    did = "took" if absorbed > 0.0 else "gave the film"
    yield _limited(
        f"Absorbed jumps of nodes in the tool {did} {_percent(abs(absorbed))} of the tool's work",
        absorbed,
        GIVEN_LIMIT,
        "nodes are set to the other flank of the blade." + remedies(figures, "finer"),
    )


def _self_contact(figures: Figures) -> Iterator[Line]:
    lost = _share_of_work(figures, "self_contact_lost_Nmm")
    if lost is None or "self_contact_Nmm" not in figures:
        return
    did = "lost" if lost >= 0.0 else "gave the film"
    yield _limited(
        f"Contact of the film with itself {did} {_percent(abs(lost))} of the tool's work",
        lost,
        GIVEN_LIMIT,
        "its parts hit each other so fast that a step is too long for it."
        + remedies(figures, *SMALLER_STEP),
    )


def _penetration(figures: Figures) -> Iterator[Line]:
    depth = figures.get("deepest_penetration_mm")
    half = figures.get("tool_half_thickness_mm")
    if depth is None or half is None:
        return
    limit = PENETRATION_LIMIT * half
    yield _judged(
        depth <= limit,
        f"Nodes penetrate the tool by at most {depth:.3g} mm (limit {limit:.3g} mm, a quarter of "
        "its half thickness).",
        f"Nodes penetrate the tool by {depth:.3g} mm, more than a quarter of its half thickness "
        f"({limit:.3g} mm): the film is not pushed aside as far as the tool is thick."
        + remedies(figures, "finer", "penalty"),
    )


def _unfelt(figures: Figures) -> Iterator[Line]:
    if "unfelt_penetration_mm" not in figures or "edge_length_mm" not in figures:
        return
    depth = figures["unfelt_penetration_mm"]
    limit = UNFELT_LIMIT * figures["edge_length_mm"]
    yield _judged(
        abs(depth) <= limit,
        f"The tool penetrates the film between nodes, without contact, by at most {depth:.3g} mm "
        f"(limit {limit:.3g} mm, half a quad's edge).",
        f"The tool penetrates the film between nodes, without contact, by {depth:.3g} mm, more "
        f"than half a quad's edge ({limit:.3g} mm)." + remedies(figures, "finer"),
    )


def _unfelt_edges(figures: Figures) -> Iterator[Line]:
    depth = figures.get("unfelt_film_edge_mm", 0.0)
    limit = figures.get("film_half_thickness_mm", float("nan"))
    if depth > limit:
        yield Line(
            "note",
            f"Rims or flanks of the film go {depth:.3g} mm into the tool between their nodes, "
            f"unfelt, more than half of its thickness ({limit:.3g} mm), and are not pushed aside."
            + remedies(figures, "film edges", "finer"),
        )


def _nothing_cut(figures: Figures) -> Iterator[Line]:
    if figures.get("n_cable_created") == 0:
        yield Line(
            "doubt",
            "Nothing was cut: no cable was created."
            + " shellcut preview draws the path of the cutting edges." * _is_of_a_tool(figures),
        )


def _off_path(figures: Figures) -> Iterator[Line]:
    n, off = figures.get("n_split", 0), figures.get("n_split_off_path", 0)
    if not n:
        return
    far, lead = figures.get("off_path_mm", float("nan")), figures.get("crack_lead_mm", 0.0)
    ahead = f", or straight ahead of it by up to {lead:.3g} mm" if lead else ""
    yield _judged(
        off == 0,
        f"All {n:,} splits lie on the path of the cutting edges{ahead}, at most {far:.2g} mm off "
        "it (limit a fifth of an edge of the film).",
        f"{off:,} of {n:,} splits lie more than a fifth of an edge of the film off the path of "
        f"the cutting edges, up to {far:.3g} mm: cracks left it; the crack map shows where."
        + remedies(figures, "through quads"),
    )


def _overshoot(figures: Figures) -> Iterator[Line]:
    if "overshoot_rel" not in figures:
        return
    missed = figures["overshoot_rel"]
    share, limit = _percent(missed), _percent(OVERSHOOT_LIMIT)
    yield _judged(
        missed <= OVERSHOOT_LIMIT,
        f"The edge meets cables in time: it misses {share} of the distance over which it drags "
        f"them (limit {limit}).",
        f"The edge meets cables late: it misses {share} of the distance over which it drags them, "
        f"more than {limit}, and that share of their work. Its motion does not go where it points, "
        "or is too fast." + remedies(figures, "more checks", *SLOWER),
    )


def _account(figures: Figures) -> Iterator[Line]:
    """Yield where all that was put in went, and how much of what was dissipated was asked for."""
    put_in, became = account(figures)
    if not became:
        return
    whole = sum(line.energy for line in put_in)
    sources = ", ".join(f"{line.words} {line.energy:.4g}" for line in put_in)
    parts = ", ".join(f"{line.words} {100.0 * line.share:.1f} %" for line in became)
    yield Line("note", f"Where {whole:.4g} N·mm went ({sources}): {parts}.")
    if not figures.get("n_cable_broken", 0):
        return
    asked, together = dissipated(figures)
    if not asked:
        return
    first, *others = asked
    said = f"{first.words.capitalize()} took {_percent(first.share)} of the dissipated work"
    said += "".join(f", {line.words} {_percent(line.share)}" for line in others)
    said += f", together {_percent(together)}" * bool(others)
    limit = _percent(ASKED_LIMIT)
    yield _judged(
        together >= ASKED_LIMIT,
        f"{said} (at least {limit}).",
        f"{said}, less than {limit}: damping and contact took the rest, as where "
        + ("a tool presses on film that does not part or " * _is_of_a_tool(figures))
        + "film springs open."
        + remedies(figures, "shorter edges", *SLOWER),
    )


def _stored(figures: Figures) -> Iterator[Line]:
    if "stored_growth_rel" not in figures or not _is_of_a_tool(figures):
        return
    stored = figures["stored_growth_rel"]
    yield _limited(
        f"In the steady window the film stored {_percent(stored)} of the tool's work",
        max(stored, 0.0),
        STORED_LIMIT,
        "it does not give way beside the tool, as a flat film that is pressed in its plane and "
        "does not buckle, and the resistance is higher by that much.",
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
    _self_contact,
    _penetration,
    _unfelt,
    _unfelt_edges,
    _nothing_cut,
    _off_path,
    _overshoot,
    _account,
    _stored,
    _rotary_inertia,
    _borrowed_stress,
)
