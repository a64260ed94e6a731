"""Numbers with a unit, such as "43.5 kJ/m^2" or "12 um", converted to mm, N, s and degrees.

The number is read as a decimal, so "0.92 g/cm3" gives exactly the double 9.2e-10.
"""

from __future__ import annotations

import re
from fractions import Fraction

from shellcut.unit import NAMES, WORDS, Exponents, parsed

_NAMES = ("mm", "N", "s", "deg")

_QUANTITY = re.compile(r"\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*([A-Za-zµμ°1/].*?)?\s*")
_EXPONENT = re.compile(r"[eE][+-]?0*(\d*)$")

# Beyond this a fraction takes too long to write out; no double needs as many digits.
_LONGEST_NUMBER = 400
_LONGEST_EXPONENT = 3

WITHIN_A_DOUBLE = "that a computer's number can hold, up to 1.8e308"


def quantity(text: str, unit: str) -> float:
    """Return the number given by a text, in ``unit``; a bare number is already in it.

    Units are multiplied with ``*`` or a blank and divided with ``/``; powers are written ``m^2`` or
    ``m2``. Raises ValueError if the text is not a number with a known unit, or has another
    dimension.

    Examples
    --------
    >>> quantity("43.5 kJ/m^2", "N/mm"), quantity("0.92 g/cm3", "t/mm^3"), quantity("12um", "mm")
    (43.5, 9.2e-10, 0.012)
    """
    wants = f"a number in {unit}" if unit else "a number without a unit"
    found = _QUANTITY.fullmatch(text)
    if not found:
        comma = ": the decimal sign is a point, thousands have none" if "," in text else ""
        raise ValueError(f"must be {wants}, got {text!r}{comma}")
    exponent = _EXPONENT.search(found[1])
    long_exponent = exponent is not None and len(exponent[1]) > _LONGEST_EXPONENT
    if long_exponent or len(found[1]) > _LONGEST_NUMBER:
        raise ValueError(f"must be {wants} {WITHIN_A_DOUBLE}, got {text!r}")
    number, given = Fraction(found[1]), found[2] or ""
    size, dimension = parsed(given) if given else (Fraction(1), parsed(unit)[1])
    target, wanted = parsed(unit) if given else (Fraction(1), dimension)
    if dimension != wanted:
        more = tuple(given - wanted for given, wanted in zip(dimension, wanted, strict=True))
        hint = ""
        if dimension[1] and more == (1, 0, -2, 0):  # force over mass
            hint = ": lb and kp are forces here, give the mass in t, kg or g; 1 lb is 0.4536 kg"
        raise ValueError(f"must be {wants}, got {text!r}, which is in {_written(dimension)}{hint}")
    try:
        return float(number * size / target)
    except OverflowError:
        raise ValueError(f"must be {wants} {WITHIN_A_DOUBLE}, got {text!r}") from None


def pattern(unit: str) -> str:
    """Return a regular expression of texts that :func:`quantity` reads in ``unit``.

    It knows units that stand alone; a product or power of units passes, whatever its dimension.

    Examples
    --------
    >>> [bool(re.match(pattern("mm"), text)) for text in ("12 um", "1 Inch", "3", "3 kg", "mm")]
    [True, True, True, False, False]
    """
    wanted = parsed(unit)[1]
    alone = [f"[µμ]{n[1:]}|{n}" if n[0] == "u" else n for n in NAMES if parsed(n)[1] == wanted]
    alone += [
        "".join(f"[{c}{c.upper()}]" if c.isalpha() else re.escape(c) for c in word)
        for word, of in WORDS.items()
        if of in NAMES and parsed(of)[1] == wanted
    ]
    product = r"[A-Za-zµμ°1/].*[\s\d*/·^²³].*"
    number = r"[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?"
    return rf"^\s*{number}\s*({'|'.join([*alone, product])})?\s*$"


def _written(dimension: Exponents) -> str:
    above: list[str] = []
    below: list[str] = []
    for name, power in zip(_NAMES, dimension, strict=True):
        if power:
            text = name if abs(power) == 1 else f"{name}^{abs(power)}"
            (above if power > 0 else below).append(text)
    return "/".join([" ".join(above) or "1", *below])
