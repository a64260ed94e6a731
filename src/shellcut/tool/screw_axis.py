r"""Find the fixed axis that a motion turns about, or the line that it moves along, if any.

A body with angular velocity w whose point r has velocity v turns at that instant about the line
through

    c = r + w x v / |w|²

along w (Mozzi's screw axis), and slides along it. The motion keeps an *axis* if w has one direction
and sense and all c lie on one line along it; it keeps a *line* if it does not turn and v has one
direction and sense. If the motion has a coordinate of its own, this must change as the angle or the
path does.

A body that turns about a line of its own and moves on at u per radian, as a rolling wheel does, has
an axis that moves, too. There c moves aside by d, the part of u across w. The line of the body that
moves on at u lies beside c, at c + d x ê with ê = w/|w|, where the turn gives ê x (d x ê) = d.
The work per radian of a force F and the moment M about that line is M·ê + F·u.

Screws and straight motions give their axis or line directly. For all others the twist is sampled at
many instants, accurately enough to recognise a table of poses that turn about one axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats, Vec3, norm, product, unit

from .coordinate import Coordinate, HasCoordinate
from .motion import Motion, ScrewMotion, StraightMotion
from .pose_of_motion import pose_at

N_INSTANT = 256
"""Number of instants at which a motion is sampled."""

AT_REST = 1e-3
"""Fraction of the largest rate of the coordinate: at slower instants the direction is noise."""

# Tolerance of the rate of a coordinate against the twist.
_SAME_RATE = 1e-3
# Tolerance of directions: far above round-off, far below any intended bend.
_SAME_DIRECTION = 1e-6
# Tolerance of the axis' position, relative to the path of the body's origin per radian: in a table
# of poses 10 degrees apart on a circle the axis wanders by 1.3e-3 of the radius.
_SAME_PLACE = 5e-3
# Tolerance of positions, relative to the distance of the body from the world's origin.
_ROUND_OFF = 1e-9


@dataclass(frozen=True)
class Axis:
    """The motion turns about an axis and slides along ``advance``.

    Examples
    --------
    >>> from math import pi
    >>> from shellcut.tool.table_motion import TableMotion
    >>> turn = TableMotion([0.0, 1.0], [[0.0, 0.0, 0.0]] * 2, [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0]])
    >>> kept_axis(turn, until=1.0)
    Axis(direction=(0.0, 0.0, 1.0), point=(0.0, 0.0, 0.0), advance=(-0.0, -0.0, -1.0), ...)
    """

    direction: Vec3
    """Unit vector; the turn is counter-clockwise seen from its tip."""
    point: Vec3
    """A point of the axis at the start [mm]."""
    advance: Vec3
    """Unit vector; the axial force is positive along it."""
    drift: Vec3 = (0.0, 0.0, 0.0)
    """Displacement of the axis itself per radian [mm], across its direction: a screw may advance at
    an angle to its axis, and a wheel rolls."""


@dataclass(frozen=True)
class Line:
    """The motion follows a line without turning."""

    direction: Vec3
    """Unit vector in the direction of motion."""


@dataclass(frozen=True, eq=False)
class Instants:
    """A motion sampled where its coordinate changes, with its derivatives by the coordinate q."""

    time: Floats
    """[s], shape (n,); ascending."""
    travel: Floats
    """The coordinate q, shape (n,), [rad or mm]."""
    spin: Floats
    """dw/dq: rotation per unit of the coordinate, shape (n, 3), [rad] over that unit."""
    shift: Floats
    """dv/dq: path of the body's origin per unit, shape (n, 3), [mm] likewise."""
    origin: Floats
    """Position of the body's origin, shape (n, 3), [mm]."""


def kept_axis(motion: Motion, until: float, stray: float = 0.0) -> Axis | Line | None:
    """Return the fixed axis or line of a motion from t = 0 to ``until`` [s], None if neither.

    stray : how far an axis may stray [mm], of a motion as seen from a film that moves.
    """
    # Not isinstance: a derived class may move differently.
    if type(motion) is ScrewMotion:
        return _of_screw(motion)
    if type(motion) is StraightMotion:
        return Line(_unit(np.array(motion.direction, float)))
    if isinstance(motion, HasCoordinate):
        own = Coordinate.own(motion, until)
        seen = instants(motion, own, until)
        return _axis(seen, stray) if own.unit == "rad" else _line(seen)
    line = _line(instants(motion, Coordinate.path(motion, until), until))
    return line or _axis(instants(motion, Coordinate.angle(motion, until), until), stray)


def instants(motion: Motion, coordinate: Coordinate, until: float) -> Instants:
    """Return the derivatives of a motion by a coordinate, wherever that changes."""
    times = (np.arange(N_INSTANT) + 0.5) / N_INSTANT * until
    rate = np.array([coordinate.rate(t) for t in times.tolist()])
    moves = np.abs(rate) > AT_REST * np.abs(rate).max(initial=0.0)
    times, rate = times[moves], rate[moves]
    travel = np.array([coordinate.at(t) for t in times.tolist()])
    spin, shift, origin = np.zeros((3, times.size, 3))
    for k, t in enumerate(times.tolist()):
        spin[k], shift[k] = motion.twist(t)
        _, origin[k] = pose_at(motion, t)
    return Instants(times, travel, spin / rate[:, None], shift / rate[:, None], origin)


def _of_screw(motion: ScrewMotion) -> Axis:
    axis = np.array(motion.axis, float)
    direction = _unit(axis)
    advance = _unit(-axis if motion.advance is None else np.array(motion.advance, float))
    along = np.array(advance)
    aside = along - product(along, np.array(direction)) * np.array(direction)
    drift = motion.pitch / (2.0 * np.pi) * aside
    if norm(aside) <= _SAME_DIRECTION:
        drift = np.zeros(3)
    x, y, z = (float(c) for c in motion.axis_point)
    return Axis(direction, (x, y, z), advance, _triple(drift))


def _axis(seen: Instants, stray: float) -> Axis | None:
    direction = _kept_direction(seen.spin)
    if direction is None:
        return None
    turn = np.linalg.norm(seen.spin, axis=1)
    # The foot of the perpendicular from the world's origin, by the path of the point there.
    shift = seen.shift - np.cross(seen.spin, seen.origin)
    place = np.cross(seen.spin, shift) / (turn**2)[:, None]
    middle = place.mean(axis=0)
    wander = np.linalg.norm(place - middle, axis=1).max()
    distance = np.linalg.norm(seen.shift, axis=1).max()
    round_off = _ROUND_OFF * np.linalg.norm(seen.origin, axis=1).max() + stray
    if wander > _SAME_PLACE * distance + round_off:
        return _drifting(direction, place, seen, _SAME_PLACE * distance + round_off)
    if norm(middle) <= _SAME_DIRECTION * distance + round_off:
        middle = np.zeros(3)
    ahead = float(product(seen.shift, direction).sum())
    onward = ahead > stray * len(place)
    return Axis(_triple(direction), _triple(middle), _triple(direction if onward else -direction))


def _drifting(direction: Floats, place: Floats, seen: Instants, stray: float) -> Axis | None:
    """Return an axis that moves on with the angle, None if its places (n, 3) do not lie so."""
    travel = seen.travel
    after, aside = travel - travel.mean(), place - place.mean(axis=0)
    drift = product(after, aside) / max(float(product(after, after)), np.finfo(float).tiny)
    if norm(aside - after[:, None] * drift).max() > stray:
        return None
    start = place.mean(axis=0) - travel.mean() * drift + np.cross(drift, direction)
    ahead = float(product(seen.shift, direction).mean())
    advance = unit(ahead * direction + drift)
    return Axis(_triple(direction), _triple(start), _triple(advance), _triple(drift))


def _line(seen: Instants) -> Line | None:
    direction = _kept_direction(seen.shift)
    # At a millimetre from the axis: less rotation than that is none for any tool that fits a film.
    if direction is None or np.abs(seen.spin).max() > _SAME_DIRECTION:
        return None
    return Line(_triple(direction))


def _kept_direction(rates: Floats) -> Floats | None:
    """Return the direction of motion, one radian or millimetre of it per unit of the coordinate."""
    total = rates.sum(axis=0)
    if not norm(total) > 0.0:
        return None
    direction = unit(total)
    if np.abs(product(rates, direction) - 1.0).max() > _SAME_RATE:
        return None
    return direction if np.abs(np.cross(rates, direction)).max() <= _SAME_DIRECTION else None


def _unit(v: Floats) -> Vec3:
    return _triple(unit(v))


def _triple(v: Floats) -> Vec3:
    x, y, z = v.tolist()
    return x, y, z
