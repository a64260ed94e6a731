"""Factors of a study: a key of the model file with a list of values, or a range of numbers."""

from __future__ import annotations

import glob
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from shellcut.model_file.source import parse_value

_RANGE = re.compile(r"([^:]+):([^:]+)")
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
_OPENING, _CLOSING = "[{", "]}"


@dataclass(frozen=True)
class Factor:
    """A key that takes several values.

    Attributes
    ----------
    key : str
        As of ``--set``: section and key, or the key alone.
    values : tuple
        The values, as in a model file; empty for a range.
    ends : tuple of float or None
        Least and largest value of a range.
    unit : str
        Written after the numbers of a range; empty for that of the key.
    """

    key: str
    values: tuple[object, ...] = ()
    ends: tuple[float, float] | None = None
    unit: str = ""

    def at(self, share: float) -> object:
        """Return the value at a share of the range, or of the list, in [0, 1)."""
        if self.ends is None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        low, high = self.ends
        return self.of_number(low + share * (high - low))

    def of_number(self, number: float) -> object:
        """Return a number of the range as a model file takes it."""
        # Twelve digits: a table that can be read, and a value that can be typed again.
        number = float(f"{number:.12g}")
        return f"{number!r} {self.unit}" if self.unit else number

    def probes(self) -> tuple[object, ...]:
        """Return the values to try before any run: all of a list, both ends of a range."""
        if self.ends is None:
            return self.values
        return self.of_number(self.ends[0]), self.of_number(self.ends[1])


def factor(key: str, given: object) -> Factor:
    """Return a factor from a value of ``--set``, of a study file, or of Python.

    A text is split at its commas: ``40,60,80``, ``M1,quick``, ``caps/*.stl``; ``10:20`` and
    ``1 mm : 2 mm`` are ranges. A list is taken as it is.

    Raises
    ------
    ValueError
        If there is no value, a range does not go up, or no file fits a pattern.

    Examples
    --------
    >>> factor("motion.pitch", "12, 20").values, factor("motion.pitch", "12:20").ends
    ((12, 20), (12.0, 20.0))
    """
    if isinstance(given, str):
        if (found := _RANGE.fullmatch(given)) and (ends := _numbers(found[1], found[2])):
            return _range(key, *ends)
        values = [one for part in _parts(given) for one in _files(key, parse_value(part))]
    elif isinstance(given, Sequence):
        values = list(given)
    else:
        values = [given]
    if not values:
        raise ValueError(f"{key} must have at least one value, got {given!r}")
    repeated = [one for k, one in enumerate(values) if one in values[:k]]
    if repeated:
        raise ValueError(f"{key} must have each value once, got {repeated[0]!r} twice")
    return Factor(key, tuple(values))


def factors_of(given: Mapping[str, object]) -> tuple[list[Factor], dict[str, object]]:
    """Return the factors, and the keys that have one value only and are settings.

    Raises
    ------
    ValueError
        With all that is wrong.
    """
    factors, settings, problems = [], {}, []
    for key, value in given.items():
        try:
            one = factor(key, value)
        except ValueError as problem:
            problems.append(str(problem))
            continue
        if one.ends is None and len(one.values) == 1:
            settings[key] = one.values[0]
        else:
            factors.append(one)
    if problems:
        raise ValueError("\n".join(problems))
    return factors, settings


def _numbers(first: str, last: str) -> tuple[float, float, str] | None:
    """Return both ends and the unit, None if these are no numbers of one unit."""
    a, b = _NUMBER.fullmatch(first), _NUMBER.fullmatch(last)
    if not a or not b or (a[2] and a[2] != b[2]):
        return None
    return float(a[1]), float(b[1]), b[2]


def _range(key: str, low: float, high: float, unit: str) -> Factor:
    if not low < high:
        raise ValueError(f"{key}: a range must go up, low:high, got {low:g}:{high:g}")
    return Factor(key, ends=(low, high), unit=unit)


def _parts(text: str) -> list[str]:
    """Return the parts between commas that are in no brackets and no quotes."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        else:
            depth += (letter in _OPENING) - (letter in _CLOSING)
        if letter == "," and not depth and not quote:
            parts.append("")
        else:
            parts[-1] += letter
    return [part.strip() for part in parts if part.strip()]


def _files(key: str, value: object) -> list[object]:
    """Return the files that fit a pattern, in order, and any other value as it is."""
    if not isinstance(value, str) or not glob.has_magic(value):
        return [value]
    found = sorted(glob.glob(value))
    if not found:
        raise ValueError(f"{key}: there is no file {value}")
    return [*found]
