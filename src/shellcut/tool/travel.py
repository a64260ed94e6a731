"""The travel of a body from its speed: it only grows."""

from __future__ import annotations

from collections.abc import Callable


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
