"""Numbers with a unit, as "43.5 kJ/m^2" or "12 um", taken to mm, N, s and degrees.

Sizes are fractions and the number is read as a decimal, so that "0.92 g/cm3" is the very double
that 9.2e-10 is.
"""

from __future__ import annotations

import re
from fractions import Fraction
from math import pi

Dimension = tuple[int, int, int, int]
"""Exponents of length, force, time and angle; a mass is force x time² / length."""

_LENGTH: Dimension = (1, 0, 0, 0)
_FORCE: Dimension = (0, 1, 0, 0)
_TIME: Dimension = (0, 0, 1, 0)
_ANGLE: Dimension = (0, 0, 0, 1)
_MASS: Dimension = (-1, 1, 2, 0)
_STRESS: Dimension = (-2, 1, 0, 0)
_ENERGY: Dimension = (1, 1, 0, 0)
_NAMES = ("mm", "N", "s", "deg")

_UNITS: dict[str, tuple[str, Dimension]] = {
    **{"um": ("1e-3", _LENGTH), "mm": ("1", _LENGTH), "cm": ("10", _LENGTH)},
    **{"m": ("1e3", _LENGTH), "inch": ("25.4", _LENGTH), "mil": ("0.0254", _LENGTH)},
    **{"mN": ("1e-3", _FORCE), "N": ("1", _FORCE), "kN": ("1e3", _FORCE)},
    **{"us": ("1e-6", _TIME), "ms": ("1e-3", _TIME), "s": ("1", _TIME), "min": ("60", _TIME)},
    **{"deg": ("1", _ANGLE), "turn": ("360", _ANGLE), "rad": (repr(180.0 / pi), _ANGLE)},
    **{"g": ("1e-6", _MASS), "kg": ("1e-3", _MASS), "t": ("1", _MASS)},
    **{"Pa": ("1e-6", _STRESS), "kPa": ("1e-3", _STRESS), "MPa": ("1", _STRESS)},
    **{"GPa": ("1e3", _STRESS), "bar": ("0.1", _STRESS)},
    **{"mJ": ("1", _ENERGY), "J": ("1e3", _ENERGY), "kJ": ("1e6", _ENERGY)},
}
_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-zµμ°1/].*?)?\s*")
_FACTOR = re.compile(r"([A-Za-z]+)(?:\^?(-?\d+))?")
_SPELLED = str.maketrans({"µ": "u", "μ": "u", "°": "deg", "²": "2", "³": "3", "·": "*"})


def quantity(text: str, unit: str) -> float:
    """Return the number that a text gives in ``unit``; a bare number is in it already.

    Parameters
    ----------
    text : str
        Number and unit; units are multiplied by ``*`` or a blank and divided by ``/``, powers are
        written ``m^2`` or ``m2``.
    unit : str
        The unit wanted; empty for a pure number.

    Raises
    ------
    ValueError
        If the text is no number with a known unit, or of another dimension.

    Examples
    --------
    >>> quantity("43.5 kJ/m^2", "N/mm"), quantity("0.92 g/cm3", "t/mm^3"), quantity("12um", "mm")
    (43.5, 9.2e-10, 0.012)
    """
    wants = f"a number in {unit}" if unit else "a number without a unit"
    found = _QUANTITY.fullmatch(text)
    if not found:
        raise ValueError(f"must be {wants}, got {text!r}")
    number, given = Fraction(found[1]), found[2] or ""
    if not given:
        return float(number)
    size, dimension = _parsed(given)
    target, wanted = _parsed(unit)
    if dimension != wanted:
        raise ValueError(f"must be {wants}, got {text!r}, which is in {_written(dimension)}")
    return float(number * size / target)


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
        if not found or found[1] not in _UNITS:
            raise ValueError(f"must have a unit made of {', '.join(_UNITS)}, got {unit!r}")
        power = int(found[2] or 1) * (-1 if divides else 1)
        one, exponents = _UNITS[found[1]]
        size *= Fraction(one) ** power
        length, force, time, angle = (
            d + power * e for d, e in zip(dimension, exponents, strict=True)
        )
        dimension = (length, force, time, angle)
    return size, dimension


def _written(dimension: Dimension) -> str:
    above: list[str] = []
    below: list[str] = []
    for name, power in zip(_NAMES, dimension, strict=True):
        if power:
            text = name if abs(power) == 1 else f"{name}^{abs(power)}"
            (above if power > 0 else below).append(text)
    return "/".join([" ".join(above) or "1", *below])
