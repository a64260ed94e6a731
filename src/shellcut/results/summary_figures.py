"""Values of ``summary.json``: those that the history of a run holds, labels and units of all."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterable, Mapping
from math import isfinite
from typing import Any

import numpy as np

from shellcut.arguments import listed
from shellcut.arrays import Floats
from shellcut.state import PUNCTURE, SplitRecord
from shellcut.unit import after, shown
from shellcut.unit import with_unit as number_with_unit

from .cut_quality import LABELS as OF_THE_CUT
from .energy_account import (
    IMBALANCE,
    PUT_IN,
    TAKEN_UP,
    energy_figures,
    growth_figure,
    relative_figures,
)
from .steady_window import half_width_of, no_mean_of, steady_figures
from .verdict import distrusted_figures

# The end of a name gives the unit; longer ones first.
_UNITS = {
    **{"ns_per_quad_step": "ns", "_N_per_mm": "N/mm", "_Nmm": "N·mm", "_deg": "°"},
    **{"_mm2": "mm^2", "_mm": "mm", "_N": "N", "_s": "s"},
}

PEAK = "_peak_"
"""In the names of values of largest magnitude, which have their sign."""

_STEADY = " over {window}"
"""Placeholder for the steady window in a label."""

LABELS = {
    "doubts": "doubts about the run",
    "torque_plateau_Nmm": f"torque, mean{_STEADY}",
    "torque_peak_Nmm": "torque, peak",
    "torque_peak_at_deg": "torque, peak at",
    "axial_force_plateau_N": f"axial force, mean{_STEADY}",
    "axial_force_peak_N": "axial force, peak",
    "axial_force_peak_at_deg": "axial force, peak at",
    "axial_force_min_N": "axial force, smallest",
    "axial_force_max_N": "axial force, largest",
    "force_plateau_N": f"force, mean{_STEADY}",
    "force_peak_N": "force, peak",
    "force_peak_at_mm": "force, peak at",
    "crack_length_mm": "crack length",
    "angle_end_deg": "angle at the end",
    "path_end_mm": "path at the end",
    "way_end_mm": "path by which the supports have parted at the end",
    **{f"{part.name}_Nmm": part.words for part in (*PUT_IN, *TAKEN_UP, IMBALANCE)},
    "cohesive_work_Nmm": "work of the cables",
    "cohesive_dissipated_Nmm": "dissipated by the cables",
    "cohesive_stored_Nmm": "stored in the cables",
    "contact_stored_Nmm": "contact, stored in its springs",
    "contact_lost_Nmm": "contact, lost in impacts and where it opens",
    "self_contact_lost_Nmm": "contact of the film with itself, lost in impacts",
    "friction_dissipated_Nmm": "friction, dissipated by slip",
    "dWcoh_dtheta_Nmm": f"cables' work per radian{_STEADY}",
    "dW_dtheta_Nmm": f"tool's work per radian{_STEADY}",
    "dWcoh_ds_N": f"cables' work per mm{_STEADY}",
    "dW_ds_N": f"work put in per mm{_STEADY}",
    "n_loose": "loose pieces at the end",
    "loose_area_mm2": "largest loose piece, area",
    "n_cable_created": "cables made",
    "n_tear": "tears, cuts that no cutting edge drives",
    "tear_off_path_mm": "tears, largest distance from the path",
    "n_cable_jointed": "cables met by the blade",
    "n_cable_broken": "cables broken",
    "n_split": "splits",
    "n_quad": "quads",
    "n_copy": "cuts of quads, notches included",
    "n_step": "steps",
    "ns_per_quad_step": "computing time per quad and step",
    "wall_s": "computing and output time",
    "imbalance_rel": "largest imbalance, of the energy put in",
    "kinetic_rel": "largest kinetic energy, of the work of the cut",
    "quasi_static": "kinetic energy allowed by quasi_static, over the work",
    "n_stop": "stops of the film by quasi_static",
    "added_inertia_factor": "scale of the rotary inertia",
    "n_imperfection": "number of the film's imperfection",
    "imperfection_mm": "bound of the film's imperfection",
    "deepest_penetration_mm": "deepest node in the tool",
    "tool_half_thickness_mm": "tool, half thickness",
    "self_contact_deepest_mm": "deepest point of the film in the film",
    "n_self_contact_looked": "searches for contact of the film with itself",
    "unfelt_penetration_mm": "deepest tool between nodes, without contact",
    "unfelt_film_edge_mm": "deepest border or flank in the tool, without contact",
    "edge_radius_mm": "cutting edge, radius",
    "severing_energy_N_per_mm": "energy at which the edge severs cables",
    "severing_opening_mm": "their length there",
    "blunt_radius_mm": "radius from which an edge severs none",
    "path_edge_mm": "sides of quads along the path",
    "bending_length_mm": "length over which the film bends at its strength",
    "largest_overshoot_mm": "largest overshoot of the edge past a cable",
    "n_recovery_borrowed": "stresses taken from a neighbour's patch",
}
"""Label of each value, in the order shown; the unit is in its name."""

_EXTREMES = {
    f"{name}_{which}_{end}"
    for name, unit in (("torque", "Nmm"), ("force", "N"), ("axial_force", "N"))
    for which in ("min", "max")
    for end in (unit, "at_deg", "at_mm")
}

# Figures that the report judges or shows elsewhere on the page.
_ELSEWHERE = {
    *_EXTREMES,
    *("imbalance_rel", "kinetic_rel", "dt_s", "verdict", "edge_length_mm", "broke_off"),
    *(f"{part.name}_Nmm" for part in (*PUT_IN, *TAKEN_UP, IMBALANCE)),
    *("overshoot_rel", "n_split_off_path", "off_path_mm"),
    *(growth_figure(part) for part in (*TAKEN_UP, IMBALANCE)),
    *("overstress_rel", "idle_edge", "idle_edge_load_rel"),
    *("piercing_delay_rel", "crack_lead_mm", "share_done", "options"),
    *("cut_work_Nmm", "damping_before_Nmm"),
    *("film_half_thickness_mm", "resistance", "no_window", "crack_path", "digest"),
    *(f"loose_{axis}_mm" for axis in "xyz"),
    *(f"window_{end}_{unit}" for end in ("from", "to") for unit in ("deg", "mm")),
}

_OF_CABLES = "cohesive_work", "cohesive_dissipated", "cohesive_stored"
_OF_TEETH = tuple(f"piercing_{one}" for one in ("force_1_N", "depth_1_mm", "work_1_Nmm"))


def key_figures(
    summary: Mapping[str, Any], names: Iterable[str] | None = None
) -> list[tuple[str, str]]:
    """Return label and value with unit of the named values that are there.

    By default of all but those that the verdict has: the known ones in order, then others by name.
    A mean has its ±. Labels of values that the verdict distrusts one by one say so.
    """
    if names is None:
        elsewhere = _ELSEWHERE | {half_width_of(key) for key in summary}
        elsewhere |= {no_mean_of(key) for key in LABELS}
        names = [key for key in dict.fromkeys((*LABELS, *summary)) if key not in elsewhere]
    window, doubtful = window_of(summary), distrusted_figures(summary)
    return [
        (label_of(n, window) + (" (distrust)" if n in doubtful else ""), said_of(n, summary))
        for n in names
        if n in summary
    ]


def window_of(summary: Mapping[str, Any]) -> str:
    """Return the steady window of a summary as text; "" without one."""
    for unit in ("deg", "mm"):
        if f"window_from_{unit}" in summary:
            other, factor = shown(unit)
            low, high = (factor * summary[f"window_{end}_{unit}"] for end in ("from", "to"))
            return f"{low:.3g}-{high:.3g}{after(other)}"
    return ""


def with_unit(key: str, value: Any) -> str:
    """Return a value of ``summary.json`` with the unit at the end of its name, as shown."""
    if isinstance(value, float):
        factor, unit = (100.0, "%") if key.endswith("_rel") else (1.0, unit_of(key))
        return number_with_unit(factor * value, unit)
    return f"{value:,}{after(unit_of(key))}" if type(value) is int else str(value)


def said_of(key: str, figures: Mapping[str, Any]) -> str:
    """Return one of some values with its unit, a mean also with its ±.

    Examples
    --------
    >>> said_of("force_plateau_N", {"force_plateau_N": 3.2, "force_plateau_half_width_N": 0.012})
    '3.2 ± 0.012 N'
    """
    half_width = figures.get(half_width_of(key))
    if half_width is None:
        return with_unit(key, figures[key])
    return number_with_unit(figures[key], unit_of(key), half_width)


def unit_of(key: str) -> str:
    """Return the unit at the end of a value's name; "" for a pure number."""
    return _UNITS.get(_ending(key), "")


def _ending(key: str) -> str:
    return next((ending for ending in _UNITS if key.endswith(ending)), "")


def figure_name(name: str, figures: Mapping[str, Any]) -> str:
    """Return the full name of a value, which may be given without its unit or in a report's words.

    Raises ValueError if no value that is a number has this name.

    Examples
    --------
    >>> figure_name("torque_peak", {"torque_peak_at_deg": 76.4, "torque_peak_Nmm": 202.3})
    'torque_peak_Nmm'
    >>> figure_name("loose pieces", {"n_loose": 1}), figure_name("flaps", {"n_flap": 4})
    ('n_loose', 'n_flap')
    """
    numbers = sorted(key for key, value in figures.items() if isinstance(value, int | float))
    spelled = {word: key for key in numbers for word in _spellings(key)}
    if (asked := _plain(name)) in spelled:
        return spelled[asked]
    close = difflib.get_close_matches(asked, spelled, n=1)
    hint = f"; did you mean {spelled[close[0]]}?" if close else listed(numbers)
    raise ValueError(f"there is no value {name}{hint}")


def known_figure(name: str, more: Iterable[str] = ()) -> str:
    """Return the full name of a value that runs may have, or one of ``more``.

    Raises ValueError if there is none.
    """
    first = re.sub(r"_\d+(?=_|$)", "_1", name)
    known = (*LABELS, *_ELSEWHERE, *_OF_TEETH, *more)
    full = figure_name(first, dict.fromkeys(known, 0.0)) if name else ""
    return full if first == name else name + full[len(first) :]


def _spellings(key: str) -> set[str]:
    """Return a value's name, that without its unit, and its words in the reports."""
    bare = key.removesuffix(_ending(key))
    words = {key, bare, label_of(key, ""), OF_THE_CUT.get(key, "")}
    if key.startswith("n_"):
        words.add(f"{bare.removeprefix('n_')}s")  # what is counted: flaps, bridges
    return {_plain(one) for one in words if one}


def _plain(name: str) -> str:
    return name.casefold().replace("_", " ").strip()


def label_of(key: str, window: str = "the steady window") -> str:
    """Return the label of a value; ``window`` says over what a mean is taken."""
    if key in LABELS:
        return LABELS[key].format(window=window)
    return key.removesuffix(_ending(key)).removeprefix("n_").replace("_", " ")


# --- values of a run ------------------------------------------------------------------------------


def run_figures(
    history: Mapping[str, Floats],
    coordinate: tuple[str, str],
    resistance: tuple[str, str],
    end: Mapping[str, float] | None = None,
    splits: Iterable[SplitRecord] = (),
) -> dict[str, float | str]:
    """Return the values by their names in ``summary.json``; those not finite are left out.

    Coordinate and resistance are name and unit; ``end`` has the history's columns at the end of the
    run, by default its last row.
    """
    end = end or {name: float(column[-1]) for name, column in history.items()}
    x, x_unit = coordinate
    figures = {
        f"{x}_end_{x_unit}": end[x],
        **energy_figures(end),
        **{f"{name}_Nmm": end[name] for name in _OF_CABLES if name in end},
        **relative_figures(history),
        "crack_length_mm": end["crack_length"],
        **_extremes(history, coordinate, resistance),
        **_extremes(history, coordinate, ("axial_force", "N")),
        **_piercing(splits),
    }
    counts = {
        f"n_cable_{what}": int(end[f"cables_{what}"])
        for what in ("created", "broken")
        if f"cables_{what}" in end
    }
    finite = {name: value for name, value in figures.items() if isfinite(value)}
    return {**finite, **counts, **steady_figures(history, coordinate, resistance)}


def _piercing(splits: Iterable[SplitRecord]) -> dict[str, float]:
    """Return force, depth and work of the tool as each cutting edge first pierces whole film.

    And the largest delay of these forces, where tips pierce.
    """
    first: dict[int, SplitRecord] = {}
    for record in splits:
        if record.kind == PUNCTURE:
            first.setdefault(record.edge + 1, record)
    figures = (("force", "N"), ("depth", "mm"), ("work", "Nmm"))
    told = {
        f"piercing_{what}_{edge}_{unit}": getattr(record, what)
        for edge, record in sorted(first.items())
        for what, unit in figures
    }
    delay = max((record.delay for record in first.values()), default=0.0)
    return told | ({"piercing_delay_rel": delay} if delay else {})


def _extremes(
    history: Mapping[str, Floats], coordinate: tuple[str, str], resistance: tuple[str, str]
) -> dict[str, float]:
    """Return the least and the largest value, the one of larger magnitude, and where they occurred.

    Nothing if the history has no such column.
    """
    name, unit = resistance
    values = history.get(name, np.zeros(0))
    finite = np.flatnonzero(np.isfinite(values))
    if not finite.size:
        return {}
    low, high = (int(finite[k]) for k in (values[finite].argmin(), values[finite].argmax()))
    peak = max(sorted((low, high)), key=lambda k: abs(float(values[k])))
    rows = {f"{name}_min": low, f"{name}_max": high, f"{name}_peak": peak}
    in_unit, (x, x_unit) = unit.replace("*", ""), coordinate
    sizes = {f"{figure}_{in_unit}": float(values[k]) for figure, k in rows.items()}
    return sizes | {f"{figure}_at_{x_unit}": float(history[x][k]) for figure, k in rows.items()}
