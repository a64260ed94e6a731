"""The end of a run in words: one sentence, its doubts, its answers, where the work went.

Answers are to the questions of those who design a cap, a blade or a film. Each comes from
``summary.json``: a mean with its ±, a peak as the single sample that it is, or the reason why the
run does not say. docs/howto/read-results.md lists them. The report of a run begins with the same
sentence.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from itertools import chain
from typing import Any

from shellcut.formats.errors import counted, point_text
from shellcut.unit import with_unit as number_with_unit

from .energy_account import account
from .summary_figures import key_figures, label_of, said_of, window_of, with_unit
from .verdict import Line, distrusted_figures, is_of_a_tool, repeated_notes, single_doubts

Summary = Mapping[str, Any]

_SIGN = 0.05
"""Of the peak: a value of the other sign up to this is a vibration of the film or the tool."""


def answers(summary: Summary) -> list[tuple[str, str]]:
    """Return what is asked, and the answer, of all questions that the run can say something to.

    Examples
    --------
    >>> for asked, answer in answers({"force_peak_N": 3.2, "force_peak_at_mm": 4.0, "n_loose": 0}):
    ...     print(f"{asked}: {answer}")
    force to cut: at most 3.2 N, at 4 mm
    loose pieces: none at the end of the run
    """
    return [
        *_level(summary, "torque", "torque to cut"),
        *_level(summary, "force", "force to cut"),
        *_level(summary, "axial_force", "force to press"),
        *_piercing(summary),
        *_film(summary),
        *_cut(summary),
    ]


def _level(summary: Summary, name: str, asked: str) -> Iterator[tuple[str, str]]:
    """Yield the mean of a torque or force over the steady window, and its peak."""
    said = levels(summary, name)
    if not said:
        return
    if why := summary.get("no_window", summary.get(f"no_{name}_plateau")):
        said.append(f"no mean: {why}")
    doubtful = any(one.startswith(name) for one in distrusted_figures(summary))
    yield asked, "; ".join(said) + (" (doubtful: it depends on the mesh)" if doubtful else "")


def levels(summary: Summary, name: str) -> list[str]:
    """Return the mean of a torque or force over the steady window, and its peak.

    If it has both signs, the peak is two: one is the most that resists, the other the most that
    drives.
    """
    unit = "Nmm" if name == "torque" else "N"
    mean, peak, low, high = (f"{name}_{one}_{unit}" for one in ("plateau", "peak", "min", "max"))
    said = []
    if mean in summary:
        said.append(f"{said_of(mean, summary)} (mean over {window_of(summary)})")
    if min(-summary.get(low, 0.0), summary.get(high, 0.0)) > _SIGN * abs(summary.get(peak, 0.0)):
        said.append(f"between {_placed(summary, low)} and {_placed(summary, high)}")
    elif peak in summary:
        bound = "at most" if summary[peak] >= 0.0 else "down to"
        said.append(f"{bound} {_placed(summary, peak, ', at')}")
    return said


def _placed(summary: Summary, key: str, at: str = " at") -> str:
    """Return a value with its place, if that is there."""
    name = key.rpartition("_")[0]
    places = (f"{name}_at_{along}" for along in ("deg", "mm"))
    where = next((f"{at} {with_unit(p, summary[p])}" for p in places if p in summary), "")
    return f"{with_unit(key, summary[key])}{where}"


def _piercing(summary: Summary) -> Iterator[tuple[str, str]]:
    """Yield with what force, how deep and after what work cutting edges pierce whole film."""
    edges = [key[:-2] for key in summary if re.fullmatch(r"piercing_force_\d+_N", key)]
    if not edges:
        return
    numbers = [one.removeprefix("piercing_force_") for one in edges]
    force, depth, work = (
        _range(summary, [f"piercing_{what}_{number}_{unit}" for number in numbers])
        for what, unit in (("force", "N"), ("depth", "mm"), ("work", "Nmm"))
    )
    who = f"cutting edge {numbers[0]}" if len(numbers) == 1 else f"{len(numbers)} cutting edges"
    each = "" if len(numbers) == 1 else " each"
    yield (
        "piercing",
        f"{who} pierced whole film with {force}{each}, {depth} deep, after {work} of work",
    )


def _range(summary: Summary, keys: list[str]) -> str:
    """Return the least and the largest of some values."""
    ascending = sorted(keys, key=lambda key: float(summary[key]))
    low, high = (with_unit(key, summary[key]) for key in (ascending[0], ascending[-1]))
    return low if low == high else f"{low} to {high}"


def _film(summary: Summary) -> Iterator[tuple[str, str]]:
    """Yield whether a piece has come loose, and whether each glue holds, peels, or has let go."""
    if n := summary.get("n_loose"):
        centre = point_text([summary[f"loose_{axis}_mm"] for axis in "xyz"], 4)
        pieces = "1 piece" if n == 1 else f"{n} pieces, the largest"
        area = with_unit("loose_area_mm2", summary["loose_area_mm2"])
        yield "loose pieces", f"{pieces} of {area} about {centre} mm"
    elif n is not None:
        yield "loose pieces", "none at the end of the run"
    ending = "_let_go_rel"
    for name in (key.removesuffix(ending) for key in summary if key.endswith(ending)):
        damaged, gone = (100.0 * summary[f"{name}_{what}_rel"] for what in ("damaged", "let_go"))
        said = f"{gone:.3g} % of its area has let go"
        if damaged == 0.0:
            said = "it holds: no part is damaged"
        elif gone == 0.0:
            lift = with_unit(f"{name}_lift_mm", summary[f"{name}_lift_mm"])
            said = (
                f"it holds, but {damaged:.2g} % of its area is damaged and lifted by up to {lift}"
            )
        if damaged > 0.0 and summary[f"{name}_resolved_rel"] < 1.0:
            said += " (doubtful: the quads do not resolve how it peels)"
        yield name, said


def _cut(summary: Summary) -> Iterator[tuple[str, str]]:
    """Yield how far cuts lie beside the path, and what the edge's radius means for its cables."""
    if "off_path_mm" in summary:
        off = with_unit("off_path_mm", summary["off_path_mm"])
        said = f"cuts lie within {off} of the path of the cutting edges"
        if n := summary.get("n_tear", 0):
            away = with_unit("tear_off_path_mm", summary["tear_off_path_mm"])
            said += f"; {n} cuts are tears, up to {away} beside it"
        yield "flanks", said
    if "blunt_radius_mm" in summary:
        radius, blunt, energy = (
            with_unit(key, summary[key])
            for key in ("edge_radius_mm", "blunt_radius_mm", "severing_energy_N_per_mm")
        )
        yield (
            "sharpness",
            f"an edge of radius {radius} severs cables at {energy}; from {blunt} on it severs none",
        )


_COUNTS = (
    *("crack_length_mm", "n_cable_created", "n_cable_jointed", "n_cable_broken"),
    *("imbalance_rel", "kinetic_rel", "n_step", "wall_s"),
)
"""Values of ``summary.json`` after those of the work."""


def conclusion(summary: Summary, n_doubt: int) -> str:
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


def ending(summary: Summary, *, verbose: bool) -> Iterator[str]:
    """Yield the lines at the end of a run; the checks that passed are one line unless verbose."""
    lines = [Line(**line) for line in summary.get("verdict", ())]
    doubts, passed, notes = (
        [line for line in lines if line.kind == kind] for kind in ("doubt", "good", "note")
    )
    first = [line for line in notes if line in [*single_doubts(summary)]]
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
    yield from (
        f"{words:<52} {number_with_unit(energy, 'N*mm'):>14} {100.0 * share:>6.1f} %"
        for words, energy, share in chain(*account(summary))
    )
    yield from (f"{label:<52} {value:>14}" for label, value in key_figures(summary, _COUNTS))
