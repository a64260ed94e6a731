"""Inputs of a surface, and the columns of numbers that they become.

A number becomes a column from -1 to 1. A name out of a list becomes a column for each name of the
list, 1 where it is that name; two names share one column.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Floats


@dataclass(frozen=True)
class Input:
    """A number between two ends, or a name out of a list."""

    name: str
    ends: tuple[float, float]
    """Least and largest value of the study, run or not; of a list (0, number of names - 1)."""
    names: tuple[str, ...] = ()
    """The names, two or more; empty for a number. A value then is a place in this list."""

    @property
    def n_column(self) -> int:
        """Columns that it becomes."""
        return 1 if len(self.names) <= 2 else len(self.names)

    def columns(self, values: Floats) -> Floats:
        """Return the columns of values, shape (n, n_column)."""
        if self.n_column > 1:
            return np.asarray(values[:, None] == np.arange(len(self.names)), float)
        low, high = self.ends
        return np.asarray(2.0 * (values - low) / (high - low) - 1.0)[:, None]

    def at(self, shares: Floats) -> Floats:
        """Return the values at shares in [0, 1): evenly over the range, each name as often."""
        if self.names:
            last = len(self.names) - 1.0
            return np.asarray(np.minimum(np.floor(shares * len(self.names)), last))
        low, high = self.ends
        return low + shares * (high - low)


def columns_of(inputs: Sequence[Input], values: Floats) -> Floats:
    """Return the columns of all inputs, from values of shape (n, n_input)."""
    return np.hstack([one.columns(values[:, k]) for k, one in enumerate(inputs)])


def at_shares(inputs: Sequence[Input], shares: Floats) -> Floats:
    """Return the values at shares of the inputs, shape (n, n_input)."""
    return np.column_stack([one.at(shares[:, k]) for k, one in enumerate(inputs)])
