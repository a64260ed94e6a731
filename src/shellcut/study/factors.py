"""Factors of a study, and designs: which values the factors take together in each run.

A factor is a key of the model file with a list of values, or a range of numbers. Several keys may
be one factor, whose values go together: edges of 40° with a pitch of 12 mm, edges of 60° with 20
mm, and no other pair. A grid takes every combination. Sobol' points and a Latin hypercube fill the
box of the ranges evenly with any number of runs [McKay1979], [Sobol1967]; SciPy makes both.
"""

from __future__ import annotations

import glob
import itertools
import math
import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from typing import Annotated, Any, Literal

import scipy

from shellcut.arguments import Option, checked
from shellcut.model_file.overrides import spelled
from shellcut.model_file.source import parse_value
from shellcut.unit import parsed

_RANGE = re.compile(r"([^:]+):([^:]+)")
_NUMBER = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(.*?)\s*")
_DECIMAL_COMMA = re.compile(r"\s*[+-]?(?:0|[1-9]\d*),0\d+\s*[A-Za-z/^]*\s*")  # 05 is no number
_OPENING, _CLOSING = "[{", "]}"
_BETWEEN_KEYS, _BETWEEN_VALUES = ",", ":"
"""Of keys whose values go together, and of such values in a text."""


@dataclass(frozen=True)
class Factor:
    """A key, or several keys, with several values."""

    keys: tuple[str, ...]
    """As of ``--set``: section and key, or the key alone. Of several the values go together."""
    values: tuple[Any, ...] = ()
    """The values, as in a model file; of several keys a tuple each; empty for a range."""
    ends: tuple[float, float] | None = None
    """Least and largest value of a range."""
    unit: str = ""
    """Written after the numbers of a range; empty for that of the key."""

    @property
    def name(self) -> str:
        """The keys, as one writes them."""
        return f"{_BETWEEN_KEYS} ".join(self.keys)

    @property
    def is_linked(self) -> bool:
        """Whether several keys go together."""
        return len(self.keys) > 1

    def settings(self, value: Any) -> dict[str, object]:
        """Return what one of its values sets, by key."""
        return dict(zip(self.keys, value if self.is_linked else (value,), strict=True))

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

    def bounds_met(self, values: Mapping[str, object], part: float) -> Iterator[str]:
        """Yield which of the values by key are :func:`at_bound`: of the range, or of the list.

        A list must be of three numbers or more: each of two is at a bound, and what is no number
        has no order.
        """
        between, within, fewest = (", ", 0.0, 3) if self.ends is None else (":", part, 2)
        for key in self.keys:
            several = [self.settings(one)[key] for one in self.probes()]
            *sizes, here = (_size(one) for one in (*several, values.get(key)))
            enough = math.isfinite(here + sum(sizes)) and len(set(sizes)) >= fewest
            if enough and at_bound(here, min(sizes), max(sizes), within):
                yield f"{key} = {values[key]} lies at a bound of {between.join(map(str, several))}"


def at_bound(x: float, low: float, high: float, part: float) -> bool:
    """Whether a number lies within some part of a range from an end of it, or beyond."""
    return min(x - low, high - x) <= part * (high - low)


def factor(name: str, given: object) -> Factor:
    """Return a factor from a value of ``--set``, of a study file, or of Python.

    A text is split at its commas: ``40,60,80``, ``M1,quick``, ``caps/*.stl``; ``10:20`` and
    ``1 mm : 2 mm`` are ranges. A list is taken as it is. The values of several keys, ``a, b``, are
    ``40:12, 60:20``, or a list of lists.

    Examples
    --------
    >>> factor("motion.pitch", "12, 20").values, factor("motion.pitch", "12:20").ends
    ((12, 20), (12.0, 20.0))
    >>> factor("tool.edge_inclination_deg, motion.pitch", "40:12, 60:20").values
    ((40, 12), (60, 20))
    """
    keys = tuple(spelled(key.strip()) for key in name.split(_BETWEEN_KEYS))
    name = keys[0] if len(keys) == 1 else name
    if "" in keys or len(set(keys)) < len(keys):
        raise ValueError(f"{name}: keys that go together must be names, each once, with commas")
    if len(keys) > 1:
        values = _groups(name, len(keys), given)
    elif isinstance(given, str):
        # only a number with a comma explains 0,05 or 1,5:2,5
        comma = _RANGE.fullmatch(given.replace(",", ".")) if "," in given else None
        if _DECIMAL_COMMA.fullmatch(given) or (comma and _numbers(name, comma[1], comma[2])):
            raise ValueError(
                f"{name}: the decimal sign is a point, a comma separates values, got {given}"
            )
        if (found := _RANGE.fullmatch(given)) and (ends := _numbers(name, found[1], found[2])):
            low, high, unit = ends
            if not low < high:
                raise ValueError(f"{name}: a range must go up, low:high, got {low:g}:{high:g}")
            return Factor((name,), ends=(low, high), unit=unit)
        values = [one for part in _parts(given, ",") for one in _files(name, parse_value(part))]
    elif isinstance(given, Sequence):
        values = list(given)
    else:
        values = [given]
    if not values:
        raise ValueError(f"{name} must have at least one value, got {given!r}")
    if repeated := [one for k, one in enumerate(values) if one in values[:k]]:
        raise ValueError(f"{name} must have each value once, got {repeated[0]!r} twice")
    return Factor(keys, tuple(values))


def factors_of(given: Mapping[str, object]) -> tuple[list[Factor], dict[str, object]]:
    """Return the factors, and the keys that have one value only and are settings.

    Raises ValueError with all that is wrong.
    """
    factors: list[Factor] = []
    settings: dict[str, object] = {}
    problems = []
    seen: set[str] = set()
    for name, value in given.items():
        try:
            one = factor(name, value)
        except ValueError as problem:
            problems.append(str(problem))
            continue
        problems += [f"{key} must be in one factor only" for key in one.keys if key in seen]
        seen.update(one.keys)
        if one.ends is None and len(one.values) == 1:
            settings |= one.settings(one.values[0])
        else:
            factors.append(one)
    if problems:
        raise ValueError("\n".join(problems))
    return factors, settings


def _groups(name: str, n_key: int, given: object) -> list[object]:
    """Return the values of keys that go together, a tuple for each run."""
    if isinstance(given, str):
        groups: list[object] = [
            tuple(parse_value(value) for value in _parts(part, _BETWEEN_VALUES))
            for part in _parts(given, ",")
        ]
    else:
        groups = list(given) if isinstance(given, Sequence) else [given]
    for group in groups:
        if isinstance(group, str) or not isinstance(group, Sequence) or len(group) != n_key:
            raise ValueError(
                f"{name} must have {n_key} values together, as "
                f"{_BETWEEN_VALUES.join('123456789'[:n_key])}, got {group!r}"
            )
    return [tuple(group) for group in groups if isinstance(group, Sequence)]


def _numbers(key: str, first: str, last: str) -> tuple[float, float, str] | None:
    """Return both ends and the unit, None if these are no numbers."""
    a, b = _NUMBER.fullmatch(first), _NUMBER.fullmatch(last)
    if not a or not b:
        return None
    if a[2] and a[2] != b[2]:
        raise ValueError(f"{key}: both ends of a range must have one unit, got {first}:{last}")
    return float(a[1]), float(b[1]), b[2]


def _size(value: object) -> float:
    """Return a number, or one with a unit in mm, N and s, to compare it; nan of anything else."""
    if found := _NUMBER.fullmatch(str(value)):
        with suppress(ValueError):  # no unit, as of a file 3.stl
            return float(found[1]) * float(parsed(found[2])[0] if found[2] else 1)
    return float("nan")


def _parts(text: str, between: str) -> list[str]:
    """Return the parts between signs that are in no brackets and no quotes."""
    parts, depth, quote = [""], 0, ""
    for letter in text:
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "\"'":
            quote = letter
        else:
            depth += (letter in _OPENING) - (letter in _CLOSING)
        if letter == between and not depth and not quote:
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


# --- designs --------------------------------------------------------------------------------------

DesignKind = Literal["grid", "sobol", "lhs"]


@checked
@dataclass(frozen=True)
class Design:
    """How the values of the factors are combined.

    Examples
    --------
    >>> Design("sobol", 16).n
    16
    """

    kind: Annotated[
        DesignKind, Option("", "every combination; Sobol' points, scrambled; a Latin hypercube")
    ] = "grid"
    n: Annotated[int | None, Option("", "number of runs of sobol or lhs", least=1)] = None
    seed: Annotated[int, Option("", "of sobol and lhs; another gives other points", least=0)] = 0

    def __post_init__(self) -> None:
        if self.kind == "grid" and self.n is not None:
            raise ValueError("a grid has as many runs as combinations: leave out n")
        if self.kind != "grid" and self.n is None:
            raise ValueError(f"a {self.kind} design needs a number of runs, such as n=16")

    def runs(self, factors: Sequence[Factor]) -> list[dict[str, object]]:
        """Return the values of all factors in each run, by key.

        Raises
        ------
        ValueError
            If a factor of a grid is a range.
        """
        several: Iterable[Sequence[object]]
        if self.kind == "grid":
            if ranges := [f"{f.name} = {f.ends[0]:g}:{f.ends[1]:g}" for f in factors if f.ends]:
                raise ValueError(
                    f"a grid takes lists of values, and {', '.join(ranges)} is a range: write the "
                    "values, or choose the design sobol or lhs with a number of runs"
                )
            several = itertools.product(*(factor.values for factor in factors))
        else:
            points = self._points(len(factors)) if factors else [[]]
            several = ([f.at(u) for f, u in zip(factors, row, strict=True)] for row in points)
        runs = []
        for values in several:
            each = zip(factors, values, strict=True)
            runs.append({key: one for f, v in each for key, one in f.settings(v).items()})
        return runs

    def _points(self, n_factor: int) -> list[list[float]]:
        """Return points of the unit cube."""
        assert self.n is not None
        if self.kind == "lhs":
            points = scipy.stats.qmc.LatinHypercube(n_factor, seed=self.seed).random(self.n)
        else:
            # Whole powers of two keep the balance of the sequence; the first n are of that.
            power = math.ceil(math.log2(self.n))
            sobol = scipy.stats.qmc.Sobol(n_factor, seed=self.seed)
            points = sobol.random_base2(power)[: self.n]
        return list(points.tolist())
