"""Gaussian processes by scikit-learn: a smooth surface through the runs, with its uncertainty.

The covariance is Matérn's of 5/2 with a length for each column, and a noise that does not depend on
the place [RasmussenWilliams2006] 4.2; all are those of the largest likelihood.
"""

from __future__ import annotations

import importlib.util
import warnings
from collections.abc import Sequence
from typing import Any

import numpy as np
import scipy

from shellcut.arrays import Floats

from .inputs import Input, columns_of

_RESTARTS = 2
"""Other starts of the search for the lengths, against a poor maximum."""

_LENGTHS = (0.1, 1e3)
"""Of the columns, which go from -1 to 1; the longest is a plane."""

_NOISES = (1e-9, 1e1)
"""Variances of the noise over that of the figure."""


def is_there() -> bool:
    """Whether scikit-learn is installed."""
    return importlib.util.find_spec("sklearn") is not None


class GaussianProcess:
    """A Gaussian process of the inputs.

    Parameters
    ----------
    inputs : sequence of Input
    values : ndarray, shape (n, n_input)
    figure : ndarray, shape (n,)
        What to describe; not constant.
    like : GaussianProcess, optional
        Begin the search at the lengths of this one and search once: for a part of its runs.
    """

    kind = "a Gaussian process"

    def __init__(
        self,
        inputs: Sequence[Input],
        values: Floats,
        figure: Floats,
        *,
        like: GaussianProcess | None = None,
    ) -> None:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel

        self.inputs = tuple(inputs)
        columns = columns_of(inputs, values)
        kernel: Any
        if like is None:
            lengths = Matern(np.full(columns.shape[1], 2.0), _LENGTHS, nu=2.5)
            kernel = ConstantKernel(1.0, (1e-3, 1e4)) * lengths + WhiteKernel(1e-3, _NOISES)
        else:
            kernel = like._process.kernel_
        self._process: Any = GaussianProcessRegressor(
            kernel,
            normalize_y=True,
            n_restarts_optimizer=0 if like else _RESTARTS,
            random_state=0,
        )
        with warnings.catch_warnings():  # a length at its end is a plane, no noise a good fit
            warnings.simplefilter("ignore", ConvergenceWarning)
            self._process.fit(columns, figure)
        self._scale = float(np.std(figure))

    def predict(self, values: Floats) -> Floats:
        """Return the figure at values of the inputs, shape (n,)."""
        return np.asarray(self._process.predict(columns_of(self.inputs, values)))

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
