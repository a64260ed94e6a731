"""A rigid motion through tabulated poses, with smooth translation and rotation.

Within an interval the translation is a cubic and the rotation R_i exp(phi), phi a cubic, which pass
the entries at the velocities of :func:`_rates`. Plain scalar arithmetic evaluates them in a few
microseconds per call, where an object of SciPy takes a hundred.

The velocity at an entry is the weighted harmonic mean of those of the intervals beside it
([FritschButland1984]), so that a motion along a line turns back at entries only, and rests where
two entries are the same; with continuous accelerations it would swing beyond them.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from math import cos, degrees, pi, sin, sqrt
from pathlib import Path
from typing import Annotated, TypeAlias

import numpy as np
import numpy.typing as npt
import scipy

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Vec3, each, norm, unit
from shellcut.formats.errors import naming
from shellcut.formats.motion_csv import read_motion_csv

from .motion import rotation_rows, turned
from .pose import Pose

LARGEST_FREE_TURN = 0.75 * pi
"""Turn between neighbouring entries of a table [rad] from which on the entries do not tell it, if
the axis changes or the angles are known but for whole turns: near half a turn the shorter rotation
is ambiguous."""

SAME_AXIS = 1e-9
"""Sine of the angle between two rotation vectors along one axis: far above round-off."""

SMALL_ANGLE = 1e-4
"""Below this [rad] rotations use series, whose next term is below 1e-17."""


Unwrap: TypeAlias = Annotated[
    bool,
    Option(
        "",
        "whether angles wrap, as from 359 to 1 deg or from 180 to -180 deg: the tool then makes "
        "the shorter turn between rows, which must be less than 135 deg",
    ),
]


@checked
@dataclass(frozen=True, eq=False)
class TableMotion:
    """Pass through tabulated poses smoothly: cubics in translation and rotation.

    Along a line the tool never leaves what lies between two entries, and where two entries are the
    same it rests. Round a corner of up to 60° it keeps its speed and cuts the corner a little; the
    more it has to brake the sharper the corner is, and at 90° and more it stops there.

    Before the first and after the last time the tool rests at the end pose, so a run may start
    early and end a step late; a table that ends in motion therefore stops the tool abruptly.

    Examples
    --------
    >>> motion = TableMotion([0.0, 1e-3], [[0.0, 0.0, 0.0], [0.0, 0.0, -2.0]])
    >>> rotation, origin = motion.pose(5e-4)
    >>> origin.tolist()
    [0.0, 0.0, -1.0]
    """

    times: npt.ArrayLike
    """Increasing, at least two, shape (n_time,), [s]."""
    translations: npt.ArrayLike
    """Position r of the body's origin, shape (n_time, 3), [mm]."""
    rotation_vectors: npt.ArrayLike | None = None
    """Axis times angle of the pose, shape (n_time, 3), [rad]; by default no rotation.

    Between two entries along one axis the tool turns by their difference, also by several turns.
    Where the axis changes it makes the shorter turn; there a difference of 135° or more is
    refused.
    """
    unwrap: Unwrap = False
    _knots: list[float] = field(init=False, repr=False)
    _translation: list[list[float]] = field(init=False, repr=False)
    _rotation: list[list[float]] = field(init=False, repr=False)
    _start: list[tuple[Vec3, Vec3, Vec3]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        times, translations, vectors = _cast_table(
            self.times, self.translations, self.rotation_vectors
        )
        step = np.diff(times)
        with np.errstate(over="ignore", invalid="ignore"):
            shifts = np.diff(translations, axis=0)
            rates = _rates(step, shifts / step[:, None])
            translation = _cubics(step, translations[:-1], shifts, rates[:-1], rates[1:])
        if not np.isfinite(translation).all():
            raise ValueError("times and translations must be such that speeds are finite numbers")
        start = scipy.spatial.transform.Rotation.from_rotvec(vectors)
        turns = _turns(vectors, start, unwrap=self.unwrap)
        object.__setattr__(self, "_knots", times.tolist())
        object.__setattr__(self, "_translation", translation.tolist())
        object.__setattr__(self, "_rotation", _rotation_cubics(step, turns).tolist())
        rows = [tuple(tuple(row) for row in matrix) for matrix in start.as_matrix().tolist()]
        object.__setattr__(self, "_start", rows)
        names = ("times", "translations", "rotation_vectors")
        for name, array in zip(names, (times, translations, vectors), strict=True):
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @classmethod
    @checked
    def read_csv(
        cls,
        path: Annotated[
            str | Path, Option("", "table of time and x, y, z, rx, ry, rz or angle", form="path")
        ],
        *,
        unwrap: Unwrap = False,
    ) -> TableMotion:
        """Read a table of poses; its headings give the units, such as ``time [ms]``.

        The columns are those of :func:`shellcut.formats.motion_csv.read_motion_csv`: ``time``,
        ``x``, ``y``, ``z`` and ``rx``, ``ry``, ``rz`` or ``angle`` (about z). From 0 to 270 deg the
        tool turns by 270 deg, from 359 to 1 deg back by 358 deg unless ``unwrap`` is true.
        """
        times, translations, rotation_vectors = read_motion_csv(path)
        with naming(path):
            return cls(times, translations, rotation_vectors, unwrap=unwrap)

    def pose(self, time: float) -> Pose:
        """Return R, shape (3, 3), and r, shape (3,), [mm], with x = R X + r."""
        i, dt = self._locate(time)
        origin, _ = _cubic(self._translation[i], dt)
        phi, _ = _cubic(self._rotation[i], dt)
        return Pose(_product(self._start[i], _exponential(phi)), np.array(origin))

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of the body's origin [mm/s], (3,) each.

        At the first and last time these are the rates at its ends, beyond them zero.
        """
        if time < self._knots[0] or time > self._knots[-1]:
            return np.zeros(3), np.zeros(3)
        i, dt = self._locate(time)
        _, velocity = _cubic(self._translation[i], dt)
        return np.array(self._angular_velocity(i, dt)), np.array(velocity)

    @property
    def leap(self) -> int | None:
        """First entry before a turn of more than 180° that may be a sensor's jump; or None.

        The shorter turn has the sense of an interval beside it, and at most three times its
        rate.
        """
        vectors, step = np.asarray(self.rotation_vectors), np.diff(self.times)
        listed = np.zeros_like(vectors[1:]) if self.unwrap else np.diff(vectors, axis=0)
        turn = norm(listed)
        shorter = (turn - 2.0 * pi * np.round(turn / (2.0 * pi)))[:, None] * unit(listed)
        for i in np.flatnonzero(turn > pi).tolist():
            for j in (i - 1, i + 1):
                if 0 <= j < len(turn) and turn[j] < pi:
                    rate, other = listed[j] / step[j], shorter[i] / step[i]
                    if 0.0 < (rate * other).sum() <= 3.0 * (rate * rate).sum():
                        return int(i)
        return None

    def _locate(self, time: float) -> tuple[int, float]:
        knots = self._knots
        i = min(max(bisect_right(knots, time) - 1, 0), len(knots) - 2)
        return i, min(max(time, knots[0]), knots[-1]) - knots[i]

    def _angular_velocity(self, i: int, dt: float) -> Vec3:
        # R = R_i exp(phi), hence w = R_i J(phi) dphi/dt with the left Jacobian
        # J f = f + (1 - cos a)/a² phi x f + (a - sin a)/a³ phi x (phi x f), a = |phi|
        phi, rate = _cubic(self._rotation[i], dt)
        squared = phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]
        angle = sqrt(squared)
        if angle < SMALL_ANGLE:
            first, second = 0.5 - squared / 24.0, 1.0 / 6.0 - squared / 120.0
        else:
            half = sin(0.5 * angle) / angle
            first, second = 2.0 * half * half, (angle - sin(angle)) / (angle * squared)
        c = _cross(phi, rate)
        cc = _cross(phi, c)
        spin = (
            rate[0] + first * c[0] + second * cc[0],
            rate[1] + first * c[1] + second * cc[1],
            rate[2] + first * c[2] + second * cc[2],
        )
        return turned(self._start[i], spin)


def _turns(vectors: Floats, start: scipy.spatial.transform.Rotation, *, unwrap: bool) -> Floats:
    """Return the rotation vector from each entry to the next, shape (n_time - 1, 3), [rad].

    It is the same in the frames of both. Along one axis rotations add up, so that it is the
    difference of the entries. The straight line between two rotation vectors is a path of rotations
    no longer than their difference, since |w| <= |dphi/dt|; so below half a turn it can be drawn
    tight to the shorter turn.

    start : the rotations of the entries.
    """
    shorter = (start[:-1].inv() * start[1:]).as_rotvec()
    listed = np.diff(vectors, axis=0)
    across = norm(np.cross(vectors[:-1], vectors[1:]))
    one_axis = across <= SAME_AXIS * norm(vectors[:-1]) * norm(vectors[1:])
    turn = norm(shorter if unwrap else listed)
    large = turn >= LARGEST_FREE_TURN
    if (unknown := large & (unwrap | ~one_axis)).any():
        i = int(np.where(unknown, turn, 0.0).argmax())
        where, other = ("with unwrap", "") if unwrap else ("where the axis changes", ", or unwrap")
        raise ValueError(
            f"rotation_vectors must turn by less than {degrees(LARGEST_FREE_TURN):g} degrees "
            f"between entries {where}, got {degrees(turn[i]):.1f} from entry {i} to {i + 1}: "
            f"add entries in between{other}"
        )
    return np.where(large[:, None], listed, shorter)


def _exponential(phi: Vec3) -> tuple[Vec3, Vec3, Vec3]:
    # rows of the rotation by the vector phi
    squared = phi[0] * phi[0] + phi[1] * phi[1] + phi[2] * phi[2]
    angle = sqrt(squared)
    if angle < SMALL_ANGLE:
        s, k = 1.0 - squared / 6.0, 0.5 - squared / 24.0
    else:
        half = sin(0.5 * angle) / angle
        s, k = sin(angle) / angle, 2.0 * half * half
    return rotation_rows(phi, s, k, 1.0 - k * squared)


def _product(a: tuple[Vec3, Vec3, Vec3], b: tuple[Vec3, Vec3, Vec3]) -> Floats:
    (b00, b01, b02), (b10, b11, b12), (b20, b21, b22) = b
    columns = ((b00, b10, b20), (b01, b11, b21), (b02, b12, b22))
    return np.array([turned(a, column) for column in columns]).T.copy()


def _cross(a: Vec3, b: Vec3) -> Vec3:
    return (
        a[1] * b[2] - a[2] * b[1],
        a[2] * b[0] - a[0] * b[2],
        a[0] * b[1] - a[1] * b[0],
    )


def _cubic(coefficients: list[float], dt: float) -> tuple[Vec3, Vec3]:
    # value and rate within an interval
    a3, a2, a1, a0, b3, b2, b1, b0, c3, c2, c1, c0 = coefficients
    return (
        (
            ((a3 * dt + a2) * dt + a1) * dt + a0,
            ((b3 * dt + b2) * dt + b1) * dt + b0,
            ((c3 * dt + c2) * dt + c1) * dt + c0,
        ),
        (
            (3.0 * a3 * dt + 2.0 * a2) * dt + a1,
            (3.0 * b3 * dt + 2.0 * b2) * dt + b1,
            (3.0 * c3 * dt + 2.0 * c2) * dt + c1,
        ),
    )


def _rates(step: Floats, mean: Floats) -> Floats:
    """Return the velocities at the entries of a table, shape (n_time, 3).

    In between the harmonic mean of the means beside it, weighted as [FritschButland1984], in
    the direction halfway between the two. At an end the speed continues as it changes between the
    first two intervals, up to twice that of the interval; the direction is that of the next entry
    mirrored at the chord, as on a circle.

    step : (n_time - 1,).  mean : (n_time - 1, 3), of the intervals.
    """
    rates, speed = np.empty((len(mean) + 1, 3)), norm(mean)
    rates[[0, -1]] = mean[[0, -1]]
    if len(mean) > 1:
        both = 3.0 * (step[:-1] + step[1:])
        both_move = np.minimum(speed[:-1], speed[1:]) > 0.0
        near, far = 2.0 * step[1:] + step[:-1], step[1:] + 2.0 * step[:-1]
        inverse = np.ones_like(both)
        np.divide(near, speed[:-1], out=inverse, where=both_move)
        inverse += np.divide(far, speed[1:], out=np.zeros_like(both), where=both_move)
        along = unit(mean)
        cosine = (along[:-1] * along[1:]).sum(axis=1)
        size = np.where(both_move, both / inverse, 0.0) * np.clip(2.0 * cosine, 0.0, 1.0)
        rates[1:-1] = size[:, None] * unit(along[:-1] + along[1:])
        for end, beside in ((0, 1), (-1, -2)):
            part = step[end] / (step[end] + step[beside])
            faster = speed[end] + part * (speed[end] - speed[beside])
            inner, own = unit(rates[beside]), along[end]
            mirrored = 2.0 * (inner * own).sum() * own - inner if inner.any() else own
            rates[end] = min(max(faster, 0.0), 2.0 * speed[end]) * mirrored
    return rates


def _cubics(step: Floats, start: Floats, shift: Floats, ends: Floats, stops: Floats) -> Floats:
    """Return the coefficients of dt³, dt², dt and 1 for x, y, z in turn, shape (n_time - 1, 12).

    start, shift : (n_time - 1, 3), value at the start of each interval and its change over
    it.  ends, stops : likewise, rates at its start and end.
    """
    h = step[:, None]
    cubic = (ends + stops - 2.0 * shift / h) / (h * h)
    square = (3.0 * shift / h - 2.0 * ends - stops) / h
    return np.stack([cubic, square, ends, start], axis=2).reshape(-1, 12)


def _rotation_cubics(step: Floats, turns: Floats) -> Floats:
    """Return the cubics of phi, 0 at the start of each interval, as of :func:`_cubics`.

    The vector of the turn from R_i to R_i+1 is the same in both frames, so angular velocities at an
    entry are those of its own frame. At the end of an interval the rate of phi is J⁻¹ w, with the
    right Jacobian J of phi.

    turns : (n_time - 1, 3) [rad].
    """
    rates, angle = _rates(step, turns / step[:, None]), norm(turns)
    large = angle >= LARGEST_FREE_TURN
    a = np.clip(angle, SMALL_ANGLE, LARGEST_FREE_TURN)
    series = 1.0 / 12.0 + angle * angle / 720.0
    exact = 1.0 / (a * a) - (1.0 + each(cos, a)) / (2.0 * a * each(sin, a))
    second = np.where(angle < SMALL_ANGLE, series, exact)[:, None]
    # J is singular at a full turn, and 1 along the axis of phi: so a large turn begins and ends
    # about its axis, or at rest where the axis changes there.
    axis = unit(turns[large])
    for rate in (rates[:-1], rates[1:]):
        size = (rate[large] * axis).sum(axis=1)
        same = norm(np.cross(rate[large], axis)) <= SAME_AXIS * np.abs(size)
        rate[large] = np.where(same, size, 0.0)[:, None] * axis
    across = np.cross(turns, rates[1:])
    stops = rates[1:] + 0.5 * across + second * np.cross(turns, across)
    return _cubics(step, np.zeros_like(turns), turns, rates[:-1], stops)


def _cast_table(
    times: npt.ArrayLike, translations: npt.ArrayLike, rotation_vectors: npt.ArrayLike | None
) -> tuple[Floats, Floats, Floats]:
    t = np.array(times, dtype=np.float64)
    if t.ndim != 1 or t.size < 2:
        raise ValueError(f"times must have shape (n_time,) with at least two, got {t.shape}")
    r = np.array(translations, dtype=np.float64)
    turns = np.zeros((t.size, 3)) if rotation_vectors is None else rotation_vectors
    phi = np.array(turns, dtype=np.float64)
    for name, array in (("translations", r), ("rotation_vectors", phi)):
        if array.shape != (t.size, 3):
            raise ValueError(f"{name} must have shape ({t.size}, 3), got {array.shape}")
    for name, array in (("times", t), ("translations", r), ("rotation_vectors", phi)):
        if not np.isfinite(array).all():
            bad = np.argwhere(~np.isfinite(array))[0][0]
            raise ValueError(f"{name} must be finite, entry {bad} is not")
    late = np.flatnonzero(np.diff(t) <= 0.0)
    if late.size:
        i = late[0]
        raise ValueError(f"times must increase, entry {i + 1} is {t[i + 1]:g} after {t[i]:g} s")
    return t, r, phi
