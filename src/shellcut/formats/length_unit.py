"""The unit of length of a file: given, or guessed from the size and logged.

Mesh and surface files contain numbers without a unit. The unit is guessed only where a wrong factor
would be obvious: a part of 2 to 2000 units is taken for millimetres, one of 0.002 to 0.1 for
metres. In between and beyond (0.1 to 2 may be inches or metres) it must be given.
"""

from __future__ import annotations

from math import isfinite
from numbers import Real
from typing import Annotated, TypeAlias

from shellcut.arguments import Option
from shellcut.unit import LENGTH, conversion

MILLIMETRES = {
    **{unit: float(LENGTH[unit]) for unit in ("um", "mm", "cm", "m")},
    "inch": float(LENGTH["in"]),
    "mil": float(LENGTH["mil"]),
}
"""Length of each unit that files are likely to have [mm]."""

_LIKELY = (0.1, 2000.0)
"""Sizes of a part [mm] beyond which the unit that its file states is taken for a mistake."""

_TAKEN_FOR_MM = (2.0, 2000.0)
_TAKEN_FOR_M = (0.002, 0.1)
_MAY_BE_INCHES = 12.0  # a foot: most films and tools are smaller

FileUnit: TypeAlias = Annotated[
    str | float | None,
    Option(
        "",
        f"of the file: {', '.join(MILLIMETRES)}",
        form="unit",
        unset="stated by the file; guessed from the size and logged",
    ),
]


def unit_in_mm(
    unit: str | float | None, extent: float, what: str, *, stated: float | None = None
) -> tuple[float, str]:
    """Return the length of the unit [mm], and a note, empty if there is nothing to say.

    The unit is given, or ``stated`` by the file [mm], or guessed from the ``extent``, the largest
    side of the bounding box in the file's unit. Messages name the part by ``what``. Raises
    ValueError if the unit is unknown, too uncertain to guess, or stated and makes a part of an
    unlikely size.

    Examples
    --------
    >>> unit_in_mm("in", 0.8, "the film")
    (25.4, '')
    >>> unit_in_mm(None, 20.4, "the film")
    (1.0, 'no unit given: taken as mm, the film is 20.4 mm across; unit="..." says otherwise')
    """
    if isinstance(unit, Real):
        if not isfinite(unit) or unit <= 0.0:
            raise ValueError(f"unit must be a finite length above 0 in mm, got {unit!r}")
        return float(unit), _against(float(unit), stated)
    if unit is not None:
        try:
            given = conversion(str(unit), "mm")
        except ValueError as problem:
            raise ValueError(f"unit {problem}") from None
        return given, _against(given, stated)
    if stated is not None:
        size = extent * stated
        if not _LIKELY[0] <= size <= _LIKELY[1]:
            raise ValueError(
                f"{what} must be {_LIKELY[0]:g} to {_LIKELY[1]:g} mm across, got {size:.4g} mm by "
                f"the unit that the file states, {_named(stated)}; if this is right, or the file "
                f"is wrong, give unit= one of {', '.join(MILLIMETRES)}"
            )
        how = "" if stated == 1.0 else ", converted to mm"
        said = f"the file states the unit {_named(stated)}{how}: {what} is {size:.4g} mm across"
        return stated, said
    for name, (least, most) in (("mm", _TAKEN_FOR_MM), ("m", _TAKEN_FOR_M)):
        if least <= extent < most:
            factor = MILLIMETRES[name]
            inches = ""
            if name == "mm" and extent <= _MAY_BE_INCHES:
                inches = f', unit="in" would make it {MILLIMETRES["inch"] * extent:.4g} mm'
            return factor, (
                f"no unit given: taken as {name}, {what} is {extent * factor:.4g} mm across; "
                f'unit="..." says otherwise{inches}'
            )
    raise ValueError(
        f"the unit must be given, because {what} is {extent:.4g} units across, which fits several: "
        f"unit= one of {', '.join(MILLIMETRES)}"
    )


def _named(millimetres: float) -> str:
    names = {length: name for name, length in MILLIMETRES.items()}
    return names.get(millimetres, f"{millimetres:g} mm")


def _against(given: float, stated: float | None) -> str:
    if stated is None or stated == given:
        return ""
    return f"the file states the unit {_named(stated)}, but is read in {_named(given)} as given"
