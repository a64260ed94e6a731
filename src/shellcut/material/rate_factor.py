"""Factor on the yield stress by the rate p' = dp/dt of the equivalent plastic strain.

As in :mod:`.hardening`, each kind is a class for the user and a function of numbers for the
kernels, which returns f >= 1 and its slope df/dp' [s]; neither may fall where p' grows in
proportion. It multiplies all of the yield stress, :math:`σ_y = [σ_0 + R(p)] f(p')`:

=================  ===========================================================================
`CowperSymonds`    f = 1 + (p'/D)^(1/q)
`JohnsonCook`      f = 1 + C ln(p'/p'_0) where p' > p'_0, else 1
=================  ===========================================================================
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats, Number
from shellcut.numerics.lane_exponentials import logarithm, power
from shellcut.numerics.lane_functions import larger, where_above


def _no_rate(p: Floats, first: int, rate: Number) -> tuple[Number, Number]:
    return 1.0 + 0.0 * rate, 0.0 * rate


def _cowper_symonds(p: Floats, first: int, rate: Number) -> tuple[Number, Number]:
    """1/D, 1/q."""
    over = larger(rate * p[first], 1e-30)
    more = power(over, p[first + 1])
    return 1.0 + more, p[first + 1] * more / over * p[first]


def _johnson_cook(p: Floats, first: int, rate: Number) -> tuple[Number, Number]:
    """1/p'_0, C."""
    over = larger(rate * p[first], 1.0)
    slope = where_above(over, 1.0, p[first + 1] / over * p[first], 0.0)
    return 1.0 + p[first + 1] * logarithm(over), slope


@dataclass(frozen=True)
class RateFactor:
    """Factor f on the yield stress by the rate of plastic strain; use one of the subclasses."""

    function: ClassVar[Callable[..., Any]] = staticmethod(_no_rate)
    kind: ClassVar[str] = ""

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        return []


@checked
@dataclass(frozen=True)
class CowperSymonds(RateFactor):
    """f = 1 + (p'/D)^(1/q).

    Examples
    --------
    >>> CowperSymonds(rate=40.0, exponent=5.0).row()
    [0.025, 0.2]
    """

    function = staticmethod(_cowper_symonds)
    kind = "Cowper-Symonds"

    rate: Annotated[float, Option("1/s", "D, rate that doubles the yield stress", above=0)]
    exponent: Annotated[float, Option("", "q, the exponent of Cowper and Symonds", least=1)]

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        return [1.0 / self.rate, 1.0 / self.exponent]


@checked
@dataclass(frozen=True)
class JohnsonCook(RateFactor):
    """f = 1 + C ln(p'/p'_0) where the rate p' is above p'_0, else 1.

    Examples
    --------
    >>> JohnsonCook(factor=0.02, rate=1.0).row()
    [1.0, 0.02]
    """

    function = staticmethod(_johnson_cook)
    kind = "Johnson-Cook"

    factor: Annotated[float, Option("", "C of 1 + C ln(rate / rate of the tests)", least=0)]
    rate: Annotated[float, Option("1/s", "p'_0, rate of the tests", above=0)]

    def row(self) -> list[float]:
        """Return the parameters of ``function``."""
        return [1.0 / self.rate, self.factor]


def rate_problems(rate: object) -> list[str]:
    """Return in words why something is no rate factor; None is none."""
    if rate is None or (isinstance(rate, RateFactor) and type(rate) is not RateFactor):
        return []
    return [f"rate must be a CowperSymonds or a JohnsonCook, got {rate!r}"]
