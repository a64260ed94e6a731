"""Prescribed rigid motions of the tool: x = R(t) X + r(t), from the body frame to the world.

==================  ========================================================================
R, r                ``pose``: rotation matrix and position of the body's origin [mm]
w, v                ``twist``: dR/dt = w x R [rad/s], v = dr/dt [mm/s], both in world axes
==================  ========================================================================

A start from rest ramps the speed by half a cosine over the ramp time T,

    speed(t) = V (1 - cos(pi t / T)) / 2,    path(t) = V (t - T/pi sin(pi t / T)) / 2,    t < T,

so that path(T) = V T / 2; before t = 0 the tool rests. Motions through tables of poses are in
:mod:`shellcut.tool.table_motion`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import cos, pi, radians, sin, sqrt
from typing import Annotated, Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Vec3, three
from shellcut.numerics.jit import BoundOnce, inline_or_plain, kernel
from shellcut.numerics.vec3 import load

from .pose import Pose

_ORIGIN = (0.0, 0.0, 0.0)

# Of its duration, over which the speed of :meth:`ScrewMotion.over` rises.
_RAMP = 0.03


@runtime_checkable
class Motion(Protocol):
    """What the simulation needs from a motion; times in s, lengths in mm, angles in rad.

    It may have a coordinate of its own besides (:class:`~shellcut.tool.coordinate.HasCoordinate`).
    """

    def pose(self, time: float) -> tuple[Floats, Floats]:
        """Return R, shape (3, 3), and r, shape (3,), [mm], with x = R X + r: a Pose, or a pair."""
        ...

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of the body's origin [mm/s], (3,) each."""
        ...


Pitch: TypeAlias = Annotated[float, Option("mm", "advance per turn; 0 for a pure rotation")]
Ramp: TypeAlias = Annotated[
    float, Option("s", "time over which the speed rises; 0 starts at full speed", least=0)
]
Axis: TypeAlias = Annotated[
    Sequence[float],
    Option("", "direction, of any length; the turn is counter-clockwise", form="3 numbers"),
]
AxisPoint: TypeAlias = Annotated[
    Sequence[float], Option("mm", "a point of the axis", form="3 numbers")
]
Advance: TypeAlias = Annotated[
    Sequence[float] | None,
    Option("", "direction of the advance", form="3 numbers", unset="against the axis"),
]


@checked
@dataclass(frozen=True)
class ScrewMotion:
    """Turn about a fixed axis and advance in proportion, starting from rest.

    The turn is counter-clockwise seen from the tip of ``axis``; the coordinate is its angle.

    Examples
    --------
    >>> opening = ScrewMotion.over(angle_deg=95.0, duration=6.0e-3, pitch=12.0)
    >>> round(opening.coordinate(6.0e-3) * 180.0 / 3.141592653589793, 9)
    95.0
    """

    angular_speed: Annotated[
        float, Option("rad/s", "speed after the ramp; to turn clockwise reverse the axis", above=0)
    ]
    pitch: Pitch = 0.0
    ramp: Ramp = 0.0
    axis: Axis = (0.0, 0.0, 1.0)
    axis_point: AxisPoint = (0.0, 0.0, 0.0)
    advance: Advance = None
    _axis: Vec3 = field(init=False, repr=False, compare=False)
    _point: Vec3 = field(init=False, repr=False, compare=False)
    _lead: Vec3 = field(init=False, repr=False, compare=False)
    _screw: Floats = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        axis = _unit("axis", self.axis)
        p0, p1, p2 = three("axis_point", self.axis_point).tolist()
        against = (-axis[0], -axis[1], -axis[2])
        advance = against if self.advance is None else _unit("advance", self.advance)
        lead = self.pitch / (2.0 * pi)
        object.__setattr__(self, "_axis", axis)
        object.__setattr__(self, "_point", (p0, p1, p2))
        object.__setattr__(self, "_lead", (lead * advance[0], lead * advance[1], lead * advance[2]))
        object.__setattr__(self, "_screw", np.array([axis, self._point, self._lead]))

    @classmethod
    @checked
    def over(
        cls,
        *,
        angle_deg: Annotated[float, Option("deg", "angle of the whole motion", above=0)],
        duration: Annotated[
            float, Option("s", "of the run; then the motion continues at its speed", above=0)
        ],
        pitch: Pitch = 0.0,
        axis: Axis = (0.0, 0.0, 1.0),
        axis_point: AxisPoint = (0.0, 0.0, 0.0),
        advance: Advance = None,
    ) -> ScrewMotion:
        """Return the screw that has turned by ``angle_deg`` exactly at ``duration``.

        Its speed rises over the first 3 % of the duration.
        """
        return cls(
            angular_speed=radians(angle_deg) / (duration * (1.0 - 0.5 * _RAMP)),
            pitch=pitch,
            ramp=_RAMP * duration,
            axis=axis,
            axis_point=axis_point,
            advance=advance,
        )

    @property
    def coordinate_unit(self) -> Literal["rad"]:
        """Unit of the coordinate."""
        return "rad"

    def coordinate(self, time: float) -> float:
        """Return the angle turned since t = 0 [rad]."""
        return _ramped_path(time, self.angular_speed, self.ramp)

    def pose(self, time: float) -> Pose:
        """Return R, shape (3, 3), and r, shape (3,), [mm], with x = R X + r."""
        rotation, origin, angle = np.empty((3, 3)), np.empty(3), self.coordinate(time)
        # A kernel, because this is called in every step.
        _POSE_OF_SCREW.code(self._screw, angle, rotation, origin)
        return Pose(rotation, origin)

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of the body's origin [mm/s], (3,) each."""
        rate = _ramped_speed(time, self.angular_speed, self.ramp)
        a0, a1, a2 = self._axis
        v0, v1, v2 = self._lead
        if self._point != _ORIGIN:
            # dr/dt = rate (h - a x R p), and R p = p - r + h angle
            moved = np.array(self._lead) * self.coordinate(time) - self.pose(time)[1]
            q0, q1, q2 = (np.array(self._point) + moved).tolist()
            v0, v1, v2 = v0 - a1 * q2 + a2 * q1, v1 - a2 * q0 + a0 * q2, v2 - a0 * q1 + a1 * q0
        spin = np.array((rate * a0, rate * a1, rate * a2))
        return spin, np.array((rate * v0, rate * v1, rate * v2))


@checked
@dataclass(frozen=True)
class StraightMotion:
    """Move along a straight line without turning, from rest; the coordinate is the path.

    Examples
    --------
    >>> motion = StraightMotion((1.0, 0.0, 0.0), speed=6000.0)
    >>> motion.coordinate(1e-3), motion.coordinate_unit
    (6.0, 'mm')
    """

    direction: Annotated[Sequence[float], Option("", "vector of any length", form="3 numbers")]
    speed: Annotated[float, Option("mm/s", "speed after the ramp", above=0)]
    ramp: Ramp = 0.0
    _direction: Vec3 = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_direction", _unit("direction", self.direction))

    @property
    def coordinate_unit(self) -> Literal["mm"]:
        """Unit of the coordinate."""
        return "mm"

    def coordinate(self, time: float) -> float:
        """Return the path since t = 0 [mm]."""
        return _ramped_path(time, self.speed, self.ramp)

    def pose(self, time: float) -> Pose:
        """Return R, shape (3, 3), and r, shape (3,), [mm], with x = R X + r."""
        path = self.coordinate(time)
        d0, d1, d2 = self._direction
        return Pose(np.eye(3), np.array((path * d0, path * d1, path * d2)))

    def twist(self, time: float) -> tuple[Floats, Floats]:
        """Return the angular velocity [rad/s] and that of the body's origin [mm/s], (3,) each."""
        rate = _ramped_speed(time, self.speed, self.ramp)
        d0, d1, d2 = self._direction
        return np.zeros(3), np.array((rate * d0, rate * d1, rate * d2))


def _ramped_path(time: float, speed: float, ramp: float) -> float:
    if time <= 0.0:
        return 0.0
    if time < ramp:
        return 0.5 * speed * (time - ramp / pi * sin(pi * time / ramp))
    return speed * (time - 0.5 * ramp)


def _ramped_speed(time: float, speed: float, ramp: float) -> float:
    if time < 0.0:
        return 0.0
    if time < ramp:
        return 0.5 * speed * (1.0 - cos(pi * time / ramp))
    return speed


@kernel
def _pose_of_screw(screw: Floats, angle: float, rotation: Floats, origin: Floats) -> None:
    """Write R and r = p - R p + h angle.

    screw : (3, 3), axis, its point p and h, the advance per radian [mm].
    """
    point, lead = load(screw, 1), load(screw, 2)
    # 1 - cos from the half angle, without cancellation
    half = sin(0.5 * angle)
    k = 2.0 * half * half
    rows = rotation_rows(load(screw, 0), sin(angle), k, 1.0 - k)
    turned_point = turned(rows, point)
    for c in range(3):
        for d in range(3):
            rotation[c, d] = rows[c][d]
        origin[c] = point[c] - turned_point[c] + lead[c] * angle


_POSE_OF_SCREW = BoundOnce(_pose_of_screw)


def _unit(name: str, values: Sequence[float]) -> Vec3:
    a0, a1, a2 = three(name, values).tolist()
    length = sqrt(a0 * a0 + a1 * a1 + a2 * a2)
    if length == 0.0:
        raise ValueError(f"{name} must not be zero: it is a direction")
    return a0 / length, a1 / length, a2 / length


@inline_or_plain
def rotation_rows(a: Vec3, s: float, k: float, c: float) -> tuple[Vec3, Vec3, Vec3]:
    """Return the rows of the rotation c 1 + s a~ + k a a^T."""
    a0, a1, a2 = a
    return (
        (c + k * a0 * a0, k * a0 * a1 - s * a2, k * a0 * a2 + s * a1),
        (k * a0 * a1 + s * a2, c + k * a1 * a1, k * a1 * a2 - s * a0),
        (k * a0 * a2 - s * a1, k * a1 * a2 + s * a0, c + k * a2 * a2),
    )


@inline_or_plain
def turned(rows: tuple[Vec3, Vec3, Vec3], a: Vec3) -> Vec3:
    """Return the vector a turned by the rotation of these rows."""
    (r00, r01, r02), (r10, r11, r12), (r20, r21, r22) = rows
    a0, a1, a2 = a
    return (
        r00 * a0 + r01 * a1 + r02 * a2,
        r10 * a0 + r11 * a1 + r12 * a2,
        r20 * a0 + r21 * a1 + r22 * a2,
    )
