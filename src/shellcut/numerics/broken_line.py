"""Piecewise linear curve: exact values, means and integrals."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats


@dataclass(frozen=True, eq=False)
class BrokenLine:
    """A piecewise linear curve, given by its corners.

    Examples
    --------
    >>> line = BrokenLine(np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, 2.0]))
    >>> line.integral(0.5, 2.0)
    2.75
    """

    x: Floats
    """Increasing, shape (n,)."""
    y: Floats
    """Shape (n,)."""

    def points_within(self, a: float, b: float) -> Floats:
        """Return a, the corners between a and b, and b."""
        return np.concatenate(([a], self.x[(self.x > a) & (self.x < b)], [b]))

    def at(self, x: Floats) -> Floats:
        """Return the values at x."""
        return np.interp(x, self.x, self.y)

    def mean_at(self, x: Floats, window: float) -> Floats:
        """Return the means over a window around x, which narrows near the ends of the line."""
        half = np.minimum(0.5 * window, np.minimum(x - self.x[0], self.x[-1] - x))
        wide = half > 0.0
        means = self.at(x)
        x, half = x[wide], half[wide]
        means[wide] = (self.integrals(x + half) - self.integrals(x - half)) / (2.0 * half)
        return means

    def integral(self, a: float, b: float) -> float:
        """Return the exact integral from a to b."""
        ends = self.integrals(np.array([a, b], float))
        return float(ends[1] - ends[0])

    def integrals(self, x: Floats) -> Floats:
        """Return the exact integrals from the first corner to x."""
        width = np.diff(self.x)
        slope = np.diff(self.y) / width
        whole = np.concatenate(([0.0], np.cumsum(0.5 * width * (self.y[1:] + self.y[:-1]))))
        k = np.clip(np.searchsorted(self.x, x, side="right") - 1, 0, len(width) - 1)
        d = x - self.x[k]
        return np.asarray(whole[k] + d * (self.y[k] + 0.5 * d * slope[k]))
