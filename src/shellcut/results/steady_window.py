"""The steady part of a cut, found from the history of its run.

docs/howto/read-results.md says where a cut is steady. Here the conditions are asked of each edge
that cuts, row by row, from the columns of :mod:`shellcut.recording.cut_front`; the window is the
longest stretch in which all hold for all edges. Z is the cut length when an edge's first cable
breaks, its process zone then being full.

Of a length that must reach Z or 2 Z a quarter of a spacing of the joints may be missing, so that
round-off decides nothing on a regular mesh, where all are multiples of half of it. The film ahead
ends at the median over the joints of the last 4 Z. The window begins and ends where the edge that
is the first to meet a cable in it meets one. An edge has stopped if it takes three times its median
travel per millimetre of cut, of cables closer than their mean distance this; it is ignored if it
has cut less than a tenth of the longest cut.

*Without a tool* nothing is met: the window is where the crack grows once its zone is full, from a
third of its last length on, the first third being the way in which the film takes the shape that
tears. Z is the length of crack when its first cable breaks.

*Tested.* Where the cut could be steady, torque or force must be: :mod:`.steady_mean` tests it for a
jump and a drift, then every other mean, and gives each its ±. Each edge must cut 1.5 Z in it, for a
force has a memory of about Z, the length of the cables that the edge drags. A jump within the first
Z is the end of the start: that length is left out, once.

Means are of sums over every step: all rows but the last are written at steps at which cracks are
looked for, and the mean of their torque is up to 0.3 % too large.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from typing import Any, TypeAlias

import numpy as np

from shellcut.arrays import Bools, Floats, Ints

from .energy_account import CABLES, driving_work, growth_shares
from .steady_mean import LEAST, Change, change_in, mean_of, n_cosine

CUT_LENGTH, PROCESS_ZONE = "cut_length_edge_", "process_zone_edge_"
UNCUT_AHEAD, TO_SPARE = "uncut_ahead_edge_", "to_spare_edge_"
"""Start of the column names, before the number of the edge; all in mm."""

INTEGRAL = "_integral"
"""End of the column of a value's integral over the angle in rad or path in mm, the sum over every
step."""

WAY = "way"
"""Name of the coordinate of a film that is torn without a tool."""

_WORDS = {
    "torque_plateau_Nmm": ("torque", "N*mm"),
    "force_plateau_N": ("force", "N"),
    "axial_force_plateau_N": ("axial force", "N"),
    "dWcoh_dtheta_Nmm": ("cables' work per radian", "N*mm"),
    "dWcoh_ds_N": ("cables' work per mm", "N"),
    "dW_dtheta_Nmm": ("tool's work per radian", "N*mm"),
    "dW_ds_N": ("work put in per mm", "N"),
}
"""Of each mean that there may be, what it is of, and its unit."""

_RENEWED = 2.0  # cut length over Z
_JUDGED = 4.0  # cut over which the film ahead is judged, over Z
_SHORT = 0.25  # what may be missing of either length, over the spacing of the joints
_STOPPED = 3.0  # travel per millimetre of cut over the median
_BYSTANDER = 0.1  # relative to the longest cut
_UP_TO_SPEED = 0.95  # relative to the median speed
_TORN = 1.0 / 3.0  # of the last crack length, without a tool
_ROUND_OFF = 1e-10  # of lengths, over that of the cut


@dataclass(frozen=True)
class SteadyWindow:
    """Range of steady cutting, or the reason why there is none."""

    low: float = float("nan")
    high: float = float("nan")
    """Ends, in the unit of the coordinate; nan without a window."""
    first: int = 0
    last: int = -1
    """First and last row of the history in the window."""
    pieces: float = 0.0
    """Cut within it over Z, of the edge of which that is least."""
    reason: str = ""
    """Why there is no window; empty if there is one."""

    def __bool__(self) -> bool:
        """Whether there is a window."""
        return not self.reason

    def text(self, unit: str) -> str:
        """Return the window in words, with the unit of the coordinate."""
        if self.reason:
            return f"none: {self.reason}"
        return f"{self.low:.3g} to {self.high:.3g} {unit}"


Range: TypeAlias = tuple[float, float]
"""Ends of a range, in the unit of the coordinate."""


def half_width_of(figure: str) -> str:
    """Return the name of the half-width of a mean's 95 % interval.

    Examples
    --------
    >>> half_width_of("torque_plateau_Nmm")
    'torque_plateau_half_width_Nmm'
    """
    name, _, unit = figure.rpartition("_")
    return f"{name}_half_width_{unit}"


def no_mean_of(figure: str) -> str:
    """Return the name of the reason why there is no such mean, though there is a steady window.

    Examples
    --------
    >>> no_mean_of("axial_force_plateau_N")
    'no_axial_force_plateau'
    """
    return f"no_{figure.rpartition('_')[0]}"


def without_means(figures: Mapping[str, Any]) -> dict[str, Any]:
    """Return some values without the means among them, and without the reasons for their lack."""
    means = {name for name in figures if half_width_of(name) in figures}
    means |= {half_width_of(name) for name in means}
    return {
        name: value
        for name, value in figures.items()
        if name not in means and not (name.startswith("no_") and isinstance(value, str))
    }


def steady_figures(
    history: Mapping[str, Floats],
    coordinate: tuple[str, str],
    resistance: tuple[str, str],
    between: Range | None = None,
) -> dict[str, float | str]:
    """Return the values of a run in its steady window, by names that include the units.

    These are the window, the mean of the resistance (and of the axial force), the work of cables
    and of tool or supports per radian or millimetre, each with its half-width
    (:func:`half_width_of`), and what that work has become there; or ``no_window``, why there is
    none. A mean of what jumps or drifts in the window is replaced by the reason
    (:func:`no_mean_of`). ``between`` as of :func:`steady_window`.
    """
    window = steady_window(history, coordinate, between)
    if not window:
        return {"no_window": window.reason}
    (_, x_unit), (name, unit) = coordinate, resistance
    work = driving_work(history)
    units = {name: unit.replace("*", ""), "axial_force": "N"}
    sums = {figure: history[figure + INTEGRAL] for figure in units if figure + INTEGRAL in history}
    if "axial_force" not in history and name not in sums:  # all work is that of the one figure
        sums = {name: work}
    per = "dtheta_Nmm" if x_unit == "deg" else "ds_N"
    means = {f"{one}_plateau_{units[one]}": column for one, column in sums.items()}
    means |= {f"dWcoh_{per}": CABLES.of(history), f"dW_{per}": work}
    rows = slice(window.first, window.last + 1)
    way, figures = _way(history, coordinate)[rows], dict[str, float | str]()
    figures[f"window_from_{x_unit}"], figures[f"window_to_{x_unit}"] = window.low, window.high
    for figure, column in means.items():
        # Each on its own: a torque may be steady while the axial force drifts.
        if change := change_in(way, column[rows], window.pieces):
            words, of = _WORDS[figure]
            ends = window.low, window.high
            figures[no_mean_of(figure)] = _said(change, words, of, coordinate, ends)
            continue
        mean = mean_of(way, column[rows], window.pieces)
        figures[figure], figures[half_width_of(figure)] = mean.value, mean.half_width
    return figures | growth_shares(history, window.first, window.last)


def steady_window(
    history: Mapping[str, Floats], coordinate: tuple[str, str], between: Range | None = None
) -> SteadyWindow:
    """Return the steady window of a run, also of one in progress, or a killed one.

    It follows from the columns of the history, and name and unit of the coordinate. With
    ``between`` it is the part of it in this range of the coordinate, up to a row, or none: the
    window that several runs have in common.
    """
    find = _torn if coordinate[0] == WAY else _cut
    try:
        cuts, first, last = find(history, coordinate, between)
        return _tested(history, coordinate, cuts, first, last, from_start=between is None)
    except _NoWindow as why:
        return SteadyWindow(reason=str(why))


class _NoWindow(Exception):
    """There is no steady window; it says why."""


def _tested(
    history: Mapping[str, Floats],
    coordinate: tuple[str, str],
    cuts: Sequence[_Cut],
    first: int,
    last: int,
    *,
    from_start: bool,
) -> SteadyWindow:
    """Return these rows as a window if torque or force is steady in them.

    ``from_start`` : whether a transient may be left out at the beginning.
    """
    (name, unit), way, rows = coordinate, _way(history, coordinate), slice(first, last + 1)
    x = history[name]
    done = [float(cut.length[last] - cut.length[first]) for cut in cuts]
    each = zip(done, cuts, strict=True)
    pieces, k = min((one / cut.zone, k) for k, (one, cut) in enumerate(each))
    if n_cosine(pieces) < LEAST:
        raise _NoWindow(
            f"it would only last from {x[first]:.3g} to {x[last]:.3g} {unit}, in which "
            f"{cuts[k].name} cuts {done[k]:.3g} mm; a mean with its ± takes "
            f"{0.5 * LEAST * cuts[k].zone:.3g} mm, {0.5 * LEAST:g} process zones"
        )
    if not x[last] > x[first]:
        raise _NoWindow("the tool does not move along the film")
    sums = (history.get(f"{figure}{INTEGRAL}") for figure in ("torque", "force"))
    work = next((column for column in sums if column is not None), driving_work(history))
    change = change_in(way[rows], work[rows], pieces)
    if change is None:
        return SteadyWindow(float(x[first]), float(x[last]), first, last, pieces)
    later = max(cut.after_zone(first) for cut in cuts)
    if from_start and change.at is not None and later < last and change.at <= way[later]:
        with suppress(_NoWindow):
            return _tested(history, coordinate, cuts, later, last, from_start=False)
    name, of = ("torque", "N*mm") if unit == "deg" else ("force", "N")
    raise _NoWindow(_said(change, name, of, coordinate, (float(x[first]), float(x[last]))))


def _said(
    change: Change, name: str, of: str, coordinate: tuple[str, str], ends: tuple[float, float]
) -> str:
    """Return a change in words, its place being in rad or mm as of :func:`_way`."""
    if coordinate[1] == "deg" and change.at is not None:
        change = replace(change, at=float(np.degrees(change.at)))
    return change.text(name, of, ends, coordinate[1])


def _way(history: Mapping[str, Floats], coordinate: tuple[str, str]) -> Floats:
    """Return the coordinate in rad or mm, shape (n_row,)."""
    x = history[coordinate[0]]
    return np.radians(x) if coordinate[1] == "deg" else x


def _within(x: Floats, between: Range | None) -> Bools:
    low, high = between or (-np.inf, np.inf)
    return np.asarray((x >= low) & (x <= high))


def _cut(
    history: Mapping[str, Floats], coordinate: tuple[str, str], between: Range | None
) -> tuple[list[_Cut], int, int]:
    """Return the cuts, and the first and last row in which those of a tool could be steady."""
    cuts = _cuts(history)
    name, unit = coordinate
    x, time = history[name], history["time"]
    renewed = np.all([cut.renewed for cut in cuts], axis=0)
    free = np.all([cut.free for cut in cuts], axis=0)
    cutting = np.all([cut.cutting(x) for cut in cuts], axis=0)
    speed = np.append(0.0, np.diff(x) / np.diff(time))
    usual = np.median(speed[speed > 0.0]) if (speed > 0.0).any() else np.inf
    up_to_speed = np.maximum.accumulate(speed) >= _UP_TO_SPEED * usual
    good = renewed & free & cutting & up_to_speed & _within(x, between)
    change = np.diff(good.astype(int), prepend=0, append=0)
    begins, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1) - 1
    if not begins.size:
        raise _NoWindow(_why_none(cuts, x, unit, renewed, free))
    longest = int(np.argmax(x[ends] - x[begins]))
    first, last = int(begins[longest]), int(ends[longest])
    if between is None:
        within = [c.joints[(c.joints >= first) & (c.joints <= last)] for c in cuts]
        joints = min(within, key=lambda one: one[:1].tolist() or [last + 1])
        first, last = (int(joints[0]), int(joints[-1])) if len(joints) else (first, first)
    return cuts, first, last


def _torn(
    history: Mapping[str, Floats], coordinate: tuple[str, str], between: Range | None
) -> tuple[list[_Cut], int, int]:
    """Return the same for the tear of a film without a tool."""
    crack, broken = history["crack_length"], history["cables_broken"] > 0.0
    if not crack[-1] > 0.0:
        raise _NoWindow("nothing was torn")
    if not broken.any():
        raise _NoWindow("no cable has broken")
    nothing = np.zeros(len(crack))
    tear = _Cut(0, crack, nothing, nothing, float(crack[np.argmax(broken)]))
    full = broken & (crack >= _TORN * crack[-1]) & _within(history[coordinate[0]], between)
    rows = tear.joints[full[tear.joints]] if between is None else np.flatnonzero(full)
    if not len(rows):
        raise _NoWindow("the crack hardly grew after its first cable had broken")
    return [tear], int(rows[0]), int(rows[-1])


@dataclass(frozen=True, eq=False)
class _Cut:
    """Progress of one edge's cut, row by row; of a tear without edges it has the number 0."""

    edge: int
    length: Floats
    ahead: Floats
    spare: Floats
    zone: float
    """Z [mm]; infinite if no cable has broken."""

    @property
    def name(self) -> str:
        return f"cutting edge {self.edge}" if self.edge else "the tear"

    def after_zone(self, row: int) -> int:
        """Return the row by which it has cut Z more than in another."""
        return int(np.searchsorted(self.length, self.length[row] + self.zone - self.short))

    @property
    def short(self) -> float:
        """Of a length that still counts as reached [mm]."""
        return _SHORT * float(np.median(np.diff(self.length[self.joints], prepend=0.0)))

    @property
    def renewed(self) -> Bools:
        return np.asarray(self.length >= _RENEWED * self.zone - self.short)

    @property
    def free(self) -> Bools:
        met = self.length[self.joints]
        ends = met + self.ahead[self.joints]
        since = np.searchsorted(met, met - _JUDGED * self.zone)
        reach = np.array([np.median(ends[i : k + 1]) for k, i in enumerate(since.tolist())])
        left = np.append(0.0, reach - met)
        n_met = np.searchsorted(self.joints, np.arange(len(self.length)), side="right")
        return (left[n_met] >= self.zone - self.short) & (self.ahead > 0.0)

    @property
    def joints(self) -> Ints:
        """Rows in which a cable has been met."""
        return np.flatnonzero(np.diff(self.length, prepend=0.0) > _ROUND_OFF * self.length[-1])

    def cutting(self, x: Floats) -> Bools:
        joints = self.joints
        if len(joints) < 2:
            return np.zeros(len(x), np.bool_)
        # A wait for one of several cables that lie close together is no stop: on an irregular mesh
        # such waits differ by much.
        grown = np.diff(self.length[joints])
        grown = np.maximum(grown, grown.mean())
        slowness = np.diff(x[joints]) / grown
        slow = _STOPPED * float(np.median(slowness))
        # At the end of the run, the next cable has not been met yet.
        slowness = np.append(slowness, (x[-1] - x[joints[-1]]) / grown[-1])
        # A row in which a cable is met belongs to the interval before.
        before = np.searchsorted(joints, np.arange(len(x))) - 1
        goes_on = (before >= 0) & (slowness[np.maximum(before, 0)] <= slow)
        return np.asarray(goes_on & (self.spare > _ROUND_OFF * self.length[-1]))


def _cuts(history: Mapping[str, Floats]) -> list[_Cut]:
    """Return the cuts to consider."""
    edges = [name.removeprefix(CUT_LENGTH) for name in history if name.startswith(CUT_LENGTH)]
    if not edges:
        raise _NoWindow("the history has no cut length, as of a tool without cutting edges")
    longest = max(float(history[CUT_LENGTH + edge].max(initial=0.0)) for edge in edges)
    if longest == 0.0:
        raise _NoWindow("no cable was bent around a cutting edge")
    cuts = []
    for edge in edges:
        length = history[CUT_LENGTH + edge]
        if length[-1] < _BYSTANDER * longest:
            continue
        broken = length - history[PROCESS_ZONE + edge] > _ROUND_OFF * longest
        zone = float(length[np.argmax(broken)]) if broken.any() else float("inf")
        ahead, spare = history[UNCUT_AHEAD + edge], history[TO_SPARE + edge]
        cuts.append(_Cut(int(edge), length, ahead, spare, zone))
    return cuts


def _why_none(cuts: list[_Cut], x: Floats, unit: str, renewed: Bools, free: Bools) -> str:
    """Return the first condition that is met nowhere."""
    for cut in cuts:
        if not cut.renewed.any():
            done = f"cutting edge {cut.edge} has cut {cut.length[-1]:.3g} mm"
            if np.isinf(cut.zone):
                return f"{done}, and none of its cables has broken"
            return f"{done}; its process zone is renewed only after {_RENEWED * cut.zone:.3g} mm"
    start = int(np.argmax(renewed))
    if not renewed.any():
        return "the edges were never in the film together"
    if not (renewed & free).any():
        cut = min(cuts, key=lambda c: float(c.ahead[start]))
        return (
            f"when the process zones had been renewed, at {x[start]:.3g} {unit}, cutting edge "
            f"{cut.edge} had {cut.ahead[start]:.3g} mm to go to the next cut or the film's edge"
        )
    return f"a cutting edge had left the film, or stopped, before {x[start]:.3g} {unit}"
