"""All units that the library reads: sizes, spellings, conversion factors.

::

    conversion("Ncm", "N*mm") = 10.0        conversion("Grad", "rad") = pi / 180

A product may be written ``N*mm``, ``N·mm``, ``N mm``, ``N-mm`` or ``Nmm``, a quotient ``kgf/mm²``
or ``lbf/in^2``. Letters keep their case where it tells units apart (``mN`` is a millinewton, ``MN``
is not known); elsewhere and in words any case is read (``lbF``, ``KN``, ``INCH``).
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from fractions import Fraction
from math import pi

Sizes = Mapping[str, Fraction]
"""Size of each unit of one dimension. Fractions, so that 0.92 g/cm^3 is the double 9.2e-10."""
Exponents = tuple[int, int, int, int]
"""Exponents of length, force, time and angle; a mass is force x time² / length."""


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
    **_exactly({"mN": "1e-3", "cN": "1e-2", "N": "1", "daN": "10", "kN": "1e3"}),
    "gf": _STANDARD_GRAVITY / 1000,
    "kgf": _STANDARD_GRAVITY,
    "ozf": _POUND / 16,
    "lbf": _POUND,
}
"""[N]"""
TIME: Sizes = _exactly({"ns": "1e-9", "us": "1e-6", "ms": "1e-3", "s": "1", "min": "60"})
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
        (("mN", "cN", "N", "kN", "gf", "kgf"), ("mm", "cm", "m")),
        (("ozf", "lbf"), ("in", "ft")),
    )
    for force in forces
    for arm in arms
}
"""[N·mm]"""
RATIO: Sizes = _exactly({"-": "1", "%": "0.01", "um/m": "1e-6"})
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
LIBRARY_UNITS = dict(zip(DIMENSIONS, ("mm", "deg", "N", "N*mm", "MPa", "s", "-"), strict=True))
"""The unit in which histories store each dimension."""

_KINDS: tuple[tuple[Sizes, Exponents], ...] = (
    (LENGTH, (1, 0, 0, 0)),
    (FORCE, (0, 1, 0, 0)),
    (TIME, (0, 0, 1, 0)),
    (ANGLE, (0, 0, 0, 1)),
    (MASS, (-1, 1, 2, 0)),
    (STRESS, (-2, 1, 0, 0)),
    (ENERGY, (1, 1, 0, 0)),
)
NAMES: dict[str, tuple[Fraction, Exponents]] = {
    name: (size, exponents) for sizes, exponents in _KINDS for name, size in sizes.items()
}
"""Size and exponents of each unit of which others are products."""
_QUOTIENTS: Mapping[Exponents, str] = {(0, 0, 0, 0): "ratio", (-2, 1, 0, 0): "stress"}
_FACTOR = re.compile(r"([A-Za-z]+)(?:\^?(-?\d+))?")
_SPELLED = str.maketrans({"µ": "u", "μ": "u", "°": "deg", "²": "2", "³": "3", "⁻": "-", "·": "*"})
_LARGEST_POWER = 9

WORDS = {
    **{
        word.lower(): word
        for word in (
            *("mm", "cm", "in", "ft", "deg", "rad", "min", "gf", "kgf", "ozf", "lbf", "kN"),
            *("kPa", "MPa", "GPa", "psi", "ksi"),
        )
    },
    **dict.fromkeys(("inch", "inches", '"'), "in"),
    **dict.fromkeys(("millimeter", "millimeters", "millimetre", "millimetres"), "mm"),
    "micron": "um",
    # Grad is German; the hundredth of a right angle is written gon
    **dict.fromkeys(("°", "degree", "degrees", "grad"), "deg"),
    **dict.fromkeys(("radian", "radians"), "rad"),
    "rev": "turn",
    **dict.fromkeys(("sec", "sek", "second", "seconds", "sekunden"), "s"),
    **dict.fromkeys(("newton", "newtons"), "N"),
    **dict.fromkeys(("lb", "lbs", "pounds"), "lbf"),
    "kp": "kgf",
    **dict.fromkeys(("megapascal", "megapascals"), "MPa"),
    "1": "-",
    **dict.fromkeys(("percent", "pct", "prozent"), "%"),
    **dict.fromkeys(("ue", "uε", "ustrain", "microstrain"), "um/m"),
}
"""Other spellings of units, in any case."""
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
    """Return the library's name of a unit, or None if it has none, as a quotient of units.

    Examples
    --------
    >>> [canonical(unit) for unit in ("Nmm", "N·cm", "in-lb", "Grad", "µm", "lbF", "furlong")]
    ['N*mm', 'N*cm', 'lbf*in', 'deg', 'um', 'lbf', None]
    """
    text = unit.strip().replace("µ", "u").replace("μ", "u")
    if text in _SPELLINGS:
        return _SPELLINGS[text]
    if text.lower() in WORDS:
        return WORDS[text.lower()]
    return _SPELLINGS.get(re.sub(r"[\s*·⋅×.\-]", "", text))


def parsed(unit: str) -> tuple[Fraction, Exponents]:
    """Return the size of a product of units in mm, N, s and degrees, and its exponents.

    Parameters
    ----------
    unit : str
        Units multiplied with ``*`` or a blank and divided with ``/``; powers are written ``m^2``,
        ``m2`` or ``m²``.

    Raises
    ------
    ValueError
        For factors that are no units, and powers above nine.

    Examples
    --------
    >>> parsed("kgf/mm^2")
    (Fraction(196133, 20000), (-2, 1, 0, 0))
    """
    size, total = Fraction(1), (0, 0, 0, 0)
    divides = False
    for piece in re.split(r"(\s*[*/]\s*|\s+)", unit.translate(_SPELLED)):
        if not piece.strip() or piece.strip() in "*/":
            divides = piece.strip() == "/"
            continue
        if piece == "1":
            continue
        found = _FACTOR.fullmatch(piece)
        name = found[1] if found else ""
        name = name if name in NAMES else canonical(name) or ""
        if found is None or name not in NAMES:
            raise ValueError(f"must have a unit made of {', '.join(NAMES)}, got {unit!r}")
        if len((found[2] or "").lstrip("-0")) > 1:
            raise ValueError(
                f"must have a unit to a power of {_LARGEST_POWER} at most, got {unit!r}"
            )
        power = int(found[2] or 1) * (-1 if divides else 1)
        factor, exponents = NAMES[name]
        size *= factor**power
        length, force, time, angle = (d + power * e for d, e in zip(total, exponents, strict=True))
        total = (length, force, time, angle)
    return size, total


def dimension(unit: str) -> str | None:
    """Return the dimension of a unit, "length", "torque" ..., or None if it is unknown.

    Examples
    --------
    >>> dimension("lbf*in"), dimension("N/cm²"), dimension("in/in")
    ('torque', 'stress', 'ratio')
    """
    return _measure(unit)[0]


def _measure(unit: str) -> tuple[str | None, Fraction]:
    # dimension, and size in the library's unit of it
    name = canonical(unit)
    for what, sizes in DIMENSIONS.items():
        if name in sizes:
            return what, sizes[str(name)]
    if not any(map(str.isalpha, unit)):
        return None, Fraction(0)
    try:
        size, exponents = parsed(unit.strip())
    except ValueError:
        return None, Fraction(0)
    return _QUOTIENTS.get(exponents), size


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
    >>> conversion("cm", "s")
    Traceback (most recent call last):
        ...
    ValueError: must be a unit of time (ns, us, ms, s, min), got 'cm', one of length
    """
    wanted, target = _measure(to)
    if wanted is None:
        raise ValueError(f"must be a unit of the library, got {to!r}")
    other, size = _measure(unit)
    if other != wanted:
        hint = f", one of {other}" if other else ""
        sizes = ", ".join(DIMENSIONS[wanted])
        raise ValueError(f"must be a unit of {wanted} ({sizes}), got {unit!r}{hint}")
    return float(size / target)


_WANTED: ContextVar[str] = ContextVar("units of the values shown", default="")


@contextmanager
def showing(units: str) -> Iterator[None]:
    """Show the values of tables, curves, pictures and pages in these units.

    Sentences, model files and written numbers (CSV, HDF5, JSON) stay in mm, N and s.

    Parameters
    ----------
    units : str
        Names joined by commas, as ``"in, lbf"``, used for lengths, forces and what is made of them.
        A unit of the same dimension, as ``"psi"`` for a stress, is preferred. All else keeps its
        unit.

    Raises
    ------
    ValueError
        If one of them is no unit.

    Examples
    --------
    >>> with showing("in, lbf, psi"):
    ...     print(with_unit(143.5, "N*mm"), *map(shown, ("mm^2", "mm/s", "MPa", "deg")))
    1.27 lbf·in ('in^2', 0.00155...) ('in/s', 0.0393...) ('psi', 145.03...) ('deg', 1.0)
    """
    for text in units.split(","):
        parsed(text)
    before = _WANTED.set(units)
    try:
        yield
    finally:
        _WANTED.reset(before)


def units_shown() -> str:
    """Return the units of the present :func:`showing`, "" outside of one."""
    return _WANTED.get()


def shown(unit: str) -> tuple[str, float]:
    """Return the unit in which numbers in ``unit`` are shown, and the factor to it."""
    named = {parsed(text)[1]: text.strip() for text in _WANTED.get().split(",") if text.strip()}
    try:
        size, exponents = parsed(unit) if named else (Fraction(1), (0, 0, 0, 0))
    except ValueError:
        return unit, 1.0
    length, force, time, angle = exponents
    parts = ((0, 1, 0, 0), "N", force), ((1, 0, 0, 0), "mm", length), ((0, 0, 1, 0), "s", time)
    new = named.get(exponents, "")
    if not new and not angle and any(power and base in named for base, _, power in parts[:2]):
        of = [(named.get(base, own), power) for base, own, power in parts]
        over, under = (
            [name if k * n == 1 else f"{name}^{k * n}" for name, n in of if k * n > 0]
            for k in (1, -1)
        )
        new = "/".join(("*".join(over) or "1", *under))
    return (new, float(size / parsed(new)[0])) if new else (unit, 1.0)


def with_unit(value: float, unit: str, half_width: float | None = None) -> str:
    """Return a number with four significant digits and its unit, as shown within `showing`.

    ``half_width`` is what is written after ±, in the same unit.
    """
    unit, factor = shown(unit)
    value = factor * value + 0.0  # no "-0"
    number = f"{value:.4g}" if abs(value) < 1e4 else f"{value:,.0f}"
    if half_width is not None:
        number += f" ± {factor * half_width:.2g}"
    return number + after(unit)


def pretty(unit: str) -> str:
    """Return a unit as printed: "N*mm" becomes "N·mm"; "" for a pure number."""
    return (
        unit.replace("*", "·")
        .replace("deg", "°")
        .replace("^2", "²")
        .replace("^3", "³")
        .removeprefix("-")
    )


def after(unit: str) -> str:
    """Return a unit as it is written after a number.

    Examples
    --------
    >>> f"{143.5}{after('N*mm')}", f"{27.4}{after('deg')}", f"{0.5}{after('-')}"
    ('143.5 N·mm', '27.4°', '0.5')
    """
    shown = pretty(unit)
    return shown if shown in ("", "°") else f" {shown}"


def in_unit(name: str, unit: str) -> str:
    """Return the name of an axis or of a row of numbers with its unit."""
    return f"{name} [{pretty(unit)}]" if pretty(unit) else name
