"""All units that the library reads: sizes, spellings, conversion factors.

::

    conversion("Ncm", "N*mm") = 10.0        conversion("Grad", "rad") = pi / 180

A product may be written ``N*mm``, ``N·mm``, ``N mm``, ``N-mm`` or ``Nmm``; letters keep their case
(``mN`` is a millinewton), whole words do not (``Deg``, ``INCH``).
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from fractions import Fraction
from math import pi

Sizes = Mapping[str, Fraction]
"""Size of each unit of one dimension. Fractions, so that 0.92 g/cm^3 is the double 9.2e-10."""


def _exactly(sizes: Mapping[str, str]) -> dict[str, Fraction]:
    return {name: Fraction(size) for name, size in sizes.items()}


_STANDARD_GRAVITY = Fraction("9.80665")
_POUND = Fraction("0.45359237") * _STANDARD_GRAVITY
_RADIAN = 180 / Fraction(pi)

LENGTH: Sizes = _exactly(
    {
        "um": "1e-3",
        "mm": "1",
        "cm": "10",
        "m": "1e3",
        "in": "25.4",
        "ft": "304.8",
        "mil": "0.0254",
    }
)
"""[mm]"""
ANGLE: Sizes = {
    "rad": _RADIAN,
    "mrad": _RADIAN / 1000,
    **_exactly({"deg": "1", "gon": "0.9", "turn": "360"}),
}
"""[deg]"""
FORCE: Sizes = {
    **_exactly({"mN": "1e-3", "N": "1", "daN": "10", "kN": "1e3"}),
    "gf": _STANDARD_GRAVITY / 1000,
    "kgf": _STANDARD_GRAVITY,
    "ozf": _POUND / 16,
    "lbf": _POUND,
}
"""[N]"""
TIME: Sizes = _exactly({"us": "1e-6", "ms": "1e-3", "s": "1", "min": "60"})
"""[s]"""
MASS: Sizes = _exactly({"g": "1e-6", "kg": "1e-3", "t": "1"})
"""[t]"""
STRESS: Sizes = {
    **_exactly({"Pa": "1e-6", "kPa": "1e-3", "MPa": "1", "GPa": "1e3", "bar": "0.1"}),
    "psi": _POUND / Fraction("25.4") ** 2,
    "ksi": 1000 * _POUND / Fraction("25.4") ** 2,
}
"""[MPa]"""
ENERGY: Sizes = _exactly({"mJ": "1", "J": "1e3", "kJ": "1e6"})
"""[N·mm]"""
TORQUE: Sizes = {
    f"{force}*{arm}": FORCE[force] * LENGTH[arm]
    for forces, arms in (
        (("mN", "N", "kN", "gf", "kgf"), ("mm", "cm", "m")),
        (("ozf", "lbf"), ("in", "ft")),
    )
    for force in forces
    for arm in arms
}
"""[N·mm]"""
RATIO: Sizes = {"-": Fraction(1), "%": Fraction("0.01")}
"""[-]"""

DIMENSIONS: Mapping[str, Sizes] = {
    "length": LENGTH,
    "angle": ANGLE,
    "force": FORCE,
    "torque": TORQUE,
    "stress": STRESS,
    "time": TIME,
    "ratio": RATIO,
}
"""Unit of each dimension in a history or a measured table."""
LIBRARY_UNITS = {
    "length": "mm",
    "angle": "deg",
    "force": "N",
    "torque": "N*mm",
    "stress": "MPa",
    "time": "s",
    "ratio": "-",
}
"""The unit in which histories store each dimension."""

_WORDS = {
    "inch": "in",
    "inches": "in",
    '"': "in",
    "micron": "um",
    "°": "deg",
    "degree": "deg",
    "degrees": "deg",
    "grad": "deg",  # German; the hundredth of a right angle is written gon
    "deg": "deg",
    "rad": "rad",
    "radian": "rad",
    "radians": "rad",
    "rev": "turn",
    "sec": "s",
    "sek": "s",
    "lb": "lbf",
    "lbs": "lbf",
    "kp": "kgf",
    "1": "-",
    "mm/mm": "-",
    "percent": "%",
    **{f"n/mm{power}": "MPa" for power in ("2", "^2", "²")},
    **{f"kn/mm{power}": "GPa" for power in ("2", "^2", "²")},
}
_SPELLINGS = {
    **{name: name for sizes in DIMENSIONS.values() for name in sizes},
    **{name.replace("*", ""): name for name in TORQUE},
    # Torques of pounds and ounces are written in either order, and often without the f of force.
    **{
        spelling: f"{force}*{arm}"
        for force in ("ozf", "lbf")
        for arm in ("in", "ft")
        for spelling in (f"{arm}{force}", f"{force[:2]}{arm}", f"{arm}{force[:2]}")
    },
}


def canonical(unit: str) -> str | None:
    """Return the library's spelling of a unit, or None if it is unknown.

    Examples
    --------
    >>> [canonical(unit) for unit in ("Nmm", "N·cm", "in-lb", "Grad", "µm", "furlong")]
    ['N*mm', 'N*cm', 'lbf*in', 'deg', 'um', None]
    """
    text = unit.strip().replace("µ", "u").replace("μ", "u")
    if text in _SPELLINGS:
        return _SPELLINGS[text]
    if text.lower() in _WORDS:
        return _WORDS[text.lower()]
    return _SPELLINGS.get(re.sub(r"[\s*·⋅×.\-]", "", text))


def dimension(unit: str) -> str | None:
    """Return the dimension of a unit, "length", "torque" ..., or None if it is unknown.

    Examples
    --------
    >>> dimension("lbf*in")
    'torque'
    """
    name = canonical(unit)
    return next((d for d, sizes in DIMENSIONS.items() if name in sizes), None)


def conversion(unit: str, to: str) -> float:
    """Return the factor that converts numbers in ``unit`` to numbers in ``to``.

    Parameters
    ----------
    unit : str
        In any common spelling.
    to : str
        A unit that the library knows; it sets the required dimension.

    Raises
    ------
    ValueError
        If ``unit`` is unknown or has another dimension; the message lists the valid units.

    Examples
    --------
    >>> conversion("N*m", "N*mm")
    1000.0
    >>> conversion("cm", "N")
    Traceback (most recent call last):
        ...
    ValueError: must be a unit of force (mN, N, daN, kN, gf, kgf, ozf, lbf), got 'cm', one of length
    """
    wanted = dimension(to)
    target = canonical(to)
    if wanted is None or target is None:
        raise ValueError(f"must be a unit of the library, got {to!r}")
    sizes = DIMENSIONS[wanted]
    name = canonical(unit)
    if name is None or name not in sizes:
        other = dimension(unit)
        hint = f", one of {other}" if other else ""
        raise ValueError(f"must be a unit of {wanted} ({', '.join(sizes)}), got {unit!r}{hint}")
    return float(sizes[name] / sizes[target])
