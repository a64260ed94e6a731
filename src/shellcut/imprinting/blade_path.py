"""The path of a tool's cutting edges through a flat film, from the tool and its motion.

The path consists of all points at which edges pass through the film's plane
(:mod:`~shellcut.imprinting.crossings`). An edge that passes through one point at a time, one that
comes down flat, and one that enters or leaves are all treated alike.

If the points lie on a straight line or a circle to 0.005 edge lengths, the path is that line or
circle, and stretches of one circle (one line) cut by several teeth are joined. Otherwise it is the
spline through points half an edge length apart. The path is extended at both ends, because the
crack runs beyond the blade. A blade that cuts only a short stretch determines its circle poorly, or
seems to go straight; but an edge that stays in a cylinder perpendicular to the film, like teeth on
a screw, cuts the trace of that cylinder, and the whole edge over its whole motion determines it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats
from shellcut.cables.cohesive_law import CohesiveLaw
from shellcut.cables.crack_lead import crack_lead
from shellcut.mesh.mesh import Mesh
from shellcut.tool.motion import Motion
from shellcut.tool.tool import Tool

from .crossings import Crossings, Stretch
from .film_plane import FilmPlane, ImprintError
from .path_curve import PathCurve

N_TIME = 400
"""Number of equal time intervals at which the edges are sampled."""

FIT = 5e-3
"""Points this close to a line or circle (in edge lengths) lie on it."""

JOINED = 6.0
"""Stretches of one line or circle closer together than this (in edge lengths) are one path."""

_ENOUGH_VERTICES = 5  # vertex crossings that determine a circle without those of chords between


def blade_path(
    tool: Tool,
    motion: Motion,
    mesh: Mesh,
    duration: float,
    *,
    law: CohesiveLaw | None = None,
    ahead: float | None = None,
    behind: float | None = None,
    n_time: int = N_TIME,
) -> list[PathCurve]:
    """Return the curves in space where cutting edges pass through the film's mid-surface.

    Parameters
    ----------
    tool : Tool
    motion : Motion
    mesh : Mesh
        Flat; the film in its reference state.
    duration : float
        End of the motion that counts [s]; it starts at t = 0.
    law : CohesiveLaw, optional
        Law of the cables, which sets how far cracks run ahead; by default the paper's.
    ahead, behind : float, optional
        Extension of the path beyond the blade's last place, and behind its first, or behind its
        body where that presses on the film behind the edge [mm]: the ``leads`` of the curves. By
        default :func:`~shellcut.cables.crack_lead.crack_lead`.
    n_time : int
        Number of time steps sampled.

    Raises
    ------
    ImprintError
        If the film is not flat or no edge passes through its plane.

    Examples
    --------
    >>> from shellcut import StraightMotion
    >>> from shellcut.mesh.structured import rectangle
    >>> from shellcut.tool.shapes import straight_blade
    >>> blade = straight_blade(length=4.0, height=3.0)
    >>> motion = StraightMotion((1.0, 0.0, 0.0), speed=6000.0)
    >>> len(blade_path(blade, motion, rectangle(12.0, 8.0, size=0.8), duration=1e-3))
    1
    """
    lead = crack_lead(tool, law)
    ahead, behind = lead if ahead is None else ahead, lead if behind is None else behind
    film = FilmPlane(mesh)
    h = float(np.median(film.edge_length))
    crossings = Crossings(film, tool, motion, np.linspace(0.0, duration, n_time + 1))
    found: list[_Line | _Arc | PathCurve] = []
    for chain in range(tool.n_chain):
        stretches, swept = crossings.of_chain(chain)
        for stretch in stretches:
            if _extent(stretch.points) > h:
                leads = _Leads(behind + crossings.body_behind(stretch), ahead)
                found.append(_simplest(stretch, swept, h, leads))
    if not found:
        raise ImprintError(
            f"a cutting edge must pass through the film's plane and move in it by an edge of the "
            f"mesh, here {h:.2g} mm, got none that does from t = 0 to {duration:g} s; check the "
            "tool's position, the motion and its duration"
        )
    lines = _joined_lines([c for c in found if isinstance(c, _Line)], h)
    arcs = _joined_arcs([c for c in found if isinstance(c, _Arc)], h)
    splines = [c for c in found if isinstance(c, PathCurve)]
    return [c.mapped(film.lift) for c in (*lines, *arcs, *splines)]


# --- what the points lie on ----------------------------------------------------------------------


class _Leads(NamedTuple):
    before: float  # [mm] for a line or spline, [rad] for an arc
    after: float


class _Span(NamedTuple):
    # range that the blade cuts, and the extensions of the path
    start: float
    end: float
    leads: _Leads

    @property
    def low(self) -> float:
        return self.start - self.leads.before

    @property
    def high(self) -> float:
        return self.end + self.leads.after

    def turned(self) -> _Span:
        return _Span(-self.end, -self.start, _Leads(self.leads.after, self.leads.before))

    def shifted(self, by: float) -> _Span:
        return _Span(self.start + by, self.end + by, self.leads)

    def joined(self, other: _Span) -> _Span:
        start, end = min(self.start, other.start), max(self.end, other.end)
        low, high = min(self.low, other.low), max(self.high, other.high)
        return _Span(start, end, _Leads(start - low, high - end))


@dataclass(frozen=True, eq=False)
class _Line:
    origin: Floats  # foot of the plane's origin
    way: Floats
    span: _Span

    def off(self, x: Floats) -> float:
        across = np.array([-self.way[1], self.way[0]])
        return float(np.abs((x - self.origin) @ across).max())


@dataclass(frozen=True, eq=False)
class _Arc:
    centre: Floats
    radius: float
    span: _Span  # [rad]; end - start in (0, 2 pi]
    backward: bool  # whether the blade came from the end

    def off(self, x: Floats) -> float:
        return float(np.abs(np.linalg.norm(x - self.centre, axis=1) - self.radius).max())

    def led_on(self, leads: _Leads) -> _Arc:
        before, after = (lead / self.radius for lead in (leads[::-1] if self.backward else leads))
        return replace(self, span=self.span._replace(leads=_Leads(before, after)))


def _extent(x: Floats) -> float:
    return float(np.linalg.norm(np.ptp(x, axis=0)))


def _simplest(stretch: Stretch, swept: Floats, h: float, leads: _Leads) -> _Line | _Arc | PathCurve:
    x, is_vertex = stretch.points, stretch.is_vertex
    enough = is_vertex.sum() >= _ENOUGH_VERTICES
    if not enough and _on_cylinder(swept, h):
        arc = _arc(x, swept)
        if arc.off(x) <= FIT * h:
            return arc.led_on(leads)
    line = _line(x)
    if line.off(x) <= FIT * h:
        return replace(line, span=line.span._replace(leads=leads))
    # vertices of a polygon lie on the true edge, points between them on its chords
    arc = _arc(x, x[is_vertex] if enough else x)
    if arc.off(x) <= FIT * h:
        return arc.led_on(leads)
    return _spline(x, h, leads)


def _on_cylinder(swept: Floats, h: float) -> bool:
    # whether an edge stays in a circle, seen from above, and not in a line
    return _line(swept).off(swept) > FIT * h and _arc(swept, swept).off(swept) <= FIT * h


def _line(x: Floats) -> _Line:
    middle = x.mean(axis=0)
    way = np.linalg.svd(x - middle, full_matrices=False)[2][0]
    # towards later times
    way = way if way @ (x[-1] - x[0]) >= 0.0 else -way
    origin = middle - (middle @ way) * way
    along = x @ way
    return _Line(origin, way, _Span(float(along.min()), float(along.max()), _Leads(0.0, 0.0)))


def _arc(x: Floats, on_it: Floats) -> _Arc:
    # least squares of |x|² = 2 c.x + (r² - c²), about the mean for round-off
    middle = on_it.mean(axis=0)
    y = on_it - middle
    A = np.column_stack([2.0 * y, np.ones(len(y))])
    solution = np.linalg.lstsq(A, (y * y).sum(axis=1), rcond=None)[0]
    centre = middle + solution[:2]
    radius = float(np.sqrt(max(solution[2] + solution[:2] @ solution[:2], 0.0)))
    angle = np.unwrap(np.arctan2(*(x - centre).T[::-1]))
    start, end = float(angle.min()), float(angle.max())
    backward = bool(angle[-1] < angle[0])
    span = _Span(start, min(end, start + 2.0 * np.pi), _Leads(0.0, 0.0))
    return _Arc(centre, radius, span, backward)


def _spline(x: Floats, h: float, leads: _Leads) -> PathCurve:
    kept = [0]
    for k in range(1, len(x)):
        if np.linalg.norm(x[k] - x[kept[-1]]) >= 0.5 * h:
            kept.append(k)
    points = x[kept]
    if len(points) > 8:
        # back at its start, in its own direction: closed
        away = np.linalg.norm(points - points[0], axis=1)
        left = int(np.argmax(away > 2.0 * h))
        back = np.flatnonzero(away[left:] < 0.6 * h)
        if len(back):
            end = left + int(back[0])
            way = points[1] - points[0]
            off = (points[end] - points[0]) @ np.array([-way[1], way[0]]) / np.linalg.norm(way)
            if abs(off) < 0.05 * h:
                return PathCurve.through(points[:end], closed=True)
    curve = PathCurve.through(points)
    before = curve.point(-np.arange(0.0, leads.before, 0.5 * h)[:0:-1])
    after = curve.point(curve.length + np.arange(0.0, leads.after, 0.5 * h)[1:])
    whole = PathCurve.through(np.concatenate([before, points, after]))
    start, end = whole.knots[[len(before), -1 - len(after)]].tolist()
    return whole.with_leads(start, whole.length - end)


def _joined_lines(lines: list[_Line], h: float) -> list[PathCurve]:
    joined = []
    left = list(lines)
    while left:
        first = left.pop(0)
        across = np.array([-first.way[1], first.way[0]])
        spans = [first.span]
        for line in list(left):
            ends = line.origin + np.outer([line.span.low, line.span.high], line.way)
            if np.abs((ends - first.origin) @ across).max() <= 2.0 * FIT * h:
                left.remove(line)
                span = line.span if line.way @ first.way > 0.0 else line.span.turned()
                spans.append(span.shifted(float((line.origin - first.origin) @ first.way)))
        for span in _union(spans, JOINED * h):
            a, b = (first.origin + s * first.way for s in (span.low, span.high))
            joined.append(PathCurve.line(a.tolist(), b.tolist()).with_leads(*span.leads))
    return joined


def _joined_arcs(arcs: list[_Arc], h: float) -> list[PathCurve]:
    joined = []
    left = list(arcs)
    full = 2.0 * np.pi
    while left:
        group = [left.pop(0)]
        for arc in list(left):
            near = np.linalg.norm(arc.centre - group[0].centre) <= 2.0 * FIT * h
            if near and abs(arc.radius - group[0].radius) <= 2.0 * FIT * h:
                left.remove(arc)
                group.append(arc)
        # the longest stretch determines the circle best
        best = max(group, key=lambda a: a.span.end - a.span.start)
        gap = JOINED * h / best.radius
        spans = [a.span.shifted(-full * np.floor(a.span.low / full)) for a in group]
        # repeat a full turn later, so that stretches across angle 0 meet
        whole = _union([span.shifted(k * full) for span in spans for k in (0, 1)], gap)
        if any(span.high - span.low >= full - gap for span in whole):
            joined.append(_circle(best, 0.0, full))
            continue
        seen: list[float] = []
        for span in whole:
            # of the two copies of a stretch, the complete one
            start = span.low
            if all(abs((start - s + np.pi) % full - np.pi) > gap for s in seen) and start < full:
                seen.append(start)
                before, after = (best.radius * lead for lead in span.leads)
                joined.append(_circle(best, start, span.high).with_leads(before, after))
    return joined


def _circle(arc: _Arc, start: float, end: float) -> PathCurve:
    space = PathCurve.circle(
        (*arc.centre.tolist(), 0.0),
        arc.radius,
        start_deg=float(np.degrees(start)),
        end_deg=float(np.degrees(end)),
    )
    return space.mapped(lambda points: points[:, :2])


def _union(spans: list[_Span], gap: float) -> list[_Span]:
    joined: list[_Span] = []
    for span in sorted(spans, key=lambda span: span.low):
        if joined and span.low - joined[-1].high <= gap:
            joined[-1] = joined[-1].joined(span)
        else:
            joined.append(span)
    return joined
