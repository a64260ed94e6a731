"""Content of a file of plane curves in one form for all formats; polygons that stand for curves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import acos, ceil, pi
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats, norm

LARGEST_FILE = 50_000_000
"""Largest size of a drawing [bytes]."""

FEWER_POINTS = "enlarge chord_deviation, or choose layers"
"""Remedy for too many points of curves."""

DEVIATION = 1e-4
"""Default chord deviation over the diagonal: 2 um for a film of 20 mm."""

LARGEST_TURN = pi / 18
"""Largest angle between the sides of a polygon for a curve [rad]: well below that of a corner."""


@dataclass(frozen=True, eq=False)
class Curve:
    """A curve as a polygon; closed if its first point is also the last."""

    points: Floats
    """In the file's unit, shape (n, 2)."""
    where: str
    """Layer and kind, for messages."""


@dataclass
class Drawing:
    """Curves as they are in the file."""

    path: Path
    curves: list[Curve]
    unit_mm: float | None
    """Length of the file's unit [mm]; None if the file does not state it."""
    no_unit: str = ""
    """Why the unit must be given, if it cannot be guessed from the size either."""
    notes: list[str] = field(default_factory=list)
    """Omissions of the reader."""

    def left_out(self, kinds: Mapping[str, int]) -> None:
        """Note how many of which kinds the reader has left out."""
        if kinds:
            listed = ", ".join(f"{n} {kind}" for kind, n in sorted(kinds.items()))
            self.notes.append(f"left out: {listed}")


def n_of_arc(radius: float, angle: float, deviation: float) -> int:
    """Return the number of chords of an arc, by deviation and turn.

    Examples
    --------
    >>> n_of_arc(10.0, 2.0 * pi, 1e-3), n_of_arc(0.01, 2.0 * pi, 1e-3)
    (223, 36)
    """
    turn = 2.0 * acos(1.0 - min(deviation / radius, 1.0)) if radius > 0.0 else pi
    return max(1, ceil(abs(angle) / min(turn, LARGEST_TURN)))


def extent_of(points: Floats) -> float:
    """Return the diagonal of the box around points, shape (n, 2)."""
    return float(norm(np.ptp(points, axis=0)))
