"""A moment that recurs at equal intervals of time."""

from __future__ import annotations

from dataclasses import dataclass

from shellcut.arguments import checked


@checked
@dataclass
class Trigger:
    """Due at t = 0, then at the first step past every multiple of an interval of time [s]."""

    interval: float
    next: float = 0.0
    """The next moment [s]."""

    def __post_init__(self) -> None:
        if not self.interval > 0:
            raise ValueError(f"interval must be a positive time in s, got {self.interval!r}")

    def __call__(self, time: float) -> bool:
        """Whether the moment is reached; each moment is reported once."""
        if time < self.next:
            return False
        self.next = (time // self.interval + 1.0) * self.interval
        return True
