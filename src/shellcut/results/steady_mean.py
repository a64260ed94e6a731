r"""Mean of a correlated series with its own ±, and a test for drifts and jumps.

A force f(s) over a path of length L has the integral W(s), known in some rows and linear between
them. Its mean is F = (W(L) - W(0))/L. Its components along cosines,

    Λ_j = (√2/L) ∫ f cos(π j s/L) ds,    j = 1 .. n,

have, at wavelengths at which the spectrum of f is flat, the variance of F each, mean 0, and are
independent of F and of each other [Mueller2007]. So

    F ± t s,    s² = (Λ_1² + ... + Λ_n²)/n,    t the 97.5 % quantile of Student's t with n degrees,

holds the expected force in 95 % of such runs [Lazarus2018]. A sawtooth has wavelengths too short to
count in it, and need not have whole periods in the window: what a broken period adds to F, it adds
to Λ_j, too. A force whose memory is short over the length Z has a flat spectrum at wavelengths of
Z and more, which are n = 2 L/Z cosines. No more than :data:`MOST` are taken, so that slow changes
count. Below :data:`LEAST` there is no ±.

*Short windows.* The end of a start, a exp(-s/Z), has the mean a (1 - exp(-L/Z)) Z/L and falls by
a (1 - exp(-L/Z)) from end to end: the mean is off by Z/L of what f still rises or falls. Below 3 Z
the test below hardly sees this. So Z/L of the rise of the fitted line is in the ±, as the root of
the sum of squares. Slower starts look like a steady force, and are not in the ±.

*Change.* A jump at the place r L gives Λ the direction sin(π j r)/j, a drift 1/j² for odd j.
Without either all directions in n dimensions are equally likely. With w the largest cosine of
an angle between Λ and ± these directions, the probability of such a w or a larger one is at most

    p = (ℓ/π)(1 - w²)^{(n-2)/2} + 2 P(cosine with one direction ≥ w or ≤ -w),

ℓ being the length of the curve of unit vectors that belong to the jumps: the volume of a tube about
a curve on a sphere [Hotelling1939], [Johnstone1989]; the second term counts the ends of the curve
and the drift. The force has changed if p < :data:`FALSE_ALARM`, and the levels differ by more than
:data:`CHANGED` of the mean. Less is not worth a refusal, and is in the ±.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.unit import with_unit

FALSE_ALARM = 0.05
"""Largest share of steady windows that are refused."""
CHANGED = 0.03
"""Difference of two levels over the mean that counts as a change."""
LEAST, MOST = 3, 8
"""Cosines, of which each is as good as an independent piece of the window."""

_LEVEL = 0.95
_SHORT = 3.0  # pieces of a window in which most drifts are not seen
_N_PLACE = 200  # at which a jump is looked for


@dataclass(frozen=True)
class Mean:
    """A mean with the half-width of its 95 % interval."""

    value: float
    half_width: float


@dataclass(frozen=True)
class Change:
    """A change of level within a window."""

    at: float | None
    """Where the level jumps, on the way; None if it drifts."""
    before: float
    after: float
    """Mean levels before and after a jump; those of the fitted line at both ends for a drift."""

    def text(self, name: str, unit: str, ends: tuple[float, float], x_unit: str) -> str:
        """Return the change in words; place of the jump and ends of the window in ``x_unit``."""
        before, after = (with_unit(level, unit) for level in (self.before, self.after))
        start, end = (with_unit(x, x_unit) for x in ends)
        if self.at is None:
            return f"the {name} drifts from {before} at {start} to {after} at {end}"
        at = with_unit(self.at, x_unit)
        means = f"its mean is {before} from {start} on, then {after} to {end}"
        return f"the {name} jumps at {at}: {means}"


def n_cosine(pieces: float) -> int:
    """Return how many cosines a window has that is ``pieces`` times as long as the memory."""
    return min(MOST, int(2.0 * pieces + 1e-9))


def mean_of(way: Floats, integral: Floats, pieces: float) -> Mean:
    """Return the mean of a series, from its integral (n_row,) over the path (n_row,).

    The path is ``pieces`` times as long as the memory of the series.
    """
    n = n_cosine(pieces)
    ends = float(way[-1] - way[0])
    t = float(scipy.special.stdtrit(n, 0.5 + 0.5 * _LEVEL))
    half_width = t * float(np.sqrt(np.mean(_components(way, integral, n) ** 2)))
    if pieces < _SHORT:
        drift = _drift(way, integral)
        half_width = float(np.hypot(half_width, (drift.after - drift.before) / pieces))
    return Mean(float(integral[-1] - integral[0]) / ends, half_width)


def change_in(way: Floats, integral: Floats, pieces: float) -> Change | None:
    """Return the jump or drift of a series, given as in :func:`mean_of`; None if it is steady."""
    n = n_cosine(pieces)
    found = _components(way, integral, n)
    if not (size := float(np.linalg.norm(found))) > 0.0:
        return None
    j = np.arange(1.0, n + 1.0)
    # Nearer to an end it looks like a broken period of the sawtooth, and is in the ±.
    r = np.linspace(1.0 / n, 1.0 - 1.0 / n, _N_PLACE)
    jumps = np.sin(np.pi * j * r[:, None]) / j
    jumps /= np.linalg.norm(jumps, axis=1)[:, None]
    drift = np.where(j % 2.0 == 1.0, 1.0 / j**2, 0.0)
    like_jumps = np.abs(jumps @ found) / size
    like_drift = abs(float(drift @ found)) / (size * float(np.linalg.norm(drift)))
    off = max(0.0, 1.0 - max(float(like_jumps.max()), like_drift) ** 2)
    curve = float(np.linalg.norm(np.diff(jumps, axis=0), axis=1).sum())
    one = float(scipy.special.betainc(0.5 * (n - 1), 0.5, off))
    if curve / np.pi * off ** (0.5 * (n - 2)) + 2.0 * one >= FALSE_ALARM:
        return None
    change = _drift(way, integral)
    if like_drift < like_jumps.max():
        change = _jump(way, integral, 0.5 / pieces)
    mean = float(integral[-1] - integral[0]) / float(way[-1] - way[0])
    return change if abs(change.after - change.before) > CHANGED * abs(mean) else None


def _components(way: Floats, integral: Floats, n: int) -> Floats:
    """Return Λ, shape (n,)."""
    along = (way - way[0]) / (way[-1] - way[0])
    step = np.diff(along)
    moved = step > 0.0
    force = np.diff(integral)[moved] / (step[moved] * (way[-1] - way[0]))
    j = np.arange(1, n + 1)[:, None]
    waves = np.diff(np.sin(np.pi * j * along))[:, moved] / (np.pi * j)
    return np.asarray(np.sqrt(2.0) * waves @ force)


def _jump(way: Floats, integral: Floats, margin: float) -> Change:
    """Return the jump of least squares, at this share of the path or more from both ends."""
    along, grown = (c - c[0] for c in (way, integral))
    r = along / along[-1]
    inner = np.flatnonzero((r >= margin) & (r <= 1.0 - margin))
    r = r[inner]
    off = (grown[inner] - r * grown[-1]) ** 2 / (r * (1.0 - r))  # squares that the jump explains
    k = int(inner[off.argmax()])
    before, after = grown[k] / along[k], (grown[-1] - grown[k]) / (along[-1] - along[k])
    return Change(float(way[k]), float(before), float(after))


def _drift(way: Floats, integral: Floats) -> Change:
    """Return the line of least squares through f at its ends: slope 12/L³ ∫(s - L/2) f ds."""
    length = float(way[-1] - way[0])
    middle = 0.5 * (way[1:] + way[:-1]) - 0.5 * (way[0] + way[-1])
    half_rise = 6.0 * float(middle @ np.diff(integral)) / length**2
    mean = float(integral[-1] - integral[0]) / length
    return Change(None, mean - half_rise, mean + half_rise)
