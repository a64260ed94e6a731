"""Polynomial surfaces by least squares, of the degree that predicts best what it has not seen."""

from __future__ import annotations

import itertools
import warnings
from collections.abc import Sequence

import numpy as np
import scipy

from shellcut.arrays import Floats, Ints

from .inputs import Input, columns_of, owners_of

_HIGHEST = 3
_RUNS_A_TERM = 1.5
"""Fewest runs for each coefficient; with fewer a polynomial follows the noise between the runs."""

Term = tuple[int, ...]
"""Columns that are multiplied; none for the constant."""


class Polynomial:
    """A polynomial of the inputs, with all products up to its degree.

    Parameters
    ----------
    inputs : sequence of Input
    values : ndarray, shape (n, n_input)
    figure : ndarray, shape (n,)
        What to describe.

    Raises
    ------
    ValueError
        If there are fewer runs than a plane needs: a run more than it has coefficients.
    """

    def __init__(self, inputs: Sequence[Input], values: Floats, figure: Floats) -> None:
        self.inputs = tuple(inputs)
        columns, owners = columns_of(inputs, values), owners_of(inputs)
        best = np.inf
        for degree in range(1, _HIGHEST + 1):
            terms = _terms(owners, self.inputs, degree)
            if degree > 1 and _RUNS_A_TERM * len(terms) > len(figure):
                break
            fit = _LeastSquares(_matrix(columns, terms), figure)
            if degree == 1 or fit.left_out < best:
                best, self.degree, self._terms, self._fit = fit.left_out, degree, terms, fit

    @property
    def kind(self) -> str:
        """What it is, in words."""
        return f"a polynomial of degree {self.degree}"

    def predict(self, values: Floats) -> Floats:
        """Return the figure at values of the inputs, shape (n,)."""
        matrix = _matrix(columns_of(self.inputs, values), self._terms)
        return np.asarray(matrix @ self._fit.coefficients)

    def draws(self, values: Floats, n_draw: int, rng: np.random.Generator) -> Floats:
        """Return surfaces that the runs also allow, shape (n_draw, n).

        Their coefficients are Student's t about those of the fit, by its covariance.
        """
        matrix = _matrix(columns_of(self.inputs, values), self._terms)
        normal = rng.standard_normal((n_draw, self._fit.root.shape[1]))
        scale = np.sqrt(self._fit.freedom / rng.chisquare(self._fit.freedom, n_draw))
        off = (normal * scale[:, None]) @ self._fit.root.T
        return np.asarray((self._fit.coefficients + off) @ matrix.T)


class _LeastSquares:
    """Coefficients, a root of their covariance, and the error at runs left out one by one."""

    def __init__(self, matrix: Floats, figure: Floats) -> None:
        u, s, vt = scipy.linalg.svd(matrix, full_matrices=False)
        rank = int((s > 1e-10 * s[0]).sum())
        u, s, vt = u[:, :rank], s[:rank], vt[:rank]
        self.freedom = len(figure) - rank
        if self.freedom < 1:
            raise ValueError(
                f"a surface must rest on more runs than its {rank} coefficients, got {len(figure)}"
            )
        self.coefficients = vt.T @ ((u.T @ figure) / s)
        missed = figure - matrix @ self.coefficients
        noise = np.sqrt(missed @ missed / self.freedom)
        self.root = noise * (vt.T / s)
        # A run left out is missed by more, by its leverage: no second fit is needed.
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RuntimeWarning)
            alone = missed / np.maximum(1.0 - (u * u).sum(axis=1), 1e-12)
        self.left_out = float(np.sqrt(np.mean(alone**2)))


def _terms(owners: Ints, inputs: Sequence[Input], degree: int) -> list[Term]:
    """Return the products of columns; those of one list of names are never multiplied."""
    found: list[Term] = []
    for n in range(degree + 1):
        for term in itertools.combinations_with_replacement(range(len(owners)), n):
            of_names = [int(owners[c]) for c in term if inputs[owners[c]].names]
            if len(set(of_names)) == len(of_names):
                found.append(term)
    return found


def _matrix(columns: Floats, terms: Sequence[Term]) -> Floats:
    return np.column_stack([columns[:, list(term)].prod(axis=1) for term in terms])
