"""The pace of a quasi-static run: how fast tool, supports and loads advance while the film moves.

A film of rate-independent laws has no time of its own but by its inertia. So the clock of tool,
supports and loads may be slower than the film's by any factor p, the pace: a step advances the film
by dt and the clock by p dt. With L the kinetic energy that is allowed, a share of the largest work
or energy of the run so far, and T the present one,

    p changes in a step by the factor 1 + g (1 - 4 T / L), g = 0.002, up to 1, the given speed;
    where T > L, or at a peak of T above L / 4 if p has halved since the last stop, the film is
    stopped and starts anew from where it is (kinetic damping), and p falls by a fifth.

So T stays below L but for what a single step adds, and is a quarter of it where p < 1. The second
rule is for film that swings: what half the pace does not calm is no motion with the tool. Film that
springs free is braked by many stops, and the tool all but waits; film that follows steadily is
never stopped. Damping by the velocity would drag on it over all its path (docs/theory/time.md).
"""

from __future__ import annotations

from typing import Annotated, TypeAlias

from shellcut.arguments import Option
from shellcut.numerics.kept import Kept

KineticShare: TypeAlias = Annotated[
    float | None,
    Option(
        "",
        "run slowly enough that kinetic energy stays below this share of the work (0.004 is a good "
        "start): tool, supports and loads slow down or wait where needed",
        above=0,
        most=0.008,
        unset="tool, supports and loads move as fast as given, and the film has its inertia",
    ),
]

_CALM = 0.25  # of the kinetic energy that is allowed, below which the pace grows
_FASTER = 2e-3  # that the pace grows by in a step
_SLOWER, _AT_STOP = 0.97, 0.8  # factors on the pace in a step at least, and where the film stops
_LEAST, _AT_START = 1e-4, 1e-2  # paces


class Pace(Kept):
    """Steps of the clock over those of the film.

    Parameters
    ----------
    share : float, optional
        Largest kinetic energy over the largest work so far; no limit by default.

    Examples
    --------
    >>> pace = Pace(0.004)
    >>> pace.adapt(0.2, work=100.0)
    >>> round(pace.now, 6), pace.stops(0.2, 0.2, work=100.0), pace.stops(0.5, 0.4, work=100.0)
    (0.00998, False, True)
    """

    kept_names = "now", "_fastest", "n_stop"

    def __init__(self, share: float | None) -> None:
        self.share = share
        """Of the work, that the kinetic energy may have; None: the film has its inertia."""
        self.now = self._fastest = 1.0 if share is None else _AT_START
        """Of the next step, and the largest since the last stop."""
        self.n_stop = 0
        """How often the film has been stopped."""

    def adapt(self, kinetic: float, work: float) -> None:
        """Choose the pace after a step with this kinetic energy [N·mm]."""
        if self.share is not None:
            excess = kinetic / (_CALM * self.share * work) - 1.0
            pace = self.now * max(1.0 - _FASTER * excess, _SLOWER)
            self.now = min(max(pace, _LEAST), 1.0)
            self._fastest = max(self._fastest, self.now)

    def stops(self, kinetic: float, before: float, work: float) -> bool:
        """Return whether the film stops at this kinetic energy, ``before`` a step ago [N·mm]."""
        if self.share is None:
            return False
        most = self.share * work
        swings = self.now <= max(0.5 * self._fastest, _LEAST) and _CALM * most < kinetic < before
        if stop := kinetic > most or swings:
            self.n_stop += 1
            self.now = self._fastest = max(_AT_STOP * self.now, _LEAST)
        return stop
