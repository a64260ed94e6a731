"""Designs: which values the factors take together in each run.

A grid takes every combination. Sobol' points and a Latin hypercube fill the box of the ranges
evenly with any number of runs [McKay1979], [Sobol1967]; SciPy makes both.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Literal

import scipy

from shellcut.arguments import Option, checked

from .factors import Factor

Kind = Literal["grid", "sobol", "lhs"]


@checked
@dataclass(frozen=True)
class Design:
    """How the values of the factors are combined.

    Examples
    --------
    >>> Design("sobol", 16).n
    16
    """

    kind: Annotated[
        Kind, Option("", "every combination; Sobol' points, scrambled; a Latin hypercube")
    ] = "grid"
    n: Annotated[int | None, Option("", "number of runs of sobol or lhs", least=1)] = None
    seed: Annotated[int, Option("", "of sobol and lhs; another gives other points", least=0)] = 0

    def __post_init__(self) -> None:
        if self.kind == "grid" and self.n is not None:
            raise ValueError("a grid has as many runs as combinations: leave out n")
        if self.kind != "grid" and self.n is None:
            raise ValueError(f"a {self.kind} design needs a number of runs, such as n=16")

    def runs(self, factors: Sequence[Factor]) -> list[dict[str, object]]:
        """Return the values of all factors in each run, by key.

        Raises
        ------
        ValueError
            If a factor of a grid is a range.
        """
        several: Iterable[Sequence[object]]
        if self.kind == "grid":
            if ranges := [f"{f.name} = {f.ends[0]:g}:{f.ends[1]:g}" for f in factors if f.ends]:
                raise ValueError(
                    f"a grid takes lists of values, and {', '.join(ranges)} is a range: write the "
                    "values, or choose the design sobol or lhs with a number of runs"
                )
            several = itertools.product(*(factor.values for factor in factors))
        else:
            points = self._points(len(factors)) if factors else [[]]
            several = ([f.at(u) for f, u in zip(factors, row, strict=True)] for row in points)
        runs = []
        for values in several:
            each = zip(factors, values, strict=True)
            runs.append({key: one for f, v in each for key, one in f.settings(v).items()})
        return runs

    def _points(self, n_factor: int) -> list[list[float]]:
        """Return points of the unit cube."""
        assert self.n is not None
        if self.kind == "lhs":
            points = scipy.stats.qmc.LatinHypercube(n_factor, seed=self.seed).random(self.n)
        else:
            # Whole powers of two keep the balance of the sequence; the first n are of that.
            power = math.ceil(math.log2(self.n))
            sobol = scipy.stats.qmc.Sobol(n_factor, seed=self.seed)
            points = sobol.random_base2(power)[: self.n]
        listed: list[list[float]] = points.tolist()
        return listed
