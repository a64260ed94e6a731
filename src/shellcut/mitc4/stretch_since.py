"""How far the film's stretch since the last evaluation of all quads may have stiffened it.

An evaluation of all quads costs as much as tens of steps; this costs a third of one. Where a quad
has been stretched by epsilon its bound omega² has grown by up to 2 (1 + ½ C_max/a) epsilon
(:mod:`.frequency`). Bending is left out: it hardly changes what is evaluated.
"""

from __future__ import annotations

from math import sqrt
from typing import Annotated, NamedTuple

import numpy as np

from shellcut.arrays import Floats, Ints
from shellcut.numerics.borrowed import borrowed
from shellcut.numerics.jit import BoundOnce, inline, kernel
from shellcut.numerics.kept import Kept
from shellcut.numerics.vec3 import dot, load
from shellcut.state import State

from .element import modes


class LastEvaluation(NamedTuple):
    """The quads as they were."""

    squared: Annotated[Floats, "(n_quad,)"]
    """Bound of omega² [1/s²]."""
    metric: Annotated[Floats, "(n_quad, 3)"]
    """Of the centre, times sixteen: p · p, q · q, p · q [mm²]."""


class StretchSince(Kept):
    """Tells how much stiffer the stiffest quad may have become by stretch.

    Parameters
    ----------
    by_stretch : float
        Growth of omega over stretch.
    """

    kept_names = ("_last",)

    def __init__(self, by_stretch: float) -> None:
        self._by_stretch = by_stretch
        self._store, self._most = BoundOnce(_store_metrics), BoundOnce(_most_stretched)
        self._last = LastEvaluation(np.zeros(0), np.zeros((0, 3)))

    def take(self, state: State, squared: Floats) -> None:
        """Begin anew, with the bounds of all quads [1/s²], an array that is kept."""
        self._last = LastEvaluation(squared, np.empty((state.n_quad, 3)))
        self._store(0, state.node.x, state.quads, self._last.metric)

    def follow(self, state: State, squared: Floats) -> None:
        """Continue with other bounds [1/s²]: what acts on the quads has changed, or copies are new.

        The stretch of quads since the last evaluation stays; some of them may have been
        evaluated meanwhile, their stretch then counts twice.
        """
        known = len(self._last.metric)
        metric = np.concatenate([self._last.metric, np.empty((state.n_quad - known, 3))])
        self._store(known, state.node.x, state.quads, metric)
        self._last = LastEvaluation(squared, metric)

    @property
    def largest(self) -> float:
        """Largest bound of omega² at the last evaluation [1/s²]."""
        return float(self._last.squared.max())

    def growth(self, state: State) -> float:
        """Return the largest omega² by stretch since, over the largest then.

        Returns
        -------
        float
            1 before the first evaluation. Copies that have not been followed yet are left out.
        """
        if not self._last.squared.size:
            return 1.0
        most = self._most(state.node.x, state.quads, self._last, 2.0 * self._by_stretch)
        return most / self.largest


@inline
def _metric(x: Floats, quads: Ints, e: int) -> tuple[float, float, float]:
    p, q, _, _ = modes(
        load(x, quads[e, 0]), load(x, quads[e, 1]), load(x, quads[e, 2]), load(x, quads[e, 3])
    )
    return dot(p, p), dot(q, q), dot(p, q)


@kernel
def _store_metrics(first: int, x: Floats, quads: Ints, metric: Floats) -> None:
    """Write the metrics of the quads from the first on to metric : (n_quad, 3).

    x : (n_node, 3).  quads : (n_quad, 4).
    """
    for e in range(first, quads.shape[0]):
        metric[e, 0], metric[e, 1], metric[e, 2] = _metric(x, quads, e)


@kernel
def _most_stretched(x: Floats, quads: Ints, last: LastEvaluation, rate: float) -> float:
    """Return the largest of squared, each grown by rate times its largest stretch.

    x : (n_node, 3).  quads : (n, 4), of the last evaluation and, behind these, copies that are
    newer.
    """
    last = borrowed(last)
    most = 0.0
    for e in range(last.squared.shape[0]):
        a, b, c = last.metric[e, 0], last.metric[e, 1], last.metric[e, 2]
        pp, qq, pq = _metric(x, quads, e)
        # The largest eigenvalue of the metric on the old one is the square of the stretch.
        # Trace and determinant of the new metric on the old one give its eigenvalues.
        area = a * b - c * c
        half = 0.5 * (pp * b + qq * a - 2.0 * pq * c) / area
        product = (pp * qq - pq * pq) / area
        stretch = sqrt(half + sqrt(max(half * half - product, 0.0))) - 1.0
        most = max(most, last.squared[e] * (1.0 + rate * max(stretch, 0.0)))
    return most
