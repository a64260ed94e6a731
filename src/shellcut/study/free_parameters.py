"""Free parameters of a fit: keys with a range and a start in it, and the energy that may be kept.

All are positive and vary by factors: the fit works with log(value / start). If the fracture energy
is kept, the last of them follows from the others, so that the law's area stays that of the model.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import scipy

from shellcut.arrays import Floats
from shellcut.model_file.overrides import path_of
from shellcut.model_file.reader import ModelVariants

from .factors import Factor

_N_TRIED = 65
"""Values of a key among which that with a given energy is sought."""

_DIGITS = 7
"""Of a value: a fit that is called again finds its runs by them."""


@dataclass(frozen=True)
class Free:
    """A free parameter."""

    key: str
    """Section and key."""
    start: float
    low: float
    high: float
    """Where the fit starts, and the ends of the range, in the unit of the key."""
    unit: str = ""
    """Of the key, for messages."""


class FreeParameters:
    """The free parameters of a fit: the factors of its settings, which must be ranges.

    With ``keep_energy`` the last of them follows from the law's fracture energy. Raises ValueError
    with all that is wrong with them.
    """

    def __init__(
        self, variants: ModelVariants, factors: Sequence[Factor], *, keep_energy: bool = False
    ) -> None:
        self._variants, self.keep_energy = variants, keep_energy
        self.all: list[Free] = []
        problems = []
        for factor in factors:
            try:
                self.all.append(_free(variants, factor))
            except ValueError as problem:
                problems.append(str(problem))
        keys = [one.key for one in self.all]
        problems += [
            f"{key} must have one range" for key in dict.fromkeys(keys) if keys.count(key) > 1
        ]
        if keep_energy and len(factors) < 2:
            problems.append("to keep the energy two or more keys must vary: the last follows")
        if keep_energy and keys and not keys[-1].startswith("cohesive."):
            problems.append(f"to keep the energy the last must be of [cohesive], not {keys[-1]}")
        if problems:
            raise ValueError("\n".join(problems))
        self.varied = self.all[:-1] if keep_energy else self.all
        """Those that the fit varies."""
        self._energy = _energy(variants, {}) if keep_energy else 0.0

    def bounds(self) -> tuple[Floats, Floats]:
        """Return the bounds of the logarithms."""
        low = np.log([free.low / free.start for free in self.varied])
        high = np.log([free.high / free.start for free in self.varied])
        return low, high

    def values(self, logs: Sequence[float]) -> dict[str, float]:
        """Return the values of all free keys.

        Raises ValueError if no value of the last key keeps the energy.
        """
        values = {
            free.key: _rounded(free.start * math.exp(log))
            for free, log in zip(self.varied, logs, strict=True)
        }
        if self.keep_energy:
            values[self.all[-1].key] = self._following(values)
        return values

    def _following(self, values: Mapping[str, float]) -> float:
        """Return the last key's value with which the law has the energy of the model."""
        last = self.all[-1]

        def excess(value: float) -> float:
            return _energy(self._variants, {**values, last.key: value}) - self._energy

        # Some values between the bounds may be no law: an opening beyond which the next one lies.
        tried = np.geomspace(last.low, last.high, _N_TRIED).tolist()
        for low, high in pairwise(one for one in tried if not np.isnan(excess(one))):
            if excess(low) * excess(high) <= 0.0:
                return _rounded(float(scipy.optimize.brentq(excess, low, high, rtol=1e-12)))
        raise ValueError(
            f"no {last.key} from {last.low:g} to {last.high:g} keeps the energy with {values}"
        )


def _free(variants: ModelVariants, factor: Factor) -> Free:
    """Return the free parameter of a range, whose ends the model reads as any other value."""
    if factor.ends is None:
        raise ValueError(
            f"{factor.name}: a fit takes one value, or a range low:high in which to fit it, "
            f"got {len(factor.values)} values"
        )
    several = ({}, *map(factor.settings, factor.probes()))
    models = [variants.read(values, try_out=False) for values in several]
    tables = [one.titled() for one in models]
    *parts, name = map(str, path_of(factor.name, models[0].head.model))
    title = ".".join(parts)
    keys = tables[1][title].of.keys
    name, key = next((n, key) for n, key in keys.items() if name in (n, key.also))
    low, high = (one[title].values[name] for one in tables[1:])
    if not low > 0.0:
        raise ValueError(f"{factor.name}: a range to fit must be above 0, got {low:g}:{high:g}")
    start = tables[0][title].values.get(name) if title in tables[0] else None
    if not isinstance(start, float) or not low <= start <= high:
        start = math.sqrt(low * high)
    return Free(f"{title}.{name}".removeprefix("."), start, low, high, key.option.unit)


def _energy(variants: ModelVariants, values: Mapping[str, object]) -> float:
    """Return the fracture energy of the law with some values [N/mm], nan if these are no law."""
    section = variants.read(values, try_out=False).sections["cohesive"]
    try:
        return float(section.made().fracture_energy)
    except ValueError:
        return float("nan")


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
