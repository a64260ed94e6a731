"""Sobol' indices of a surface: which share of a figure's variance comes from which input.

The first-order index of an input is the share of the variance that goes if the input is known; the
total index adds its share of what several inputs do together [Sobol1993], [Saltelli2010]. SciPy
estimates them from the surface at Sobol' points.

The intervals hold both errors of that: they are quantiles over surfaces that the runs also allow,
each with its own resampling of the points [LeGratiet2014].
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from shellcut.arrays import Floats

from .surface import Surface, at_shares

_N_DRAW = 200
_EVALUATIONS = 2600
"""Of one surface, about; a draw of a Gaussian process takes the cube of this."""


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
