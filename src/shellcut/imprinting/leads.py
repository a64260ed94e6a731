"""Extend a path at its ends (leads), as far as the mesh has room.

The crack runs a little beyond the blade at both ends of its path, so the path is extended there
(:mod:`~shellcut.imprinting.blade_path`). These leads are optional: where one would come too close
to a rim, a hole, a pre-crack or another path, it is shortened instead of refused. It ends at the
end of the film: a crack does not continue behind a hole.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from .course import Course, Surroundings
from .edge_line import find_edge_line
from .film_plane import FilmPlane, ImprintError
from .path_curve import PathCurve


def with_room(film: FilmPlane, curves: Sequence[PathCurve]) -> tuple[list[PathCurve], list[str]]:
    """Return the curves with the longest leads that the mesh has room for, and notes.

    Parameters
    ----------
    film : FilmPlane
    curves : sequence of PathCurve
        In the film's plane. A curve on a line of edges, including its leads, keeps them; one
        without room even without leads is returned without, and refused later with the reason.
    """
    surroundings = Surroundings(film)
    fitted: list[PathCurve] = []
    notes: list[str] = []
    curves = [_to_the_rim(surroundings, curve) for curve in curves]
    for i, curve in enumerate(curves):
        if curve.closed or not any(curve.leads) or _is_there(surroundings, curve):
            fitted.append(curve)
            continue
        beside = [
            course
            for other in (*fitted, *(_shortened(c, (0.0, 0.0)) for c in curves[i + 1 :]))
            for course in _courses(surroundings, other) or []
        ]
        fitted.append(_fitted(surroundings, curve, beside))
        notes += _notes(surroundings, curve, fitted[-1])
    return fitted, notes


def _to_the_rim(surroundings: Surroundings, curve: PathCurve) -> PathCurve:
    # leads up to the film's end, and a little beyond its rim
    kept = []
    for lead, at, sense in (
        (curve.leads[0], curve.leads[0], -1.0),
        (curve.leads[1], curve.length - curve.leads[1], 1.0),
    ):
        way = np.linspace(0.0, lead, 2 + int(lead / surroundings.spacing))
        outside = np.flatnonzero(~surroundings.inside(curve.point(at + sense * way)))
        kept.append(float(way[outside[0]]) if len(outside) else lead)
    return _shortened(curve, (kept[0], kept[1]))


def _fitted(surroundings: Surroundings, curve: PathCurve, beside: Sequence[Course]) -> PathCurve:
    # the longest leads first, by steps of an edge
    ladders = []
    for lead, at in zip(curve.leads, (curve.leads[0], curve.length - curve.leads[1]), strict=True):
        h = float(surroundings.size(curve.point(at))[0])
        ladders.append([lead, *(np.arange(np.ceil(lead / h) - 1.0, -1.0, -1.0) * h).tolist()])
    for before, after in sorted(product(*ladders), key=sum, reverse=True):
        candidate = _shortened(curve, (before, after))
        if _has_room(surroundings, candidate, beside):
            return candidate
    return _shortened(curve, (0.0, 0.0))


def _shortened(curve: PathCurve, leads: tuple[float, float]) -> PathCurve:
    if curve.closed or leads == curve.leads:
        return curve
    before, after = (have - keep for have, keep in zip(curve.leads, leads, strict=True))
    return curve.part(before, curve.length - after).with_leads(*leads)


def _courses(surroundings: Surroundings, curve: PathCurve) -> list[Course] | None:
    try:
        return surroundings.courses(curve)
    except ImprintError:
        return None


def _is_there(surroundings: Surroundings, curve: PathCurve) -> bool:
    courses = _courses(surroundings, curve)
    return courses is not None and all(find_edge_line(surroundings.film, c) for c in courses)


def _has_room(surroundings: Surroundings, curve: PathCurve, beside: Sequence[Course]) -> bool:
    try:
        courses = surroundings.courses(curve)
        for course in courses:
            surroundings.check(course)
        surroundings.check_apart(courses, beside)
    except ImprintError:
        return False
    return True


def _notes(surroundings: Surroundings, wanted: PathCurve, curve: PathCurve) -> list[str]:
    notes = []
    for name, lead, kept, at in (
        ("before the start", wanted.leads[0], curve.leads[0], curve.leads[0]),
        ("beyond the end", wanted.leads[1], curve.leads[1], curve.length - curve.leads[1]),
    ):
        place = curve.point(at)
        if kept < lead and surroundings.inside(place)[0]:
            notes.append(
                f"the path is extended by {kept:.2g} instead of {lead:.2g} mm {name} at "
                f"{surroundings.film.place(place[0])}, where the mesh has no room for more: a "
                "crack that runs farther leaves it"
            )
    return notes
