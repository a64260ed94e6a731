"""A surface through the figure of many runs: how well it predicts, and what it is sensitive to.

It gives the figure as a function of a few inputs, and knows nothing of runs and of models. It is a
Gaussian process of scikit-learn. The covariance is Matérn's of 5/2 with a length for each column,
and a noise that does not depend on the place [RasmussenWilliams2006] 4.2; all are those of the
largest likelihood.

The first-order Sobol' index of an input is the share of the variance that goes if the input is
known; the total index adds its share of what several inputs do together [Sobol1993],
[Saltelli2010]. SciPy estimates them from the surface at Sobol' points. The intervals hold both
errors of that: they are quantiles over surfaces that the runs also allow, each with its own
resampling of the points [LeGratiet2014].
"""

from __future__ import annotations

import importlib.util
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import scipy

from shellcut.arrays import Floats

_ONE_BY_ONE = 20
"""Runs up to which each is left out by itself; of more a tenth at a time."""

_MOST = 400
"""Runs through which a surface goes: its work grows with the cube of their number."""

_RESTARTS = 2
"""Other starts of the search for the lengths, against a poor maximum."""

_LENGTHS = (0.1, 1e3)
"""Of the columns, which go from -1 to 1; the longest is a plane."""

_NOISES = (1e-9, 1e1)
"""Variances of the noise over that of the figure."""

_N_DRAW = 200
_EVALUATIONS = 2600
"""Of one surface, about; a draw of a Gaussian process takes the cube of this."""


@dataclass(frozen=True)
class Input:
    """A number between two ends, or a name out of a list.

    A number becomes a column from -1 to 1. A name out of a list becomes a column for each name of
    the list, 1 where it is that name; two names share one column.
    """

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


def is_there() -> bool:
    """Whether scikit-learn is installed."""
    return importlib.util.find_spec("sklearn") is not None


def fewest_runs(inputs: Sequence[Input]) -> int:
    """Return how many runs a surface needs at least: a plane, left-out runs and one more."""
    return 3 + sum(one.n_column for one in inputs)


def is_constant(figure: Floats) -> bool:
    """Whether a figure is the same in all runs, but for round-off."""
    return bool(np.ptp(figure) <= 1e-9 * max(np.abs(figure).max(), 1e-300))


class Surface:
    """A figure as a function of the inputs, and how well it predicts.

    The figure is not constant, of :func:`fewest_runs` or more.
    """

    def __init__(self, inputs: Sequence[Input], values: Floats, figure: Floats) -> None:
        from sklearn.dummy import DummyRegressor
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
        from sklearn.model_selection import PredefinedSplit, cross_val_predict

        self.inputs = tuple(inputs)
        self.rows = np.arange(len(figure))
        if len(self.rows) > _MOST:
            self.rows = np.sort(np.random.default_rng(0).permutation(len(figure))[:_MOST])
        """The runs it rests on, as rows of what was given, shape (n_run,)."""
        columns, figure = columns_of(inputs, values[self.rows]), figure[self.rows]
        lengths = Matern(np.full(columns.shape[1], 2.0), _LENGTHS, nu=2.5)
        kernel = ConstantKernel(1.0, (1e-3, 1e4)) * lengths + WhiteKernel(1e-3, _NOISES)
        self._process: Any = GaussianProcessRegressor(
            kernel, normalize_y=True, n_restarts_optimizer=_RESTARTS, random_state=0
        )
        self.n_run = len(figure)
        self.n_fold = self.n_run if self.n_run <= _ONE_BY_ONE else 10
        """Parts in which the runs were left out; ``n_run`` if one by one."""
        places = np.random.default_rng(0).permutation(self.n_run)
        parts = PredefinedSplit(places % self.n_fold)
        with warnings.catch_warnings():  # a length at its end is a plane, no noise a good fit
            warnings.simplefilter("ignore", ConvergenceWarning)
            self._process.fit(columns, figure)
            # Through a part of the runs the search begins at the lengths of all.
            again = GaussianProcessRegressor(self._process.kernel_, normalize_y=True)
            self.left_out: Floats = cross_val_predict(again, columns, figure, cv=parts)
            """Prediction of each run by a surface through the others, shape (n_run,)."""
        mean = cross_val_predict(DummyRegressor(), columns, figure, cv=parts)
        self.error, self.mean_error = (
            float(np.sqrt(np.mean((one - figure) ** 2))) for one in (self.left_out, mean)
        )
        """Root-mean-square miss of runs left out, by the surface and by the mean of the others."""
        self._scale = float(np.std(figure))

    @property
    def explained(self) -> float:
        """Share of the variance of unseen runs that it predicts; 0 for the mean, 1 for all."""
        return 1.0 - (self.error / self.mean_error) ** 2

    def predict(self, values: Floats) -> Floats:
        """Return the figure at values of the inputs, shape (n,)."""
        return np.asarray(self._process.predict(columns_of(self.inputs, values)))

    def mean_over_others(self, places: Mapping[int, Floats], n_other: int) -> Floats:
        """Return the mean over all other inputs, at the grid of places of some, by their number."""
        others = at_shares(
            self.inputs, scipy.stats.qmc.Sobol(len(self.inputs), seed=0).random(n_other)
        )
        grid = np.meshgrid(*places.values(), indexing="ij")
        mean = np.zeros(grid[0].shape)
        for other in others:
            points = np.tile(other, (mean.size, 1))
            for k, at in zip(places, grid, strict=True):
                points[:, k] = at.ravel()
            mean += self.predict(points).reshape(mean.shape) / n_other
        return mean

    def draws(self, values: Floats, n_draw: int, rng: np.random.Generator) -> Floats:
        """Return surfaces that the runs also allow, shape (n_draw, n), without the noise."""
        mean, covariance = self._process.predict(columns_of(self.inputs, values), return_cov=True)
        noise = self._process.kernel_.k2.noise_level * self._scale**2
        covariance[np.diag_indices_from(covariance)] -= noise
        root = _root(covariance, 1e-8 * self._scale**2)
        return np.asarray(mean + rng.standard_normal((n_draw, len(mean))) @ root.T)


def _root(covariance: Floats, least: float) -> Floats:
    """Return a triangular root; the little that is added keeps round-off from making it none."""
    diagonal = np.diag_indices_from(covariance)
    while True:
        covariance[diagonal] += least
        try:
            root: Floats = scipy.linalg.cholesky(covariance, lower=True, check_finite=False)
            return root
        except scipy.linalg.LinAlgError:
            least *= 10.0


@dataclass(frozen=True)
class Indices:
    """Sobol' indices of all inputs, in their order."""

    first: Floats
    total: Floats
    """Medians over the surfaces, shape (n_input,)."""
    first_interval: Floats
    total_interval: Floats
    """Within which 95 % of them lie, shape (n_input, 2)."""
    n_point: int
    """Points of one sample of the estimate."""
    n_draw: int
    """Surfaces."""


def sobol_indices(surface: Surface, *, seed: int = 0) -> Indices:
    """Return the indices of a surface of two inputs or more, independent and evenly distributed."""
    inputs, n_input = surface.inputs, len(surface.inputs)
    n = 2 ** int(np.log2(_EVALUATIONS / (n_input + 2)))
    rng = np.random.default_rng(seed)
    shares = scipy.stats.qmc.Sobol(2 * n_input, seed=rng).random(n)
    a, b = shares[:, :n_input], shares[:, n_input:]
    mixed = np.repeat(a[None], n_input, axis=0)
    for k in range(n_input):
        mixed[k, :, k] = b[:, k]
    places = at_shares(inputs, np.concatenate([a, b, *mixed]))
    drawn = surface.draws(places, _N_DRAW, rng).reshape(_N_DRAW, n_input + 2, n)
    # each surface at its own resampling of the points
    chosen = rng.integers(n, size=(_N_DRAW, 1, n))
    drawn = np.take_along_axis(drawn, chosen, axis=2).transpose(1, 0, 2)
    drawn = drawn - drawn.mean(axis=(0, 2), keepdims=True)  # which makes the estimates stable
    found = scipy.stats.sobol_indices(
        func={"f_A": drawn[0], "f_B": drawn[1], "f_AB": drawn[2:]}, n=n
    )
    first, total = np.clip(found.first_order, 0.0, 1.0), np.maximum(found.total_order, 0.0)
    return Indices(
        np.median(first, axis=0),
        np.median(total, axis=0),
        np.quantile(first, (0.025, 0.975), axis=0).T,
        np.quantile(total, (0.025, 0.975), axis=0).T,
        n,
        _N_DRAW,
    )
