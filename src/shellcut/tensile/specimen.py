"""Nominal stress-strain curves from tables of test machines: :func:`read_specimens`."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated

import numpy as np

from shellcut.arguments import Option, checked
from shellcut.arrays import Floats
from shellcut.formats.errors import FileError
from shellcut.formats.number_table import NumberTable, read_number_table
from shellcut.results.measured_curve import curve_of_columns

from .columns import Choice, Column, specimen_columns

BROKEN = 0.1
"""A specimen is broken when the stress has fallen below this part of its strength (ISO 527-1)."""

_GONE = 0.02  # of the strength: the record is read until then, for the energy

FEWEST = 5
"""Points that a curve must have."""

LARGEST_STRAIN = 20.0
"""Films of polyethylene reach 10; beyond, per cent were read as a ratio."""


@checked
@dataclass(frozen=True, kw_only=True)
class SpecimenSize:
    """Dimensions of the specimens [mm]; what is not needed may be left out."""

    gauge_length: Annotated[
        float | None,
        Option(
            "mm",
            "length over which the extension is measured; between the grips, if the cross-head's",
            above=0,
        ),
    ] = None
    width: Annotated[float | None, Option("mm", "for columns of force", above=0)] = None
    thickness: Annotated[float | None, Option("mm", "for columns of force", above=0)] = None


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
    columns: str
    """From which columns, in words."""
    notes: tuple[str, ...] = ()
    """What was done to them, and what to know of them."""


def read_specimens(
    path: str | Path,
    piece: SpecimenSize | None = None,
    direction: str = "",
    columns: Choice = None,
    units: str | Sequence[str] | None = None,
) -> list[Specimen]:
    """Read all specimens of a table, cut in a direction, as MD.

    The ``piece`` is needed for columns of extension (gauge length) and force (width and thickness);
    columns and units are those of :func:`shellcut.tensile.columns.specimen_columns`.
    """
    table = read_number_table(path)
    size = piece or SpecimenSize()
    pairs = specimen_columns(table, columns, units)
    problems = []
    if size.gauge_length is None and any(x.dimension == "length" for x, _ in pairs):
        problems.append("extensions need the gauge_length")
    if None in (size.width, size.thickness) and any(y.dimension == "force" for _, y in pairs):
        problems.append("forces need width and thickness of the specimen")
    if problems:
        used = "; ".join(f"{_quoted(x)} and {_quoted(y)}" for x, y in pairs)
        raise FileError(table.path, f"{'; '.join(problems)}: of {used}")
    return [
        _specimen(_rows_of(table, x.index, y.index), (x, y), number, (size, direction))
        for number, (x, y) in enumerate(pairs, start=1)
    ]


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
    table: NumberTable, columns: tuple[Column, Column], number: int, of: tuple[SpecimenSize, str]
) -> Specimen:
    (x, y), (piece, direction) = columns, of
    at = [x.index, y.index]
    stress = table.numbers(at)[:, 1]
    if not len(stress) or not np.nanmax(stress) > 0.0:
        raise FileError(table.path, f"{_quoted(y)} must rise above 0; is tension negative?")
    peak = int(np.nanargmax(stress))
    broken = bool((stress[peak:] < BROKEN * stress[peak]).any())
    low = np.flatnonzero(stress[peak:] < _GONE * stress[peak])
    end = peak + int(low[0]) if len(low) else len(stress)
    if end < FEWEST:
        raise FileError(
            table.path, f"{_quoted(y)} must have {FEWEST} points up to the break, got {end}"
        )
    whole = replace(table, rows=table.rows[:end], lines=table.lines[:end])
    curve = curve_of_columns(whole, at, (x.unit, y.unit))
    strain, stress = np.asarray(curve.x), np.asarray(curve.y)
    notes = list(curve.notes)
    told = [f"strain from {_quoted(x)}", f"stress from {_quoted(y)}"]
    if x.dimension == "length":
        strain = strain / float(piece.gauge_length or 1.0)
        told[0] += f" over {piece.gauge_length:g} mm"
        notes.append(
            "strains are extensions over the gauge length: where they are those of the cross-head, "
            "machine and grips yield too, and the modulus is too low"
        )
    if y.dimension == "force":
        stress = stress / (float(piece.width or 1.0) * float(piece.thickness or 1.0))
        told[1] += f" over {piece.width:g} mm x {piece.thickness:g} mm"
    if strain[-1] > LARGEST_STRAIN:
        written = np.abs(whole.numbers(at)[:, 0])
        row = int(np.argmax(written > LARGEST_STRAIN / strain[-1] * written.max()))
        raise FileError(
            table.path,
            f"strain must stay below {LARGEST_STRAIN:g}, got {strain[-1]:.4g} in {_quoted(x)}, "
            f"beyond it from line {whole.lines[row]} on; is it in %?",
        )
    if x.true and x.dimension == "ratio":
        strain = np.expm1(strain)
        told[0] += " (true, made nominal)"
    if y.true and y.dimension == "stress":
        stress = stress / (1.0 + strain)
        told[1] += " (true, made nominal)"
    name = f"{table.path.stem} {number}"
    direction = direction or _direction(y.heading.name)
    columns_used = " and ".join(told)
    return Specimen(name, direction, strain, stress, broken, columns_used, tuple(notes))


def _quoted(one: Column) -> str:
    named = repr(one.heading.text) if one.heading.text else f"column {one.index + 1}"
    return named if one.unit and one.unit in one.heading.text else f"{named} in {one.unit}"


def _direction(name: str) -> str:
    # a word of the stress's heading, as in "stress MD 1 [MPa]"
    for word in re.split(r"[\s_()\[\],;]+", name):
        if word.upper() in ("MD", "CD", "TD") or word.rstrip("°") in ("0", "45", "90"):
            return word.upper()
    return ""
