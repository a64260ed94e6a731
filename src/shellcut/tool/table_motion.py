"""A rigid motion through tabulated poses, with smooth translation and rotation.

Within an interval the translation is a cubic spline and the rotation R_i exp(phi), phi a cubic.
Plain scalar arithmetic evaluates them in a few microseconds per call; a scipy spline takes a
hundred.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, field
from math import degrees, pi, sin, sqrt
from pathlib import Path
from typing import Annotated

import numpy as np
import numpy.typing as npt
import scipy

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Vec3
from shellcut.formats.errors import FileError
from shellcut.formats.motion_csv import read_motion_csv
from shellcut.numerics.small_matrices import inverse

from .motion import rotation_rows, turned
from .pose import Pose

LARGEST_TABLE_TURN = 0.75 * pi
"""Largest rotation between neighbouring entries of a table [rad]: near half a turn the direction is
ambiguous."""

SUBDIVISIONS = 16
"""Pieces of a table interval over which the travelled angle or path is summed."""

SMALL_ANGLE = 1e-4
"""Below this [rad] rotations use series, whose next term is below 1e-17."""


@checked
@dataclass(frozen=True, eq=False)
class TableMotion:
    """Pass through tabulated poses smoothly: cubic splines in translation and rotation.

    Before the first and after the last time the tool rests at the end pose, so a run may start
    early and end a step late; a table that ends in motion therefore stops the tool abruptly.

    The coordinate is the travel of the tool, which only grows: the angle (integral of the angular
    speed) if the table turns at all, otherwise the path of the body's origin.

    Examples
    --------
    >>> motion = TableMotion([0.0, 1e-3], [[0.0, 0.0, 0.0], [0.0, 0.0, -2.0]])
    >>> round(motion.coordinate(1e-3), 9), motion.coordinate_unit
    (2.0, 'mm')
    """

    times: npt.ArrayLike
    """Increasing, at least two, shape (n_time,), [s]."""
    translations: npt.ArrayLike
    """Position r of the body's origin, shape (n_time, 3), [mm]."""
    rotation_vectors: npt.ArrayLike | None = None
    """Axis times angle of the pose, shape (n_time, 3), [rad]; by default no rotation.

    Between entries the tool turns the shorter way; turns of 135° or more are refused.
    """
    _knots: list[float] = field(init=False, repr=False)
    _translation: list[list[float]] = field(init=False, repr=False)
    _rotation: list[list[float]] = field(init=False, repr=False)
    _start: list[tuple[Vec3, Vec3, Vec3]] = field(init=False, repr=False)
    _turns: bool = field(init=False, repr=False)
    _travel: list[list[tuple[float, float]]] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        times, translations, vectors = _cast_table(
            self.times, self.translations, self.rotation_vectors
        )
        n = times.size
        cubic = scipy.interpolate.CubicSpline(times, translations)
        if not np.isfinite(cubic.c).all():
            raise ValueError("times and translations must be such that speeds are finite numbers")
        # per interval the coefficients of dt³, dt², dt, 1 for x, y, z in turn
        translation = cubic.c.transpose(1, 2, 0).reshape(n - 1, 12)
        start = scipy.spatial.transform.Rotation.from_rotvec(vectors)
        turn = (start[:-1].inv() * start[1:]).magnitude()
        if turn.max() >= LARGEST_TABLE_TURN:
            i = int(turn.argmax())
            raise ValueError(
                f"rotation_vectors must turn by less than {degrees(LARGEST_TABLE_TURN):g} degrees "
                f"between entries, got {degrees(turn[i]):.1f} from entry {i} to {i + 1}: "
                "add entries in between"
            )
        object.__setattr__(self, "_knots", times.tolist())
        object.__setattr__(self, "_translation", translation.tolist())
        object.__setattr__(self, "_rotation", _rotation_cubics(times, start).tolist())
        rows = [tuple(tuple(row) for row in matrix) for matrix in start.as_matrix().tolist()]
        object.__setattr__(self, "_start", rows)
        object.__setattr__(self, "_turns", bool(turn.max() > 0.0))
        object.__setattr__(self, "_travel", self._sum_travel())
        names = ("times", "translations", "rotation_vectors")
        for name, array in zip(names, (times, translations, vectors), strict=True):
            array.flags.writeable = False
            object.__setattr__(self, name, array)

    @classmethod
    @checked
    def read_csv(
        cls,
        path: Annotated[
            str | Path, Option("", "time and x, y, z, rx, ry, rz or angle", form="path")
        ],
    ) -> TableMotion:
        """Read a table of poses; its headings give the units, such as ``time [ms]``.

        The columns are those of :func:`shellcut.formats.motion_csv.read_motion_csv`: ``time``,
        ``x``, ``y``, ``z`` and ``rx``, ``ry``, ``rz`` or ``angle`` (about z).
        """
        times, translations, rotation_vectors = read_motion_csv(path)
        try:
            return cls(times, translations, rotation_vectors)
        except ValueError as problem:
            raise FileError(path, str(problem)) from None

    @property
    def coordinate_unit(self) -> str:
        """Unit of the coordinate: "rad" if the table turns, otherwise "mm"."""
        return "rad" if self._turns else "mm"

    def coordinate(self, time: float) -> float:
        """Return the angle [rad] or path [mm] travelled since the first time."""
        i, dt = self._locate(time)
        piece = (self._knots[i + 1] - self._knots[i]) / SUBDIVISIONS
        j = min(int(dt / piece), SUBDIVISIONS - 1)
        (s0, v0), (s1, v1) = self._travel[i][j], self._travel[i][j + 1]
        u = dt / piece - j
        # cubic Hermite: the travel and its rate at both ends of the piece
        return (
            s0
            + u * u * (3.0 - 2.0 * u) * (s1 - s0)
            + u * (1.0 - u) * piece * ((1.0 - u) * v0 - u * v1)
        )

    def pose(self, time: float) -> Pose:
        """Return R, shape (3, 3), and r, shape (3,), [mm], with x = R X + r."""
        i, dt = self._locate(time)
        origin, _ = _cubic(self._translation[i], dt)
        phi, _ = _cubic(self._rotation[i], dt)
        return Pose(_product(self._start[i], _exponential(phi)), np.array(origin))

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of the body's origin [mm/s], (3,) each.

        At the first and last time these are the ends of the splines, beyond them zero.
        """
        if time < self._knots[0] or time > self._knots[-1]:
            return np.zeros(3), np.zeros(3)
        i, dt = self._locate(time)
        _, velocity = _cubic(self._translation[i], dt)
        return np.array(self._angular_velocity(i, dt)), np.array(velocity)

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

    def _sum_travel(self) -> list[list[tuple[float, float]]]:
        # (travel, speed) at the ends of the pieces of each interval, by 5-point Gauss per piece
        nodes, weights = np.polynomial.legendre.leggauss(5)

        def speed(i: int, dt: float) -> float:
            if self._turns:
                v0, v1, v2 = self._angular_velocity(i, dt)
            else:
                _, (v0, v1, v2) = _cubic(self._translation[i], dt)
            return sqrt(v0 * v0 + v1 * v1 + v2 * v2)

        travel = 0.0
        table = []
        for i in range(len(self._knots) - 1):
            piece = (self._knots[i + 1] - self._knots[i]) / SUBDIVISIONS
            row = [(travel, speed(i, 0.0))]
            for j in range(SUBDIVISIONS):
                for x, w in zip(nodes.tolist(), weights.tolist(), strict=True):
                    travel += 0.5 * piece * w * speed(i, piece * (j + 0.5 + 0.5 * x))
                row.append((travel, speed(i, piece * (j + 1))))
            table.append(row)
        return table


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


def _rotation_cubics(times: Floats, start: scipy.spatial.transform.Rotation) -> Floats:
    # RotationSpline is R_i exp(cubic in t - t_i), 0 at t_i: the cubics, shape (n_time - 1, 12),
    # from its values at thirds of the intervals (no spline of scipy is called during a run)
    spline = scipy.spatial.transform.RotationSpline(times, start)
    step = np.diff(times)
    thirds = np.array([1.0, 2.0, 3.0]) / 3.0
    at_thirds = spline((times[:-1, None] + step[:, None] * thirds).ravel())
    back = scipy.spatial.transform.Rotation.from_quat(
        np.repeat(start[:-1].as_quat(), 3, axis=0)
    ).inv()
    phi = (back * at_thirds).as_rotvec().reshape(-1, 3, 3)
    fit = inverse(np.column_stack([thirds * thirds * thirds, thirds * thirds, thirds]))
    scaled = np.einsum("kj,ijc->ick", fit, phi)
    powers = np.stack([step * step * step, step * step, step], axis=1)
    cubics = np.zeros((len(step), 3, 4))
    cubics[..., :3] = scaled / powers[:, None, :]
    return cubics.reshape(-1, 12)


def _cast_table(
    times: npt.ArrayLike, translations: npt.ArrayLike, rotation_vectors: npt.ArrayLike | None
) -> tuple[Floats, Floats, Floats]:
    t = np.array(times, dtype=np.float64)
    if t.ndim != 1 or t.size < 2:
        raise ValueError(f"times must have shape (n_time,) with at least two, got {t.shape}")
    r = np.array(translations, dtype=np.float64)
    if rotation_vectors is None:
        phi = np.zeros((t.size, 3))
    else:
        phi = np.array(rotation_vectors, dtype=np.float64)
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
