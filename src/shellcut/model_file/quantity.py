"""Numbers with a unit, such as "43.5 kJ/m^2" or "12 um", converted to mm, N, s and degrees.

The number is read as a decimal, so "0.92 g/cm3" gives exactly the double 9.2e-10.
"""

from __future__ import annotations

import re
from fractions import Fraction

from shellcut import unit as unit_table

Dimension = tuple[int, int, int, int]
"""Exponents of length, force, time and angle; a mass is force x time² / length."""

_NAMES = ("mm", "N", "s", "deg")

_KINDS: tuple[tuple[unit_table.Sizes, Dimension], ...] = (
    (unit_table.LENGTH, (1, 0, 0, 0)),
    (unit_table.FORCE, (0, 1, 0, 0)),
    (unit_table.TIME, (0, 0, 1, 0)),
    (unit_table.ANGLE, (0, 0, 0, 1)),
    (unit_table.MASS, (-1, 1, 2, 0)),
    (unit_table.STRESS, (-2, 1, 0, 0)),
    (unit_table.ENERGY, (1, 1, 0, 0)),
)
_UNITS: dict[str, tuple[Fraction, Dimension]] = {
    name: (size, dimension) for sizes, dimension in _KINDS for name, size in sizes.items()
}
_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-zµμ°1/].*?)?\s*")
_EXPONENT = re.compile(r"[eE][+-]?0*(\d*)$")
_FACTOR = re.compile(r"([A-Za-z]+)(?:\^?(-?\d+))?")
_SPELLED = str.maketrans({"µ": "u", "μ": "u", "°": "deg", "²": "2", "³": "3", "·": "*"})

# Beyond this a fraction takes too long to write out; no double needs as many digits.
_LONGEST_NUMBER = 400
_LONGEST_EXPONENT = 3
_LARGEST_POWER = 9

WITHIN_A_DOUBLE = "that a computer's number can hold, up to 1.8e308"


def quantity(text: str, unit: str) -> float:
    """Return the number given by a text, in ``unit``; a bare number is already in it.

    Parameters
    ----------
    text : str
        Number and unit; units are multiplied with ``*`` or a blank and divided with ``/``; powers
        are written ``m^2`` or ``m2``.
    unit : str
        The required unit; empty for a pure number.

    Raises
    ------
    ValueError
        If the text is not a number with a known unit, or has another dimension.

    Examples
    --------
    >>> quantity("43.5 kJ/m^2", "N/mm"), quantity("0.92 g/cm3", "t/mm^3"), quantity("12um", "mm")
    (43.5, 9.2e-10, 0.012)
    """
    wants = f"a number in {unit}" if unit else "a number without a unit"
    found = _QUANTITY.fullmatch(text)
    if not found:
        raise ValueError(f"must be {wants}, got {text!r}")
    exponent = _EXPONENT.search(found[1])
    long_exponent = exponent is not None and len(exponent[1]) > _LONGEST_EXPONENT
    if long_exponent or len(found[1]) > _LONGEST_NUMBER:
        raise ValueError(f"must be {wants} {WITHIN_A_DOUBLE}, got {text!r}")
    number, given = Fraction(found[1]), found[2] or ""
    size, dimension = _parsed(given) if given else (Fraction(1), _parsed(unit)[1])
    target, wanted = _parsed(unit) if given else (Fraction(1), dimension)
    if dimension != wanted:
        raise ValueError(f"must be {wants}, got {text!r}, which is in {_written(dimension)}")
    try:
        return float(number * size / target)
    except OverflowError:
        raise ValueError(f"must be {wants} {WITHIN_A_DOUBLE}, got {text!r}") from None


def _parsed(unit: str) -> tuple[Fraction, Dimension]:
    size, dimension = Fraction(1), (0, 0, 0, 0)
    divides = False
    for piece in re.split(r"(\s*[*/]\s*|\s+)", unit.translate(_SPELLED)):
        if not piece.strip() or piece.strip() in "*/":
            divides = piece.strip() == "/"
            continue
        if piece == "1":
            continue
        found = _FACTOR.fullmatch(piece)
        name = _name(found[1]) if found else None
        if found is None or name is None:
            raise ValueError(f"must have a unit made of {', '.join(_UNITS)}, got {unit!r}")
        if len((found[2] or "").lstrip("-0")) > 1:
            raise ValueError(
                f"must have a unit to a power of {_LARGEST_POWER} at most, got {unit!r}"
            )
        power = int(found[2] or 1) * (-1 if divides else 1)
        one, exponents = _UNITS[name]
        size *= one**power
        length, force, time, angle = (
            d + power * e for d, e in zip(dimension, exponents, strict=True)
        )
        dimension = (length, force, time, angle)
    return size, dimension


def _name(word: str) -> str | None:
    """Return the name of a unit, which may be spelt out like "inch" or "degrees"."""
    name = word if word in _UNITS else unit_table.canonical(word)
    return name if name in _UNITS else None


def _written(dimension: Dimension) -> str:
    above: list[str] = []
    below: list[str] = []
    for name, power in zip(_NAMES, dimension, strict=True):
        if power:
            text = name if abs(power) == 1 else f"{name}^{abs(power)}"
            (above if power > 0 else below).append(text)
    return "/".join([" ".join(above) or "1", *below])
