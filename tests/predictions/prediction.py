"""A prediction: what is published, our model of it, our values with error bars, and the verdict.

Each case is a file beside this one with a ``PREDICTION``. The page (``run.py``) and the slow tests
(``test_predictions.py``) read the same declaration.

With the mean m of the runs on the finest mesh, edges q times those of the next, m' of the next,
m_v of slower runs beside m, and s the standard deviation of n repeated runs,

    value = m + (m_v - m),
    mesh = q / (1 - q) |m - m'|,   speed = |m_v - m|,   scatter = t s / sqrt(n)

as in docs/howto/converge.md, but for means: a single run is off by t s. The half-width is the root
of the sum of their squares. A case may derive a value from several runs instead, with parts of its
own, such as the interval of a fit or the scatter of what had to be guessed.
"""

import math
import sys
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeAlias

import numpy as np
import scipy

TESTS = Path(__file__).resolve().parents[1]
# Models of tests that a prediction shares.
sys.path += [str(TESTS), str(TESTS / "verification")]


BLIND, KNOWN = "*blind, not compared yet*", "*not blind, not compared yet*"
"""Results before the comparison: nobody who made the prediction knows the value, or somebody may.
"""


@dataclass(frozen=True)
class Figure:
    """A published number.

    Attributes
    ----------
    name : str
        As the runs return it.
    published : str
        The number, in words.
    low, high : float
        Its band; without one our value stands alone.
    short : (float, float), optional
        What the mean of the short runs must lie in where that is not the band, because our figure
        misses it or only finer meshes reach it: four standard deviations of such a mean and more
        about it.
    waits : str
        Result of a value that has not been compared yet, :data:`BLIND` or :data:`KNOWN`.
    """

    name: str
    published: str
    low: float = math.nan
    high: float = math.nan
    short: tuple[float, float] | None = None
    waits: str = ""


@dataclass(frozen=True)
class Run:
    """A run: its arguments, edges [mm], the speed over that of the model, and what it is for."""

    keys: Mapping[str, Any]
    edge: float
    speed: float = 1.0
    short: bool = False


Results: TypeAlias = Mapping[str, Mapping[str, Any]]
"""What the runs of a case returned, by name."""
Derived: TypeAlias = tuple[float, Mapping[str, float], int]
"""A value, the parts of its half-width, and the number of its runs."""


@dataclass(frozen=True)
class Prediction:
    """A case.

    Attributes
    ----------
    title, source, sure, model : str
        Of the page: what it is, who published it, how sure that is, and what our model takes from
        where.
    figures : tuple of Figure
    runs : mapping from str to Run
    run : callable
        Runs with the keys of a run; returns figures by name, and lists for the picture.
    picture : callable
        Draws, from what the runs returned by name, to a path.
    said : str
        What the result says, after it is known.
    caption : str
        Of the picture; the title by default.
    derive : callable, optional
        Returns value, parts of the half-width and number of runs of figures that need several runs,
        by name; or an answer in words.
    """

    title: str
    source: str
    sure: str
    model: str
    figures: tuple[Figure, ...]
    runs: Mapping[str, Run]
    run: Callable[..., dict[str, Any]]
    picture: Callable[[Mapping[str, dict[str, Any]], Path], None]
    said: str = ""
    caption: str = ""
    derive: Callable[[Results], Mapping[str, Derived | str]] | None = None


@dataclass(frozen=True)
class Found:
    """A figure with its error bar: value, half-width by part, and the scatter of single runs.

    Or an answer in words.
    """

    figure: Figure
    value: float
    parts: Mapping[str, float]
    scatter: float = math.nan
    n: int = 1
    words: str = ""

    @property
    def half_width(self) -> float:
        """Of the error bar."""
        return math.hypot(*self.parts.values())

    @property
    def hits(self) -> bool:
        """Whether the value lies in the published band."""
        return self.figure.low <= self.value <= self.figure.high

    @property
    def verdict(self) -> str:
        """Hit or miss, in words."""
        if self.figure.waits:
            return self.figure.waits
        if math.isnan(self.figure.low) or self.words:
            return "–"
        if self.hits:
            return "hit"
        near = self.figure.low if self.value < self.figure.low else self.figure.high
        inside = abs(self.value - near) <= self.half_width
        return "**miss**" + (", the error bar reaches the band" if inside else "")


def found(case: Prediction, figure: Figure, results: Results) -> Found:
    """Return a figure of a case with its error bar from what the runs returned."""
    derived = case.derive(results) if case.derive else {}
    if figure.name in derived:
        given = derived[figure.name]
        if isinstance(given, str):
            return Found(figure, math.nan, {}, n=0, words=given)
        value, parts, n = given
        return Found(figure, value, parts, n=n)
    return mean_of(case, figure, results)


def mean_of(case: Prediction, figure: Figure, results: Results) -> Found:
    """Return a figure with its error bar from the runs that have it themselves."""
    values = {name: one[figure.name] for name, one in results.items() if figure.name in one}
    if not values:
        return Found(figure, math.nan, {}, n=0)
    groups: dict[tuple[float, float], list[float]] = {}
    for name, value in values.items():
        groups.setdefault((case.runs[name].edge, case.runs[name].speed), []).append(value)
    edges = sorted({edge for edge, speed in groups if speed == 1.0})
    finest = groups[edges[0], 1.0]
    value, parts = float(np.mean(finest)), {}
    if len(edges) > 1:
        q = edges[0] / edges[1]
        parts["mesh"] = q / (1.0 - q) * abs(value - float(np.mean(groups[edges[1], 1.0])))
    for (edge, speed), slower in groups.items():
        if speed < 1.0:
            change = float(np.mean(slower) - np.mean(groups[edge, 1.0]))
            value, parts["speed"] = value + change, abs(change)
    off = np.concatenate([np.array(one) - np.mean(one) for one in groups.values()])
    free = len(off) - len(groups)
    scatter = float(np.sqrt((off**2).sum() / free)) if free else math.nan
    if free:
        t = float(scipy.stats.t.ppf(0.975, free))
        parts["scatter"] = t * scatter / math.sqrt(len(finest))
    return Found(figure, value, parts, scatter, len(values))
