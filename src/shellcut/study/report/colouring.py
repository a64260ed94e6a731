"""Groups of runs by a factor, each with a colour and a name in the legend."""

from __future__ import annotations

import itertools
from dataclasses import dataclass

import numpy as np

from shellcut.arrays import Bools, Ints
from shellcut.unit import after
from shellcut.view.curves import PALETTE

from .studied import Studied


@dataclass(frozen=True)
class Colouring:
    """Groups of runs by one factor."""

    factor: str
    """Its name."""
    names: tuple[str, ...]
    """Of the groups, in order."""
    group: Ints
    """Of each run, shape (n,)."""

    def style(self, group: int) -> str:
        """Return the style of a group's lines, from the first to the last of the palette."""
        n = len(PALETTE)
        if len(self.names) > n:
            return f"c{group % n}"
        return f"c{round(group * (n - 1) / max(1, len(self.names) - 1))}"

    def color(self, group: int) -> str:
        """Return the colour of a group."""
        return PALETTE[int(self.style(group)[1:])]


def coloured_by(factor: Studied, rows: Bools | Ints) -> Colouring:
    """Return groups by the values of a factor, or by even parts of its range."""
    values, unit = factor.values[rows], after(factor.unit)
    if factor.names:
        return Colouring(factor.name, factor.names, values.astype(int))
    levels = np.unique(values)
    if len(levels) <= len(PALETTE):
        names = tuple(f"{factor.name} {level:.5g}{unit}" for level in levels)
        return Colouring(factor.name, names, np.searchsorted(levels, values))
    low, high = factor.ends
    bounds = np.linspace(low, high, len(PALETTE))  # one colour less: bounds that are easier to read
    group = np.clip(np.searchsorted(bounds, values, side="right") - 1, 0, len(PALETTE) - 2)
    names = tuple(
        f"{factor.name} {a:.4g} to {b:.4g}{unit}" for a, b in itertools.pairwise(bounds.tolist())
    )
    return Colouring(factor.name, names, group)
