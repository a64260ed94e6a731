r"""The result of a fit: values, how far the data tell them, and the curves.

With the derivatives J of the n residuals r at the best of p parameters and P = (Jᵀ J)⁻¹, errors e
of the residuals shift the parameters, in their logarithm, by P Jᵀ e (Gauss-Newton). The errors of
curve c have a variance s_c² of their own, as a residual carries the share of its point in the
curve, and correlations S_c (:mod:`.curve_misfit`); those of two curves are independent. So the
covariance of the parameters is a sum over the curves,

    C = sum_c s_c² A_c P,    A_c = P J_cᵀ S_c J_c,    s_c² = r_c·r_c / (n_c - tr A_c).

From r_c·r_c the variance s_c² is known as if from nu_c = (n_c - tr A_c)² / tr (M_c S_c)²
independent errors, M_c = 1 - J_c P J_cᵀ; so C_kk = sum_c C_kk,c is known as if from
nu_k = C_kk² / sum_c (C_kk,c² / nu_c) ([Satterthwaite1946]). The 95 % interval is the value times
exp(± t sqrt(C_kk)), t Student's with nu_k degrees of freedom. Of one curve without correlations
this is r·r / (n - p) P and nu = n - p. The interval says how well the data determine the parameters
of *this* model, not whether the model is right.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.files.whole_file import write_text
from shellcut.results.comparison import Comparison, finite
from shellcut.view import Curve, Diagram, can_draw, draw_curves

from .curve_misfit import correlations, residuals
from .factors import at_bound
from .fit_runs import FitRuns

FIT, PICTURE = "fit.json", "fit.png"

_LEVEL = 0.95
_APART = 0.98
"""Correlation of two parameters beyond which the data do not tell them apart: each interval is then
five times as wide as if the other were known."""
_LEAST_LEFT = 1e-6
"""Part of a curve's points, less than which is round-off: all of the curve went into the parameters
and nothing is left to tell its errors."""
_NEAR = 2e-3
"""Part of a range, by its logarithm, to which a fit comes near to an end that it is kept from."""
_WIDE = 1.5
"""Factor from the value to the end of its interval beyond which it is not determined."""


@dataclass(frozen=True)
class FittedValue:
    """A fitted parameter."""

    key: str
    unit: str
    start: float
    value: float
    """In the unit."""
    low: float
    high: float
    """Ends of the 95 % interval; nan for one that follows from the others, and if it is unknown."""


@dataclass(frozen=True, eq=False)
class FitResult:
    """What a fit has found."""

    values: tuple[FittedValue, ...]
    rms: float
    rms_at_start: float
    """Root mean square difference over the measured peak, now and at the start."""
    correlation: Floats
    """Of the varied parameters, shape (n, n); nan with one whose interval is unknown."""
    n_run: int
    """Runs it rests on."""
    notes: tuple[str, ...]
    """How far the data tell the parameters, in words."""
    comparisons: list[Comparison]
    """The curves at the best parameters."""
    at_start: list[Comparison]
    """The same at the start."""
    settings: tuple[Mapping[str, object], ...]
    """Keys that the experiment of each curve had otherwise."""

    def __str__(self) -> str:
        """Return a small table and the notes."""
        lines = [f"{'key':<34}{'start':>12}{'fitted':>12}   95 % interval"]
        for k, one in enumerate(self.values):
            without = "unknown" if k < len(self.correlation) else "follows"
            between = f"{one.low:.4g} to {one.high:.4g}" if one.low == one.low else without
            unit = f" {one.unit}" if one.unit else ""
            lines.append(f"{one.key:<34}{one.start:>12.5g}{one.value:>12.5g}   {between}{unit}")
        lines.append(
            f"difference {100 * self.rms:.2f} % of the peak (rms), {100 * self.rms_at_start:.2f} % "
            f"at the start; {self.n_run} runs"
        )
        return "\n".join([*lines, *self.notes])

    def write(self, folder: Path) -> None:
        """Write ``fit.json`` and, with Matplotlib, ``fit.png``."""
        figures = {
            "said": str(self),
            "values": [asdict(one) for one in self.values],
            "rms_relative": self.rms,
            "rms_relative_at_start": self.rms_at_start,
            "correlation": self.correlation.tolist(),
            "n_run": self.n_run,
            "notes": list(self.notes),
            "curves": [
                {
                    "y": one.y_name,
                    "settings": dict(settings),
                    "rms_relative": float(np.linalg.norm(residuals([one]))),
                }
                for one, settings in zip(self.comparisons, self.settings, strict=True)
            ],
        }
        write_text(folder / FIT, json.dumps(finite(figures), indent=1))
        if can_draw():
            diagrams = []
            for now, before, settings in zip(
                self.comparisons, self.at_start, self.settings, strict=True
            ):
                curves = [
                    Curve("measured", now.measured, "measured"),
                    Curve("at the start", before.simulated, "contact", x=before.x),
                    Curve("fitted", now.simulated),
                ]
                said = [f"{key} = {value}" for key, value in settings.items()]
                if now.window:
                    said.append(f"all averaged over {now.window:.3g} {now.x_unit}")
                diagrams.append(
                    Diagram(
                        now.x,
                        curves,
                        now.x_name,
                        now.x_unit,
                        now.y_name,
                        now.y_unit,
                        title=", ".join(said),
                    )
                )
            draw_curves(folder / PICTURE, diagrams, size=(9.0, 4.0 * len(diagrams)))


def result_of(runs: FitRuns, slopes: Floats, ended: str) -> FitResult:
    """Return the result of all runs, with the derivatives of the residuals and why they ended."""
    best = runs.best()
    found, at_start = runs.at(best), runs.at(np.zeros(best.size))
    missed, comparisons, start = found.residuals, found.comparisons, at_start.residuals
    n_curve = len(comparisons)
    # Without the derivatives of some, the intervals of the others are those with these as they are.
    known = np.flatnonzero(~np.isnan(slopes).any(axis=0))
    covariance, nu = np.full((best.size, best.size), np.nan), np.full(best.size, np.nan)
    covariance[np.ix_(known, known)], nu[known] = covariance_of(
        slopes[:, known], missed, [correlations(one) for one in comparisons]
    )
    spread = np.sqrt(np.diag(covariance))
    t = scipy.special.stdtrit(np.fmax(nu, 1.0), 0.5 + 0.5 * _LEVEL)
    with np.errstate(all="ignore"):
        correlation = covariance / np.outer(spread, spread)
        factors = [*np.exp(t * spread).tolist(), float("nan")]
    values = runs.parameters.values(best.tolist())
    fitted = []
    for one, factor in zip(runs.parameters.all, factors, strict=False):
        value = values[one.key]
        fitted.append(
            FittedValue(one.key, one.unit, one.start, value, value / factor, value * factor)
        )
    notes = [f"ended because {ended}", *_judged(runs, best, fitted, correlation)]
    return FitResult(
        values=tuple(fitted),
        rms=float(np.sqrt(missed @ missed / n_curve)),
        rms_at_start=float(np.sqrt(start @ start / n_curve)),
        correlation=correlation,
        n_run=runs.n_run,
        notes=tuple(notes),
        comparisons=comparisons,
        at_start=at_start.comparisons,
        settings=tuple(curve.settings for curve in runs.curves),
    )


@np.errstate(invalid="ignore")  # curves without any miss
def covariance_of(slopes: Floats, missed: Floats, alike: Sequence[Floats]) -> tuple[Floats, Floats]:
    """Return C, infinite where the data say nothing, and nu of each parameter, nan without a miss.

    slopes : J, shape (n, p).  missed : r, shape (n,).  alike : of each curve, the correlations of
    its points k apart.
    """
    n, p = slopes.shape
    unknown = np.diag(np.full(p, np.inf)), np.ones(p)
    information = slopes.T @ slopes
    largest = float(np.trace(information))
    if n <= p or not largest > 0.0:
        return unknown
    # Of a singular matrix the inverse would be round-off. So each parameter is as if measured by
    # itself, too, with errors like those of the curves, but far beyond any use.
    alone = 1e-12 * largest * np.eye(p)
    P = np.linalg.inv(information + alone)
    ends = np.cumsum([len(c) for c in alike])[:-1]
    parts, per_nu = [], []
    for c, J, r in zip(alike, np.split(slopes, ends), np.split(missed, ends), strict=True):
        S_J = scipy.linalg.matmul_toeplitz(c, J)
        B = J.T @ S_J
        A = P @ B
        left = len(c) - float(np.trace(A))
        if not left > _LEAST_LEFT * len(c):
            return unknown
        squares = len(c) + 2.0 * float(np.arange(len(c) - 1, 0, -1) @ c[1:] ** 2)
        squares += float(np.trace(A @ A)) - 2.0 * float(np.trace(P @ S_J.T @ S_J))
        parts.append(float(r @ r) / left * P @ (B + alone / len(alike)) @ P)
        per_nu.append(squares / left**2)
    C = np.sum(parts, axis=0)
    shares = np.diagonal(parts, axis1=1, axis2=2) / np.diag(C)
    return C, 1.0 / (np.array(per_nu) @ shares**2)


def _judged(
    runs: FitRuns, best: Floats, fitted: list[FittedValue], correlation: Floats
) -> list[str]:
    """Return in words how far the data tell the parameters."""
    notes = []
    low, high = runs.parameters.bounds()
    for k, one in enumerate(fitted[: best.size]):
        notes += [
            f"the data cannot tell {fitted[j].key} and {one.key} apart (correlation "
            f"{correlation[j, k]:.3f}): a change of one is made up by the other, only a "
            "combination of both is determined; fix one of them, or add a curve on which "
            "they act differently"
            for j in range(k)
            if abs(correlation[j, k]) > _APART
        ]
        if one.high != one.high:
            notes.append(
                f"the interval of {one.key} is unknown, as no run with values near it could be "
                "taken; the other intervals hold only for this value"
            )
        elif not one.high < _WIDE * one.value:
            notes.append(
                f"the data hardly determine {one.key}: with 95 % it lies between {one.low:.3g} and "
                f"{one.high:.3g} {one.unit}".rstrip()
            )
        if at_bound(best[k], low[k], high[k], _NEAR):
            notes.append(f"{one.key} lies at a bound, {one.value:.4g} {one.unit}: widen it")
    tried = runs.tried.values()
    notes += [f"distrust, at the fitted values: {doubt}" for doubt in runs.at(best).doubts]
    if n_doubted := sum(bool(one.doubts) for one in tried):
        notes.append(f"the verdict distrusts {n_doubted} of {len(tried)} sets of values")
    if failures := [one.failure for one in tried if one.failure]:
        notes.append(f"{len(failures)} sets of values could not be run: {failures[0]}")
    return notes
