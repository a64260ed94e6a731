"""Units of length, angle, force, torque and time as people write them, and the factors between.

::

    conversion("Ncm", "N*mm") = 10.0        conversion("Grad", "rad") = pi / 180

A product may be written ``N*mm``, ``N·mm``, ``N mm``, ``N-mm`` or ``Nmm``; letters keep their case
(``mN`` is a millinewton), whole words do not (``Deg``, ``INCH``).
"""

from __future__ import annotations

import re
from math import pi

_STANDARD_GRAVITY = 9.80665
_POUND = 0.45359237 * _STANDARD_GRAVITY

LENGTH = {
    "um": 1e-3,
    "mm": 1.0,
    "cm": 10.0,
    "m": 1000.0,
    "in": 25.4,
    "ft": 304.8,
    "mil": 0.0254,
}
"""Size of each unit of length [mm]."""
ANGLE = {
    "rad": 1.0,
    "mrad": 1e-3,
    "deg": pi / 180.0,
    "gon": pi / 200.0,
    "turn": 2.0 * pi,
}
"""Size of each unit of angle [rad]."""
FORCE = {
    "mN": 1e-3,
    "N": 1.0,
    "daN": 10.0,
    "kN": 1000.0,
    "gf": 1e-3 * _STANDARD_GRAVITY,
    "kgf": _STANDARD_GRAVITY,
    "ozf": _POUND / 16.0,
    "lbf": _POUND,
}
"""Size of each unit of force [N]."""
TIME = {"us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0}
"""Size of each unit of time [s]."""
TORQUE = {
    f"{force}*{arm}": FORCE[force] * LENGTH[arm]
    for forces, arms in (
        (("mN", "N", "kN", "gf", "kgf"), ("mm", "cm", "m")),
        (("ozf", "lbf"), ("in", "ft")),
    )
    for force in forces
    for arm in arms
}
"""Size of each unit of torque [N·mm]."""
RATIO = {"-": 1.0, "%": 0.01}
"""Size of each pure number."""

DIMENSIONS = {
    "length": LENGTH,
    "angle": ANGLE,
    "force": FORCE,
    "torque": TORQUE,
    "time": TIME,
    "ratio": RATIO,
}
LIBRARY_UNITS = {
    "length": "mm",
    "angle": "deg",
    "force": "N",
    "torque": "N*mm",
    "time": "s",
    "ratio": "-",
}
"""The unit in which histories hold each dimension."""

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
    "percent": "%",
}
_SPELLINGS = {
    **{name: name for sizes in DIMENSIONS.values() for name in sizes},
    **{name.replace("*", ""): name for name in TORQUE},
    # Torques of pounds and ounces are said either way round, and often without the f of force.
    **{
        spelling: f"{force}*{arm}"
        for force in ("ozf", "lbf")
        for arm in ("in", "ft")
        for spelling in (f"{arm}{force}", f"{force[:2]}{arm}", f"{arm}{force[:2]}")
    },
}


def canonical(unit: str) -> str | None:
    """Return how the library writes a unit, or None if it does not know it.

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
    """Return what a unit measures, "length", "torque" ..., or None if it is not known.

    Examples
    --------
    >>> dimension("lbf*in")
    'torque'
    """
    name = canonical(unit)
    return next((d for d, sizes in DIMENSIONS.items() if name in sizes), None)


def conversion(unit: str, to: str) -> float:
    """Return the factor that takes numbers in ``unit`` to numbers in ``to``.

    Parameters
    ----------
    unit : str
        As people write it.
    to : str
        A unit that the library knows; its dimension is the one wanted.

    Raises
    ------
    ValueError
        If ``unit`` is unknown or of another dimension, with the known units of the one wanted.

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
    return sizes[name] / sizes[target]
