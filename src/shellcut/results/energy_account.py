"""Where the work of a run went: the energy balance, of entries or of the history's columns.

docs/theory/energy.md names its parts. They are linear in the entries, so the balance of a part
of the run is that of the differences between its ends. Ledger, ``summary.json``, verdict, curves,
report and the table at the end of a run all take their parts and sums from here.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from functools import reduce
from math import isfinite
from operator import add
from typing import Any, NamedTuple, TypeVar

import numpy as np

from shellcut.arrays import Bools, Floats

Energy = TypeVar("Energy", float, Floats)
"""Energies [N·mm], at one moment or in the rows of a history."""


class Part(NamedTuple):
    """A part of the energy balance."""

    name: str
    """Its value in ``summary.json`` is NAME_Nmm."""
    words: str
    entries: tuple[str, ...]
    """Of :class:`shellcut.simulation.ledger.Ledger`, columns of ``history.csv``; their sum."""

    def of(self, entries: Mapping[str, Energy]) -> Energy:
        """Return its energy; histories of older versions lack some entries."""
        zero: Energy = 0.0 * next(iter(entries.values()))
        return reduce(add, (entries[name] for name in self.entries if name in entries), zero)


PUT_IN = (
    Part("tool_work", "work of the tool", ("tool_work",)),
    Part("support_work", "work of the supports", ("support_work",)),
    Part("load_work", "work of the loads", ("load_work",)),
    Part("initial", "energy at the start", ("initial",)),
)
"""What puts energy into the film."""

CABLES = Part("cables", "cables", ("cohesive_work", "cohesive_start_work"))
STORED = Part("strain", "stored in the film", ("strain",))
ASKED_FOR = (
    CABLES,
    Part("material_dissipated", "yielding or damage of the material", ("material_dissipated",)),
    Part("adhesion", "glue", ("adhesion_work",)),
    Part("friction", "friction", ("friction_work",)),
    Part("joint_friction", "friction of the cables on the cutting edge", ("joint_friction",)),
)
"""What the work of a cut goes into by the laws of film, cables, glue and friction."""

_DAMPING = Part("damping", "damping", ("damping_stiffness", "damping_mass", "damping_kinetic"))
_KINETIC = Part("kinetic", "kinetic energy", ("kinetic_translation", "kinetic_rotation"))
TAKEN_UP = (
    *ASKED_FOR,
    _DAMPING,
    STORED,
    _KINETIC,
    Part("contact", "contact", ("contact_work",)),
    Part("self_contact", "contact of the film with itself", ("self_contact_work",)),
)
"""What the work becomes."""

KINETIC_IN_FILM, TOOL_WORK_IN_FILM = "kinetic_in_film", "tool_work_in_film"
"""Columns of kinetic energy and work of the tool as seen from a film that its supports move
[N·mm]."""

IMBALANCE = Part("imbalance", "imbalance", ("imbalance",))

# Imbalance and kinetic energy are compared with an energy once it reaches this part of its
# maximum: at first touch there is almost no work to compare with.
_COMPARED_FROM = 0.1

# Of the energy put in: a tool that does less work rests.
_ROUND_OFF = 1e-9

# Smallest share that is shown.
_SHOWN = 5e-4


def total(parts: Iterable[Part], entries: Mapping[str, Energy]) -> Energy:
    """Return the sum of some parts."""
    zero: Energy = 0.0 * next(iter(entries.values()))
    return reduce(add, (part.of(entries) for part in parts), zero)


def energy_shares(history: Mapping[str, Floats]) -> dict[str, Floats]:
    """Return what the work has become, by its words, each of shape (n_row,), [N·mm].

    Parts that are zero throughout are left out.
    """
    return {part.words: share for part in TAKEN_UP if (share := part.of(history)).any()}


def energy_figures(entries: Mapping[str, float]) -> dict[str, float]:
    """Return the balance as values of ``summary.json`` [N·mm], with what contact stores and loses.

    What is zero is left out. A film that blew up has no balance: one entry that is not finite
    leaves nothing to compare with.
    """
    figures = {part.name: part.of(entries) for part in (*PUT_IN, *TAKEN_UP)}
    figures["imbalance"] = total(PUT_IN, entries) - total(TAKEN_UP, entries)
    if not isfinite(figures["imbalance"]):
        return {}
    of_contact = ("contact_stored", "friction_dissipated", "adhesion_dissipated")
    figures |= {name: entries.get(name, 0.0) for name in of_contact}
    figures["contact_lost"] = figures["contact"] - figures["contact_stored"]
    figures["self_contact_lost"] = figures["self_contact"] - entries.get("self_contact_stored", 0.0)
    return {f"{name}_Nmm": energy for name, energy in figures.items() if energy}


def growth_figure(part: Part) -> str:
    """Return the value that is a part's share of what was put in over the steady window."""
    return f"{'stored' if part is STORED else part.name}_growth_rel"


def growth_shares(history: Mapping[str, Floats], first: int, last: int) -> dict[str, float]:
    """Return what has become of all that was put in from one row to another, by values.

    With the imbalance the shares make up 1; those that are zero are left out, but for what the film
    stores. Empty where nothing was put in.
    """
    grown = {name: float(column[last] - column[first]) for name, column in history.items()}
    whole = total(PUT_IN, grown)
    if not whole > 0.0:
        return {}
    shares = {growth_figure(part): part.of(grown) / whole for part in TAKEN_UP}
    shares[growth_figure(IMBALANCE)] = 1.0 - sum(shares.values())
    return {name: one for name, one in shares.items() if one or name == growth_figure(STORED)}


def window_account(figures: Mapping[str, Any]) -> list[Share]:
    """Return the balance of the steady window, without energies; empty without a window."""
    if growth_figure(STORED) not in figures:
        return []
    parts = ((part.words, figures.get(growth_figure(part), 0.0)) for part in (*TAKEN_UP, IMBALANCE))
    return [Share(words, float("nan"), share) for words, share in parts if abs(share) >= _SHOWN]


def never_touched(figures: Mapping[str, Any]) -> bool:
    """Whether a run has a tool that never touched the film."""
    depths = [figures.get(f"{name}_mm") for name in ("deepest_penetration", "unfelt_penetration")]
    return depths == [0.0, 0.0] and not figures.get("tool_work_Nmm")


class Share(NamedTuple):
    """A line of the energy balance."""

    words: str
    energy: float
    """[N·mm]."""
    share: float
    """Of the whole: of all that was put in, or of all that was dissipated."""


def account(figures: Mapping[str, Any]) -> tuple[list[Share], list[Share]]:
    """Return what was put in and what became of it; the shares of each make up 1.

    Empty where nothing was put in, or a tool never touched its film: then round-off is all there
    is. Shares that round to 0.0 % are left out.
    """
    whole = sum(figures.get(f"{part.name}_Nmm", 0.0) for part in PUT_IN)
    if not whole > 0.0 or never_touched(figures):
        return [], []

    def lines(parts: Iterable[Part]) -> Iterator[Share]:
        for part in parts:
            energy = figures.get(f"{part.name}_Nmm", 0.0)
            if abs(energy) >= _SHOWN * whole:
                yield Share(part.words, energy, energy / whole)

    return list(lines(PUT_IN)), list(lines((*TAKEN_UP, IMBALANCE)))


def dissipated(figures: Mapping[str, Any]) -> tuple[list[Share], float]:
    """Return what went where the laws of the run let it go, and all such shares together.

    The shares are of the dissipated work: besides these, damping and what contact has lost,
    whatever their signs. Energy that is stored or kinetic is not in it, nor damping before the cut.
    Cables count with all their work: what they hold is dissipated when they break.
    """
    asked = [(part.words, figures.get(f"{part.name}_Nmm", 0.0)) for part in ASKED_FOR]
    lost = (figures.get(f"{name}_lost_Nmm", 0.0) for name in ("contact", "self_contact"))
    whole = sum(energy for _, energy in asked) + sum(map(abs, (damping_of_cut(figures), *lost)))
    if not whole > 0.0:
        return [], 0.0
    shares = [Share(words, energy, energy / whole) for words, energy in asked if energy]
    return shares, sum(share.share for share in shares)


def damping_of_cut(figures: Mapping[str, Any]) -> float:
    """Return what damping has dissipated since the cut began [N·mm]."""
    return float(figures.get("damping_Nmm", 0.0) - figures.get("damping_before_Nmm", 0.0))


def driving_work(entries: Mapping[str, Energy]) -> Energy:
    """Return the work of tool and supports together, which move tool and film to each other."""
    return PUT_IN[0].of(entries) + PUT_IN[1].of(entries)


def put_through(entries: Mapping[str, Energy]) -> Energy:
    """Return the magnitudes of what has been put into the film so far, or taken out, together.

    They are those of tool and supports, of the loads and of the start. The
    error of the energy balance is relative to it. Tool and supports count together: what both do
    in a film that moves on with its tool depends on the axes only.
    """
    _, _, loads, start = PUT_IN
    return abs(driving_work(entries)) + abs(loads.of(entries)) + abs(start.of(entries))


def energy_put_in(history: Mapping[str, Floats]) -> Floats:
    """Return the largest energy so far that has been put in or taken out, shape (n_row,)."""
    return _so_far(put_through(history))


def cut_work(history: Mapping[str, Floats]) -> tuple[Floats, int]:
    """Return the work of the cut up to each row, shape (n_row,), and the row before it begins.

    It is the work of the tool, as seen from the film, or what cables, material, glue and friction
    have absorbed since the tool began to work, whichever is larger; of both the largest so far. A
    tool that does no work but round-off rests: then that of the supports takes its place, or else
    that of the loads. Without a tool only that of the supports does.
    """
    tool = TOOL_WORK_IN_FILM if TOOL_WORK_IN_FILM in history else "tool_work"
    moved = tool, "support_work"
    names = (*moved, "load_work") if "deepest_penetration" in history else moved
    least = _ROUND_OFF * energy_put_in(history)
    works = (np.abs(history[name]) for name in names if name in history)
    work = next((one for one in works if (one > least).any()), np.zeros(len(least)))
    done, asked = work > least, total(ASKED_FOR, history)
    begin = max(int(np.argmax(done)) - 1, 0) if done.any() else 0
    if not done.any():
        return np.zeros(len(least)), begin
    return _so_far(np.maximum(work, asked - asked[begin])), begin


def _so_far(energy: Floats) -> Floats:
    """Return the largest magnitude up to each row, nan in rows that are not finite."""
    finite = np.isfinite(energy)
    most = np.maximum.accumulate(np.where(finite, np.abs(energy), 0.0))
    return np.where(finite, most, np.nan)


def trusted_rows(whole: Floats) -> Bools:
    """Return the rows with enough of an energy to compare others with, shape (n_row,).

    These are the rows with at least a tenth of its largest value; none if all are zero.
    """
    most = np.fmax.reduce(whole, initial=0.0)
    return np.asarray((whole > 0.0) & (whole >= _COMPARED_FROM * most))


def relative_figures(history: Mapping[str, Floats]) -> dict[str, float]:
    """Return what the verdict compares energies with [N·mm], and the largest shares of it, [-].

    The kinetic energy is that which is seen from the film, if supports move it. Left out is what
    has nothing to be compared with, or is zero.
    """
    put_in, (work, begin) = energy_put_in(history), cut_work(history)
    before = _DAMPING.of(history)[begin : begin + 1]
    shares = (
        ("imbalance_rel", history["imbalance"], put_in),
        ("kinetic_rel", history.get(KINETIC_IN_FILM, _KINETIC.of(history)), work),
    )
    figures = {
        name: float((np.abs(energy[rows]) / whole[rows]).max())
        for name, energy, whole in shares
        if (rows := trusted_rows(whole)).any()
    }
    energies = {
        "cut_work_Nmm": np.fmax.reduce(work, initial=0.0),
        "damping_before_Nmm": before.sum(),
    }
    return figures | {name: float(energy) for name, energy in energies.items() if energy}
