"""The verdict: how far the results of a run can be trusted, from the values of its summary.

Report, ``run.log``, ``summary.json`` and the end of the terminal's output all contain these lines.
To judge a new value, write a function that yields its line and add it to ``_JUDGES``.
"""

from __future__ import annotations

import logging
import math
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from typing import Any

from shellcut.loads.adhesion import ZONE_SIDES

from .energy_account import (
    ASKED_FOR,
    PUT_IN,
    STORED,
    account,
    damping_of_cut,
    dissipated,
    growth_figure,
    never_touched,
    window_account,
)

LOGGER = logging.getLogger("shellcut.verdict")
"""Logs the lines at the end of a run: doubts as warnings, the others as information."""
LOGGER.setLevel(logging.INFO)

# Limits, with their reasons in docs/howto/trust.md. Energies are relative to the work of the cut.
IMBALANCE_LIMIT = 0.01  # of the energy put in
KINETIC_LIMIT, QUASI_STATIC_LIMIT = 0.05, 0.01
DAMPING_LIMIT = 0.10
CONTACT_LIMIT = 0.05  # friction not counted
GIVEN_LIMIT = 0.01  # that contact gives to the film: as wrong as an imbalance
PENETRATION_LIMIT = 0.25  # of the tool's half thickness; at 1 a node is as near to the other flank
UNFELT_LIMIT = 0.5  # of the side of a quad
OVERSHOOT_LIMIT = 0.02  # of the distance over which the edge drags its cables
ASKED_LIMIT = 0.85  # of the dissipated work, to cables, film and friction
STORED_LIMIT, STORED_NOTE = 0.10, 0.03
OTHER_LIMIT = 0.10  # of the steady window's work, to neither cables, film nor friction
STRESS_LIMIT = 1.2  # of the strength, in film where no crack can begin
IDLE_LIMIT = 1.2  # of F_p, with which an edge may press that has cut nothing
DELAY_LIMIT = 0.05  # of the time for which a tip presses before it pierces
INERTIA_NOTE = 100.0  # scale of the rotary inertia


@dataclass(frozen=True)
class Line:
    """One sentence: ``good``, ``doubt`` (outside its band) or ``note``."""

    kind: str
    text: str

    @property
    def word(self) -> str:
        """The word before the sentence."""
        return {"good": "ok", "doubt": "distrust", "note": "note"}[self.kind]

    def __str__(self) -> str:
        return f"{self.word}: {self.text}"


Figures = Mapping[str, Any]
"""Values of ``summary.json``, by their names there."""


def verdict(figures: Figures, doubts: Iterable[str] = ()) -> list[Line]:
    """Return a sentence for every value that bears on trust in the results, doubts first.

    The values are those of ``summary.json``; missing ones are skipped. The doubts are about the
    model before the run.

    Examples
    --------
    >>> print(verdict({"imbalance_rel": 0.0002})[0])
    ok: The energies balance: the error is at most 0.02 % of the energy put in (limit 1 %).
    """
    lines = [Line("doubt", f"Before the run: {text}") for text in doubts]
    lines += [line for judge in _JUDGES for line in judge(figures)]
    if lines and may_crack(figures):
        lines.append(
            Line(
                "note",
                "No value shows whether the crack took the right path"
                + (", which follows the sides of the quads" if "n_copy" not in figures else "")
                + ": look at the pictures (docs/limits.md).",
            )
        )
    return [line for kind in ("doubt", "good", "note") for line in lines if line.kind == kind]


def doubts_in(summary: Figures) -> tuple[str, ...]:
    """Return what the verdict in a ``summary.json`` distrusts, without the remedies."""
    lines = (line for line in summary.get("verdict", ()) if line["kind"] == "doubt")
    return tuple(line["text"].partition(". ")[0].removesuffix(".") for line in lines)


def say(lines: Iterable[Line]) -> None:
    """Log the lines of a verdict."""
    for line in lines:
        LOGGER.log(logging.WARNING if line.kind == "doubt" else logging.INFO, "%s", line)


_REMEDIES: dict[str, tuple[str, Callable[[Figures], bool]]] = {
    "slower": ("a slower motion", lambda o: "quasi_static" not in o),
    "smaller share": ("a smaller quasi_static", lambda o: o["quasi_static"] > 0.0),
    "finer": ("a finer film near the tool", lambda _: True),
    "damping": ("less damping", lambda _: True),
    "penalty": ("a larger contact.penalty", lambda _: True),
    "imperfection": ("imperfection = 1", lambda o: not o["n_imperfection"]),
    "film edges": ("contact.film_edges = true", lambda o: not o["film_edges"]),
    "shorter sides": (
        "quads with sides shorter than half of opening_u",
        lambda o: o["edge_length_mm"] > 0.5 * o["opening_u_mm"],
    ),
    "through quads": (
        'cracks through the quads (fracture.path = "free")',
        lambda o: o["path"] == "edges" and not o["only_along_edges"],
    ),
    "more checks": (
        "more checks (a smaller fracture.check_every)",
        lambda o: o["check_every"] > 1,
    ),
    "smaller step": ("a smaller time.safety", lambda o: not o["fixed_step"]),
    "smaller fixed step": ("a smaller time.fixed", lambda o: o["fixed_step"]),
}
"""Words of each remedy, and whether a run with these values and options could still take it."""
_SLOWER, _SMALLER_STEP = ("slower", "smaller share"), ("smaller step", "smaller fixed step")
"""Of each pair one is left."""


def _remedies(figures: Figures, *names: str) -> str:
    """Return a sentence with those of some remedies that are left, after a space; "" for none.

    A remedy is named only if the run does not use it yet. The checks before a run name the remedies
    of what they find.
    """
    options = {**figures, **figures.get("options", {})}
    texts = []
    for text, is_left in (_REMEDIES[name] for name in names):
        with suppress(KeyError, TypeError):  # an option that is not there, or None
            if is_left(options):
                texts.append(text)
    if not texts:
        return ""
    *others, last = texts
    return f" Use {', '.join(others)}{' or ' if others else ''}{last}."


def _judged(within: bool, good: str, bad: str, figure: str, limit: str, remedy: str = "") -> Line:
    """Return conclusion, value and limit; if the value is not within it, what to do."""
    if within:
        return Line("good", f"{good}: {figure} (limit {limit}).")
    return Line("doubt", f"{bad}: {figure} (limit {limit}).{remedy}")


def _beside(value: float, limit: float, digits: int = 3) -> str:
    """Return a number with digits enough to tell it from its limit."""
    texts = (f"{value:.{n}g}" for n in range(digits, 17) if f"{value:.{n}g}" != f"{limit:.{n}g}")
    return next(texts, f"{value:.{digits}g}")


def _percent(share: float, limit: float = float("nan")) -> str:
    # three digits near 100 %: 97.5 %, not 98 %
    return f"{_beside(100.0 * share, 100.0 * limit, 2 if abs(share) < 0.095 else 3)} %"


def _of_cut(share: float, limit: float) -> str:
    return f"{_percent(share, limit)} of the work of the cut"


def _share_of_cut(figures: Figures, energy: float) -> float | None:
    """Return an energy over the work of the cut, None without."""
    work = figures.get("cut_work_Nmm", 0.0)
    return energy / work if work > 0.0 else None


def is_of_a_tool(figures: Figures) -> bool:
    """Whether a run has a tool."""
    # a tool at rest, against which supports move the film, does no work
    return "tool_work_Nmm" in figures or "deepest_penetration_mm" in figures


def _not_come_far(figures: Figures) -> bool:
    """Whether a run was stopped before any cable broke: the first touch is all vibration."""
    stopped = figures.get("share_done", 1.0) < 1.0
    return bool(stopped and may_crack(figures) and figures.get("n_cable_broken", 1) == 0)


def may_crack(figures: Figures) -> bool:
    """Whether the film of a run may crack: one without a cohesive law has no path of cracks."""
    return bool(figures.get("options", {"path": ""}).get("path") is not None)


def _energies(figures: Figures) -> Iterator[Line]:
    """Yield whether the run came to its end, and whether its energies balance."""
    if (share := figures.get("share_done", 1.0)) < 1.0:
        at = f"{_percent(share)} of its time"
        if figures.get("broke_off", False):
            yield Line(
                "doubt",
                f"The run failed within a step, at {at}: these lines are about the results before; "
                "the message at its end gives the reason.",
            )
        else:
            yield Line(
                "note", f"The run was stopped at {at}: these lines are about its results so far."
            )
        if _not_come_far(figures):
            yield Line(
                "note",
                "No cable had broken by then, so kinetic energy and damping are not judged.",
            )
    if "imbalance_rel" in figures:
        missed = figures["imbalance_rel"]
        yield _judged(
            abs(missed) <= IMBALANCE_LIMIT,
            "The energies balance",
            "No force or energy of this run can be trusted, because the energies do not balance",
            f"the error is at most {_percent(missed, IMBALANCE_LIMIT)} of the energy put in",
            _percent(IMBALANCE_LIMIT),
            _remedies(figures, *_SMALLER_STEP),
        )


def _speed(figures: Figures) -> Iterator[Line]:
    """Yield whether inertia and damping change the results."""
    judged = not _not_come_far(figures)
    if "kinetic_rel" in figures and judged:
        kinetic = figures["kinetic_rel"]
        most = QUASI_STATIC_LIMIT if "quasi_static" in figures else KINETIC_LIMIT
        bad, remedy = "The motion is too fast, so that inertia", _remedies(figures, *_SLOWER)
        tool, supports, loads = (figures.get(f"{part.name}_Nmm", 0.0) for part in PUT_IN[:3])
        if abs(loads) > abs(tool + supports):
            bad = "The motion or the loads change too fast, so that inertia"
            remedy += (
                " Let the loads grow more slowly; if they tear the film by themselves, it moves "
                "fast whatever you do."
            )
        if figures.get("options", {}).get("unheld"):
            bad, remedy = "The film, or a piece of it, is not supported, so that its inertia", ""
        yield _judged(
            abs(kinetic) <= most,
            "The motion is slow enough",
            f"{bad} carries part of the load",
            f"kinetic energy reaches {_of_cut(kinetic, most)}",
            _percent(most),
            remedy,
        )
    if "piercing_delay_rel" in figures:
        delay = figures["piercing_delay_rel"]
        # It had pressed for t + T, of which T is the delay: T / t goes with the square of the
        # speed. A tenth more, because the depth at which the film carries F_p changes with the
        # speed, too.
        share, limit = (one / (1.0 - one) for one in (min(delay, 0.99), DELAY_LIMIT))
        slower = math.ceil(11.0 * math.sqrt(share / limit)) / 10.0
        yield _judged(
            delay <= DELAY_LIMIT,
            "Force and depth at the first piercing do not depend on impacts of the film's nodes",
            "Depth and work at the first piercing are not those of a slow tip, because impacts of "
            "the film's nodes are large",
            "the force on a tip is averaged over a time that is up to "
            f"{_percent(delay, DELAY_LIMIT)} of the time for which the tip pressed",
            _percent(DELAY_LIMIT),
            f" Use a motion that is {slower:.1f} times slower, or a finer film near the tips.",
        )
    damping = _share_of_cut(figures, damping_of_cut(figures))
    if damping is not None and judged:
        yield _judged(
            abs(damping) <= DAMPING_LIMIT,
            "Damping is small",
            "Force or torque is too high by the work of damping, because film springs open",
            _of_cut(damping, DAMPING_LIMIT),
            _percent(DAMPING_LIMIT),
            _remedies(figures, "shorter sides", *_SLOWER, "damping"),
        )


def _contact(figures: Figures) -> Iterator[Line]:
    """Yield what contact took of the work, with the tool and of the film with itself."""
    contact = _share_of_cut(figures, figures.get("contact_Nmm", 0.0))
    if contact is not None and is_of_a_tool(figures):
        stored, lost = (figures.get(f"contact_{name}_Nmm", 0.0) for name in ("stored", "lost"))
        did, limit, cures = "took", CONTACT_LIMIT, ["finer", *_SMALLER_STEP]
        bad = "Contact loses too much energy where film hits the tool or springs off it"
        if contact < 0.0:
            did, limit = "gave the film", GIVEN_LIMIT
            bad = "Contact creates energy, because film hit the tool too fast for the time step"
        elif stored > lost:
            cures = ["finer", "penalty"]
            bad = (
                "Contact stores too much energy in its springs, because film presses hard on the "
                "tool"
            )
        yield _judged(
            abs(contact) <= limit,
            "Contact takes little work",
            bad,
            f"it {did} {_of_cut(abs(contact), limit)}, friction not counted",
            _percent(limit),
            _remedies(figures, *cures),
        )
    lost = _share_of_cut(figures, figures.get("self_contact_lost_Nmm", 0.0))
    if lost is not None and "self_contact_Nmm" in figures:
        did = "lost" if lost >= 0.0 else "gave the film"
        yield _judged(
            abs(lost) <= GIVEN_LIMIT,
            "Parts of the film meet slowly enough",
            "Parts of the film hit each other too fast for the time step",
            f"their contact {did} {_of_cut(abs(lost), GIVEN_LIMIT)}",
            _percent(GIVEN_LIMIT),
            _remedies(figures, *_SMALLER_STEP),
        )


def _depths(figures: Figures) -> Iterator[Line]:
    """Yield how deep the tool is in nodes, quads and edges of the film."""
    touched = not never_touched(figures)
    depth, half = (
        figures.get(f"{name}_mm") for name in ("deepest_penetration", "tool_half_thickness")
    )
    if depth is not None and half is not None and touched:
        limit = PENETRATION_LIMIT * half
        yield _judged(
            depth <= limit,
            "The tool pushes the film aside by its full thickness",
            "The tool pushes the film aside by less than its thickness",
            f"nodes of the film are up to {_beside(depth, limit)} mm deep in the tool",
            f"{limit:.3g} mm, a quarter of {half:.3g} mm, the tool's volume over its surface",
            _remedies(figures, "finer", "penalty"),
        )
    depth, side = (figures.get(f"{name}_mm") for name in ("unfelt_penetration", "edge_length"))
    if depth is not None and side is not None and touched:
        limit = UNFELT_LIMIT * side
        yield _judged(
            abs(depth) <= limit,
            "The film resists the tool between its nodes, too",
            "The film does not resist the tool between its nodes",
            f"the tool is up to {_beside(depth, limit)} mm deep in quads where no node feels it",
            f"{limit:.3g} mm, half the side of a quad",
            _remedies(figures, "finer"),
        )
    depth = figures.get("unfelt_film_edge_mm", 0.0)
    limit = figures.get("film_half_thickness_mm", float("nan"))
    if depth > limit:
        yield Line(
            "note",
            "Borders or flanks of the film are not pushed aside where they cross the tool between "
            f"their nodes: they are up to {_beside(depth, limit)} mm deep in it (limit "
            f"{limit:.3g} mm, half of the film's thickness)."
            + _remedies(figures, "film edges", "finer"),
        )


def _where_nothing_was_cut(figures: Figures) -> Iterator[Line]:
    """Yield the doubts of film that would have torn, or been pierced, where no cut began."""
    stress = figures.get("overstress_rel", 0.0)
    if stress > STRESS_LIMIT:
        yield Line(
            "doubt",
            "The film would have torn where it has no notch: its stress stayed at "
            f"{_beside(stress, STRESS_LIMIT)} times the strength, at more than three quads from "
            f"cracks, supports and tool (limit {STRESS_LIMIT:g}). The run begins no crack there, "
            "and what follows is not what the film would do. Cut a notch where it tears.",
        )
    load = figures.get("idle_edge_load_rel", 0.0)
    if load > IDLE_LIMIT:
        yield Line(
            "doubt",
            f"Cutting edge {figures['idle_edge']:.0f} has cut nothing, though it pressed with "
            f"{_beside(load, IDLE_LIMIT)} times the force that pierces the film (limit "
            f"{IDLE_LIMIT:g}): another edge has cut the quad below it, or film beside it. "
            "Force and work are wrong." + _remedies(figures, "finer"),
        )


def _glue(figures: Figures) -> Iterator[Line]:
    """Yield the doubts of glue that has let go on quads that do not resolve how it peels."""
    ending = "_resolved_rel"
    for name in (key.removesuffix(ending) for key in figures if key.endswith(ending)):
        resolved = figures[f"{name}{ending}"]
        if resolved < 1.0 and figures.get(f"{name}_let_go_rel", 0.0) > 0.0:
            yield Line(
                "doubt",
                f"The film snaps off {name} from quad to quad, and the force that peels it is too "
                f"high: the zone over which it lets go has {ZONE_SIDES * resolved:.2g} sides of "
                f"the quads (limit {ZONE_SIDES:g}). At 1.1 sides the force was too high by 1 %, at "
                "0.9 by a fifth, at 0.8 it was more than twice as high. Use quads with sides at "
                f"most {resolved:.2g} times as long, or a lower strength of the glue.",
            )


def single_doubts(figures: Figures) -> Iterator[Line]:
    """Yield the notes on single values that are doubtful, while the others may be right."""
    if distrusted_figures(figures):
        side, bent = figures["path_edge_mm"], figures["bending_length_mm"]
        yield Line(
            "note",
            "The axial force is doubtful, because it depends on the mesh: the quads along the cut "
            f"have sides of {side:.3g} mm (limit {bent:.3g} mm). On longer sides the film cannot "
            "fold beside the tool, and its flanks press on the tool (contact.film_edges). The "
            "error changes during the cut: in the opening test on quick and M1 (sides of 0.82 and "
            "0.4 mm) the axial force is between -1.8 and 2.4 N, and the two differ by 0.1 to "
            "1.1 N. If you need this force, compare finer films (shellcut converge).",
        )


def repeated_notes(figures: Figures) -> list[Line]:
    """Return the lines whose content the answers and the table of energies have, too."""
    return [*_account(figures), *_window(figures)]


def distrusted_figures(figures: Figures) -> tuple[str, ...]:
    """Return the names of single values that depend on the mesh, while the others may be right.

    The axial force, where flanks press on the tool whose quads are too long to fold beside it.
    """
    side, bent = figures.get("path_edge_mm", 0.0), figures.get("bending_length_mm", float("nan"))
    presses = side > bent and figures.get("options", {}).get("film_edges")
    axial = (f"axial_force_{which}_N" for which in ("plateau", "peak", "min", "max"))
    return tuple(one for one in axial if presses and one in figures)


def _cut(figures: Figures) -> Iterator[Line]:
    """Yield whether anything was cut, where, and whether the edge met its cables in time."""
    if figures.get("n_cable_created") == 0 and may_crack(figures):
        why = "the tool never touched the film" if never_touched(figures) else "no cable was made"
        where = ""
        if is_of_a_tool(figures):
            where = " Use shellcut preview to see the path of the cutting edges."
        yield Line("doubt", f"Nothing was cut: {why}.{where}")
    n, off = figures.get("n_split", 0), figures.get("n_split_off_path", 0)
    torn, away = figures.get("n_tear", 0), figures.get("tear_off_path_mm")
    if torn:
        beside = "of the path of the cutting edges, or straight ahead of it"
        where = "" if away is None else f" They lie within {away:.2g} mm {beside}."
        yield Line(
            "note",
            f"{torn:,} of {n + torn:,} cuts are tears: there the film tore without a cutting "
            f"edge.{where} If you did not expect a tear, look at the pictures.",
        )
    if n:
        far, lead = figures.get("off_path_mm", float("nan")), figures.get("crack_lead_mm", 0.0)
        ahead = f", or straight ahead of it by up to {lead:.3g} mm" if lead else ""
        others = " other than tears" if torn else ""
        most, lie = ("up to", "beside it") if off else ("at most", f"away from it{ahead}")
        yield _judged(
            off == 0,
            "The cracks follow the path of the cutting edges",
            "Cracks left the path of the cutting edges; the crack map shows where",
            f"{off or n:,} of {n:,} splits{others} are {most} {far:.3g} mm {lie}",
            "a fifth of the side of a quad",
            _remedies(figures, "through quads"),
        )
    if "overshoot_rel" in figures:
        missed = figures["overshoot_rel"]
        yield _judged(
            missed <= OVERSHOOT_LIMIT,
            "The cutting edge meets its cables in time",
            "Force or torque is too low, because the cutting edge meets its cables late: it is too "
            "fast, or does not move where it points",
            f"it meets them after {_percent(missed, OVERSHOOT_LIMIT)} of the distance over which "
            "it drags them",
            _percent(OVERSHOOT_LIMIT),
            _remedies(figures, "more checks", *_SLOWER),
        )


def _account(figures: Figures) -> Iterator[Line]:
    """Yield what became of the work, and the share that the laws of the model dissipated."""
    put_in, became = account(figures)
    if not became:
        return
    whole = sum(line.energy for line in put_in)
    sources = ", ".join(f"{line.words} {line.energy:.4g}" for line in put_in)
    parts = ", ".join(f"{line.words} {100.0 * line.share:.1f} %" for line in became)
    yield Line("note", f"{whole:.4g} N·mm were put in ({sources}). They became: {parts}.")
    if not figures.get("n_cable_broken", 0):
        return
    asked, together = dissipated(figures)
    if not asked:
        return
    first, *others = asked
    said = f"{first.words} took {_percent(first.share, ASKED_LIMIT)} of the dissipated work"
    said += "".join(f", {line.words} {_percent(line.share)}" for line in others)
    said += f", together {_percent(together, ASKED_LIMIT)}" if others else ""
    yield _judged(
        together >= ASKED_LIMIT,
        "Cables, film and friction dissipated the work, not damping and contact",
        "Damping and contact dissipated too much of the work, because film springs open"
        + (" or a tool presses on film that does not part" if is_of_a_tool(figures) else ""),
        said,
        f"at least {_percent(ASKED_LIMIT)}",
        _remedies(figures, "shorter sides", *_SLOWER),
    )


def _window(figures: Figures) -> Iterator[Line]:
    """Yield what the work of the steady window became, and judge the part that no law explains."""
    if why := figures.get("no_window"):
        yield Line("note", f"No part of the cut is steady, so no mean is given: {why}.")
    became = window_account(figures)
    if not became:
        return
    parts = ", ".join(f"{line.words} {100.0 * line.share:.1f} %" for line in became)
    said = f"In the steady window the work became: {parts}."
    stored = figures[growth_figure(STORED)]
    if stored >= STORED_NOTE:
        said += (
            " The stored part is no work of cutting, but force or torque contains it: the longer "
            "the cut, the more film the tool strains."
        )
    elif stored <= -STORED_NOTE:
        said += (
            " The film released energy that it had stored before, so force or torque is less than "
            "the work of cutting."
        )
    yield Line("note", said)
    if not is_of_a_tool(figures):
        return
    by_law = sum(figures.get(growth_figure(part), 0.0) for part in ASKED_FOR)
    # Where the film releases energy the cut takes more work than was put in.
    other = (1.0 - stored - by_law) / max(1.0, by_law)
    yield _judged(
        abs(other) <= OTHER_LIMIT,
        "In the steady window force or torque is that of cables, film and friction",
        "In the steady window force or torque is not that of cables, film and friction alone: "
        "vibration, damping and contact carry part of it",
        f"all else took {_percent(other, OTHER_LIMIT)} of the work in that window",
        _percent(OTHER_LIMIT),
        _remedies(figures, "shorter sides", *_SLOWER, "damping"),
    )


def _stored(figures: Figures) -> Iterator[Line]:
    """Yield a doubt where much is stored and the film could not buckle, by shape or mesh.

    Where it could buckle, a thick film between near clamps really stores as much, and nothing is
    to be done.
    """
    stored = figures.get(growth_figure(STORED), 0.0)
    if stored <= STORED_LIMIT or not is_of_a_tool(figures):
        return
    side, bent = figures.get("path_edge_mm", 0.0), figures.get("bending_length_mm", float("nan"))
    if remedy := _remedies(figures, "imperfection"):
        why = "a film without imperfection stays flat"
    elif side > bent:
        why = (
            f"the quads along the cut have sides of {side:.3g} mm, and it folds only on sides "
            f"shorter than {bent:.3g} mm"
        )
        remedy = " Compare it with a run on a finer film near the tool."
    else:
        return
    yield Line(
        "doubt",
        "Force or torque may be too high, because the film may not fold beside the tool: "
        f"{why}. It stored {_percent(stored, STORED_LIMIT)} of the work that was put in during the "
        f"steady window (limit {_percent(STORED_LIMIT)}).{remedy}",
    )


def _rotary_inertia(figures: Figures) -> Iterator[Line]:
    factor = figures.get("added_inertia_factor", 0.0)
    if factor > INERTIA_NOTE:
        yield Line(
            "note",
            f"Rotary inertia is scaled by {factor:.3g} for a longer time step, so bending waves "
            "shorter than a few quads are too slow. Use a finer film if you need these waves.",
        )


_JUDGES: tuple[Callable[[Figures], Iterator[Line]], ...] = (
    _energies,
    _speed,
    _where_nothing_was_cut,
    _contact,
    _depths,
    single_doubts,
    _cut,
    _glue,
    _account,
    _window,
    _stored,
    _rotary_inertia,
)
