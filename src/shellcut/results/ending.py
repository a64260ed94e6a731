"""The end of a run in words: one sentence, its doubts, its answers, where the work went.

All of it is from ``summary.json``. The report of a run begins with the same sentence.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any

from shellcut.formats.errors import counted
from shellcut.unit import with_unit

from .answers import answers, levels
from .energy_account import account
from .summary_figures import key_figures, label_of
from .verdict import Line, distrusted_figures, is_of_a_tool, repeated_notes, single_doubts

_COUNTS = (
    *("crack_length_mm", "n_cable_created", "n_cable_jointed", "n_cable_broken"),
    *("imbalance_rel", "kinetic_rel", "n_step", "wall_s"),
)
"""Values of ``summary.json`` after those of the work."""


def conclusion(summary: Mapping[str, Any], n_doubt: int) -> str:
    """Return in one sentence what a run found, and what is doubtful; "" without a force or torque.

    Examples
    --------
    >>> conclusion({"force_peak_N": 3.2, "force_peak_at_mm": 4.0}, n_doubt=1)
    'Moving the film took a force of at most 3.2 N, at 4 mm; there is 1 doubt.'
    """
    name = "torque" if "torque_peak_Nmm" in summary else "force"
    if not (said := levels(summary, name)):
        return ""
    cut, tool = summary.get("crack_length_mm", 0.0) > 0.0, is_of_a_tool(summary)
    film = "pulling the film apart" if cut else "moving the film"
    who = film if not tool else "the cut" if cut else "moving the tool"
    if (share := summary.get("share_done", 1.0)) < 1.0:
        why = "failed" if summary.get("broke_off") else "was stopped"
        who = f"up to {100.0 * share:.3g} % of its time, where the run {why}, {who}"
    why = summary.get("no_window", "")
    but = f", but no steady value exists: {why}" if why else ""
    trust = [f"there {'is' if n_doubt == 1 else 'are'} {counted(n_doubt, 'doubt')}"] * (n_doubt > 0)
    if doubtful := distrusted_figures(summary):
        names = dict.fromkeys(label_of(n).partition(",")[0] for n in doubtful)
        number = "one value is" if len(names) == 1 else f"{len(names)} values are"
        trust.append(f"{number} doubtful: the {', '.join(names)}")
    end = " and ".join(trust) or "no check failed"
    return f"{who[0].upper()}{who[1:]} took a {name} of {said[0]}{but}; {end}."


def ending(summary: Mapping[str, Any], *, verbose: bool) -> Iterator[str]:
    """Yield the lines at the end of a run; the checks that passed are one line unless verbose."""
    lines = [Line(**line) for line in summary.get("verdict", ())]
    kinds = ([line for line in lines if line.kind == kind] for kind in ("doubt", "good", "note"))
    doubts, passed, notes = kinds
    first = [line for line in notes if line in single_doubts(summary)]
    folded = first if verbose else first + repeated_notes(summary)
    left = [line for line in notes if line not in folded]
    yield from filter(None, [conclusion(summary, len(doubts)), *map(str, doubts + first)])
    yield ""
    yield from (f"{asked:<16} {answer}" for asked, answer in answers(summary))
    if passed:
        listed = ":" if verbose else " (--verbose shows them; run.log and the report list them)"
        yield counted(len(passed), "check") + " passed" + listed
    yield from map(str, passed * verbose + left)
    yield ""
    for words, energy, share in chain(*account(summary)):
        yield f"{words:<52} {with_unit(energy, 'N*mm'):>14} {100.0 * share:>6.1f} %"
    yield from (f"{label:<52} {value:>14}" for label, value in key_figures(summary, _COUNTS))
