"""Nominal stress-strain curves from tables of test machines: :func:`read_specimens`.

The unit in a heading says what a column is: ``%`` or ``-`` strain, ``mm`` extension, ``MPa``
stress, ``N`` force. Each stress belongs to the strain before it; one strain may serve all stresses.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path

import numpy as np

from shellcut.arrays import Floats
from shellcut.formats.errors import FileError
from shellcut.formats.number_table import Heading, NumberTable, read_number_table
from shellcut.results.measured_curve import curve_of_columns
from shellcut.unit import dimension

BROKEN = 0.1
"""A specimen is broken when the stress has fallen below this part of its strength (ISO 527-1)."""

_GONE = 0.02  # of the strength: the record is read until then, for the energy

FEWEST = 5
"""Points that a curve must have."""

LARGEST_STRAIN = 20.0
"""Films of polyethylene reach 10; beyond, per cent were read as a ratio."""


@dataclass(frozen=True, kw_only=True)
class SpecimenSize:
    """Dimensions of the specimens [mm]; what is not needed may be left out.

    Raises
    ------
    ValueError
        If one of them is not a finite length above 0.
    """

    gauge_length: float | None = None
    """Length over which the extension is measured; between the grips, if the cross-head's."""
    width: float | None = None
    thickness: float | None = None

    def __post_init__(self) -> None:
        problems = [
            f"{name} must be a finite length above 0 in mm, got {value!r}"
            for name, value in vars(self).items()
            if value is not None and not (isfinite(value) and value > 0.0)
        ]
        if problems:
            raise ValueError("; ".join(problems))


@dataclass(frozen=True, eq=False)
class Specimen:
    """The nominal curve of one specimen up to its break."""

    name: str
    direction: str
    """MD, CD, 45 ..., or empty."""
    strain: Floats
    """Engineering strain [-], increasing, shape (n,)."""
    stress: Floats
    """Force over the undeformed section [MPa], shape (n,)."""
    broken: bool
    """Whether the record shows the break; otherwise it ends before."""
    notes: tuple[str, ...] = ()


def read_specimens(
    path: str | Path, piece: SpecimenSize | None = None, direction: str = ""
) -> list[Specimen]:
    """Read all specimens of a table.

    Parameters
    ----------
    path : str or Path
    piece : SpecimenSize, optional
        Needed for columns of extension (gauge length) and force (width and thickness).
    direction : str
        In which the specimens were cut, as MD.

    Raises
    ------
    FileError
        Lists columns without a partner, unknown units, missing dimensions, and lines that are not
        numbers or run back.
    """
    table = read_number_table(path)
    size = piece or SpecimenSize()
    found = []
    for number, (x, y) in enumerate(_pairs(table, size), start=1):
        found.append(_specimen(_rows_of(table, x, y), (x, y), number, (size, direction)))
    return found


def _pairs(table: NumberTable, piece: SpecimenSize) -> list[tuple[int, int]]:
    # the columns of strain (or extension) and stress (or force) that belong together
    if not table.headings:
        raise FileError(
            table.path,
            "the table must have headings with units, as strain [%]; stress [MPa], got none",
        )
    kinds: dict[str, list[int]] = {}
    for k, heading in enumerate(table.headings):
        kinds.setdefault(dimension(heading.unit) or "", []).append(k)
    strains = kinds.get("ratio") or kinds.get("length", [])
    stresses = kinds.get("stress") or kinds.get("force", [])
    listing = ", ".join(repr(heading.text) for heading in table.headings)
    if not strains or not stresses:
        raise FileError(
            table.path,
            "a tensile test needs a column of strain (%, -) or extension (mm) and one of stress "
            f"(MPa) or force (N), with the unit in its heading; got {listing}",
        )
    if len(strains) == 1:
        strains = strains * len(stresses)
    if len(strains) != len(stresses):
        raise FileError(
            table.path,
            f"every stress must have its strain, or all the same one, got {len(strains)} columns "
            f"of strain and {len(stresses)} of stress: {listing}",
        )
    problems = []
    if "ratio" not in kinds and piece.gauge_length is None:
        problems.append("extensions need the gauge_length")
    if "stress" not in kinds and None in (piece.width, piece.thickness):
        problems.append("forces need width and thickness of the specimen")
    if problems:
        raise FileError(table.path, "; ".join(problems))
    return list(zip(strains, stresses, strict=True))


def _rows_of(table: NumberTable, x: int, y: int) -> NumberTable:
    # without the rows where a shorter specimen has no numbers any more
    held = [
        k
        for k, row in enumerate(table.rows)
        if len(row) != table.n_column or row[x].strip() or row[y].strip()
    ]
    rows, lines = tuple(table.rows[k] for k in held), tuple(table.lines[k] for k in held)
    return replace(table, rows=rows, lines=lines)


def _specimen(
    table: NumberTable, columns: tuple[int, int], number: int, of: tuple[SpecimenSize, str]
) -> Specimen:
    piece, direction = of
    headings = table.headings[columns[0]], table.headings[columns[1]]
    stress = table.numbers(list(columns))[:, 1]
    if not len(stress) or not np.nanmax(stress) > 0.0:
        raise FileError(table.path, f"{headings[1].text!r} must rise above 0; is tension negative?")
    peak = int(np.nanargmax(stress))
    broken = bool((stress[peak:] < BROKEN * stress[peak]).any())
    low = np.flatnonzero(stress[peak:] < _GONE * stress[peak])
    end = peak + int(low[0]) if len(low) else len(stress)
    if end < FEWEST:
        raise FileError(
            table.path,
            f"{headings[1].text!r} must have {FEWEST} points up to the break, got {end}",
        )
    whole = replace(table, rows=table.rows[:end], lines=table.lines[:end])
    curve = curve_of_columns(whole, list(columns))
    strain, stress = np.asarray(curve.x), np.asarray(curve.y)
    if curve.x_unit == "mm":
        strain = strain / float(piece.gauge_length or 1.0)
    if curve.y_unit == "N":
        stress = stress / (float(piece.width or 1.0) * float(piece.thickness or 1.0))
    if strain[-1] > LARGEST_STRAIN:
        raise FileError(
            table.path,
            f"strain must stay below {LARGEST_STRAIN:g}, got {strain[-1]:.4g} in "
            f"{headings[0].text!r}; is it in %?",
        )
    name = f"{table.path.stem} {number}"
    notes = tuple(f"{name}: {note}" for note in curve.notes)
    return Specimen(name, direction or _direction(headings), strain, stress, broken, notes)


def _direction(headings: tuple[Heading, Heading]) -> str:
    # a word of the stress's heading, as in "stress MD 1 [MPa]"
    for word in headings[1].name.replace("_", " ").split():
        if word.upper() in ("MD", "CD", "TD") or word.rstrip("°") in ("0", "45", "90"):
            return word.upper()
    return ""
