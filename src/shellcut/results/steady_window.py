"""The steady part of a cut, found from the history of its run.

docs/howto/read-results.md says where a cut is steady. Here the conditions are asked of each edge
that cuts, row by row, from the columns of :mod:`shellcut.recording.cut_front`; the window is the
longest stretch in which all hold for all edges. Z is the cut length when an edge's first cable
breaks, its process zone then being full.

Of a length that must reach Z or 2 Z a quarter of a spacing of the joints may be missing, so that
round-off decides nothing on a regular mesh, where all are multiples of half of it. The film ahead
ends at the median over the joints of the last 4 Z. The window has whole periods of the edge that is
the first to meet a cable in it, which must cut half of Z there: what is true of less is true of
some cables, not of the cut. An edge has stopped if it takes three times its median travel per
millimetre of cut, and is ignored if it has cut less than a tenth of the longest cut.

*Without a tool* nothing is met: the window is where the crack grows once its zone is full, from a
third of its last length on, the first third being the way in which the film takes the shape that
tears.

Means are of sums over every step: all rows but the last are written at steps at which cracks are
looked for, and the mean of their torque is up to 0.3 % too large.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Floats, Ints
from shellcut.formats.errors import counted

from .energy_account import CABLES, driving_work, growth_shares

CUT_LENGTH, PROCESS_ZONE = "cut_length_edge_", "process_zone_edge_"
UNCUT_AHEAD, TO_SPARE = "uncut_ahead_edge_", "to_spare_edge_"
"""Start of the column names, before the number of the edge; all in mm."""

INTEGRAL = "_integral"
"""End of the column of a figure's integral over the angle in rad or way in mm, the sum over every
step."""

WAY = "way"
"""Name of the coordinate of a film that is torn without a tool."""

_RENEWED = 2.0  # cut length over Z
_JUDGED = 4.0  # cut over which the film ahead is judged, over Z
_SHORT = 0.25  # what may be missing of either length, over the spacing of the joints
_STOPPED = 3.0  # travel per millimetre of cut over the median
_BYSTANDER = 0.1  # relative to the longest cut
_UP_TO_SPEED = 0.95  # relative to the median speed
_LEAST_PERIODS = 2
_LEAST = 0.5  # cut in the window over Z
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


def steady_figures(
    history: Mapping[str, Floats], coordinate: tuple[str, str], resistance: tuple[str, str]
) -> dict[str, float | str]:
    """Return the figures of a run in its steady window, by names that include the units.

    These are the window, the mean of the resistance (and of the axial force), the work of cables
    and of tool or supports per radian or millimetre, and what that work has become there; or
    ``no_window``, why there is none.
    """
    window = steady_window(history, coordinate)
    if not window:
        return {"no_window": window.reason}
    (x_name, x_unit), (name, unit) = coordinate, resistance
    turns = x_unit == "deg"

    def grown(column: Floats) -> float:
        return float(column[window.last] - column[window.first])

    work = driving_work(history)
    units = {name: unit.replace("*", ""), "axial_force": "N"}
    sums = {figure: history[figure + INTEGRAL] for figure in units if figure + INTEGRAL in history}
    if "axial_force" not in history and name not in sums:  # all work is that of the one figure
        sums = {name: work}
    way = np.radians(history[x_name]) if turns else history[x_name]
    length, done, cables = map(grown, (way, work, CABLES.of(history)))
    per = "dtheta_Nmm" if turns else "ds_N"
    figures: dict[str, float | str] = {
        f"window_from_{x_unit}": window.low,
        f"window_to_{x_unit}": window.high,
        **{f"{one}_plateau_{units[one]}": grown(column) / length for one, column in sums.items()},
        f"dWcoh_{per}": cables / length,
        f"dW_{per}": done / length,
    }
    return figures | growth_shares(history, window.first, window.last)


def steady_window(history: Mapping[str, Floats], coordinate: tuple[str, str]) -> SteadyWindow:
    """Return the steady window of a run, also of one in progress, or a killed one.

    It follows from the columns of the history, and name and unit of the coordinate.
    """
    if coordinate[0] == WAY:
        return _torn(history, coordinate)
    cuts = _cuts(history)
    if isinstance(cuts, str):
        return SteadyWindow(reason=cuts)
    name, unit = coordinate
    x, time = history[name], history["time"]
    renewed = np.all([cut.renewed for cut in cuts], axis=0)
    free = np.all([cut.free for cut in cuts], axis=0)
    cutting = np.all([cut.cutting(x) for cut in cuts], axis=0)
    first, last = _longest(x, renewed & free & cutting & _up_to_speed(x, time))
    if first < 0:
        return SteadyWindow(reason=_why_none(cuts, x, unit, renewed, free))
    within = [(c, c.joints[(c.joints >= first) & (c.joints <= last)]) for c in cuts]
    cut, joints = min(within, key=lambda one: one[1][:1].tolist() or [last + 1])
    done = float(np.ptp(cut.length[joints])) if len(joints) else 0.0
    if len(joints) <= _LEAST_PERIODS or done < _LEAST * cut.zone - cut.short:
        return SteadyWindow(
            reason=f"it would only last from {x[first]:.3g} to {x[last]:.3g} {unit}, in which "
            f"cutting edge {cut.edge} cuts {done:.3g} mm; its process zone is {cut.zone:.3g} mm"
        )
    low, high = int(joints[0]), int(joints[-1])
    if not x[high] > x[low]:
        return SteadyWindow(reason="the tool does not move along the film")
    return SteadyWindow(float(x[low]), float(x[high]), low, high)


def _torn(history: Mapping[str, Floats], coordinate: tuple[str, str]) -> SteadyWindow:
    """Return the steady window of a film that is torn without a tool."""
    crack, x = history["crack_length"], history[coordinate[0]]
    if not crack[-1] > 0.0:
        return SteadyWindow(reason="nothing was torn")
    grown = np.flatnonzero(np.diff(crack, prepend=0.0) > _ROUND_OFF * crack[-1])
    full = (history["cables_broken"][grown] > 0.0) & (crack[grown] >= _TORN * crack[-1])
    within = grown[full]
    if len(within) <= _LEAST_PERIODS:
        return SteadyWindow(
            reason=f"the crack grew in {counted(len(grown), 'row')} of the history only"
        )
    first, last = int(within[0]), int(within[-1])
    return SteadyWindow(float(x[first]), float(x[last]), first, last)


@dataclass(frozen=True, eq=False)
class _Cut:
    """Progress of one edge's cut, row by row."""

    edge: int
    length: Floats
    ahead: Floats
    spare: Floats
    zone: float
    """Z [mm]; infinite if no cable has broken."""

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
        grown = np.diff(self.length[joints])
        slowness = np.diff(x[joints]) / grown
        slow = _STOPPED * float(np.median(slowness))
        # At the end of the run, the next cable has not been met yet.
        slowness = np.append(slowness, (x[-1] - x[joints[-1]]) / grown[-1])
        # A row in which a cable is met belongs to the interval before.
        before = np.searchsorted(joints, np.arange(len(x))) - 1
        goes_on = (before >= 0) & (slowness[np.maximum(before, 0)] <= slow)
        return np.asarray(goes_on & (self.spare > _ROUND_OFF * self.length[-1]))


def _cuts(history: Mapping[str, Floats]) -> list[_Cut] | str:
    """Return the cuts to consider, or why there are none."""
    edges = [name.removeprefix(CUT_LENGTH) for name in history if name.startswith(CUT_LENGTH)]
    if not edges:
        return "the history lacks the cut length of each cutting edge"
    longest = max(float(history[CUT_LENGTH + edge].max(initial=0.0)) for edge in edges)
    if longest == 0.0:
        return "no cable was bent around a cutting edge"
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


def _up_to_speed(x: Floats, time: Floats) -> Bools:
    """Return the rows after the start-up ramp."""
    speed = np.append(0.0, np.diff(x) / np.diff(time))
    moving = speed[speed > 0.0]
    usual = np.median(moving) if moving.size else np.inf
    return np.asarray(np.maximum.accumulate(speed) >= _UP_TO_SPEED * usual)


def _longest(x: Floats, good: Bools) -> tuple[int, int]:
    """Return the first and last row of the longest stretch, -1 if there is none."""
    change = np.diff(good.astype(int), prepend=0, append=0)
    begins, ends = np.flatnonzero(change == 1), np.flatnonzero(change == -1) - 1
    if not begins.size:
        return -1, -1
    k = int(np.argmax(x[ends] - x[begins]))
    return int(begins[k]), int(ends[k])


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
