"""Limited-memory BFGS ([NocedalWright2006]) with a bisecting line search.

Implemented here because SciPy's version calls threaded linear algebra on vectors of a few thousand
entries: that took ten times as long on a busy machine, and sums whose order depends on the number
of threads would make the mesh differ between machines.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Callable

import numpy as np

from shellcut.arrays import Floats

_MEMORY = 12
_SUFFICIENT = 1e-4  # smallest ratio of actual to predicted decrease of a step
_FLATTER = 0.9  # largest ratio of slopes after and before a step
_TRIALS = 30


def minimise(
    function: Callable[[Floats], tuple[float, Floats]],
    start: Floats,
    *,
    n_step: int,
    tolerance: float,
    first_move: float,
) -> Floats:
    """Return a minimum of a smooth function, starting at ``start``.

    Parameters
    ----------
    function : callable
        Returns the value and the gradient, of the shape of ``start``.
    start : ndarray, shape (n,)
    n_step : int
        Largest number of steps.
    tolerance : float
        Stop when a step lowers the value by less.
    first_move : float
        Largest change of an unknown in the first step.
    """
    x = start
    value, gradient = function(x)
    pairs: deque[tuple[Floats, Floats, float]] = deque(maxlen=_MEMORY)
    for _ in range(n_step):
        way = -_inverse_times(pairs, gradient)
        slope = _dot(way, gradient)
        if slope >= 0.0:
            pairs.clear()
            way, slope = -gradient, -_dot(gradient, gradient)
        if slope == 0.0:
            break
        length = 1.0 if pairs else first_move / float(np.abs(way).max())
        found = _search(function, x, value, way, slope, length)
        if found is None:
            break
        move, new_value, new_gradient = found
        change = new_gradient - gradient
        if _dot(move, change) > 0.0:
            pairs.append((move, change, 1.0 / _dot(move, change)))
        fall = value - new_value
        x, value, gradient = x + move, new_value, new_gradient
        if fall < tolerance:
            break
    return x


def _dot(a: Floats, b: Floats) -> float:
    # pairwise sum: bitwise the same for any number of threads
    return float((a * b).sum())


def _inverse_times(pairs: deque[tuple[Floats, Floats, float]], gradient: Floats) -> Floats:
    q = gradient.copy()
    shares = []
    for move, change, rho in reversed(pairs):
        share = rho * _dot(move, q)
        shares.append(share)
        q -= share * change
    if pairs:
        move, change, rho = pairs[-1]
        q /= rho * _dot(change, change)
    for (move, change, rho), share in zip(pairs, reversed(shares), strict=True):
        q += (share - rho * _dot(change, q)) * move
    return q


def _search(
    function: Callable[[Floats], tuple[float, Floats]],
    x: Floats,
    value: float,
    way: Floats,
    slope: float,
    length: float,
) -> tuple[Floats, float, Floats] | None:
    # double until the slope is positive, bisect between too short and too long
    short, long = 0.0, np.inf
    best = None
    for _ in range(_TRIALS):
        move = length * way
        new_value, gradient = function(x + move)
        if not new_value <= value + _SUFFICIENT * length * slope:
            long = length
        else:
            best = move, new_value, gradient
            if _dot(gradient, way) >= _FLATTER * slope:
                break
            short = length
        length = 2.0 * length if np.isinf(long) else 0.5 * (short + long)
    return best
