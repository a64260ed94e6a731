"""A notch: a film is cut along a line before the run."""

from __future__ import annotations

import itertools
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from shellcut.arrays import Floats, cross, norm, product, unit
from shellcut.numerics.small_matrices import least_squares
from shellcut.state import NOTCH, State

from .growth import Growth
from .notch_line import NotchLine, row_at
from .open_edges import boundary_edges
from .quad_polygon import AWAY, WHOLE, ascending
from .ray_ahead import SNAP
from .tip import Place, Tip


class _Crossed(NamedTuple):
    """A side of the border that a line crosses."""

    a: int
    b: int
    """Its nodes, and ..."""
    s: float
    """... the share of the side from a to where it is crossed."""
    at: float
    """How far along the line that is [mm]."""
    height: float
    """Of the line over the side there [mm]."""
    size: float
    """Length of the side [mm]."""
    enters: bool
    """Whether the line leads into the film."""


_place = attrgetter("at")


def cut_notch(growth: Growth, state: State, points: Floats) -> None:
    """Cut the film along a line through points, see :meth:`.Simulation.notch`.

    points : (n, 3) [mm].
    """
    path, film = growth.path, growth.path.film
    line, before = NotchLine(points), len(state.split_log)
    tip = _slit(growth, state, line)
    for start, stop in itertools.pairwise(points):
        # The line may have more than its first point before the border.
        tip = tip or _border_tip(state, start, stop)
        if tip is not None or row_at(state, stop) is not None:
            break
    if tip is None:
        raise ValueError(
            f"a notch must begin within a quad or at the border, but its line from "
            f"{points[0].tolist()} to {stop.tolist()} mm begins on a side of quads or crosses "
            "no side of the border: move its first point"
        )
    going: Tip | None = tip
    at: Place | None = None
    while going is not None and (ahead := film.rows_ahead(going)):
        at = film.place_in(state, *ahead[0])
        here = film.at_tip(going, state.node.X)
        quads = state.node.X[state.quads[[row for row, _ in ahead]]]
        along, lean = line.direction(here, at, quads)
        segment = path.segment_from(state, going, along, lean, growth.tips)
        if segment is None:
            break
        cut = growth.cut(state, segment, NOTCH, 0.0)
        going = growth.tip_after(state, segment, cut, 1, going.heading)
        if going is None:
            break
        there, at_cut = film.at_tip(going, state.node.X), going.flank is not None
        if line.ends(there, cut.length, at_cut=at_cut):
            growth.tips.append(going)
            return
    if len(state.split_log) == before:
        raise ValueError(
            f"a notch must lead into the film, got one at {points[0].tolist()} mm that "
            "leaves it there: move its first point into the film, off the sides of quads"
        )
    further = None if at is None else line.point_ahead(at.size)
    if further is not None and row_at(state, further) is not None:
        raise ValueError(
            f"a notch must be a line that quads can follow, got one from {points[0].tolist()} "
            f"mm that ends after {here.tolist()} mm although its line continues in the film: it "
            "turns too sharply there, or reaches a hole or a cut; take a finer mesh, round "
            "the corner, or notch the rest by itself"
        )


def _slit(growth: Growth, state: State, line: NotchLine) -> Tip | None:
    """Cut the quad in which a notch within the film begins; return the tip where it continues."""
    path, film, found = growth.path, growth.path.film, row_at(state, line.start)
    if found is None or growth.cuts.topology.polygon(found[0]) != WHOLE:
        return None
    row, place = found
    at = film.place_in(state, row, place)
    along, lean = line.direction(line.start, at, state.node.X[state.quads[[row]]])
    back, ahead = (path.segment(state, row, place, w, lean) for w in (-along, along))
    if back is None or ahead is None:
        return None
    cut = growth.through(state, back, ahead, NOTCH)
    if cut is None:
        return None
    behind = growth.tip_after(state, back, cut, 0, -cut.heading)
    if behind is not None:
        growth.tips.append(behind)
    return growth.tip_after(state, ahead, cut, 1, cut.heading)


def _border_tip(state: State, start: Floats, end: Floats) -> Tip | None:
    """Return a tip on the border where a line between two points first crosses it.

    Seen along the film's normal there: on a curved film the line leaves the sheet, and a side
    of the border is crossed from which it is nearer than the side is long. Of several sheets that
    it enters within such a length, that counts which it passes closest by.
    """
    along, crossed = end - start, list[_Crossed]()
    for a, b in boundary_edges(state).tolist():
        A, B = state.node.X[[a, b]]
        size, n = float(norm(A - B)), state.node.t[a] + state.node.t[b]
        n = unit(n)
        in_sheet = np.stack([along, A - B, A - start], axis=1)
        in_sheet -= np.outer(n, product(n, in_sheet))
        base, gap = in_sheet[:, :2], in_sheet[:, 2]
        ahead, s = least_squares(base, gap)
        miss = norm(product(base, (ahead, s)) - gap)
        on_it = miss < AWAY * size and -AWAY < s < 1.0 + AWAY
        height = float(abs(product(A + s * (B - A) - start - ahead * along, n)))
        if on_it and height < size and -AWAY < ahead < 1.0 + AWAY:
            enters = bool(product(cross(n, B - A), along) > 0.0)
            at = float(ahead) * float(norm(along))
            crossed.append(_Crossed(a, b, float(s), at, height, size, enters))
    if not crossed:
        return None
    entered = [one for one in crossed if one.enters] or crossed
    first = min(one.at for one in entered)
    near = [one for one in entered if one.at - first <= one.size]
    least = min(one.height for one in near)
    a, b, s, *_ = min((one for one in near if one.height <= least + AWAY * one.size), key=_place)
    at_end = next((n for n, at in ((a, 0.0), (b, 1.0)) if abs(s - at) < SNAP), None)
    if at_end is not None:
        return Tip((at_end, at_end), 0.0, -1, unit(along))
    a, b, s = ascending(a, b, s)
    return Tip((a, b), s, -1, unit(along))
