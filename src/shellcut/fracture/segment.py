"""A straight piece of a crack."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from .quad_polygon import Point, along_side, corner_at


@dataclass(frozen=True)
class Segment:
    """A straight way of a crack through a row."""

    row: int
    entry: Point
    exit: Point
    side: int
    """Side of the quad on which the exit lies, FLANK on an earlier cut."""
    corner: int
    """Corner of the quad at the exit, -1 if it is none."""
    along_side: bool = False
    """Whether it runs from corner to corner along a side of the quad."""
    right: float = 1.0
    """Share of the row to the right of it, 1 along a side."""

    def reversed(self) -> Segment:
        """Return the same along a side the other way."""
        corner = corner_at(self.entry)
        return Segment(self.row, self.exit, self.entry, self.side, corner, self.along_side)

    def on_side_of(self, ring: Sequence[int]) -> tuple[tuple[int, int], float]:
        """Return the nodes of the side at which it ends, ascending, and where on it.

        ring : (4,), nodes at the corners of the row.
        """
        a, b = ring[self.side], ring[(self.side + 1) % 4]
        s = along_side(self.side, self.exit)
        return ((a, b), s) if a < b else ((b, a), 1.0 - s)
