"""Free parameters of a fit: keys with a start and bounds, and the energy that may be kept.

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
from shellcut.model_file import Model
from shellcut.model_file.reader import ModelVariants

_FACTOR = 3.0
"""Default bounds: a third of the start and three times it."""

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
    """Value of the model, and bounds, in the unit of the key."""
    unit: str = ""
    """Of the key, for messages."""


class FreeParameters:
    """The free parameters of a fit, by section and key, some with bounds.

    With ``keep_energy`` the last key follows from the law's fracture energy. Raises ValueError with
    all that is wrong with keys and bounds.
    """

    def __init__(
        self,
        variants: ModelVariants,
        keys: Sequence[str],
        bounds: Mapping[str, tuple[float, float]],
        *,
        keep_energy: bool = False,
    ) -> None:
        self._variants, self.keep_energy = variants, keep_energy
        model = variants.read({})
        problems = [f"{key} is not among the free keys" for key in bounds if key not in keys]
        if len(set(keys)) < len(keys):
            problems.append("each free key must be given once")
        if keep_energy and len(keys) < 2:
            problems.append("to keep the energy two or more keys must be free: the last follows")
        if keep_energy and keys and not keys[-1].startswith("cohesive."):
            problems.append(f"to keep the energy the last must be of [cohesive], not {keys[-1]}")
        self.all: list[Free] = []
        for key in keys:
            try:
                self.all.append(_free(model, key, bounds.get(key)))
            except ValueError as problem:
                problems.append(str(problem))
        if not keys:
            problems.append("give at least one free key")
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


def _free(model: Model, key: str, bounds: tuple[float, float] | None) -> Free:
    title, _, name = key.partition(".")
    section = model.sections.get(title)
    if section is None or not name:
        raise ValueError(
            f"{key}: a free key is written SECTION.KEY, of {', '.join(model.sections)}"
        )
    keys = section.of.keys
    if name not in keys:
        raise ValueError(f"{key}: [{title}] has no such key, but {', '.join(keys)}")
    start, wants = section.values[name], keys[name].form.wants
    if not wants.endswith("number"):
        raise ValueError(f"{key} is no number, but {wants}: it cannot be fitted")
    if start is None:
        raise ValueError(f"{key} has no value in the model: set one from which the fit starts")
    if isinstance(start, bool) or not isinstance(start, int | float) or not start > 0.0:
        raise ValueError(f"{key} must be a number above 0 in the model, where it is {start!r}")
    low, high = bounds or (start / _FACTOR, start * _FACTOR)
    if not 0.0 < low <= start <= high or not low < high:
        raise ValueError(f"{key}: the bounds {low:g}:{high:g} must lie around its start, {start:g}")
    return Free(key, float(start), low, high, keys[name].option.unit)


def _energy(variants: ModelVariants, values: Mapping[str, object]) -> float:
    """Return the fracture energy of the law with some values [N/mm], nan if these are no law."""
    section = variants.read(values, try_out=False).sections["cohesive"]
    try:
        return float(section.made().fracture_energy)
    except ValueError:
        return float("nan")


def _rounded(value: float) -> float:
    return float(f"{value:.{_DIGITS}g}")
