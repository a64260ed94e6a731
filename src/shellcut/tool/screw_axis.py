r"""What a rigid motion keeps: an axis that it turns about, a line that it goes along, or neither.

A body with the angular velocity w and the velocity v of a point r turns at that instant about the
line through

    c = r + w x v / |w|²

along w (Mozzi's screw axis), and slides along it. The motion keeps an *axis* if w has one direction
and sense and all c lie on one line along it; it keeps a *line* if it does not turn and v has one
direction and sense. The coordinate of the motion must grow with the turn or the way itself, which
that of a motion of one's own need not do.

Screws and straight motions say what they keep. Of all others the twist is looked at at many
instants, which is sharp enough to tell a table of poses that turn about one axis.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats, Vec3

from .motion import Motion, ScrewMotion, StraightMotion

N_INSTANT = 256
"""At which a motion is looked at."""

AT_REST = 1e-3
"""Of the largest rate of the coordinate: slower instants say nothing of the direction."""

# Of the rate of the coordinate against the twist: the travel of a table is itself interpolated.
_SAME_RATE = 1e-3
# Of directions: far above round-off, far below any bend that would be wanted.
_SAME_DIRECTION = 1e-6
# Of the places of the axis, relative to the way of the body's origin a radian: of a table of poses
# 10 degrees apart on a circle, a cubic spline, the axis wanders by 2e-4 of the radius.
_SAME_PLACE = 5e-3
# Of places, relative to the distance of the body from the world's origin.
_ROUND_OFF = 1e-9
# Half the interval of the rate of the coordinate, relative to the run: its round-off is 1e-10.
_INTERVAL = 1e-6


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
    """Unit vector, along which the axial force is counted."""
    drift: Vec3 = (0.0, 0.0, 0.0)
    """How far the axis itself moves a radian [mm]: a screw may advance at an angle to its axis."""


@dataclass(frozen=True)
class Line:
    """The motion goes along a line without turning."""

    direction: Vec3
    """Unit vector, ahead."""


@dataclass(frozen=True, eq=False)
class Instants:
    """A motion at instants at which its coordinate moves, and what it does there a unit of it."""

    time: Floats
    """[s], shape (n,); ascending."""
    spin: Floats
    """dw/dq: turn a unit of the coordinate, shape (n, 3), [rad] over that unit."""
    shift: Floats
    """dv/dq: way of the body's origin a unit of it, shape (n, 3), [mm] likewise."""
    origin: Floats
    """Where the body's origin is, shape (n, 3), [mm]."""

    @property
    def shift_at_world_origin(self) -> Floats:
        """Way of the body's point that is at the world's origin, shape (n, 3)."""
        return np.asarray(self.shift - np.cross(self.spin, self.origin))


def kept_axis(motion: Motion, until: float) -> Axis | Line | None:
    """Return the axis or line that a motion keeps from t = 0 to ``until`` [s], None if neither."""
    # A class derived from one of these may move otherwise.
    if type(motion) is ScrewMotion:
        return _of_screw(motion)
    if type(motion) is StraightMotion:
        return Line(_unit(np.array(motion.direction, float)))
    seen = instants(motion, until)
    if not seen.time.size:
        return None
    if motion.coordinate_unit == "rad":
        return _axis(seen)
    return _line(seen)


def instants(motion: Motion, until: float) -> Instants:
    """Return what a motion does a unit of its coordinate, wherever that moves."""
    times = (np.arange(N_INSTANT) + 0.5) / N_INSTANT * until
    rate = np.array([coordinate_rate(motion, t, until) for t in times])
    moves = np.abs(rate) > AT_REST * np.abs(rate).max(initial=0.0)
    times, rate = times[moves], rate[moves]
    spin, shift, origin = np.zeros((3, times.size, 3))
    for k, t in enumerate(times.tolist()):
        spin[k], shift[k] = motion.twist(t)
        _, origin[k] = motion.pose(t)
    return Instants(times, spin / rate[:, None], shift / rate[:, None], origin)


def coordinate_rate(motion: Motion, time: float, until: float) -> float:
    """Return how fast the coordinate of a motion grows [rad/s or mm/s]."""
    d = _INTERVAL * until
    return (motion.coordinate(time + d) - motion.coordinate(time - d)) / (2.0 * d)


def _of_screw(motion: ScrewMotion) -> Axis:
    axis = np.array(motion.axis, float)
    direction = _unit(axis)
    advance = _unit(-axis if motion.advance is None else np.array(motion.advance, float))
    along = np.array(advance)
    aside = along - (along @ np.array(direction)) * np.array(direction)
    drift = motion.pitch / (2.0 * np.pi) * aside
    if np.linalg.norm(aside) <= _SAME_DIRECTION:
        drift = np.zeros(3)
    x, y, z = (float(c) for c in motion.axis_point)
    return Axis(direction, (x, y, z), advance, _triple(drift))


def _axis(seen: Instants) -> Axis | None:
    turn = np.linalg.norm(seen.spin, axis=1)
    total = seen.spin.sum(axis=0)
    if not np.linalg.norm(total) > 0.0:
        return None
    direction = total / np.linalg.norm(total)
    # One radian of the coordinate is one radian about the axis.
    if np.abs(seen.spin @ direction - 1.0).max() > _SAME_RATE:
        return None
    if np.abs(np.cross(seen.spin, direction)).max() > _SAME_DIRECTION:
        return None
    # The foot of the perpendicular from the world's origin.
    place = np.cross(seen.spin, seen.shift_at_world_origin) / (turn**2)[:, None]
    middle = place.mean(axis=0)
    wander = np.linalg.norm(place - middle, axis=1).max()
    way = np.linalg.norm(seen.shift, axis=1).max()
    round_off = _ROUND_OFF * np.linalg.norm(seen.origin, axis=1).max()
    if wander > _SAME_PLACE * way + round_off:
        return None
    if np.linalg.norm(middle) <= _SAME_DIRECTION * way + round_off:
        middle = np.zeros(3)
    ahead = float((seen.shift @ direction).sum())
    return Axis(
        _triple(direction), _triple(middle), _triple(direction if ahead > 0.0 else -direction)
    )


def _line(seen: Instants) -> Line | None:
    total = seen.shift.sum(axis=0)
    if not np.linalg.norm(total) > 0.0:
        return None
    direction = total / np.linalg.norm(total)
    if np.abs(seen.shift @ direction - 1.0).max() > _SAME_RATE:
        return None
    if np.abs(np.cross(seen.shift, direction)).max() > _SAME_DIRECTION:
        return None
    # A millimetre from the axis: less turn than that is none for any tool that fits a film.
    if np.abs(seen.spin).max() > _SAME_DIRECTION:
        return None
    return Line(_triple(direction))


def _unit(v: Floats) -> Vec3:
    return _triple(v / np.linalg.norm(v))


def _triple(v: Floats) -> Vec3:
    x, y, z = v.tolist()
    return x, y, z
