"""A surface through runs, with the error by which it misses runs that it has not seen."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from shellcut.arrays import Floats

from .gaussian_process import GaussianProcess, is_there
from .inputs import Input
from .polynomial import Polynomial

_ONE_BY_ONE = 20
"""Runs up to which each is left out by itself; of more a tenth at a time."""

_MOST = 400
"""Runs through which a Gaussian process goes: its work grows with the cube of their number."""


class Surface(Protocol):
    """A figure as a function of the inputs."""

    inputs: tuple[Input, ...]

    @property
    def kind(self) -> str:
        """What it is, in words."""
        ...

    def predict(self, values: Floats) -> Floats:
        """Return the figure at values of the inputs, shape (n,)."""
        ...

    def draws(self, values: Floats, n_draw: int, rng: np.random.Generator) -> Floats:
        """Return surfaces that the runs also allow, shape (n_draw, n)."""
        ...


@dataclass(frozen=True)
class Fitted:
    """A surface and how well it predicts.

    Attributes
    ----------
    surface : Surface
    n_run : int
        Runs it rests on.
    n_fold : int
        Parts in which the runs were left out; ``n_run`` if one by one.
    error, mean_error : float
        Root-mean-square miss of runs left out, by the surface and by the mean of the others, in
        the unit of the figure.
    left_out : ndarray, shape (n_run,)
        Prediction of each run by a surface through the others.
    rows : ndarray, shape (n_run,)
        The runs, as rows of what was given.
    """

    surface: Surface
    n_run: int
    n_fold: int
    error: float
    mean_error: float
    left_out: Floats
    rows: np.ndarray[tuple[int], np.dtype[np.int64]]

    @property
    def explained(self) -> float:
        """Share of the variance of unseen runs that it predicts; 0 for the mean, 1 for all."""
        return 1.0 - (self.error / self.mean_error) ** 2


def fewest_runs(inputs: Sequence[Input]) -> int:
    """Return how many runs a surface needs at least: a plane, left-out runs and one more."""
    return 3 + sum(one.n_column for one in inputs)


def fit(inputs: Sequence[Input], values: Floats, figure: Floats) -> Fitted:
    """Return a surface through runs, a Gaussian process if scikit-learn is installed.

    Parameters
    ----------
    inputs : sequence of Input
    values : ndarray, shape (n, n_input)
    figure : ndarray, shape (n,)

    Raises
    ------
    ValueError
        If there are too few runs, or the figure is the same in all.
    """
    if len(figure) < (least := fewest_runs(inputs)):
        raise ValueError(
            f"a surface over {len(inputs)} factors must rest on {least} runs or more, got "
            f"{len(figure)}"
        )
    if is_constant(figure):
        raise ValueError(f"the figure must differ from run to run, got {figure[0]:g} in all")
    rows = np.arange(len(figure))
    gaussian = is_there()
    if gaussian and len(rows) > _MOST:
        rows = np.sort(np.random.default_rng(0).permutation(len(figure))[:_MOST])
        values, figure = values[rows], figure[rows]
    if gaussian:
        whole = GaussianProcess(inputs, values, figure)
        return _judged(
            whole, lambda v, f: GaussianProcess(inputs, v, f, like=whole), values, figure, rows
        )
    return _judged(
        Polynomial(inputs, values, figure),
        lambda v, f: Polynomial(inputs, v, f),
        values,
        figure,
        rows,
    )


def is_constant(figure: Floats) -> bool:
    """Whether a figure is the same in all runs, but for round-off."""
    return bool(np.ptp(figure) <= 1e-9 * max(np.abs(figure).max(), 1e-300))


def _judged(
    surface: Surface,
    again: Callable[[Floats, Floats], Surface],
    values: Floats,
    figure: Floats,
    rows: np.ndarray[tuple[int], np.dtype[np.int64]],
) -> Fitted:
    """Predict every run by a surface through the others."""
    n = len(figure)
    n_fold = n if n <= _ONE_BY_ONE else 10
    fold = np.random.default_rng(0).permutation(n) % n_fold
    predicted, mean = np.empty(n), np.empty(n)
    for k in range(n_fold):
        out = fold == k
        mean[out] = figure[~out].mean()
        if is_constant(figure[~out]):
            predicted[out] = mean[out]
        else:
            predicted[out] = again(values[~out], figure[~out]).predict(values[out])
    error, mean_error = (float(np.sqrt(np.mean((p - figure) ** 2))) for p in (predicted, mean))
    return Fitted(surface, n, n_fold, error, mean_error, predicted, rows)
