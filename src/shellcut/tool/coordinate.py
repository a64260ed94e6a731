"""The coordinate of a motion: the angle or the path over which its torque or force is given.

A motion may have a coordinate of its own. That of any other is a travel, which only grows: the
integral of a speed over time.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal, Protocol, TypeAlias, runtime_checkable

import numpy as np

from shellcut.arrays import norm

from .motion import Motion

Unit: TypeAlias = Literal["rad", "mm"]

# Ticks of the run over which a speed is summed.
_N_TICK = 1024
# Half the interval of the rate of a motion's own coordinate, relative to the run: its round-off is
# 1e-10.
_INTERVAL = 1e-6


@runtime_checkable
class HasCoordinate(Protocol):
    """A motion with a coordinate of its own."""

    @property
    def coordinate_unit(self) -> Unit:
        """Unit of the coordinate."""
        ...

    def coordinate(self, time: float) -> float:
        """Return the angle [rad] or the path [mm] travelled."""
        ...


@dataclass(frozen=True)
class Coordinate:
    """A coordinate and its rate at any time [s]."""

    unit: Unit
    at: Callable[[float], float]
    """Takes a time; returns the angle [rad] or the path [mm]."""
    rate: Callable[[float], float]
    """Takes a time; returns the rate [rad/s or mm/s]."""
    of: str = ""
    """Whose path it is, for texts."""

    @classmethod
    def own(cls, motion: HasCoordinate, until: float) -> Coordinate:
        """Return that of a motion which has one; its rate is a difference.

        until : end of the run [s].
        """
        d = _INTERVAL * until

        def rate(time: float) -> float:
            return (motion.coordinate(time + d) - motion.coordinate(time - d)) / (2.0 * d)

        return cls(motion.coordinate_unit, motion.coordinate, rate)

    @classmethod
    def travelled(
        cls, unit: Unit, speed: Callable[[float], float], until: float, of: str = ""
    ) -> Coordinate:
        """Return the travel with a speed, which takes a time [s]."""
        return cls(unit, Travel(speed, until / _N_TICK).at, speed, of)

    @classmethod
    def angle(cls, motion: Motion, until: float) -> Coordinate:
        """Return the angle by which a motion has turned, about whatever axis."""
        return cls.travelled("rad", lambda time: _size(motion.twist(time)[0]), until)

    @classmethod
    def path(cls, motion: Motion, until: float) -> Coordinate:
        """Return the path of the body's origin."""
        return cls.travelled("mm", lambda time: _size(motion.twist(time)[1]), until)


def _size(vector: object) -> float:
    return float(norm(np.asarray(vector, float)))


class Travel:
    """Integral of a speed over time, by Simpson's rule over equal ticks.

    Within a tick it is the cubic with the travel and its rate at both ends. The speed is evaluated
    where the travel is asked for first.

    Parameters
    ----------
    speed : callable
        Takes a time [s]; returns what the travel grows by in a second.
    tick : float
        [s]

    Examples
    --------
    >>> travel = Travel(lambda time: 2.0 * time, tick=0.5)
    >>> travel.at(0.0), travel.at(1.25)
    (0.0, 1.5625)
    """

    def __init__(self, speed: Callable[[float], float], tick: float) -> None:
        self._speed, self._tick = speed, tick
        self._table: list[tuple[float, float]] = []

    def at(self, time: float) -> float:
        """Return the travel since t = 0, none before that."""
        tick, table, speed = self._tick, self._table, self._speed
        k = int(time / tick) if time > 0.0 else 0
        if not table:
            table.append((0.0, speed(0.0)))
        while len(table) <= k + 1:
            at, (travel, before) = len(table) * tick, table[-1]
            middle, end = speed(at - 0.5 * tick), speed(at)
            table.append((travel + tick / 6.0 * (before + 4.0 * middle + end), end))
        (s0, v0), (s1, v1) = table[k], table[k + 1]
        u = max(time, 0.0) / tick - k
        return (
            s0
            + u * u * (3.0 - 2.0 * u) * (s1 - s0)
            + u * (1.0 - u) * tick * ((1.0 - u) * v0 - u * v1)
        )
